"""Functions that have no machine code of their own, written by those that have.

Laws of users may call any of them. Errors are a few units in the last place, but for
`pow` and `exp2`, whose error grows with the size of the exponent as that of exp does.
"""

import math

import jax.numpy as jnp

LARGE = 2.0**26
"""Beyond it the square of a number drowns one."""
WHOLE = 2.0**52
"""Numbers from here on have no fraction."""
LOG_2 = math.log(2.0)


def _expm1(x):
    power = jnp.exp(x)
    # What rounding takes from the power it takes from its logarithm too.
    near = (power - 1.0) * x / jnp.log(power)
    small = jnp.abs(x) < 0.5
    value = jnp.where(small & (power != 1.0), near, power - 1.0)
    return jnp.where(power == 1.0, x, value)


def _log1p(x):
    sum_ = 1.0 + x
    near = jnp.log(sum_) * x / (sum_ - 1.0)
    value = jnp.where(jnp.abs(x) < 0.5, near, jnp.log(sum_))
    return jnp.where(sum_ == 1.0, x, value)


def _tanh(x):
    power = _expm1(-2.0 * jnp.abs(x))
    return -jnp.sign(x) * power / (power + 2.0)


def _sinh(x):
    size = jnp.abs(x)
    power, half = _expm1(size), jnp.exp(0.5 * size)
    small = 0.5 * (power + power / (power + 1.0))
    # In two factors, as the power itself overflows a little sooner
    return jnp.sign(x) * jnp.where(size < 30.0, small, (0.5 * half) * half)


def _cosh(x):
    half = jnp.exp(0.5 * jnp.abs(x))
    return (0.5 * half) * half + 0.5 / (half * half)


def _asinh(x):
    size = jnp.abs(x)
    square = jnp.minimum(size, LARGE) ** 2
    near = _log1p(size + square / (1.0 + jnp.sqrt(square + 1.0)))
    return jnp.sign(x) * jnp.where(size < LARGE, near, jnp.log(size) + LOG_2)


def _acosh(x):
    over = jnp.minimum(x, LARGE) - 1.0
    near = _log1p(over + jnp.sqrt(2.0 * over + over * over))
    return jnp.where(x < LARGE, near, jnp.log(x) + LOG_2)


def _atanh(x):
    size = jnp.abs(x)
    return jnp.sign(x) * (0.5 * _log1p(2.0 * size / (1.0 - size)))


def _asin(x):
    return jnp.arctan(x / jnp.sqrt((1.0 - x) * (1.0 + x)))


def _acos(x):
    return 2.0 * jnp.arctan(jnp.sqrt((1.0 - x) / (1.0 + x)))


def _atan2(y, x):
    steep = jnp.abs(y) > jnp.abs(x)
    nothing = (x == 0.0) & (y == 0.0)
    top, bottom = jnp.where(steep, -x, y), jnp.where(steep, y, x)
    angle = jnp.arctan(top / jnp.where(nothing, 1.0, bottom))
    side = jnp.where(y < 0.0, -1.0, 1.0)
    behind = jnp.where(x < 0.0, side * math.pi, 0.0)
    return angle + jnp.where(steep, side * (0.5 * math.pi), behind)


def _truncated(x):
    size = jnp.abs(x)
    rounded = (size + WHOLE) - WHOLE
    whole = jnp.where(rounded > size, rounded - 1.0, rounded)
    return jnp.where(size < WHOLE, jnp.sign(x) * whole, x)


def _floor(x):
    whole = _truncated(x)
    return jnp.where(whole > x, whole - 1.0, whole)


def _ceil(x):
    whole = _truncated(x)
    return jnp.where(whole < x, whole + 1.0, whole)


def _rem(x, y):
    return x - y * _truncated(x / y)


def _pow(x, y):
    size = jnp.abs(x)
    whole = _truncated(y) == y
    odd = whole & (_truncated(0.5 * y) != 0.5 * y)
    power = jnp.exp(y * jnp.log(jnp.where(size == 0.0, 1.0, size)))
    at_zero = jnp.where(y > 0.0, 0.0, math.inf)
    power = jnp.where(size == 0.0, at_zero, power)
    power = jnp.where(y == 0.0, 1.0, power)
    negative = jnp.where(odd, -power, jnp.where(whole, power, math.nan))
    return jnp.where(jnp.isnan(y), y, jnp.where(x < 0.0, negative, power))


def _clamp(low, x, high):
    return jnp.minimum(jnp.maximum(x, low), high)


REWRITTEN = {
    "acos": _acos,
    "acosh": _acosh,
    "asin": _asin,
    "asinh": _asinh,
    "atan2": _atan2,
    "atanh": _atanh,
    "ceil": _ceil,
    "clamp": _clamp,
    "cosh": _cosh,
    "exp2": lambda x: jnp.exp(x * LOG_2),
    "expm1": _expm1,
    "floor": _floor,
    "log1p": _log1p,
    "logistic": lambda x: 1.0 / (1.0 + jnp.exp(-x)),
    "pow": _pow,
    "rem": _rem,
    "rsqrt": lambda x: 1.0 / jnp.sqrt(x),
    "sinh": _sinh,
    "tanh": _tanh,
}
"""Primitive of JAX -> function of float64 arrays, place by place."""

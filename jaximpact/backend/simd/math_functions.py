"""Elementary functions in vector arithmetic.

Reductions of the argument and polynomials are those of fdlibm (Sun Microsystems, 1993),
with the cases taken by selection. Errors are below two units in the last place, of the
tangent below four, and of its inverse below two and a half. Numbers
below the smallest normal one count as zero, as they do in XLA's programs on CPU.

The functions of `REWRITTEN` have no code of their own and are written in JAX by those
that have; laws of users may call any of them. Their errors are a few units in the last
place, but for `pow` and `exp2`, whose error grows with the size of the exponent as that
of exp does.
"""

import math

import jax.numpy as jnp

from .graph import Graph, Value, bits_of

ROUNDER = 1.5 * 2.0**52
"""Added, it rounds a float to an integer, found in its lowest bits."""
SMALLEST = 2.0**-1022
SIGN = -(2**63)
LOG2_HIGH, LOG2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
# The three add up to pi / 2.
QUARTERS = (1.5707963267948966, 6.123233995736766e-17, -1.4973849048591833e-33)
LOG_TERMS = (
    6.666666666666735130e-01,
    3.999999999940941908e-01,
    2.857142874366239149e-01,
    2.222219843214978396e-01,
    1.818357216161805012e-01,
    1.531383769920937332e-01,
    1.479819860511658591e-01,
)
SINE_TERMS = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
COSINE_TERMS = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
ARC_TERMS = (
    3.33333333333329318027e-01,
    -1.99999999998764832476e-01,
    1.42857142725034663711e-01,
    -1.11111104054623557880e-01,
    9.09088713343650656196e-02,
    -7.69187620504482999495e-02,
    6.66107313738753120669e-02,
    -5.83357013379057348645e-02,
    4.97687799461593236017e-02,
    -3.65315727442169155270e-02,
    1.62858201153657823623e-02,
)
EXP_TERMS = tuple(1.0 / math.factorial(n) for n in range(2, 14))


def _polynomial(graph: Graph, x: Value, terms: tuple[float, ...]) -> Value:
    """Compute the sum of `terms[n] x**n`, by pairs, so that few operations wait for
    others."""
    values = list(terms)
    while len(values) > 1:
        pairs = [
            graph.apply("fused", values[i + 1], x, values[i])
            for i in range(0, len(values) - 1, 2)
        ]
        values = pairs + values[2 * len(pairs) :]
        if len(values) > 1:
            x = graph.apply("multiply", x, x)
    return values[0]


def exp(graph: Graph, x: Value) -> Value:
    """Exponential."""
    at = graph.apply
    rounded = at("fused", x, 1.0 / math.log(2.0), ROUNDER)
    count = at("subtract", rounded, ROUNDER)
    rest = at("fused", count, -LOG2_HIGH, x)
    rest = at("fused", count, -LOG2_LOW, rest)
    bend = _polynomial(graph, rest, EXP_TERMS)
    power = at("add", at("fused", at("multiply", rest, rest), bend, rest), 1.0)
    shifted = at("shift_left", at("to_bits", rounded), 52)
    result = at("from_bits", at("integer_add", at("to_bits", power), shifted))
    vanishes = at("less", x, -708.3964185322641)
    outside = at("or", vanishes, at("less", 709.782712893384, x))
    return graph.choose(outside, graph.choose(vanishes, 0.0, math.inf), result)


def log(graph: Graph, x: Value) -> Value:
    """Natural logarithm."""
    at = graph.apply
    bits = at("to_bits", x)
    exponent = at(
        "shift_right", at("integer_subtract", bits, bits_of(math.sqrt(0.5))), 52
    )
    part = at("from_bits", at("integer_subtract", bits, at("shift_left", exponent, 52)))
    count = at("to_float", exponent)
    # In sums of two, so that few operations wait for others
    f = at("subtract", part, 1.0)
    s = at("divide", f, at("add", part, 1.0))
    z = at("multiply", s, s)
    half = at("multiply", at("multiply", f, f), 0.5)
    low = at("fused", count, LOG2_LOW, at("negate", half))
    rest = at("fused", z, _polynomial(graph, z, LOG_TERMS), half)
    small = at("fused", s, rest, low)
    result = at("add", at("fused", count, LOG2_HIGH, f), small)
    outside = graph.choose(
        at("less", at("magnitude", x), SMALLEST), -math.inf, math.nan
    )
    outside = graph.choose(at("equal", x, math.inf), x, outside)
    usual = at("and", at("at_most", SMALLEST, x), at("less", x, math.inf))
    return graph.choose(usual, result, outside)


def _quarter_turns(graph: Graph, x: Value) -> tuple[Value, Value, Value]:
    """Sine and cosine of what is left of an angle after whole quarter turns, and the
    number of these."""
    at = graph.apply
    rounded = at("fused", x, 2.0 / math.pi, ROUNDER)
    count = at("subtract", rounded, ROUNDER)
    rest = x
    for part in QUARTERS:
        rest = at("fused", count, -part, rest)
    z = at("multiply", rest, rest)
    sine = at(
        "fused",
        at("multiply", z, rest),
        _polynomial(graph, z, SINE_TERMS),
        rest,
    )
    half = at("multiply", z, 0.5)
    most = at("subtract", 1.0, half)
    lost = at("subtract", at("subtract", 1.0, most), half)
    cosine = at(
        "fused",
        at("multiply", z, z),
        _polynomial(graph, z, COSINE_TERMS),
        lost,
    )
    return sine, at("add", most, cosine), at("to_bits", rounded)


def _signed(graph: Graph, value: Value, turns: Value) -> Value:
    """Change the sign of a value in the third and fourth quarter."""
    at = graph.apply
    sign = at("shift_left", at("bits_and", turns, 2), 62)
    return at("from_bits", at("bits_differ", at("to_bits", value), sign))


def _is_odd(graph: Graph, turns: Value) -> Value:
    return graph.apply("integer_equal", graph.apply("bits_and", turns, 1), 1)


def sin(graph: Graph, x: Value) -> Value:
    """Sine, of angles up to 1e9."""
    sine, cosine, turns = _quarter_turns(graph, x)
    return _signed(graph, graph.choose(_is_odd(graph, turns), cosine, sine), turns)


def cos(graph: Graph, x: Value) -> Value:
    """Cosine, of angles up to 1e9."""
    sine, cosine, turns = _quarter_turns(graph, x)
    value = graph.choose(_is_odd(graph, turns), sine, cosine)
    return _signed(graph, value, graph.apply("integer_add", turns, 1))


def atan(graph: Graph, x: Value) -> Value:
    """Arc tangent."""
    at = graph.apply
    size = at("magnitude", x)
    steep = at("less", math.tan(3.0 * math.pi / 8.0), size)
    middle = at("less", math.tan(math.pi / 8.0), size)
    top = graph.choose(middle, at("subtract", size, 1.0), size)
    bottom = graph.choose(middle, at("add", size, 1.0), 1.0)
    t = at(
        "divide",
        graph.choose(steep, -1.0, top),
        graph.choose(steep, size, bottom),
    )
    z = at("multiply", t, t)
    bend = at("multiply", z, _polynomial(graph, z, ARC_TERMS))

    def base(whole: float) -> Value:
        return graph.choose(steep, whole, graph.choose(middle, 0.5 * whole, 0.0))

    rest = at("subtract", at("multiply", t, bend), base(QUARTERS[1]))
    angle = at("subtract", base(QUARTERS[0]), at("subtract", rest, t))
    sign = at("bits_and", at("to_bits", x), SIGN)
    return at("from_bits", at("bits_or", at("to_bits", angle), sign))


def tan(graph: Graph, x: Value) -> Value:
    """Tangent, of angles up to 1e9."""
    return graph.apply("divide", sin(graph, x), cos(graph, x))


def cbrt(graph: Graph, x: Value) -> Value:
    """Cube root."""
    at = graph.apply
    size = at("magnitude", x)
    guess = exp(graph, at("multiply", log(graph, size), 1.0 / 3.0))
    square = at("multiply", guess, guess)
    over = at("fused", square, guess, at("negate", size))
    better = at("subtract", guess, at("divide", over, at("multiply", square, 3.0)))
    regular = at("and", at("less", 0.0, guess), at("less", guess, math.inf))
    root = graph.choose(regular, better, guess)
    sign = at("bits_and", at("to_bits", x), SIGN)
    return at("from_bits", at("bits_or", at("to_bits", root), sign))


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

"""Elementary functions that stay finite, with a finite gradient, at their singular
point.

`jax.grad` of `jnp.where(x > 0, jnp.sqrt(x), 0)` is NaN at 0, because the branch that
is not taken is differentiated as well. Every function here feeds its singular operation
a harmless argument first (the "double where") and is tested at the point itself.
"""

import jax.numpy as jnp

from ._types import Scalar

TINY = 1e-30
"""Smallest divisor [-]; far below any force, length or energy of a real impact."""


def safe_sqrt(x: Scalar) -> Scalar:
    """Compute the square root of `max(x, 0)`; value 0 and gradient 0 for `x <= 0`."""
    positive = x > 0
    return jnp.where(positive, jnp.sqrt(jnp.where(positive, x, 1.0)), 0.0)


def safe_power(x: Scalar, exponent: Scalar) -> Scalar:
    """Compute `x ** exponent` for `x > 0`; value 0 and gradient 0 for `x <= 0`."""
    positive = x > 0
    power = positive_power(jnp.where(positive, x, 1.0), exponent)
    return jnp.where(positive, power, 0.0)


def positive_power(x: Scalar, exponent: Scalar) -> Scalar:
    """Compute `x ** exponent` where `x` is known to be positive.

    Written as `exp(exponent log x)`: the same value to rounding, and both factors
    vectorise on a CPU where `pow` does not.
    """
    return jnp.exp(exponent * jnp.log(x))

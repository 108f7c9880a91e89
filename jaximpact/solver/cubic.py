"""The cubic through values and rates at both ends of a step: its peak and its root."""

import jax
import jax.numpy as jnp

from ..safe import safe_sqrt


def hermite_cubic(start, start_rate, end, end_rate, width):
    """Coefficients a, b, c of the cubic `start + a s + b s^2 + c s^3`, s from 0 to 1,
    through both ends' values and rates."""
    a = width * start_rate
    rise = end - start
    b = 3.0 * rise - 2.0 * a - width * end_rate
    c = a + width * end_rate - 2.0 * rise
    return a, b, c


def peak_of_cubic(start, start_rate, end, end_rate, width):
    """Largest value on a step of the cubic through both ends' values and rates.

    Returns:
        The value and where it is reached, as a part of the step. Of equal candidates
        the end counts. Finite, with finite gradients, for every input: flat steps and
        steps of no width give the end's value.
    """
    a, b, c = hermite_cubic(start, start_rate, end, end_rate, width)
    # derivative a + 2 b s + 3 c s^2; its maximum root in the form without cancellation
    root = safe_sqrt(b * b - 3.0 * a * c)
    divisor = -b + root
    usable = jnp.abs(divisor) > 1e-300
    s = jnp.where(usable, a / jnp.where(usable, divisor, 1.0), 1.0)
    # The place of a maximum has no first-order effect on its value.
    s = jax.lax.stop_gradient(jnp.clip(s, 0.0, 1.0))
    inside = start + s * (a + s * (b + s * c))
    return jnp.where(inside > end, inside, end), jnp.where(inside > end, s, 1.0)


def root_of_cubic(start, start_rate, end, end_rate, width):
    """Where the cubic through both ends' values and rates is zero, as a part of width.

    For start > 0 > end. Eight Newton steps kept inside the bracket; where they have not
    converged, half way.
    """
    a, b, c = hermite_cubic(start, start_rate, end, end_rate, width)
    low, high = jnp.zeros_like(a), jnp.ones_like(a)
    s = start / (start - end)
    for _ in range(8):
        value = start + s * (a + s * (b + s * c))
        slope = a + s * (2.0 * b + s * 3.0 * c)
        low, high = jnp.where(value > 0, s, low), jnp.where(value > 0, high, s)
        newton = s - value / jnp.where(slope < 0.0, slope, -1.0)
        inside = (slope < 0.0) & (newton > low) & (newton < high)
        s = jnp.where(inside, newton, 0.5 * (low + high))
    value = start + s * (a + s * (b + s * c))
    return jnp.where(jnp.abs(value) < 0.1 * jnp.minimum(start, -end), s, 0.5)

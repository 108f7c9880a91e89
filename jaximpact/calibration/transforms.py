r"""Bounded parameters as smooth images of the real line.

The optimiser works on z, any real number. A parameter p in (lower, upper) is

$$ q(p) = q_l + (q_u - q_l) / (1 + e^{-z}), $$

with q = ln p for a positive parameter and q = p for one that may be 0 or negative.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

NEAR_BOUND = 0.01
"""A parameter within this part of its range from a bound, measured in q, is at it."""

Parameters = Float[Array, " parameters"]


class Bounds(NamedTuple):
    """Ranges of the fitted parameters, in the units of their columns."""

    lower: Parameters
    upper: Parameters
    logarithmic: Bool[Array, " parameters"]
    """Whether q is the logarithm; both bounds are positive then."""

    def parameter(self, z: Parameters) -> Parameters:
        """p of z, in the closed range; smooth, finite gradient for every z."""
        low, high = _natural(self, self.lower), _natural(self, self.upper)
        # From the nearer bound, so that neither end loses its digits.
        near = jax.nn.sigmoid(-jnp.abs(z)) * (high - low)
        q = jnp.where(z < 0.0, low + near, high - near)
        exponential = jnp.exp(jnp.where(self.logarithmic, q, 0.0))
        return jnp.where(self.logarithmic, exponential, q)

    def real(self, p) -> np.ndarray:
        """z of p, for p strictly inside."""
        return logit(self.part(p))

    def part(self, p) -> np.ndarray:
        """Where p lies between its bounds, in q: 0 at the lower, 1 at the upper."""
        low, high = _natural(self, self.lower), _natural(self, self.upper)
        return np.asarray((_natural(self, p) - low) / (high - low))

    def at_part(self, part) -> np.ndarray:
        """p at a part of its range; the inverse of `part`."""
        low, high = _natural(self, self.lower), _natural(self, self.upper)
        q = np.asarray(low + np.asarray(part) * (high - low))
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, q, 0)), q)

    def range(self) -> np.ndarray:
        """Width of the range in the coordinate of the errors: the logarithm, or p in
        units of half its range, so that a standard error of 1 is useless in both."""
        low, high = _natural(self, self.lower), _natural(self, self.upper)
        return np.where(self.logarithmic, high - low, 2.0)

    def slope(self, z) -> np.ndarray:
        """Derivative of the coordinate of the errors by z, positive."""
        near = np.asarray(jax.nn.sigmoid(-jnp.abs(jnp.asarray(z))))
        return self.range() * near * (1.0 - near)

    def bound_reached(self, p) -> list[str | None]:
        """For each parameter "lower", "upper" or None."""
        part = np.asarray(self.part(p))
        near = np.where(
            part < NEAR_BOUND, "lower", np.where(part > 1 - NEAR_BOUND, "upper", "")
        )
        return [str(word) or None for word in near]


def logit(part) -> np.ndarray:
    """z of a part of the range, strictly between 0 and 1."""
    return np.log(part) - np.log1p(-np.asarray(part))


def _natural(bounds: Bounds, p):
    """q of p."""
    logarithm = jnp.log(jnp.where(bounds.logarithmic, p, 1.0))
    return jnp.where(bounds.logarithmic, logarithm, p)

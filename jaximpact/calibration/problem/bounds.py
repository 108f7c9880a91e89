r"""Coordinates in which parameters are fitted, each between two bounds.

The optimiser works on x, and standard errors are stated in it:

$$ x = \ln p \quad\text{or}\quad x = p / h, $$

the first for a parameter that is always positive, so that differences in x are
relative; h is half the range, so that a standard error of 1 is useless in both.
"""

from typing import Any, NamedTuple

import numpy as np

from ..._jax_internals import namespace_of

NEAR_BOUND = 0.01
"""Distance from a bound, as a fraction of the range in x, within which a parameter is
at it."""


class Bounds(NamedTuple):
    """Ranges of the unknowns in the units of their columns, shape (unknowns,)."""

    lower: np.ndarray
    upper: np.ndarray
    logarithmic: np.ndarray
    """Whether x is the logarithm; both bounds are positive then."""

    @property
    def half(self) -> np.ndarray:
        """Half the range."""
        return (self.upper - self.lower) / 2.0

    def coordinate(self, p) -> np.ndarray:
        """Convert p to x, shape (..., unknowns)."""
        p = np.asarray(p, float)
        logarithm = np.log(np.where(self.logarithmic, p, 1.0))
        return np.where(self.logarithmic, logarithm, p / self.half)

    def parameter(self, x) -> np.ndarray:
        """Convert x, of NumPy or JAX, to p."""
        xp = namespace_of(x)
        x = xp.asarray(x, float)
        exponential = xp.exp(xp.where(self.logarithmic, x, 0.0))
        return xp.where(self.logarithmic, exponential, x * self.half)

    def slope(self, x) -> np.ndarray:
        """Compute the derivative of p with respect to x."""
        x = np.asarray(x, float)
        return np.where(self.logarithmic, self.parameter(x), self.half)

    @property
    def low(self) -> np.ndarray:
        """Lower bounds in x."""
        return self.coordinate(self.lower)

    @property
    def high(self) -> np.ndarray:
        """Upper bounds in x."""
        return self.coordinate(self.upper)

    def at_fraction(self, fraction) -> Any:
        """Compute x at a fraction of the range, of NumPy or JAX."""
        return self.low + fraction * (self.high - self.low)

    def fraction(self, x) -> np.ndarray:
        """Compute the position of x in its range; the inverse of `at_fraction`."""
        return (np.asarray(x) - self.low) / (self.high - self.low)

    def bound_reached(self, x) -> list[str | None]:
        """Name the bound that each parameter has reached: "lower", "upper" or None."""
        words = []
        for fraction in np.asarray(self.fraction(x)):
            near = "upper" if fraction > 1 - NEAR_BOUND else None
            words.append("lower" if fraction < NEAR_BOUND else near)
        return words

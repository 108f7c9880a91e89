r"""The coordinates in which parameters are fitted, each between two bounds.

The optimiser works on x, and errors are stated in it:

$$ x = \ln p \quad\text{or}\quad x = p / h, $$

the first for a parameter that is always positive, so that differences in x are relative
ones; h is half the range, so that a standard error of 1 is useless in both.
"""

from typing import NamedTuple

import numpy as np

NEAR_BOUND = 0.01
"""A parameter within this part of its range from a bound, measured in x, is at it."""


class Bounds(NamedTuple):
    """Ranges of the unknowns `(unknowns,)`, in the units of their columns."""

    lower: np.ndarray
    upper: np.ndarray
    logarithmic: np.ndarray
    """Whether x is the logarithm; both bounds are positive then."""

    @property
    def half(self) -> np.ndarray:
        """Half the range."""
        return (self.upper - self.lower) / 2.0

    def coordinate(self, p) -> np.ndarray:
        """x of p, `(..., unknowns)`."""
        p = np.asarray(p, float)
        logarithm = np.log(np.where(self.logarithmic, p, 1.0))
        return np.where(self.logarithmic, logarithm, p / self.half)

    def parameter(self, x) -> np.ndarray:
        """p of x."""
        x = np.asarray(x, float)
        exponential = np.exp(np.where(self.logarithmic, x, 0.0))
        return np.where(self.logarithmic, exponential, x * self.half)

    def slope(self, x) -> np.ndarray:
        """Derivative of p by x."""
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

    def at_part(self, part) -> np.ndarray:
        """x at a part of the range: 0 at the lower bound, 1 at the upper."""
        return self.low + np.asarray(part) * (self.high - self.low)

    def part(self, x) -> np.ndarray:
        """Where x lies in its range; the inverse of `at_part`."""
        return (np.asarray(x) - self.low) / (self.high - self.low)

    def bound_reached(self, x) -> list[str | None]:
        """For each parameter "lower", "upper" or None."""
        words = []
        for part in np.asarray(self.part(x)):
            near = "upper" if part > 1 - NEAR_BOUND else None
            words.append("lower" if part < NEAR_BOUND else near)
        return words

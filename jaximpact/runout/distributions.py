r"""Distributions of random inputs, each by its inverse distribution function.

`values` turns uniform numbers u in (0, 1) into samples, one for one, so that a sample
depends on its own number alone:

$$ x = F^{-1}(u) $$

A distribution with `least` and `most` is truncated there: it has the shape that it
would have without them, and no value beyond.
"""

import math
from typing import NamedTuple

import jax
import numpy as np


class Normal(NamedTuple):
    """Normal distribution, truncated at both ends."""

    mean: float
    sd: float
    """Standard deviation, above 0, before the truncation."""
    least: float = -np.inf
    most: float = np.inf

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        low, high, sign = self._ends()
        inside = low + (high - low) * (uniforms if sign > 0.0 else 1.0 - uniforms)
        standard = sign * np.asarray(jax.scipy.special.ndtri(inside))
        return np.clip(self.mean + self.sd * standard, self.least, self.most)

    @property
    def probability_inside(self) -> float:
        """Probability between the ends; 0 where it is too small for a number."""
        low, high, _ = self._ends()
        return high - low

    def _ends(self) -> tuple[float, float, float]:
        """Give the probabilities below both ends, and 1; or, where both lie above the
        mean, those above them, which keep their digits, and -1."""
        ends = (np.array([self.least, self.most]) - self.mean) / self.sd
        sign = 1.0 if self.least <= self.mean else -1.0
        low, high = np.sort(np.asarray(jax.scipy.special.ndtr(sign * ends)))
        return float(low), float(high), sign


class Uniform(NamedTuple):
    """Uniform distribution between two ends."""

    start: float
    stop: float

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        return self.start + (self.stop - self.start) * uniforms


class Lognormal(NamedTuple):
    r"""Lognormal distribution, truncated at both ends.

    $\ln x \sim N(\ln m, \ln s)$ with the median m and the geometric standard deviation
    s: two thirds of the values lie between $m/s$ and $m s$.
    """

    median: float
    """Median, above 0, before the truncation."""
    geometric_sd: float
    """Geometric standard deviation [-], above 1, before the truncation."""
    least: float = 0.0
    most: float = np.inf

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        # A sample beyond the numbers is inf, which the range of the quantity refuses.
        with np.errstate(over="ignore"):
            values = np.exp(self._logarithm.values(uniforms))
        return np.clip(values, self.least, self.most)

    @property
    def probability_inside(self) -> float:
        """Probability between the ends; 0 where it is too small for a number."""
        return self._logarithm.probability_inside

    @property
    def _logarithm(self) -> Normal:
        ends = (math.log(x) if x > 0.0 else -np.inf for x in (self.least, self.most))
        return Normal(math.log(self.median), math.log(self.geometric_sd), *ends)


class PowerLaw(NamedTuple):
    r"""Power law between two ends, as of the volumes of rockfalls.

    The number of blocks larger than x goes with $x^{-b}$:

    $$ P(X > x) = \frac{x^{-b} - M^{-b}}{L^{-b} - M^{-b}}, \qquad L \le x \le M . $$

    The density goes with $x^{-(b + 1)}$.

    Source: Dussauge, Grasso and Helmstetter (2003), Statistical analysis of rockfall
    volume distributions, doi 10.1029/2001JB000650: b of about 0.5 for cliffs.
    """

    exponent: float
    """Exponent b of the cumulative numbers [-], above 0."""
    least: float
    """Least value L, above 0."""
    most: float
    """Largest value M, above L."""

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        # By logarithms: powers of the ends may be beyond the numbers.
        span = math.log(self.most) - math.log(self.least)
        missing = np.expm1(-self.exponent * span)
        steps = -np.log1p(uniforms * missing) / self.exponent
        return np.clip(self.least * np.exp(steps), self.least, self.most)


Distribution = Normal | Uniform | Lognormal | PowerLaw
"""Any of the distributions."""

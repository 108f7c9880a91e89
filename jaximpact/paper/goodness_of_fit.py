r"""Exponential and normal distributions fitted by maximum likelihood, and how near they
come.

The distance is Kolmogorov's: the largest difference between the distribution function
of the numbers and the fitted one. Where the numbers are drawn from such a distribution,
5 % of the samples of n lie farther from their own fit than

$$ D_5 = \frac{0.2}{n} + \frac{1.094}{\sqrt n + 0.26 + 0.5/\sqrt n}, \qquad
   D_5 = \frac{0.895}{\sqrt n - 0.01 + 0.85/\sqrt n} $$

for the exponential and the normal one. Many numbers tell any model from what they were
drawn from: then it is the distance itself that says how good the fit is.

Source: Stephens (1974), EDF statistics for goodness of fit and some comparisons.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

SOME = 2
"""Numbers that a fit needs at the least."""


class Fit(NamedTuple):
    """A fitted distribution; NaN where there are fewer than two different numbers."""

    start: float
    """Mean of a normal distribution; where an exponential one begins."""
    scale: float
    """Standard deviation, or mean beyond the start."""
    distance: float
    """Kolmogorov's [-]."""
    distance_by_chance: float
    """What it exceeds in 5 of 100 cases if the numbers are so distributed."""
    count: int

    @property
    def mean(self) -> float:
        """Mean of an exponential distribution."""
        return self.start + self.scale


def fit_exponential(values) -> Fit:
    r"""The density $\exp(-(x - x_0)/s)/s$ from the least of the numbers on, $x_0$."""
    values = np.sort(np.asarray(values, float))
    n = len(values)
    if n < SOME or values[0] == values[-1]:
        return _nothing(n)
    start = values[0]
    scale = float(np.mean(values - start))
    distance = _distance(1.0 - np.exp(-(values - start) / scale))
    root = np.sqrt(n)
    chance = 0.2 / n + 1.094 / (root + 0.26 + 0.5 / root)
    return Fit(float(start), scale, distance, chance, n)


def fit_normal(values) -> Fit:
    """Mean and standard deviation."""
    values = np.sort(np.asarray(values, float))
    n = len(values)
    if n < SOME or values[0] == values[-1]:
        return _nothing(n)
    mean, scale = float(np.mean(values)), float(np.std(values))
    distance = _distance(ndtr((values - mean) / scale))
    root = np.sqrt(n)
    chance = 0.895 / (root - 0.01 + 0.85 / root)
    return Fit(mean, scale, distance, chance, n)


def _distance(expected: np.ndarray) -> float:
    """Kolmogorov's distance, by the fitted distribution function at sorted numbers."""
    n = len(expected)
    ranks = np.arange(n + 1) / n
    return float(np.max(np.maximum(expected - ranks[:-1], ranks[1:] - expected)))


def _nothing(count: int) -> Fit:
    return Fit(np.nan, np.nan, np.nan, np.nan, count)

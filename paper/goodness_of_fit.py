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

FEWEST = 2
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
    """Distance exceeded in 5 of 100 cases if the numbers are so distributed."""
    count: int

    @property
    def mean(self) -> float:
        """Mean of an exponential distribution."""
        return self.start + self.scale


def fit_exponential(values) -> Fit:
    r"""Fit the density $\exp(-(x - x_0)/s)/s$ from the least of the numbers on,
    $x_0$."""
    return _fit(
        values,
        np.min,
        lambda values, start: np.mean(values - start),
        lambda scaled: 1.0 - np.exp(-scaled),
        lambda n, root: 0.2 / n + 1.094 / (root + 0.26 + 0.5 / root),
    )


def fit_normal(values) -> Fit:
    """Fit mean and standard deviation."""
    return _fit(
        values,
        np.mean,
        lambda values, start: np.std(values),
        ndtr,
        lambda n, root: 0.895 / (root - 0.01 + 0.85 / root),
    )


def _fit(values, start_of, scale_of, distribution, distance_by_chance) -> Fit:
    """Make a fit by functions: of the numbers, of these and the start, of the distance
    from the start over the scale, and of the count and its root."""
    values = np.sort(np.asarray(values, float))
    n = len(values)
    if n < FEWEST or values[0] == values[-1]:
        return Fit(np.nan, np.nan, np.nan, np.nan, n)
    start = float(start_of(values))
    scale = float(scale_of(values, start))
    expected = distribution((values - start) / scale)
    ranks = np.arange(n + 1) / n
    distance = np.max(np.maximum(expected - ranks[:-1], ranks[1:] - expected))
    return Fit(start, scale, float(distance), distance_by_chance(n, np.sqrt(n)), n)

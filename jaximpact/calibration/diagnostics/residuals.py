"""Studentised residuals, and tests for trends in them.

A residual is (measured - predicted) / (s sigma), divided by sqrt(1 - h) with h its
leverage. If the model is right residuals are normal, of variance 1 and independent of
every input.
"""

from typing import NamedTuple

import numpy as np

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import ndtr, ndtri, stdtr

from ..problem.objective import Objective, Points
from .uncertainty import leverages

FEWEST = 8
"""Least number of different values of an input for a test of trend."""
IMPROBABLE = 0.05
"""Probability, over all tests of trend, that one is significant by chance."""
LARGE = 3.0
"""Residuals [standard deviations] above which a test is named."""
NOTHING = 0.01
"""Standard deviations below which residuals are errors of the integration."""
LEAST_LEFT = 1e-6
"""Least 1 - h: a measurement of leverage 1 has no residual."""


class Trend(NamedTuple):
    """Trend of the residuals of a target with an input."""

    target: str
    against: str
    correlation: float
    """Spearman's rank correlation."""
    autocorrelation: float
    """Lag-1 autocorrelation: 1 - half of von Neumann's ratio of the ranks."""
    chance: float
    """p-value of the more significant of the two."""


class Residuals(NamedTuple):
    """Residuals of all exact measurements, shape (tests, targets); NaN elsewhere."""

    values: np.ndarray
    """Studentised residuals [standard deviations]."""
    leverage: np.ndarray
    """Leverage of each measurement."""
    trends: list[Trend]
    """Significant trends, the smallest p-value first."""
    looked_for: int
    """Number of tests of trend: two for each target and input."""

    def ordered(self) -> tuple[np.ndarray, np.ndarray]:
        """Return normal quantiles and the ascending residuals of a Q-Q plot."""
        values = np.sort(self.values[np.isfinite(self.values)])
        part = (np.arange(len(values)) + 0.5) / max(len(values), 1)
        return ndtri(part), values


def residuals_of(objective: Objective, points: Points, inflation: float) -> Residuals:
    """Compute the residuals at a fit (points of one lane)."""
    study = objective.study
    predicted = points.predicted[0]
    exact = study.exact & np.isfinite(predicted)
    leverage = leverages(objective, points)
    left = 1.0 - leverage
    scale = objective.sigma * np.sqrt(inflation * np.maximum(left, LEAST_LEFT))
    there = exact & (left > LEAST_LEFT)
    values = np.where(there, (study.measured - predicted) / scale, np.nan)
    trends, count = _trends(objective, values, predicted)
    return Residuals(values, np.where(exact, leverage, np.nan), trends, count)


def varying_inputs(objective: Objective) -> dict[str, np.ndarray]:
    """Find the columns of the scene that differ among the tests."""
    inputs = objective.study.tests.inputs.items()
    return {name: v for name, v in inputs if np.nanmax(v) > np.nanmin(v)}


def _trends(objective: Objective, values, predicted) -> tuple[list[Trend], int]:
    study, found, count = objective.study, [], 0
    for place, target in enumerate(study.targets):
        there = np.isfinite(values[:, place])
        if not np.any(np.abs(values[there, place]) > NOTHING):
            continue
        against = varying_inputs(objective) | {"prediction": predicted[:, place]}
        for name, along in against.items():
            x, back = np.unique(along[there], return_inverse=True)
            if len(x) < FEWEST:
                continue
            # Residuals at one value of the input have no order: their mean is taken.
            mean = np.bincount(back, values[there, place]) / np.bincount(back)
            correlation, chance = _rank_correlation(mean)
            autocorrelation, other = _autocorrelation(mean)
            count += 2
            trend = correlation, autocorrelation, float(min(chance, other))
            found.append(Trend(target, name, *trend))
    trends = [trend for trend in found if trend.chance * count < IMPROBABLE]
    return sorted(trends, key=lambda trend: trend.chance), count


def _ranks(values: np.ndarray) -> np.ndarray:
    """Rank values from 1; equal ones get the mean rank."""
    _, back, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - 0.5 * (count - 1))[back]


def _rank_correlation(values: np.ndarray) -> tuple[float, float]:
    """Compute Spearman's correlation with the order, and its p-value by Student's
    distribution."""
    ranks, freedom = _ranks(values), len(values) - 2
    correlation = float(np.corrcoef(np.arange(len(ranks)), ranks)[0, 1])
    left = max((1.0 - correlation) * (1.0 + correlation), 0.0)
    deviation = abs(correlation) * np.sqrt(freedom / left) if left else np.inf
    return correlation, float(2.0 * stdtr(freedom, -deviation))


def _autocorrelation(values: np.ndarray) -> tuple[float, float]:
    """Compute the lag-1 autocorrelation of ranks and its p-value (Bartels 1982)."""
    ranks, count = _ranks(values), len(values)
    ratio = np.sum(np.diff(ranks) ** 2) / np.sum((ranks - np.mean(ranks)) ** 2)
    # Bartels's approximation of the ratio's distribution: normal, mean 2.
    variance = 20.0 / (5.0 * count + 7.0)
    return float(1.0 - 0.5 * ratio), float(ndtr((ratio - 2.0) / np.sqrt(variance)))


def in_words(residuals: Residuals, objective: Objective) -> list[str]:
    """Describe trends and large residuals."""
    study, lines = objective.study, []
    for trend in residuals.trends:
        lines.append(
            f"The residuals of {trend.target} depend on {trend.against}: rank "
            f"correlation {trend.correlation:+.2f}, lag-1 autocorrelation "
            f"{trend.autocorrelation:+.2f}, p-value {trend.chance:.1g}."
        )
    if not residuals.trends and residuals.looked_for:
        lines.append(
            "No significant trend with the prediction or with any input that varies."
        )
    large = np.abs(np.nan_to_num(residuals.values)) > LARGE
    for test, place in zip(*np.nonzero(large), strict=True):
        value = residuals.values[test, place]
        lines.append(
            f"{study.targets[place]} of {study.tests.name(test)} lies {abs(value):.2g} "
            f"standard deviations {'above' if value > 0.0 else 'below'} the fit."
        )
    return lines

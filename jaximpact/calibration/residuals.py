"""What the fit leaves over, and whether it follows anything.

A residual is (measured - predicted) / (s sigma), and studentised by its leverage h,
which the fit takes up of it: divided by sqrt(1 - h). Where the model is right they are
normal, of variance 1, and follow nothing.
"""

from typing import NamedTuple

import numpy as np

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import ndtr, ndtri, stdtr

from .objective import Objective, Points
from .uncertainty import leverages

FEWEST = 8
"""Different values of an input in which a trend is looked for."""
IMPROBABLE = 0.05
"""Chance, over all trends looked for, that one is found where there is none."""
LARGE = 3.0
"""Residuals beyond are named."""
NOTHING = 0.01
"""Standard deviations below which residuals are those of the integration, not of the
model."""
LEAST_LEFT = 1e-6
"""Least of 1 - h: a measurement that the fit takes up wholly has no residual."""


class Trend(NamedTuple):
    """Residuals of a target that follow an input."""

    target: str
    against: str
    correlation: float
    """Spearman's."""
    likeness: float
    """Of neighbours: 1 - half of von Neumann's ratio of the ranks, 0 for none."""
    chance: float
    """That the more improbable of the two is as large where there is neither."""


class Residuals(NamedTuple):
    """Of every measurement that is no limit, `(tests, targets)`; NaN elsewhere."""

    values: np.ndarray
    """Studentised."""
    leverage: np.ndarray
    """Degrees of freedom that the fit takes up of each measurement."""
    trends: list[Trend]
    """That chance does not explain, the least probable first."""
    looked_for: int
    """How many were looked for: two to a target and an input."""

    def ordered(self) -> tuple[np.ndarray, np.ndarray]:
        """Quantiles of the normal distribution, and the residuals in ascending order:
        what a Q-Q plot draws."""
        values = np.sort(self.values[np.isfinite(self.values)])
        part = (np.arange(len(values)) + 0.5) / max(len(values), 1)
        return ndtri(part), values


def residuals_of(objective: Objective, points: Points, inflation: float) -> Residuals:
    """Residuals at a fit (points of one lane)."""
    study = objective.study
    predicted = points.predicted[0]
    exact = study.known & (study.censored == 0) & np.isfinite(predicted)
    leverage = leverages(objective, points)
    left = 1.0 - leverage
    scale = objective.sigma * np.sqrt(inflation * np.maximum(left, LEAST_LEFT))
    there = exact & (left > LEAST_LEFT)
    values = np.where(there, (study.measured - predicted) / scale, np.nan)
    trends, count = _trends(objective, values, predicted)
    return Residuals(values, np.where(exact, leverage, np.nan), trends, count)


def varying_inputs(objective: Objective) -> dict[str, np.ndarray]:
    """Columns of the scene that differ among the tests."""
    inputs = objective.study.tests.inputs
    return {name: values for name, values in inputs.items() if np.ptp(values) > 0.0}


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
            # Those at one value have no order.
            mean = np.bincount(back, values[there, place]) / np.bincount(back)
            correlation, chance = _rank_correlation(mean)
            likeness, other = _likeness(mean)
            count += 2
            trend = correlation, likeness, float(min(chance, other))
            found.append(Trend(target, name, *trend))
    trends = [trend for trend in found if trend.chance * count < IMPROBABLE]
    return sorted(trends, key=lambda trend: trend.chance), count


def _ranks(values: np.ndarray) -> np.ndarray:
    """From 1; equal values share the mean of theirs."""
    _, back, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - 0.5 * (count - 1))[back]


def _rank_correlation(values: np.ndarray) -> tuple[float, float]:
    """Spearman's, with the order in which they stand, and the chance of as much by
    Student's distribution."""
    ranks, freedom = _ranks(values), len(values) - 2
    correlation = np.corrcoef(np.arange(len(ranks)), ranks)[0, 1]
    left = max((1.0 - correlation) * (1.0 + correlation), 0.0)
    if left == 0.0:
        return float(correlation), 0.0
    deviation = abs(correlation) * np.sqrt(freedom / left)
    return float(correlation), float(2.0 * stdtr(freedom, -deviation))


def _likeness(values: np.ndarray) -> tuple[float, float]:
    """How alike neighbours are, and the chance of as much (Bartels 1982)."""
    ranks = _ranks(values)
    count = len(ranks)
    ratio = np.sum(np.diff(ranks) ** 2) / np.sum((ranks - np.mean(ranks)) ** 2)
    # Bartels's approximation of the ratio's distribution: normal, mean 2.
    variance = 20.0 / (5.0 * count + 7.0)
    return float(1.0 - 0.5 * ratio), float(ndtr((ratio - 2.0) / np.sqrt(variance)))


def in_words(residuals: Residuals, objective: Objective) -> list[str]:
    """What stands out."""
    study, lines = objective.study, []
    for trend in residuals.trends:
        lines.append(
            f"The residuals of {trend.target} follow {trend.against}: rank correlation "
            f"{trend.correlation:+.2f}, likeness of neighbours {trend.likeness:+.2f}, "
            f"chance {trend.chance:.1g}. The model misses something, and errors that "
            "take the misfit for random are too small."
        )
    if not residuals.trends and residuals.looked_for:
        lines.append(
            "They follow neither prediction nor any input that differs, beyond chance."
        )
    large = np.abs(np.nan_to_num(residuals.values)) > LARGE
    for test, place in zip(*np.nonzero(large), strict=True):
        value = residuals.values[test, place]
        lines.append(
            f"{study.targets[place]} of {study.tests.name(test)} lies {abs(value):.2g} "
            f"standard deviations {'above' if value > 0.0 else 'below'} the fit."
        )
    return lines

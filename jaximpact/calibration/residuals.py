"""What the fit leaves over, and whether it follows anything.

A residual is (measured - predicted) / (s sigma), and studentised by its leverage h,
which the fit takes up of it: divided by sqrt(1 - h). Where the model is right they are
normal, of variance 1, and follow nothing.
"""

from typing import NamedTuple

import numpy as np
from scipy.stats import norm, spearmanr

from .objective import Objective, Points
from .uncertainty import leverages

FEWEST = 6
"""Measurements that a trend is looked for in."""
IMPROBABLE = 0.05
"""Chance, over all trends looked for, that one is found where there is none."""
LARGE = 3.0
"""Residuals beyond are named."""
LEAST_LEFT = 1e-6
"""Least of 1 - h: a measurement that the fit takes up wholly has no residual."""


class Trend(NamedTuple):
    """Residuals of a target that follow an input."""

    target: str
    against: str
    correlation: float
    """Spearman's."""
    chance: float
    """That it is as large where there is none."""


class Residuals(NamedTuple):
    """Of every measurement that is no limit, `(tests, targets)`; NaN elsewhere."""

    values: np.ndarray
    """Studentised."""
    leverage: np.ndarray
    """Degrees of freedom that the fit takes up of each measurement."""
    trends: list[Trend]
    """That chance does not explain, the least probable first."""
    looked_for: int
    """How many trends were looked for."""

    def ordered(self) -> tuple[np.ndarray, np.ndarray]:
        """Quantiles of the normal distribution, and the residuals in ascending order:
        what a Q-Q plot draws."""
        values = np.sort(self.values[np.isfinite(self.values)])
        part = (np.arange(len(values)) + 0.5) / max(len(values), 1)
        return norm.ppf(part), values


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
        of_target = values[:, place]
        there = np.isfinite(of_target)
        if np.sum(there) < FEWEST:
            continue
        against = varying_inputs(objective) | {"prediction": predicted[:, place]}
        for name, along in against.items():
            if len(np.unique(along[there])) < 3:
                continue
            count += 1
            correlation, chance = spearmanr(along[there], of_target[there])
            found.append(Trend(target, name, float(correlation), float(chance)))
    trends = [trend for trend in found if trend.chance * count < IMPROBABLE]
    return sorted(trends, key=lambda trend: trend.chance), count


def in_words(residuals: Residuals, objective: Objective) -> list[str]:
    """What stands out."""
    study, lines = objective.study, []
    for trend in residuals.trends:
        way = "grow" if trend.correlation > 0.0 else "fall"
        lines.append(
            f"The residuals of {trend.target} {way} with {trend.against} (Spearman's "
            f"correlation {trend.correlation:+.2f}, chance {trend.chance:.1g}): the "
            "model misses something, and errors that take the scatter for random are "
            "too small."
        )
    if not residuals.trends and residuals.looked_for:
        lines.append(
            f"None of {residuals.looked_for} trends looked for, against inputs and "
            "prediction, is beyond chance."
        )
    large = np.abs(np.nan_to_num(residuals.values)) > LARGE
    for test, place in zip(*np.nonzero(large), strict=True):
        value = residuals.values[test, place]
        lines.append(
            f"{study.targets[place]} of {study.tests.name(test)} lies {abs(value):.2g} "
            f"standard deviations {'above' if value > 0.0 else 'below'} the fit."
        )
    return lines

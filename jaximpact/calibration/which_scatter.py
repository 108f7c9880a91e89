r"""Whether residuals speak for the other kind of scatter than a study takes.

Of n residuals e, each freed of the part that the fit takes up of it, and the sizes z of
what the fit predicts (`proportional`), the largest Gaussian log-likelihoods differ by

$$ \ln \frac{L_p}{L_c} = \frac{n}{2} \left( \ln \overline{e^2} -
   \ln \overline{(e / z)^2} \right) - \sum_i \ln z_i . $$

Either has one number that is estimated. Where all z are alike it is 0.
"""

from collections.abc import Collection

import numpy as np

from .losses import LOSSES
from .objective import Objective, Points
from .proportional import CONSTANT, PROPORTIONAL, least_size
from .scatter import LEAST_PART
from .uncertainty import LEAST_LEFT, leverages

FEWEST = 8
"""Measurements of a target from which they can tell."""
CLEARLY = 3.0
"""Difference of the logarithms that is told: 20 to 1."""
MOST_TIMES = 1e3
"""Beyond which nobody asks how many times."""


def doubtful_scatter(
    objective: Objective, points: Points, astray: Collection[str] = ()
) -> list[str]:
    """What to set instead, of every target whose residuals clearly say so.

    Of exact measurements alone, all predicted with one sign, and of Gaussian losses: an
    outlier, which a robust one puts up with, would speak for whatever it is far out of.

    Args:
        points: the best fit, of one lane.
        astray: targets that are passed over, for their residuals follow something: they
            are what the model misses, not scatter.
    """
    study = objective.study
    if study.loss != LOSSES[0]:
        return []
    predicted = points.predicted[0]
    left = 1.0 - leverages(objective, points)
    exact = study.known & (study.censored == 0) & np.isfinite(predicted)
    least = least_size(study.measured)
    lines = []
    for place in np.flatnonzero(~study.sigma_given):
        if study.targets[place] in astray:
            continue
        told = exact[:, place] & (left[:, place] > LEAST_LEFT)
        value, measured = predicted[told, place], study.measured[told, place]
        if len(value) < FEWEST or np.min(value) * np.max(value) <= 0.0:
            continue
        residual = (measured - value) / np.sqrt(left[told, place])
        size = np.maximum(np.abs(value), least[place])
        if np.sum(residual**2) <= LEAST_PART**2 * np.sum(size**2):
            continue  # the integration's errors, no scatter
        for_proportional = log_ratio(residual, size)
        is_proportional = study.proportional[place]
        against = -for_proportional if is_proportional else for_proportional
        if against > CLEARLY:
            lines.append(_words(study.targets[place], is_proportional, against))
    return lines


def log_ratio(residual: np.ndarray, size: np.ndarray) -> float:
    """ln(L_p / L_c), above 0 where the residuals speak for proportional scatter."""
    squares = np.mean(residual**2), np.mean((residual / size) ** 2)
    half = 0.5 * len(residual)
    return float(half * np.log(squares[0] / squares[1]) - np.sum(np.log(size)))


def _words(name: str, is_proportional: bool, against: float) -> str:
    times = float(np.exp(min(against, np.log(MOST_TIMES))))
    chance = f"{times:.0f} times as probable"
    if against > np.log(MOST_TIMES):
        chance = f"more than {MOST_TIMES:g} times as probable"
    if is_proportional:
        return (
            f"The residuals of {name} do not grow with its value: constant scatter is "
            f'{chance} as one in proportion to it. Set scatter.{name} = "{CONSTANT}".'
        )
    return (
        f"The residuals of {name} grow with its value: scatter in proportion to it is "
        f'{chance} as a constant one. Set scatter.{name} = "{PROPORTIONAL}".'
    )

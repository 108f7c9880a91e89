r"""Constant or proportional scatter, as the residuals of a fit tell.

It is tested by the ratio of the largest Gaussian likelihoods. With n residuals e, each
over the root of 1 - leverage, and the sizes z of the predictions (`problem.noise`),

$$ \ln \frac{L_p}{L_c} = \frac{n}{2} \left( \ln \overline{e^2} -
   \ln \overline{(e / z)^2} \right) - \sum_i \ln z_i ; $$

either kind has one number that is estimated. Where all z are equal it is 0.
"""

from collections.abc import Collection

import numpy as np

from ..estimation.sigma import LEAST_PART, leverages
from ..problem.noise import CONSTANT, LOSSES, PROPORTIONAL
from ..problem.objective import Objective, Points
from .uncertainty import LEAST_LEFT

FEWEST = 8
"""Least number of measurements that show the kind of scatter."""
CLEAR = 3.0
"""Logarithm of the likelihood ratio, 20 to 1, from which it is taken as shown."""


def evidence_of_proportional(objective: Objective, points: Points) -> np.ndarray:
    """Compute ln(L_p / L_c) of each target at a fit (points of one lane); 0 where the
    residuals cannot tell.

    Only exact measurements count, all predicted with one sign, and only Gaussian
    losses: an outlier, which a robust loss tolerates, would decide the ratio.
    """
    study = objective.study
    evidence = np.zeros(len(study.targets))
    if study.loss != LOSSES[0]:
        return evidence
    predicted = points.predicted[0]
    left = 1.0 - leverages(objective, points)
    used = study.exact & np.isfinite(predicted) & (left > LEAST_LEFT)
    least = study.least_size
    stated = study.sigma_given | np.isin(study.targets, study.understated)
    for target in np.flatnonzero(~stated):
        cells = used[:, target]
        value, measured = predicted[cells, target], study.measured[cells, target]
        if len(value) < FEWEST or np.min(value) * np.max(value) <= 0.0:
            continue
        residual = (measured - value) / np.sqrt(left[cells, target])
        size = np.maximum(np.abs(value), least[target])
        if np.sum(residual**2) > LEAST_PART**2 * np.sum(size**2):
            evidence[target] = log_ratio(residual, size)
        # Less is errors of the integration, and no scatter.
    return evidence


def log_ratio(residual: np.ndarray, size: np.ndarray) -> float:
    """Compute ln(L_p / L_c), above 0 where residuals support proportional scatter."""
    squares = np.mean(residual**2), np.mean((residual / size) ** 2)
    half = 0.5 * len(residual)
    return float(half * np.log(squares[0] / squares[1]) - np.sum(np.log(size)))


def doubtful_scatter(
    objective: Objective, points: Points, biased: Collection[str] = ()
) -> list[str]:
    """Warn of targets whose residuals clearly show the other kind of scatter.

    Targets that are `biased` are skipped: what has a trend is misfit, not scatter.
    """
    study, lines = objective.study, []
    for target, evidence in enumerate(evidence_of_proportional(objective, points)):
        name, is_proportional = study.targets[target], study.proportional[target]
        against = -evidence if is_proportional else evidence
        if name not in biased and against > CLEAR:
            lines.append(_in_words(name, is_proportional, against))
    return lines


def chosen_in_words(objective: Objective, points: Points) -> list[str]:
    """Say which kind of scatter a fit chose for targets of which nobody stated it."""
    study, lines = objective.study, []
    for target, evidence in enumerate(evidence_of_proportional(objective, points)):
        name = study.targets[target]
        if name in study.scatter_open and study.proportional[target]:
            lines.append(
                f"The values of {name} span more than a decade: its scatter was taken "
                f"in proportion to the value, which is {_times(evidence)} times as "
                f'probable as a constant one. Set scatter.{name} = "{CONSTANT}" to '
                "have that."
            )
    return lines


def _times(evidence: float) -> str:
    more = evidence > np.log(1e3)
    return "more than 1000" if more else f"{np.exp(max(evidence, 0.0)):.2g}"


def _in_words(name: str, is_proportional: bool, against: float) -> str:
    times = _times(against)
    if is_proportional:
        return (
            f"The residuals of {name} do not grow with its value: constant scatter is "
            f"{times} times as probable as one in proportion to it. Set "
            f'scatter.{name} = "{CONSTANT}".'
        )
    return (
        f"The residuals of {name} grow with its value: scatter in proportion to it is "
        f"{times} times as probable as a constant one. Set "
        f'scatter.{name} = "{PROPORTIONAL}".'
    )

r"""Tests predicted from the others: left out one by one, or campaign by campaign.

The fit to the rest starts at the best fit to all. Its prediction y of a test that was
left out has the standard deviation

$$ \sqrt{s^2 \sigma^2 + J C J^T} , $$

with C the covariance of the rest, the bounds a weak prior, and J the derivative of y.
Sigmas that were estimated, and the inflation s^2, are those of the whole fit; a sigma
that is a part of the value is the same part of what the rest predicts. Impacts are
computed at "balanced" where their errors are small beside the sigmas.

One Gauss-Newton step from the best fit to all tells roughly where the rest would lead.
It is taken for the fit where it is less than a fifth of a standard error of every soil
parameter, and of more than `AT_MOST` tests that move the fit farther for those that
move it least.
"""

from typing import NamedTuple

import numpy as np

from .chance import too_few
from .fit import fit, no_finer_than_sigmas
from .least_squares import Progress, bounded_step
from .objective import Objective, Points
from .scatter import sizes
from .stopping import Patience, Reason
from .uncertainty import CONFIDENCE, Uncertainty, regular_covariance

AT_MOST = 60
"""Fits that are made without a test."""
LEFT_OUT = Patience(
    1e-4, 1e-4, 1e-3, 1e-2, rejected=8, flat=1e-3, steps=40, joins=False
)
"""A hundredth of a standard error, which is less than the error of J C J^T. Each is a
fit to other data, so that none joins another."""
SMALL_STEP = 0.2
"""Standard errors. What such a step lacks to the fit is a part of it, and moves a
prediction by a part of that part of its error."""
OTHER_STARTS = 4
"""Ends of other starts from which the rest of a campaign's tests is fitted too."""


class LeftOut(NamedTuple):
    """What the others say of the tests that were left out, group by group."""

    groups: tuple[str, ...]
    group: np.ndarray
    """Place of each test's group, `(tests,)`; -1 for one without a measurement."""
    x: np.ndarray
    """Fits to the rest, `(groups, unknowns)`."""
    reasons: list[Reason]
    """Why each of them stopped."""
    moved: np.ndarray
    """How far the fit moves, in standard errors of the whole, along each unknown,
    `(groups, unknowns)`; NaN along one of no influence."""
    predicted: np.ndarray
    """Of each test by the rest, `(tests, targets)`; NaN where there is none."""
    deviation: np.ndarray
    """Standard deviation of a measurement about that, likewise."""
    quantile: float
    """Deviations to either side that make a band of 95 %."""

    def standardised(self, measured: np.ndarray) -> np.ndarray:
        """Measured less predicted, over the deviation."""
        return (measured - self.predicted) / self.deviation

    def inside(self, measured: np.ndarray) -> np.ndarray:
        """Which measurements lie in their bands of 95 %."""
        return np.abs(self.standardised(measured)) <= self.quantile


def leave_out_each(
    objective: Objective,
    points: Points,
    uncertainty: Uncertainty,
    *,
    at_most: int = AT_MOST,
    progress: Progress = lambda text: None,
) -> LeftOut:
    """Leave out one test after the other.

    Args:
        objective: with the sigmas of the fit.
        points: the best fit, of one lane.
        uncertainty: of the fit.
        at_most: fits to be made.
        progress: called with a line of text for each.

    Tests without a measurement are passed over.
    """
    study = objective.study
    measured = np.flatnonzero(np.any(study.known, axis=1))
    group = np.full(len(study.tests), -1)
    group[measured] = np.arange(len(measured))
    each = np.eye(len(study.tests), dtype=bool)[measured]
    steps = linearised(objective, points, each)
    soil = len(study.parameters)
    far = np.max(np.abs(steps / uncertainty.standard_errors)[:, :soil], axis=1)
    fitted = far > SMALL_STEP
    fitted[np.argsort(-far, kind="stable")[at_most:]] = False
    steps[fitted] = np.nan
    names = tuple(study.tests.name(test) for test in measured)
    starts = points.x[0][None]
    return _leave_out(
        objective, points, uncertainty, names, group, starts, steps, "tests", progress
    )


def leave_out_campaigns(
    objective: Objective,
    points: Points,
    uncertainty: Uncertainty,
    ends: np.ndarray | None = None,
    *,
    progress: Progress = lambda text: None,
) -> LeftOut | None:
    """Leave out one campaign after the other; None where there is one alone.

    Args:
        ends: of other starts, `(starts, unknowns)` in x, best first; the rest is fitted
            from the first few too, for without a campaign another minimum may be best.
    """
    labels = objective.study.tests.labels["campaign"]
    names = tuple(dict.fromkeys(labels))
    if len(names) < 2:
        return None
    group = np.array([names.index(label) for label in labels])
    starts = points.x[0][None]
    if ends is not None:
        starts = np.concatenate([starts, ends[:OTHER_STARTS]])
    steps = np.full((len(names), points.x.shape[1]), np.nan)
    return _leave_out(
        *(objective, points, uncertainty, names, group, starts, steps),
        *("campaigns", progress),
    )


def linearised(objective: Objective, points: Points, left: np.ndarray) -> np.ndarray:
    """Step in x to where the rest would lead, `(groups, unknowns)`, by one Gauss-Newton
    step.

    Args:
        left: which tests are left out, `(groups, tests)`.
    """
    bounds, x = objective.bounds, points.x
    steps = []
    for tests in left:
        rest = objective.without(tests).reweigh(points)
        free = np.ones(x.shape, bool)
        step, _ = bounded_step(rest, free, bounds.low - x, bounds.high - x, np.zeros(1))
        steps.append(step[0])
    return np.array(steps)


def _leave_out(
    objective, points, uncertainty, names, group, starts, steps, what, progress
) -> LeftOut:
    """Leave out one group after the other: by its step, or by a fit where that is
    NaN."""
    study, size = objective.study, points.x.shape[1]
    predicted = np.full(study.measured.shape, np.nan)
    deviation = np.full(study.measured.shape, np.nan)
    ends, reasons = np.empty((len(names), size)), []
    of_whole = sizes(study, points.predicted[0])
    coarser = no_finer_than_sigmas(objective)
    errors = uncertainty.standard_errors
    for number, step in enumerate(steps):
        progress(f"{what} left out: {number} of {len(names)}")
        tests = group == number
        if np.all(np.isfinite(step)):
            rest, reason = objective.without(tests), Reason.converged
            best = _moved(rest, points, step)
        else:
            rest = coarser.without(tests)
            fits = fit(rest, starts, patience=LEFT_OUT)
            best, reason = fits.points.take([fits.best]), fits.reasons[fits.best]
        covariance = regular_covariance(rest, best, uncertainty.inflation)
        rows = best.jacobian[0, tests]
        variance = np.einsum("rtp,pq,rtq->rt", rows, covariance, rows)
        predicted[tests] = best.predicted[0, tests]
        part = sizes(study, best.predicted[0]) / of_whole
        scatter = (objective.sigma * part) ** 2 * uncertainty.inflation
        deviation[tests] = np.sqrt(scatter[tests] + variance)
        ends[number] = best.x[0]
        reasons.append(reason)
    moved = (ends - points.x[0]) / np.where(errors < 1e6, errors, np.nan)
    return LeftOut(
        names,
        group,
        ends,
        reasons,
        moved,
        predicted,
        deviation,
        uncertainty.quantile,
    )


def _moved(objective: Objective, points: Points, step: np.ndarray) -> Points:
    """Points of one lane a step further, the model taken to be linear."""
    x, predicted = points.x + step, points.predicted + points.jacobian @ step
    return objective.weigh(x, predicted, points.outcomes, points.jacobian)


def in_words(left: LeftOut, objective: Objective, what: str) -> list[str]:
    """How well the rest predicts what was left out.

    Args:
        what: was left out: "test" or "campaign".
    """
    study = objective.study
    exact = study.known & (study.censored == 0) & (left.group >= 0)[:, None]
    there = exact & np.isfinite(left.predicted)
    lines = []
    if np.any(there):
        inside = int(np.sum(left.inside(study.measured) & there))
        count = int(np.sum(there))
        lines.append(
            f"{inside} of {count} measurements lie in the band of "
            f"{100 * CONFIDENCE:g} % that the fit without their {what} gives them."
        )
        if too_few(inside, count, CONFIDENCE):
            lines.append(
                f"That is fewer than chance allows: the fit does not predict a new "
                f"{what} as well as its errors say."
            )
    limits = study.known & (study.censored != 0) & np.isfinite(left.predicted)
    if np.any(limits):
        apart = (left.predicted - study.measured) * study.censored
        kept = int(np.sum(limits & (apart >= 0.0)))
        lines.append(
            f"{kept} of {int(np.sum(limits))} limits are kept by the fit without their "
            f"{what}."
        )
    missing = int(np.sum(exact & ~np.isfinite(left.predicted)))
    if missing:
        lines.append(f"{missing} of them cannot be predicted without their {what}.")
    lost = [
        name
        for name, reason in zip(left.groups, left.reasons, strict=True)
        if not reason.at_minimum
    ]
    if lost:
        lines.append(f"The fit without {', '.join(lost)} came to no minimum.")
    return lines

r"""Cross-validation: tests or campaigns predicted by a fit without them.

The fit to the rest starts at the best fit to all. Its prediction y of a test that was
left out has the standard deviation

$$ \sqrt{s^2 \sigma^2 + J C J^T} , $$

with C the covariance of the rest, the bounds a weak prior, and J the derivative of y.
Estimated sigmas and the inflation s^2 are those of the whole fit; a proportional sigma
is the same fraction of what the rest predicts. Impacts are computed at "balanced" where
their errors are small beside the sigmas.

One Gauss-Newton step from the best fit replaces the fit to the rest where it is less
than a fifth of a standard error of every unknown; where more than `AT_MOST`
tests move the fit farther, also for those of them that move it least.
"""

import itertools
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import bdtr

from ...progress import tell, within
from ..estimation.least_squares import Reason, Tolerance, bounded_step, fit
from ..estimation.sigma import LEAST_LEFT, hat, sizes
from ..problem.objective import Objective, Points
from .posterior import root_of, variances
from .uncertainty import CONFIDENCE, Uncertainty, regular_covariance

AT_MOST = 60
"""Largest number of fits without a test."""
LEFT_OUT = Tolerance(promise=1e-3, step=1e-4, evaluations=40)
"""Where fits to the rest may end: a twentieth of a standard error, below the error of
J C J^T."""
SMALL_STEP = 0.2
"""Standard errors below which a Gauss-Newton step replaces the fit: what it lacks is a
fraction of it, and moves a prediction by a fraction of its error."""


def too_few(inside: int, count: int, confidence: float) -> bool:
    """Test whether fewer intervals hold their measurement than chance allows.

    The probability of so few among `count` independent intervals of `confidence` each
    is below 2 %.
    """
    return bool(bdtr(inside, count, confidence) < 0.02)


class LeftOut(NamedTuple):
    """Predictions of tests by the fit to the others, group by group."""

    groups: tuple[str, ...]
    """Names of the groups that were left out."""
    group: np.ndarray
    """Index of the group of each test, shape (tests,); -1 without a measurement."""
    x: np.ndarray
    """Fits to the rest in x, shape (groups, unknowns)."""
    reasons: list[Reason]
    """Reason for which each of them stopped."""
    moved: np.ndarray
    """Change of the unknowns in standard errors of the whole fit, shape (groups,
    unknowns); NaN for one without influence."""
    predicted: np.ndarray
    """Prediction of each test by the rest, shape (tests, targets); NaN where none."""
    deviation: np.ndarray
    """Standard deviation of a measurement about it, the same shape."""
    quantile: float
    """Half width of the 95 % band in these deviations."""

    def standardised(self, measured: np.ndarray) -> np.ndarray:
        """Compute measured less predicted over the deviation."""
        return (measured - self.predicted) / self.deviation

    def inside(self, measured: np.ndarray) -> np.ndarray:
        """Find the measurements within their 95 % bands."""
        return np.abs(self.standardised(measured)) <= self.quantile


def leave_out_each(
    objective: Objective,
    points: Points,
    uncertainty: Uncertainty,
    *,
    at_most: int = AT_MOST,
) -> LeftOut:
    """Predict each test by the fit without it, from the fit to all (points of one
    lane), with at most so many fits; tests without a measurement are skipped."""
    study = objective.study
    group, measured = study.each_test()
    each = group == np.arange(len(measured))[:, None]
    steps = linearised(objective, points, each)
    # A nuisance parameter of the test alone goes all the way to its prior.
    far = np.max(np.abs(steps / uncertainty.standard_errors), axis=1)
    fitted = far > SMALL_STEP
    fitted[np.argsort(-far, kind="stable")[at_most:]] = False
    steps[fitted] = np.nan
    names = tuple(study.tests.name(test) for test in measured)
    with within("tests left out: "):
        rests = fits_without(objective, points, each, steps, points.x)
        return _left_out(objective, points, uncertainty, names, group, rests)


def leave_out_campaigns(
    objective: Objective,
    points: Points,
    uncertainty: Uncertainty,
    ends: np.ndarray | None = None,
) -> LeftOut | None:
    """Predict each campaign by the fit without it; None where there is only one with
    measurements.

    Args:
        ends: ends of other starts in x, best first, shape (starts, unknowns); the rest
            is fitted from the first few too, since without a campaign another minimum
            may be the best.
    """
    labels = objective.study.tests.labels["campaign"]
    measured = np.any(objective.study.known, axis=1)
    names = tuple(dict.fromkeys(itertools.compress(labels, measured)))
    if len(names) < 2:
        return None
    group = np.array([names.index(n) if n in names else -1 for n in labels])
    # Four other ends: each costs a fit without each campaign.
    starts = points.x if ends is None else np.concatenate([points.x, ends[:4]])
    steps = np.full((len(names), points.x.shape[1]), np.nan)
    left = group == np.arange(len(names))[:, None]
    with within("campaigns left out: "):
        rests = fits_without(objective, points, left, steps, starts)
        return _left_out(objective, points, uncertainty, names, group, rests)


def linearised(objective: Objective, points: Points, left: np.ndarray) -> np.ndarray:
    """Compute the Gauss-Newton step in x towards the fit to the rest, shape (groups,
    unknowns), for masks of the tests left out, shape (groups, tests)."""
    rests = (objective.without(tests).reevaluate(points) for tests in left)
    return np.array([bounded_step(objective, rest)[0] for rest in rests])


def measured_alone(
    objective: Objective, points: Points, group: np.ndarray
) -> np.ndarray:
    """Find the measurements, shape (tests, targets), that depend on something that no
    other group of tests measures: the fit to the rest keeps what they gave it, and
    predicts them by themselves.

    Args:
        group: index of the group of each test, shape (tests,); -1 for none.
    """
    rows, inverse = hat(objective, points)
    # Sums of squares of these columns are leverages.
    rows = (rows @ root_of(inverse)).reshape(*objective.study.known.shape, -1)
    alone = np.zeros(rows.shape[:2], bool)
    for one in range(np.max(group) + 1):
        own = rows[group == one]
        values, vectors = np.linalg.eigh(np.einsum("rtp,rtq->pq", own, own))
        there = own @ vectors[:, values > 1.0 - LEAST_LEFT]
        alone[group == one] = np.sum(there**2, axis=2) > LEAST_LEFT
    return alone


class Rest(NamedTuple):
    """Fit to all tests but those of a group."""

    tests: np.ndarray
    """Mask of the group, shape (tests,)."""
    objective: Objective
    points: Points
    """Best fit, one lane."""
    reason: Reason


def fits_without(
    objective: Objective,
    points: Points,
    left: np.ndarray,
    steps: np.ndarray,
    starts: np.ndarray,
) -> Iterator[Rest]:
    """Yield the fit without each group: made, or where its step is no NaN, the best fit
    moved by it with the model linearised.

    Args:
        left: masks of the tests left out, shape (groups, tests).
        steps: linearised steps from the best fit, shape (groups, unknowns).
        starts: starting points of fits, shape (starts, unknowns).
    """
    coarser = objective.no_finer_than_sigmas()
    for number, (tests, step) in enumerate(zip(left, steps, strict=True)):
        tell(f"{number} of {len(steps)} groups left out")
        if np.all(np.isfinite(step)):
            rest, reason = objective.without(tests), Reason.converged
            predicted = points.predicted + points.jacobian @ step
            model = predicted, points.outcomes, points.jacobian
            best = rest.evaluate(points.x + step, *model)
        else:
            rest = coarser.without(tests)
            fits = fit(rest, starts, tolerance=LEFT_OUT)
            best, reason = fits.points.take([fits.best]), fits.reasons[fits.best]
        yield Rest(tests, rest, best, reason)


def _left_out(
    objective: Objective,
    points: Points,
    uncertainty: Uncertainty,
    names: tuple[str, ...],
    group: np.ndarray,
    rests: Iterable[Rest],
) -> LeftOut:
    study = objective.study
    predicted, deviation = np.full((2, *study.measured.shape), np.nan)
    of_whole = sizes(study, points.predicted[0])
    ends, reasons = [], []
    for tests, rest, best, reason in rests:
        covariance = regular_covariance(rest, best, uncertainty.inflation)
        predicted[tests] = best.predicted[0, tests]
        part = sizes(study, best.predicted[0]) / of_whole
        scatter = (objective.sigma * part) ** 2 * uncertainty.inflation
        variance = variances(best.jacobian[0, tests], covariance)
        deviation[tests] = np.sqrt(scatter[tests] + variance)
        ends.append(best.x[0])
        reasons.append(reason)
    predicted[measured_alone(objective, points, group)] = np.nan
    x, errors = np.array(ends), uncertainty.standard_errors
    moved = (x - points.x[0]) / np.where(errors < 1e6, errors, np.nan)
    quantile = uncertainty.quantile_of_all
    return LeftOut(names, group, x, reasons, moved, predicted, deviation, quantile)


def in_words(left: LeftOut, objective: Objective, what: str) -> list[str]:
    """Describe how well the rest predicts each "test" or "campaign" left out."""
    study = objective.study
    exact = study.exact & (left.group >= 0)[:, None]
    there = exact & np.isfinite(left.predicted)
    lines = []
    if count := int(np.sum(there)):
        inside = int(np.sum(left.inside(study.measured) & there))
        lines.append(
            f"{inside} of {count} measurements lie within the {100 * CONFIDENCE:g} % "
            f"band of the fit without their {what}."
        )
        if too_few(inside, count, CONFIDENCE):
            lines[-1] += (
                " That is fewer than chance allows: the errors of predictions of a new "
                f"{what} are underestimated."
            )
    limits = study.known & (study.censored != 0) & np.isfinite(left.predicted)
    if np.any(limits):
        apart = (left.predicted - study.measured) * study.censored
        kept = int(np.sum(limits & (apart >= 0.0)))
        lines.append(
            f"{kept} of {int(np.sum(limits))} limits are satisfied by the fit without "
            f"their {what}."
        )
    if missing := int(np.sum(exact & ~there)):
        lines.append(f"{missing} of them cannot be predicted without their {what}.")
    fits = zip(left.groups, left.reasons, strict=True)
    if lost := [name for name, reason in fits if not reason.at_minimum]:
        lines.append(f"The fit without {', '.join(lost)} reached no minimum.")
    return lines

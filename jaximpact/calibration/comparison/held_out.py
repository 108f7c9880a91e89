r"""Log predictive densities of tests by fits that have not seen them.

A measurement that was left out has the density of its prediction by the rest: with
y the value of the model there, C the covariance of the unknowns and J the derivative
of y,

$$ \ln p = \ln t_\nu\!\left(\frac{\hat y - y}{d}\right) - \ln d, \qquad
   d^2 = s^2 \sigma^2 + J C J^T, $$

with Student's distribution of the degrees of freedom from which sigma was estimated, or
the normal one where sigma is given. Sigma and the inflation s^2 are estimated again
from the rest. The score of a test is the sum over its measurements; a limit counts with
the logarithm of its probability.

Where predictions of a test jump within the confidence region of the rest, a derivative
does not tell what may be measured. Its density is then the mean over draws x_k of the
unknowns, normal with the covariance C,

$$ p = \frac{1}{K} \sum_k \prod_i \frac{1}{s \sigma_i}
   t_\nu\!\left(\frac{\hat y_i - y_i(x_k)}{s \sigma_i}\right) . $$

With `exact` every group is refitted. Otherwise one Gauss-Newton step from the fit to
all stands for the refit where it is short, as in `cross_validation`.
"""

from typing import NamedTuple

import numpy as np

# Not scipy.stats here, which takes 0.6 s to import.
from scipy.special import log_ndtr, logsumexp

from ..diagnostics.cross_validation import (
    SMALL_STEP,
    Rest,
    fits_without,
    linearised,
    measured_alone,
)
from ..diagnostics.posterior import root_of, variances
from ..diagnostics.predictive import NORMAL_FROM
from ..diagnostics.uncertainty import Uncertainty, estimate, regular_covariance
from ..estimation.branches import draws_about, has_left, is_abrupt
from ..estimation.sigma import estimate_sigma, freedom_of_sigmas
from ..problem.objective import Objective, Points

MISSED_BY = 10.0
"""Standard deviations by which a measurement without a prediction counts as missed."""
DRAWS = 128
"""Number of draws at which jumps are looked for, and over which densities are
averaged."""


class HeldOut(NamedTuple):
    """Predictions of tests by fits without their groups."""

    density: np.ndarray
    """Log predictive density of the measurements of each test, shape (sets of targets,
    tests); 0 for a test without measurement."""
    predicted: np.ndarray
    """Predictions, shape (tests, targets); NaN where there is none."""
    deviation: np.ndarray
    """Standard deviation of a measurement about its prediction, the same shape."""
    refitted: int
    """Number of groups that were refitted."""


def held_out(
    objective: Objective,
    best: Points,
    uncertainty: Uncertainty,
    group: np.ndarray,
    *,
    exact: bool,
    sets: np.ndarray,
) -> HeldOut:
    """Predict each group of tests by the fit to the others.

    Args:
        objective: objective with the sigmas of the fit to all.
        best, uncertainty: the fit to all, of one lane.
        group: index of the group of each test, shape (tests,).
        exact: whether every group is refitted.
        sets: masks of the targets whose density is computed, shape (sets, targets).
    """
    known = objective.study.known
    left = group == np.arange(np.max(group) + 1)[:, None]
    steps = linearised(objective, best, left)
    errors = np.where(uncertainty.standard_errors > 0.0, uncertainty.standard_errors, 1)
    refitted = exact | np.any(np.abs(steps / errors) > SMALL_STEP, axis=1)
    steps[refitted] = np.nan
    predicted, deviation = np.full((2, *known.shape), np.nan)
    density = np.zeros((len(sets), len(group)))
    for rest in fits_without(objective, best, left, steps, best.x):
        predicted[rest.tests] = rest.points.predicted[0, rest.tests]
        deviation[rest.tests], density[:, rest.tests] = _predict(rest, sets)
    # Their densities are those of the wide prior that stands for what is not measured.
    predicted[measured_alone(objective, best, group)] = np.nan
    return HeldOut(density, predicted, deviation, int(np.sum(refitted)))


def _predict(fitted: Rest, sets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the deviations of the tests left out, shape (tests left out, targets),
    and their log densities, shape (sets of targets, tests left out): that of a curve at
    the first of its points, and 0 at the others."""
    tests, rest, points, _ = fitted
    study = rest.study
    if not np.all(study.sigma_given):
        rest = rest.with_sigma(estimate_sigma(rest, points))
        points = rest.reevaluate(points)
    uncertainty = estimate(rest, points)
    covariance = regular_covariance(rest, points, uncertainty.inflation)
    variance = variances(points.jacobian[0, tests], covariance)
    noise = rest.sigma[tests] * np.sqrt(uncertainty.inflation)
    deviation = np.sqrt(rest.sigma[tests] ** 2 * uncertainty.inflation + variance)
    freedom = freedom_of_sigmas(rest, points)
    # `without` has taken the measurements away.
    measured = np.stack([study.tests.measured[n] for n in study.targets], axis=1)[tests]
    known, censored = np.isfinite(measured), study.censored[tests]

    def density(predicted: np.ndarray, deviation: np.ndarray) -> np.ndarray:
        u = (measured - predicted) / deviation
        u = np.where(np.isfinite(predicted), u, MISSED_BY)
        of_cells = log_densities(u, deviation, censored, freedom)
        of_sets = (np.where(known & chosen, of_cells, 0.0) for chosen in sets)
        return np.stack([np.sum(cells, axis=-1) for cells in of_sets])

    at_best = density(points.predicted[0, tests], deviation)
    places = np.flatnonzero(tests)
    x = draws_about(rest, points, root_of(covariance), DRAWS)
    draws = rest.of_tests(places).values(x).predicted
    jumps = _jumps(rest, points, places, x, draws) & np.any(known, axis=1)
    # Points of a curve are one test, which all of them belong to in one draw.
    first, of_test = np.unique(study.tests.first_of_row[places], return_inverse=True)

    def by_test(values: np.ndarray) -> np.ndarray:
        rows = (values[..., of_test == test] for test in range(len(first)))
        return np.stack([np.sum(of_one, axis=-1) for of_one in rows], axis=-1)

    mixture = logsumexp(by_test(density(draws, noise)), axis=1) - np.log(DRAWS)
    of_tests = np.where(by_test(1.0 * jumps) > 0.0, mixture, by_test(at_best))
    at_first = np.zeros_like(at_best)
    at_first[:, np.unique(of_test, return_index=True)[1]] = of_tests
    return deviation, at_first


def _jumps(
    rest: Objective, points: Points, places: np.ndarray, x: np.ndarray, draws
) -> np.ndarray:
    """Find the tests at some places of which a prediction jumps between the fit and one
    of the draws x, shape (places,); `draws` are their predictions there."""
    predicted = np.full((len(x), *rest.study.measured.shape), np.nan)
    predicted[:, places] = draws
    ends = points._replace(x=x, predicted=predicted)
    beyond = np.zeros(predicted.shape, bool)
    beyond[:, places] = has_left(rest, points, ends)[:, places]
    return np.any(is_abrupt(rest, points, ends, beyond)[:, places], axis=(0, 2))


def log_densities(
    u: np.ndarray, deviation: np.ndarray, censored: np.ndarray, freedom: np.ndarray
) -> np.ndarray:
    """Compute the log predictive density of each measurement, shape (..., targets).

    Args:
        u: measured less predicted over the deviation.
        deviation: standard deviations.
        censored: 1 where the true value is above, -1 where it is below, else 0.
        freedom: degrees of freedom of each target, shape (targets,); infinite where
            sigma is given.
    """
    from scipy.stats import t

    nu = np.where(freedom < NORMAL_FROM, freedom, np.inf)
    towards = -censored * u
    # The probability of a limit that is missed by far is no number of double precision.
    of_student = np.log(np.maximum(t.cdf(towards, nu), 1e-300))
    limit = np.where(np.isinf(nu), log_ndtr(towards), of_student)
    return np.where(censored == 0, t.logpdf(u, nu) - np.log(deviation), limit)

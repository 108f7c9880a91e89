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
from scipy.special import gammaln, log_ndtr, logsumexp, stdtr

from ...progress import tell
from ..diagnostics.cross_validation import LEFT_OUT, SMALL_STEP, linearised, move
from ..diagnostics.uncertainty import Uncertainty, estimate, regular_covariance
from ..estimation.branches import draws_about, has_left, is_abrupt
from ..estimation.search import fit
from ..estimation.sigma import estimate_sigma, freedom_of_targets
from ..problem.objective import Objective, Points

# Not scipy.stats, which takes 0.6 s to import.

MISSED_BY = 10.0
"""Standard deviations by which a measurement without a prediction counts as missed."""
NORMAL_FROM = 200.0
"""Degrees of freedom above which Student's distribution is taken as normal."""
LEAST_CHANCE = 1e-300
DRAWS = 128
"""Number of draws at which jumps are looked for, and over which densities are
averaged."""


class HeldOut(NamedTuple):
    """Predictions of tests by fits without their groups."""

    density: np.ndarray
    """Log predictive density of the measurements of each test, shape (tests,); 0 for a
    test without measurement."""
    predicted: np.ndarray
    """Predictions, shape (tests, targets); NaN where there is none."""
    deviation: np.ndarray
    """Standard deviation of a measurement about its prediction, the same shape."""
    refitted: int
    """Number of groups that were refitted."""
    unpredicted: int
    """Number of measurements without a prediction."""


def held_out(
    objective: Objective,
    best: Points,
    uncertainty: Uncertainty,
    group: np.ndarray,
    *,
    exact: bool,
) -> HeldOut:
    """Predict each group of tests by the fit to the others.

    Args:
        objective: objective with the sigmas of the fit to all.
        best, uncertainty: the fit to all, of one lane.
        group: index of the group of each test, shape (tests,).
        exact: whether every group is refitted.
    """
    study = objective.study
    groups = np.unique(group[np.any(study.known, axis=1)])
    left = group[None] == groups[:, None]
    steps = linearised(objective, best, left)
    errors = np.where(uncertainty.standard_errors > 0.0, uncertainty.standard_errors, 1)
    far = np.any(np.abs(steps / errors) > SMALL_STEP, axis=1)
    refitted = np.ones(len(groups), bool) if exact else far
    shape = study.measured.shape
    predicted, deviation = np.full(shape, np.nan), np.full(shape, np.nan)
    density = np.zeros(len(left[0]))

    for number in range(len(groups)):
        tell("groups left out", number, len(groups))
        tests, rest = left[number], objective.without(left[number])
        if refitted[number]:
            found = fit(rest, best.x, tolerance=LEFT_OUT)
            points = found.points.take([found.best])
        else:
            points = move(rest, best, steps[number])
        of_rest = _predict(rest, points, tests)
        predicted[tests], deviation[tests] = points.predicted[0, tests], of_rest[0]
        density[tests] = of_rest[1]

    known = study.known
    return HeldOut(
        density=density,
        predicted=predicted,
        deviation=deviation,
        refitted=int(np.sum(refitted)),
        unpredicted=int(np.sum(known & ~np.isfinite(predicted))),
    )


def _predict(
    rest: Objective, points: Points, tests: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the deviations of the tests left out, shape (tests left out, targets),
    and their log densities, shape (tests left out,), by the fit to the rest (points of
    one lane)."""
    study, sigma = rest.study, rest.sigma
    if not np.all(study.sigma_given):
        rest = rest.with_sigma(estimate_sigma(rest, points))
        points, sigma = rest.reevaluate(points), rest.sigma
    uncertainty = estimate(rest, points)
    covariance = regular_covariance(rest, points, uncertainty.inflation)
    rows = points.jacobian[0, tests]
    variance = np.einsum("rtp,pq,rtq->rt", rows, covariance, rows)
    deviation = np.sqrt(sigma[tests] ** 2 * uncertainty.inflation + variance)
    freedom = np.where(
        study.sigma_given, np.inf, np.maximum(freedom_of_targets(rest, points), 1.0)
    )
    # `without` has taken the measurements away.
    measured = np.stack([study.tests.measured[n] for n in study.targets], axis=1)
    u = (measured[tests] - points.predicted[0, tests]) / deviation
    missing = ~np.isfinite(points.predicted[0, tests])
    u = np.where(missing, MISSED_BY, u)
    known, censored = np.isfinite(measured[tests]), study.censored[tests]
    cells = log_densities(u, deviation, censored, freedom)
    density = np.sum(np.where(known, cells, 0.0), axis=1)
    places = np.flatnonzero(tests)
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    x = draws_about(rest, points, root, DRAWS)
    draws = rest.of_tests(places).values(x).predicted
    jumps = _jumps(rest, points, places, x, draws) & np.any(known, axis=1)
    for place in np.flatnonzero(jumps):
        noise = sigma[places[place]] * np.sqrt(uncertainty.inflation)
        u = (measured[places[place]] - draws[:, place]) / noise
        u = np.where(np.isfinite(draws[:, place]), u, MISSED_BY)
        limits = np.broadcast_to(censored[place], u.shape)
        each = log_densities(u, noise, limits, freedom)
        of_draws = np.sum(np.where(known[place], each, 0.0), axis=1)
        density[place] = logsumexp(of_draws) - np.log(DRAWS)
    return deviation, density


def _jumps(
    rest: Objective, points: Points, places: np.ndarray, x: np.ndarray, draws
) -> np.ndarray:
    """Find the tests at some places of which a prediction jumps between the fit and a
    draw, shape (places,).

    Args:
        x: draws, shape (draws, unknowns).
        draws: predictions of these tests there.
    """
    predicted = np.full((len(x), *rest.study.measured.shape), np.nan)
    predicted[:, places] = draws
    ends = points._replace(x=x, predicted=predicted)
    beyond = np.zeros(predicted.shape, bool)
    beyond[:, places] = has_left(rest, points, ends)[:, places]
    return np.any(is_abrupt(rest, points, ends, beyond)[:, places], axis=(0, 2))


def log_densities(
    u: np.ndarray, deviation: np.ndarray, censored: np.ndarray, freedom: np.ndarray
) -> np.ndarray:
    """Compute the log predictive density of each measurement.

    Args:
        u: measured less predicted over the deviation, shape (tests, targets).
        deviation: standard deviations, the same shape.
        censored: 1 where the true value is above, -1 where it is below, else 0.
        freedom: degrees of freedom of each target, shape (targets,); infinite where
            sigma is given.
    """
    normal = np.broadcast_to(freedom >= NORMAL_FROM, u.shape)
    nu = np.broadcast_to(np.minimum(freedom, NORMAL_FROM), u.shape)
    of_normal = -0.5 * u**2 - 0.5 * np.log(2.0 * np.pi)
    of_student = (
        gammaln(0.5 * (nu + 1.0))
        - gammaln(0.5 * nu)
        - 0.5 * np.log(nu * np.pi)
        - 0.5 * (nu + 1.0) * np.log1p(u**2 / nu)
    )
    exact = np.where(normal, of_normal, of_student) - np.log(deviation)
    towards = -censored * u
    chance = np.log(np.maximum(stdtr(nu, towards), LEAST_CHANCE))
    limit = np.where(normal, log_ndtr(towards), chance)
    return np.where(censored == 0, exact, limit)

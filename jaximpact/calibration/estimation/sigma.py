r"""Estimates of the sigmas that are not given, from the residuals, target by target.

For the n exact measurements of a target, of which the fit takes up p degrees of freedom
(the sum of their leverages), sigma solves

$$ \sum_i u_i \rho'(u_i) + \sum_{\text{limits}} u_i \rho'(u_i) = \kappa \, (n - p), $$

with u the residuals in units of sigma and kappa the mean of u rho' under Gaussian
scatter: the restricted maximum likelihood where all is Gaussian and measured. For a
robust loss it is Huber's second proposal.

Where scatter is proportional (`problem.noise`) the sigmas of a target are a factor r on
the sizes of the predictions, and r is found likewise. A fit takes its sigmas as given,
so that it gains nothing by predicting more in order to have larger ones; fit and sigmas
are updated in turn.

Where sigmas of some targets are given, and those of another are estimated, given ones
that are too small for the residuals are multiplied by a factor that is estimated
likewise. (Where all are given their inflation does that, `diagnostics.uncertainty`.)
"""

import numpy as np

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import chdtrc

from ...progress import within
from ..problem.config import Study
from ..problem.noise import losses, scale_of_normal
from ..problem.objective import Objective, Points
from .least_squares import Fits
from .linear_algebra import pseudo_inverse
from .search import fit_along

LEAST_PART = 1e-3
"""Sigma over the root mean square of a target, or over its size where scatter is
proportional, below which no sigma is estimated: nothing is measured better, and targets
without noise would give 0."""
LEAST_LEFT = 1e-6
"""Least 1 - leverage: a measurement of leverage 1 has no residual."""
LEAST_FREEDOM = 0.99
"""Degrees of freedom that a target needs for a sigma of its own: one, to rounding."""
IMPROBABLE = 0.01
"""Probability of a larger, or smaller, chi-square below which the given sigmas are too
small, or too large."""
ROUNDS = 20
SETTLED = 3e-3
"""Relative change of every sigma at which the rounds end."""


def sizes(study: Study, values: np.ndarray) -> np.ndarray:
    """Compute what sigmas are in proportion to; 1 where they are constant.

    Args:
        values: values of the targets, shape (tests, targets). The measured value
            replaces NaN, and y_0 where there is no measurement either.
    """
    values = np.where(np.isfinite(values), values, study.measured)
    values = np.where(np.isfinite(values), np.abs(values), 0.0)
    floored = np.maximum(values, study.least_size)
    return np.where(study.proportional, floored, 1.0)


def relative_sigma(
    study: Study, sigma: np.ndarray, predicted: np.ndarray
) -> np.ndarray:
    """Compute r of each target at a fit, shape (targets,); NaN where it is constant.

    Args:
        sigma, predicted: shape (tests, targets). Sigmas that are not those of this fit,
            nominal ones or those of an earlier step, have no single r: the median is
            taken.
    """
    ratio = median_sigma(study, sigma / sizes(study, predicted))
    return np.where(study.proportional, ratio, np.nan)


def median_sigma(study: Study, sigma: np.ndarray) -> np.ndarray:
    """Compute the median sigma of each target, shape (targets,), over its measurements;
    over all tests for a target without any."""
    counts = study.known | ~np.any(study.known, axis=0)
    return np.nanmedian(np.where(counts, sigma, np.nan), axis=0)


def hat(objective: Objective, points: Points) -> tuple[np.ndarray, np.ndarray]:
    """Compute B, shape (cells, unknowns), and C of the hat matrix B C B^T, which turns
    measurements over sigma into predictions over sigma, at a fit (points of one
    lane)."""
    study = objective.study
    rows, used, u = standardised_rows(objective, points)
    censored = study.censored.ravel()
    curved = np.where(used, losses(u, censored).curvature, 0.0)
    rows = rows * np.sqrt(curved * weights_of_cells(study))[:, None]
    matrix = rows.T @ rows + np.diag(objective.prior_information(points.x[0]))
    # An unknown at its bound is fixed, and takes up nothing.
    bounds, x = objective.bounds, points.x[0]
    fixed = (x <= bounds.low) | (x >= bounds.high)
    matrix[fixed, :] = matrix[:, fixed] = 0.0
    return rows, pseudo_inverse(matrix)


def leverages(objective: Objective, points: Points) -> np.ndarray:
    """Compute the degrees of freedom that a fit (points of one lane) takes up of each
    measurement, shape (tests, targets)."""
    rows, inverse = hat(objective, points)
    return np.sum(rows @ inverse * rows, axis=1).reshape(objective.study.known.shape)


def freedom_of_targets(objective: Objective, points: Points) -> np.ndarray:
    """Compute the degrees of freedom of each target, shape (targets,), at a fit (points
    of one lane): its exact measurements less their leverages."""
    exact = objective.study.exact & np.isfinite(points.predicted[0])
    used_up = np.where(exact, leverages(objective, points), 0.0)
    return np.sum(exact, axis=0) - np.sum(used_up, axis=0)


def freedom_of_sigmas(objective: Objective, points: Points) -> np.ndarray:
    """Compute the degrees of freedom from which each sigma was estimated, shape
    (targets,), 1 at least; infinite where it was given."""
    freedom = np.maximum(freedom_of_targets(objective, points), 1.0)
    return np.where(objective.study.sigma_given, np.inf, freedom)


def sharing_scale(study: Study, freedom: np.ndarray) -> list[np.ndarray]:
    """List the targets, by index, whose sigmas are estimated by one factor: each with a
    degree of freedom alone, all others together."""
    estimated = ~study.sigma_given
    alone = estimated & (freedom >= LEAST_FREEDOM)
    together = np.flatnonzero(estimated & ~alone)
    return [*np.flatnonzero(alone)[:, None], *([together] if len(together) else [])]


def weights_of_cells(study: Study) -> np.ndarray:
    """Weight of every measurement, shape (cells,)."""
    return np.broadcast_to(study.weights, study.known.shape).ravel()


def standardised_rows(objective: Objective, points: Points):
    """Compute the Jacobian over sigma (cells, unknowns), the mask of used cells, and
    the residuals over sigma (cells,)."""
    study = objective.study
    predicted = points.predicted[0]
    used = (study.known & np.isfinite(predicted)).ravel()
    jacobian = points.jacobian[0] / objective.sigma[..., None]
    rows = np.where(used[:, None], jacobian.reshape(len(used), -1), 0.0)
    u = ((predicted - study.measured) / objective.sigma).ravel()
    return rows, used, np.where(used, u, 0.0)


def estimate_sigma(objective: Objective, points: Points) -> np.ndarray:
    """Estimate the sigmas, shape (tests, targets), in one round at a fit (points of one
    lane).

    A target with too few measurements for a sigma of its own shares, with those like
    it, one factor on the nominal sigmas; without degrees of freedom it keeps them.
    """
    study, predicted = objective.study, points.predicted[0]
    r = relative_sigma(study, objective.sigma, predicted)
    sigma = np.where(study.proportional, r * sizes(study, predicted), objective.sigma)
    objective = objective.with_sigma(sigma.copy())
    of_exact, of_limits = _misfits(objective, points)
    freedom = freedom_of_targets(objective, points)
    kappa = scale_of_normal(study.loss)

    def factor(targets) -> float:
        left = np.sum(freedom[targets])
        if left < LEAST_FREEDOM:
            return 1.0
        # Limits that the fit violates could make the difference negative.
        below = max(kappa * left - np.sum(of_limits[targets]), 0.2 * kappa * left)
        return float(np.sqrt(np.sum(of_exact[targets]) / below))

    for targets in sharing_scale(study, freedom):
        sigma[:, targets] *= factor(targets)
    scale = np.where(study.proportional, 1.0, study.scale)
    least = LEAST_PART * scale * sizes(study, predicted)
    return np.where(study.sigma_given, sigma, np.maximum(sigma, least))


def _misfits(objective: Objective, points: Points) -> tuple[np.ndarray, np.ndarray]:
    """Sum u times the slope of the loss over the exact measurements of each target, and
    over its limits, shape (targets,)."""
    study, predicted = objective.study, points.predicted[0]
    used = study.known & np.isfinite(predicted)
    u = np.where(used, (predicted - study.measured) / objective.sigma, 0.0)
    misfit = np.where(used, u * losses(u, study.censored, study.loss).slope, 0.0)
    exact = used & study.exact
    of_exact = np.sum(np.where(exact, misfit, 0.0), axis=0)
    return of_exact, np.sum(np.where(exact, 0.0, misfit), axis=0)


def understated(objective: Objective, points: Points) -> np.ndarray:
    """Find the targets whose given sigmas are too small for their residuals at a fit
    (points of one lane), shape (targets,); none where all sigmas are given."""
    study = objective.study
    chi_square = _misfits(objective, points)[0] / scale_of_normal(study.loss)
    freedom = freedom_of_targets(objective, points)
    enough = study.sigma_given & (freedom >= LEAST_FREEDOM)
    improbable = chdtrc(np.maximum(freedom, LEAST_FREEDOM), chi_square) < IMPROBABLE
    return enough & improbable & ~np.all(study.sigma_given)


def sigma_factors(objective: Objective) -> dict[str, float]:
    """Compute the factors on given sigmas that the fit found too small, by target."""
    study = objective.study
    ratio = np.median(objective.sigma / study.sigma, axis=0)
    return {n: float(ratio[study.targets.index(n)]) for n in study.understated}


def settle(objective: Objective, fits: Fits) -> tuple[Objective, Fits]:
    """Update sigmas and fit in turn until they agree, from the best fit, of one
    lane."""
    if np.all(objective.study.sigma_given):
        return objective, fits
    for number in range(1, ROUNDS + 1):
        sigma = estimate_sigma(objective, fits.points)
        # The sigma of a cell without measurement changes no fit.
        known = objective.study.known
        change = np.max(np.abs(np.log(sigma / objective.sigma)[known]))
        objective = objective.with_sigma(sigma)
        points = objective.reevaluate(fits.points)
        fits = Fits(points, fits.reasons, fits.steps)
        if change <= SETTLED:
            break
        with within(f"errors of measurement, round {number}: "):
            fits = fit_along(objective, points.x[0])
    return objective, fits

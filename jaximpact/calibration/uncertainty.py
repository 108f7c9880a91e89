r"""How well the data determine the unknowns, at the best fit.

With J the Jacobian by x of the predictions over sigma, w the targets' weights and P the
priors' information, the curvature of the objective and the variance of its gradient are

$$ H = \sum_i w_i h_i J_i^T J_i + P, \qquad V = \sum_i w_i^2 v_i J_i^T J_i + P, $$

h and v those of the loss: 1 for Gaussian scatter, the loss's curvature for a limit; for
a robust loss the mean of its second derivative, and of its slope squared over (n - p) /
n (Huber 1981, section 7.6). The covariance is H^-1 V H^-1, and its inverse the Fisher
matrix. Where sigmas are given and the misfit is larger than they allow, the covariance
is multiplied by the reduced chi-square.

Where a target's sigma is estimated from many measurements, v is each one's own slope
squared over 1 less its leverage, so that the scatter need not be the same for all
(White 1980; MacKinnon and White 1985).
"""

from typing import NamedTuple

import numpy as np

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import chdtrc, ndtri, stdtrit

from .losses import losses, true_curvature
from .objective import Objective, Points

USELESS_ERROR = 1.0
"""A standard error above this, in x, says that the data do not determine it."""
LEAST_EIGENVALUE = 1e-12
"""Part of the largest eigenvalue below which one counts as nothing: rounding."""
NO_INFORMATION = 1e30
"""Variance along a direction of which the data say nothing."""
CONFIDENCE = 0.95
MANY = 20.0
"""Degrees of freedom from which measurements tell their scatter one by one."""
LEAST_LEFT = 0.1
"""Of 1 less a leverage: a measurement that alone rules the fit tells no scatter."""
IMPROBABLE = 0.01
"""Chance of a larger chi-square below which the sigmas given are held to be too
small."""


class Uncertainty(NamedTuple):
    """Errors in x: relative for positive parameters."""

    inflation: float
    """By which the covariance is multiplied; 1 where the sigmas can be true."""
    reduced_chi_square: float
    """Of the exact measurements, over the degrees of freedom; NaN without any."""
    degrees_of_freedom: float
    """Exact measurements less what the fit takes up."""
    quantile: float
    """Standard errors to either side that make an interval of 95 %: of Student's
    distribution where the scatter was estimated."""
    covariance: np.ndarray
    standard_errors: np.ndarray
    correlation: np.ndarray
    eigenvalues: np.ndarray
    """Of the Fisher matrix of the soil's parameters, the nuisances left free;
    ascending."""
    eigenvectors: np.ndarray
    """One a column."""


def estimate(objective: Objective, points: Points) -> Uncertainty:
    """Uncertainty at a fit (points of one lane).

    An unknown without any influence gets a very large standard error, not NaN.
    """
    study = objective.study
    soil = len(study.parameters)
    curvature, variance, squares, freedom = _parts(objective, points)
    covariance = _sandwich(curvature, variance)
    reduced = squares / freedom if freedom > 0.5 else float("nan")
    inflation = 1.0
    given = np.all(study.sigma_given)
    if given and freedom > 0.5 and chdtrc(freedom, squares) < IMPROBABLE:
        inflation = reduced
    covariance = covariance * inflation
    scattered = not given or inflation > 1.0
    half = 0.5 + CONFIDENCE / 2.0
    quantile = stdtrit(max(freedom, 1.0), half) if scattered else ndtri(half)
    errors = np.sqrt(np.diag(covariance))
    fisher = _fisher(curvature, variance, soil) / inflation
    values, vectors = np.linalg.eigh(fisher)
    return Uncertainty(
        inflation=inflation,
        reduced_chi_square=reduced,
        degrees_of_freedom=freedom,
        quantile=float(quantile),
        covariance=covariance,
        standard_errors=errors,
        correlation=covariance / np.outer(errors, errors),
        eigenvalues=np.maximum(values, 0.0),
        eigenvectors=vectors,
    )


def regular_covariance(
    objective: Objective, points: Points, inflation: float
) -> np.ndarray:
    """Covariance in x with the bounds as a weak prior, so that it is finite whatever
    the data say.

    An unknown without a prior gets the information of a uniform distribution over its
    range, 12 / range^2.

    Args:
        points: a fit, of one lane.
        inflation: by which the covariance of the data is multiplied.
    """
    curvature, variance, _, _ = _parts(objective, points)
    extra = np.diag(bounds_information(objective))
    half = np.linalg.inv(curvature / inflation + extra)
    return half @ (variance / inflation + extra) @ half


def laplace_covariance(
    objective: Objective, points: Points, inflation: float
) -> np.ndarray:
    """Likewise, of the curvature alone: that of the posterior, which takes the sigmas
    for true and the same for all measurements of a target."""
    curvature = _parts(objective, points)[0] / inflation
    return np.linalg.inv(curvature + np.diag(bounds_information(objective)))


def bounds_information(objective: Objective) -> np.ndarray:
    """Of a uniform distribution between the bounds, 0 for an unknown with a prior."""
    width = objective.bounds.high - objective.bounds.low
    return np.where(np.isinf(objective.prior_sd), 12.0 / width**2, 0.0)


def leverages(objective: Objective, points: Points) -> np.ndarray:
    """Degrees of freedom that the fit takes up of each cell, `(tests, targets)`."""
    study = objective.study
    rows, used, u = _rows(objective, points)
    censored = study.censored.ravel()
    curved = np.where(used, losses(u, censored).curvature, 0.0)
    curved = curved * _weights(objective)
    matrix = (rows.T * curved) @ rows
    matrix += np.diag(objective.prior_information(points.x[0]))
    # At a bound an unknown is held, and takes up nothing.
    held = _held(objective, points)
    matrix[held, :] = matrix[:, held] = 0.0
    inverse = _pseudo_inverse(matrix)
    return (curved * np.einsum("rp,pq,rq->r", rows, inverse, rows)).reshape(
        study.known.shape
    )


def _weights(objective: Objective) -> np.ndarray:
    """Of every cell."""
    study = objective.study
    return np.broadcast_to(study.weights, study.known.shape).ravel()


def _held(objective: Objective, points: Points) -> np.ndarray:
    bounds, x = objective.bounds, points.x[0]
    return (x <= bounds.low) | (x >= bounds.high)


def _rows(objective: Objective, points: Points):
    """Jacobian `(cells, unknowns)`, which cells are used, and their residuals."""
    study = objective.study
    predicted = points.predicted[0]
    used = (study.known & np.isfinite(predicted)).ravel()
    jacobian = points.jacobian[0] / objective.sigma[..., None]
    rows = np.where(used[:, None], jacobian.reshape(len(used), -1), 0.0)
    u = ((predicted - study.measured) / objective.sigma).ravel()
    return rows, used, np.where(used, u, 0.0)


def _parts(objective: Objective, points: Points):
    """H, V, the squares of the exact measurements' residuals, and the degrees of
    freedom."""
    study = objective.study
    rows, used, u = _rows(objective, points)
    exact = used & (study.censored.ravel() == 0)
    prior = objective.prior_information(points.x[0])
    taken = leverages(objective, points).ravel()
    freedom = float(np.sum(exact) - np.sum(taken[exact]))
    h, v = _of_loss(objective, u, exact, taken, freedom)
    weights = np.where(used, _weights(objective), 0.0)
    curvature = (rows.T * (weights * h)) @ rows + np.diag(prior)
    variance = (rows.T * (weights**2 * v)) @ rows + np.diag(prior)
    return curvature, variance, float(np.sum(u[exact] ** 2)), freedom


def _of_loss(objective, u, exact, taken, freedom):
    """h and v of every cell."""
    study = objective.study
    of = losses(u, study.censored.ravel(), study.loss)
    mean_curvature = mean_square = 1.0
    if study.loss != "gaussian" and np.any(exact):
        count = np.sum(exact)
        mean_curvature = np.mean(true_curvature(u[exact], study.loss))
        mean_square = np.sum(of.slope[exact] ** 2) / max(freedom, 1.0)
        # All residuals far out: as if each told a tenth of what it should.
        mean_curvature = max(mean_curvature, 0.1 * np.sum(of.curvature[exact]) / count)
    square = np.where(exact, mean_square, of.curvature)
    if freedom >= MANY:
        own = of.slope**2 / np.maximum(1.0 - taken, LEAST_LEFT)
        for target in np.flatnonzero(~study.sigma_given):
            cells = np.zeros(study.known.shape, bool)
            cells[:, target] = True
            cells = cells.ravel() & exact
            # Less than the mean square only where sigma is the least that is believed.
            mean = max(np.mean(own[cells]), 1e-300) if np.any(cells) else 1.0
            square[cells] = own[cells] * max(1.0, mean_square / mean)
    return np.where(exact, mean_curvature, of.curvature), square


def _sandwich(curvature: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """H^-1 V H^-1, with a very large variance where H says nothing."""
    values, vectors = np.linalg.eigh(curvature)
    empty = values <= LEAST_EIGENVALUE * max(values[-1], 0.0)
    # Rounding in such a direction must not reach the other unknowns.
    clean = np.where(empty & (np.abs(vectors) < 1e-6), 0.0, vectors)
    inverse = np.where(empty, 0.0, 1.0 / np.where(empty, 1.0, values))
    half = clean * inverse
    covariance = half @ (clean.T @ variance @ clean) @ half.T
    return covariance + (clean * np.where(empty, NO_INFORMATION, 0.0)) @ clean.T


def _fisher(curvature: np.ndarray, variance: np.ndarray, soil: int) -> np.ndarray:
    """H V^-1 H of the soil's parameters, the nuisances left free. Not the inverse of
    the covariance, in which directions of which nothing is known drown the others."""
    information = curvature @ _pseudo_inverse(variance) @ curvature
    between = information[:soil, soil:]
    others = _pseudo_inverse(information[soil:, soil:])
    return information[:soil, :soil] - between @ others @ between.T


def _pseudo_inverse(matrix: np.ndarray) -> np.ndarray:
    """Inverse without the directions of which it says nothing."""
    if not len(matrix):
        return matrix
    values, vectors = np.linalg.eigh(matrix)
    empty = values <= LEAST_EIGENVALUE * max(values[-1], 0.0)
    inverse = np.where(empty, 0.0, 1.0 / np.where(empty, 1.0, values))
    return (vectors * inverse) @ vectors.T

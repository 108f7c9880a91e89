r"""Covariance and standard errors of the unknowns at the best fit.

With J the Jacobian of the predictions over sigma with respect to x, w the weights of
the targets and P the information of the priors, the curvature of the objective and the
variance of its gradient are

$$ H = \sum_i w_i h_i J_i^T J_i + P, \qquad
   V = s^2 \sum_i w_i^2 v_i J_i^T J_i + P, $$

with h and v those of the loss: 1 for Gaussian scatter, the curvature of the loss for a
limit; for a robust loss the mean of its second derivative, and of its slope squared
over (n - p) / n (Huber 1981, section 7.6). The covariance is H^-1 V H^-1, its inverse
the Fisher matrix. The inflation s^2 is 1; where sigmas are given and the misfit is
larger than they allow, it is the reduced chi-square, in which a robust loss has the sum
of u times its slope, over its mean under Gaussian scatter. Priors are not inflated:
residuals say nothing about them.

Where the sigma of a target is estimated from many measurements, v is the squared slope
of each over 1 - leverage, so that the scatter may differ between tests (White 1980;
MacKinnon and White 1985). Of few, V has another term: weights by sigmas that are
estimated, of a target k from nu_k degrees of freedom, make a fit scatter more than
H^-1, and H^-1 too small (Kenward and Roger 1997, Biometrics 53, 983):

$$ \sum_k \frac{4 w_k}{\nu_k} (A_k - A_k H^{-1} A_k), \qquad
   A_k = \sum_{i \text{ of } k} w_k J_i^T J_i, $$

with w_k the weight of the target.
"""

from typing import NamedTuple

import numpy as np

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import chdtrc, ndtri, stdtrit

from ..estimation.linear_algebra import LEAST_EIGENVALUE, inverse_positive
from ..estimation.sigma import (
    IMPROBABLE,
    freedom_of_targets,
    hat,
    leverages,
    pseudo_inverse,
    sharing_scale,
    standardised_rows,
    weights_of_cells,
)
from ..problem.config import Study
from ..problem.noise import LOSSES, Losses, losses, scale_of_normal, true_curvature
from ..problem.objective import Objective, Points
from .posterior import Draws

USELESS_ERROR = 1.0
"""Standard error in x above which a parameter is not identifiable."""
CONFIDENCE = 0.95
TAIL = (1.0 - CONFIDENCE) / 2.0
"""Probability beyond either end of an interval."""
LEAST_LEFT = 0.1
"""Least 1 - leverage: a measurement that alone rules the fit has no residual."""
MANY = 20.0
"""Degrees of freedom from which the scatter is estimated test by test."""


class Uncertainty(NamedTuple):
    """Covariance in x: standard errors are relative for positive parameters."""

    inflation: float
    """Factor on the squares of the given sigmas; 1 where they can be true."""
    reduced_chi_square: float
    """Chi-square of the exact measurements over the degrees of freedom; NaN without
    any."""
    degrees_of_freedom: float
    """Number of exact measurements less the sum of their leverages."""
    quantile: np.ndarray
    """Half widths of the 95 % confidence intervals of the soil's parameters in standard
    errors, shape (parameters,): of Student's distribution where the scatter was
    estimated."""
    quantile_of_all: float
    """The same of a measurement, by all degrees of freedom."""
    profile_scale: np.ndarray
    """Variance of each unknown over that of the curvature alone, shape (unknowns,): 1
    where both matrices above are the same, the inflation without priors."""
    covariance: np.ndarray
    """Covariance in x, shape (unknowns, unknowns)."""
    standard_errors: np.ndarray
    """Standard errors in x, shape (unknowns,)."""
    correlation: np.ndarray
    """Correlation, shape (unknowns, unknowns)."""
    eigenvalues: np.ndarray
    """Eigenvalues, ascending, of the Fisher matrix of the soil's parameters with the
    nuisances left free, shape (parameters,)."""
    eigenvectors: np.ndarray
    """Eigenvectors, one a column."""


def estimate(objective: Objective, points: Points) -> Uncertainty:
    """Estimate the uncertainty at a fit (points of one lane).

    An unknown without influence gets a very large standard error, not NaN.
    """
    study = objective.study
    soil = len(study.parameters)
    curvature, variance, prior, chi_square, freedom = _parts(objective, points)
    reduced = chi_square / freedom if freedom > 0.5 else float("nan")
    all_given = np.all(study.sigma_given)
    poor = all_given and freedom > 0.5 and chdtrc(freedom, chi_square) < IMPROBABLE
    inflation = reduced if poor else 1.0
    curvature, variance = curvature + prior, variance * inflation + prior
    covariance = _sandwich(curvature, variance)
    alone = np.diag(pseudo_inverse(curvature))
    known = (np.diag(covariance) < 1e12) & (alone > 0.0)
    variances = np.diag(covariance) / np.where(known, alone, 1.0)
    scale = np.where(known, variances, inflation)
    of_all = freedom if not all_given or inflation > 1.0 else np.inf
    of_each = np.full(soil, of_all)
    if not all_given:
        of_each = freedom_of_variances(objective, points)
    fisher = _fisher(curvature, variance, soil)
    return Uncertainty(
        inflation=inflation,
        reduced_chi_square=reduced,
        degrees_of_freedom=freedom,
        quantile=_quantile(of_each),
        quantile_of_all=float(_quantile(of_all)),
        profile_scale=scale,
        **_of_covariance(covariance, fisher),
    )


def _quantile(freedom) -> np.ndarray:
    """Compute Student's quantile, which is the normal one of infinite degrees of
    freedom."""
    half = 0.5 + CONFIDENCE / 2.0
    return np.where(
        np.isinf(freedom), ndtri(half), stdtrit(np.maximum(freedom, 1.0), half)
    )


def freedom_of_variances(objective: Objective, points: Points) -> np.ndarray:
    r"""Compute the degrees of freedom of the variances of the soil's parameters, shape
    (parameters,), by Satterthwaite's rule, 2 mean^2 / variance (1946, Biometrics
    Bulletin 2, 110).

    With w the part of a variance that each measurement brings, it is

    $$ 1 \Big/ \sum_k \frac{1}{\nu_k} \Big(\sum_{i \text{ of } k} w_i \Big)^2 ,
       \qquad
       1 \Big/ \sum_{il} \frac{w_i}{M_{ii}} \frac{w_l}{M_{ll}} M_{il}^2 , $$

    the second for many measurements, whose scatter is estimated test by test (Bell and
    McCaffrey 2002, Survey Methodology 28, 169; Imbens and Kolesar 2016, Review of
    Economics and Statistics 98, 701). M is 1 less the hat matrix. Where sigma is given
    w counts as 0, and the sum of w is below 1.
    """
    rows, inverse = hat(objective, points)
    left = 1.0 - np.sum(rows @ inverse * rows, axis=1)
    total = np.diag(inverse)[: len(objective.study.parameters)]
    # A parameter at its bound has no variance.
    known = total > 0.0
    parts = (rows @ inverse[:, : len(total)]) ** 2 / np.where(known, total, 1.0)
    scales = _scales(objective, points)
    freedom = np.sum(freedom_of_targets(objective, points))
    if freedom < MANY:
        spread = sum(np.sum(parts[cells], axis=0) ** 2 / nu for cells, nu in scales)
    else:
        estimated = np.any([cells for cells, _ in scales], axis=0)
        parts[~estimated] = 0.0
        parts = parts / np.maximum(left, LEAST_LEFT)[:, None]
        between = [(rows.T * part) @ rows @ inverse for part in parts.T]
        # The trace of (W M)^2, with M = 1 - B C B^T.
        spread = (2.0 * left - 1.0) @ parts**2
        spread += [np.sum(one * one.T) for one in between]
    return np.where(known, 1.0 / np.maximum(spread, 1e-12), freedom)


def _scales(objective: Objective, points: Points) -> list[tuple[np.ndarray, float]]:
    """List the exact cells, as a mask, from which each factor on sigmas is estimated,
    and its degrees of freedom, 1 at least."""
    study, scales = objective.study, []
    freedom = freedom_of_targets(objective, points)
    for targets in sharing_scale(study, freedom):
        of_these = np.isin(np.arange(len(study.targets)), targets)
        cells = study.exact & np.isfinite(points.predicted[0]) & of_these
        scales.append((cells.ravel(), max(float(np.sum(freedom[targets])), 1.0)))
    return scales


def _of_covariance(covariance: np.ndarray, fisher: np.ndarray) -> dict:
    """Compute the fields of `Uncertainty` that follow from a covariance, and from the
    Fisher matrix of the soil's parameters."""
    errors = np.sqrt(np.diag(covariance))
    values, vectors = np.linalg.eigh(fisher)
    return dict(
        covariance=covariance,
        standard_errors=errors,
        correlation=covariance / np.outer(errors, errors),
        eigenvalues=np.maximum(values, 0.0),
        eigenvectors=vectors,
    )


def from_draws(
    uncertainty: Uncertainty,
    draws: Draws,
    points: Points,
    soil: int,
    matrix: np.ndarray | None = None,
) -> Uncertainty:
    r"""Replace the covariance by the mean square of the distances of draws from a fit,

    $$ \sum_i w_i (x_i - \hat x)(x_i - \hat x)^T , $$

    that of the posterior and the square of the distance of its mean: beside a jump the
    fit lies at an edge of the posterior.

    Args:
        points: the fit, of one lane.
        soil: number of the soil's parameters, the first of the unknowns.
        matrix: that of `stretch`, if there is one.
    """
    apart = draws.x - points.x[0]
    if matrix is not None:
        apart = apart @ matrix.T
    covariance = (apart.T * draws.weights) @ apart
    fisher = inverse_positive(covariance[:soil, :soil])
    return uncertainty._replace(**_of_covariance(covariance, fisher))


def regular_covariance(
    objective: Objective, points: Points, inflation: float
) -> np.ndarray:
    """Compute the covariance in x with the bounds as a weak prior: always finite.

    An unknown without a prior gets the information of a uniform distribution over its
    range, 12 / range^2.
    """
    curvature, variance, prior, _, _ = _parts(objective, points)
    # As much beside the curvature as with sigmas that need no inflation.
    extra = inflation * np.diag(objective.bounds_information)
    half = inverse_positive(curvature + prior + extra)
    return half @ (inflation * (variance + extra) + prior) @ half


def laplace(objective: Objective, points: Points, inflation: float) -> np.ndarray:
    """Approximate the covariance of the posterior by Laplace's method: from the
    curvature alone, with the sigmas taken as true."""
    curvature, _, prior, _, _ = _parts(objective, points)
    extra = np.diag(objective.bounds_information)
    return inverse_positive(curvature / inflation + prior + extra)


def stretch(
    objective: Objective, points: Points, inflation: float
) -> np.ndarray | None:
    r"""Compute the matrix by which draws of the posterior, as distances from the fit in
    x, get the covariance of the estimate, shape (unknowns, unknowns).

    $$ T = L^{-T} (L^{-1} V L^{-T})^{1/2} L^T , \qquad H = L L^T : $$

    weights of targets and robust losses make H, the curvature of the cost, another
    matrix than V, the variance of its gradient (Ribatet, Cooley and Davison 2012,
    Statistica Sinica 22, 813). None where they are equal but for estimated sigmas.
    """
    if objective.study.is_likelihood:
        return None
    terms = _terms(objective, points)
    own = objective.prior_information(points.x[0]) + objective.bounds_information
    curvature, variance = (
        part / inflation + np.diag(own)
        for part in (terms.curvature, terms.variance(terms.v))
    )
    root = np.linalg.cholesky(curvature)
    inner = np.linalg.solve(root, np.linalg.solve(root, variance).T)
    values, vectors = np.linalg.eigh(0.5 * (inner + inner.T))
    inner = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    return np.linalg.solve(root.T, inner @ root.T)


class _Terms(NamedTuple):
    """What H and V are made of, cell by cell."""

    rows: np.ndarray
    """Jacobian over sigma, shape (cells, unknowns)."""
    weights: np.ndarray
    """Weights, shape (cells,); 0 of cells that are not used."""
    h: np.ndarray
    v: np.ndarray
    """h and v of the loss, shape (cells,)."""
    of: Losses
    u: np.ndarray
    """Residuals over sigma, shape (cells,)."""
    exact: np.ndarray
    """Mask of the exact measurements, shape (cells,)."""
    leverage: np.ndarray
    freedom: float
    """Degrees of freedom."""

    @property
    def curvature(self) -> np.ndarray:
        """Part of the tests in H."""
        return (self.rows.T * (self.weights * self.h)) @ self.rows

    def variance(self, v: np.ndarray) -> np.ndarray:
        """Compute the part of the tests in V, with v of each cell."""
        return (self.rows.T * (self.weights**2 * v)) @ self.rows


def _terms(objective: Objective, points: Points) -> _Terms:
    study = objective.study
    rows, used, u = standardised_rows(objective, points)
    exact = used & (study.censored.ravel() == 0)
    leverage = leverages(objective, points).ravel()
    freedom = float(np.sum(exact) - np.sum(leverage[exact]))
    of = losses(u, study.censored.ravel(), study.loss)
    h, v = _of_loss(study, of, u, exact, freedom)
    weights = np.where(used, weights_of_cells(study), 0.0)
    return _Terms(rows, weights, h, v, of, u, exact, leverage, freedom)


def _parts(objective: Objective, points: Points):
    """Compute the parts of the tests in H and, before inflation, in V, the part P of
    the priors, the chi-square of the exact residuals, and the degrees of freedom."""
    study, terms = objective.study, _terms(objective, points)
    prior = np.diag(objective.prior_information(points.x[0]))
    v = _of_each_test(study, terms) if terms.freedom >= MANY else terms.v
    variance = terms.variance(v)
    if terms.freedom < MANY:
        variance += _of_estimated_weights(objective, points)
    works = (terms.u * terms.of.slope)[terms.exact]
    chi_square = float(np.sum(works) / scale_of_normal(study.loss))
    return terms.curvature, variance, prior, chi_square, terms.freedom


def _of_estimated_weights(objective: Objective, points: Points) -> np.ndarray:
    """Compute Kenward and Roger's term of V."""
    rows, inverse = hat(objective, points)
    term = np.zeros_like(inverse)
    for cells, nu in _scales(objective, points):
        information = rows[cells].T @ rows[cells]
        weight = np.max(weights_of_cells(objective.study)[cells], initial=0.0)
        left = information - information @ inverse @ information
        term += 4.0 * weight / nu * left
    return term


def _of_loss(
    study: Study, of: Losses, u: np.ndarray, exact: np.ndarray, freedom: float
) -> tuple[np.ndarray, np.ndarray]:
    """Compute h and v of the loss, shape (cells,)."""
    mean_curvature = mean_square = 1.0
    if study.loss != LOSSES[0] and np.any(exact):
        count = np.sum(exact)
        mean_curvature = np.mean(true_curvature(u[exact], study.loss))
        mean_square = np.sum(of.slope[exact] ** 2) / max(freedom, 1.0)
        # With all residuals large the mean may vanish: at least a tenth of the secant.
        mean_curvature = max(mean_curvature, 0.1 * np.sum(of.curvature[exact]) / count)
    h = np.where(exact, mean_curvature, of.curvature)
    return h, np.where(exact, mean_square, of.curvature)


def _of_each_test(study: Study, terms: _Terms) -> np.ndarray:
    """Compute v of each measurement, where sigma is estimated, in place of that of the
    loss, shape (cells,)."""
    of_each = terms.of.slope**2 / np.maximum(1.0 - terms.leverage, LEAST_LEFT)
    v, mean_square = terms.v.copy(), np.max(terms.v[terms.exact], initial=0.0)
    for target in np.flatnonzero(~study.sigma_given):
        cells = np.zeros(study.known.shape, bool)
        cells[:, target] = True
        cells = cells.ravel() & terms.exact
        # The mean square is smaller only where sigma is at its lower limit.
        mean = max(np.mean(of_each[cells]), 1e-300) if np.any(cells) else 1.0
        v[cells] = of_each[cells] * max(1.0, mean_square / mean)
    return v


def _sandwich(curvature: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Compute H^-1 V H^-1, with a very large variance where H vanishes."""
    values, vectors = np.linalg.eigh(curvature)
    empty = values <= LEAST_EIGENVALUE * max(values[-1], 0.0)
    # Rounding in such a direction must not reach the other unknowns.
    clean = np.where(empty & (np.abs(vectors) < 1e-6), 0.0, vectors)
    inverse = np.where(empty, 0.0, 1.0 / np.where(empty, 1.0, values))
    half = clean * inverse
    covariance = half @ (clean.T @ variance @ clean) @ half.T
    return covariance + (clean * np.where(empty, 1e30, 0.0)) @ clean.T


def _fisher(curvature: np.ndarray, variance: np.ndarray, soil: int) -> np.ndarray:
    """Compute H V^-1 H of the soil's parameters with the nuisances left free.

    The inverse of the covariance would lose it to rounding beside directions without
    information.
    """
    information = curvature @ pseudo_inverse(variance) @ curvature
    between = information[:soil, soil:]
    others = pseudo_inverse(information[soil:, soil:])
    return information[:soil, :soil] - between @ others @ between.T

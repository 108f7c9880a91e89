r"""How well the data determine the parameters, from the Jacobian at the best fit.

With J the Jacobian of the residuals by the coordinates of the errors (the logarithm of
a positive parameter; otherwise the parameter over half its range) and s^2 the variance
of the residuals, the Fisher matrix is F = J^T J / s^2, the covariance its inverse.
"""

from typing import NamedTuple

import numpy as np

from .transforms import Bounds

USELESS_ERROR = 1.0
"""A standard error above this, relative, says that the data do not determine it."""
LEAST_EIGENVALUE = 1e-12
"""Part of the largest eigenvalue below which one counts as nothing: rounding."""
NO_INFORMATION = 1e30
"""Variance along a direction of which the data say nothing."""


class Uncertainty(NamedTuple):
    """Errors in the coordinates of the errors: relative for positive parameters."""

    variance: float
    """s^2: 1 where sigmas are given, else estimated from the residuals."""
    variance_estimated: bool
    reduced_chi_square: float
    """Sum of squared residuals over the degrees of freedom; NaN without any."""
    degrees_of_freedom: int
    standard_errors: np.ndarray
    correlation: np.ndarray
    eigenvalues: np.ndarray
    """Of the Fisher matrix, ascending."""
    eigenvectors: np.ndarray
    """One a column."""


def jacobian_in_errors(bounds: Bounds, z, jacobian) -> np.ndarray:
    """The Jacobian by z turned into that by the coordinates of the errors."""
    return np.asarray(jacobian) / bounds.slope(z)


def estimate(residuals, failed, jacobian, *, sigma_given: bool) -> Uncertainty:
    """Uncertainty of a fit.

    Args:
        residuals, failed: flat, at the fit; failed ones say nothing.
        jacobian: `(residuals, parameters)` in the coordinates of the errors.
        sigma_given: whether the residuals are in units of known sigmas.

    A parameter without any influence gets a very large standard error, not NaN.
    """
    known = np.asarray(failed) == 0.0
    residuals, jacobian = np.asarray(residuals)[known], np.asarray(jacobian)[known]
    size = jacobian.shape[1]
    freedom = len(residuals) - size
    squares = float(np.sum(residuals**2))
    reduced = squares / freedom if freedom > 0 else float("nan")
    # Without a degree of freedom, or with a perfect fit, scatter cannot be estimated.
    variance = 1.0 if sigma_given or not reduced > 0.0 else reduced
    fisher = jacobian.T @ jacobian / variance
    values, vectors = np.linalg.eigh(fisher)
    empty = values <= LEAST_EIGENVALUE * max(values[-1], 0.0)
    inverse = np.where(empty, NO_INFORMATION, 1.0 / np.where(empty, 1.0, values))
    # Rounding in such a direction must not reach the other parameters.
    clean = np.where(empty & (np.abs(vectors) < 1e-6), 0.0, vectors)
    covariance = (clean * inverse) @ clean.T
    errors = np.sqrt(np.diag(covariance))
    return Uncertainty(
        variance=variance,
        variance_estimated=not sigma_given,
        reduced_chi_square=reduced,
        degrees_of_freedom=freedom,
        standard_errors=errors,
        correlation=covariance / np.outer(errors, errors),
        eigenvalues=values,
        eigenvectors=vectors,
    )

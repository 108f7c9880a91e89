"""Linear algebra with positive matrices that may be singular, never an exception.

The inverse scales a matrix to a unit diagonal first, so that unknowns of very different
influence keep their digits beside each other; the pseudo-inverse leaves out what
vanishes beside the largest.
"""

import numpy as np

LEAST = 1e-14
"""Least eigenvalue of a scaled matrix: below is rounding."""
LEAST_EIGENVALUE = 1e-12
"""Fraction of the largest eigenvalue below which one counts as zero: rounding."""


def inverse_positive(matrix: np.ndarray) -> np.ndarray:
    """Invert positive matrices, shape (..., n, n): symmetric, positive and finite.

    A direction that is lost to rounding gets the largest variance that double precision
    can tell from it, not a negative or an infinite one.
    """
    diagonal = np.einsum("...pp->...p", matrix)
    root = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scale = root[..., :, None] * root[..., None, :]
    scaled = matrix / scale
    values, vectors = np.linalg.eigh(0.5 * (scaled + np.swapaxes(scaled, -1, -2)))
    values = np.maximum(values, LEAST)
    return (vectors / values[..., None, :]) @ np.swapaxes(vectors, -1, -2) / scale


def pseudo_inverse(matrix: np.ndarray) -> np.ndarray:
    """Invert a positive matrix without the directions in which it vanishes."""
    if not len(matrix):
        return matrix
    values, vectors = np.linalg.eigh(matrix)
    empty = values <= LEAST_EIGENVALUE * max(values[-1], 0.0)
    inverse = np.where(empty, 0.0, 1.0 / np.where(empty, 1.0, values))
    return (vectors * inverse) @ vectors.T

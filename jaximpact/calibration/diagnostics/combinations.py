"""Parameter combinations: what the tests identify, and what acts together only."""

import numpy as np

from ..problem.bounds import Bounds
from ..problem.objective import Objective
from .uncertainty import USELESS_ERROR, Uncertainty

SMALL_EXPONENT = 0.1
"""Exponents below this are left out of a parameter combination."""
TOGETHER = 1e-3
"""Component of a combination without information above which a parameter acts in it."""
ENDLESS_ERROR = 1e6
"""Standard error from which a parameter is said to have no influence."""


def partners(objective: Objective, uncertainty: Uncertainty, place: int) -> list[str]:
    """Name the parameters that compensate one in combinations without information."""
    endless = uncertainty.eigenvalues < 1.0 / ENDLESS_ERROR**2
    vectors = np.abs(uncertainty.eigenvectors[:, endless])
    shared = vectors[:, vectors[place] > TOGETHER]
    names = [parameter.name for parameter in objective.study.parameters]
    return [
        name
        for other, name in enumerate(names)
        if other != place and np.any(shared[other] > TOGETHER)
    ]


def directions(names, bounds: Bounds, uncertainty: Uncertainty) -> list[str]:
    """Describe the eigenvectors of the Fisher matrix and their errors, best known
    first."""
    lines = []
    values, vectors = uncertainty.eigenvalues, uncertainty.eigenvectors.T
    for value, vector in zip(values[::-1], vectors[::-1], strict=True):
        error = 1.0 / np.sqrt(max(value, 1e-300))
        known = f"known to {100 * error:.3g} % (eigenvalue {value:.4g})"
        if error > USELESS_ERROR:
            known = f"not identifiable (eigenvalue {value:.3g})"
        lines.append(f"{combination(names, bounds, vector)}: {known}")
    return lines


def combination(names, bounds: Bounds, vector) -> str:
    """Write an eigenvector as a product of powers, the largest exponent 1.

    A parameter in linear space is written as exp(p / half its range).
    """
    vector = np.asarray(vector) / vector[np.argmax(np.abs(vector))]
    factors = []
    for place, exponent in enumerate(vector):
        if abs(exponent) < SMALL_EXPONENT:
            continue
        name = names[place]
        if not bounds.logarithmic[place]:
            half = float(bounds.upper[place] - bounds.lower[place]) / 2
            name = f"exp({name}/{half:g})"
        power = f"^{exponent:.2f}" if abs(exponent - 1.0) > 5e-3 else ""
        factors.append(name + power)
    return " ".join(factors)

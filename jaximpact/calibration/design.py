r"""Choosing rows of a linear model so that its parameters become most certain.

A measurement with derivatives J and standard deviation sigma adds

$$ \Delta M = J^T J / \sigma^2 $$

to the information M, the inverse of the covariance. D-optimal is what makes det(M)
largest, that is the ellipsoid of errors smallest; A-optimal what makes the sum of the
variances, trace(M^-1), least. Measurements are chosen one after the other, each the
best after those before it; the same may be chosen again.
"""

from typing import NamedTuple

import numpy as np

CRITERIA = ("D", "A")


class Design(NamedTuple):
    """Measurements chosen one after the other."""

    chosen: list[int]
    covariances: np.ndarray
    """Before, and after each choice, `(choices + 1, parameters, parameters)`."""


def choose(
    information: np.ndarray, gains: np.ndarray, count: int, criterion: str = "D"
) -> Design:
    """Choose measurements.

    Args:
        information: at first, `(parameters, parameters)`, positive.
        gains: of each candidate, `(candidates, parameters, parameters)`.
        count: how many to choose.
        criterion: one of `CRITERIA`.
    """
    covariances, chosen = [np.linalg.inv(information)], []
    for _ in range(count):
        best = int(np.argmax(merit(information, gains, criterion)))
        information = information + gains[best]
        chosen.append(best)
        covariances.append(np.linalg.inv(information))
    return Design(chosen, np.array(covariances))


def merit(information: np.ndarray, gains: np.ndarray, criterion: str) -> np.ndarray:
    """What each candidate brings, `(candidates,)`: the fall of the mean logarithm of
    the ellipsoid's axes, or of the logarithm of the sum of variances."""
    after = information + gains
    if criterion == "D":
        size = len(information)
        before = np.linalg.slogdet(information)[1]
        return (np.linalg.slogdet(after)[1] - before) / (2.0 * size)
    variances = np.trace(np.linalg.inv(after), axis1=1, axis2=2)
    return 0.5 * np.log(np.trace(np.linalg.inv(information)) / variances)

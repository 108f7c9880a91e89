r"""Predictive distributions: what the model gives for each draw, and scatter about it.

A distribution stands as atoms with weights: each draw's value, plus the scatter at
equally probable places. Forecasts are judged by the continuous ranked probability score

$$ \text{CRPS} = E|X - y| - \tfrac12 E|X - X'| , $$

X and X' independent draws of the prediction and y what was measured: the absolute error
of a forecast without spread, in the unit of the result; the less the better (Gneiting
and Raftery 2007).
"""

from typing import NamedTuple

import numpy as np

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import ndtri, stdtrit

CONFIDENCES = (0.5, 0.95)
"""Of the intervals that are told."""
PLACES = 101
"""Of the scatter, about each draw: the outermost leave half a per cent beyond."""
NORMAL_FROM = 200.0
"""Degrees of freedom from which Student's distribution passes for normal."""


class Predictive(NamedTuple):
    """Of one measurement; atoms ascending."""

    atoms: np.ndarray
    weights: np.ndarray
    """They sum to 1."""

    def quantile(self, part: float) -> float:
        """The value below which a part of the distribution lies."""
        middle = np.cumsum(self.weights) - 0.5 * self.weights
        return float(np.interp(part, middle, self.atoms))

    def above(self, value: float) -> float:
        """The chance of more."""
        return float(np.sum(self.weights[self.atoms > value]))

    def crps(self, measured: float) -> float:
        """The score of what was measured."""
        apart = np.sum(self.weights * np.abs(self.atoms - measured))
        upto = np.cumsum(self.weights)
        spread = np.sum(self.weights * self.atoms * (2.0 * upto - self.weights - 1.0))
        return float(apart - spread)


def predictive(
    values: np.ndarray, weights: np.ndarray, sigma: float, freedom: float = np.inf
) -> Predictive | None:
    """The distribution of a measurement; None where no draw has a value.

    Args:
        values: what the model gives for each draw, NaN where nothing.
        weights: of the draws.
        sigma: standard deviation of the scatter; 0 for the model's value itself.
        freedom: degrees of freedom from which sigma was estimated: the scatter is
            Student's then.
    """
    there = np.isfinite(values) & (weights > 0.0)
    if not np.any(there):
        return None
    atoms, weights = values[there], weights[there]
    if sigma > 0.0:
        parts = (np.arange(PLACES) + 0.5) / PLACES
        scatter = ndtri(parts) if freedom >= NORMAL_FROM else stdtrit(freedom, parts)
        atoms = (atoms[:, None] + sigma * scatter).ravel()
        weights = np.repeat(weights, PLACES)
    order = np.argsort(atoms, kind="stable")
    return Predictive(atoms[order], weights[order] / np.sum(weights))

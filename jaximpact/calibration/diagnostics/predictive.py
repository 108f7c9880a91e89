r"""Predictive distributions: the model at each draw plus the scatter of measurements,
and the discrepancy of the model.

A distribution is held as weighted atoms: the value of each draw plus equally probable
values of the scatter. Forecasts are judged by the continuous ranked probability score

$$ \text{CRPS} = E|X - y| - \tfrac12 E|X - X'| , $$

with X and X' independent draws of the prediction and y the measurement: for a forecast
without spread the absolute error, in the unit of the result; smaller is better
(Gneiting and Raftery 2007).
"""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri, stdtr, stdtrit

from ...quantities import NEVER_NEGATIVE
from ..problem.objective import Objective
from .posterior import Draws
from .uncertainty import TAIL

# Not scipy.stats, which takes 0.6 s to import.

PLACES = 101
"""Values of the scatter about each draw: half a per cent lies beyond the outermost."""
NORMAL_FROM = 200.0
"""Degrees of freedom above which Student's distribution is taken as normal."""


class Predictive(NamedTuple):
    """Predictive distribution of one measurement; atoms ascending."""

    atoms: np.ndarray
    weights: np.ndarray
    """Weights of the atoms; their sum is 1."""

    def quantile(self, fraction: float) -> float:
        """Compute the value below which a fraction of the distribution lies."""
        middle = np.cumsum(self.weights) - 0.5 * self.weights
        return float(np.interp(fraction, middle, self.atoms))

    def above(self, value: float) -> float:
        """Compute the probability of a larger value."""
        # Rounding may carry a sum of all weights past 1
        return min(1.0, float(np.sum(self.weights[self.atoms > value])))

    def crps(self, measured: float) -> float:
        """Compute the score of a measurement."""
        apart = np.sum(self.weights * np.abs(self.atoms - measured))
        upto = np.cumsum(self.weights)
        spread = np.sum(self.weights * self.atoms * (2.0 * upto - self.weights - 1.0))
        return float(apart - spread)


def predictive(
    values: np.ndarray,
    weights: np.ndarray,
    sigma: float,
    freedom: float = np.inf,
    *,
    discrepancy: float = 0.0,
    positive: bool = False,
) -> Predictive | None:
    """Make the distribution of a measurement; None where no draw has a value.

    Args:
        values: value of the model at each draw; NaN where there is none.
        weights: weights of the draws.
        sigma: standard deviation of the scatter; 0 for the value of the model itself.
        freedom: degrees of freedom from which sigma and discrepancy were estimated;
            both then follow Student's distribution.
        discrepancy: standard deviation of the discrepancy; counts only beside a sigma.
        positive: whether a measurement is never negative; its logarithm scatters then,
            and the value of the model and sigma are mean and standard deviation of the
            lognormal distribution. The discrepancy widens it about the same median.
    """
    there = np.isfinite(values) & (weights > 0.0)
    if not np.any(there):
        return None
    atoms, weights = values[there], weights[there]
    if sigma > 0.0:
        parts = (np.arange(PLACES) + 0.5) / PLACES
        scatter = ndtri(parts) if freedom >= NORMAL_FROM else stdtrit(freedom, parts)
        middle, spread = atoms[:, None], sigma
        if positive:
            middle, spread = _logarithm(middle, sigma)
        apart = discrepancy
        if positive and discrepancy > 0.0:
            apart = _logarithm(atoms[:, None], discrepancy)[1]
        atoms = (middle + np.hypot(spread, apart) * scatter).ravel()
        atoms = np.exp(atoms) if positive else atoms
        weights = np.repeat(weights, PLACES)
    order = np.argsort(atoms, kind="stable")
    return Predictive(atoms[order], weights[order] / np.sum(weights))


def _logarithm(values: np.ndarray, sigma) -> tuple[np.ndarray, np.ndarray]:
    """Compute mean and standard deviation of the logarithm of lognormal measurements,
    from the values of the model and sigma."""
    # A model that says 0 must not have intervals of no width.
    mean = np.maximum(values, 0.5 * sigma)
    square = np.log1p((sigma / mean) ** 2)
    return np.log(mean) - 0.5 * square, np.sqrt(square)


class Bands(NamedTuple):
    """95 % bands of every test and target, shape (tests, targets); NaN where no draw
    has a prediction.

    `low`, `middle` and `high` belong to the value of the model, whose unknowns are
    uncertain; `measured_low` and `measured_high` to a measurement, which scatters about
    it.
    """

    low: np.ndarray
    middle: np.ndarray
    high: np.ndarray
    measured_low: np.ndarray
    measured_high: np.ndarray


def bands_of(
    objective: Objective,
    draws: Draws,
    inflation: float,
    weights: np.ndarray,
    freedom: np.ndarray,
) -> Bands:
    """Compute the bands from draws. A measurement scatters as in `predictive`.

    Args:
        objective: objective with the sigmas of the fit, whose squares are multiplied by
            the inflation.
        weights: weights of the draws, as predictions take them; their sum is 1.
        freedom: degrees of freedom from which the sigma of each target was estimated,
            shape (targets,); infinite where it was given.
    """
    there = np.isfinite(draws.predicted)
    weights = np.where(there, weights[:, None, None], 0.0)
    total = np.sum(weights, axis=0)
    share = weights / np.where(total > 0.0, total, 1.0)
    values = np.where(there, draws.predicted, 0.0)
    positive = np.isin(objective.study.targets, NEVER_NEGATIVE)
    scatter = objective.sigma * np.sqrt(inflation)
    middle, spread = values.copy(), np.broadcast_to(scatter, values.shape).copy()
    scaled = _logarithm(values[..., positive], scatter[:, positive])
    middle[..., positive], spread[..., positive] = scaled
    known = np.full(len(freedom), np.inf)
    rows = [
        *(_quantile(values, share, 0.0, known, p) for p in (TAIL, 0.5, 1.0 - TAIL)),
        *(_quantile(middle, share, spread, freedom, p) for p in (TAIL, 1.0 - TAIL)),
    ]
    for row in rows[3:]:
        row[:, positive] = np.exp(row[:, positive])
    return Bands(*(np.where(total > 0.0, row, np.nan) for row in rows))


def _quantile(values, weights, sigma, freedom, part: float) -> np.ndarray:
    """Compute a quantile of a mixture of Student's distributions (draws, ...) by
    bisection, between the smallest and the largest quantile of one of them."""
    there = weights > 0.0
    normal = freedom >= NORMAL_FROM
    few = np.where(normal, 1.0, freedom)
    of_one = values + sigma * np.where(normal, ndtri(part), stdtrit(few, part))
    low = np.min(np.where(there, of_one, np.inf), axis=0)
    high = np.max(np.where(there, of_one, -np.inf), axis=0)
    empty = ~np.any(there, axis=0)
    low, high = np.where(empty, 0.0, low), np.where(empty, 0.0, high)
    for _ in range(50):
        middle = 0.5 * (low + high)
        apart = middle - values
        ratio = apart / np.where(sigma > 0.0, sigma, 1.0)
        smooth = np.where(normal, ndtr(ratio), stdtr(few, ratio))
        below = np.where(sigma > 0.0, smooth, (apart >= 0.0).astype(float))
        under = np.sum(weights * below, axis=0) < part
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    return 0.5 * (low + high)

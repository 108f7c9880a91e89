"""Where the data leave the prediction of each measurement: bands of 95 %."""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from .draws import Draws
from .objective import Objective
from .uncertainty import CONFIDENCE

HALVINGS = 50


class Bands(NamedTuple):
    """Of every test and target, `(tests, targets)`; NaN where no draw has a prediction.

    The first three are of the model's value, for the unknowns are uncertain; the last
    two are of a measurement, which scatters about it.
    """

    low: np.ndarray
    middle: np.ndarray
    high: np.ndarray
    measured_low: np.ndarray
    measured_high: np.ndarray
    failed_part: np.ndarray
    """Weight of the draws for which there is no prediction."""

    def inside(self, measured: np.ndarray) -> np.ndarray:
        """Which measurements lie in the band of measurements."""
        return (measured >= self.measured_low) & (measured <= self.measured_high)


def bands_of(objective: Objective, draws: Draws, inflation: float) -> Bands:
    """Bands from draws.

    Args:
        objective: with the sigmas of the fit.
        inflation: of the sigmas' squares.
    """
    tail = (1.0 - CONFIDENCE) / 2.0
    there = np.isfinite(draws.predicted)
    weights = np.where(there, draws.weights[:, None, None], 0.0)
    total = np.sum(weights, axis=0)
    share = weights / np.where(total > 0.0, total, 1.0)
    values = np.where(there, draws.predicted, 0.0)
    nothing = np.zeros_like(objective.sigma)
    scatter = objective.sigma * np.sqrt(inflation)
    rows = [
        np.where(total > 0.0, _quantile(values, share, sigma, part), np.nan)
        for part, sigma in (
            (tail, nothing),
            (0.5, nothing),
            (1.0 - tail, nothing),
            (tail, scatter),
            (1.0 - tail, scatter),
        )
    ]
    return Bands(*rows, failed_part=np.clip(1.0 - total, 0.0, 1.0))


def _quantile(values, weights, sigma, part: float) -> np.ndarray:
    """Of a mixture of normal distributions `(draws, ...)`, by halving."""
    there = weights > 0.0
    reach = 6.0 * sigma
    low = np.min(np.where(there, values, np.inf), axis=0) - reach
    high = np.max(np.where(there, values, -np.inf), axis=0) + reach
    empty = ~np.any(there, axis=0)
    low, high = np.where(empty, 0.0, low), np.where(empty, 0.0, high)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        apart = middle - values
        below = np.where(
            sigma > 0.0,
            ndtr(apart / np.where(sigma > 0.0, sigma, 1.0)),
            (apart >= 0.0).astype(float),
        )
        under = np.sum(weights * below, axis=0) < part
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    return 0.5 * (low + high)

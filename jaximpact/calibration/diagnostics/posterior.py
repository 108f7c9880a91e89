"""Draws of a posterior, weighted or in chains."""

from typing import NamedTuple

import numpy as np

from ...accuracy import Accuracy

FEWEST = 50
"""Effective sample size below which draws are not to be trusted."""
ROUGH = 0.05
"""Largest tolerated error of a cost over s^2: the relative error of a weight."""


class Chains(NamedTuple):
    """Diagnostics of the chains of NUTS."""

    statistics: dict[str, np.ndarray]
    """Statistics of each trajectory by ArviZ's names, shape (chains, draws): logarithm
    of the density up to a constant, divergence (as at discontinuities), mean acceptance
    probability, number of leapfrog steps."""
    scale_reduction: np.ndarray
    """R-hat of the unknowns, shape (unknowns,): near 1 where the chains agree."""
    effective: np.ndarray
    """Effective sample sizes, the same shape."""
    seconds: float
    """Wall time [s]."""


class Draws(NamedTuple):
    """Draws of the posterior, and the predictions at them."""

    x: np.ndarray
    """Unknowns, shape (draws, unknowns); chain after chain."""
    log_weights: np.ndarray
    """Logarithms of the weights up to a constant, shape (draws,)."""
    cost: np.ndarray
    """Objective function, shape (draws,)."""
    predicted: np.ndarray
    """Predictions, shape (draws, tests, targets); NaN where there is none."""
    effective_fraction: np.ndarray
    """Effective sample size as a fraction of the draws so far, after each round of
    importance sampling; the last belongs to these draws, the first tells how near to
    normal the posterior is."""
    accuracy: Accuracy
    """Accuracy of the impacts."""
    error: float
    """Largest error of a cost over s^2 among the draws computed again; NaN before
    that."""
    chains: Chains | None = None
    """Diagnostics of the chains; None for draws by importance sampling."""

    @property
    def weights(self) -> np.ndarray:
        """Weights, shape (draws,); their sum is 1."""
        return normalised(self.log_weights)

    @property
    def effective(self) -> float:
        """Effective sample size."""
        return float(self.effective_fraction[-1] * len(self.x))

    @property
    def trusted(self) -> bool:
        """Whether the effective sample size is large enough."""
        return self.effective >= FEWEST

    @property
    def rough(self) -> bool:
        """Whether errors of the costs are too large in spite of that."""
        return self.error > ROUGH

    def thinned(self, count: int) -> "Draws":
        """Return at most so many of the draws, one of several equally far apart."""
        step = -(-len(self.x) // count)
        if step == 1:
            return self
        names = "x", "log_weights", "cost", "predicted"
        rows = {name: getattr(self, name)[::step] for name in names}
        return self._replace(**rows)

    def mean(self) -> np.ndarray:
        """Compute the posterior mean of x."""
        return moments(self.x, self.weights)[0]

    def covariance(self) -> np.ndarray:
        """Compute the posterior covariance of x."""
        return moments(self.x, self.weights)[1]


def normalised(log_weights: np.ndarray) -> np.ndarray:
    """Compute weights whose sum is 1 from their logarithms."""
    weights = np.exp(log_weights - np.max(log_weights))
    return weights / np.sum(weights)


def moments(x: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute mean and covariance of weighted rows."""
    apart = x - weights @ x
    return weights @ x, (apart.T * weights) @ apart


def variances(rows: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Compute J C J^T of predictions, shape (tests, targets), from their derivatives,
    shape (tests, targets, unknowns), and a covariance."""
    return np.einsum("rtp,pq,rtq->rt", rows, covariance, rows)


def root_of(covariance: np.ndarray) -> np.ndarray:
    """Compute a root R of a covariance R R^T."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))

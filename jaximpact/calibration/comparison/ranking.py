r"""Ranking of laws by their scores: differences, ties, and stacking weights.

With $l_{ik}$ the log predictive density of unit i by law k (a test, or a group of
tests), the expected log predictive density is $\sum_i l_{ik}$, and the difference of
two laws has the standard error $\sqrt{n}$ times the standard deviation of
$l_{ik} - l_{ij}$ over the units. Stacking weights solve

$$ \max_w \sum_i \ln \sum_k w_k \exp l_{ik}, \qquad w_k \ge 0, \ \sum_k w_k = 1 $$

(Yao, Vehtari, Simpson and Gelman 2018, Bayesian Analysis 13, 917-1007).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.special import logsumexp, softmax

SMALL_DIFFERENCE = 4.0
"""Difference of log predictive densities below which its standard error is no measure
of it (Sivula, Magnusson and Vehtari 2020), so that it is a tie."""
ERRORS = 2.0
"""Standard errors within which two laws tie."""
FEWEST_UNITS = 5
"""Number of units below which no standard error of a difference is estimated."""


class Ranking(NamedTuple):
    """Ranking of laws by one way of leaving tests out."""

    best: int
    """Index of the law that predicts best."""
    apart: np.ndarray
    """Difference of each law to the best, shape (laws,); not positive."""
    error: np.ndarray
    """Standard error of the difference; NaN with too few groups."""
    ties: tuple[int, ...]
    """Indices of the laws that tie with the best, the best among them."""
    preferred: int
    """Index of the law with the fewest parameters among them; of several the one that
    was named first."""


def ranking(scores: np.ndarray, counts: Sequence[int], named: Sequence[int]) -> Ranking:
    """Rank laws by their log predictive densities, shape (units, laws), the number of
    their parameters, and the order in which they were named."""
    totals = np.sum(scores, axis=0)
    best = int(np.argmax(totals))
    pairs = [difference(scores, law, best) for law in range(len(counts))]
    apart, error = (np.array(part) for part in zip(*pairs, strict=True))
    ties = tuple(i for i, pair in enumerate(pairs) if i == best or is_tie(*pair))
    preferred = min(ties, key=lambda i: (counts[i], named[i]))
    return Ranking(best, apart, error, ties, preferred)


def difference(scores: np.ndarray, law: int, other: int) -> tuple[float, float]:
    """Sum the scores, shape (units, laws), of a law less those of another; also the
    standard error, NaN with fewer than `FEWEST_UNITS` units."""
    if law == other:
        return 0.0, 0.0
    apart, count = scores[:, law] - scores[:, other], len(scores)
    if count < FEWEST_UNITS:
        return float(np.sum(apart)), float("nan")
    return float(np.sum(apart)), float(np.sqrt(count) * np.std(apart, ddof=1))


def is_tie(apart: float, error: float) -> bool:
    """Test whether a difference of scores leaves open which law predicts better."""
    small = abs(apart) < SMALL_DIFFERENCE or abs(apart) < ERRORS * error
    return bool(small or not np.isfinite(error))


def stacking_weights(scores: np.ndarray) -> np.ndarray:
    """Compute the weights, shape (laws,), with which the mixture of all laws predicts
    best, from log predictive densities, shape (units, laws)."""
    laws = scores.shape[1]
    relative = scores - np.max(scores, axis=1, keepdims=True)

    def cost(z: np.ndarray) -> tuple[float, np.ndarray]:
        """Negative mean score of the mixture with weights softmax(z), with gradient."""
        weights = softmax(z)
        log_parts = relative + np.log(np.maximum(weights, 1e-300))
        total = np.asarray(logsumexp(log_parts, axis=1))
        # Share of each law in the mixture's density of each unit.
        share = np.exp(log_parts - total[:, None])
        return -float(np.mean(total)), weights - np.mean(share, axis=0)

    minimum = minimize(cost, np.zeros(laws), jac=True, method="L-BFGS-B")
    return softmax(minimum.x)

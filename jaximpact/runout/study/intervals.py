r"""Confidence intervals of shares and percentiles, exact for any number of blocks.

Both take the blocks as independent random samples, and nothing else: no distribution of
what is measured, and no large number. They tell how far another seed might lead, and
nothing of errors of the model or of its inputs.
"""

import functools
from collections.abc import Sequence

import numpy as np
from scipy.special import bdtr, betaincinv

LEVEL = 0.95
"""Probability with which an interval holds the true value, at least."""
TAIL = 0.5 * (1.0 - LEVEL)


def share_interval(count: int, blocks: int) -> tuple[float, float]:
    r"""Find the interval of Clopper and Pearson for the share behind `count` of
    `blocks`.

    $$ I_l(k, n - k + 1) = \alpha/2, \qquad I_h(k + 1, n - k) = 1 - \alpha/2 $$

    with the regularised incomplete beta function I; from 0 for no block, and to 1 for
    all of them. NaN where there are no blocks.

    Source: Clopper and Pearson (1934), The use of confidence or fiducial limits
    illustrated in the case of the binomial.
    """
    if blocks == 0:
        return np.nan, np.nan
    low = betaincinv(count, blocks - count + 1, TAIL) if count else 0.0
    high = betaincinv(count + 1, blocks - count, 1 - TAIL) if count < blocks else 1.0
    return float(low), float(high)


@functools.cache
def percentile_ranks(blocks: int, percent: float) -> tuple[int, int]:
    r"""Find the ranks, from 1, of the sorted values between which a percentile lies.

    The number of blocks below the true percentile is binomial, so that with its
    distribution function F the values of ranks l and u enclose it with probability

    $$ F(u - 1) - F(l - 1) \ge 0.95, \qquad F(l-1) \le 0.025, \qquad F(u-1) \ge 0.975.
    $$

    Rank 0, or one above the number of blocks, where there are too few of them.

    Source: David and Nagaraja (2003), Order statistics, section 7.1.
    """
    cumulative = bdtr(np.arange(blocks + 1), blocks, percent / 100.0)
    low = int(np.searchsorted(cumulative, TAIL, "right"))
    return low, int(np.searchsorted(cumulative, 1.0 - TAIL)) + 1


def percentile_interval(values: np.ndarray, percent: float) -> tuple[float, float]:
    """Find the interval of a percentile of the finite values by `percentile_ranks`.

    NaN for an end for which there are too few blocks; see `least_blocks`.
    """
    finite = np.sort(values[np.isfinite(values)])
    low, high = percentile_ranks(len(finite), percent)
    return (
        float(finite[low - 1]) if low >= 1 else np.nan,
        float(finite[high - 1]) if high <= len(finite) else np.nan,
    )


def percentile_intervals(
    values: np.ndarray, percents: Sequence[float]
) -> list[tuple[float, float]]:
    """Find the interval of each percentile of the finite values."""
    return [percentile_interval(values, percent) for percent in percents]


def least_blocks(percent: float) -> int:
    """Count the blocks from which on a percentile has an interval with both ends."""
    share = percent / 100.0
    further = np.log(TAIL) / np.log(max(share, 1.0 - share))
    return int(np.ceil(further))

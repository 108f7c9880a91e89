"""Intervals of shares and percentiles: against SciPy, against sums over the binomial
distribution, and against their promise on random samples."""

import numpy as np
import pytest
from scipy import stats

from jaximpact.runout.study.intervals import (
    least_blocks,
    percentile_interval,
    percentile_ranks,
    share_interval,
)


@pytest.mark.parametrize(
    ("count", "blocks"), [(0, 1), (1, 1), (0, 40), (7, 40), (40, 40), (3, 100_000)]
)
def test_shares_are_those_of_clopper_and_pearson(count, blocks):
    expected = stats.binomtest(count, blocks).proportion_ci(0.95, method="exact")
    # SciPy searches for the ends, down to 2e-12.
    np.testing.assert_allclose(
        share_interval(count, blocks), [expected.low, expected.high], atol=4e-12
    )


def test_without_blocks_no_share_has_an_interval():
    assert np.all(np.isnan(share_interval(0, 0)))


@pytest.mark.parametrize("percent", [50, 90, 95, 99])
@pytest.mark.parametrize("blocks", [1, 10, 72, 367, 368, 1000, 20_000])
def test_ranks_hold_their_probability_and_no_narrower_ones_do(blocks, percent):
    low, high = percentile_ranks(blocks, percent)
    below = stats.binom(blocks, percent / 100.0)
    # Each end misses with at most 2.5 %, and one rank further in with more.
    assert low == 0 or below.cdf(low - 1) <= 0.025
    assert below.cdf(low) > 0.025
    assert high == blocks + 1 or below.cdf(high - 1) >= 0.975
    assert below.cdf(high - 2) < 0.975
    assert 0 <= low < high <= blocks + 1


@pytest.mark.parametrize("percent", [1, 50, 90, 95, 99])
def test_least_blocks_are_the_first_with_both_ends(percent):
    least = least_blocks(percent)

    def whole(blocks):
        low, high = percentile_ranks(blocks, percent)
        return low >= 1 and high <= blocks

    assert whole(least)
    assert not whole(least - 1)


def test_known_numbers():
    """log(0.025) / log(0.95) = 71.9, and 367.04 for 0.99."""
    assert [least_blocks(p) for p in (50, 95, 99)] == [6, 72, 368]


def test_too_few_blocks_get_no_end():
    values = np.arange(100.0)
    low, high = percentile_interval(values, 99)
    assert low == 96.0
    assert np.isnan(high)
    assert np.all(np.isnan(percentile_interval(np.full(3, np.nan), 95)))
    assert np.all(np.isnan(percentile_interval(np.zeros(0), 50)))


def test_what_is_not_finite_is_no_block():
    values = np.append(np.arange(400.0), np.full(50, np.nan))
    shuffled = np.random.default_rng(1).permutation(values)
    assert percentile_interval(shuffled, 95) == percentile_interval(values[:400], 95)


@pytest.mark.parametrize(("blocks", "percent"), [(100, 50), (100, 95), (400, 99)])
def test_intervals_hold_the_true_percentile(blocks, percent):
    """Of 4000 samples at least 95 % less three standard errors: 1 %."""
    samples = np.random.default_rng(0).exponential(size=(4000, blocks))
    truth = -np.log(1.0 - percent / 100.0)
    ends = np.array([percentile_interval(s, percent) for s in samples])
    held = np.mean((ends[:, 0] <= truth) & (truth <= ends[:, 1]))
    assert held >= 0.94
    # The binomial distribution has steps: more than 95 %, but not for nothing.
    assert held <= 0.985

"""Intervals of shares and percentiles: against SciPy, and against their
promise on random samples."""

import numpy as np
import pytest
from scipy import stats

from jaximpact.runout.study.intervals import (
    least_blocks,
    percentile_interval,
    percentile_interval_over_grounds,
    percentile_ranks,
    share_interval,
    share_intervals_over_grounds,
)


@pytest.mark.parametrize("percent", [50, 90, 95, 99])
@pytest.mark.parametrize("blocks", [1, 10, 72, 367, 368, 1000, 20_000])
def test_ranks_are_those_of_scipy(blocks, percent):
    values = np.random.default_rng(0).exponential(size=blocks)
    expected = stats.quantile_test(values, p=percent / 100.0).confidence_interval(0.95)
    np.testing.assert_array_equal(
        percentile_interval(values, percent), [expected.low, expected.high]
    )


@pytest.mark.parametrize("percent", [1, 50, 90, 95, 99])
def test_least_blocks_are_the_first_with_both_ends(percent):
    for blocks, whole in (
        (least_blocks(percent), True),
        (least_blocks(percent) - 1, False),
    ):
        low, high = percentile_ranks(blocks, percent)
        assert (low >= 1 and high <= blocks) == whole


def test_known_numbers():
    """log(0.025) / log(0.95) = 71.9, and 367.04 for 0.99."""
    assert [least_blocks(p) for p in (50, 95, 99)] == [6, 72, 368]


def test_too_few_blocks_get_no_end():
    """And what is not finite is no block."""
    values = np.arange(100.0)
    low, high = percentile_interval(values, 99)
    assert low == 96.0
    assert np.isnan(high)
    assert np.all(np.isnan(percentile_interval(np.full(3, np.nan), 95)))
    assert np.all(np.isnan(percentile_interval(np.zeros(0), 50)))
    assert np.all(np.isnan(share_interval(0, 0)))
    with_gaps = np.random.default_rng(1).permutation([*values, *np.full(50, np.nan)])
    assert percentile_interval(with_gaps, 95) == percentile_interval(values, 95)


@pytest.mark.parametrize("grounds", [1, 3])
def test_grounds_that_are_alike_have_the_intervals_of_one(grounds):
    """By bisection in place of the inverse: to 1e-9."""
    counts = np.tile([0, 7, 40], (grounds, 1))
    ends = share_intervals_over_grounds(counts, np.full(grounds, 40))
    expected = np.transpose([share_interval(k, 40) for k in (0, 7, 40)])
    np.testing.assert_allclose(ends, expected, atol=1e-9)
    values = np.random.default_rng(0).exponential(size=500)
    same = percentile_interval_over_grounds([values] * grounds, 95)
    assert same == percentile_interval(values, 95)


def test_shares_on_uncertain_ground_against_samples():
    """Of the same mixtures of beta distributions; 3 standard errors of a quantile of
    400 000 samples, at densities above 1."""
    blocks, counts = np.array([30, 50, 80]), np.array([3, 20, 60])
    low, high = share_intervals_over_grounds(counts[:, None], blocks)
    random, size = np.random.default_rng(1), 400_000
    ground = random.integers(0, 3, size)
    k, n = counts[ground], blocks[ground]
    expected_low = np.quantile(random.beta(k, n - k + 1), 0.025)
    expected_high = np.quantile(random.beta(k + 1, n - k), 0.975)
    error = 3 * np.sqrt(0.025 * 0.975 / size)
    assert low[0] == pytest.approx(expected_low, abs=error)
    assert high[0] == pytest.approx(expected_high, abs=error)


def test_percentiles_on_uncertain_ground_by_their_definition():
    random = np.random.default_rng(2)
    grounds = [random.normal(k, 1.0, 100 + 50 * k) for k in range(4)]
    low, high = percentile_interval_over_grounds([*grounds, np.zeros(0)], 90)

    def mean(x, less):
        counts = [np.sum(own < x) if less else np.sum(own <= x) - 1 for own in grounds]
        sizes = map(len, grounds)
        pairs = zip(counts, sizes, strict=True)
        return np.mean([stats.binom.cdf(c, n, 0.9) for c, n in pairs])

    every = np.sort(np.concatenate(grounds))
    assert low == max(x for x in every if mean(x, True) <= 0.025)
    assert high == min(x for x in every if mean(x, False) >= 0.975)


def test_grounds_without_blocks_do_not_count():
    counts, blocks = np.array([[3], [0], [5]]), np.array([10, 0, 12])
    some = share_intervals_over_grounds(counts, blocks)
    np.testing.assert_array_equal(
        some, share_intervals_over_grounds(counts[[0, 2]], blocks[[0, 2]])
    )
    assert np.all(np.isnan(share_intervals_over_grounds(counts[1:2], blocks[1:2])))
    assert np.all(np.isnan(percentile_interval_over_grounds([np.zeros(0)] * 2, 95)))
    few = [np.arange(100.0), np.arange(50.0)]
    low, high = percentile_interval_over_grounds(few, 99)
    assert low > 0.0
    assert np.isnan(high)


def test_intervals_hold_what_a_ground_of_the_posterior_has():
    """Grounds of normal location: of 600 true ones at least 95 % less three standard
    errors, 2.7 %."""
    random, held = np.random.default_rng(3), []
    for _ in range(600):
        centre = random.normal(size=30)
        values = random.normal(centre[:, None], 1.0, (30, 200))
        truth = random.normal()
        share = np.sum(values > 1.0, axis=1)[:, None]
        (low,), (high,) = share_intervals_over_grounds(share, np.full(30, 200))
        bottom, top = percentile_interval_over_grounds(values, 95)
        of_share = low <= stats.norm.sf(1.0 - truth) <= high
        held.append((of_share, bottom <= truth + stats.norm.ppf(0.95) <= top))
    # 30 samples of a posterior miss some of its tails: 1 / 31 of them on each side at
    # most.
    assert np.all(np.mean(held, axis=0) >= 0.95 - 0.027 - 0.02)


@pytest.mark.parametrize("blocks", [1, 2, 40, 1000])
def test_intervals_of_shares_are_those_of_scipy(blocks):
    """To the tolerance of the root that SciPy searches."""
    for count in {0, 1, blocks // 3, blocks - 1, blocks}:
        expected = stats.binomtest(count, blocks).proportion_ci(0.95)
        np.testing.assert_allclose(share_interval(count, blocks), expected, atol=1e-11)

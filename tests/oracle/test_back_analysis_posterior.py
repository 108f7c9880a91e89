"""Posteriors of back-analyses by regression, against exact ones."""

import numpy as np
import pytest

from jaximpact.runout.back_analysis.regression import (
    make_pool,
    posterior_at,
    ranks_of_left_out,
    weighted_quantiles,
)

BLOCKS, SETS = 20, 1500


def linear_data_sets(rng):
    """Mean and spread of 20 normal numbers about the first of two parameters, which
    have a standard normal prior; the second changes nothing."""
    z = rng.standard_normal((SETS, 2))
    data = z[:, :1] + 2.0 * rng.standard_normal((SETS, BLOCKS))
    summaries = np.column_stack([data.mean(1), np.median(data, 1), data.std(1)])
    return z, summaries


def exact(mean):
    """Posterior mean and standard deviation of the first parameter."""
    precision = 1.0 + BLOCKS / 2.0**2
    return BLOCKS / 2.0**2 * mean / precision, precision**-0.5


@pytest.mark.parametrize("mean", [-1.5, 0.0, 0.8])
def test_posterior_of_a_normal_mean(mean):
    rng = np.random.default_rng(1)
    z, summaries = linear_data_sets(rng)
    pool = make_pool(z, summaries, np.array([mean, mean, 2.0]))
    samples, weights = posterior_at(pool, pool.t_observed)
    low, middle, high = weighted_quantiles(samples, weights, (0.025, 0.5, 0.975)).T[0]
    centre, sd = exact(mean)
    # A median of some 200 weighted samples has a standard error of 0.1 sd, and their
    # 95 % interval one of 7 %; thrice that.
    assert middle == pytest.approx(centre, abs=0.3 * sd)
    assert high - low == pytest.approx(2.0 * 1.96 * sd, rel=0.25)
    # Of the second parameter nothing is learnt.
    width = np.diff(weighted_quantiles(samples, weights, (0.025, 0.975)).T[1])[0]
    assert width == pytest.approx(2.0 * 1.96, rel=0.25)


def test_ranks_of_left_out_data_sets_are_uniform():
    rng = np.random.default_rng(2)
    z, summaries = linear_data_sets(rng)
    pool = make_pool(z, summaries, np.array([0.3, 0.3, 2.0]))
    inside = np.mean(np.abs(ranks_of_left_out(pool, 400) - 0.5) <= 0.475, axis=0)
    # Binomial standard error of 400 at 95 %: 1.1 %; thrice that.
    np.testing.assert_allclose(inside, 0.95, atol=0.034)


def test_a_narrow_posterior_within_a_wide_prior():
    """A parameter known to a thousandth of its prior, by a curved relation."""
    rng = np.random.default_rng(3)
    z = rng.uniform(-0.2, 0.2, (SETS, 1))
    noise = 0.01 * rng.standard_normal(SETS)
    summaries = (np.exp(3.0 * z[:, 0]) + noise)[:, None]
    pool = make_pool(z, summaries, np.array([np.exp(0.3)]))
    samples, weights = posterior_at(pool, pool.t_observed)
    mean = weights @ samples[:, 0]
    sd = np.sqrt(weights @ (samples[:, 0] - mean) ** 2)
    # 0.01 over the slope of the relation, 3 exp(0.3).
    expected = 0.01 / (3.0 * np.exp(0.3))
    assert mean == pytest.approx(0.1, abs=0.3 * expected)
    assert sd == pytest.approx(expected, rel=0.25)

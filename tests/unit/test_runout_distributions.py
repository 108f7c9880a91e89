"""Distributions of random inputs, against SciPy's, and as a study's file says them."""

import numpy as np
import pytest
from scipy import stats

from jaximpact.errors import InputError
from jaximpact.io.toml import Key
from jaximpact.runout import Lognormal, Normal, PowerLaw, Uniform, draw
from jaximpact.runout.study.quantity import read_quantity

U = np.concatenate([[2.0**-54, 1e-12, 1.0 - 2.0**-53], np.linspace(0.001, 0.999, 999)])


def truncated(frozen, least, most):
    """Inverse distribution function of a SciPy distribution cut off at both ends."""
    low, high = frozen.cdf([least, most])
    return lambda u: frozen.ppf(low + (high - low) * u)


LOGNORMAL = stats.lognorm(np.log(2.5), scale=0.8)
CASES = {
    "normal": (Normal(3.0, 2.0, 1.0, 4.0), truncated(stats.norm(3, 2), 1.0, 4.0)),
    "uniform": (Uniform(-1.0, 3.0), stats.uniform(-1.0, 4.0).ppf),
    "lognormal": (Lognormal(0.8, 2.5), LOGNORMAL.ppf),
    "lognormal, cut": (
        Lognormal(0.8, 2.5, 0.5, 6.0),
        truncated(LOGNORMAL, 0.5, 6.0),
    ),
    # SciPy's truncated Pareto distribution has the same cumulative exponent.
    "power law": (
        PowerLaw(0.5, 0.01, 20.0),
        stats.truncpareto(0.5, 2000.0, scale=0.01).ppf,
    ),
    "steep power law": (
        PowerLaw(3.0, 2.0, 5.0),
        stats.truncpareto(3.0, 2.5, scale=2.0).ppf,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_values_are_those_of_scipy(name):
    distribution, inverse = CASES[name]
    # Rounding: near u = 1 an error of 1e-16 in u is 1e-16 / (1 - u) of the tail's
    # probability, which both lose alike; the ends in between agree to 1e-11.
    inner = (U > 1e-13) & (U < 1.0 - 1e-13)
    found = distribution.values(U)
    np.testing.assert_allclose(found[inner], inverse(U[inner]), rtol=1e-10)
    assert np.all(np.isfinite(found))
    assert np.all(np.diff(distribution.values(np.sort(U))) >= 0.0)


@pytest.mark.parametrize("name", CASES)
def test_drawn_samples_follow_the_distribution(name):
    distribution, inverse = CASES[name]
    drawn = draw({"a": distribution}, 20_000, 3)["a"]
    # Kolmogorov and Smirnov's test against equally many quantiles; 1e-3 of all seeds
    # would fail, and the seed is fixed.
    grid = inverse((np.arange(200_000) + 0.5) / 200_000)
    assert stats.ks_2samp(drawn, grid).pvalue > 1e-3
    few = draw({"b": Uniform(0.0, 1.0), "a": distribution}, 10, 3)["a"]
    np.testing.assert_array_equal(few, drawn[:10])


def test_no_value_lies_beyond_the_bounds():
    ends = np.array([2.0**-54, 1.0 - 2.0**-53])
    for distribution in (
        Lognormal(1.0, 1.001, 50.0, 60.0),
        Lognormal(1.0, 1e3, 1e-9, 1e9),
        PowerLaw(1e-9, 1e-3, 1e3),
        PowerLaw(900.0, 1e-3, 1e3),
    ):
        values = distribution.values(np.concatenate([ends, U]))
        assert np.all(values >= distribution.least)
        assert np.all(values <= distribution.most)


def test_a_power_law_of_no_exponent_is_uniform_in_the_logarithm():
    """Limit b -> 0; the remaining b span is 1e-8."""
    values = PowerLaw(1e-9, 1e-3, 10.0).values(U)
    np.testing.assert_allclose(np.log10(values), -3.0 + 4.0 * U, atol=1e-7)


@pytest.mark.parametrize(
    ("said", "read"),
    [
        ({"mean": 1, "sd": 2, "most": 3}, Normal(1.0, 2.0, most=3.0)),
        ({"median": 1, "geometric_sd": 2}, Lognormal(1.0, 2.0)),
        (
            {"median": 1, "geometric_sd": 2, "least": 0.1},
            Lognormal(1.0, 2.0, least=0.1),
        ),
        ({"exponent": 0.5, "least": 1, "most": 8}, PowerLaw(0.5, 1.0, 8.0)),
        ({"from": 0, "to": 1}, Uniform(0.0, 1.0)),
        ([1, 2], (1.0, 2.0)),
        (3, 3.0),
    ],
)
def test_a_file_says_distributions(tmp_path, said, read):
    assert read_quantity(Key(tmp_path, "key"), said, None) == read


@pytest.mark.parametrize(
    ("said", "parts"),
    [
        ({"median": 1}, "{ median, geometric_sd }"),
        ({"median": 1, "geometric_sd": 1}, "geometric_sd: must be above 1"),
        ({"median": 0, "geometric_sd": 2}, "key.median: must be above 0"),
        ({"median": 1, "geometric_sd": 2, "sd": 1}, "must be a number, a list"),
        ({"median": 1, "geometric_sd": 2, "most": -1}, "needs least below most"),
        (
            {"median": 1, "geometric_sd": 1.001, "least": 2},
            "so far from a median 1 with geometric_sd 1.001",
        ),
        ({"exponent": 0.5}, "needs least and most beside its exponent"),
        ({"exponent": 0.5, "most": 2}, "needs least and most"),
        ({"exponent": 0.5, "least": 0, "most": 2}, "key.least: must be above 0"),
        ({"exponent": 0, "least": 1, "most": 2}, "key.exponent: must be above 0"),
        ({"exponent": 1, "least": 2, "most": 2}, "needs least below most"),
        ({"from": 0, "to": 1, "least": 0}, "takes no least or most"),
        ({"meadian": 1, "geometric_sd": 2}, "did you mean median?"),
        ({"mean": 1, "sd": float("nan")}, "must be finite"),
        ({}, "must be a number, a list"),
    ],
)
def test_bad_distributions_are_refused(tmp_path, said, parts):
    with pytest.raises(InputError) as error:
        read_quantity(Key(tmp_path / "s.toml", "key"), said, None)
    assert parts in str(error.value)

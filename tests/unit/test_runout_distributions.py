"""Distributions of random inputs, against SciPy's, and as a study's file says them."""

import re

import numpy as np
import pytest
from error_messages import warned_once
from scipy import stats

from jaximpact import Soil
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.io.toml import Key
from jaximpact.runout import Lognormal, Normal, PowerLaw, Uniform, draw
from jaximpact.runout.study.quantity import read_ground_quantity, read_quantity
from jaximpact.runout.terrain import ground_columns

U = np.concatenate([[2.0**-54, 1e-12, 1.0 - 2.0**-53], np.linspace(0.001, 0.999, 999)])


def truncated(frozen, least, most):
    """Inverse distribution function of a SciPy distribution cut off at both ends."""
    low, high = frozen.cdf([least, most])
    return lambda u: frozen.ppf(low + (high - low) * u)


def pareto(exponent, least, most):
    """Of the same cumulative exponent."""
    return stats.truncpareto(exponent, most / least, scale=least).ppf


LOGNORMAL = stats.lognorm(np.log(2.5), scale=0.8)
CASES = {
    "normal": (Normal(3.0, 2.0, 1.0, 4.0), truncated(stats.norm(3, 2), 1.0, 4.0)),
    "uniform": (Uniform(-1.0, 3.0), stats.uniform(-1.0, 4.0).ppf),
    "lognormal": (Lognormal(0.8, 2.5), LOGNORMAL.ppf),
    "cut": (Lognormal(0.8, 2.5, 0.5, 6.0), truncated(LOGNORMAL, 0.5, 6.0)),
    "power law": (PowerLaw(0.5, 0.01, 20.0), pareto(0.5, 0.01, 20.0)),
    "steep power law": (PowerLaw(3.0, 2.0, 5.0), pareto(3.0, 2.0, 5.0)),
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


FIRST_DRAWS = [1.098990039096864, 2.7912608936625847, 1.141582449641262]
"""Of the seed 3 for a quantity a, between 1 and 3."""


def test_draws_depend_on_seed_and_name_alone():
    quantities = {"a": Uniform(1.0, 3.0), "b": Normal(0.0, 1.0), "c": 5.0}
    many = draw(quantities, 1000, 3)
    few = draw(quantities, 10, 3)
    alone = draw({"b": Normal(0.0, 1.0)}, 1000, 3)
    for name in quantities:
        np.testing.assert_array_equal(few[name], many[name][:10])
    np.testing.assert_array_equal(alone["b"], many["b"])
    assert not np.any(draw(quantities, 1000, 4)["a"] == many["a"])
    # The first numbers of the streams, as they must stay from version to version.
    np.testing.assert_allclose(few["a"][:3], FIRST_DRAWS, rtol=1e-15)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_far_tails_keep_their_distribution(side):
    """Beyond 12 standard deviations what is left is near exponential, with a mean of
    1 / (12 + 1 / 12) or so; shares of 1e-33 must not be rounded away."""
    shares = (np.arange(1000) + 0.5) / 1000
    ends = (12.0, np.inf) if side > 0.0 else (-np.inf, -12.0)
    values = Normal(0.0, 1.0, *ends).values(shares)
    beyond = side * values - 12.0
    assert np.all(np.isfinite(values))
    assert np.all(np.diff(values) > 0.0)
    # 1 / 12 to its next order, 1 / 12**3; a thousand shares cut the tail off by 1e-3.
    assert np.mean(beyond) == pytest.approx(1 / 12 - 2 / 12**3, rel=0.01)


def test_lists_make_every_combination():
    drawn = draw({"a": (1.0, 2.0), "b": (5.0, 6.0, 7.0)}, 8, 0)
    assert list(drawn["a"]) == [1, 1, 1, 2, 2, 2, 1, 1]
    assert list(drawn["b"]) == [5, 6, 7, 5, 6, 7, 5, 6]


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
    ("message", "said"),
    [
        ("{ median, geometric_sd }", {"median": 1}),
        ("geometric_sd: must be above 1", {"median": 1, "geometric_sd": 1}),
        ("key.median: must be above 0", {"median": 0, "geometric_sd": 2}),
        ("must be a number, a list", {"median": 1, "geometric_sd": 2, "sd": 1}),
        ("needs least below most", {"median": 1, "geometric_sd": 2, "most": -1}),
        (
            "so far from a median 1 with geometric_sd 1.001",
            {"median": 1, "geometric_sd": 1.001, "least": 2},
        ),
        ("needs least and most beside its exponent", {"exponent": 0.5}),
        ("needs least and most", {"exponent": 0.5, "most": 2}),
        ("key.least: must be above 0", {"exponent": 0.5, "least": 0, "most": 2}),
        ("key.exponent: must be above 0", {"exponent": 0, "least": 1, "most": 2}),
        ("needs least below most", {"exponent": 1, "least": 2, "most": 2}),
        ("takes no least or most", {"from": 0, "to": 1, "least": 0}),
        ("did you mean median?", {"meadian": 1, "geometric_sd": 2}),
        ("must be finite", {"mean": 1, "sd": float("nan")}),
        ("must be a number, a list", {}),
    ],
)
def test_bad_distributions_are_refused(tmp_path, message, said):
    with pytest.raises(InputError, match=re.escape(message)):
        read_quantity(Key(tmp_path / "s.toml", "key"), said, None)


@pytest.mark.parametrize(
    ("name", "said", "warning"),
    [
        ("cohesion_kPa", {"mean": 2e4, "sd": 5e3}, r"key.mean: is 20000 kPa; .* Pa\?"),
        ("cohesion_kPa", {"median": 2e4, "geometric_sd": 2}, "key.median: is 20000"),
        (
            "cohesion_kPa",
            {"exponent": 1, "least": 1, "most": 2e4},
            "key.most: is 20000",
        ),
        (
            "cohesion_kPa",
            {"mean": 2e4, "sd": 5e3, "correlation_length_m": 10},
            "key.mean: is 20000",
        ),
        (
            "friction_angle_deg",
            {"mean": 30, "sd": 5, "least": 0.35},
            r"key.least: is 0.35 deg; .* rad\?",
        ),
        # Ends of what the quantity may be, which are no values of it.
        ("friction_angle_deg", {"mean": 30, "sd": 5, "least": 0, "most": 60}, None),
        ("k_E", {"mean": 900, "sd": 500, "least": 0}, None),
    ],
)
def test_parameters_in_another_unit_are_warned_of(tmp_path, name, said, warning):
    with warned_once(UnusualValueWarning, warning):
        read_ground_quantity(
            Key(tmp_path / "s.toml", "key"), said, ground_columns(Soil())[name]
        )

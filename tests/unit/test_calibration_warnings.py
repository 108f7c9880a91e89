"""What a report says against trusting a fit: units, misfit, starts, few tests."""

import dataclasses
from types import SimpleNamespace

import jax
import numpy as np
import pytest
from calibration_studies import study_of_columns

from jaximpact import PRESETS, Block, Impact, Scene, Soil, simulate_batch
from jaximpact.calibration import fit_study
from jaximpact.calibration.diagnostics.discrepancy import Discrepancy
from jaximpact.calibration.diagnostics.examination import (
    doubtful_units,
    freedom_text,
    warnings_of,
    worse_than_mean,
)
from jaximpact.calibration.diagnostics.identifiability import Verdict
from jaximpact.calibration.diagnostics.residuals import Bias, Residuals, residuals_of
from jaximpact.calibration.report.contents import target_table
from jaximpact.calibration.report.parameters import about_draws, verdict
from jaximpact.calibration.report.prediction import _about_discrepancy

ANGLES = [10.0, 25.0, 40.0, 50.0, 60.0, 35.0]
SPEEDS = [8.0, 12.0, 10.0, 15.0, 20.0, 6.0]
NOTHING_ELSE = SimpleNamespace(
    residuals=Residuals(np.zeros((0, 0)), [], 0, []),
    each=None,
    campaigns=None,
    posterior=SimpleNamespace(trusted=True, rough=False),
    samples=None,
)


def study(columns, **content):
    return study_of_columns(columns, starts=4, accuracy="balanced", **content)


@pytest.fixture(scope="module")
def e_n():
    """What the model gives on Table 1, with the scatter of a good measurement."""
    jax.config.update("jax_enable_x64", True)
    impact = Impact(speed=np.array(SPEEDS), angle=np.deg2rad(ANGLES))
    scene = Scene(Block(mass=np.full(6, 500.0)), Soil(), impact)
    noise = 1.0 + 0.02 * np.random.default_rng(0).normal(size=6)
    return np.asarray(simulate_batch(scene).e_n) * noise


def columns(e_n):
    return {"speed_mps": SPEEDS, "angle_deg": ANGLES, "e_n": list(e_n)}


def doubts(columns, **content):
    result = fit_study(study(columns, **content))
    return warnings_of(result, result.variants[0], NOTHING_ELSE), result


def first_words(result):
    """The verdict's first lines, with all that speaks against the fit."""
    (variant,) = result.variants
    residuals = residuals_of(variant.objective, variant.points, 1.0)
    return verdict(result, variant, residuals)[0]


def test_angles_in_radians_parts_in_per_cent_and_depths_in_millimetres():
    angles = [0.2, 0.9, 1.2]
    (words,) = doubtful_units(study({"angle_deg": angles, "e_n": [0.2, 0.3, 0.4]}))
    assert "angle_deg is between 0.2 and 1.2" in words
    assert "radians?" in words
    (words,) = doubtful_units(study({"angle_deg": [9.0, 40.0], "e_n": [20.0, 31.0]}))
    assert "per cent?" in words
    # A block of 100 kg has a diameter of 0.42 m.
    depths = {"angle_deg": [9.0, 40.0], "max_sinking_m": [100.0, 210.0]}
    (words,) = doubtful_units(study(depths))
    assert "max_sinking_m are above 369 diameters" in words
    assert not doubtful_units(study(depths | {"max_sinking_m": [0.1, 2.1]}))
    (words,) = doubtful_units(study({"angle_deg": [9.0, 40.0], "e_n": [0.2, 1.2]}))
    assert words.startswith("e_n is above 1 in row 3: ")
    limits = {"angle_deg": [9.0, 40.0], "e_n": ["0.2", "<1.5"]}
    assert not doubtful_units(study(limits))
    (words,) = doubtful_units(study(limits | {"e_n": ["0.2", ">1.5"]}))
    assert words.startswith("e_n is above 1 in row 3: ")
    for fine in ([0.0, 0.0], [0.0, 1.0], [0.5, 12.0]):
        assert not doubtful_units(study({"angle_deg": fine, "e_n": [0.2, 0.9]}))
    assert not doubtful_units(study({"speed_mps": [5.0], "e_n": [0.2]}))


def test_times_in_milliseconds_and_forces_in_kilonewtons():
    times, forces = np.array([2.0, 8.0, 20.0]), np.array([5e3, 6e4, 4e4])

    def of_curve(time, force):
        return doubtful_units(study({"time_s": time, "normal_force_N": force}))

    assert of_curve(1e-3 * times, forces) == []
    (words,) = of_curve(times, forces)
    assert "times in time_s are above 8, " in words
    assert "milliseconds?" in words
    # A block of 100 kg weighs 981 N.
    (words,) = of_curve(1e-3 * times, 1e-3 * forces)
    assert "normal_force_N is above 0.0612 times the weight" in words
    assert "kilonewtons?" in words
    # As a load cell has them, which is no matter of the unit, with noise too.
    for offset in (0.0, 40.0):
        (words,) = of_curve(1e-3 * times, offset - np.append(forces[:2], 0.0))
        assert "but one is -61." in words
        assert "is the sign another?" in words
    assert "kilonewtons?" in of_curve(1e-3 * times, -1e-3 * forces)[0]
    (words,) = doubtful_units(study({"angle_deg": [9.0], "max_normal_force_N": [60]}))
    assert "max_normal_force_N is above 0.0612 times" in words


def test_a_good_fit_has_nothing_against_it(e_n):
    found, result = doubts(columns(e_n), parameters={"k_E": {}})
    assert found == []
    assert first_words(result).startswith("The tests identify k_E")


def test_what_the_model_cannot_do_is_missed_by_more_than_the_mean(e_n):
    """No ground gives back 1.7 times the normal velocity at 10 degrees; the same with
    sigmas that nobody can keep."""
    for content in ({}, {"default_sigma": {"e_n": 0.01}}):
        tests = columns(1.7 + 0.1 * e_n)
        found, result = doubts(tests, parameters={"k_E": {}}, **content)
        (words,) = [x for x in found if "R2 of e_n" in x]
        assert "is below 0" in words
        words = first_words(result)
        assert "The model does not describe e_n." in words
        assert "The tests identify" not in words


def test_a_bias_comes_first():
    """Drops whose e_n leaves no choice of k_E, and whose forces were measured a third
    too low: all are overestimated by about a half."""
    speeds = np.linspace(5.0, 14.0, 12)
    scene = Scene(Block(mass=np.full(12, 500.0)), Soil(), Impact(speed=speeds))
    true = simulate_batch(scene)
    random = np.random.default_rng(3)
    e_n = np.asarray(true.e_n) * (1.0 + 0.02 * random.normal(size=12))
    force = np.asarray(true.max_normal_force) * (1.0 + 0.05 * random.normal(size=12))
    drops = {"mass_kg": [500.0] * 12, "speed_mps": speeds, "angle_deg": [0.0] * 12}
    drops |= {"e_n": e_n, "sigma_e_n": 0.02 * e_n, "max_normal_force_N": force / 1.5}
    _, result = doubts(drops, parameters={"k_E": {}})
    words = first_words(result)
    number = "overestimates max_normal_force_N in 12 of 12 tests, by "
    assert words.startswith(f"The fit {number}")
    assert 40.0 < float(words.split(number)[1].split()[0]) < 60.0
    assert "The tests identify" not in words
    (variant,) = result.variants
    residuals = residuals_of(variant.objective, variant.points, 1.0)
    diagnostics = SimpleNamespace(**vars(NOTHING_ELSE) | {"residuals": residuals})
    found = warnings_of(result, variant, diagnostics)
    assert sum("max_normal_force_N is biased" in line for line in found) == 1


def test_a_wrong_shape_comes_first():
    """Elongated blocks that were fitted as spheres, with stated sigmas and without."""
    angles = np.array([10.0, 25.0, 40.0, 50.0, 60.0, 35.0, 20.0, 45.0])
    turned = np.array([-50.0, 20.0, 70.0, -20.0, 40.0, 5.0, -70.0, 55.0])
    impact = Impact.from_degrees(12.0, angles, orientation=turned)
    e_n = np.asarray(simulate_batch(Scene(Block(aspect_ratio=2.0), Soil(), impact)).e_n)
    tests = {"speed_mps": [12.0] * 8, "angle_deg": angles, "e_n": e_n}
    for sigma in ({"default_sigma": {"e_n": 0.02}}, {}):
        _, result = doubts(tests, parameters={"k_E": {}}, **sigma)
        words = first_words(result)
        assert words.startswith("The model does not describe e_n. ")
        assert "The tests identify" not in words
        assert ("times as large as the given sigmas allow" in words) == bool(sigma)


def test_a_fit_that_explains_little_says_so_first(e_n):
    """Two thirds of the variance of e_n are noise: it may be scatter of the tests."""
    random = np.random.default_rng(1)
    tests = columns(e_n + 1.4 * np.std(e_n) * random.normal(size=6))
    _, result = doubts(tests, parameters={"k_E": {}})
    words = first_words(result)
    assert words.startswith("The fit explains less than half of the variance of e_n. ")
    assert "If that is scatter of the tests, they identify k_E" in words


def test_repeated_impacts_are_as_good_as_their_mean():
    """The fit reaches the mean itself: what is left is scatter, of which it is said
    that it is all there is."""
    repeated = {"angle_deg": [30.0] * 4, "e_n": [0.30, 0.31, 0.32, 0.31]}
    found, _ = doubts(repeated, parameters={"k_E": {}})
    assert not any("R2 of e_n" in x for x in found)
    (words,) = [x for x in found if "The scatter estimated for e_n" in x]
    assert "state their sigma" in words


def test_sigmas_that_are_guesses_are_called_so():
    found, result = doubts({"angle_deg": [30.0], "e_n": [0.3]}, parameters={"k_E": {}})
    assert any(x.startswith("0 degrees of freedom") for x in found)
    assert any("a guess" in x for x in found)
    table = target_table(result, result.variants[0], NOTHING_ELSE)
    assert "(guessed)" in table.rows[0][-1]


def test_the_sigma_of_limits_alone_is_a_guess(e_n):
    """Also where that of another target is estimated."""
    limits = [f"<{1.1 * value}" for value in e_n]
    for tests in (
        {"speed_mps": SPEEDS, "angle_deg": ANGLES, "e_n": limits},
        columns(e_n) | {"e_t": [">0.1"] * 6},
    ):
        found, result = doubts(tests, parameters={"k_E": {}})
        (words,) = [line for line in found if "only limits are known" in line]
        name = "e_n" if "e_t" not in tests else "e_t"
        assert words.startswith(f"Of {name} only limits")
        assert f"State it, as sigma_{name} in the table or as default_sigma." in words
        assert not any("too few measurements to estimate" in line for line in found)
        table = target_table(result, result.variants[0], NOTHING_ELSE)
        row = dict(zip(table.columns, table.rows[-1], strict=True))
        assert row["sigma"].endswith("(guessed)")
    given, _ = doubts(tests, default_sigma={"e_t": 0.05}, parameters={"k_E": {}})
    assert not any("only limits" in line for line in given)


@pytest.mark.parametrize(("sigma", "too_large"), [(0.002, False), (0.5, True)])
def test_sigmas_that_are_far_too_large_are_called_so(e_n, sigma, too_large):
    """Of six values that scatter by about 0.002."""
    words, _ = doubts(
        columns(e_n), default_sigma={"e_n": sigma}, parameters={"k_E": {}}
    )
    said = [line for line in words if "the sigmas are too large" in line]
    assert len(said) == too_large


def test_given_sigmas_that_are_too_small_beside_estimated_ones(e_n):
    """They get a factor, which the report states."""
    depths = {"max_penetration_m": [0.1, 0.16, 0.09, 0.15, 0.1, 0.04]}
    lines, result = doubts(columns(e_n) | depths, default_sigma={"e_n": 1e-5})
    (words,) = [line for line in lines if "given sigmas allow" in line]
    assert words.startswith("The misfit of e_n is larger than its given sigmas allow. ")
    variant = result.variants[0]
    factor = float(np.median(variant.sigma[:, 0])) / 1e-5
    assert factor > 10.0
    assert f"multiplied by {factor:.3g}, " in words
    rows = target_table(result, variant, NOTHING_ELSE).text()
    assert f"(given, times {factor:.3g})" in rows


def test_a_bias_from_zero_has_no_per_cent():
    assert Bias("e_n", 0.04, 0.05, np.nan, 5, 6, 0.01, 0.02, True).words == (
        "the fit overestimates e_n in 5 of 6 tests, by 0.04 in the mean"
    )
    depth = Bias("max_sinking_m", -0.04, 0.05, np.nan, 1, 6, 0.01, 0.02, True)
    assert depth.words.endswith("in 5 of 6 tests, by 0.04 m in the mean")


def test_a_fit_that_predicts_worse_than_the_mean_of_the_other_tests():
    """Of 0.2, 0.3 and 0.4 the mean of the other two is off by 0.15, 0 and 0.15."""
    known = study({"angle_deg": [9.0, 20.0, 40.0], "e_n": [0.2, 0.3, 0.4]})
    of_mean = 0.15 * np.sqrt(2.0 / 3.0)

    def words(error):
        predicted = known.measured + np.array([[error], [-error], [error]])
        return worse_than_mean(known, SimpleNamespace(predicted=predicted), 0)

    (text,) = words(1.2 * of_mean)
    assert "its rms error is 0.122, that of the fit 0.147" in text
    assert words(1.05 * of_mean) == []
    assert worse_than_mean(known, None, 0) == []
    # Of measurements that are all the same the mean has no error but rounding.
    known = dataclasses.replace(known, measured=np.full((3, 1), 0.2))
    assert words(1e-7) == []
    assert words(1e-2) != []


def test_no_freedom_is_none_whatever_rounding_leaves():
    assert [freedom_text(f) for f in (-4.3e-14, 1.6e-15, 0.5, 42.0, 41.996)] == [
        *("0", "0", "0.5", "42", "42")
    ]


def test_a_search_that_missed_the_best_fit_is_said(e_n):
    result = fit_study(study(columns(e_n), parameters={"k_E": {}}))
    variant = result.variants[0]
    assert warnings_of(result, variant, NOTHING_ELSE) == []
    (words,) = warnings_of(result, variant._replace(found_later=True), NOTHING_ELSE)
    assert words.startswith("The search did not find the best fit")
    (words,) = warnings_of(result, variant._replace(agreed=3), NOTHING_ELSE)
    assert words.startswith(f"Only 3 of {variant.members} members")


@pytest.mark.parametrize("sigma", [{}, {"default_sigma": {"e_n": 0.003}}])
@pytest.mark.parametrize(("mean", "sd"), [(300.0, 20.0), (1800.0, 100.0)])
def test_a_prior_that_the_tests_contradict(e_n, mean, sd, sigma):
    """Also where the estimated scatter is so wide for its sake that the fit is at the
    prior."""
    free = fit_study(study(columns(e_n), parameters={"k_E": {}}, **sigma)).variants[0]
    given, error = free.parameters[0], free.standard_error(0)
    prior = {"k_E": {"prior": {"mean": mean, "sd": sd}}}
    _, result = doubts(columns(e_n), parameters=prior, **sigma)
    (verdict_of_fit,) = result.variants[0].verdicts
    assert not verdict_of_fit.determined
    apart = abs(given - mean) / np.hypot(error, sd)
    said = f"its prior, {mean:g} +- {sd:g}, and the tests disagree by "
    assert verdict_of_fit.reason.startswith(said)
    deviations = float(verdict_of_fit.reason.removeprefix(said).split()[0])
    np.testing.assert_allclose(deviations, apart, rtol=0.1)
    assert f"without the prior they give {given:.3g} +- " in verdict_of_fit.reason
    assert "add no information" not in verdict_of_fit.reason
    assert "Tests and priors contradict each other." in first_words(result)


def test_a_prior_that_the_tests_agree_with_is_no_reason(e_n):
    for mean, sd in ((660.0, 20.0), (720.0, 60.0), (690.0, 1.0)):
        prior = {"k_E": {"prior": {"mean": mean, "sd": sd}}}
        result = fit_study(
            study(columns(e_n), default_sigma={"e_n": 0.01}, parameters=prior)
        )
        (verdict_of_fit,) = result.variants[0].verdicts
        assert "disagree" not in verdict_of_fit.reason


def test_draws_that_all_count_do_not_make_a_bound_normal():
    """At a bound the draws are cut off like the posterior, and all count."""
    plain = SimpleNamespace(sigma_given=np.array([True]), is_likelihood=True)
    result = SimpleNamespace(study=plain)
    draws = SimpleNamespace(
        x=np.zeros((512, 1)),
        effective_fraction=np.array([0.9]),
        accuracy=PRESETS["balanced"],
        error=1e-4,
    )

    def words(determined, of_draws=False):
        verdict = Verdict("c_v", determined, "" if determined else "it is at a bound")
        variant = SimpleNamespace(verdicts=[verdict], errors_of_draws=of_draws)
        return about_draws(result, variant, draws)

    assert "nearly normal" in words(True)
    assert "nearly normal" not in words(False)
    assert "c_v" in words(False)
    assert "rely on the verdict" in words(False)
    assert "Standard errors are those of these draws" in words(True, of_draws=True)


def test_the_part_of_the_discrepancy_is_that_of_what_is_predicted():
    """Two targets in two tests: none has a part that has no prediction, no scatter or
    no discrepancy, as at a time of a force curve, where only forces are predicted."""
    scale = np.ones(2), np.full(2, np.inf)
    known = Discrepancy(1.0, 3.0, 6, ("largest speeds",), np.zeros((1, 3)), *scale)

    def told(middle, sigma, discrepancy):
        fields = dict(middle=middle, sigma=sigma, discrepancy=discrepancy)
        arrays = {name: np.array(values) for name, values in fields.items()}
        fitted = SimpleNamespace(discrepancy=known)
        return _about_discrepancy(SimpleNamespace(fitted=fitted, **arrays))[0]

    words = told([[1, 2], [1, 2]], [[1, 1], [1, 1]], [[0.5, 1], [2, 3]])
    assert words.startswith("Discrepancy is 20 to 90 % of the variance of a ")
    words = told([[1, np.nan], [1, 2]], [[1, 1], [0, 1]], [[1, 3], [3, 0]])
    assert words.startswith("Discrepancy is 50 to 50 % ")
    of_force = told([[np.nan, 2], [np.nan, 2]], [[1, 1], [1, 0]], [[1, 0], [1, 0]])
    assert of_force.startswith("Discrepancy is estimated from 6 measurements left out")

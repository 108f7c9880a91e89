"""Comparison of laws: densities of what was left out against exact refits and closed
forms, ties, stacking, and laws that are found in data that they made."""

import dataclasses
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from calibration_studies import Linear, study_of_columns
from error_messages import assert_one_line
from matplotlib.figure import Figure
from scipy import stats
from scipy.optimize import minimize_scalar

from jaximpact import (
    AnglePowerLaw,
    Block,
    ConstantCoefficients,
    FrictionalEllipsoid,
    Impact,
    PfeifferBowen,
    Scene,
    Soil,
    simulate_batch,
)
from jaximpact.calibration import compare, read_study
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.compare_laws import Comparison
from jaximpact.calibration.comparison import held_out as held_out_module
from jaximpact.calibration.comparison.comparison import (
    Compared,
    GroupScores,
    _all_groups,
    compare_study,
)
from jaximpact.calibration.comparison.contenders import Contender, contenders_of
from jaximpact.calibration.comparison.fitted_law import (
    fit_law,
    law_of_json,
    objective_of,
    of_targets,
    predict_law,
)
from jaximpact.calibration.comparison.held_out import held_out, log_densities
from jaximpact.calibration.comparison.ranking import (
    difference,
    is_tie,
    stacking_weights,
)
from jaximpact.calibration.comparison.rebound_objective import rebound_objective
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.problem.config import Variant
from jaximpact.calibration.report.comparison import verdict, worse_than_others
from jaximpact.errors import InputError
from jaximpact.laws import FluidityRate
from jaximpact.laws.bearing import VesicWithInertia
from jaximpact.parameters import parameter
from jaximpact.rebound import AbstractRebound, Rebound
from jaximpact.reports.json_tree import plain

REBOUND = ["constant coefficients", "Pfeiffer and Bowen", "power law in the angle"]
NOISE = 0.02


class Fading(AbstractRebound):
    """A law of a user's own: both coefficients fall with the speed."""

    half_speed: jax.Array = parameter(
        10.0, "m/s", "(0, inf)", "speed of half the rebound", usual=(0.5, 100.0)
    )

    def __call__(self, block, impact):
        part = 1.0 / (1.0 + impact.speed / self.half_speed)
        return Rebound(
            -part * impact.normal_velocity,
            part * impact.tangential_velocity,
            impact.angular_velocity,
        )


def columns(count=24, seed=0):
    random = np.random.default_rng(seed)
    return {
        "mass_kg": random.uniform(20.0, 200.0, count),
        "aspect_ratio": random.uniform(0.6, 1.8, count),
        "orientation_deg": random.uniform(0.0, 180.0, count),
        "angular_velocity_degps": random.uniform(-300.0, 300.0, count),
        "angle_deg": random.uniform(5.0, 70.0, count),
        "speed_mps": random.uniform(3.0, 20.0, count),
    }


def blocks_and_impacts(tests):
    impact = Impact.from_degrees(
        tests["speed_mps"],
        tests["angle_deg"],
        tests["orientation_deg"],
        tests["angular_velocity_degps"],
    )
    return Block(mass=tests["mass_kg"], aspect_ratio=tests["aspect_ratio"]), impact


def made_by(law, count=24, seed=0, targets=("e_n", "e_t")):
    """Tests that a law of rebound made, with noise."""
    tests = columns(count, seed)
    block, impact = blocks_and_impacts(tests)
    after = law(block, impact)
    exact = {"e_n": after.e_n(impact), "e_t": after.e_t(impact)}
    random = np.random.default_rng(seed + 1)
    noisy = {n: np.asarray(exact[n]) + NOISE * random.normal(size=count) for n in exact}
    return tests | {name: noisy[name] for name in targets}


@pytest.mark.parametrize("law", [PfeifferBowen, FrictionalEllipsoid])
def test_derivatives_of_a_rebound_law(law):
    """By central differences, whose error at a step of 1e-6 is about 1e-9; kinks of the
    frictional ellipsoid are missed by these tests."""
    tests = made_by(ConstantCoefficients(0.4, 0.8), count=8)
    objective = rebound_objective(study_of_columns(tests), law)
    bounds, step = objective.bounds, 1e-6
    x = bounds.at_fraction(0.37)[None]
    jacobian = objective(x).jacobian[0]
    for unknown in range(x.shape[1]):
        ahead, back = x.copy(), x.copy()
        ahead[0, unknown] += step
        back[0, unknown] -= step
        change = objective.values(ahead).predicted - objective.values(back).predicted
        assert jacobian[..., unknown] == pytest.approx(
            change[0] / (2.0 * step), abs=1e-7
        )


def test_energies_of_a_rebound_law_are_those_of_its_velocities():
    tests = columns(5)
    names = "e_bar", "R_r", "v_n_mps", "omega_radps"
    study = study_of_columns(tests | {name: np.ones(5) for name in names})
    objective = rebound_objective(study, PfeifferBowen)
    x = objective.bounds.coordinate(np.array([0.5, 0.7]))[None]
    found = dict(zip(names, objective.values(x).predicted[0].T, strict=True))
    block, impact = blocks_and_impacts(tests)
    v_n, v_t, spin = PfeifferBowen(0.5, 0.7)(block, impact)
    rotation = 0.5 * block.inertia * spin**2
    after = 0.5 * block.mass * (v_n**2 + v_t**2) + rotation
    before = 0.5 * block.mass * impact.speed**2
    before += 0.5 * block.inertia * impact.angular_velocity**2
    # Rounding alone.
    assert found["e_bar"] == pytest.approx(np.sqrt(after / before), rel=1e-12)
    assert found["R_r"] == pytest.approx(np.asarray(rotation / after), rel=1e-12)
    assert found["v_n_mps"] == pytest.approx(np.asarray(v_n), rel=1e-12)
    assert found["omega_radps"] == pytest.approx(np.asarray(spin), rel=1e-12)


def test_a_constant_coefficient_is_the_mean():
    """And a new measurement of it has Student's distribution about the mean, with the
    classical standard deviation."""
    tests = made_by(ConstantCoefficients(0.4, 0.8), targets=("e_n",))
    study = study_of_columns(tests)
    contender = Contender("constant", ConstantCoefficients)
    found = fit_law(study, contender)
    mean, count = np.mean(tests["e_n"]), len(tests["e_n"])
    spread = np.std(tests["e_n"], ddof=1)
    # The fit stops at a thousandth of a standard error.
    assert found.fitted.values[0] == pytest.approx(mean, abs=1e-3 * spread)
    assert found.fitted.sigma[0] == pytest.approx(spread, rel=1e-3)
    again = law_of_json(plain(found.fitted.as_json()))
    prediction = predict_law(again, contender, study)
    # e_t has no influence: e_n alone has the variance of a mean.
    expected = spread * np.sqrt(1.0 + 1.0 / count)
    assert prediction.deviation[:, 0] == pytest.approx(expected, rel=2e-3)
    assert prediction.freedom[0] == pytest.approx(count - 1, abs=0.01)
    low, high = prediction.interval(3, 0)
    half = expected * stats.t(count - 1).ppf(0.975)
    # Atoms of the scatter are a hundredth apart in probability.
    assert (high - low) / 2.0 == pytest.approx(half, rel=0.02)


def test_sigmas_stated_by_new_tests_stand_for_those_of_the_fit():
    """Where these were given too: here too small, so that both are inflated."""
    tests = made_by(ConstantCoefficients(0.4, 0.8), targets=("e_n",))
    given = study_of_columns(tests, default_sigma={"e_n": 0.1 * NOISE})
    contender = Contender("constant", ConstantCoefficients)
    found = law_of_json(plain(fit_law(given, contender).fitted.as_json()))
    assert found.inflation > 10.0
    stated = np.where(np.arange(len(tests["e_n"])) % 2, 0.3 * NOISE, np.nan)
    new = study_of_columns(tests | {"sigma_e_n": stated}, default_sigma={"e_n": 1.0})
    deviation = predict_law(found, contender, new).deviation[:, 0]
    as_fitted = predict_law(found, contender, given).deviation[:, 0]
    assert np.array_equal(deviation[::2], as_fitted[::2])
    of_law = as_fitted**2 - found.inflation * (0.1 * NOISE) ** 2
    expected = np.sqrt(found.inflation * (0.3 * NOISE) ** 2 + of_law)
    np.testing.assert_allclose(deviation[1::2], expected[1::2], rtol=1e-12)
    # Of a sigma that was estimated those of new tests say nothing.
    free = fit_law(study_of_columns(tests), contender).fitted
    alike = (predict_law(free, contender, study).deviation for study in (given, new))
    assert np.array_equal(*alike)


def test_sigmas_of_empty_cells_count_for_nothing():
    tests = made_by(ConstantCoefficients(0.4, 0.8), targets=("e_n",))
    count = len(tests["e_n"])
    half = np.where(np.arange(count) < count // 3, tests["e_n"], np.nan)
    sigma = np.where(np.isnan(half), 1.0, NOISE)
    study = study_of_columns(tests | {"e_n": half, "sigma_e_n": sigma})
    contender = Contender("constant", ConstantCoefficients)
    fitted = fit_law(study, contender).fitted
    inflation = np.sqrt(fitted.inflation)
    np.testing.assert_allclose(fitted.sigma, NOISE * inflation, rtol=1e-12)


def test_densities_are_those_of_scipy():
    u, deviation = (
        np.array([[0.3, -1.2], [2.0, 0.1]]),
        np.array([[0.1, 2.0], [1.0, 3.0]]),
    )
    censored = np.array([[0, 0], [1, -1]])
    found = log_densities(u, deviation, censored, np.array([7.0, np.inf]))
    student, normal = stats.t(7.0), stats.norm()
    expected = [
        [student.logpdf(0.3) - np.log(0.1), normal.logpdf(-1.2) - np.log(2.0)],
        # Of a limit the probability that the value is above or below it.
        [student.logsf(2.0), normal.logcdf(0.1)],
    ]
    assert found == pytest.approx(np.array(expected), rel=1e-10)


def fitted_linear_model(count, sigma):
    """Matrix, measurements and objective of a linear model, and its fit."""
    random = np.random.default_rng(3)
    matrix = random.normal(size=(count, 2))
    measured = matrix @ [0.5, -0.4] + sigma * random.normal(size=count)
    tests = {"speed_mps": np.linspace(5, 12, count), "e_n": measured}
    unknown = {"lower": 0.01, "upper": 100.0, "start": 1.0}
    study = study_of_columns(
        tests,
        default_sigma={"e_n": sigma},
        parameters={"alpha_s": unknown, "c_v": unknown},
    )
    linear = Linear(study)
    linear.bounds = linear.bounds._replace(
        lower=np.full(2, -1e3), upper=np.full(2, 1e3), logarithmic=np.zeros(2, bool)
    )
    # Half the range is the unit of x.
    linear.matrix = matrix * linear.bounds.half
    solution = np.linalg.lstsq(matrix, measured, rcond=None)[0]
    return matrix, measured, linear, linear((solution / linear.bounds.half)[None])


@pytest.mark.parametrize("exact", [True, False])
def test_densities_of_a_linear_model_are_exact(exact):
    """With sigma given, each left-out density is that of Bayesian linear regression."""
    count, sigma = 14, 0.1
    matrix, measured, linear, points = fitted_linear_model(count, sigma)
    found = held_out(
        *(linear, points, estimate(linear, points), np.arange(count)),
        exact=exact,
        sets=np.ones((1, 1), bool),
    )
    for left in range(count):
        rest = np.arange(count) != left
        inverse = np.linalg.inv(matrix[rest].T @ matrix[rest])
        fitted = inverse @ matrix[rest].T @ measured[rest]
        variance = sigma**2 * (1.0 + matrix[left] @ inverse @ matrix[left])
        normal = stats.norm(matrix[left] @ fitted, np.sqrt(variance))
        # The bounds are a weak prior, of 1e3 against 0.1.
        assert found.density[0, left] == pytest.approx(
            normal.logpdf(measured[left]), abs=1e-3
        )


class Flipping(Linear):
    """Linear but for the test whose row is the first of `matrix`: beyond a value its
    prediction is another."""

    beyond, first = np.inf, None

    def _predict(self, x, derivatives):
        predicted, outcomes, jacobian = super()._predict(x, derivatives)
        row = np.all(self.matrix == self.first, axis=1)[:, None]
        predicted = np.where(row & (predicted > self.beyond), 50.0, predicted)
        return predicted, outcomes, jacobian


@pytest.mark.parametrize("shift", [-0.5, 0.0, 2.0])
def test_density_of_a_test_beyond_a_jump(shift):
    """The integral over the normal distribution of what the rest predicts: here the
    fit to the rest is beyond the jump, and the measurement before it."""
    count, sigma = 14, 0.1
    matrix, measured, linear, points = fitted_linear_model(count, sigma)
    inverse = np.linalg.inv(matrix[1:].T @ matrix[1:])
    middle = matrix[0] @ inverse @ matrix[1:].T @ measured[1:]
    spread = sigma * np.sqrt(matrix[0] @ inverse @ matrix[0])
    flipping = Flipping(linear.study)
    vars(flipping).update(vars(linear))
    flipping.first, flipping.beyond = linear.matrix[0], middle - shift * spread
    found = held_out(
        *(flipping, points, estimate(linear, points), np.arange(count)),
        exact=True,
        sets=np.ones((1, 1), bool),
    )
    before = stats.norm(middle, spread).cdf(flipping.beyond)
    value = np.linspace(middle - 8.0 * spread, flipping.beyond, 20_001)
    density = stats.norm(middle, spread).pdf(value)
    density = density * stats.norm(value, sigma).pdf(measured[0])
    expected = np.log(np.sum(density) * (value[1] - value[0]))
    # Four standard errors of the share of 128 draws before the jump.
    error = 4.0 * np.sqrt((1.0 - before) / (before * 128))
    assert found.density[0, 0] == pytest.approx(expected, abs=error)
    # The derivative at the fit knows nothing of it.
    assert expected > stats.norm(50.0, 0.2).logpdf(measured[0]) + 1000.0


@pytest.mark.parametrize(
    "truth", [PfeifferBowen(0.4, 0.8), AnglePowerLaw(0.4, 0.5, 0.8)]
)
def test_the_short_way_agrees_with_exact_refits(truth):
    """One step stands for a refit where it is short: scores agree to a tenth of the
    4 below which a difference is no difference."""
    study = study_of_columns(made_by(truth, count=12, seed=5))
    found = fit_law(study, Contender("law", type(truth)))
    arguments = found.objective, found.points, found.uncertainty, np.arange(12)
    sets = np.array([[True, True], [True, False], [False, True]])
    short, exact = (
        held_out(*arguments, exact=exact, sets=sets) for exact in (False, True)
    )
    assert exact.refitted == 12
    assert short.refitted < 12
    assert np.sum(short.density[0]) == pytest.approx(np.sum(exact.density[0]), abs=0.4)
    # Predictions that do not jump have independent errors: e_n, and e_t, alone.
    assert exact.density[0] == pytest.approx(exact.density[1] + exact.density[2])


def test_stacking_weights_are_the_best_mixture():
    random = np.random.default_rng(0)
    scores = random.normal(size=(40, 2)) * [1.0, 1.5]
    weights = stacking_weights(scores)

    def score(weight):
        return -np.sum(
            np.log(
                weight * np.exp(scores[:, 0]) + (1.0 - weight) * np.exp(scores[:, 1])
            )
        )

    best = minimize_scalar(score, bounds=(0.0, 1.0), method="bounded")
    # The objective is flat at its maximum: 1e-3 of a weight moves it by 1e-5.
    assert weights[0] == pytest.approx(best.x, abs=5e-3)
    assert np.sum(weights) == pytest.approx(1.0, rel=1e-12)
    worse = np.stack([scores[:, 0], scores[:, 0] - 30.0], axis=1)
    assert stacking_weights(worse)[0] > 0.999


def test_differences_and_ties():
    scores = np.stack([np.zeros(10), np.linspace(-2.0, 0.0, 10)], axis=1)
    apart, error = difference(scores, 1, 0)
    assert apart == pytest.approx(-10.0)
    expected = np.sqrt(10) * np.std(scores[:, 1], ddof=1)
    assert error == pytest.approx(expected, rel=1e-12)
    assert not is_tie(apart, error)
    assert is_tie(-3.9, 0.1)
    assert is_tie(-10.0, 5.1)
    assert is_tie(-100.0, float("nan"))
    assert np.isnan(difference(scores[:4], 1, 0)[1])


@pytest.mark.parametrize(
    "truth",
    [
        ConstantCoefficients(0.4, 0.8),
        PfeifferBowen(0.4, 0.8),
        AnglePowerLaw(0.4, 0.6, 0.8),
    ],
    ids=lambda law: type(law).__name__,
)
def test_the_law_that_made_the_tests_is_preferred(truth):
    found = compare(made_by(truth), REBOUND)
    assert found.preferred == truth.words
    assert found.ties[0] == found.best
    assert sum(found.weights.values()) == pytest.approx(1.0)
    nested = isinstance(truth, ConstantCoefficients)
    # A power law of exponent 0 is a constant: it ties, and has a parameter more.
    assert (set(found.ties) == {REBOUND[0], REBOUND[2]}) == nested
    assert ("equally well" in repr(found)) == nested
    assert "0.02" in str(found.to_dataframe().loc[truth.words].round(2).to_list())
    assert found.to_xarray().law.values.tolist() == list(found.laws)
    axes = Figure().subplots()
    assert found.plot(ax=axes) is axes
    assert [label.get_text() for label in axes.get_yticklabels()] == list(found.laws)


def compared_with_model(tests, worse_by):
    """The model, whose score is lower than that of constant coefficients in each of
    some tests, and a little more so in each further one."""
    model = Variant("", {})
    scores = np.zeros((tests, 2))
    scores[:, 1] = -worse_by - 0.1 * np.arange(tests)
    laws = [
        SimpleNamespace(
            name=name, contender=Contender(name, law), count=count, named=count
        )
        for name, law, count in (
            ("constant coefficients", ConstantCoefficients, 2),
            ("model", model, 3),
        )
    ]
    names = tuple(f"row {number}" for number in range(tests))
    study = SimpleNamespace(variants=(model,), targets=("e_n", "e_t"))
    by_test = GroupScores("test", names, scores)
    return Compared(study, (), laws, by_test, [], np.array([1.0, 0.0]), {}), model


def test_a_law_that_predicts_better_than_the_model_is_named():
    compared, model = compared_with_model(tests=9, worse_by=2.0)
    (words,) = worse_than_others(compared, model)
    # Sum of 2.0, 2.1, ..., 2.8; nine times their variance, 0.075, is 0.82 squared.
    assert words == (
        "The model predicts e_n and e_t worse: its score is 21.6 ± 0.8 less than that "
        "of constant coefficients. Predict with constant coefficients."
    )
    assert verdict(compared)[0] == (
        "For e_n and e_t, use constant coefficients: it predicts tests left out better "
        "than all other laws."
    )
    tie, model = compared_with_model(tests=9, worse_by=0.0)
    assert worse_than_others(tie, model) == []


def test_with_few_tests_no_law_is_preferred():
    compared, model = compared_with_model(tests=4, worse_by=9.0)
    assert worse_than_others(compared, model) == []
    assert verdict(compared)[0] == (
        "For e_n and e_t, no law is preferred, since 4 of the 5 tests that are needed "
        "to tell which law predicts best were measured."
    )


def test_groups_targets_and_refusals_are_named(tmp_path):
    tests = made_by(ConstantCoefficients(0.4, 0.8))
    tests["test"] = [f"shot {number}" for number in range(24)]
    tests["campaign"] = ["north"] * 12 + ["south"] * 12
    tests["max_penetration_m"] = np.full(24, 0.1)
    found = compare(tests, REBOUND[:2], by=["campaign", "speed_mps"])
    assert found.compared.targets_left_out == ("max_penetration_m",)
    text = " ".join(str(found).split())
    for words in (
        "Left out: max_penetration_m",
        "For e_n and e_t alone, laws of rebound included, use constant coefficients",
        "By campaign of e_n and e_t alone (2 groups left out one by one)",
        "with fewer than 5 groups the differences have no standard error",
        "By speed_mps of e_n and e_t alone (5 groups",
    ):
        assert words in text
    found.write(tmp_path / "out")
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {
        *("comparison.html", "comparison.csv", "comparison.json"),
        "jaximpact-study.json",
    }
    lines = (tmp_path / "out" / "comparison.csv").read_text().splitlines()
    assert len(lines) == 1 + 2 * 24 * 2


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"by": 3}, "by must be of type str or Iterable"),
        ({"by": [3]}, "by names must be of type str, but is 3"),
        ({"by": [["campaign"]]}, "by names must be of type str"),
        ({"exact": "yes"}, "exact must be of type bool, but is 'yes' (str)"),
    ],
)
def test_a_comparison_that_cannot_be_made(options, words):
    with pytest.raises(InputError) as error:
        compare(made_by(ConstantCoefficients(0.4, 0.8)), REBOUND[:1], **options)
    assert_one_line(error.value, words)


def test_a_law_of_ones_own_is_compared(tmp_path):
    tests = made_by(Fading(half_speed=jnp.asarray(8.0)))
    found = compare(tests, ["constant coefficients", Fading])
    assert found.best == "Fading"
    assert found.ties == ("Fading",)
    fitted = found.law("Fading").parameters["half_speed"]
    # Ten standard errors: noise of 0.02 in 48 values of about 0.4.
    assert fitted == pytest.approx(8.0, rel=0.05)
    new = {"mass_kg": [50.0], "speed_mps": [8.0], "angle_deg": [30.0]}
    stacked = found.predict(new)
    assert stacked.middle[0] == pytest.approx([0.5, 0.5], abs=0.02)
    assert np.all((stacked.low < stacked.middle) & (stacked.middle < stacked.high))
    missing = "Not in the table, default values: density_kgm3 2577.8, aspect_ratio 1,"
    assert missing in str(stacked)


class Boundless(AbstractRebound):
    """A law whose parameter may be anything."""

    size: jax.Array = parameter(1.0, "-", "(0, inf)", "a size")

    def __call__(self, block, impact):
        return Rebound(-self.size, self.size, impact.angular_velocity)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"laws": ["constant"]}, "did you mean 'constant coefficients'"),
        ({"laws": []}, "laws is empty"),
        ({"laws": [3]}, "laws must hold names"),
        ({"laws": [ConstantCoefficients, "constant coefficients"]}, "twice"),
        ({"laws": [Boundless]}, "declare usual=(low, high)"),
        ({"laws": REBOUND, "by": "speed"}, "did you mean 'speed_mps'"),
        ({"laws": REBOUND, "by": "campaign"}, "one value in all tests"),
    ],
)
def test_what_cannot_be_compared_is_refused(given, words):
    tests = made_by(ConstantCoefficients(0.4, 0.8), count=6)
    with pytest.raises(InputError) as error:
        compare(tests, **given)
    assert_one_line(error.value, words)


def test_laws_of_rebound_need_a_target_that_they_predict():
    tests = {"speed_mps": [5.0, 8.0], "max_penetration_m": [0.1, 0.2]}
    with pytest.raises(InputError, match="predict none of max_penetration_m"):
        compare_study(study_of_columns(tests), REBOUND)


def test_parameters_without_influence_do_not_count():
    """e_t changes nothing that was measured, so that the law has one parameter."""
    tests = made_by(ConstantCoefficients(0.4, 0.8), targets=("e_n",))
    found = compare(tests, REBOUND)
    assert found.law("constant coefficients").count == 1
    assert found.preferred == "constant coefficients"
    assert "e_t without influence" in str(found)


# --- Cohesion as a contender


def drops(**changed):
    """Depths of drops, the study's options changed."""
    tests = {"mass_kg": [100.0, 400.0], "speed_mps": [10.0, 20.0], "e_n": [0.1, 0.2]}
    return study_given(tests | changed.pop("columns", {}), **changed)


def names(study):
    return [contender.name for contender in contenders_of(None, study)]


def test_grounds_compared_by_default_and_those_that_the_study_has():
    study = drops()
    assert names(study)[:4] == [
        *("model", "model with cohesion", "model with modulus at contact pressure"),
        "model with inertia",
    ]
    by_pressure = drops(ground={"elasticity": "ContactPressureModulus"})
    assert not any("pressure" in name for name in names(by_pressure))
    with pytest.raises(InputError, match="has ContactPressureModulus already"):
        contenders_of("model with modulus at contact pressure", by_pressure)
    (cohesive,) = contenders_of("Model with cohesion", study)
    objective = objective_of(study, cohesive)
    fitted = [one.name for one in objective.study.parameters]
    assert fitted == ["c_v", "gamma_v", "k_E", "cohesion_kPa"]
    for changed in (
        {"fit": ("c_v", "cohesion_kPa")},
        {"ground": {"cohesion_kPa": 20.0}},
        {"columns": {"cohesion_kPa": [5.0, 10.0]}},
    ):
        stated = drops(**changed)
        assert not any("cohesion" in name for name in names(stated))
        assert "model with inertia" in names(stated)
        with pytest.raises(InputError, match="fits or states cohesion_kPa"):
            contenders_of("model with cohesion", stated)


@pytest.mark.parametrize(
    ("law", "name", "column", "value"),
    [
        (Soil(dilatancy=0.5), "usual laws, dilatancy 0.5", "dilatancy", 0.5),
        (
            VesicWithInertia(ground_inertia=3.0),
            "bearing VesicWithInertia, ground_inertia 3",
            *("ground_inertia", 3.0),
        ),
        (Soil(friction_angle=np.deg2rad(25.0)), None, "friction_angle", 0.0),
    ],
)
def test_values_of_laws_given_as_objects(law, name, column, value):
    """They are those of the ground that is compared, but for what is fitted."""
    study = drops(ground={"friction_angle_deg": 30.0})
    (found,) = contenders_of([law, "model"], study)[:1]
    soil = objective_of(study, found).scene.soil
    if name is not None:
        assert found.name == name
        np.testing.assert_allclose(np.rad2deg(soil.friction_angle), 30.0)
        np.testing.assert_allclose(getattr(soil, column), value)
    else:
        np.testing.assert_allclose(np.rad2deg(soil.friction_angle), 25.0)
    # Two of the same laws are two contenders.
    assert len(contenders_of([Soil(dilatancy=0.5), Soil(dilatancy=1.0)], study)) == 2
    fitted = contenders_of([Soil(c_v=0.3)], study)[0]
    assert fitted.name == "usual laws"


class Lagging(FluidityRate):
    """A law of a user's own with a parameter that is small in its unit."""

    permeability: jax.Array = parameter(
        1e-9, "m/s", "(0, inf)", "permeability", usual=(1e-12, 1e-3)
    )


def test_small_values_of_laws_given_as_objects():
    """Five times the default is another value, in whatever unit."""
    laws = [Lagging(permeability=value) for value in (1e-9, 5e-9)]
    same, other = contenders_of(laws, drops())
    assert same.name == "flow Lagging"
    assert other.name == "flow Lagging, permeability 5e-09"


def test_points_of_a_curve_are_one_test(tmp_path):
    """They are left out together, as in the fit's own cross-validation."""
    times = tmp_path / "a.csv"
    times.write_text("time_s,normal_force_N\n0.001,2e4\n0.002,4e4\n0.004,3e4\n")
    (tmp_path / "tests.csv").write_text("force_curve,speed_mps\na.csv,5\na.csv,8\n")
    study = read_study(tmp_path / "tests.csv")
    _, names, group = _all_groups(study, [])[0]
    assert names == ("row 2", "row 3")
    np.testing.assert_array_equal(group, [-1, -1, 0, 0, 0, 1, 1, 1])


@pytest.mark.parametrize("jumping", [False, True])
def test_points_of_a_curve_beyond_a_jump_belong_to_one_draw(monkeypatch, jumping):
    """Their density is the mean over draws of their product, at the first of them, and
    not the product of their means."""
    count, sigma = 14, 0.1
    matrix, measured, linear, points = fitted_linear_model(count, sigma)
    group = np.minimum(np.arange(count), 11)
    kind = type(linear.study.tests)
    monkeypatch.setattr(kind, "first_of_row", property(lambda tests: group))
    monkeypatch.setattr(held_out_module, "DRAWS", 20_000)
    jumps = held_out_module._jumps
    monkeypatch.setattr(
        held_out_module, "_jumps", lambda *a: jumps(*a) | (jumping & (len(a[2]) == 3))
    )
    found = held_out(
        *(linear, points, estimate(linear, points), group),
        exact=True,
        sets=np.ones((1, 1), bool),
    )
    left = group == 11
    inverse = np.linalg.inv(matrix[~left].T @ matrix[~left])
    apart = measured[left] - matrix[left] @ inverse @ matrix[~left].T @ measured[~left]
    covariance = matrix[left] @ inverse @ matrix[left].T + np.eye(3)
    if not jumping:
        covariance = np.diag(np.diag(covariance))
    normal = stats.multivariate_normal(np.zeros(3), sigma**2 * covariance)
    # 20 000 draws, of which a tenth count.
    assert found.density[0, 11] == pytest.approx(normal.logpdf(apart), abs=0.06)
    np.testing.assert_array_equal(found.density[0, 12:], 0.0)


def test_groups_of_numbers_are_those_of_all_laws():
    """Also of a law of rebound, which predicts only a part of the targets."""
    speeds = np.linspace(5.0, 20.0, 15)
    e_n = np.where(np.arange(15) % 3, 0.3, np.nan)
    tests = {"speed_mps": speeds, "max_sinking_m": 0.1 * speeds, "e_n": e_n}
    study = study_of_columns(tests)
    _, names, group = _all_groups(study, "speed_mps")[1]
    _, others, part = _all_groups(of_targets(study, ("e_n",)), "speed_mps")[1]
    assert len(names) == 5
    assert names == others
    measured = np.isfinite(e_n)
    np.testing.assert_array_equal(part[measured], group[measured])


def comparison_of(tests, *laws):
    """Grounds and laws compared with few starts of each fit."""
    study = dataclasses.replace(study_of_columns(tests), starts=4)
    return Comparison(compare_study(study, laws))


GROUNDS = "model", "model with cohesion"


@pytest.fixture(scope="module")
def of_drops():
    """Grounds and a law of rebound on drops that the model made without cohesion."""
    draw = np.random.default_rng(1)
    speed = np.linspace(3.0, 15.0, 8)
    made = simulate_batch(Scene(Block(mass=100.0), Soil(), Impact(speed=speed)))
    noise = draw.lognormal(0.0, 0.02, (2, 8))
    tests = {
        "mass_kg": np.full(8, 100.0),
        "speed_mps": speed,
        "e_n": made.e_n * noise[0],
        "max_normal_force_N": made.max_normal_force * noise[1],
    }
    return comparison_of(tests, *GROUNDS, "constant coefficients")


@pytest.mark.slow
def test_tests_of_another_ground_are_not_predicted(of_drops):
    new = {"speed_mps": [10.0], "angle_deg": [30.0]}
    with pytest.raises(InputError, match="is FluidityRate, but the fit was made with"):
        of_drops.predict(new | {"flow": ["FluidityRate"]})
    with pytest.raises(InputError, match="c_v: was fitted, and cannot be given"):
        of_drops.predict(new | {"c_v": [0.5]})


def test_what_is_not_predicted_without_its_test_has_no_error():
    tests = made_by(ConstantCoefficients(0.4, 0.8), count=8)
    tests["e_t"] = np.where(np.arange(8) == 3, tests["e_t"], np.nan)
    found = compare(tests, ["constant coefficients"])
    (law,) = found.compared.laws
    e_t = found.compared.study.targets.index("e_t")
    assert np.isnan(law.rms_left_out[e_t])
    assert np.isfinite(law.rms_left_out[1 - e_t])
    assert "nan" not in str(found)


def test_groups_of_numbers_that_are_close():
    """Each value is a group of its own, and a row without a measurement is none."""
    speeds = [10.001, 10.002, 10.001, 10.003, 99.0]
    study = study_of_columns({"speed_mps": speeds, "e_n": [0.1, 0.2, 0.3, 0.4, None]})
    _, names, group = _all_groups(study, "speed_mps")[1]
    assert names == ("10.001", "10.002", "10.003")
    np.testing.assert_array_equal(group, [0, 1, 0, 2, -1])
    wide = np.append(1000.0 + 0.001 * np.arange(20), 5000.0)
    e_n = [*np.full(20, 0.2), None]
    study = study_of_columns({"mass_kg": wide, "e_n": e_n})
    _, names, group = _all_groups(study, "mass_kg")[1]
    assert len(names) == 5
    np.testing.assert_array_equal(np.bincount(group[:20]), 4)
    # One value in most tests.
    often = np.append(np.full(60, 5.0), 6.0 + np.arange(14))
    study = study_of_columns({"speed_mps": often, "e_n": np.full(74, 0.2)})
    assert len(_all_groups(study, "speed_mps")[1][1]) > 1


@pytest.mark.slow
@pytest.mark.parametrize("cohesion", [0.0, 60e3])
def test_cohesion_that_made_the_tests_is_found(cohesion):
    """Its parameter more is paid for: without it the model ties."""
    draw = np.random.default_rng(3)
    mass, speed = np.exp(draw.uniform(0.0, 7.0, 24)), draw.uniform(3.0, 20.0, 24)
    soil = Soil(c_v=0.5, gamma_v=4.0, k_E=400.0, cohesion=cohesion)
    made = simulate_batch(Scene(Block(mass=mass), soil, Impact(speed=speed)))
    noise = draw.lognormal(0.0, 0.03, (2, 24))
    tests = {
        "mass_kg": mass,
        "speed_mps": speed,
        "max_penetration_m": made.max_penetration * noise[0],
        "max_normal_force_N": made.max_normal_force * noise[1],
    }
    found = comparison_of(tests, *GROUNDS)
    if cohesion:
        assert found.ties == ("model with cohesion",)
    assert found.preferred == ("model with cohesion" if cohesion else "model")


@pytest.mark.slow
def test_grounds_on_all_targets_and_laws_of_rebound_on_theirs(of_drops, tmp_path):
    """Nothing measured is dropped: each has its comparison, by one fit."""
    found, beside = of_drops, of_drops.with_rebound
    assert found.targets == ("e_n", "max_normal_force_N")
    assert set(found.laws) == {*GROUNDS}
    assert beside.targets == ("e_n",)
    assert set(beside.laws) == {*GROUNDS, "constant coefficients"}
    assert beside.with_rebound is None
    for name in GROUNDS:
        assert found.law(name).parameters == beside.law(name).parameters
        assert found.law(name).rms_left_out[0] == beside.law(name).rms_left_out[0]
    text = " ".join(str(found).split())
    assert "For e_n and max_normal_force_N, use model" in text
    assert "; for e_n alone, laws of rebound included, use model" in text
    assert "Left out: max_normal_force_N" in text
    new = {"mass_kg": [100.0], "speed_mps": [9.0]}
    assert found.predict(new).middle.shape == (1, 2)
    assert beside.predict(new).middle.shape == (1, 1)
    whole = {law.name: law for law in found.predict(new).laws}
    for law in beside.predict(new).laws:
        if law.name in whole:
            e_n_alone = whole[law.name].discrepancy[:, :1]
            np.testing.assert_array_equal(law.discrepancy, e_n_alone)
    found.write(tmp_path / "out")
    lines = (tmp_path / "out" / "comparison.csv").read_text().splitlines()
    assert len(lines) == 1 + 2 * 16 + 3 * 8

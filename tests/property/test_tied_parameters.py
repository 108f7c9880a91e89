"""Parameters that are expressions of others, and parameters that differ by group."""

import jax
import numpy as np
import pytest
from calibration_studies import Linear
from error_messages import assert_one_line

from jaximpact import Soil
from jaximpact.calibration import calibrate, predict
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.diagnostics.importance_sampling import draw
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.estimation.starts import fit
from jaximpact.calibration.problem.expressions import Tied, read_tied
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective, names_of
from jaximpact.errors import InputError
from jaximpact.io.toml import Key
from jaximpact.quantities import INPUT_COLUMNS

INPUTS = {
    "mass_kg": [50.0, 300.0, 900.0, 120.0, 400.0, 80.0],
    "speed_mps": [6.0, 12.0, 20.0, 9.0, 15.0, 5.0],
    "angle_deg": [15.0, 40.0, 30.0, 0.0, 20.0, 50.0],
}


def objective_given(fit, inputs=INPUTS, **columns):
    count = len(inputs["mass_kg"])
    nothing = {name: np.ones(count) for name in ("e_n", "max_penetration_m")}
    study = study_given(inputs | nothing | columns, fit, *(None,) * 6)
    return Objective(study, study.variants[0], models_of(study)[0])


def at(objective, values):
    return objective.bounds.coordinate(np.array(values, float))[None]


def assert_derivatives(objective, x):
    """Of the model, by central differences with a step of 1e-5, where its errors are
    some 1e-9."""
    jacobian, step = objective(x).jacobian[0], 1e-5
    for unknown in range(x.shape[1]):
        ahead, back = x.copy(), x.copy()
        ahead[0, unknown] += step
        back[0, unknown] -= step
        change = objective.values(ahead).predicted - objective.values(back).predicted
        apart = jacobian[..., unknown] - change[0] / (2.0 * step)
        assert np.max(np.abs(apart)) < 2e-3 * np.max(np.abs(jacobian))


@pytest.mark.parametrize(
    "text",
    [
        "2 * a - b / 3",
        "a ** 2 + 1",
        "a ** b",
        "-sqrt(a) * exp(-b) + c",
        "log(a * b) ** 2 / c",
        "sin(a) + cos(b) * tan(c / 10)",
        "2.5e2",
    ],
)
def test_expressions_and_their_derivatives(text):
    """Values are Python's; derivatives by central differences, exact to 1e-8."""
    tied = Tied("y", text, {"c": 1.7})
    functions = {n: getattr(np, n) for n in ("sqrt", "exp", "log", "sin", "cos", "tan")}
    step = 1e-6
    for p in ({"a": 1.3, "b": 0.6}, {"a": 2.2, "b": 1.9}):
        expected = eval(text, functions, {**p, "c": 1.7})
        assert tied.evaluate(p) == pytest.approx(expected, rel=1e-13)
        rates = jax.grad(lambda p: jax.numpy.asarray(tied.evaluate(p), float))(p)
        for name in p:
            ahead, back = (
                tied.evaluate(p | {name: p[name] + change}) for change in (step, -step)
            )
            assert rates[name] == pytest.approx((ahead - back) / (2 * step), abs=1e-7)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("__import__('os')", "calls __import__"),
        ("c_v.real", "alone"),
        ("c_v if c_v else 1", "alone"),
        ("[c_v][0]", "alone"),
        ("c_v @ c_v", "alone"),
        ("True * c_v", "truth value"),
        ("2 * c_w", "did you mean 'c_v'"),
        ("2 *", "is no expression"),
        ("1 - c_v", "must be above 0"),
        (3.0, "must be a text"),
        ("c_v" + " + c_v" * 200, "must be a text"),
    ],
)
def test_what_is_no_expression_is_refused(text, words, tmp_path):
    column = INPUT_COLUMNS["k_E"]
    with pytest.raises(InputError) as error:
        read_tied(
            Key(tmp_path / "study.toml", "parameters.k_E.expression"),
            *("k_E", text),
            *({"c_v": (0.1, 10.0)}, {}, column),
        )
    assert_one_line(error.value, words, "parameters.k_E.expression")


def test_a_tied_parameter_follows_the_others():
    tied = objective_given({"c_v": {}, "k_E": {"expression": "300 * sqrt(c_v) + 50"}})
    free = objective_given({"c_v": {}, "k_E": {}})
    value = 300.0 * np.sqrt(2.0) + 50.0
    found, expected = tied(at(tied, [2.0])), free(at(free, [2.0, value]))
    # The same impacts: rounding of the expression alone.
    assert found.predicted == pytest.approx(expected.predicted, rel=1e-9)
    assert_derivatives(tied, at(tied, [2.0]))


def test_groups_have_factors_on_a_parameter():
    groups = ["north"] * 3 + ["south"] * 3
    fit = {"c_v": {"by": "campaign", "group_sd": 0.3}, "k_E": {}}
    pooled = objective_given(fit, campaign=groups)
    assert names_of(pooled.study) == ["c_v", "k_E", "c_v[north]", "c_v[south]"]
    x = at(pooled, [2.0, 900.0, 0.2, -0.4])
    free = objective_given({"c_v": {}, "k_E": {}})
    predicted = pooled.values(x).predicted[0]
    for tests, factor in (([0, 1, 2], np.exp(0.2)), ([3, 4, 5], np.exp(-0.4))):
        alone = free.values(at(free, [2.0 * factor, 900.0])).predicted[0]
        assert predicted[tests] == pytest.approx(alone[tests], rel=1e-9)
    assert_derivatives(pooled, x)


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"by": "campaign", "group_sd": "estimated"}, "must be a number"),
        ({"by": "campaign"}, "group_sd: is missing"),
        ({"group_sd": 0.3}, "by: is missing"),
        ({"by": "campaign", "group_sd": -1.0}, "must lie above 0"),
        ({"by": "shape", "group_sd": 0.3}, "by"),
    ],
)
def test_groups_that_cannot_be_used_are_refused(entry, words):
    with pytest.raises(InputError) as error:
        objective_given({"c_v": entry})
    assert_one_line(error.value, words)


GROUPS, EACH, SIGMA, GROUP_SD = 6, 4, 0.1, 0.3


class OneWay(Linear):
    """Predictions mu + b_g, linear in x: one-way random effects."""

    @property
    def matrix(self):
        groups = self.study.nuisances[0].group[:, None] == np.arange(GROUPS)
        columns = np.column_stack([np.ones(GROUPS * EACH), groups])
        return columns * self.bounds.slope(np.zeros(1 + GROUPS))


def one_way(measured):
    names = [f"{number}" for number in range(GROUPS) for _ in range(EACH)]
    tests = {"e_n": measured.ravel(), "speed_mps": np.full(measured.size, 5.0)}
    study = study_given(
        tests | {"campaign": names},
        *({"c_v": {"by": "campaign", "group_sd": GROUP_SD}}, None, None, None),
        *({"e_n": SIGMA}, None, None),
    )
    objective = OneWay(study, study.variants[0], None)
    return objective, fit(objective, np.zeros((1, 1 + GROUPS))).points


def exact_posterior(measured):
    """Means and standard deviations of the common value and of the first group's
    deviation, groups and noise of known standard deviations."""
    means, noise = np.mean(measured, axis=1), SIGMA**2 / EACH
    total, kept = GROUP_SD**2 + noise, noise / (GROUP_SD**2 + noise)
    apart = (1.0 - kept) * (means[0] - np.mean(means))
    variance = GROUP_SD**2 * kept + (1.0 - kept) ** 2 * total / GROUPS
    return np.array([np.mean(means), apart]), np.sqrt([total / GROUPS, variance])


def test_uncertainty_of_groups_is_that_of_one_way_random_effects():
    """In closed form for groups of equal size (Searle, Casella and McCulloch 1992,
    section 4.5): the fit, its standard errors, and draws."""
    random = np.random.default_rng(8)
    measured = 0.5 + SIGMA * random.normal(size=(GROUPS, EACH))
    measured += GROUP_SD * random.normal(size=(GROUPS, 1))
    objective, points = one_way(measured)
    mean, deviation = exact_posterior(measured)
    uncertainty = estimate(objective, points)
    # The group's deviation is a fraction of half its range in x.
    unit = np.array([1.0, objective.bounds.half[1]])
    assert points.x[0, :2] * unit == pytest.approx(mean, abs=1e-3)
    assert uncertainty.standard_errors[:2] * unit == pytest.approx(deviation, rel=1e-6)
    found = draw(objective, points, 1.0, count=4000)
    errors = np.sqrt(np.diag(found.covariance())[:2]) * unit
    # 4 standard errors of some 2500 independent draws.
    assert np.all(np.abs(found.mean()[:2] * unit - mean) < 0.08 * deviation)
    assert errors == pytest.approx(deviation, rel=0.06)


@pytest.mark.slow
def test_a_fit_with_a_tie_and_groups_is_found_and_predicts(tmp_path):
    """Tests of two grounds whose c_v differ by a factor of 1.5; noise-free, so that the
    prior on its logarithm moves it by little."""
    inputs = {name: values * 2 for name, values in INPUTS.items()}
    fit = {
        "c_v": {"by": "campaign", "group_sd": 0.3},
        "k_E": {"expression": "600 * c_v"},
    }
    groups = ["north"] * 6 + ["south"] * 6
    model = objective_given(fit, inputs, campaign=groups)
    truth = [1.5, np.log(1.5) / 2.0, -np.log(1.5) / 2.0]
    measured = model.values(at(model, truth)).predicted[0].T
    columns = dict(zip(model.study.targets, measured, strict=True))
    tests = inputs | columns | {"campaign": groups}
    sigma = {"e_n": 1e-3, "max_penetration_m": 1e-3}
    found = calibrate(tests, fit=fit, sigma=sigma, out=tmp_path / "out")
    values = found.result.variants[0].parameters
    assert values == pytest.approx(truth, abs=0.02)
    assert isinstance(found.soil, Soil)
    assert float(found.soil.k_E) == pytest.approx(600.0 * values[0], rel=1e-12)
    new = {name: values[:2] for name, values in INPUTS.items()}
    new["campaign"] = ["north", "east"]
    text = predict(tmp_path / "out", new)
    (variant,) = text.variants
    assert variant.best[0] == pytest.approx(measured[:, 0], abs=2e-3)
    # A ground that the fit has not seen is less certain.
    width = variant.high_95 - variant.low_95
    assert np.all(width[1] > 2.0 * width[0])

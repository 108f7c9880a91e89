"""Parameters that are expressions of others, and parameters that differ by group."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from calibration_studies import Linear
from error_messages import assert_one_line
from scipy.optimize import brentq
from scipy.special import ndtr

from jaximpact import Soil
from jaximpact.calibration import calibrate, predict, sample_posterior
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.diagnostics.importance_sampling import draw
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.estimation.sigma import settle
from jaximpact.calibration.estimation.starts import fit
from jaximpact.calibration.problem.expressions import Tied, read_tied
from jaximpact.calibration.problem.forward_model import engine_of
from jaximpact.calibration.problem.nuisance import LEAST_GROUP_SD, MOST_GROUP_SD
from jaximpact.calibration.problem.objective import Objective, names_of
from jaximpact.errors import InputError
from jaximpact.io.toml import Key
from jaximpact.progress import Progress
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
    return Objective(study, study.variants[0], engine_of(study))


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
    p = np.array([[1.3, 0.6], [2.2, 1.9]])
    value, rate = tied.evaluate(("a", "b"), p)
    functions = {n: getattr(np, n) for n in ("sqrt", "exp", "log", "sin", "cos", "tan")}
    for lane, (a, b) in enumerate(p):
        expected = eval(text, functions, {"a": a, "b": b, "c": 1.7})
        assert value[lane] == pytest.approx(expected, rel=1e-13)
    step = 1e-6
    for index in range(2):
        ahead, back = p.copy(), p.copy()
        ahead[:, index] += step
        back[:, index] -= step
        change = (
            tied.evaluate(("a", "b"), ahead)[0] - tied.evaluate(("a", "b"), back)[0]
        )
        assert rate[:, index] == pytest.approx(change / (2 * step), abs=1e-7)


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
        ({"by": "campaign", "group_sd": "free"}, "must be a number"),
        ({"group_sd": 0.3}, "by: is missing"),
        ({"by": "campaign", "group_sd": -1.0}, "must lie above 0"),
        ({"by": "shape", "group_sd": 0.3}, "by"),
    ],
)
def test_groups_that_cannot_be_used_are_refused(entry, words):
    with pytest.raises(InputError) as error:
        objective_given({"c_v": entry})
    assert_one_line(error.value, words)


GROUPS, EACH = 6, 4


class OneWay(Linear):
    """Predictions mu + b_g, linear in x: one-way random effects."""

    @property
    def matrix(self):
        groups = self.study.nuisances[0].group[:, None] == np.arange(GROUPS)
        columns = np.column_stack([np.ones(GROUPS * EACH), groups])
        return columns * self.bounds.slope(np.zeros(1 + GROUPS))

    def _wanted(self, x, free):
        return np.ones(x.T.shape, bool)


def one_way(measured, sigma):
    names = [f"{number}" for number in range(GROUPS) for _ in range(EACH)]
    tests = {"e_n": measured.ravel(), "speed_mps": np.full(measured.size, 5.0)}
    study = study_given(
        tests | {"campaign": names},
        *({"c_v": {"by": "campaign"}}, None, None, None, sigma, None, None),
    )
    objective = OneWay(study, study.variants[0], None)
    start = fit(objective, np.zeros((1, 1 + GROUPS)))
    objective, best = settle(objective, start, fit, Progress())
    return objective, best.points


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("between", [0.3, 0.0])
def test_sds_of_groups_are_those_of_one_way_random_effects(stated, between):
    """In closed form for groups of equal size: the mean squares within and between
    groups (Searle, Casella and McCulloch 1992, section 4.5)."""
    random = np.random.default_rng(4)
    measured = 0.5 + 0.1 * random.normal(size=(GROUPS, EACH))
    measured += between * random.normal(size=(GROUPS, 1))
    objective, points = one_way(measured, {"e_n": 0.1} if stated else None)
    means = np.mean(measured, axis=1)
    of_groups = EACH * np.var(means, ddof=1)
    within = np.sum((measured - means[:, None]) ** 2) / (GROUPS * (EACH - 1))
    within = 0.01 if stated else within
    (nuisance,) = objective.study.nuisances
    # Where both are estimated, rounds end at changes of 0.3 %.
    tolerance = 1e-5 if stated else 5e-3
    if between:
        expected = np.sqrt((of_groups - within) / EACH)
        assert nuisance.prior.sd == pytest.approx(expected, rel=tolerance)
        assert objective.sigma[0, 0] == pytest.approx(np.sqrt(within), rel=tolerance)
        shrunk = (means - np.mean(means)) * (1.0 - within / of_groups)
        found = objective.bounds.parameter(points.x[0])[1:]
        assert found == pytest.approx(shrunk, abs=1e-3)
    else:
        assert of_groups < within * 1.2  # the estimate is at its least, or near it
        assert nuisance.prior.sd < 0.03


def exact_posterior(measured, sigma):
    """Posterior of one-way random effects with known sigma on a grid of s, uniform
    between its limits: s, its probabilities, and mean and variance for each s of the
    common value, of the first group's deviation and of a new group's value."""
    s = np.linspace(LEAST_GROUP_SD, MOST_GROUP_SD, 5001)
    means = np.mean(measured, axis=1)
    count, noise = len(means), sigma**2 / measured.shape[1]
    total = s**2 + noise
    squares = np.sum((means - np.mean(means)) ** 2)
    log = -0.5 * (count - 1) * np.log(total) - 0.5 * squares / total
    shares = np.exp(log - np.max(log))
    kept = noise / total
    apart = (1.0 - kept) * (means[0] - np.mean(means))
    variance = s**2 * kept + (1.0 - kept) ** 2 * total / count
    common = np.mean(means) + 0.0 * s
    return (
        s,
        shares / np.sum(shares),
        {
            "common": (common, total / count),
            "first": (apart, variance),
            "new": (common, total / count + s**2),
        },
    )


def quantile_of(weights, values, part):
    order = np.argsort(values)
    upto = np.cumsum(weights[order]) - 0.5 * weights[order]
    return float(np.interp(part, upto, values[order]))


def quantile_of_normals(shares, mean, deviation, part):
    """Quantile of a mixture of normal distributions."""
    ends = np.min(mean - 9.0 * deviation), np.max(mean + 9.0 * deviation)
    return brentq(lambda at: shares @ ndtr((at - mean) / deviation) - part, *ends)


@pytest.mark.parametrize("between", [0.2, 0.04])
def test_uncertainty_of_group_sds_is_that_of_one_way_random_effects(between):
    """Draws and standard errors against the exact posterior, where groups differ by
    more, and by less, than their means scatter."""
    random = np.random.default_rng(8)
    sigma, count = 0.1, 20_000
    measured = 0.5 + sigma * random.normal(size=(GROUPS, EACH))
    measured += between * random.normal(size=(GROUPS, 1))
    objective, points = one_way(measured, {"e_n": sigma})
    s, shares, exact = exact_posterior(measured, sigma)
    found = draw(objective, points, 1.0, count=count)
    values = objective.bounds.parameter(found.x)
    # c_v is fitted in its logarithm, in which predictions are linear.
    drawn = {"common": found.x[:, 0], "first": values[:, 1]}
    new = random.normal(0.0, found.group_sds["c_v"])
    drawn["new"] = found.x[:, 0] + new
    assert found.effective_fraction[-1] > 0.5
    for part in (0.025, 0.5, 0.975):
        # 10 000 effective draws tell a quantile of the tails to 3 % of a standard
        # deviation, and values of s 5 % apart to a third of a step.
        of_s = quantile_of(found.weights, found.group_sds["c_v"], part)
        assert of_s == pytest.approx(quantile_of(shares, s, part), rel=0.08, abs=2e-3)
        for name, values in drawn.items():
            mean, variance = exact[name]
            expected = quantile_of_normals(shares, mean, np.sqrt(variance), part)
            width = np.sqrt(shares @ variance)
            at = quantile_of(found.weights, values, part)
            assert at == pytest.approx(expected, abs=0.1 * width)
    errors = estimate(objective, points).standard_errors[:2]
    errors *= [1.0, objective.bounds.half[1]]
    for place, name in enumerate(("common", "first")):
        mean, variance = exact[name]
        expected = np.sqrt(shares @ (variance + mean**2) - (shares @ mean) ** 2)
        assert errors[place] == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
def test_nuts_samples_the_sds_of_groups_too():
    """The exact posterior of one-way random effects again."""
    pytest.importorskip("blackjax")
    pytest.importorskip("arviz")
    random = np.random.default_rng(8)
    measured = 0.5 + 0.1 * random.normal(size=(GROUPS, EACH))
    measured += 0.2 * random.normal(size=(GROUPS, 1))
    objective, points = one_way(measured, {"e_n": 0.1})
    objective.engine = SimpleNamespace(kernel="the linear model")
    fitted = SimpleNamespace(
        objective=objective, points=points, uncertainty=estimate(objective, points)
    )
    found = sample_posterior(fitted, warmup=200, count=500, seed=2)
    chains = found.chains
    assert chains.scale_reduction.shape == (GROUPS + 2,)
    assert np.all(chains.scale_reduction < 1.03)
    effective = np.min(chains.effective)
    assert effective > 200.0
    s, shares, exact = exact_posterior(measured, 0.1)
    mean = shares @ np.log(s)
    deviation = np.sqrt(shares @ np.log(s) ** 2 - mean**2)
    # 4 standard errors of a mean, and of a standard deviation.
    error = 4.0 / np.sqrt(effective)
    logs = np.log(found.group_sds["c_v"])
    assert abs(np.mean(logs) - mean) < error * deviation
    assert np.std(logs) == pytest.approx(deviation, rel=error)
    common, variance = exact["common"]
    deviation = np.sqrt(shares @ variance)
    assert abs(np.mean(found.x[:, 0]) - common[0]) < error * deviation
    assert np.std(found.x[:, 0]) == pytest.approx(deviation, rel=error)


@pytest.mark.slow
def test_a_fit_with_a_tie_and_groups_is_found_and_predicts(tmp_path):
    """Tests of two grounds whose c_v differ by a factor of 1.5; noise-free, so that the
    prior on its logarithm, whose deviation is estimated, moves it by little."""
    inputs = {name: values * 2 for name, values in INPUTS.items()}
    fit = {
        "c_v": {"by": "campaign"},
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
    # k_E tells the common c_v: the root mean square of the groups about it.
    (variant,) = json.loads((tmp_path / "out" / "fit.json").read_text())["variants"]
    group_sd = variant["group_sd"]["c_v"]
    assert group_sd == pytest.approx(truth[1], rel=0.05)
    assert f"0 +- {group_sd:.4g} (estimated)" in str(found)
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

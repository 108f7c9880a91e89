"""Parameters that are expressions of others, and parameters that differ by group."""

import jax
import numpy as np
import pytest
from calibration_studies import Linear, fit

from jaximpact import Block, Impact, Scene, Soil, simulate_batch
from jaximpact.calibration import calibrate, predict
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.diagnostics.importance_sampling import draw
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.problem.expressions import Tied


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
        {"c_v": {"by": "campaign", "group_sd": GROUP_SD}},
        sigma={"e_n": SIGMA},
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


INPUTS = {
    "mass_kg": [50.0, 300.0, 900.0, 120.0, 400.0, 80.0],
    "speed_mps": [6.0, 12.0, 20.0, 9.0, 15.0, 5.0],
    "angle_deg": [15.0, 40.0, 30.0, 0.0, 20.0, 50.0],
}


@pytest.mark.slow
def test_a_fit_with_a_tie_and_groups_is_found_and_predicts(tmp_path):
    """Tests of two grounds whose c_v differ by a factor of 1.5; noise-free, so that the
    prior on its logarithm moves it by little."""
    middle, factor = 1.5, np.sqrt(1.5)
    blocks = Block(mass=np.array(INPUTS["mass_kg"]))
    impact = Impact.from_degrees(
        np.array(INPUTS["speed_mps"]), np.array(INPUTS["angle_deg"])
    )
    soils = (
        Soil(c_v=c, k_E=600.0 * middle) for c in (middle * factor, middle / factor)
    )
    results = [simulate_batch(Scene(blocks, soil, impact)) for soil in soils]
    tests = {name: values * 2 for name, values in INPUTS.items()}
    tests |= {
        "campaign": ["north"] * 6 + ["south"] * 6,
        "e_n": np.concatenate([each.e_n for each in results]),
        "max_penetration_m": np.concatenate([r.max_penetration for r in results]),
    }
    fit = {
        "c_v": {"by": "campaign", "group_sd": 0.3},
        "k_E": {"expression": "600 * c_v"},
    }
    sigma = {"e_n": 1e-3, "max_penetration_m": 1e-3}
    found = calibrate(tests, fit=fit, sigma=sigma, out=tmp_path / "out")
    values = found.result.variants[0].parameters
    truth = middle, np.log(factor), -np.log(factor)
    assert values == pytest.approx(truth, abs=0.02)
    assert isinstance(found.soil, Soil)
    assert float(found.soil.k_E) == pytest.approx(600.0 * values[0], rel=1e-12)
    new = {name: values[:2] for name, values in INPUTS.items()}
    new["campaign"] = ["north", "east"]
    (variant,) = predict(tmp_path / "out", new).variants
    assert variant.best[0, 0] == pytest.approx(tests["e_n"][0], abs=2e-3)
    # A ground that the fit has not seen is less certain.
    width = variant.high_95 - variant.low_95
    assert np.all(width[1] > 2.0 * width[0])

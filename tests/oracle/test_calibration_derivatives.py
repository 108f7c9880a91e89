"""Costs and derivatives of studies against impacts that are simulated one by one, from
scenes and formulas written out here, and against their central differences."""

import jax
import numpy as np
import pytest
from calibration_studies import objective_of, write_study_of
from paths import ROOT
from scipy.stats import norm
from text_files import write_rows

from jaximpact import PRESETS, Accuracy, Block, Scene, simulate
from jaximpact.quantities import CURVE_COLUMNS, TARGET_COLUMNS
from jaximpact.scene_quantities import scene_with

pytestmark = pytest.mark.slow

EXACT = Accuracy("exact", 1e-11, PRESETS["reference"].floor)
"""Far below every preset, so that differences are not the noise of an integration, and
derivatives not those of its steps."""
STEP = 1e-4
CLOSE = 2e-5
"""Of the largest derivative of a target. Nearly all agree to 1e-6; where next to
nothing is left of a result, steps that pass a switch of the laws by 1e-9 are seen."""
SHIPPED = (
    *("ambroso2005", "beladjine2007", "gerber2019", "katsuragi2007", "labiouse1996"),
    *("lu2019", "wyllie", "twins/slow", "twins/slower", "twins/very-dense"),
)
# Not penner2002: at one of its points e_n is 0.01 in all tests, and the derivatives of
# so little are right to 1e-4 alone.

# What none of the above has: a robust loss, weights, priors, a tie, factors of groups,
# nuisances of every kind, limits, gaps, force curves and targets that follow from
# others.
STUDY = """
data = "tests.csv"
loss = "student"
weights = { e_n = 2.0 }
[parameters]
c_v = { start = 1.0, by = "campaign", group_sd = 0.3 }
gamma_v = { start = 6.0, prior = { mean = 8.0, sd = 3.0 } }
k_E = { expression = "300 * sqrt(c_v) + 50" }
[nuisance]
slope_deg = { by = "campaign", prior = { mean = 1.0, sd = 3.0 } }
mass_kg = { by = "row", prior = { mean = 0.0, sd = 5.0 } }
speed_mps = { by = "row", prior = { mean = 0.0, sd = 0.5 } }
"""
COLUMNS = (
    *("mass_kg", "aspect_ratio", "orientation_deg", "speed_mps", "angle_deg"),
    *("campaign", "force_curve", "e_n", "sigma_e_n", "translational_ratio"),
    *("rebound_angle_deg", "normal_impulse_Ns", "tangential_impulse_Ns"),
    *("final_sinking_m", "max_tangential_force_N"),
)
ROWS = (
    (50, 1.2, 10, 6, 15, "a", "both.csv", 0.2, 0.02, 0.3, 60, 350, ">9", 0.02, 2e3),
    (300, 2, 30, 12, 40, "a", "normal.csv", "<0.4", 0.05, 0.2, 70, 3e3, 800, "", 2e4),
    (900, 1.5, 70, 20, -30, "b", "", "", "", 0.1, -50, 2e4, -4e3, 0.3, 9e4),
)
CURVES = {
    "both.csv": [(-0.001, 0, 0), (0.004, 3e3, 800), (0.012, 5e3, 1e3), (0.02, 2e3, "")],
    "normal.csv": [(0.1, 0.0, ""), (0.01, 4e4, "")],
}


@pytest.fixture(scope="module")
def made_up(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made-up")
    for name, points in CURVES.items():
        write_rows(folder / name, ("time_s", *CURVE_COLUMNS), points)
    return write_study_of(folder, STUDY, COLUMNS, ROWS)


def scene_of(study, test, p):
    """The scene of one test: columns of the table, fixed values, then the unknowns."""
    columns = study.tests.inputs
    values = {name: columns[name][test] for name in columns if name != "time_s"}
    values |= study.soil | study.variants[0].soil
    count = len(study.parameters)
    fitted = {one.name: p[place] for place, one in enumerate(study.parameters)}
    values |= fitted
    for nuisance in study.nuisances:
        own = p[count + nuisance.group[test]]
        count += len(nuisance.groups)
        if nuisance.pooled:
            values[nuisance.name] *= np.exp(own)
        else:
            values[nuisance.name] = own + columns.get(nuisance.name, 0.0 * p)[test]
    for tied in study.tied:
        values[tied.name] = eval(tied.text, {"sqrt": np.sqrt}, fitted)
    block = Block(shape=study.tests.base.block.shape)
    return scene_with(Scene(block), values)


def result(name, scene, found):
    """A target of one impact, in the unit of its column."""
    block, impact = scene.block, scene.impact
    v_n, v_t = found.normal_velocity, found.tangential_velocity
    before = impact.speed * np.array([np.cos(impact.angle), np.sin(impact.angle)])
    match name:
        case "translational_ratio":
            return (v_n**2 + v_t**2) / impact.speed**2
        case "rebound_angle_deg":
            return np.degrees(np.arctan2(v_t, -v_n))
        case "normal_impulse_Ns":
            return block.mass * (before[0] - v_n)
        case "tangential_impulse_Ns":
            return block.mass * (before[1] - v_t)
        case "normal_force_N" | "tangential_force_N":
            return getattr(found.history, CURVE_COLUMNS[name].field)[..., 0]
    return getattr(found, TARGET_COLUMNS[name].field)


def simulated(study, test, points):
    """Targets of one test at several p, shape (points, targets); NaN without one."""
    scenes = [scene_of(study, test, p) for p in points]
    scene = jax.tree.map(lambda *leaves: np.stack(leaves), *scenes)
    time = study.tests.times[test]
    at = [time] if np.isfinite(time) else None
    found = simulate(scene, accuracy=EXACT, save_at=at)
    results = np.full((len(points), len(study.targets)), np.nan)
    for place, name in enumerate(study.targets):
        if (name in CURVE_COLUMNS) == np.isfinite(time):
            results[:, place] = result(name, scene, found)
    return results


def cost_of(objective, p, predicted):
    """Negative logarithm of likelihood and priors, measurement by measurement."""
    study, cost = objective.study, 0.0
    for test, target in np.argwhere(study.known):
        u = predicted[test, target] - study.measured[test, target]
        u /= study.sigma[test, target]
        sign = study.censored[test, target]
        square = -2.0 * norm.logcdf(sign * u) if sign else u**2
        loss = 2.5 * np.log1p(square / 4.0) if study.loss == "student" else square / 2.0
        cost += study.weights[target] * loss
    priors = [one.prior for one in study.parameters]
    for nuisance in study.nuisances:
        priors += [nuisance.prior] * len(nuisance.groups)
    for value, prior in zip(p, priors, strict=True):
        cost += 0.5 * ((value - prior.mean) / prior.sd) ** 2 if prior else 0.0
    return cost


def random_points(objective, count=2):
    """Points in the middle half of the bounds, nuisances within their priors."""
    random, study = np.random.default_rng(0), objective.study
    x = objective.bounds.at_fraction(
        random.uniform(0.25, 0.75, (count, len(objective.bounds.lower)))
    )
    first = len(study.parameters)
    mean, sd = objective.prior_mean[first:], objective.prior_sd[first:]
    p = mean + sd * random.uniform(-1.0, 1.0, (count, len(mean)))
    x[:, first:] = p / objective.bounds.half[first:]
    return x


@pytest.mark.parametrize("name", [*SHIPPED, "made up"])
def test_costs_and_derivatives_are_those_of_plain_simulations(name, made_up):
    """Derivatives by central differences, but for results whose differences of two
    steps do not agree: they are near a jump or a kink."""
    path = made_up if name == "made up" else ROOT / "calibration" / name / "study.toml"
    whole = objective_of(path, EXACT)
    every = max(1, len(whole.study.tests) // 5)
    tests = np.arange(0, len(whole.study.tests), every)
    objective = whole if name == "made up" else whole.of_tests(tests)
    x = random_points(objective)
    points, steps = objective(x), STEP * np.eye(x.shape[1])
    for lane, at in enumerate(x):
        around = np.concatenate([at + k * steps for k in (1, -1, 2, -2)] + [[at]])
        around = objective.bounds.parameter(around)
        found = [simulated(whole.study, test, around) for test in tests]
        *found, predicted = np.stack(found, axis=1)
        np.testing.assert_allclose(points.predicted[lane], predicted, rtol=1e-6)
        *costs, cost = (
            cost_of(objective, p, values)
            for p, values in zip(around, [*found, predicted], strict=True)
        )
        assert points.cost[lane] == pytest.approx(cost, rel=1e-6)
        ahead, back, far_ahead, far_back = np.split(np.moveaxis(found, 0, -1), 4, -1)
        slopes = (ahead - back) / (2.0 * STEP)
        size = np.nanmax(np.abs(slopes), axis=(0, 2), keepdims=True)
        rough = np.abs((far_ahead - far_back) / (4.0 * STEP) - slopes) > 5e-5 * size
        defined = np.isfinite(slopes)
        assert np.mean(rough[defined]) < 0.05
        apart = np.abs(points.jacobian[lane] - slopes) / size
        assert np.all(apart[defined & ~rough] < CLOSE)
        if not np.any(rough):
            ahead, back, _, _ = np.split(np.array(costs), 4)
            slopes = (ahead - back) / (2.0 * STEP)
            apart = points.gradient[lane] - slopes
            assert np.all(np.abs(apart) < CLOSE * np.max(np.abs(slopes)))

"""Calibration: coordinates, steps, known values recovered, verdicts, bad studies."""

import dataclasses
import json
from types import SimpleNamespace

import numpy as np
import pytest
from calibration_studies import Linear, objective_of, write_study_of
from error_messages import assert_one_line_error

from jaximpact import PRESETS, Accuracy, Block, Impact, Soil, simulate
from jaximpact.calibration import read_study, run_study
from jaximpact.calibration.diagnostics.identifiability import combination, judge_all
from jaximpact.calibration.diagnostics.jumps import in_words as jumps_in_words
from jaximpact.calibration.diagnostics.jumps import judge, shares_of, without_jumps
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.estimation.branches import (
    descend_on_branches,
    jump_shares,
    jumped,
)
from jaximpact.calibration.estimation.least_squares import (
    FINE,
    Fits,
    Reason,
    bounded_step,
    levenberg_marquardt,
)
from jaximpact.calibration.estimation.starts import (
    fit,
    fit_starts,
    label_minima,
    polish,
    spread_starts,
)
from jaximpact.calibration.problem.bounds import Bounds
from jaximpact.calibration.problem.objective import Objective, Points, start_of
from jaximpact.calibration.study import judge_lowest
from jaximpact.cli import main

pytestmark = pytest.mark.slow

TRUE = {"c_v": 2.0, "gamma_v": 5.0, "k_E": 1500.0}
TESTS = ((100.0, 6.0), (500.0, 15.0), (50.0, 25.0), (2000.0, 10.0))
TARGETS = ("e_n", "max_penetration_m", "max_normal_force_N")
STUDY = """\
data = "tests.csv"
starts = 16
seed = 1
[parameters]
c_v = { start = 1.0, lower = 0.1, upper = 20.0 }
gamma_v = { start = 10.0, lower = 0.5, upper = 100.0 }
k_E = { start = 900.0, lower = 50.0, upper = 20000.0 }
alpha_s = { start = 0.9, lower = 0.1, upper = 2.0 }
[default_sigma]
e_n = 0.01
max_penetration_m = 0.005
max_normal_force_N = 5000.0
"""


def write_study(folder, text=STUDY, measured=None):
    """A study in a folder, its targets the ones given, else ones."""
    measured = np.ones((len(TESTS), len(TARGETS))) if measured is None else measured
    columns = "mass_kg", "speed_mps", *TARGETS
    return write_study_of(folder, text, columns, np.hstack([TESTS, measured]))


def true_point(objective):
    return objective.bounds.coordinate([*TRUE.values(), 1.0])


@pytest.fixture(scope="module")
def predicted(tmp_path_factory):
    """What the model gives for the true soil: noise-free targets."""
    objective = objective_of(write_study(tmp_path_factory.mktemp("true")))
    return objective(true_point(objective)[None]).predicted[0]


@pytest.fixture(scope="module")
def twin(tmp_path_factory, predicted):
    """The study of noise-free targets, and where it wrote."""
    folder = tmp_path_factory.mktemp("twin")
    path = write_study(folder, measured=predicted)
    return run_study(path, folder / "out"), folder / "out"


def some_bounds():
    return Bounds(
        np.array([0.01, -1.0]), np.array([50.0, 3.0]), np.array([True, False])
    )


@pytest.mark.parametrize("p", [(0.01, -1.0), (1.0, 0.0), (50.0, 3.0)])
def test_coordinates_round_trip(p):
    bounds = some_bounds()
    x = bounds.coordinate(p)
    np.testing.assert_allclose(bounds.parameter(x), p, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(bounds.at_fraction(bounds.fraction(x)), x, atol=1e-12)


def test_slope_of_the_coordinates():
    bounds, x, step = some_bounds(), np.array([0.7, -0.3]), 1e-6
    change = bounds.parameter(x + step) - bounds.parameter(x - step)
    # Differences of second order, with rounding.
    np.testing.assert_allclose(bounds.slope(x), change / (2.0 * step), rtol=1e-9)


def test_bounds_are_noticed():
    bounds = some_bounds()
    reached = [
        bounds.bound_reached(bounds.coordinate(p)) for p in ([0.0101, 0.0], [1.0, 2.99])
    ]
    assert reached == [["lower", None], [None, "upper"]]


def test_starts_are_spread_and_repeat():
    bounds, nothing = some_bounds(), np.zeros(2)
    given = bounds.coordinate([1.0, 0.5])
    free = np.full(2, np.inf)
    starts = spread_starts(bounds, given, nothing, free, 9, seed=3)
    again = spread_starts(bounds, given, nothing, free, 9, seed=3)
    np.testing.assert_array_equal(starts, again)
    other = spread_starts(bounds, given, nothing, free, 9, seed=4)
    assert not np.array_equal(starts, other)
    np.testing.assert_array_equal(starts[0], given)
    strata = np.floor((bounds.fraction(starts[1:]) - 0.02) / 0.96 * 8).astype(int)
    for column in strata.T:  # each stratum once
        np.testing.assert_array_equal(np.sort(column), np.arange(8))
    assert spread_starts(bounds, given, nothing, free, 1, seed=0).shape == (1, 2)


def test_starts_follow_a_prior():
    bounds, given = some_bounds(), np.zeros(2)
    sd = np.array([np.inf, 0.1])
    starts = spread_starts(bounds, given, np.array([0.0, 1.0]), sd, 200, seed=0)
    values = bounds.parameter(starts[1:])[:, 1]
    # A sample of 199, in strata: its moments are far closer than those of chance.
    assert np.mean(values) == pytest.approx(1.0, abs=0.005)
    assert np.std(values) == pytest.approx(0.1, abs=0.005)


class Valley:
    """Rosenbrock's valley, with its minimum at (1, 1), as an objective."""

    bounds = Bounds(np.array([-5.0, -5.0]), np.array([5.0, 5.0]), np.zeros(2, bool))

    def __call__(self, x, free=None):
        a, b = self.bounds.parameter(x).T
        residuals = np.stack([10.0 * (b - a**2), 1.0 - a], axis=1)
        rows = np.zeros((len(x), 2, 2))
        rows[:, 0, 0], rows[:, 0, 1], rows[:, 1, 0] = -20.0 * a, 10.0, -1.0
        return self.points(x, residuals, rows, np.zeros((len(x), 1)))

    def points(self, x, residuals, rows, outcomes, more=0.0):
        rows = rows * self.bounds.half
        return Points(
            x,
            0.5 * np.sum(residuals**2, axis=1) + more,
            np.einsum("lrp,lr->lp", rows, residuals),
            np.einsum("lrp,lrq->lpq", rows, rows),
            residuals[:, :, None],
            outcomes,
            rows[:, :, None, :],
        )

    def values(self, x):
        return self(x)

    def failed(self, predicted):
        return ~np.isfinite(predicted)

    def variance(self, cost):
        return np.abs(cost)


class Cliff(Valley):
    """A slope down to a cliff at a = 0, and no minimum before it."""

    def __call__(self, x, free=None):
        a = self.bounds.parameter(x)[:, 0]
        beyond = (a < 0.0).astype(float)
        residuals = np.stack([1.0 + a, 0.0 * a], axis=1)
        rows = np.zeros((len(x), 2, 2))
        rows[:, 0, 0] = 1.0
        return self.points(x, residuals, rows, beyond[:, None], 100.0 * beyond)


def test_rosenbrock_from_everywhere():
    """The known minimum (1, 1), from 25 points."""
    grid = np.linspace(-4.0, 4.0, 5)
    x = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2) / 5.0
    fits = levenberg_marquardt(Valley(), x, None, FINE)
    assert set(fits.reasons) == {Reason.converged}
    found = Valley.bounds.parameter(fits.points.x)
    # A promise of 1e-10 leaves 1e-5 in the flattest direction, of curvature 0.2.
    np.testing.assert_allclose(found, 1.0, atol=1e-4)


def test_a_held_unknown_stays():
    x = np.array([[0.1, 0.5]])
    fits = levenberg_marquardt(Valley(), x, np.array([[True, False]]), FINE)
    assert fits.points.x[0, 1] == 0.5
    # b = 2.5: the minimum of 100 (b - a^2)^2 + (1 - a)^2 over a.
    a = Valley.bounds.parameter(fits.points.x)[0, 0]
    assert -400.0 * a * (2.5 - a**2) - 2.0 * (1.0 - a) == pytest.approx(0.0, abs=1e-2)


def test_a_start_at_a_cliff_is_stuck():
    """The cost falls towards a cliff, and there is no minimum before it."""
    fits = levenberg_marquardt(Cliff(), np.array([[0.3, 0.0]]), None, FINE)
    assert fits.reasons == [Reason.jump]
    assert not fits.reasons[0].at_minimum
    assert 0.0 <= fits.points.x[0, 0] < 1e-2


def test_a_step_keeps_to_the_bounds_and_goes_down():
    """Against all corners and edges of a correlated quadratic, by brute force."""
    random = np.random.default_rng(0)
    root = random.normal(size=(40, 3, 3))
    hessian = np.einsum("lpq,lrq->lpr", root, root) + 1e-3 * np.eye(3)
    gradient = random.normal(size=(40, 3))
    down, up = -random.random((40, 3)), random.random((40, 3))
    nothing = np.zeros((40, 0))
    points = Points(nothing, nothing, gradient, hessian, nothing, nothing, nothing)
    step, promise = bounded_step(points, np.ones((40, 3), bool), down, up, np.zeros(40))
    assert np.all((step >= down) & (step <= up))
    parts = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, 21)] * 3), -1).reshape(-1, 3)
    for lane in range(40):
        grid = down[lane] + parts * (up[lane] - down[lane])
        model = grid @ gradient[lane] + 0.5 * np.einsum(
            "gp,pq,gq->g", grid, hessian[lane], grid
        )
        assert promise[lane] >= -np.min(model) - 1e-3


def linear_study(tmp_path, rows, sigma=None):
    """A study whose Jacobian is put in by hand."""
    lines = ["mass_kg,e_n"] + ["1.0,0.0"] * rows
    (tmp_path / "tests.csv").write_text("\n".join(lines) + "\n")
    text = """data = "tests.csv"
[parameters]
c_v = { start = 1.0, lower = 0.1, upper = 10.0 }
gamma_v = { start = 1.0, lower = 0.1, upper = 10.0 }
"""
    if sigma is not None:
        text += f"[default_sigma]\ne_n = {sigma}\n"
    (tmp_path / "study.toml").write_text(text)
    return read_study(tmp_path / "study.toml")


def by_hand(study, jacobian, predicted):
    """An objective and a point of it, without an engine."""
    objective = Objective(study, study.variants[0], None)
    x = np.zeros((1, 2))
    return objective, objective.evaluate(
        x,
        predicted[None, :, None],
        np.zeros((1, len(predicted))),
        jacobian[None, :, None],
    )


def test_uncertainty_of_a_linear_fit(tmp_path):
    """Against the textbook: y = a + b x with a known sigma."""
    place = np.linspace(0.0, 1.0, 11)
    jacobian = np.stack([np.ones(11), place], axis=1)
    objective, point = by_hand(
        linear_study(tmp_path, 11, 0.5), jacobian, 0.1 * np.ones(11)
    )
    found = estimate(objective, point)
    covariance = 0.5**2 * np.linalg.inv(jacobian.T @ jacobian)
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-9)
    assert found.degrees_of_freedom == pytest.approx(9.0)
    assert found.inflation == 1.0


def test_sigmas_that_are_too_small_are_not_believed(tmp_path):
    place = np.linspace(0.0, 1.0, 11)
    jacobian = np.stack([np.ones(11), place], axis=1)
    predicted = np.where(np.arange(11) % 2, 1.0, -1.0)
    objective, point = by_hand(linear_study(tmp_path, 11, 0.1), jacobian, predicted)
    found = estimate(objective, point)
    assert found.inflation == pytest.approx(11 * 100.0 / 9.0)


def test_scatter_that_differs_from_test_to_test(tmp_path):
    """Against the textbook's sandwich (White's, with leverages), for an estimated
    sigma."""
    place = np.linspace(0.0, 1.0, 60)
    jacobian = np.stack([np.ones(60), place], axis=1)
    noise = place * np.random.default_rng(0).normal(size=60)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    noise -= jacobian @ inverse @ jacobian.T @ noise
    # Targets of 0 have a nominal sigma of 0.05.
    sigma = np.sqrt(np.sum(noise**2) / 58.0)
    objective, point = by_hand(
        linear_study(tmp_path, 60), jacobian * sigma / 0.05, noise
    )
    objective = objective.with_sigma(np.full((60, 1), sigma))
    found = estimate(objective, objective.reevaluate(point))
    leverage = np.einsum("rp,pq,rq->r", jacobian, inverse, jacobian)
    middle = (jacobian.T * (noise / sigma) ** 2 / (1.0 - leverage)) @ jacobian
    expected = 0.05**2 * inverse @ middle @ inverse
    scale = max(1.0, 1.0 / np.mean((noise / sigma) ** 2 / (1.0 - leverage)))
    np.testing.assert_allclose(found.covariance, scale * expected, rtol=1e-9)


def test_a_parameter_without_influence_leaves_the_others_their_errors(tmp_path):
    jacobian = np.stack([np.ones(11), np.zeros(11)], axis=1)
    objective, point = by_hand(
        linear_study(tmp_path, 11, 0.5), jacobian, 0.1 * np.ones(11)
    )
    found = estimate(objective, point)
    assert found.standard_errors[1] > 1e6
    assert found.standard_errors[0] == pytest.approx(0.5 / np.sqrt(11.0))


def test_failed_predictions_say_nothing(tmp_path):
    jacobian = np.stack([np.ones(11), np.linspace(0.0, 1.0, 11)], axis=1)
    predicted = np.full(11, 0.1)
    predicted[5:] = np.nan
    objective, point = by_hand(linear_study(tmp_path, 11, 0.5), jacobian, predicted)
    found = estimate(objective, point)
    covariance = 0.5**2 * np.linalg.inv(jacobian[:5].T @ jacobian[:5])
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-9)
    assert point.cost[0] > 1e6


def test_a_combination_in_words():
    bounds = Bounds(np.ones(3), 2.0 * np.ones(3), np.array([True] * 3))
    vector = np.array([0.8, -0.4, 0.01])
    assert combination(("c_v", "gamma_v", "k_E"), bounds, vector) == "c_v gamma_v^-0.50"


def test_predictions_are_those_of_the_model(predicted):
    soil = Soil(**TRUE, alpha_s=1.0)
    mass, speed = TESTS[1]
    block, impact = Block(mass=mass), Impact(speed=speed)
    result = simulate(block, soil, impact, accuracy="reference")
    expected = (result.e_n, result.max_penetration, result.max_normal_force)
    # Machine code keeps what is zero by symmetry as an unknown here, and not there.
    np.testing.assert_allclose(predicted[1], expected, rtol=1e-6)


def test_jacobian_equals_central_differences(tmp_path):
    """Far below the tolerance of any preset, so that differences are not its noise."""
    exact = Accuracy("exact", 1e-11, PRESETS["reference"].floor)
    objective = objective_of(write_study(tmp_path), exact)
    x = true_point(objective)
    width = 1e-3
    steps = width * np.eye(len(x))
    around = objective(np.concatenate([x[None], x + steps, x - steps]))
    plus, minus = np.split(around.predicted[1:], 2)
    differences = np.moveaxis((plus - minus) / (2.0 * width), 0, -1)
    largest = np.max(np.abs(differences), axis=(0, 2), keepdims=True)
    np.testing.assert_allclose(
        around.jacobian[0] / largest, differences / largest, rtol=0.0, atol=1e-5
    )


def test_gradient_and_cost_agree(tmp_path):
    """The objective's gradient, with robust loss and prior, against differences."""
    text = STUDY.replace("seed = 1", 'seed = 1\nloss = "student"')
    text = text.replace("upper = 20.0", "upper = 20.0, prior = {mean = 1.0, sd = 0.5}")
    exact = Accuracy("exact", 1e-11, PRESETS["reference"].floor)
    measured = np.tile([0.2, 0.3, 1e5], (len(TESTS), 1))
    path = write_study(tmp_path, text, measured)
    objective = objective_of(path, exact)
    x = true_point(objective)
    steps = 1e-3 * np.eye(len(x))
    points = objective(np.concatenate([x[None], x + steps, x - steps]))
    plus, minus = np.split(points.cost[1:], 2)
    largest = np.max(np.abs(points.gradient[0]))
    np.testing.assert_allclose(
        points.gradient[0], (plus - minus) / 2e-3, rtol=0.0, atol=1e-5 * largest
    )


def test_twin_is_recovered(twin):
    """From every start, to the accuracy of the impacts."""
    result, _ = twin
    variant = result.variants[0]
    reached = variant.reached
    assert np.sum(reached) >= 12
    for place, value in enumerate(TRUE.values()):
        np.testing.assert_allclose(
            variant.end_parameters[reached, place], value, rtol=1e-4
        )
        assert variant.parameters[place] == pytest.approx(value, rel=1e-4)
    assert variant.failed == 0
    assert len(variant.start_costs) == 16
    assert result.engine == "machine code"


def test_verdicts_of_the_twin(twin):
    """Friction under the block has no influence where nothing slides."""
    result, _ = twin
    variant = result.variants[0]
    determined = {v.name: v.determined for v in variant.verdicts}
    assert determined == {"c_v": True, "gamma_v": True, "k_E": True, "alpha_s": False}
    assert "no influence" in variant.verdicts[3].reason
    held = variant.profiles["alpha_s"]
    # Each point is a fit of its own, which may stop early: nothing beside 1.92, where a
    # 95 % interval ends.
    assert np.max(held.rise) < 0.2
    assert np.median(held.rise) < 1e-3
    assert held.low is None
    assert held.high is None
    ends = variant.bounds.lower[3], variant.bounds.upper[3]
    np.testing.assert_allclose(held.values[[0, -1]], ends)
    # Near the minimum a profile is the parabola of the standard error.
    profile = variant.profiles["c_v"]
    error = variant.uncertainty.standard_errors[0]
    apart = np.abs(np.log(profile.values / variant.parameters[0])) / error
    # Its 95 % interval ends within three standard errors; the rest is rounding.
    assert np.max(apart) < 3.001
    near = (apart > 0.5) & (apart < 2.5)
    assert np.any(near)
    np.testing.assert_allclose(np.sqrt(profile.rise[near]), apart[near], rtol=0.2)


def test_files_of_the_twin(twin):
    result, out = twin
    assert sorted(p.name for p in out.iterdir()) == [
        *("fit.json", "fitted.csv", "jaximpact-study.json", "report.html")
    ]
    report = (out / "report.html").read_text()
    assert "alpha_s is not identifiable" in report
    assert "of 16 starts found the best fit" in report
    content = json.loads((out / "fit.json").read_text())
    alpha_s = content["variants"][0]["parameters"]["alpha_s"]
    assert alpha_s["standard_error"] is None
    assert alpha_s["interval_95"] is None
    (table,) = result.study.tests.files
    assert content["manifest"]["data"] == [
        {"file": "tests.csv", "sha256": table.sha256}
    ]
    assert content["manifest"]["seed"] == 1
    rows = (out / "fitted.csv").read_text().splitlines()
    assert len(rows) == 1 + len(TESTS) * len(TARGETS)


def test_the_same_study_gives_the_same_numbers(tmp_path, predicted):
    noisy = predicted * (1.0 + 0.02 * np.random.default_rng(0).normal(size=(4, 3)))
    objective = objective_of(write_study(tmp_path, measured=noisy))
    x = spread_starts(
        objective.bounds,
        start_of(objective.study),
        objective.prior_mean,
        objective.prior_sd,
        6,
        seed=0,
    )
    once, again = fit(objective, x), fit(objective, x)
    np.testing.assert_array_equal(once.points.x, again.points.x)
    assert once.reasons == again.reasons


def test_fits_above_the_best_say_so(tmp_path):
    objective = objective_of(write_study(tmp_path))
    points = objective(np.stack([true_point(objective), start_of(objective.study)]))
    best = float(np.min(points.cost))
    worse = int(np.argmax(points.cost))
    fits = Fits(points, [Reason.converged, Reason.converged], np.zeros(2, int))
    reasons = label_minima(objective, fits, best)
    assert reasons[worse] is Reason.above
    assert reasons[1 - worse] is Reason.converged


@pytest.mark.parametrize("agreed", [False, True])
def test_starts_left_behind_search_together(tmp_path, monkeypatch, agreed):
    """Those near the best stay; of the others those whose members came to the place of
    the best one are at the fit from there, or all if most members did."""
    study = linear_study(tmp_path, 3, sigma=0.1)
    objective = Linear(study, study.variants[0], None)
    objective.matrix = np.eye(3)[:, :2]
    stuck, ended = Reason.stuck, Reason.converged
    # Of the starts 0 is the best, 4 within a tenth of sigma from it.
    rounds = [
        (
            [[0.2, 0.0], [0.5, 0.0], [0.9, 0.0], [0.6, 0.0], [0.21, 0.0]],
            [ended, stuck, Reason.jump, ended, stuck],
        ),
        ([[0.1, 0.0], [0.05, 0.0]], [stuck, ended]),
    ]
    begun = []

    def made(objective, x, **how):
        ends, reasons = rounds[len(begun)]
        begun.append(x)
        return Fits(objective(np.array(ends)), reasons, np.full(len(ends), 5))

    def evolved(objective, x, candidates):
        np.testing.assert_array_equal(x, rounds[0][0])
        within = (candidates >= objective.bounds.low) & (
            candidates <= objective.bounds.high
        )
        assert np.all(within)
        assert len(candidates) > 100
        # The second member is elsewhere, and so does not find the best one.
        others = [0.32, 0.33] if agreed else [0.7, 0.8]
        return np.array([[a, 0.0] for a in (0.3, 0.71, 0.31, *others)])

    starts = "jaximpact.calibration.estimation.starts"
    monkeypatch.setattr(f"{starts}.fit", made)
    monkeypatch.setattr(f"{starts}.evolve", evolved)
    monkeypatch.setattr(f"{starts}.polish", lambda objective, fits: fits)
    monkeypatch.setattr(Objective, "rough", lambda objective: objective)
    fits = fit_starts(objective, np.zeros((5, 2)), "levenberg-marquardt")
    np.testing.assert_array_equal(begun[1][:2], [[0.3, 0.0], [0.31, 0.0]])
    third = 0.05 if agreed else 0.9
    np.testing.assert_array_equal(fits.points.x[:, 0], [0.2, 0.05, third, 0.05, 0.21])
    of_third = Reason.searched if agreed else Reason.jump
    assert fits.reasons == [ended, ended, of_third, Reason.searched, stuck]
    np.testing.assert_array_equal(fits.restarts, [0, 1, int(agreed), 1, 0])
    np.testing.assert_array_equal(fits.steps, [5, 10, 5 + 5 * agreed, 10, 5])


class Jumping(Linear):
    """Linear but for the first test, whose prediction jumps where x_0 + x_1 > 1."""

    def _predict(self, x, derivatives):
        predicted, outcomes, jacobian = super()._predict(x, derivatives)
        predicted[:, 0, 0] += np.where(np.sum(x, axis=1) > 1.0, 100.0, 0.0)
        return predicted, outcomes, jacobian


def jumping(tmp_path):
    study = linear_study(tmp_path, 3, sigma=0.1)
    objective = Jumping(study, study.variants[0], None)
    objective.matrix = np.array([[0.1, 0.1], [1.0, 0.0], [0.0, 1.0]])
    measured = np.array([[0.1], [0.9], [0.4]])
    study = dataclasses.replace(study, measured=measured)
    return objective._changed(study=study)


def test_the_best_fit_along_a_jump_is_found(tmp_path):
    """By hand: beside the line x_0 + x_1 = 1, (0.75, 0.25) is nearest to (0.9, 0.4)."""
    objective = jumping(tmp_path)
    begin = levenberg_marquardt(objective, np.array([[0.2, 0.2]]), None, FINE)
    assert not begin.reasons[0].at_minimum
    found = descend_on_branches(objective, begin)
    assert found.reasons == [Reason.edge]
    assert np.sum(found.points.x) <= 1.0
    best = 0.5 * (2.0 * 0.15**2 / 0.1**2)
    # Sampled steps end within some hundredths of the unit of costs, 1.
    assert best <= found.points.cost[0] <= best + 0.05


class JumpingDown(Linear):
    """Linear but for the first test, whose prediction jumps down where x_0 + x_1 >
    `jump`: the further beyond, the better it becomes."""

    jump = 1.0

    def _predict(self, x, derivatives):
        predicted, outcomes, jacobian = super()._predict(x, derivatives)
        beyond = np.sum(x, axis=1) > self.jump
        predicted[:, 0, 0] -= np.where(beyond, 100.0, 0.0)
        return predicted, outcomes, jacobian

    def no_finer_than_sigmas(self):
        coarse = self._changed()
        coarse.jump = 1.01
        return coarse


def test_a_fit_beside_a_jump_that_accuracy_moves_stays_beside_it(tmp_path):
    """At the higher accuracy the end at the lower one is beyond the jump, where the
    first test is 1000 sigmas from its measurement."""
    of_study = jumping(tmp_path)
    objective = JumpingDown(of_study.study, of_study.study.variants[0], None)
    objective.matrix = of_study.matrix
    x = np.array([[0.2, 0.2]])
    begin = Fits(objective(x), [Reason.stuck], np.zeros(1, int))
    found = polish(objective, begin)
    assert found.reasons == [Reason.edge]
    best = 0.5 * (2.0 * 0.15**2 / 0.1**2)
    assert best <= found.points.cost[0] <= best + 0.05


def fitted(objective, share, of_draws=False):
    """What `in_words` uses of a result."""
    return SimpleNamespace(objective=objective, jumps=share, errors_of_draws=of_draws)


def test_a_test_near_a_jump_is_left_out_of_the_errors(tmp_path):
    objective = jumping(tmp_path)
    fits = Fits(objective(np.array([[0.75, 0.25]])), [Reason.edge], np.zeros(1, int))
    share = shares_of(objective, fits)
    # The line passes through the point: half of the draws are beyond.
    assert 0.3 < share[0, 0] < 0.7
    np.testing.assert_array_equal(share[1:], 0.0)
    words = jumps_in_words(fitted(objective, share), None)
    assert len(words) == 1
    assert "row 2" in words[0]
    # Two measurements of two unknowns would be left: all are used, and it is said.
    assert without_jumps(objective, share) is objective
    assert "Too few measurements" in words[0]
    assert "inaccurate" in words[0]
    (words,) = jumps_in_words(fitted(objective, share, of_draws=True), None)
    assert "draws of the posterior" in words
    assert jumps_in_words(fitted(objective, 0.0 * share), None) == []


class JumpingInOne(Jumping):
    """Two targets, of which the second is the first without its jump."""

    def _predict(self, x, derivatives):
        smooth, outcomes, jacobian = Linear._predict(self, x, derivatives)
        jumping, _, _ = super()._predict(x, derivatives)
        predicted = np.concatenate([jumping, smooth], axis=2)
        return predicted, outcomes, np.repeat(jacobian, 2, axis=2)


def jumping_in_one(tmp_path):
    objective = jumping(tmp_path)
    study = objective.study
    twice = {
        name: np.repeat(getattr(study, name), 2, axis=-1)
        for name in ("measured", "censored", "sigma_given", "proportional", "weights")
    }
    study = dataclasses.replace(study, targets=("e_n", "e_t"), **twice)
    two = JumpingInOne(study, study.variants[0], None)
    two.matrix = objective.matrix
    return two._changed(sigma=np.full((3, 2), 0.1))


def test_results_of_a_test_that_do_not_jump_stay(tmp_path):
    """Five measurements are left of six: errors are those of a linear fit to them."""
    two = jumping_in_one(tmp_path)
    fits = Fits(two(np.array([[0.75, 0.25]])), [Reason.edge], np.zeros(1, int))
    share = shares_of(two, fits)
    np.testing.assert_array_equal(share > 0.0, [[True, False]] + 2 * [[False, False]])
    (words,) = jumps_in_words(fitted(two, share), None)
    assert "row 2 (e_n: " in words
    assert "Standard errors and profiles leave" in words
    (words,) = jumps_in_words(fitted(two, share, of_draws=True), None)
    assert "draws of the posterior; profiles leave" in words
    smooth = without_jumps(two, share)
    found = estimate(smooth, smooth.reevaluate(fits.points))
    rows = np.concatenate([two.matrix, two.matrix[1:]]) / 0.1
    expected = np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))
    np.testing.assert_allclose(found.standard_errors, expected, rtol=1e-12)


def test_errors_beside_a_jump_are_those_of_the_posterior(tmp_path):
    """Against the integral over a grid: half of the plane is beyond the jump, at no
    weight. Without the jump the errors would be a third larger."""
    objective = jumping_in_one(tmp_path)
    best = Fits(objective(np.array([[0.75, 0.25]])), [Reason.edge], np.zeros(1, int))
    judged = judge(objective, best)
    assert judged.of_draws
    axis = np.linspace(-0.5, 2.0, 201)
    x = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    cost = objective.values(x).cost
    weights = np.exp(np.min(cost) - cost)
    apart = x - best.points.x
    expected = (apart.T * (weights / np.sum(weights))) @ apart
    errors = np.sqrt(np.diag(expected))
    stuck = best._replace(reasons=[Reason.stuck])
    for of_draws in (False, True):
        judgement = objective, stuck, judged.uncertainty, {}, stuck
        verdicts = judge_all(*judgement, of_draws=of_draws)
        assert all(verdict.determined == of_draws for verdict in verdicts)
    smooth = judged.smooth.reevaluate(best.points)
    without = estimate(judged.smooth, smooth).standard_errors
    assert np.all(without > 1.15 * errors)
    # Four standard errors of a standard deviation of so many draws.
    near = 4.0 / np.sqrt(2.0 * judged.draws.effective)
    found = judged.uncertainty
    np.testing.assert_allclose(found.standard_errors, errors, rtol=near)
    correlation = expected[0, 1] / np.prod(errors)
    assert found.correlation[0, 1] == pytest.approx(correlation, abs=2.0 * near)
    np.testing.assert_allclose(
        found.eigenvectors @ np.diag(found.eigenvalues) @ found.eigenvectors.T,
        np.linalg.inv(found.covariance),
        rtol=1e-9,
    )


def test_draws_do_not_hide_what_is_not_determined(tmp_path):
    """Between the bounds draws have a finite spread, whatever the sigmas."""
    objective = jumping_in_one(tmp_path)
    objective = objective.with_sigma(np.full((3, 2), 20.0))
    best = Fits(objective(np.array([[0.75, 0.25]])), [Reason.edge], np.zeros(1, int))
    judged = judge(objective, best)
    assert not judged.of_draws
    assert np.all(judged.uncertainty.standard_errors > 1.0)


def test_a_fit_goes_on_from_a_lower_draw(tmp_path):
    """From beside the jump, but not at the lowest point there."""
    objective = jumping_in_one(tmp_path)
    begin = Fits(objective(np.array([[0.55, 0.4]])), [Reason.edge], np.zeros(1, int))
    _, found, judged = judge_lowest(objective, begin)
    lowest = objective.values(np.array([[0.75, 0.25]])).cost[0]
    assert begin.points.cost[0] > lowest + 1.0
    assert found.points.cost[0] < lowest + 0.05
    assert np.min(judged.draws.cost) > lowest - 1e-9


class Bending(Linear):
    """Linear but for the first test, whose prediction bends."""

    def _predict(self, x, derivatives):
        predicted, outcomes, jacobian = super()._predict(x, derivatives)
        predicted[:, 0, 0] += 100.0 * np.sum((x - 0.5) ** 2, axis=1)
        return predicted, outcomes, jacobian


def test_a_prediction_that_bends_does_not_jump(tmp_path):
    """Derivatives are the same, and the draws lie as far from the linear prediction."""
    straight = jumping(tmp_path)
    objective = Bending(straight.study, straight.study.variants[0], None)
    objective.matrix = straight.matrix
    fit = objective(np.array([[0.5, 0.5]]))
    draws = objective.values(fit.x + 0.3 * np.eye(2))
    assert np.all(jumped(objective, fit, draws)[:, 0])
    np.testing.assert_array_equal(jump_shares(objective, fit), 0.0)


def test_beside_sigmas_that_are_far_too_small_not_all_is_a_jump(tmp_path):
    """The misfit is 0.1, and sigma a ten-thousandth of it."""
    straight = jumping(tmp_path)
    x = np.array([[0.5, 0.5]])
    exact = straight.values(x).predicted[0]
    study = dataclasses.replace(
        straight.study, measured=exact + 0.1 * np.array([[1.0], [-1.0], [1.0]])
    )
    objective = Bending(study, study.variants[0], None)
    objective.matrix = straight.matrix
    objective = objective.with_sigma(np.full((3, 1), 1e-5))
    fits = Fits(objective(x), [Reason.flat], np.zeros(1, int))
    np.testing.assert_array_equal(shares_of(objective, fits), 0.0)


@pytest.mark.parametrize("method", ["adam", "l-bfgs"])
def test_first_order_methods_lower_the_cost(tmp_path, predicted, monkeypatch, method):
    objective = objective_of(write_study(tmp_path, measured=predicted))
    monkeypatch.setattr("jaximpact.calibration.estimation.first_order.STEPS", 25)
    x = true_point(objective) + 0.3 * np.eye(4)[:3]
    before = objective(x).cost
    after = fit(objective, x, method=method)
    assert np.all(after.points.cost < 0.2 * before)
    assert set(after.reasons) <= {Reason.step_limit, Reason.converged, Reason.stuck}


BAD = {
    "unknown key": ("starts = 16", "strats = 4", ("key strats", "starts")),
    "unknown parameter": ("k_E = {", "kE = {", ("parameters.kE", "k_E")),
    "block parameter": ("k_E = {", "mass_kg = {", ("parameters.mass_kg",)),
    "unknown bound": ("lower = 50.0", "low = 50.0", ("parameters.k_E.low", "lower")),
    "start outside": ("start = 900.0", "start = 9.0", ("parameters.k_E.start", "50")),
    "no bounds": (", lower = 0.1, upper = 2.0", "", ("parameters.alpha_s.lower",)),
    "negative bound": ("lower = 0.1,", "lower = -0.1,", ("parameters.c_v.lower",)),
    "wrong type": ("starts = 16", "starts = 4.5", ("key starts", "whole number")),
    "missing data": ("tests.csv", "nowhere.csv", ("nowhere.csv", "cannot be read")),
    "unknown target": ("seed = 1", 'targets = ["en"]', ("key targets", "e_n")),
    "absent target": ("seed = 1", 'targets = ["e_bar"]', ("targets", "no column")),
    "no target": ("seed = 1", "targets = []", ("key targets",)),
    "method": ("seed = 1", 'method = "adm"', ("key method", "adam")),
    "accuracy": ("seed = 1", 'accuracy = "fats"', ("key accuracy", "fast")),
    "loss": ("seed = 1", 'loss = "studnet"', ("key loss", "student")),
    "weight": (
        "[default_sigma]",
        "[weights]\ne_n = -1\n[default_sigma]",
        ("weights.e_n", "above 0"),
    ),
    "prior": (
        "start = 1.0,",
        "start = 1.0, prior = { mean = 1.0, sd = 0.0 },",
        ("parameters.c_v.prior.sd", "above 0"),
    ),
    "prior without mean": (
        "start = 1.0,",
        "start = 1.0, prior = { sd = 1.0 },",
        ("parameters.c_v.prior.mean", "missing"),
    ),
    "data twice": (
        '"tests.csv"',
        '["tests.csv", "tests.csv"]',
        ("key data", "twice"),
    ),
    "sigma": ("e_n = 0.01", "e_n = 0.0", ("default_sigma.e_n", "above 0")),
    "fixed soil": ("[default_sigma]", "[soil]\nk_F = 1.0\n[default_sigma]", ("k_E",)),
    "twice": ("[default_sigma]", "[soil]\nk_E = 1.0\n[default_sigma]", ("is fitted",)),
    "variant": (
        "[default_sigma]",
        "[[variants]]\nx = 1\n[default_sigma]",
        ("variants",),
    ),
    "not TOML": ("starts = 16", "starts =", ("not valid TOML",)),
}


@pytest.mark.parametrize(("old", "new", "parts"), BAD.values(), ids=BAD)
def test_bad_study_is_one_line(tmp_path, capsys, old, new, parts):
    assert old in STUDY
    path = write_study(tmp_path, STUDY.replace(old, new, 1))
    out = tmp_path / "out"
    assert main(["calibrate", str(path), "--out", str(out)]) == 2
    assert_one_line_error(capsys, str(tmp_path), *parts)
    assert not out.exists()


def test_bad_target_names_row_and_column(tmp_path, capsys):
    path = write_study(tmp_path)
    table = tmp_path / "tests.csv"
    lines = table.read_text().splitlines()
    lines[2] = "500.0,15.0,inf,1.0,1.0"
    table.write_text("\n".join(lines))
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "tests.csv", "row 3", "column e_n", "finite")


def test_no_measured_result(tmp_path, capsys):
    path = write_study(tmp_path)
    (tmp_path / "tests.csv").write_text("mass_kg\n1.0\n")
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "tests.csv", "no measured result")


def test_tangential_restitution_at_vertical_incidence_is_refused(tmp_path, capsys):
    path = write_study(tmp_path)
    (tmp_path / "tests.csv").write_text("mass_kg,e_t\n1.0,0.5\n")
    text = STUDY[: STUDY.index("[default_sigma]")]
    path.write_text(text)
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "tests.csv", "e_t")

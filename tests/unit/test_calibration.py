"""Fits: coordinates, starts, steps, uncertainties, jumps."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from calibrated_twin import DROPS, TRUE, results_of_model, twin_study
from calibration_studies import Linear, objective_of, study_of_columns

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

pytestmark = pytest.mark.slow


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


def linear_study(rows, sigma=None):
    """A study whose Jacobian is put in by hand."""
    unknown = {"start": 1.0, "lower": 0.1, "upper": 10.0}
    content = {"parameters": {"c_v": unknown, "gamma_v": unknown}}
    if sigma is not None:
        content["default_sigma"] = {"e_n": sigma}
    return study_of_columns({"mass_kg": 1.0, "e_n": np.zeros(rows)}, **content)


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


def test_uncertainty_of_a_linear_fit():
    """Against the textbook: y = a + b x with a known sigma."""
    place = np.linspace(0.0, 1.0, 11)
    jacobian = np.stack([np.ones(11), place], axis=1)
    objective, point = by_hand(linear_study(11, 0.5), jacobian, 0.1 * np.ones(11))
    found = estimate(objective, point)
    covariance = 0.5**2 * np.linalg.inv(jacobian.T @ jacobian)
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-9)
    assert found.degrees_of_freedom == pytest.approx(9.0)
    assert found.inflation == 1.0


def test_sigmas_that_are_too_small_are_not_believed():
    place = np.linspace(0.0, 1.0, 11)
    jacobian = np.stack([np.ones(11), place], axis=1)
    predicted = np.where(np.arange(11) % 2, 1.0, -1.0)
    objective, point = by_hand(linear_study(11, 0.1), jacobian, predicted)
    found = estimate(objective, point)
    assert found.inflation == pytest.approx(11 * 100.0 / 9.0)


def test_scatter_that_differs_from_test_to_test():
    """Against the textbook's sandwich (White's, with leverages), for an estimated
    sigma."""
    place = np.linspace(0.0, 1.0, 60)
    jacobian = np.stack([np.ones(60), place], axis=1)
    noise = place * np.random.default_rng(0).normal(size=60)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    noise -= jacobian @ inverse @ jacobian.T @ noise
    # Targets of 0 have a nominal sigma of 0.05.
    sigma = np.sqrt(np.sum(noise**2) / 58.0)
    objective, point = by_hand(linear_study(60), jacobian * sigma / 0.05, noise)
    objective = objective.with_sigma(np.full((60, 1), sigma))
    found = estimate(objective, objective.reevaluate(point))
    leverage = np.einsum("rp,pq,rq->r", jacobian, inverse, jacobian)
    middle = (jacobian.T * (noise / sigma) ** 2 / (1.0 - leverage)) @ jacobian
    expected = 0.05**2 * inverse @ middle @ inverse
    scale = max(1.0, 1.0 / np.mean((noise / sigma) ** 2 / (1.0 - leverage)))
    np.testing.assert_allclose(found.covariance, scale * expected, rtol=1e-9)


def test_a_parameter_without_influence_leaves_the_others_their_errors():
    jacobian = np.stack([np.ones(11), np.zeros(11)], axis=1)
    objective, point = by_hand(linear_study(11, 0.5), jacobian, 0.1 * np.ones(11))
    found = estimate(objective, point)
    assert found.standard_errors[1] > 1e6
    assert found.standard_errors[0] == pytest.approx(0.5 / np.sqrt(11.0))


def test_failed_predictions_say_nothing():
    jacobian = np.stack([np.ones(11), np.linspace(0.0, 1.0, 11)], axis=1)
    predicted = np.full(11, 0.1)
    predicted[5:] = np.nan
    objective, point = by_hand(linear_study(11, 0.5), jacobian, predicted)
    found = estimate(objective, point)
    covariance = 0.5**2 * np.linalg.inv(jacobian[:5].T @ jacobian[:5])
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-9)
    assert point.cost[0] > 1e6


def test_a_combination_in_words():
    bounds = Bounds(np.ones(3), 2.0 * np.ones(3), np.array([True] * 3))
    vector = np.array([0.8, -0.4, 0.01])
    assert combination(("c_v", "gamma_v", "k_E"), bounds, vector) == "c_v gamma_v^-0.50"


def twin_objective(noise=0.0):
    random, results = np.random.default_rng(0), results_of_model(DROPS)
    noisy = {
        name: np.array(values) * (1.0 + noise * random.normal(size=len(values)))
        for name, values in results.items()
    }
    return objective_of(twin_study(noisy))


def true_point(objective):
    return objective.bounds.coordinate([*TRUE.values(), 1.0])


def test_the_same_study_gives_the_same_numbers():
    objective = twin_objective(noise=0.02)
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


def test_fits_above_the_best_say_so():
    objective = twin_objective()
    points = objective(np.stack([true_point(objective), start_of(objective.study)]))
    best = float(np.min(points.cost))
    worse = int(np.argmax(points.cost))
    fits = Fits(points, [Reason.converged, Reason.converged], np.zeros(2, int))
    reasons = label_minima(objective, fits, best)
    assert reasons[worse] is Reason.above
    assert reasons[1 - worse] is Reason.converged


@pytest.mark.parametrize("agreed", [False, True])
def test_starts_left_behind_search_together(monkeypatch, agreed):
    """Those near the best stay; of the others those whose members came to the place of
    the best one are at the fit from there, or all if most members did."""
    study = linear_study(3, sigma=0.1)
    objective = Linear(study, matrix=np.eye(3)[:, :2])
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


def jumping():
    study = linear_study(3, sigma=0.1)
    objective = Jumping(study, matrix=np.array([[0.1, 0.1], [1.0, 0.0], [0.0, 1.0]]))
    measured = np.array([[0.1], [0.9], [0.4]])
    study = dataclasses.replace(study, measured=measured)
    return objective._changed(study=study)


def test_the_best_fit_along_a_jump_is_found():
    """By hand: beside the line x_0 + x_1 = 1, (0.75, 0.25) is nearest to (0.9, 0.4)."""
    objective = jumping()
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


def test_a_fit_beside_a_jump_that_accuracy_moves_stays_beside_it():
    """At the higher accuracy the end at the lower one is beyond the jump, where the
    first test is 1000 sigmas from its measurement."""
    of_study = jumping()
    objective = JumpingDown(of_study.study, matrix=of_study.matrix)
    x = np.array([[0.2, 0.2]])
    begin = Fits(objective(x), [Reason.stuck], np.zeros(1, int))
    found = polish(objective, begin)
    assert found.reasons == [Reason.edge]
    best = 0.5 * (2.0 * 0.15**2 / 0.1**2)
    assert best <= found.points.cost[0] <= best + 0.05


def fitted(objective, share, of_draws=False):
    """What `in_words` uses of a result."""
    return SimpleNamespace(objective=objective, jumps=share, errors_of_draws=of_draws)


def test_a_test_near_a_jump_is_left_out_of_the_errors():
    objective = jumping()
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


def jumping_in_one():
    objective = jumping()
    study = objective.study
    twice = {
        name: np.repeat(getattr(study, name), 2, axis=-1)
        for name in ("measured", "censored", "sigma_given", "proportional", "weights")
    }
    study = dataclasses.replace(study, targets=("e_n", "e_t"), **twice)
    two = JumpingInOne(study, matrix=objective.matrix)
    return two._changed(sigma=np.full((3, 2), 0.1))


def test_results_of_a_test_that_do_not_jump_stay():
    """Five measurements are left of six: errors are those of a linear fit to them."""
    two = jumping_in_one()
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


def test_errors_beside_a_jump_are_those_of_the_posterior():
    """Against the integral over a grid: half of the plane is beyond the jump, at no
    weight. Without the jump the errors would be a third larger."""
    objective = jumping_in_one()
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


def test_draws_do_not_hide_what_is_not_determined():
    """Between the bounds draws have a finite spread, whatever the sigmas."""
    objective = jumping_in_one()
    objective = objective.with_sigma(np.full((3, 2), 20.0))
    best = Fits(objective(np.array([[0.75, 0.25]])), [Reason.edge], np.zeros(1, int))
    judged = judge(objective, best)
    assert not judged.of_draws
    assert np.all(judged.uncertainty.standard_errors > 1.0)


def test_a_fit_goes_on_from_a_lower_draw():
    """From beside the jump, but not at the lowest point there."""
    objective = jumping_in_one()
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


def test_a_prediction_that_bends_does_not_jump():
    """Derivatives are the same, and the draws lie as far from the linear prediction."""
    straight = jumping()
    objective = Bending(straight.study, matrix=straight.matrix)
    fit = objective(np.array([[0.5, 0.5]]))
    draws = objective.values(fit.x + 0.3 * np.eye(2))
    assert np.all(jumped(objective, fit, draws)[:, 0])
    np.testing.assert_array_equal(jump_shares(objective, fit), 0.0)


def test_beside_sigmas_that_are_far_too_small_not_all_is_a_jump():
    """The misfit is 0.1, and sigma a ten-thousandth of it."""
    straight = jumping()
    x = np.array([[0.5, 0.5]])
    exact = straight.values(x).predicted[0]
    study = dataclasses.replace(
        straight.study, measured=exact + 0.1 * np.array([[1.0], [-1.0], [1.0]])
    )
    objective = Bending(study, matrix=straight.matrix)
    objective = objective.with_sigma(np.full((3, 1), 1e-5))
    fits = Fits(objective(x), [Reason.flat], np.zeros(1, int))
    np.testing.assert_array_equal(shares_of(objective, fits), 0.0)


@pytest.mark.parametrize("method", ["adam", "l-bfgs"])
def test_first_order_methods_lower_the_cost(monkeypatch, method):
    objective = twin_objective()
    monkeypatch.setattr("jaximpact.calibration.estimation.first_order.STEPS", 25)
    x = true_point(objective) + 0.3 * np.eye(4)[:3]
    before = objective(x).cost
    after = fit(objective, x, method=method)
    assert np.all(after.points.cost < 0.2 * before)
    assert set(after.reasons) <= {Reason.step_limit, Reason.converged, Reason.stuck}

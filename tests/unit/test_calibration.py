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
from jaximpact.calibration.estimation.branches import has_left, jump_shares
from jaximpact.calibration.estimation.evolution import Population, search, spread
from jaximpact.calibration.estimation.least_squares import (
    Fits,
    Reason,
    bounded_step,
    fit,
)
from jaximpact.calibration.estimation.search import (
    fit_along,
    fit_by,
    fit_places,
    label_minima,
    refine,
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


def spreading(count, seed=0, prior=None):
    """Candidates of a study of c_v and k_E, and the bounds."""
    k_e = {"lower": 10.0, "upper": 1e4} | ({"prior": prior} if prior else {})
    content = {"parameters": {"c_v": {}, "k_E": k_e}, "seed": seed}
    study = study_of_columns({"mass_kg": 1.0, "e_n": np.zeros(3)}, **content)
    objective = Linear(study)
    return objective, spread(objective, count)


def test_candidates_are_spread_and_repeat():
    objective, candidates = spreading(9, seed=3)
    np.testing.assert_array_equal(spreading(9, seed=3)[1], candidates)
    assert not np.array_equal(spreading(9, seed=4)[1], candidates)
    np.testing.assert_array_equal(candidates[0], start_of(objective.study))
    fraction = objective.bounds.fraction(candidates[1:])
    strata = np.floor((fraction - 0.02) / 0.96 * 8).astype(int)
    for column in strata.T:  # each stratum once
        np.testing.assert_array_equal(np.sort(column), np.arange(8))
    assert spreading(1)[1].shape == (1, 2)


def test_candidates_follow_a_prior():
    objective, candidates = spreading(200, prior={"mean": 1000.0, "sd": 100.0})
    values = objective.bounds.parameter(candidates[1:])[:, 1]
    # A sample of 199, in strata: its moments are far closer than those of chance.
    assert np.mean(values) == pytest.approx(1000.0, rel=0.005)
    assert np.std(values) == pytest.approx(100.0, rel=0.05)


class Valley:
    """Rosenbrock's valley, with its minimum at (1, 1), as an objective."""

    bounds = Bounds(np.array([-5.0, -5.0]), np.array([5.0, 5.0]), np.zeros(2, bool))

    def __call__(self, x):
        a, b = self.bounds.parameter(x).T
        residuals = np.stack([10.0 * (b - a**2), 1.0 - a], axis=1)
        rows = np.zeros((len(x), 2, 2))
        rows[:, 0, 0], rows[:, 0, 1], rows[:, 1, 0] = -20.0 * a, 10.0, -1.0
        return self.points(x, residuals, rows)

    def points(self, x, residuals, rows):
        rows = rows * self.bounds.half
        return Points(
            x,
            0.5 * np.sum(residuals**2, axis=1),
            np.einsum("lrp,lr->lp", rows, residuals),
            np.einsum("lrp,lrq->lpq", rows, rows),
            residuals[:, :, None],
            np.zeros((len(x), 1)),
            rows[:, :, None, :],
        )

    def values(self, x):
        return self(x)

    def residuals(self, points):
        return points.predicted[0, :, 0], points.jacobian[0, :, 0]

    def failed(self, predicted):
        return ~np.isfinite(predicted)

    def variance(self, cost):
        return np.abs(cost)

    def unit(self, cost):
        return np.maximum(1.0, np.abs(cost))


class Cliff(Valley):
    """A slope down to a cliff at a = 0, and no minimum before it."""

    def __call__(self, x):
        a = self.bounds.parameter(x)[:, 0]
        residuals = np.stack([1.0 + a, 15.0 * (a < 0.0)], axis=1)
        rows = np.zeros((len(x), 2, 2))
        rows[:, 0, 0] = 1.0
        return self.points(x, residuals, rows)


def test_rosenbrock_from_everywhere():
    """The known minimum (1, 1), from 25 points."""
    grid = np.linspace(-4.0, 4.0, 5)
    x = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2) / 5.0
    fits = fit(Valley(), x)
    assert set(fits.reasons) == {Reason.converged}
    found = Valley.bounds.parameter(fits.points.x)
    # A promise of 1e-6 leaves 3e-3 in the flattest direction, of curvature 0.2.
    np.testing.assert_allclose(found, 1.0, atol=3e-3)


def test_a_fixed_unknown_stays():
    x = np.array([[0.1, 0.5]])
    fits = fit(Valley(), x, np.array([[True, False]]))
    assert fits.points.x[0, 1] == 0.5
    # b = 2.5: the minimum of 100 (b - a^2)^2 + (1 - a)^2 over a.
    a = Valley.bounds.parameter(fits.points.x)[0, 0]
    assert -400.0 * a * (2.5 - a**2) - 2.0 * (1.0 - a) == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("near", [0.0, 1e-13, 1e-11, -1e-8])
def test_a_start_beside_zero_moves(near):
    """As a profile's unknowns that are left free: deviations of a group, whose best
    value is 0 but for rounding."""
    x = np.array([[0.2, near]])  # a = 1
    fits = fit(Valley(), x, np.array([[False, True]]))
    assert fits.reasons == [Reason.converged]
    assert Valley.bounds.parameter(fits.points.x)[0, 1] == pytest.approx(1.0, abs=1e-3)


def test_a_start_at_a_cliff_is_stuck():
    """The cost falls towards a cliff, and there is no minimum before it."""
    fits = fit(Cliff(), np.array([[0.3, 0.0]]))
    assert fits.reasons == [Reason.stuck]
    assert not fits.reasons[0].at_minimum
    assert 0.0 <= fits.points.x[0, 0] < 1e-2


def test_a_minimum_at_a_bound_is_at_the_bound():
    """Of the valley with b at most 0: a^2 + 400 a^3 ... its lowest point has b = 0."""

    class Lower(Valley):
        bounds = Bounds(np.array([-5.0, -5.0]), np.array([5.0, 0.0]), np.zeros(2, bool))

    fits = fit(Lower(), Lower.bounds.coordinate([[-2.0, -3.0]]))
    assert fits.reasons[0].at_minimum
    assert fits.points.x[0, 1] == Lower.bounds.high[1]
    a = Lower.bounds.parameter(fits.points.x)[0, 0]
    # The derivative of 50 a^4 + (1 - a)^2 / 2.
    assert 200.0 * a**3 - (1.0 - a) == pytest.approx(0.0, abs=1e-2)


def test_a_step_keeps_to_the_bounds_and_goes_down():
    """Against all corners and edges of a correlated quadratic, by brute force."""
    random, nothing = np.random.default_rng(0), np.zeros((1, 0))
    parts = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, 21)] * 3), -1).reshape(-1, 3)
    for _ in range(40):
        root, gradient = random.normal(size=(3, 3)), random.normal(size=3)
        hessian = root @ root.T + 1e-3 * np.eye(3)
        down, up = -random.random(3), random.random(3)
        bounds = SimpleNamespace(low=down, high=up)
        points = Points(
            *(np.zeros((1, 3)), nothing, gradient[None]),
            *(hessian[None], nothing, nothing, nothing),
        )
        step, promise = bounded_step(SimpleNamespace(bounds=bounds), points)
        assert np.all((step >= down) & (step <= up))
        grid = down + parts * (up - down)
        model = grid @ gradient + 0.5 * np.einsum("gp,pq,gq->g", grid, hessian, grid)
        assert promise >= -np.min(model) - 1e-3


@pytest.mark.parametrize("loss", ["gaussian", "soft-l1", "student"])
def test_half_the_sum_of_squares_is_the_cost(loss):
    """Of measurements, limits, a prediction that is missing, and one that is exact; the
    gradient is that of the residuals."""
    study = linear_study(5, sigma=0.1)
    censored = np.array([0, 1, -1, 0, 0])[:, None]
    study = dataclasses.replace(study, censored=censored, loss=loss)
    matrix = np.array([[1.0, 0.3], [0.5, -1.0], [0.2, 0.4], [0.0, 0.0], [1.0, 1.0]])
    objective = Linear(study, matrix=matrix).with_loss(loss)
    point = objective(np.array([[0.3, 0.2]]))
    predicted = point.predicted.copy()
    predicted[0, 4] = np.nan
    point = objective.evaluate(point.x, predicted, point.outcomes, point.jacobian)
    residuals, rows = objective.residuals(point)
    assert 0.5 * np.sum(residuals**2) == pytest.approx(point.cost[0], rel=1e-12)
    np.testing.assert_allclose(residuals @ rows, point.gradient[0], rtol=1e-12)


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


def test_an_outlier_that_a_robust_loss_softens_widens_no_interval():
    predicted = np.where(np.arange(40) % 2, 0.1, -0.1)
    predicted[3] = 3.0  # thirty sigmas
    jacobian = np.stack([np.ones(40), np.linspace(0.0, 1.0, 40)], axis=1)
    for loss, expected in (("gaussian", 24.7), ("student", 1.0)):
        study = dataclasses.replace(linear_study(40, 0.1), loss=loss)
        found = estimate(*by_hand(study, jacobian, predicted))
        # (39 + 900) / 38, the sum of squares over the degrees of freedom
        assert found.inflation == pytest.approx(expected, rel=0.01)


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
    (once, members), (again, others) = fit_places(objective), fit_places(objective)
    np.testing.assert_array_equal(once.points.x, again.points.x)
    np.testing.assert_array_equal(members.x, others.x)
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


def test_places_of_a_population():
    x = np.array([[0.0, 0.0], [0.2, -0.1], [1.0, 0.0], [0.9, 0.2], [0.0, 2.0]])
    population = Population(x, np.array([1.0, 1.05, 1.5, 2.0, 3.0]), unit=1.0)
    np.testing.assert_array_equal(population.places(9), x[[0, 2, 4]])
    np.testing.assert_array_equal(population.places(2), x[[0, 2]])
    assert population.agreed == 2
    # One of a cost that the data cannot tell from the lowest agrees too.
    assert population._replace(unit=5.0).agreed == 3


class Hollows(Linear):
    """The first prediction has many hollows, which stop fits by derivatives."""

    def _predict(self, x, derivatives):
        predicted, outcomes, jacobian = super()._predict(x, derivatives)
        predicted[:, 0, 0] += 3.0 * np.sin(20.0 * x[:, 0])
        jacobian[:, 0, 0, 0] += 60.0 * np.cos(20.0 * x[:, 0])
        return predicted, outcomes, jacobian


@pytest.mark.parametrize("rows", [3, 12])
def test_a_search_passes_local_minima(rows):
    """With many measurements by the robust cost, with few by the cost itself."""
    matrix = np.resize(np.array([[0.1, 0.1], [1.0, 0.0], [0.0, 1.0]]), (rows, 2))
    objective = Hollows(linear_study(rows, sigma=0.1), matrix=matrix)
    x = objective.bounds.coordinate([[2.0, 3.0]])
    study = dataclasses.replace(
        objective.study, measured=objective.values(x).predicted[0]
    )
    objective = objective._changed(study=study)
    population = search(objective, 24)
    assert population.agreed >= 12
    np.testing.assert_allclose(population.x[0], x[0], atol=0.3)


def test_the_lowest_end_has_derivatives(monkeypatch):
    """Where the first one that is fitted to the end ends above another."""
    objective = Linear(linear_study(3, sigma=0.1), matrix=np.eye(3)[:, :2])
    x = np.array([[0.1, 0.0], [0.9, 0.0]])
    population = Population(x, np.zeros(2), unit=1.0)
    begun = []

    def refine(objective, x, others):
        begun.append(x)
        points = objective((x + (0.5 if len(begun) == 1 else 0.0))[None])
        return Fits(points, [Reason.converged], np.ones(1, int))

    module = "jaximpact.calibration.estimation.search"
    monkeypatch.setattr(f"{module}.search", lambda objective, members: population)
    monkeypatch.setattr(f"{module}.refine", refine)
    monkeypatch.setattr(Objective, "rough", lambda objective: objective)
    fits, _ = fit_places(objective)
    assert len(begun) == 2
    assert np.any(fits.points.jacobian[fits.best])


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
    begin = fit(objective, np.array([[0.2, 0.2]]))
    assert not begin.reasons[0].at_minimum
    found = fit_along(objective, np.array([0.2, 0.2]))
    assert found.reasons == [Reason.edge]
    assert np.sum(found.points.x) <= 1.0
    best = 0.5 * (2.0 * 0.15**2 / 0.1**2)
    # A search ends where it falls by a hundredth of the unit of costs, 1.
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
    found = refine(objective, np.array([0.2, 0.2]))
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
        judgement = objective, stuck, judged.uncertainty, {}, stuck, {}
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
    assert np.all(has_left(objective, fit, draws)[:, 0])
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
    after = fit_by(method, objective, x)
    assert np.all(after.points.cost < 0.2 * before)
    assert set(after.reasons) <= {Reason.step_limit, Reason.converged, Reason.stuck}

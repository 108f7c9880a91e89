"""What is to be known of a fit: left-out tests, bands, residuals, further tests and the
posterior. Linear models have exact answers."""

import dataclasses
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from calibrated_twin import results_of_model
from calibration_studies import Linear, fit, objective_of, study_of_columns
from calibration_studies import fitted as settled
from error_messages import assert_one_line_error
from scipy.stats import binomtest, lognorm, truncnorm, ttest_1samp
from scipy.stats import t as student

from jaximpact import PRESETS
from jaximpact.calibration import (
    Sigma,
    fit_study,
    sample_posterior,
    suggest_tests,
    to_inference_data,
)
from jaximpact.calibration.diagnostics import importance_sampling as draws
from jaximpact.calibration.diagnostics.cross_validation import (
    leave_out_campaigns,
    leave_out_each,
    linearised,
)
from jaximpact.calibration.diagnostics.further_tests import as_text, choose, merit
from jaximpact.calibration.diagnostics.identifiability import Verdict, profile_all
from jaximpact.calibration.diagnostics.importance_sampling import draw
from jaximpact.calibration.diagnostics.nuts import compare_errors
from jaximpact.calibration.diagnostics.posterior import Chains, Draws
from jaximpact.calibration.diagnostics.predictive import bands_of, predictive
from jaximpact.calibration.diagnostics.residuals import residuals_of
from jaximpact.calibration.diagnostics.uncertainty import estimate, regular_covariance
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io.files import replacing

pytestmark = pytest.mark.slow

# --- A linear model in place of impacts: every answer is known. ---

SIGMA = 0.05
HALF_WIDTH = 0.5 * np.log(1e6)
"""Of the range of each unknown, in x."""


def linear(matrix, measured, campaigns=None, sigma=None):
    """The objective of a linear model, its fit (points of one lane) and uncertainty."""
    tests = {"speed_mps": np.arange(len(measured)) + 1.0, "e_n": measured}
    if campaigns is not None:
        tests["campaign"] = campaigns
    names = ("c_v", "gamma_v", "k_E")[: matrix.shape[1]]
    sigma = {"e_n": SIGMA} if sigma is None else sigma
    bounds = {"start": 1.0, "lower": 1e-3, "upper": 1e3}
    study = study_of_columns(
        tests, parameters=dict.fromkeys(names, bounds), default_sigma=sigma
    )
    objective = Linear(study, matrix=matrix)
    points = fit(objective, np.zeros((1, matrix.shape[1]))).points
    return objective, points, estimate(objective, points)


def line(count, seed=0, campaigns=None):
    """Matrix of a straight line, and measurements about 0.2 + 0.3 z."""
    z = np.linspace(-1.0, 1.0, count)
    matrix = np.stack([np.ones(count), z], axis=1)
    noise = SIGMA * np.random.default_rng(seed).normal(size=count)
    return matrix, 0.2 + 0.3 * z + noise


def test_bounds_as_a_weak_prior():
    """The second unknown has no influence: a uniform distribution over its range is
    left. On the first the bounds have next to none."""
    matrix = np.stack([np.ones(8), np.zeros(8)], axis=1)
    objective, points, _ = linear(matrix, np.full(8, 0.1))
    covariance = regular_covariance(objective, points, 1.0)
    assert covariance[1, 1] == pytest.approx((2.0 * HALF_WIDTH) ** 2 / 12.0)
    information = 8.0 / SIGMA**2 + 12.0 / (2.0 * HALF_WIDTH) ** 2
    assert covariance[0, 0] == pytest.approx(1.0 / information)


def test_draws_of_a_normal_posterior():
    """Their moments are those of the fit; next to all of them count."""
    objective, points, uncertainty = linear(*line(20))
    found = draw(objective, points, 1.0, count=4000)
    assert len(found.effective_fraction) == 1
    # Student's distribution of 5 degrees of freedom for a normal one of 2: 0.924.
    assert found.effective_fraction[0] == pytest.approx(0.924, abs=0.03)
    # 4 standard errors of the mean of 3700 draws.
    error = uncertainty.standard_errors
    assert np.all(np.abs(found.mean() - points.x[0]) < 4.0 * error / np.sqrt(3700))
    apart = found.covariance() - uncertainty.covariance
    # Errors of 2.3 % on variances: 4 of them.
    assert np.all(np.abs(apart) < 0.1 * np.outer(error, error))


def test_draws_of_a_prior_that_the_tests_leave_alone():
    """They are of the normal distribution of the prior, cut off at the bounds, though
    drawn in the logarithm of the parameter."""
    bounds = {"start": 1.0, "lower": 0.01, "upper": 100.0}
    study = study_of_columns(
        {"speed_mps": 1.0, "e_n": [0.1]},
        parameters={"c_v": bounds | {"prior": {"mean": 1.0, "sd": 0.5}}},
        default_sigma={"e_n": 1e3},
    )
    objective = Linear(study, matrix=np.ones((1, 1)))
    points = fit(objective, np.zeros((1, 1))).points
    found = draw(objective, points, 1.0, count=4000)
    value, weights = np.exp(found.x[:, 0]), found.weights
    exact = truncnorm((0.01 - 1.0) / 0.5, np.inf, loc=1.0, scale=0.5)
    # Four standard errors of the mean of the effective draws.
    error = exact.std() / np.sqrt(found.effective)
    assert abs(weights @ value - exact.mean()) < 4.0 * error
    below = weights @ (value < 0.5)
    assert abs(below - exact.cdf(0.5)) < 4.0 * 0.5 / np.sqrt(found.effective)


def test_sigmas_that_are_too_small_leave_priors_as_they_are():
    """Of a mean under a normal prior: estimate, interval and draws by hand, for x twice
    the parameter."""
    measured = 0.2 + 0.2 * np.tile([1.0, -1.0], 8)
    study = study_of_columns(
        {"speed_mps": 1.0, "e_n": measured},
        parameters={
            "dilatancy": {
                "start": 0.5,
                "lower": 0.0,
                "upper": 1.0,
                "prior": {"mean": 0.7, "sd": 0.05},
            }
        },
        default_sigma={"e_n": SIGMA},
    )
    objective = Linear(study, matrix=np.full((16, 1), 0.5))
    points = fit(objective, np.full((1, 1), 1.4)).points
    found = estimate(objective, points)
    of_tests, of_prior = 16.0 / SIGMA**2, 1.0 / 0.05**2
    mean = (0.2 * of_tests + 0.7 * of_prior) / (of_tests + of_prior)
    assert 0.5 * points.x[0, 0] == pytest.approx(mean, abs=1e-6)
    freedom = 16.0 - of_tests / (of_tests + of_prior)
    inflation = np.sum((measured - mean) ** 2) / SIGMA**2 / freedom
    assert found.inflation == pytest.approx(inflation, rel=1e-6)
    assert inflation > 10.0
    error = np.sqrt(inflation * of_tests + of_prior) / (of_tests + of_prior)
    assert 0.5 * found.standard_errors[0] == pytest.approx(error, rel=1e-6)
    (profile,) = profile_all(objective, points, found)
    ends = mean - error, mean + error
    np.testing.assert_allclose((profile.low, profile.high), ends, rtol=1e-4)
    drawn = draw(objective, points, inflation, count=4000)
    precision = of_tests / inflation + of_prior
    centre = (0.2 * of_tests / inflation + 0.7 * of_prior) / precision
    # Four standard errors.
    error = np.sqrt(1.0 / precision / drawn.effective)
    assert abs(0.5 * drawn.mean()[0] - centre) < 4.0 * error
    ratio = 0.25 * drawn.covariance()[0, 0] * precision
    assert abs(ratio - 1.0) < 4.0 * np.sqrt(2.0 / drawn.effective)


def test_draws_that_do_not_count_are_drawn_again(monkeypatch):
    """From a proposal ten times too narrow they find the posterior all the same."""
    objective, points, uncertainty = linear(*line(20))
    narrow = np.linalg.inv(100.0 * points.hessian[0])
    monkeypatch.setattr(draws, "laplace", lambda *arguments: narrow)
    found = draw(objective, points, 1.0, count=2000)
    assert len(found.effective_fraction) > 1
    assert found.effective_fraction[-1] > draws.ENOUGH
    deviation = np.sqrt(np.diag(found.covariance()))
    np.testing.assert_allclose(deviation, uncertainty.standard_errors, rtol=0.15)


def test_draws_in_parts_are_of_the_same_posterior():
    """From a first proposal that is too wide, and one that is too narrow."""
    objective, points, uncertainty = linear(*line(20))
    for factor in (0.01, 100.0):
        other = points._replace(jacobian=np.sqrt(factor) * points.jacobian)
        about = objective, objective.reevaluate(other)
        found = draws.sample(objective, points, 1.0, about=about, parts=8, count=4000)
        assert len(found.x) == 500 * len(found.effective_fraction)
        assert found.effective > draws.ENOUGH * 4000
        assert np.isnan(found.error)
        # Four standard errors of a standard deviation of 1200 draws.
        deviation = np.sqrt(np.diag(found.covariance()))
        np.testing.assert_allclose(deviation, uncertainty.standard_errors, rtol=0.08)
    below = found.cost.min() + 1e-3
    enough = draws.sample(
        objective, points, 1.0, about=about, enough_below=below, parts=8, count=4000
    )
    assert len(enough.effective_fraction) <= len(found.effective_fraction)
    assert np.min(enough.cost) < below


KNOWN = np.array([np.inf])
"""Degrees of freedom of a sigma that is given."""


def test_bands_of_a_line():
    """Against the textbook, of the line and of a measurement."""
    matrix, measured = line(20)
    objective, points, uncertainty = linear(matrix, measured)
    drawn = draw(objective, points, 1.0, count=4000)
    found = bands_of(objective, drawn, 1.0, drawn.weights, KNOWN)
    spread = np.sqrt(np.einsum("tp,pq,tq->t", matrix, uncertainty.covariance, matrix))
    width = (found.high - found.low)[:, 0]
    # Quantiles of some 3700 draws: 4 standard errors of 3 % each.
    np.testing.assert_allclose(width, 2.0 * 1.96 * spread, rtol=0.12)
    width = (found.measured_high - found.measured_low)[:, 0]
    np.testing.assert_allclose(width, 2.0 * 1.96 * np.hypot(spread, SIGMA), rtol=0.03)


@pytest.mark.parametrize("freedom", [1.0, 3.0, 30.0])
def test_bands_of_an_estimated_sigma_are_those_of_predictions(freedom):
    """Student's quantiles, with the weights of the draws that predictions take."""
    objective, points, _ = linear(*line(5))
    drawn = draw(objective, points, 1.0, count=400)
    weights = drawn.weights * np.linspace(0.5, 1.5, len(drawn.weights))
    weights /= np.sum(weights)
    found = bands_of(objective, drawn, 1.0, weights, np.array([freedom]))
    width = found.measured_high - found.measured_low
    for test in range(5):
        values = drawn.predicted[:, test, 0]
        each = partial(student.cdf, df=freedom)
        for part, band in ((0.025, found.measured_low), (0.975, found.measured_high)):
            below = each((band[test, 0] - values) / SIGMA)
            assert np.sum(weights * below) == pytest.approx(part, abs=1e-12)
        # The atoms of a prediction stand for intervals of one per cent.
        expected = predictive(values, weights, SIGMA, freedom)
        assert expected.quantile(0.975) - expected.quantile(0.025) == pytest.approx(
            width[test, 0], rel=0.02
        )


@pytest.mark.parametrize("target", ["max_penetration_m", "final_sinking_m"])
def test_bands_of_what_is_never_negative(target):
    """Those of one draw are the quantiles of the lognormal distribution."""
    objective, points, _ = linear(*line(6))
    study = dataclasses.replace(objective.study, targets=(target,))
    objective.study, value = study, 0.5 * SIGMA + 0.04 * np.arange(6.0)
    one = draw(objective, points, 1.0, count=1)
    one = one._replace(predicted=value[None, :, None])
    found = bands_of(objective, one, 4.0, np.ones(1), KNOWN)
    shape = np.sqrt(np.log1p((2.0 * SIGMA / np.maximum(value, SIGMA)) ** 2))
    scale = np.maximum(value, SIGMA) * np.exp(-0.5 * shape**2)
    for part, band in ((0.025, found.measured_low), (0.975, found.measured_high)):
        # Of one draw it is in closed form.
        expected = lognorm.ppf(part, shape, scale=scale)
        np.testing.assert_allclose(band[:, 0], expected, rtol=1e-10)
    np.testing.assert_allclose(found.low[:, 0], value, rtol=1e-12)


def test_bands_where_nothing_is_predicted():
    objective, points, _ = linear(*line(6))
    found = draw(objective, points, 1.0)
    gone = found.predicted.copy()
    gone[:, 2] = np.nan
    found = found._replace(predicted=gone)
    bands = bands_of(objective, found, 1.0, found.weights, KNOWN)
    assert np.isnan(bands.low[2, 0])
    assert np.all(np.isfinite(np.delete(bands.low, 2, axis=0)))


def test_left_out_of_a_line():
    """In closed form: the residual over 1 - h, and sigma / sqrt(1 - h)."""
    matrix, measured = line(12)
    objective, points, uncertainty = linear(matrix, measured)
    found = leave_out_each(objective, points, uncertainty)
    hat = matrix @ np.linalg.inv(matrix.T @ matrix) @ matrix.T
    left = 1.0 - np.diag(hat)
    residual = measured - (hat @ measured)
    # The fits end a hundredth of a standard error from their minima; the bounds, as a
    # prior, add 1e-5.
    apart = measured - found.predicted[:, 0]
    np.testing.assert_allclose(apart, residual / left, rtol=1e-3, atol=1e-2 * SIGMA)
    np.testing.assert_allclose(found.deviation[:, 0], SIGMA / np.sqrt(left), rtol=1e-3)
    steps = linearised(objective, points, np.eye(12, dtype=bool))
    exact = [
        np.linalg.lstsq(np.delete(matrix, k, 0), np.delete(measured, k), rcond=None)[0]
        for k in range(12)
    ]
    np.testing.assert_allclose(points.x[0] + steps, exact, rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(found.x, exact, rtol=0.0, atol=1e-2 * SIGMA)


class Bent(Linear):
    """The first unknown, plus the square of each test's own."""

    def _predict(self, x, derivatives):
        own, count = x[:, 1:], x.shape[1]
        jacobian = np.zeros((*own.shape, 1, count))
        jacobian[..., 0] = 1.0
        for test in range(count - 1):
            jacobian[:, test, 0, 1 + test] = 2.0 * own[:, test]
        return (x[:, :1] + own**2)[:, :, None], np.zeros(own.shape), jacobian


def test_a_test_left_out_has_its_own_unknown_where_the_prior_is():
    """And not where the model, taken as linear over all the way there, would be."""
    measured = 0.2 + np.array([0.5, 0.9, 1.4, 2.0]) ** 2
    study = study_of_columns(
        {"e_n": measured, "orientation_deg": np.zeros(4)},
        parameters={"c_v": {"start": 1.0, "lower": 1e-3, "upper": 1e3}},
        nuisance={"orientation_deg": {"by": "row", "prior": {"mean": 0.0, "sd": 1.0}}},
        default_sigma={"e_n": SIGMA},
    )
    objective = Bent(study, matrix=np.zeros((4, 5)))
    points = fit(objective, np.array([[0.2, 0.5, 0.9, 1.4, 2.0]])).points
    found = leave_out_each(objective, points, estimate(objective, points))
    for test in range(4):
        # A fit to the rest ends a twentieth of a standard error from its minimum, times
        # the root of the reduced chi-square.
        assert abs(found.x[test, 1 + test]) < 0.1
        own = found.x[test, 1 + test] ** 2
        assert found.predicted[test, 0] == pytest.approx(found.x[test, 0] + own)


def test_of_many_only_the_most_telling_are_fitted(monkeypatch):
    """For the others a Gauss-Newton step stands, which for a line is as good."""
    made = []

    def counted(objective, x, **how):
        made.append(np.flatnonzero(~np.any(objective.study.known, axis=1)))
        return fit(objective, x, **how)

    monkeypatch.setattr(
        "jaximpact.calibration.diagnostics.cross_validation.fit", counted
    )
    matrix, measured = line(12)
    measured[4] += 10.0 * SIGMA
    objective, points, uncertainty = linear(matrix, measured)
    expected = leave_out_each(objective, points, uncertainty)
    assert 2 < len(made) < 12
    made.clear()
    found = leave_out_each(objective, points, uncertainty, at_most=2)
    assert [4] in [list(left) for left in made]
    assert len(made) == 2
    for name in ("predicted", "deviation"):
        np.testing.assert_allclose(
            *(getattr(left, name) for left in (found, expected)), atol=1e-2 * SIGMA
        )
    made.clear()
    leave_out_each(objective, points, uncertainty, at_most=0)
    assert not made


def test_campaigns_left_out():
    """One campaign lies elsewhere: the others do not predict it, and that is said."""
    matrix, measured = line(18)
    names = np.repeat(["a", "b", "c"], 6)[np.random.default_rng(0).permutation(18)]
    objective, points, uncertainty = linear(matrix, measured, names)
    found = leave_out_campaigns(objective, points, uncertainty)
    rest = names != "b"
    exact = np.linalg.lstsq(matrix[rest], measured[rest], rcond=None)[0]
    number = found.groups.index("b")
    np.testing.assert_allclose(found.x[number], exact, rtol=0.0, atol=1e-2 * SIGMA)
    assert np.mean(found.inside(measured[:, None])) > 0.8
    shifted = measured + np.where(names == "b", 1.0, 0.0)
    objective, points, uncertainty = linear(matrix, shifted, names)
    found = leave_out_campaigns(objective, points, uncertainty._replace(inflation=1.0))
    assert not np.any(found.inside(shifted[:, None])[names == "b"])
    alone = linear(matrix, measured)
    assert leave_out_campaigns(*alone) is None
    # A campaign without a measurement is none.
    some = linear(matrix, np.where(names == "a", np.nan, measured), names)
    assert set(leave_out_campaigns(*some).groups) == {"b", "c"}
    one = linear(matrix, np.where(names == "b", measured, np.nan), names)
    assert leave_out_campaigns(*one) is None


def test_without_the_only_test_that_tells():
    """Left out it cannot be predicted: what it alone tells stays where it was, which
    would predict it by itself, and is as uncertain as the bounds are wide."""
    matrix = np.stack([np.ones(6), [0, 0, 1, 0, 0, 0]], axis=1)
    objective, points, uncertainty = linear(matrix, np.full(6, 0.1))
    found = leave_out_each(objective, points, uncertainty)
    assert found.deviation[2, 0] == pytest.approx(HALF_WIDTH / np.sqrt(3.0), rel=1e-3)
    assert np.all(np.delete(found.deviation, 2) < 2.0 * SIGMA)
    missing = np.isnan(found.predicted[:, 0])
    np.testing.assert_array_equal(missing, np.arange(6) == 2)


def test_residuals_are_studentised():
    """Of many repeats each has the variance 1, whatever its leverage."""
    squares = []
    for seed in range(200):
        matrix, measured = line(5, seed)
        objective, points, _ = linear(matrix, measured)
        squares.append(residuals_of(objective, points, 1.0).values[:, 0] ** 2)
    # Of 200 squares of normal numbers: 4 standard errors of 0.1.
    np.testing.assert_allclose(np.mean(squares, axis=0), 1.0, atol=0.4)


def test_what_residuals_follow_is_found():
    """A line fitted to a parabola: no rank correlation, but neighbours are alike. Of
    pure noise nothing is said, in 95 of 100 cases."""
    z = np.linspace(-1.0, 1.0, 16)
    matrix = np.stack([np.ones(16), z], axis=1)
    objective, points, _ = linear(matrix, z**2)
    found = residuals_of(objective, points, 1.0)
    assert {trend.against for trend in found.trends} == {"speed_mps"}
    assert abs(found.trends[0].correlation) < 0.1
    assert found.trends[0].autocorrelation > 0.6
    # The same, far below sigma: what an integration leaves, not a model.
    objective, points, _ = linear(matrix, 1e-4 * SIGMA * z**2)
    assert residuals_of(objective, points, 1.0).trends == []
    said = 0
    for seed in range(60):
        objective, points, _ = linear(*line(16, seed))
        said += bool(residuals_of(objective, points, 1.0).trends)
    assert said <= 8  # 3 expected; more than 8 in one of 100


def test_a_bias_is_found_by_signs_and_by_the_mean():
    """Of a slope through 0 fitted to what has an offset. The p-values are SciPy's: the
    t-test has the degrees of freedom that the slope leaves."""
    z = np.linspace(-1.0, 1.0, 15)
    random = np.random.default_rng(4)
    measured = SIGMA * (1.5 + random.normal(size=15))
    objective, points, _ = linear(z[:, None], measured)
    (bias,) = residuals_of(objective, points, 1.0).biases
    apart = points.predicted[0, :, 0] - measured
    assert bias.significant
    assert (bias.above, bias.count) == (np.sum(apart > 0.0), 15)
    assert bias.mean == pytest.approx(np.mean(apart))
    assert bias.percent == pytest.approx(
        100.0 * np.mean(apart) / np.mean(np.abs(measured))
    )
    assert bias.chance_of_signs == pytest.approx(binomtest(bias.above, 15).pvalue)
    # One degree of freedom less than SciPy's 14: s^2 grows by 14/13.
    ratio = ttest_1samp(apart, 0.0).statistic * np.sqrt(13.0 / 14.0)
    assert bias.chance_of_mean == pytest.approx(2.0 * student.sf(abs(ratio), 13.0))
    assert bias.words.startswith("the fit underestimates e_n in ")
    # Without an offset little is said, and nothing of what an integration leaves.
    said = 0
    for seed in range(60):
        objective, points, _ = linear(*line(16, seed))
        said += bool(residuals_of(objective, points, 1.0).biased)
    assert said <= 8  # at most 3 expected; more than 8 in one of 100
    objective, points, _ = linear(z[:, None], np.full(15, 1e-3 * SIGMA))
    assert not residuals_of(objective, points, 1.0).biased


def test_a_profile_and_a_standard_error_of_a_line_agree():
    """Both are exact: the cost is a parabola. Without sigmas the standard error allows
    for scatter that grows along the line, and the profile is scaled by it."""
    random = np.random.default_rng(6)
    z = np.linspace(0.0, 2.0, 40)
    matrix = np.stack([np.ones(40), z], axis=1)
    measured = z + SIGMA * z**2 * random.normal(size=40)
    objective, points, _ = linear(matrix, measured, sigma={})
    uncertainty = estimate(objective, points)
    assert np.max(np.abs(np.log(uncertainty.profile_scale))) > 0.2
    profiles = profile_all(objective, points, uncertainty)
    errors = uncertainty.quantile * uncertainty.standard_errors
    for place, profile in enumerate(profiles):
        ends = np.log([profile.low_95, profile.high_95])
        expected = points.x[0, place] + errors[place] * np.array([-1.0, 1.0])
        # Costs of profiles are those of fits to a tenth of a standard error.
        np.testing.assert_allclose(ends, expected, atol=0.01 * errors[place])


class Root(Linear):
    """A root of the unknown, on which few measurements leave much doubt."""

    def _predict(self, x, derivatives):
        value = np.sqrt(3.0 + x)[:, :, None] * np.ones((1, len(self.matrix), 1))
        jacobian = np.zeros((*value.shape, 1))
        jacobian[..., 0] = 0.5 / value
        return value, np.zeros(value.shape[:2]), jacobian


@pytest.mark.parametrize("count", [2, 3, 4])
def test_a_profile_of_few_measurements_ends_where_the_likelihood_does(count):
    """Of Student's quantiles of 12.7, 4.3 and 3.2, in closed form."""
    measured = np.array([1.55, 1.65, 1.7, 1.72])[:count]
    study = study_of_columns(
        {"e_n": measured},
        parameters={"c_v": {"start": 1.0, "lower": 0.06, "upper": 1e3}},
    )
    objective, fits = settled(Root(study, matrix=np.ones((count, 1))))
    points = fits.points
    uncertainty = estimate(objective, points)
    (profile,) = profile_all(objective, points, uncertainty)
    middle = np.mean(measured)
    apart = uncertainty.quantile[0] * np.std(measured, ddof=1) / np.sqrt(count)
    assert uncertainty.quantile[0] == pytest.approx(student.ppf(0.975, count - 1))
    ends = (middle + apart * np.array([-1.0, 1.0])) ** 2 - 3.0
    # A part of the half width: interpolation between points 1.5 times as far.
    width = 0.02 * np.ptp(ends)
    np.testing.assert_allclose(
        np.log([profile.low_95, profile.high_95]), ends, atol=width
    )


# --- Design, of linear models whose best designs are known. ---


def gains_of(rows):
    return rows[:, :, None] * rows[:, None, :]


def test_the_best_design_of_a_parabola():
    """D-optimal is a third of the tests at each of -1, 0 and 1."""
    z = np.linspace(-1.0, 1.0, 21)
    rows = np.stack([np.ones(21), z, z**2], axis=1)
    found = choose(1e-6 * np.eye(3), gains_of(rows), 30)
    places, counts = np.unique(z[found.chosen].round(6), return_counts=True)
    np.testing.assert_allclose(places, [-1.0, 0.0, 1.0], atol=1e-9)
    np.testing.assert_array_equal(counts, 10)


def test_a_and_d_differ_where_they_should():
    """Two unknowns, one known ill: A looks after the ill-known one, D after whichever
    can be improved by the larger factor."""
    information = np.diag([1.0, 100.0])
    gains = gains_of(np.array([[1.0, 0.0], [0.0, 20.0]]))
    assert np.argmax(merit(information, gains, "A")) == 0
    assert np.argmax(merit(information, gains, "D")) == 1
    # By hand: determinant 2 and 5 times as large, over 4; trace from 1.01 to 0.51.
    np.testing.assert_allclose(merit(information, gains, "D"), np.log([2.0, 5.0]) / 4.0)
    expected = 0.5 * np.log(1.01 / 0.51)
    assert merit(information, gains, "A")[0] == pytest.approx(expected)


# --- Impacts. ---

DROPS = {"mass_kg": [100.0, 500.0, 50.0, 2000.0], "speed_mps": [6.0, 15.0, 25.0, 10.0]}
MEASURE = {"e_n": 0.01, "max_penetration_m": 0.005}


def drops_study(drops, results=None, **changed):
    """A study of vertical drops with the results given, else the model's."""
    content = {
        "starts": 2,
        "accuracy": "balanced",
        "soil": {"dilatancy": 0.5},
        "parameters": {"c_v": {}, "gamma_v": {}, "k_E": {}},
        "default_sigma": MEASURE,
    }
    return study_of_columns(
        drops | (results or results_of_model(drops)), **content | changed
    )


@pytest.fixture(scope="module")
def fitted():
    """The fit of a twin without noise."""
    return fit_study(drops_study(DROPS)).variants[0]


def test_a_further_test_shrinks_errors_as_promised(fitted):
    """Against the fit of a study that has it; no other candidate would have done
    better."""
    candidates = {"mass_kg": [50.0, 2000.0], "speed_mps": [4.0, 12.0, 30.0]}
    found = suggest_tests(fitted, candidates, MEASURE, together=True, count=1)
    best, uncertainty = found.chosen[0], {}
    for added in zip(*found.candidates.values(), strict=True):
        drops = {
            name: [*values, more]
            for (name, values), more in zip(DROPS.items(), added, strict=True)
        }
        objective = objective_of(drops_study(drops))
        points = fit(objective, fitted.points.x).points
        uncertainty[added] = estimate(objective, points)
        if added == tuple(best.scene.values()):
            for place, name in enumerate(objective.study.targets):
                expected = objective.study.measured[-1, place]
                assert best.predicted[name] == pytest.approx(expected, rel=1e-3)
    # The bounds, as a prior, add 1e-3; derivatives are to 1e-3 at this accuracy.
    errors = uncertainty[tuple(best.scene.values())].standard_errors
    np.testing.assert_allclose(best.errors, errors, rtol=1e-2)
    volumes = [np.linalg.slogdet(u.covariance)[1] for u in uncertainty.values()]
    assert [*uncertainty][np.argmin(volumes)] == tuple(best.scene.values())


def test_further_tests_where_data_determine_nothing():
    """One vertical drop, one number: the bounds stand in for data, and it is said."""
    drop, sigma = {"mass_kg": [500.0], "speed_mps": [15.0]}, {"e_n": 0.01}
    results = {"e_n": results_of_model(drop)["e_n"]}
    variant = fit_study(drops_study(drop, results, default_sigma=sigma)).variants[0]
    found = suggest_tests(variant, {"speed_mps": [5.0, 30.0]}, sigma)
    assert set(found.stood_in) >= {"c_v", "gamma_v"}
    assert np.all(np.isfinite(found.now))
    widest = 2.0 * np.max(variant.bounds.half) / np.sqrt(12.0)
    assert np.all(found.now <= widest)
    assert np.all(np.diff([c.volume for c in found.chosen]) >= 0.0)
    text = as_text(found)
    assert "the bounds replace data" in text
    now = next(line for line in text.splitlines() if line.strip().startswith("now"))
    assert now.count("not identifiable") == 3


def test_candidates_without_a_result_are_counted(fitted):
    candidates = {"angle_deg": [0.0, 30.0]}
    assert suggest_tests(fitted, candidates, {"e_n": 0.01}, count=1).left_out == 0
    found = suggest_tests(fitted, candidates, {"e_t": 0.01}, count=1)
    assert found.left_out == 1  # e_t has no meaning along the normal
    assert found.volumes[0, 0] == 1.0
    with pytest.raises(InputError, match="must be D or A"):
        suggest_tests(fitted, criterion="E")


def test_a_test_that_tells_next_to_nothing_is_not_recommended(fitted):
    """It tells something all the same: the table has its gain."""
    candidates = {"angle_deg": [0.0, 30.0]}
    exact = suggest_tests(fitted, candidates, {"e_n": 0.01}, count=1)
    assert exact.chosen[0].volume > 1.1
    assert "The next test: angle_deg" in as_text(exact)
    vague = suggest_tests(fitted, candidates, {"e_n": 1.0}, count=1)
    assert 1.0 < vague.chosen[0].volume < 1.005
    text = as_text(vague)
    assert "best of these tests would shrink the errors by less than 0.5 % in" in text
    assert "The next test" not in text


def test_a_sigma_in_words():
    assert str(Sigma(0.01, 0.1)) == "0.01 and 10 %"
    assert str(Sigma(relative=0.1)) == "10 %"


def test_the_known_combination_of_one_number():
    """One sum is measured, to 5 %: its eigenvalue is exact, whatever is not known."""
    matrix = np.array([[3.0, 4.0, 0.0]])
    _, _, found = linear(matrix, [0.5])
    np.testing.assert_allclose(found.eigenvalues, [0.0, 0.0, 25.0 / SIGMA**2])
    np.testing.assert_allclose(np.abs(found.eigenvectors[:, 2]), [0.6, 0.8, 0.0])


# --- The posterior. ---


def summary(mean, deviation, effective=np.inf):
    """Posterior of one parameter as NUTS would have it: `(draws, parameters)`."""
    mean, deviation = np.atleast_1d(mean), np.atleast_1d(deviation)
    normal = np.random.default_rng(0).normal(size=(2, 2000, len(mean)))
    x = mean + deviation * (normal - normal.mean((0, 1))) / normal.std((0, 1))
    ones = np.ones(len(mean))
    return Draws(
        x=x.reshape(4000, -1),
        log_weights=np.zeros(4000),
        cost=np.zeros(4000),
        predicted=np.zeros((4000, 1, 1)),
        effective_fraction=np.ones(1),
        accuracy=PRESETS["balanced"],
        error=0.0,
        chains=Chains({}, ones, min(effective, 4000.0) * ones, 0.0),
    )


def test_which_to_believe():
    objective, points, uncertainty = linear(*line(20))
    found = draw(objective, points, 1.0, count=4000)
    best, error = points.x[0], uncertainty.standard_errors
    known = [Verdict("c_v", True, ""), Verdict("gamma_v", True, "")]
    fit = SimpleNamespace(points=points, uncertainty=uncertainty, verdicts=known)

    def words(mean, deviation, **changed):
        return compare_errors(fit, found, summary(mean, deviation, **changed))

    (line_,) = words(best, error)
    assert "agree on c_v, gamma_v" in line_
    # NUTS alone is off: by 10 standard deviations of its noise.
    first, second = words(best + np.array([10.0, 0.0]) * error / 60.0, error)
    assert "differ by more than chance in c_v:" in first
    assert "agree on gamma_v" in second
    # As far off, but of so few independent draws that it may be chance.
    assert len(words(best + 0.17 * error, error, effective=100.0)) == 1
    # All draws are half as wide as the standard error says.
    narrow = uncertainty._replace(standard_errors=2.0 * error)
    fit.uncertainty = narrow
    lines = words(best, error)
    assert all("Use the posterior, not the standard error" in x for x in lines)
    # What is not determined is compared with nothing.
    fit.uncertainty = uncertainty
    fit.verdicts = [known[0], Verdict("gamma_v", False, "the profile is open")]
    first, second = words(best, error)
    assert "Not identifiable: gamma_v" in first
    assert "agree on c_v," in second


def test_draws_whose_costs_are_rough_are_computed_again():
    """Errors of a coarse accuracy are found, and gone in the weights; those that no
    accuracy takes away are told."""
    objective, points, _ = linear(*line(20))
    plain = draw(objective, points, 1.0)
    assert plain.accuracy == draws.LADDER[0]
    assert plain.error == 0.0

    class Rough(Linear):
        """Predictions with errors that differ from place to place."""

        sizes = None

        def _predict(self, x, derivatives):
            predicted, outcomes, jacobian = super()._predict(x, derivatives)
            error = self.sizes[draws.LADDER.index(self.accuracy)] * np.sin(
                1e5 * x[:, :1]
            )
            return predicted + error[..., None], outcomes, jacobian

    rough = Rough(objective.study, matrix=objective.matrix)
    rough.sizes = 0.003, 0.0, 0.0
    found = draw(rough, points, 1.0)
    assert found.accuracy == draws.LADDER[1]
    assert not found.rough
    np.testing.assert_array_equal(found.x, plain.x)
    np.testing.assert_allclose(found.weights, plain.weights, rtol=1e-12)
    np.testing.assert_allclose(found.effective_fraction, plain.effective_fraction)
    rough.sizes = 0.003, -0.003, 0.0
    assert draw(rough, points, 1.0).rough


def test_nuts_agrees_with_laplace(tmp_path):
    """A twin with 2 % of noise, where the posterior is near normal, and its file."""
    pytest.importorskip("blackjax")
    arviz = pytest.importorskip("arviz")
    drops = {name: values[:3] for name, values in DROPS.items()}
    random = np.random.default_rng(5)
    exact = np.array([*results_of_model(drops).values()]).T
    noisy = exact * (1.0 + 0.02 * random.normal(size=exact.shape))
    study = drops_study(
        drops,
        dict(zip(MEASURE, noisy.T.tolist(), strict=True)),
        starts=6,
        soil={"dilatancy": 0.5, "k_E": 1500.0},
        parameters={"c_v": {}, "gamma_v": {}},
        default_sigma=MEASURE | {"e_n": 0.002},
    )
    variant = fit_study(study).variants[0]
    inflation = variant.uncertainty.inflation
    drawn = draw(variant.objective, variant.points, inflation)
    samples = sample_posterior(
        variant, chains=4, warmup=60, count=150, seed=1, draws=drawn
    )
    chains = samples.chains
    assert not np.any(chains.statistics["diverging"])
    assert not samples.rough
    assert np.all(chains.scale_reduction < 1.05)
    effective = np.minimum(chains.effective, 600.0)
    assert np.all(effective > 150.0)
    error = variant.uncertainty.standard_errors
    mean, deviation = np.mean(samples.x, axis=0), np.std(samples.x, axis=0)
    # Of n independent normal draws the mean scatters by 1 / sqrt(n) standard
    # deviations, and the standard deviation by a part of 1 / sqrt(2 n): 4 of each. The
    # draws of importance sampling, which tell how far the posterior is from normal,
    # scatter likewise.
    there = drawn.effective_fraction[-1] * len(drawn.x)
    noise = 4.0 * np.sqrt(1.0 / effective + 1.0 / there)
    assert np.all(np.abs(mean - drawn.mean()) < noise * error)
    drawn_deviation = np.sqrt(np.diag(drawn.covariance()))
    assert np.all(np.abs(deviation / drawn_deviation - 1.0) < noise / np.sqrt(2.0))
    # Of the posterior's own distance from the normal one of the standard errors: a
    # tenth of one, for 2 % of noise on what is nearly linear over it.
    assert np.all(np.abs(mean - variant.points.x[0]) < (noise + 0.1) * error)
    assert np.all(np.abs(deviation / error - 1.0) < noise / np.sqrt(2.0) + 0.1)
    correlation = np.corrcoef(samples.x.T)[0, 1]
    expected = variant.uncertainty.correlation[0, 1]
    most = (4.0 / np.sqrt(np.min(effective)) + 0.1) * (1.0 - expected**2)
    assert abs(correlation - expected) < most

    with replacing(tmp_path / "posterior.nc") as temporary:
        to_inference_data(variant, samples).to_netcdf(str(temporary))
    assert [p.name for p in tmp_path.glob("*posterior*")] == ["posterior.nc"]
    data = arviz.from_netcdf(tmp_path / "posterior.nc")
    assert set(data.groups()) >= {
        *("posterior", "posterior_predictive", "log_likelihood"),
        *("sample_stats", "observed_data"),
    }
    of_chains = variant.bounds.parameter(samples.x)[:, 0].reshape(4, 150)
    np.testing.assert_array_equal(data.posterior.c_v.values, of_chains)
    assert data.posterior.gamma_v.attrs["units"] == "m/s"
    assert data.attrs["accuracy"] == samples.accuracy.name
    assert not np.any(data.sample_stats.diverging)
    assert data.log_likelihood.measured.shape == (4, 150, noisy.size)
    observed = data.observed_data.measured
    np.testing.assert_array_equal(observed.values, noisy.ravel())
    assert list(observed.unit.values) == ["-", "m"] * 3
    assert observed.measurement.values[0].endswith(": e_n")
    predicted = data.posterior_predictive.measured.values.mean((0, 1))
    sigma = np.tile([0.002, 0.005], 3)
    assert np.all(np.abs(predicted - noisy.ravel()) < 4.0 * sigma)


def test_sampling_without_the_extra(tmp_path, capsys, monkeypatch):
    real = __import__("importlib.util").util.find_spec
    monkeypatch.setattr(
        "importlib.util.find_spec",
        lambda name, *rest: None if name == "blackjax" else real(name, *rest),
    )
    path = tmp_path / "tests.csv"
    path.write_text("e_n\n0.2\n")
    code = main(["calibrate", str(path), "--out", str(tmp_path / "o"), "--posterior"])
    assert code == 2
    assert_one_line_error(capsys, "blackjax", "pip install 'jaximpact[bayes]'")

"""Discrepancy of the model outside the fitted tests: against closed forms, and by how
many measurements lie in the intervals that it makes."""

import numpy as np
import pytest
from calibration_studies import Linear, fitted, study_of_columns
from scipy import stats

from jaximpact.calibration.diagnostics.discrepancy import (
    NUGGET,
    Discrepancy,
    discrepancy_of_json,
    estimate_discrepancy,
    freedom_of_sum,
    in_words,
    kriging,
    kriging_variance,
    places_of,
    thirds,
)
from jaximpact.calibration.diagnostics.predictive import predictive
from jaximpact.calibration.diagnostics.uncertainty import (
    estimate,
    regular_covariance,
)
from jaximpact.reports.json_tree import plain

ONE = np.ones(1)


def test_away_from_one_test_the_variance_grows_with_the_power_of_the_distance():
    fitted_place = np.array([[0.3, -1.0, 0.5]])
    away = fitted_place + np.array([[0.0, 3.0, 4.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    covariance = kriging(away, fitted_place)
    # The nugget is what the fitted test itself is uncertain by.
    expected = np.array([5.0**1.5, 0.0, 1.0]) + NUGGET
    np.testing.assert_allclose(np.diag(covariance), expected, atol=1e-9)
    between = 0.5 * (5.0**1.5 + 1.0 - np.sqrt(26.0) ** 1.5)
    np.testing.assert_allclose(covariance[0, 2], between + NUGGET, atol=1e-9)


def test_kriging_is_the_conditional_covariance_of_the_field():
    """Of the field less its value at the first test, whose covariance is known."""
    random = np.random.default_rng(0)
    places, tests = random.normal(size=(4, 3)), random.normal(size=(5, 3))

    def covariance(a, b):
        def apart(p, q):
            return np.linalg.norm(p[:, None] - q, axis=-1) ** 1.5

        first = tests[:1]
        return 0.5 * (apart(a, first) + apart(b, first).T - apart(a, b))

    others = tests[1:]
    beside = covariance(places, others)
    known = beside @ np.linalg.solve(covariance(others, others), beside.T)
    expected = covariance(places, places) - known
    # The nugget moves it by some 1e-6.
    np.testing.assert_allclose(kriging(places, tests), expected, atol=1e-4)
    variance = kriging_variance(places, tests)
    np.testing.assert_allclose(variance, np.diag(kriging(places, tests)), rtol=1e-9)


def test_a_test_that_stands_twice_counts_once():
    random = np.random.default_rng(1)
    places, tests = random.normal(size=(3, 3)), random.normal(size=(4, 3))
    twice = np.concatenate([tests, tests])
    np.testing.assert_array_equal(kriging(places, twice), kriging(places, tests))


def test_thirds_of_what_varies():
    places = np.zeros((7, 3))
    places[:, 0] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 9.0]
    places[:, 1] = [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]  # two sizes: no third
    measured = np.arange(7) < 6
    groups = thirds(places, measured)
    assert [*groups] == ["largest speeds", "smallest speeds"]
    np.testing.assert_array_equal(np.flatnonzero(groups["largest speeds"]), [4, 5])
    np.testing.assert_array_equal(np.flatnonzero(groups["smallest speeds"]), [0, 1])


def test_sigma_and_discrepancy_together():
    whole = predictive(np.zeros(1), ONE, 3.0, discrepancy=4.0)
    alone = predictive(np.zeros(1), ONE, 5.0)
    assert whole is not None
    assert alone is not None
    np.testing.assert_allclose(whole.atoms, alone.atoms, rtol=1e-14)
    # Of a positive result it widens the interval about the same median.
    narrow = predictive(ONE, ONE, 0.1, positive=True)
    wide = predictive(ONE, ONE, 0.1, discrepancy=2.0, positive=True)
    assert narrow is not None
    assert wide is not None
    assert wide.quantile(0.5) == pytest.approx(narrow.quantile(0.5), rel=1e-12)
    spread = np.sqrt(np.log1p(0.01) + np.log1p(4.0))
    ratio = np.log(wide.quantile(0.9) / wide.quantile(0.1))
    # 101 atoms stand for the distribution.
    assert ratio == pytest.approx(2.0 * 1.2816 * spread, rel=0.01)


def test_degrees_of_freedom_of_both():
    one = np.ones((1, 1))
    assert freedom_of_sum(one, 7.0, 0.0 * one, 1.0) == 7.0
    assert freedom_of_sum(0.0 * one, 7.0, one, 3.0) == 3.0
    assert freedom_of_sum(one, 4.0, one, 4.0) == 8.0
    assert np.isinf(freedom_of_sum(0.0 * one, 7.0, 0.0 * one, 1.0))


SPEEDS = np.exp(np.linspace(0.0, 2.0, 15))
"""The first ten are fitted."""


def line(curvature, seed):
    """A line in the logarithm of the speed fitted to measurements on a parabola, with
    noise of 0.05."""
    random = np.random.default_rng(seed)
    along = np.log(SPEEDS)
    truth = 0.2 + 0.3 * along + curvature * along**2
    measured = truth + 0.05 * random.normal(size=len(SPEEDS))
    given = np.where(np.arange(15) < 10, measured, np.nan)
    columns = {"speed_mps": SPEEDS, "e_n": given}
    bounds = {"start": 1.0, "lower": 1e-3, "upper": 1e3}
    study = study_of_columns(columns, parameters={"c_v": bounds, "k_E": bounds})
    matrix = np.stack([np.ones(15), along], axis=1)
    return Linear(study, matrix=matrix), measured


def coverage(curvature, repeats=40):
    """Fractions of the measurements in their 95 % intervals: of the third beyond the
    fitted tests with and without discrepancy, and of new ones at the fitted tests."""
    held = []
    for seed in range(repeats):
        objective, measured = line(curvature, seed)
        objective, fits = fitted(objective)
        points = fits.points
        uncertainty = estimate(objective, points)
        found = estimate_discrepancy(objective, points, uncertainty)
        assert found is not None
        assert found.left_out == 6
        covariance = regular_covariance(objective, points, 1.0)
        rows = points.jacobian[0, :, 0]
        sigma = np.sqrt(
            objective.sigma[:, 0] ** 2 + np.sum(rows @ covariance * rows, axis=1)
        )
        study = objective.study
        apart = found.deviation(study.tests, study.soil, points.predicted[0])[:, 0]
        again = line(curvature, seed + 1000)[1]
        error = np.where(np.isfinite(study.measured[:, 0]), again, measured)
        error = np.abs(error - points.predicted[0, :, 0])
        freedom = freedom_of_sum(sigma, 8.0, apart, found.freedom)
        wide = error <= np.hypot(sigma, apart) * stats.t.ppf(0.975, freedom)
        narrow = error <= sigma * stats.t.ppf(0.975, 8.0)
        held.append([np.mean(wide[10:]), np.mean(narrow[10:]), np.mean(wide[:10])])
    return np.mean(held, axis=0)


def test_intervals_hold_outside_the_fitted_tests():
    # Errors of one repeat go together: these fractions are known to some 4 %.
    wide, narrow, inside = coverage(0.0)
    assert min(wide, narrow) > 0.87
    assert 0.9 < inside < 0.985
    wide, narrow, _ = coverage(0.2)
    assert narrow < 0.6
    assert wide > 0.87


def test_without_three_speeds_nothing_is_known():
    columns = {"speed_mps": [1.0, 1.0, 2.0, 2.0], "e_n": [0.2, 0.21, 0.4, 0.42]}
    bounds = {"start": 1.0, "lower": 1e-3, "upper": 1e3}
    study = study_of_columns(columns, parameters={"c_v": bounds})
    objective, fits = fitted(Linear(study, matrix=np.array([[1.0], [1], [2], [2]])))
    uncertainty = estimate(objective, fits.points)
    assert estimate_discrepancy(objective, fits.points, uncertainty) is None
    assert "an estimate needs three values of speed, size or angle" in in_words(None)


def test_limits_at_three_speeds_tell_nothing():
    """They have no errors, and the words say so."""
    columns = {"speed_mps": [1.0, 2.0, 3.0], "e_n": [">0.1", "<0.5", ">0.2"]}
    study = study_of_columns(
        columns, parameters={"c_v": {"start": 1.0, "lower": 1e-3, "upper": 1e3}}
    )
    objective, fits = fitted(Linear(study, matrix=np.array([[0.1], [0.2], [0.3]])))
    uncertainty = estimate(objective, fits.points)
    assert estimate_discrepancy(objective, fits.points, uncertainty) is None
    assert "with measurements that are not limits" in in_words(None)


def test_written_and_read_again():
    found = Discrepancy(
        factor=1.5,
        freedom=2.5,
        left_out=6,
        groups=("largest speeds",),
        places=np.zeros((2, 3)),
        scatter=np.array([0.05, 0.1]),
        least_size=np.array([np.inf, 0.2]),
    )
    again = discrepancy_of_json(plain(found))
    assert again is not None
    assert "6 measurements" in in_words(again)
    for one, other in zip(found, again, strict=True):
        np.testing.assert_array_equal(one, other)
    assert discrepancy_of_json(None) is None


def test_a_positive_result_is_off_in_proportion():
    columns = {"speed_mps": [4.0], "mass_kg": [8.0], "density_kgm3": [1.0]}
    study = study_of_columns(columns | {"e_n": [0.1], "duration_s": [0.1]})
    found = Discrepancy(
        factor=2.0,
        freedom=3.0,
        left_out=4,
        groups=(),
        places=places_of(study.tests, {}) - [[0.0, 1.0, 0.0]],
        scatter=np.array([0.05, 0.1]),
        least_size=np.array([np.inf, 0.02]),
    )
    # A factor e in size away; the nugget adds half a millionth.
    values = np.array([[7.0, 3.0]])
    apart = found.deviation(study.tests, {}, values)
    np.testing.assert_allclose(apart, [[2.0 * 0.05, 2.0 * 0.1 * 3.0]], rtol=1e-5)

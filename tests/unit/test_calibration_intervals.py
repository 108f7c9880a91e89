"""Intervals of parameters whose sigmas are estimated, of linear models by hand."""

import dataclasses

import numpy as np
import pytest
from calibration_studies import study_of_columns
from scipy.stats import t as student

from jaximpact.calibration.diagnostics.identifiability import _within, interval_text
from jaximpact.calibration.diagnostics.uncertainty import (
    estimate,
    freedom_of_variances,
)
from jaximpact.calibration.problem.objective import Objective

UNKNOWN = {"start": 1.0, "lower": 0.1, "upper": 10.0}
PARAMETERS = {"parameters": {"c_v": UNKNOWN, "gamma_v": UNKNOWN}}


def two_targets(counts, slopes):
    """Measurements of 0 of two targets, so many of each, by predictions of mean 0 that
    are these multiples of the unknowns, shape (targets, unknowns); sigmas are those
    estimated if each unknown is the mean of a target."""
    cells = np.where(np.arange(max(counts))[:, None] < counts, 0.0, np.nan)
    columns = {"mass_kg": 1.0, "e_n": cells[:, 0], "v_n_mps": cells[:, 1]}
    study = study_of_columns(columns, **PARAMETERS)
    noise = np.random.default_rng(0).normal(size=cells.shape) + cells
    noise = np.nan_to_num(noise - np.nanmean(noise, axis=0))
    objective = Objective(study, study.variants[0], None)
    sigma = np.sqrt(np.sum(noise**2, axis=0) / (np.array(counts) - 1.0))
    objective = objective.with_sigma(np.broadcast_to(sigma, cells.shape))
    jacobian = np.broadcast_to(slopes, (1, *cells.shape, 2))
    point = np.zeros((1, 2)), noise[None], np.zeros((1, len(cells))), jacobian
    return objective, objective.evaluate(*point)


@pytest.mark.parametrize("counts", [(4, 10), (16, 11)])
def test_a_target_alone_has_its_own_degrees_of_freedom(counts):
    """Two means, each of a target: the intervals are those of two t-tests, whether
    sigmas are estimated from few measurements or from many."""
    objective, point = two_targets(counts, np.eye(2))
    found = estimate(objective, point)
    freedom = np.array(counts) - 1.0
    errors = objective.sigma[0] / np.sqrt(counts)
    np.testing.assert_allclose(found.quantile, student.ppf(0.975, freedom), rtol=1e-9)
    np.testing.assert_allclose(found.standard_errors, errors, rtol=1e-9)
    of_all = student.ppf(0.975, np.sum(freedom))
    assert found.quantile_of_all == pytest.approx(of_all)


def test_the_weights_of_two_targets_are_estimated():
    """A mean of two targets: against Meier (1953, Biometrics 9, 59), equation of the
    variance of a weighted mean, and Satterthwaite's degrees of freedom."""
    counts = np.array([5, 8])
    objective, point = two_targets(counts, np.array([[1.0, 0.0], [1.0, 0.0]]))
    found = estimate(objective, point)
    information = counts / objective.sigma[0] ** 2
    part = information / np.sum(information)
    freedom = counts - part
    larger = 1.0 + 4.0 * np.sum(part * (1.0 - part) / freedom)
    variance = larger / np.sum(information)
    assert found.covariance[0, 0] == pytest.approx(variance)
    assert found.profile_scale[0] == pytest.approx(larger)
    effective = 1.0 / np.sum(part**2 / freedom)
    assert found.quantile[0] == pytest.approx(student.ppf(0.975, effective))


def test_a_common_weight_of_the_targets_changes_no_error():
    """Of a mean of two targets, whose weights by their sigmas are estimated."""
    counts, found = np.array([5, 8]), []
    for weight in (0.05, 1.0, 50.0):
        objective, point = two_targets(counts, np.array([[1.0, 0.0], [1.0, 0.0]]))
        weights = np.full(2, weight)
        study = dataclasses.replace(objective.study, weights=weights)
        objective = objective._changed(study=study)
        found.append(estimate(objective, objective.reevaluate(point)).covariance[0, 0])
    np.testing.assert_allclose(found, found[1], rtol=1e-9)


def test_degrees_of_freedom_of_scatter_that_differs_from_test_to_test():
    """Against 2 mean^2 / variance of White's estimate with the leverages, of simulated
    Gaussian residuals: 3 standard errors of the variance of 100 000 are 2 %."""
    place = np.linspace(0.0, 1.0, 25) ** 3
    jacobian = np.stack([np.ones(25), place], axis=1)
    study = study_of_columns({"mass_kg": 1.0, "e_n": np.zeros(25)}, **PARAMETERS)
    objective = Objective(study, study.variants[0], None)
    point = np.zeros((1, 25, 1)), np.zeros((1, 25)), jacobian[None, :, None]
    point = objective.evaluate(np.zeros((1, 2)), *point)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    left = np.eye(25) - jacobian @ inverse @ jacobian.T
    residuals = np.random.default_rng(0).normal(size=(100_000, 25)) @ left
    shares = (jacobian @ inverse) ** 2 / np.diag(left)[:, None]
    variances = residuals**2 @ shares
    freedom = 2.0 * np.mean(variances, axis=0) ** 2 / np.var(variances, axis=0)
    found = freedom_of_variances(objective, point)
    np.testing.assert_allclose(found, freedom, rtol=0.02)


def test_a_profile_without_ends_claims_no_values_between():
    """It is low at both bounds, and high on either side of the best fit."""
    x, rise = np.linspace(0.0, 1.0, 5), np.array([0.5, 9.0, 0.0, 9.0, 0.5])
    assert interval_text(*_within(x, rise, 1.0)) == "no end within the bounds"
    # A third of the way to the next point, where the root of the rise is 3.
    assert interval_text(*_within(x[1:], rise[1:], 1.0)) == "above 0.417"

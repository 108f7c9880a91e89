"""Measurements as people have them: campaigns, gaps, limits, outliers, and quantities
that nobody measured."""

import numpy as np
import pytest
from calibration_studies import objective_of
from error_messages import assert_one_line_error
from scipy.integrate import quad
from scipy.stats import norm
from text_files import write_rows

from jaximpact.calibration import fit_study, read_study
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.estimation.least_squares import FINE
from jaximpact.calibration.estimation.sigma import settle
from jaximpact.calibration.estimation.starts import fit
from jaximpact.calibration.problem.noise import (
    LOSSES,
    losses,
    scale_of_normal,
    true_curvature,
)
from jaximpact.calibration.problem.objective import names_of, start_of
from jaximpact.calibration.report.contents import about
from jaximpact.cli import main

U = np.linspace(-6.0, 6.0, 25)
STUDY = """\
data = ["north.csv", "south.csv"]
starts = 6
[parameters]
c_v = { start = 0.9, lower = 0.1, upper = 10.0 }
gamma_v = { start = 6.0, lower = 0.5, upper = 100.0 }
"""
SLOPE = """\
[nuisance.slope_deg]
by = "campaign"
prior = { mean = 25.0, sd = 10.0 }
"""
TRUE = np.array([1.5, 4.0])
SLOPES = {"north": 30.0, "south": 20.0}
TARGETS = "e_n,e_t,max_sinking_m"
HEADER = f"mass_kg,speed_mps,angle_deg,{TARGETS}"
NORTH = ((100, 8, 40), (400, 12, 50), (800, 10, 30), (200, 15, 60))
SOUTH = ((300, 10, 45), (600, 14, 35), (150, 9, 55))


def test_what_was_not_measured_may_be_written_so(tmp_path):
    """A column without any measurement is no target, and is named."""
    head = "speed_mps,angle_deg,e_n,e_t,max_sinking_m"
    rows = "10,20,0.2,NaN,", "12,30,nan,0.6,n/a", "15,40,NA,>0.5,nan"
    (tmp_path / "tests.csv").write_text("\n".join((head, *rows)))
    study = read_study(tmp_path / "tests.csv")
    assert study.targets == ("e_n", "e_t")
    np.testing.assert_array_equal(
        study.known, [[True, False], [False, True], [False, True]]
    )
    assert any("Without any measurement: max_sinking_m." in x for x in about(study))


@pytest.mark.parametrize("sign", [1, -1])
def test_the_loss_of_a_limit_is_that_of_the_scatter_beyond_it(sign):
    """exp(-loss) is the chance that the true value lies beyond the limit: by
    quadrature of the normal density."""
    for u in (-3.0, -0.5, 0.0, 1.0, 4.0):
        found = losses(np.array([u]), np.array([sign])).value[0]
        # Predicted u, limit 0, scatter of 1.
        ends = (0.0, np.inf) if sign > 0 else (-np.inf, 0.0)
        chance, _ = quad(lambda y, u=u: norm.pdf(y - u), *ends, epsabs=1e-13)
        assert np.exp(-found) == pytest.approx(chance, rel=1e-8)


@pytest.mark.parametrize("kind", LOSSES)
@pytest.mark.parametrize("sign", [0, 1, -1])
def test_slopes_of_losses(kind, sign):
    censored = np.full(U.shape, sign)
    step = 1e-5
    plus, minus = (losses(U + by, censored, kind).value for by in (step, -step))
    slope = (plus - minus) / (2.0 * step)
    found = losses(U, censored, kind)
    np.testing.assert_allclose(found.slope, slope, rtol=1e-6, atol=1e-8)
    assert np.all(found.curvature >= 0.0)


@pytest.mark.parametrize("kind", LOSSES)
def test_curvatures_of_losses(kind):
    step, nothing = 1e-5, np.zeros(U.shape, int)
    plus, minus = (losses(U + by, nothing, kind).slope for by in (step, -step))
    np.testing.assert_allclose(
        true_curvature(U, kind), (plus - minus) / (2.0 * step), atol=1e-8
    )
    by_quadrature, _ = quad(
        lambda u: (
            u * losses(np.array([u]), np.zeros(1, int), kind).slope[0] * norm.pdf(u)
        ),
        -12.0,
        12.0,
    )
    assert scale_of_normal(kind) == pytest.approx(by_quadrature, rel=1e-6)


def test_far_limits_have_finite_losses():
    """Where the normal distribution is 0 to rounding, or 1."""
    found = losses(np.array([-1e4, 1e4]), np.ones(2, int))
    np.testing.assert_allclose(found.value, [5e7, 0.0], rtol=1e-6)
    assert np.all(np.isfinite(found.slope))
    assert np.all(np.isfinite(found.curvature))


def write_study(folder, text=STUDY, cells=None):
    """A study of two campaigns; `cells` replaces targets, by file and row."""
    for name, tests in (("north", NORTH), ("south", SOUTH)):
        rows = [
            (*test, *(cells or {}).get((name, row), ("0.1", "0.5", "0.2")))
            for row, test in enumerate(tests)
        ]
        write_rows(folder / f"{name}.csv", HEADER.split(","), rows)
    path = folder / "study.toml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def predicted(tmp_path_factory):
    """Targets of the true soil on the true slopes, `(tests, targets)`."""
    path = write_study(tmp_path_factory.mktemp("true"), STUDY + SLOPE)
    objective = objective_of(path)
    true = objective.bounds.coordinate([*TRUE, *SLOPES.values()])
    return objective(true[None]).predicted[0]


def as_cells(values):
    """Cells of both files."""
    rows = [("north", row) for row in range(len(NORTH))]
    rows += [("south", row) for row in range(len(SOUTH))]
    texts = [tuple(repr(float(x)) for x in line) for line in values]
    return dict(zip(rows, texts, strict=True))


def test_campaigns_are_joined(tmp_path):
    study = read_study(write_study(tmp_path, STUDY + SLOPE))
    assert len(study.tests) == 7
    assert study.tests.labels["campaign"] == ["north"] * 4 + ["south"] * 3
    assert names_of(study)[2:] == ["slope_deg[north]", "slope_deg[south]"]
    assert study.tests.place(4) == (tmp_path / "south.csv", 2)
    np.testing.assert_array_equal(study.tests.inputs["mass_kg"][3:5], [200.0, 300.0])


def test_a_column_that_one_file_lacks_has_its_default(tmp_path):
    path = write_study(tmp_path)
    (tmp_path / "south.csv").write_text("mass_kg,slope_deg,e_bar\n100,10,0.5\n")
    study = read_study(path)
    np.testing.assert_array_equal(study.tests.inputs["speed_mps"], [8, 12, 10, 15, 14])
    np.testing.assert_array_equal(study.tests.inputs["slope_deg"], [0, 0, 0, 0, 10])
    assert list(np.isnan(study.measured[4])) == [True, True, False, True]
    assert study.targets == ("e_n", "e_t", "e_bar", "max_sinking_m")


def test_empty_cells_and_limits_are_read(tmp_path):
    cells = {("north", 1): ("", ">0.3", "< 0.1")}
    study = read_study(write_study(tmp_path, cells=cells))
    assert np.isnan(study.measured[1, 0])
    np.testing.assert_array_equal(study.measured[1, 1:], [0.3, 0.1])
    np.testing.assert_array_equal(study.censored[1], [0, 1, -1])
    assert np.sum(study.known) == 20


@pytest.mark.slow
def test_twin_of_two_slopes_that_nobody_measured(tmp_path, predicted):
    """Soil and both slopes from noise-free targets. The prior, one of 10 degrees about
    25, pulls by what its information is against that of the data."""
    text = STUDY.replace("starts = 6", "starts = 16") + SLOPE
    text += "[default_sigma]\ne_n = 1e-5\ne_t = 1e-5\nmax_sinking_m = 1e-5\n"
    path = write_study(tmp_path, text, as_cells(predicted))
    result = fit_study(read_study(path)).variants[0]
    assert result.reason.at_minimum
    assert np.any(result.reached)
    found = result.parameters
    np.testing.assert_allclose(found[:2], TRUE, rtol=1e-4)
    np.testing.assert_allclose(found[2:], list(SLOPES.values()), atol=1e-2)
    assert [verdict.determined for verdict in result.verdicts] == [True, True]


def test_missing_cells_say_nothing(tmp_path, predicted):
    """A fit with a cell left empty is that to the other cells, whatever stood there."""
    cells = as_cells(predicted)
    cells["south", 1] = ("", *cells["south", 1][1:])
    objective = objective_of(write_study(tmp_path, STUDY + SLOPE, cells))
    true = objective.bounds.coordinate([*TRUE, 28.0, 22.0])
    points = objective(true[None])
    whole = objective_of(
        write_study(tmp_path, STUDY + SLOPE, as_cells(predicted))
    ).with_sigma(objective.sigma)
    u = (points.predicted[0, 5, 0] - predicted[5, 0]) / objective.sigma[5, 0]
    assert abs(u) > 0.01
    assert whole(true[None]).cost[0] - points.cost[0] == pytest.approx(0.5 * u**2)


def test_limits_that_are_kept_cost_little_and_broken_ones_much(tmp_path, predicted):
    costs = []
    for limit in (">-1.0", ">2.0"):
        cells = as_cells(predicted)
        cells["south", 1] = (limit, *cells["south", 1][1:])
        objective = objective_of(write_study(tmp_path, STUDY + SLOPE, cells))
        true = objective.bounds.coordinate([*TRUE, *SLOPES.values()])
        prior = 0.5 * (0.5**2 + 0.5**2)
        costs.append(objective(true[None]).cost[0] - prior)
    assert costs[0] < 1e-12
    assert costs[1] > 100.0


def fitted(objective):
    fits = fit(objective, start_of(objective.study)[None], rule=FINE)
    return settle(objective, fits, fit)


def test_robust_losses_put_up_with_an_outlier(tmp_path, predicted):
    noise = 1.0 + 0.01 * np.random.default_rng(1).normal(size=predicted.shape)
    noise[2, 0] = 1.25
    errors = {}
    for loss in LOSSES:
        text = STUDY.replace("starts = 6", f'starts = 6\nloss = "{loss}"') + SLOPE
        text += "[default_sigma]\ne_n = 2e-3\ne_t = 7e-3\nmax_sinking_m = 1e-3\n"
        path = write_study(tmp_path, text, as_cells(predicted * noise))
        objective, best = fitted(objective_of(path))
        assert best.reasons[0].at_minimum
        x, true = best.points.x[0, :2], objective.bounds.coordinate([*TRUE, 0.0, 0.0])
        errors[loss] = np.max(np.abs(x - true[:2]))
        found = estimate(objective, best.points)
        assert np.all(np.isfinite(found.standard_errors))
        assert np.all(found.standard_errors[:2] < 1.0)
    assert errors["student"] < 0.3 * errors["gaussian"]
    assert errors["soft-l1"] < 0.7 * errors["gaussian"]


def test_sigmas_that_are_not_given_are_estimated_for_each_target(tmp_path, predicted):
    """In units of one target's scatter the other's is what was put in: 1 and 5 %, each
    to the accuracy of an estimate from 7 values, a factor of two."""
    random = np.random.default_rng(3)
    noise = random.normal(size=predicted.shape) * [0.01, 0.05, 0.01]
    path = write_study(tmp_path, STUDY + SLOPE, as_cells(predicted * (1.0 + noise)))
    objective, best = fitted(objective_of(path))
    scale = np.sqrt(np.mean(predicted**2, axis=0))
    part = objective.sigma[0] / scale
    assert np.all(part > 0.5 * np.array([0.01, 0.05, 0.01]))
    assert np.all(part < 2.0 * np.array([0.01, 0.05, 0.01]))
    # They are what they are estimated to be once more.
    u = (best.points.predicted[0] - objective.study.measured) / objective.sigma
    assert estimate(objective, best.points).reduced_chi_square == pytest.approx(
        np.sum(u**2) / estimate(objective, best.points).degrees_of_freedom
    )
    found = estimate(objective, best.points)
    assert found.reduced_chi_square == pytest.approx(1.0, rel=0.02)


def test_weights_multiply_losses_and_are_no_information(tmp_path, predicted):
    """Doubling every weight doubles the cost and leaves the covariance."""
    sigmas = "[default_sigma]\ne_n = 0.01\ne_t = 0.01\nmax_sinking_m = 0.01\n"
    doubled = "[weights]\ne_n = 2.0\ne_t = 2.0\nmax_sinking_m = 2.0\n"
    found = []
    for text in (STUDY + sigmas, STUDY + sigmas + doubled):
        objective = objective_of(write_study(tmp_path, text, as_cells(predicted)))
        points = objective(start_of(objective.study)[None])
        found.append((points.cost[0], estimate(objective, points)))
    (cost, once), (twice_cost, twice) = found
    assert twice_cost == pytest.approx(2.0 * cost)
    np.testing.assert_allclose(twice.covariance, once.covariance, rtol=1e-9)


def test_a_prior_on_a_parameter_counts_as_a_measurement(tmp_path, predicted):
    text = STUDY.replace(
        "upper = 10.0", "upper = 10.0, prior = { mean = 1.0, sd = 0.2 }"
    )
    objective = objective_of(write_study(tmp_path, text, as_cells(predicted)))
    without = objective_of(write_study(tmp_path, STUDY, as_cells(predicted)))
    x = objective.bounds.coordinate([1.3, 5.0])[None]
    more = objective(x).cost[0] - without(x).cost[0]
    assert more == pytest.approx(0.5 * (0.3 / 0.2) ** 2)


BAD = {
    "unknown nuisance": ("slope_deg]", "slop_deg]", ("nuisance.slop_deg", "slope_deg")),
    "unknown key": ("by =", "buy =", ("nuisance.slope_deg.buy", "by")),
    "unknown group": ('"campaign"', '"campain"', ("key nuisance.", ".by", "campaign")),
    "group without a column": ('"campaign"', '"test"', ("no column",)),
    "no prior": ("prior =", "# prior =", ("nuisance.slope_deg.prior", "missing")),
    "no mean": ("mean = 25.0, ", "", ("prior.mean", "missing")),
    "no spread": ("sd = 10.0", "sd = -1", ("prior.sd", "above 0")),
    "outside": ("mean = 25.0", "mean = 95.0", ("prior.mean", "(-90, 90)")),
    "missing file": ("south.csv", "soth.csv", ("soth.csv", "cannot be read")),
    "no file": ('["north.csv", "south.csv"]', "[]", ("key data",)),
}


@pytest.mark.parametrize(("old", "new", "parts"), BAD.values(), ids=BAD)
def test_bad_study_is_one_line(tmp_path, capsys, old, new, parts):
    text = STUDY + SLOPE
    assert old in text
    path = write_study(tmp_path, text.replace(old, new, 1))
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, str(tmp_path), *parts)


def test_a_measurement_without_sigma_among_others_is_named(tmp_path, capsys):
    path = write_study(tmp_path)
    (tmp_path / "north.csv").write_text("e_n,sigma_e_n\n0.1,0.01\n0.2,\n,\n")
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "north.csv", "row 3", "column e_n", "sigma_e_n")


def test_an_empty_group_is_named(tmp_path, capsys):
    text = STUDY + SLOPE.replace('"campaign"', '"test"')
    path = write_study(tmp_path, text)
    (tmp_path / "north.csv").write_text("test,e_n\na,0.1\n,0.2\n")
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "north.csv", "row 3", "column test", "is empty")

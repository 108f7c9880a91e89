"""Measurements as people have them: campaigns, gaps, limits, outliers, and quantities
that nobody measured."""

import csv
from types import SimpleNamespace

import numpy as np
import pytest
from calibration_studies import (
    fitted,
    objective_of,
    study_of_columns,
    write_study_of,
)
from scipy.integrate import quad
from scipy.stats import norm

from jaximpact import Soil
from jaximpact.calibration import fit_study, read_study
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.compare_laws import StackedPrediction
from jaximpact.calibration.diagnostics.further_tests import _common
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.problem.noise import (
    LOSSES,
    losses,
    scale_of_normal,
    true_curvature,
)
from jaximpact.calibration.problem.objective import names_of, start_of
from jaximpact.calibration.report.comparison import comparison_csv
from jaximpact.calibration.report.contents import (
    _fixed_quantities,
    about,
    left_out_table,
)
from jaximpact.calibration.report.files import fitted_table
from jaximpact.calibration.report.prediction import _test_table
from jaximpact.errors import InputError

U = np.linspace(-6.0, 6.0, 25)
TESTS = {
    "campaign": ["north"] * 4 + ["south"] * 3,
    "mass_kg": [100, 400, 800, 200, 300, 600, 150],
    "speed_mps": [8, 12, 10, 15, 10, 14, 9],
    "angle_deg": [40, 50, 30, 60, 45, 35, 55],
}
TARGETS = ("e_n", "e_t", "max_sinking_m")
PARAMETERS = {
    "c_v": {"start": 0.9, "lower": 0.1, "upper": 10.0},
    "gamma_v": {"start": 6.0, "lower": 0.5, "upper": 100.0},
}
SLOPE = {"slope_deg": {"by": "campaign", "prior": {"mean": 25.0, "sd": 10.0}}}
TRUE = [1.5, 4.0]
SLOPES = [30.0, 20.0]


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


def study(results, sigmas=None, **content):
    """A study of two campaigns, whose slopes nobody measured, with results
    (tests, targets)."""
    columns = TESTS | dict(zip(TARGETS, np.transpose(results), strict=True))
    if sigmas is not None:
        content["default_sigma"] = dict(zip(TARGETS, sigmas, strict=True))
    content = {"parameters": PARAMETERS, "nuisance": SLOPE} | content
    return study_of_columns(columns, **content)


@pytest.fixture(scope="module")
def predicted():
    """Targets of the true soil on the true slopes, `(tests, targets)`."""
    objective = objective_of(study(np.ones((7, 3))))
    return objective.values(objective.bounds.coordinate([TRUE + SLOPES])).predicted[0]


def test_campaigns_are_joined(tmp_path):
    """A file is a campaign, and a column that it lacks has its default."""
    (tmp_path / "north.csv").write_text("mass_kg,e_n\n100,0.1\n400,0.2\n")
    (tmp_path / "south.csv").write_text(
        "mass_kg,speed_mps,e_n,max_sinking_m\n300,12,,>0.5\n600,14,< 0.1,\n"
    )
    path = tmp_path / "study.toml"
    path.write_text(
        'data = ["north.csv", "south.csv"]\n[nuisance.slope_deg]\n'
        'by = "campaign"\nprior = { mean = 25.0, sd = 10.0 }\n'
    )
    joined = read_study(path)
    assert joined.tests.labels["campaign"] == ["north"] * 2 + ["south"] * 2
    assert names_of(joined)[-2:] == ["slope_deg[north]", "slope_deg[south]"]
    assert joined.tests.place(2) == (tmp_path / "south.csv", 2)
    np.testing.assert_array_equal(joined.tests.inputs["mass_kg"], [100, 400, 300, 600])
    np.testing.assert_array_equal(joined.tests.inputs["speed_mps"], [14, 14, 12, 14])
    assert joined.targets == ("e_n", "max_sinking_m")
    nan = np.nan
    np.testing.assert_array_equal(
        joined.measured, [[0.1, nan], [0.2, nan], [nan, 0.5], [0.1, nan]]
    )
    np.testing.assert_array_equal(joined.censored[2:], [[0, 1], [-1, 0]])


def comparison_rows(study):
    """Rows of comparison.csv for one law, all of whose predictions are 0."""
    numbers = np.zeros(study.measured.shape)
    left_out = SimpleNamespace(
        density=numbers[:, 0], predicted=numbers, deviation=numbers
    )
    law = SimpleNamespace(name="model", left_out=left_out)
    part = SimpleNamespace(study=study, laws=[law])
    text = comparison_csv(SimpleNamespace(parts=[part]))
    return list(csv.DictReader(text.splitlines()))


def test_files_of_one_name_are_told_apart(tmp_path):
    for folder, text in (("2019", "100,0.1\n400,0.2\n"), ("2023", "300,0.3\n")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "tests.csv").write_text("mass_kg,e_n\n" + text)
    path = tmp_path / "study.toml"
    path.write_text('data = ["2019/tests.csv", "2023/tests.csv"]\n')
    study = read_study(path)
    tests = study.tests
    assert tests.labels["campaign"] == ["2019/tests"] * 2 + ["2023/tests"]
    assert tests.described == "3 tests of 2019/tests.csv, 2023/tests.csv"
    names = ["2019/tests.csv", "2023/tests.csv"]
    assert [one["file"] for one in tests.checksums] == names
    numbers = np.zeros(study.measured.shape)
    variant = SimpleNamespace(
        variant=study.variants[0], sigma=numbers, predicted=numbers
    )
    bands = SimpleNamespace(
        **dict.fromkeys(("low", "high", "measured_low", "measured_high"), numbers)
    )
    found = SimpleNamespace(
        each=None, bands=bands, residuals=SimpleNamespace(values=numbers)
    )
    result = SimpleNamespace(study=study, variants=[variant])
    fitted_rows = fitted_table(result, [found]).frame()
    assert fitted_rows.file.tolist() == [names[0], names[0], names[1]]
    assert fitted_rows.row.tolist() == [2, 3, 2]
    assert tests.name(2) == "2023/tests row 2"
    # The table of a comparison is joined with it by file and row.
    compared = comparison_rows(study)
    assert [row["file"] for row in compared] == fitted_rows.file.tolist()
    assert [int(row["row"]) for row in compared] == [2, 3, 2]


def test_limits_are_marked_in_the_table_of_a_comparison():
    rows = comparison_rows(study_of_columns({"e_n": ["0.2", ">0.3", "<0.1"]}))
    assert [row["limit"] for row in rows] == ["", ">", "<"]
    assert [row["measured"] for row in rows] == ["0.2", "0.3", "0.1"]


def test_whole_numbers_with_and_without_a_point_are_one_group(tmp_path):
    """As programs write a column of numbers that has an empty cell; those of other
    digits, and names, stay as they are."""
    (tmp_path / "a.csv").write_text("campaign,id,e_n\n1,007,0.1\n2,7,0.2\n")
    (tmp_path / "b.csv").write_text("campaign,id,e_n\n1.0,1.1,0.3\n2.0,1.10,0.3\n")
    (tmp_path / "c.csv").write_text("campaign,id,e_n\n1.0,1.0,0.3\n,1.5,0.3\n")
    path = tmp_path / "study.toml"
    path.write_text(
        'data = ["a.csv", "b.csv", "c.csv"]\n[nuisance.slope_deg]\n'
        'by = "campaign"\nprior = { mean = 25.0, sd = 10.0 }\n'
    )
    study = read_study(path)
    assert study.nuisances[0].groups == ("1", "2", "c")
    assert study.nuisances[0].group.tolist() == [0, 1, 0, 1, 0, 2]
    assert study.tests.labels["id"] == ["007", "7", "1.1", "1.10", "1.0", "1.5"]


def test_tests_of_one_name_are_told_apart_in_tables():
    """Each in a line of its own, also where its name has several."""
    tests = {"name": ["007", "two\nlines", "007"], "e_n": [0.1, 0.2, 0.3]}
    known, numbers = study_of_columns(tests), np.ones((3, 1))
    left = SimpleNamespace(
        predicted=numbers, deviation=numbers, standardised=lambda measured: numbers
    )
    stacked = StackedPrediction(
        *(known.tests, known.targets, (), numbers), *[numbers] * 3
    )
    of_target = dict(measured=numbers, censored=np.zeros((3, 1)), targets=("e_n",))
    prediction = SimpleNamespace(tests=known.tests, **of_target)
    variant = SimpleNamespace(
        middle=numbers, low_95=numbers, high_95=numbers, outcomes=["detached"] * 3
    )
    for text in (
        left_out_table(known, left, "test").text(),
        _test_table(prediction, variant).text(),
        str(stacked).partition("\n")[2],
    ):
        rows = text.splitlines()[1:4]
        # The second row takes two lines of the file.
        names = ("007 (row 2)", "two lines", "007 (row 5)")
        for row, name in zip(rows, names, strict=True):
            assert row.startswith(f"  {name}  ")
    assert stacked.to_dataframe().test[0] == "007 (row 2)"


def test_files_that_differ_in_their_suffix_are_campaigns_of_their_own(tmp_path):
    for name in ("2019.csv", "2019.txt"):
        (tmp_path / name).write_text("mass_kg,e_n\n100,0.1\n")
    path = tmp_path / "study.toml"
    path.write_text('data = ["2019.csv", "2019.txt"]\n')
    assert read_study(path).tests.labels["campaign"] == ["2019.csv", "2019.txt"]


def test_a_nuisance_of_each_test_has_a_name_of_its_own():
    columns = {"test": ["a", "b", "a"], "mass_kg": [100, 200, 300], "e_n": [0.1] * 3}
    orientation = {"by": "row", "prior": {"mean": 40.0, "sd": 5.0}}
    joined = study_of_columns(columns, nuisance={"orientation_deg": orientation})
    assert [name.removeprefix("orientation_deg") for name in names_of(joined)[-3:]] == [
        *("[a (row 2)]", "[b]", "[a (row 4)]")
    ]


def test_limits_do_not_set_scale_and_kind_of_scatter():
    """A detection limit that is far above or below what was measured says nothing of
    how measurements scatter."""
    exact = study_of_columns({"angle_deg": 20.0, "e_n": [0.2, 0.3, 0.25]})
    for limit in ("<0.9", ">0.001"):
        e_n = ["0.2", "0.3", "0.25", limit]
        limited = study_of_columns({"angle_deg": 20.0, "e_n": e_n})
        assert limited.scatter_open == ()
        np.testing.assert_array_equal(limited.scale, exact.scale)
        np.testing.assert_array_equal(limited.sigma[:3], exact.sigma)
    alone = study_of_columns({"angle_deg": 20.0, "e_n": ["<0.3", "<0.4"]})
    np.testing.assert_allclose(alone.scale, np.sqrt(0.125))


def test_limits_in_the_file_of_a_curve_are_limits(tmp_path):
    """As those of a sensor that clips are."""
    curve = "time_s,normal_force_N\n0.001,2e4\n0.002,>4e4\n0.004,3e4\n"
    (tmp_path / "a.csv").write_text(curve)
    (tmp_path / "tests.csv").write_text("force_curve,speed_mps,e_n\na.csv,5,<0.3\n")
    study = read_study(tmp_path / "tests.csv")
    force = study.targets.index("normal_force_N")
    np.testing.assert_array_equal(study.censored[:, force], [0, 0, 1, 0])
    np.testing.assert_array_equal(study.censored[:, 1 - force], [-1, 0, 0, 0])
    # Its points are no tests in which something else was not measured.
    np.testing.assert_array_equal(study.comparable[:, force], [False, *[True] * 3])
    np.testing.assert_array_equal(study.comparable[:, 1 - force], [True, *[False] * 3])
    alone = study_given(tmp_path / "tests.csv", targets=["e_n"])
    np.testing.assert_array_equal(alone.comparable[:, 0], [True, False, False, False])


def test_a_point_of_a_curve_needs_its_time(tmp_path):
    (tmp_path / "a.csv").write_text("time_s,normal_force_N\n0.001,2e4\n,3e4\n")
    (tmp_path / "tests.csv").write_text("force_curve,speed_mps\na.csv,5\n")
    with pytest.raises(InputError, match=r"a\.csv, row 3, column time_s: is empty"):
        read_study(tmp_path / "tests.csv")


def test_what_stands_in_tables_and_curves_twice_is_told(tmp_path):
    """A repeated test has its curve again, of which nothing is said."""
    curve = "time_s,normal_force_N\n0.01,3e4\n0.02,0\n0.02,0\n0.03,0\n"
    (tmp_path / "curve.csv").write_text(curve)
    (tmp_path / "once.csv").write_text(curve.replace("0.02,0\n0.02,0", "0.02,0"))

    def told(*curves):
        rows = [["a", 100.0, name] for name in curves]
        columns = ["name", "mass_kg", "force_curve"]
        study = write_study_of(tmp_path, 'data = "tests.csv"', columns, rows)
        return read_study(study).tests.repeated_in_words()

    twice = "If they stand there twice by mistake, standard errors are too small."
    assert told("once.csv") == []
    of_curve = "Points of curves that are the same as another: 1, the first of them"
    assert told("curve.csv") == [f"{of_curve} at 0.02 s in curve.csv. {twice}"]
    of_test = "Tests that are the same as another in every column: 2, the first of them"
    assert told(*["once.csv"] * 3) == [f"{of_test} row 3 as row 2. {twice}"]
    assert len(told("curve.csv", "curve.csv")) == 2


def test_the_copy_of_a_table_is_told(tmp_path):
    """Though its name is that of a campaign. The same numbers in two campaigns that the
    tables state are no copy."""
    path = tmp_path / "study.toml"
    path.write_text('data = ["a.csv", "a_copy.csv"]\n')

    def told(campaign, of_copy):
        for name, stated in (("a", campaign), ("a_copy", of_copy)):
            rows = f"{stated},100,0.1\n{stated},400,0.2\n"
            (tmp_path / f"{name}.csv").write_text("campaign,mass_kg,e_n\n" + rows)
        return read_study(path).tests.repeated_in_words()

    for campaign in ("", "north"):
        (line,) = told(campaign, campaign)
        assert "column: 2, the first of them a_copy row 2 as a row 2." in line
    assert told("north", "south") == []


def test_the_middle_of_the_tests_has_a_curve_once(tmp_path):
    """Where further tests are looked for, however many points it has."""
    curve = "".join(f"{0.001 * k},{1e3 * k}\n" for k in range(1, 40))
    (tmp_path / "a.csv").write_text(f"time_s,normal_force_N\n{curve}")
    rows = "a.csv,900,\n,100,0.2\n,200,0.3\n"
    (tmp_path / "tests.csv").write_text(f"force_curve,mass_kg,e_n\n{rows}")
    study = read_study(tmp_path / "tests.csv")
    objective = objective_of(study)
    fitted = SimpleNamespace(
        objective=objective, variant=study.variants[0], parameters=np.ones(9)
    )
    assert _common(fitted)["mass_kg"] == 200.0


def test_a_parameter_that_follows_others_has_no_start_of_the_ground():
    tests = {"mass_kg": [1.0, 2.0], "e_n": [0.1, 0.2]}
    fit = {"gamma_v": {}, "k_E": {"expression": "100 * gamma_v"}}
    study = study_given(tests, fit=fit, ground=Soil(k_E=300.0, gamma_v=5.0))
    assert [tied.name for tied in study.tied] == ["k_E"]
    assert study.parameters[0].start == 5.0


def test_the_ground_of_the_table_is_in_the_head():
    tests = {"speed_mps": [5.0, 9.0], "e_n": [0.1, 0.2], "psi": 0.5}
    study = study_of_columns(tests | {"dilatancy": [0.0, 1.0]}, soil={"beta": 0.8})
    told = _fixed_quantities(study)
    assert "Table 1 but for beta 0.8, psi 0.5, dilatancy 0 to 1." in told
    told = _fixed_quantities(study_of_columns(tests, soil={"dilatancy": 1e-9}))
    assert "Table 1 but for dilatancy 1e-09, psi 0.5." in told


@pytest.mark.slow
def test_twin_of_two_slopes_that_nobody_measured(predicted):
    """Soil and both slopes from noise-free targets. The prior, one of 10 degrees about
    25, pulls by what its information is against that of the data."""
    result = fit_study(study(predicted, (1e-5, 1e-5, 1e-5), starts=16)).variants[0]
    assert result.reason.at_minimum
    found = result.parameters
    np.testing.assert_allclose(found[:2], TRUE, rtol=1e-4)
    np.testing.assert_allclose(found[2:], SLOPES, atol=1e-2)
    assert [verdict.determined for verdict in result.verdicts] == [True, True]


def test_robust_losses_put_up_with_an_outlier(predicted):
    noise = 1.0 + 0.01 * np.random.default_rng(1).normal(size=predicted.shape)
    noise[2, 0] = 1.25
    errors = {}
    for loss in LOSSES:
        outlying = study(predicted * noise, (2e-3, 7e-3, 1e-3), loss=loss)
        objective, best = fitted(objective_of(outlying))
        assert best.reasons[0].at_minimum
        x, true = best.points.x[0, :2], objective.bounds.coordinate([*TRUE, 0.0, 0.0])
        errors[loss] = np.max(np.abs(x - true[:2]))
        found = estimate(objective, best.points)
        assert np.all(np.isfinite(found.standard_errors))
        assert np.all(found.standard_errors[:2] < 1.0)
    assert errors["student"] < 0.3 * errors["gaussian"]
    assert errors["soft-l1"] < 0.7 * errors["gaussian"]


def test_sigmas_that_are_not_given_are_estimated_for_each_target(predicted):
    """In units of one target's scatter the other's is what was put in: 1 and 5 %, each
    to the accuracy of an estimate from 7 values, a factor of two."""
    random = np.random.default_rng(3)
    noise = random.normal(size=predicted.shape) * [0.01, 0.05, 0.01]
    objective, best = fitted(objective_of(study(predicted * (1.0 + noise))))
    scale = np.sqrt(np.mean(predicted**2, axis=0))
    part = objective.sigma[0] / scale
    assert np.all(part > 0.5 * np.array([0.01, 0.05, 0.01]))
    assert np.all(part < 2.0 * np.array([0.01, 0.05, 0.01]))
    # They are what they are estimated to be once more.
    found = estimate(objective, best.points)
    u = (best.points.predicted[0] - objective.study.measured) / objective.sigma
    expected = np.sum(u**2) / found.degrees_of_freedom
    assert found.reduced_chi_square == pytest.approx(expected)
    assert found.reduced_chi_square == pytest.approx(1.0, rel=0.02)


def test_weights_multiply_losses_and_are_no_information(predicted):
    """Doubling every weight doubles the cost and leaves the covariance."""
    found, doubled = [], dict.fromkeys(TARGETS, 2.0)
    for weights in ({}, {"weights": doubled}):
        # Without priors, which have no weight.
        weighted = study(predicted, (0.01, 0.01, 0.01), nuisance={}, **weights)
        objective = objective_of(weighted)
        points = objective(start_of(objective.study)[None])
        found.append((points.cost[0], estimate(objective, points)))
    (cost, once), (twice_cost, twice) = found
    assert twice_cost == pytest.approx(2.0 * cost)
    np.testing.assert_allclose(twice.covariance, once.covariance, rtol=1e-9)

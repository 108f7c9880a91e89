"""Calibration in one call, from a path or columns, and predictions with its result."""

import copy
import dataclasses
import json
import pickle

import numpy as np
import pytest
from calibrated_twin import TRUE, results_of_model
from calibration_studies import write_study_of
from error_messages import assert_one_line_error
from matplotlib import pyplot
from text_files import rows_of, write_columns

import jaximpact
from jaximpact import (
    PRESETS,
    Block,
    Impact,
    Scene,
    Soil,
    calibrate,
    predict,
    simulate_batch,
)
from jaximpact.calibration import read_study
from jaximpact.calibration.api import ground_of
from jaximpact.calibration.arguments import study_given, table_given
from jaximpact.calibration.prediction import held_out_study, predict_variant
from jaximpact.calibration.problem.dataset import joined_tables
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective
from jaximpact.calibration.report.frames import dataset_of
from jaximpact.cli import main
from jaximpact.errors import InputError

pytestmark = pytest.mark.slow

# Vertical, since the drops of the twin tell nothing of friction; "steep" is only a
# warning.
NEW = {
    "name": ["near", "steep", "fast", "gap"],
    "mass_kg": [150.0, 400.0, 900.0, 600.0],
    "speed_mps": [10.0, 14.0, 40.0, 18.0],
    "angle_deg": [0.0, 75.0, 0.0, 0.0],
}


@pytest.fixture(scope="module")
def found(twin):
    return twin.found


@pytest.fixture(scope="module")
def new():
    return NEW | results_of_model(NEW)


def test_a_fit_is_pickled_and_copied(found, new):
    for again in (pickle.loads(pickle.dumps(found)), copy.deepcopy(found)):
        assert str(again) == str(found)
        assert float(again.soil.c_v) == float(found.soil.c_v)
    predicted = predict(found, new)
    assert str(pickle.loads(pickle.dumps(predicted))) == str(predicted)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Where the command line wrote the fit of two drops with one number each."""
    folder = tmp_path_factory.mktemp("drops")
    columns = "mass_kg", "speed_mps", "e_n", "sigma_e_n"
    rows = (100, 6, 0.15, 0.02), (500, 15, 0.13, 0.02)
    path = write_study_of(folder, 'data = "tests.csv"\nstarts = 4\n', columns, rows)
    assert main(["calibrate", str(path), "--out", str(folder / "out")]) == 0
    return folder / "out"


def test_the_soil_is_found_and_ready(found):
    """From noise-free targets, to the accuracy of the impacts."""
    for name, true in TRUE.items():
        assert float(getattr(found.soil, name)) == pytest.approx(true, rel=1e-4)
        assert found.parameters[name]["determined"]
        low, high = found.parameters[name]["interval_95"]
        assert low < true < high
    assert float(found.soil.dilatancy) == 0.5
    assert float(found.soil.friction_angle) == pytest.approx(
        float(Soil().friction_angle)
    )


def test_cohesion_is_fitted_where_it_is_asked_for():
    """Drops of many sizes, of exact numbers: what does not grow with the depth is told
    from what does. Neither bounds nor a start are given."""
    draw = np.random.default_rng(1).uniform
    mass, speed = np.exp(draw(0.0, np.log(2e3), 16)), draw(3.0, 20.0, 16)
    truth = Soil(c_v=0.6, gamma_v=4.0, k_E=400.0, cohesion=30e3)
    drops = Scene(Block(mass=mass), truth, Impact(speed=speed))
    of_truth = simulate_batch(drops)
    tests = {
        "mass_kg": mass,
        "speed_mps": speed,
        "e_n": of_truth.e_n,
        "max_penetration_m": of_truth.max_penetration,
        "max_normal_force_N": of_truth.max_normal_force,
    }
    asked = ("c_v", "gamma_v", "k_E", "cohesion_kPa")
    fitted = calibrate(tests, fit=asked)
    assert float(fitted.soil.cohesion) == pytest.approx(30e3, rel=0.01)
    assert "cohesion_kPa = 30 " in str(fitted)
    usual = [one.name for one in study_given(tests).parameters]
    assert "cohesion_kPa" not in usual


def test_a_summary_at_a_glance(found):
    text = str(found)
    for words in (
        *("6 tests of tests.csv", "e_n, max_penetration_m", "dilatancy 0.5"),
        *("aspect_ratio 1", "standard error", "c_v, gamma_v", "(given)"),
        *("The tests identify c_v", "members of the search agree"),
    ):
        assert words in text
    assert max(map(len, text.splitlines())) <= 100
    assert repr(found).startswith("<Calibration: 6 tests of tests.csv\n")


def test_a_summary_says_what_is_not_determined(written):
    """The same words as in the report: bounds that are hit, and no error bars."""
    found = calibrate(written.parent / "study.toml")
    assert not any(one["determined"] for one in found.parameters.values())
    assert "not identifiable" in str(found)
    assert "No parameter is identifiable by itself" in str(found)
    assert "Warnings" in str(found)
    assert "Warnings" in (written / "report.html").read_text()
    # The command line's numbers are these: there is no second way.
    tree = json.loads((written / "fit.json").read_text())
    assert tree["variants"][0]["parameters"] == found.parameters


@pytest.mark.parametrize("layout", [None, "constrained"])
def test_plots_are_axes_and_files(found, tmp_path, layout):
    path = tmp_path / "fit.png"
    drawn = found.plot(path)
    assert path.stat().st_size > 1000
    figure, axes = pyplot.subplots(2, 2, layout=layout)
    targets = found.result.study.targets
    assert len(np.ravel(drawn)) == len(targets)
    axes[1, 1].plot([0.0, 1.0], label="a line of the user's")
    found.plot_residuals("speed_mps", ax=axes[0, 1])
    assert axes[0, 1].get_xlabel() == "speed [m/s]"
    words = axes[0, 1].get_legend().get_texts()
    assert [text.get_text() for text in words] == [*targets]
    assert axes[0, 0].get_legend() is axes[1, 1].get_legend() is None
    assert found.plot_profile("c_v", ax=axes[0, 0]) is axes[0, 0]
    assert axes[0, 0].get_xlabel() == "c_v"
    found.plot_draws("c_v", "gamma_v", ax=axes[1, 0])
    assert axes[1, 0].get_ylabel() == "gamma_v [m/s]"
    pyplot.close(figure)
    with pytest.raises(InputError, match="did you mean c_v"):
        found.plot_profile("c_w")
    with pytest.raises(
        InputError, match="must be one of prediction, mass_kg, speed_mps"
    ):
        found.plot_residuals("c_w")


def test_tables_of_a_fit(found):
    """They hold the numbers of the result, under the names of the reports."""
    (variant,), parameters = found.result.variants, found.to_dataframe()
    for name, one in found.parameters.items():
        row = parameters.loc[name]
        assert (row.value, row.identifiable) == (one["value"], one["determined"])
        error = np.nan if one["standard_error"] is None else one["standard_error"]
        assert row.standard_error == pytest.approx(error, nan_ok=True)
    assert parameters.unit["gamma_v"] == "m/s"
    errors = np.sqrt(np.diag(found.to_dataframe("covariance")))
    expected = [variant.standard_error(place) for place in range(len(errors))]
    np.testing.assert_allclose(errors, expected)
    draws = found.to_dataframe("draws")
    assert draws.weight.sum() == pytest.approx(1.0)
    assert list(draws) == [*variant.names, "weight"]
    profile = found.to_dataframe("profiles").groupby("parameter").get_group("c_v")
    assert profile.likelihood_ratio.min() == pytest.approx(0.0, abs=1e-3)
    residuals = found.to_dataframe("residuals")
    np.testing.assert_allclose(
        residuals.fitted - residuals.measured, residuals.residual, atol=1e-15
    )
    dataset = found.to_xarray()
    np.testing.assert_array_equal(dataset.fitted, variant.predicted)
    np.testing.assert_array_equal(dataset.draws.sel(parameter="c_v"), draws["c_v"])
    of_soil = dataset.sel(parameter=list(parameters.index))
    for name in ("low_95", "high_95", "identifiable", "reason"):
        np.testing.assert_array_equal(of_soil[name], parameters[name])
    correlation = found.to_dataframe("correlation")
    np.testing.assert_array_equal(dataset.correlation, correlation)
    # With every estimated sigma uncertain, as in fit.json, which has six digits of them
    weights = found.as_json()["variants"][0]["draws"]["weights"]
    for same in (draws["weight"], dataset.weight):
        np.testing.assert_allclose(same, weights, rtol=1e-5)
    with pytest.raises(InputError, match="did you mean parameters"):
        found.to_dataframe("parameter")


def test_limits_are_marked_in_the_dataset_of_a_fit(found):
    result, variant, examined = found._fit(None)
    censored = np.zeros(result.study.measured.shape, int)
    censored[:2, 0] = 1, -1
    study = dataclasses.replace(result.study, censored=censored)
    dataset = dataset_of((result._replace(study=study), variant, examined))
    assert dataset.limit.sel(target="e_n").values.tolist() == [">", "<", *[""] * 4]


def test_columns_are_read_as_their_table_is(tmp_path, twin):
    """Same study from a path and from columns; a data frame needs no `keys`."""

    class Frame:
        columns = tuple(twin.tests)

        def __getitem__(self, name):
            return np.array(twin.tests[name])

    path = write_columns(tmp_path / "tests.csv", twin.tests)
    of_path = read_study(path)
    for given in (twin.tests, Frame(), path):
        study = study_given(given)
        np.testing.assert_array_equal(study.measured, of_path.measured)
        assert study.parameters == of_path.parameters
        assert study.targets == of_path.targets
        for name, values in of_path.tests.inputs.items():
            np.testing.assert_array_equal(study.tests.inputs[name], values)


def test_cells_of_columns():
    table = table_given(
        {
            "mass_kg": 500,
            "campaign": ["a", "a", "b", "b"],
            "e_n": [0.25, None, float("nan"), ">0.3"],
        }
    )
    np.testing.assert_array_equal(table.numbers["mass_kg"], [500.0] * 4)
    np.testing.assert_array_equal(table.numbers["e_n"], [0.25, np.nan, np.nan, 0.3])
    np.testing.assert_array_equal(table.censored["e_n"], [0, 0, 0, 1])
    assert table.labels["campaign"] == ["a", "a", "b", "b"]


def test_a_soil_as_ground(twin):
    """Fitted parameters start at its values; columns of the table come first."""
    soil = Soil(c_v=3.0, beta=0.8, friction_angle=np.deg2rad(35.0))
    given = twin.tests | {"friction_angle_deg": 33.0}
    study = study_given(given, ("c_v",), soil, targets=["e_n"], seed=5)
    assert study.parameters[0].start == pytest.approx(3.0)
    assert study.soil["beta"] == pytest.approx(0.8)
    assert "friction_angle_deg" not in study.soil
    assert (study.targets, study.seed) == (("e_n",), 5)


def test_a_soil_that_differs_from_test_to_test(found):
    with pytest.raises(InputError, match="variant 'dense' is unknown"):
        found.soil_of("dense")
    with pytest.raises(AttributeError, match="calibrat"):
        jaximpact.calibrat  # noqa: B018


def test_new_tests_are_predicted(found, new):
    """A fit without noise predicts what the model gives; friction, which it does not
    know, matters in the steep one alone."""
    with np.errstate(all="raise"):
        prediction = predict(found, new)
        text = str(prediction)
    variant, drops = prediction.variants[0], [0, 2, 3]
    for place, target in enumerate(("e_n", "max_penetration_m")):
        expected = np.array(new[target])[drops]
        np.testing.assert_allclose(variant.best[drops, place], expected, atol=2e-4)
        # A third of the scatter of the drops, beyond whose speeds "fast" is.
        np.testing.assert_allclose(variant.middle[drops, place], expected, atol=3e-3)
    assert np.all(variant.low_95 < variant.low_50)
    assert np.all(variant.high_50 < variant.high_95)
    width = variant.model_high - variant.model_low
    assert np.all(width[1, 0] > 2.0 * width[drops, 0])
    assert "speed_mps 40 (fitted: 6 to 25) in fast." in text
    assert "angle_deg 75 (fitted: 0 alone) in steep." in text
    assert "near" not in text.split("\n\n")[0]
    assert "8 of 8 measurements lie within their 95 % intervals" in text
    dataset = prediction.to_xarray().isel(variant=0).sel(target="max_penetration_m")
    np.testing.assert_array_equal(dataset.predicted, variant.middle[:, 1])
    assert dataset.name.values.tolist() == new["name"]
    assert str(dataset.unit.values) == "m"
    figure, axes = pyplot.subplots(1, 2)
    assert prediction.plot(ax=axes) is axes
    medians = next(line for line in axes[1].lines if line.get_label() == "median")
    np.testing.assert_array_equal(medians.get_ydata(), variant.middle[:, 1])
    pyplot.close(figure)


def test_limits_and_gaps_are_respected(found, new):
    """An empty cell is in no score, a limit in none but its own, and a table without
    results has no scores."""
    e_n = new["e_n"]
    cells = [f">{e_n[0] - 0.1}", e_n[1], f">{e_n[2] + 0.1}", None]
    prediction = predict(found, new | {"e_n": cells})
    variant = prediction.variants[0]
    np.testing.assert_allclose(variant.limit_chance[[0, 2], 0], [1.0, 0.0], atol=1e-3)
    assert np.isfinite(variant.crps[:, 0]).tolist() == [False, True, False, False]
    assert np.all(np.isfinite(variant.middle))
    assert "Of 2 limits of e_n 1 are expected to be satisfied" in str(prediction)
    bare = predict(found, NEW)
    np.testing.assert_array_equal(bare.variants[0].middle, variant.middle)
    assert "Scores" not in str(bare)


def test_draws_are_predicted_as_exactly_as_they_were_drawn(found):
    """One draw alone: what the model gives for it at the accuracy of the draws."""
    ground = ground_of(found)
    study = held_out_study(ground, joined_tables((table_given(NEW),)))
    (fitted,) = ground.variants
    alone = fitted._replace(draws=fitted.draws[:1], weights=np.ones(1))
    model = models_of(study)[0]
    low = {}
    for name in ("fast", "balanced"):
        of_one = alone._replace(accuracy=PRESETS[name])
        low[name] = predict_variant(study, ground, of_one, model).model_low
    objective = Objective(study, fitted.variant, model, PRESETS["balanced"])
    x = objective.bounds.coordinate(fitted.draws[:1])
    exact = objective.values(x).predicted[0]
    np.testing.assert_array_equal(low["balanced"], exact)
    assert not np.array_equal(low["fast"], exact)


def test_many_tests_are_predicted_some_draws_at_a_time(found, monkeypatch):
    """With the same numbers, and a line of progress for each."""
    whole, lines = predict(found, NEW).variants[0], []
    monkeypatch.setattr("jaximpact.calibration.problem.objective.AT_ONCE", 400)
    parts = predict(found, NEW, progress=lines.append).variants[0]
    np.testing.assert_array_equal(parts.low_95, whole.low_95)
    np.testing.assert_array_equal(parts.outcome_share, whole.outcome_share)
    assert any(line.startswith("variant 1 of 1: 300 of ") for line in lines)
    assert "variant 1 of 1: intervals of 3 of 4 tests" in lines


def test_a_result_that_was_not_fitted(found, new):
    """It is predicted too; its scatter is nobody's statement."""
    prediction = predict(found, NEW | {"duration_s": [0.05, None, None, None]})
    assert prediction.targets[-1] == "duration_s"
    assert "The scatter of duration_s is unknown" in str(prediction)


def test_what_is_not_determined_widens_the_intervals(written, tmp_path, capsys):
    """Two numbers do not tell three parameters: the draws go as far as the bounds, and
    with them the depth that is predicted."""
    tests = {"mass_kg": [300], "speed_mps": [10], "max_penetration_m": [0.2]}
    path = write_columns(tmp_path / "new.csv", tests)
    out = tmp_path / "predicted.csv"
    assert main(["predict", str(written), str(path), "--out", str(out)]) == 0
    text = capsys.readouterr().out
    for name in ("c_v", "gamma_v", "k_E"):
        assert f"{name} was not identifiable" in text
    rows = {row["target"]: row for row in rows_of(out)}
    low, high = (
        float(rows["max_penetration_m"][n]) for n in ("model_low", "model_high")
    )
    # The fits at the ends of every profile that fit as well: depth by a factor of 2.
    assert high > 2.0 * low
    tree = json.loads((tmp_path / "predicted.csv.manifest.json").read_text())
    assert tree["variants"][0]["undetermined"] == ["c_v", "gamma_v", "k_E"]
    assert tree["variants"][0]["accuracy_of_draws"] == "balanced"
    assert tree["manifest"]["tests"][0]["file"] == "new.csv"


def test_bad_predictions_are_one_line(written, tmp_path, capsys):
    path = write_columns(tmp_path / "new.csv", {"mass_kg": [300], "c_v": [1.0]})
    assert main(["predict", str(written), str(path)]) == 2
    assert_one_line_error(capsys, "new.csv", "column c_v", "was fitted")
    assert main(["predict", str(tmp_path), str(path)]) == 2
    assert_one_line_error(capsys, "fit.json", "cannot be read")
    assert main(["predict", str(path), str(path)]) == 2
    assert_one_line_error(capsys, "new.csv", "is no JSON")
    tree = json.loads((written / "fit.json").read_text())
    del tree["fitted_tests"]
    (tmp_path / "fit.json").write_text(json.dumps(tree))
    assert main(["predict", str(tmp_path), str(path)]) == 2
    assert_one_line_error(capsys, "fit.json", "calibrate again")

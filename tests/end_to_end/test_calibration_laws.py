"""Calibration with laws of the user's own and with other shapes: fitted, predicted,
kept and refused."""

import dataclasses
import json

import numpy as np
import pytest
from calibrated_twin import results_of_model
from calibration_studies import objective_of, write_study_of
from error_messages import assert_one_line_error
from text_files import write_columns

from jaximpact import Outcome, Soil, calibrate, predict
from jaximpact.calibration import read_study, suggest_tests
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.fitted_ground import read_fitted
from jaximpact.calibration.problem.objective import start_of
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.laws import Perzyna, PowerNucleus
from jaximpact.shapes import EllipticCylinder, RectangularPrism

pytestmark = pytest.mark.slow

LAWS = '''\
"""A flow that saturates."""

from jaximpact.laws import AbstractFlow, displacement_rates, overstress, parameter


class Saturating(AbstractFlow):
    my_rate: object = parameter(4.0, "m/s", "(0, inf)", "fluidity")
    my_limit: object = parameter(0.1, "-", "[0, 10]", "saturation")

    def __call__(self, load, hardening, foundation, *, branch=None):
        over = overstress(load.size, hardening, branch=branch)
        rate = self.my_rate * over / (1.0 + self.my_limit * over)
        return displacement_rates(rate, load, 0.0, branch=branch)


'''
TRUE = {"my_rate": 6.0, "my_limit": 0.3, "c_v": 1.5}
SIGMA = {"e_n": 2e-3, "max_penetration_m": 1e-3}
FITTED = {
    "mass_kg": [100.0, 500.0, 50.0, 2000.0, 300.0, 800.0, 150.0, 400.0],
    "speed_mps": [6.0, 15.0, 25.0, 10.0, 12.0, 20.0, 9.0, 18.0],
    "angle_deg": [8.0, 20.0, 40.0, 60.0, 30.0, 10.0, 50.0, 5.0],
    "aspect_ratio": [1.2] * 8,
}
"""All by the planar model alone, so that no other is compiled."""
NEW = {
    "mass_kg": [200.0, 600.0],
    "speed_mps": [8.0, 16.0],
    "angle_deg": [15.0, 35.0],
    "aspect_ratio": [1.2, 1.2],
}
FEW = {name: values[:3] for name, values in FITTED.items()}
TESTS = FEW | dict.fromkeys(SIGMA, [0.2] * 3)
STUDY = """\
data = "tests.csv"
starts = 4
[soil]
flow = "my_laws.py:Saturating"
[parameters]
my_rate = { start = 3.0, lower = 0.5, upper = 50.0 }
my_limit = { start = 0.1, lower = 0.01, upper = 5.0 }
c_v = {}
[default_sigma]
e_n = 0.002
max_penetration_m = 0.001
"""


def write_laws(folder, text=LAWS):
    (folder / "my_laws.py").write_text(text)
    return f"{folder / 'my_laws.py'}:Saturating"


def study_in(folder, text, **columns):
    """A study of few tests beside the law."""
    write_laws(folder)
    return read_study(write_study_of(folder, text, TESTS | columns))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A law, tests that it made with noise of known sigmas, and a study of them."""
    folder = tmp_path_factory.mktemp("own")
    soil = Soil(flow=write_laws(folder), **TRUE)
    results = results_of_model(FITTED, soil)
    noise = np.random.default_rng(0).normal(size=(8, 2)).T
    for each, (name, sigma) in zip(noise, SIGMA.items(), strict=True):
        results[name] = np.array(results[name]) + sigma * each
    write_study_of(folder, STUDY, FITTED | results)
    write_columns(folder / "new.csv", NEW | results_of_model(NEW, soil))
    return folder


@pytest.fixture(scope="module")
def found(folder):
    return calibrate(folder / "study.toml", out=folder / "out")


@pytest.fixture(scope="module")
def written(found, folder):
    """Where the files of the fit are."""
    return folder / "out"


def test_parameters_of_a_law_are_found_again(found):
    """From tests with noise: the truth lies in the intervals, and the ground that is
    given back has the law and the values."""
    for name, true in TRUE.items():
        one = found.parameters[name]
        assert one["determined"]
        assert one["interval_95"][0] < true < one["interval_95"][1]
        assert one["value"] == pytest.approx(true, rel=0.2)
        assert float(getattr(found.soil, name)) == pytest.approx(one["value"])
    assert type(found.soil.flow).__name__ == "Saturating"
    assert "Table 1 but for flow Saturating" in " ".join(str(found).split())


def test_a_call_says_the_same(folder, found):
    """As a study file, with the law in a soil."""
    wanted = {
        "my_rate": {"start": 3.0, "lower": 0.5, "upper": 50.0},
        "my_limit": {"start": 0.1, "lower": 0.01, "upper": 5.0},
        "c_v": {},
    }
    ground = Soil(flow=f"{folder / 'my_laws.py'}:Saturating")
    of_call = study_given(folder / "tests.csv", wanted, ground, sigma=SIGMA)
    of_file = found.result.study
    assert [p.name for p in of_call.parameters] == list(TRUE)
    points = [
        objective_of(each)(start_of(of_file)[None]) for each in (of_call, of_file)
    ]
    np.testing.assert_array_equal(points[0].predicted, points[1].predicted)
    assert points[0].cost == points[1].cost


def test_the_law_stands_in_the_files(written):
    tree = json.loads((written / "fit.json").read_text())
    assert "my_laws.Saturating" in (written / "report.html").read_text()
    assert tree["manifest"]["laws"]["flow"].startswith("my_laws.Saturating (")
    assert tree["manifest"]["parts"]["flow"]["name"].endswith("my_laws.py:Saturating")


def test_a_fitted_ground_is_read_with_its_laws(written):
    ground = read_fitted(written)
    assert type(ground.parts["flow"]).__name__ == "Saturating"
    assert [p.name for p in ground.parameters] == list(TRUE)
    assert set(TRUE) <= set(ground.ranges)


def test_tests_are_predicted_with_the_law(folder, found, written):
    """By the result as by its files, within their small intervals."""
    of_call, of_files = (predict(fit, folder / "new.csv") for fit in (found, written))
    for prediction in (of_call, of_files):
        (variant,) = prediction.variants
        np.testing.assert_allclose(variant.middle, prediction.measured, atol=4e-3)
        assert np.all(variant.low_95 < prediction.measured)
        assert np.all(prediction.measured < variant.high_95)
    manifest = json.loads((written / "fit.json").read_text())["manifest"]
    write = folder / "predicted.csv"
    of_files.write(write)
    beside = json.loads((folder / "predicted.csv.manifest.json").read_text())
    assert beside["manifest"]["laws"] == manifest["laws"]


def test_a_shape_and_a_law_that_were_not_fitted_are_told(twin, found):
    block = {"shape": "RectangularPrism", "corner_radius_ratio": [0.3]}
    tests = {"mass_kg": [200.0], "speed_mps": [8.0]}
    text = str(predict(twin.found, tests | block))
    assert "No fitted test has a block of the shape RectangularPrism." in text
    assert "Outside" not in text
    with pytest.raises(InputError, match="column flow: is Perzyna, but the fit was"):
        predict(found, tests | {"flow": "Perzyna"})


def test_a_law_that_was_edited_is_another(tmp_path, written, folder, capsys):
    """A fit is not predicted with it; where it is gone, the copy beside the fit is."""
    tree = (written / "fit.json").read_text()
    moved = tree.replace(str(folder / "my_laws.py"), str(tmp_path / "gone.py"))
    (tmp_path / "fit.json").write_text(moved)
    arguments = ["predict", str(tmp_path), str(folder / "new.csv")]
    assert main(arguments) == 2
    assert_one_line_error(capsys, "fit.json", "flow that is not there", "gone.py")
    (tmp_path / "gone.py").write_text(LAWS)
    assert main(arguments) == 0
    capsys.readouterr()
    (tmp_path / "gone.py").write_text(LAWS.replace("1.0 + ", "1.1 + "))
    assert main(arguments) == 2
    assert_one_line_error(capsys, "fit.json", "changed since", "calibrate again")


def of_variant(study, variant, values):
    """The objective of a variant, and x of values of its unknowns."""
    objective = objective_of(dataclasses.replace(study, variants=(variant,)))
    return objective, objective.bounds.coordinate(np.array([values], float))


def assert_predicts(study, variant, expected, rtol=1e-6):
    """At c_v = 2."""
    objective, x = of_variant(study, variant, [2.0])
    found = objective.values(x).predicted[0].T
    np.testing.assert_allclose(found, [*expected.values()], rtol=rtol)


def test_variants_with_other_laws(tmp_path):
    """Each is computed with its own, and what it does not have does not count."""
    text = """\
data = "tests.csv"
[soil]
flow = "PowerNucleus"
nucleus_exponent = 1.5
[parameters]
c_v = {}
[[variants]]
[[variants]]
flow = "Perzyna"
gamma_v = 4.0
"""
    study = study_in(tmp_path, text)
    flows = PowerNucleus(nucleus_exponent=1.5), Perzyna(gamma_v=4.0)
    for variant, flow in zip(study.variants, flows, strict=True):
        expected = results_of_model(FEW, Soil(flow=flow, c_v=2.0))
        assert_predicts(study, variant, expected)
    assert study.variants[1].name == "flow Perzyna, gamma_v 4.0"


def test_a_nuisance_and_a_column_of_a_law(folder, tmp_path):
    """A value a campaign of one parameter, a value a test of the other. Of the law of
    the fit above, whose machine code is there."""
    text = f"""\
data = "tests.csv"
[soil]
flow = '{folder / "my_laws.py"}:Saturating'
[parameters]
c_v = {{}}
[nuisance.my_limit]
by = "campaign"
prior = {{ mean = 0.3, sd = 0.05 }}
"""
    rates = [3.0, 5.0, 8.0]
    study = study_in(tmp_path, text, my_rate=rates, campaign=["a", "b", "a"])
    objective, x = of_variant(study, study.variants[0], [2.0, 0.2, 0.4])
    points = objective(x)
    assert objective.model.engine == "machine code"
    law = type(study.tests.base.soil.flow)
    flow = law(my_rate=np.array(rates), my_limit=np.array([0.2, 0.4, 0.2]))
    expected = results_of_model(FEW, Soil(flow=flow, c_v=2.0))
    np.testing.assert_allclose(points.predicted[0].T, [*expected.values()], rtol=1e-6)
    step = 1e-4 * np.eye(3)[[1]]
    ahead, back = (objective.values(x + s).predicted[0] for s in (step, -step))
    slope = (ahead - back) / 2e-4
    np.testing.assert_allclose(points.jacobian[0, :, :, 1], slope, rtol=1e-2)


def test_shapes_of_tests(tmp_path):
    """A column of shapes, and one shape for all of them."""
    prism = RectangularPrism(corner_radius_ratio=0.4, aspect_ratio=1.5)
    text = 'data = "tests.csv"\n[parameters]\nc_v = {}\n'
    study = study_in(
        tmp_path,
        text,
        shape=["RectangularPrism", "RectangularPrism", "EllipticCylinder"],
        corner_radius_ratio=[0.4, 0.4, ""],
        aspect_ratio=[1.5, 1.5, 1.2],
    )
    soil, cylinder = Soil(c_v=2.0), EllipticCylinder(aspect_ratio=1.2)
    prisms = results_of_model(FEW, soil, shape=prism)
    cylinders = results_of_model(FEW, soil, shape=cylinder)
    expected = {name: [*prisms[name][:2], cylinders[name][2]] for name in prisms}
    assert_predicts(study, study.variants[0], expected, rtol=1e-5)
    # Held for all, where no table says it.
    block = '[block]\nshape = "RectangularPrism"\ncorner_radius_ratio = 0.4\n'
    tests = {name: TESTS[name] for name in TESTS if name != "aspect_ratio"}
    text += block + "aspect_ratio = 1.5\n"
    study = read_study(write_study_of(tmp_path, text, tests))
    assert_predicts(study, study.variants[0], prisms, rtol=1e-5)


def test_the_next_test_of_a_law(found):
    """Candidates may differ in whatever is not fitted."""
    fitted = found.result.variants[0]
    advice = suggest_tests(fitted, {"speed_mps": [5.0, 40.0], "beta": [0.9]}, count=1)
    assert advice.names == tuple(TRUE)
    assert np.all(advice.chosen[0].errors <= advice.now * (1.0 + 1e-9))
    with pytest.raises(InputError, match="my_rate: is fitted"):
        suggest_tests(fitted, {"my_rate": [5.0]})
    outcome = fitted.outcomes[0]
    assert str(Outcome(int(outcome))) == "detached"

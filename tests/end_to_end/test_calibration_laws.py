"""Calibration with laws of the user's own and with other shapes: fitted, predicted,
kept and refused."""

import dataclasses
import json

import jax
import numpy as np
import pytest
from calibration_studies import objective_of
from error_messages import assert_one_line_error
from text_files import write_rows

from jaximpact import (
    Block,
    Impact,
    Outcome,
    Scene,
    Soil,
    calibrate,
    predict,
    simulate_batch,
)
from jaximpact.calibration import read_study, suggest_tests
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.fitted_ground import read_fitted
from jaximpact.calibration.problem.objective import start_of
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.laws import FluidityRate, PowerNucleus
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
COLUMNS = ("mass_kg", "speed_mps", "angle_deg")
FITTED = (
    *((100, 6, 0), (500, 15, 20), (50, 25, 40), (2000, 10, 60)),
    *((300, 12, 30), (800, 20, 10), (150, 9, 50), (400, 18, 5)),
)
NEW = ((200, 8, 15), (600, 16, 35))
STUDY = """\
data = "tests.csv"
starts = 8
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


def measured(rows, soil, block=None):
    """What the model gives for tests, a row each of `SIGMA`'s columns."""
    mass, speed, angle = np.array(rows, float).T
    block = block or Block(mass=mass)
    impact = Impact(speed=speed, angle=np.deg2rad(angle))
    result = simulate_batch(Scene(block, soil, impact), accuracy="reference")
    return np.stack([result.e_n, result.max_penetration], axis=1)


def write_laws(folder, text=LAWS):
    (folder / "my_laws.py").write_text(text)
    return f"{folder / 'my_laws.py'}:Saturating"


def write_study(folder, text=STUDY, rows=((500, 15, 20, 0.2, 0.2),)):
    write_laws(folder)
    write_rows(folder / "tests.csv", (*COLUMNS, *SIGMA), rows)
    (folder / "study.toml").write_text(text)
    return folder / "study.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A law, tests that it made with noise of known sigmas, and a study of them."""
    folder = tmp_path_factory.mktemp("own")
    jax.config.update("jax_enable_x64", True)
    soil = Soil(flow=write_laws(folder), **TRUE)
    results = measured(FITTED, soil)
    noise = np.random.default_rng(0).normal(size=results.shape)
    results += noise * list(SIGMA.values())
    write_study(folder, rows=np.hstack([FITTED, results]))
    write_rows(
        folder / "new.csv", (*COLUMNS, *SIGMA), np.hstack([NEW, measured(NEW, soil)])
    )
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
    of_call = study_given(
        folder / "tests.csv", wanted, ground, None, None, SIGMA, None, None
    )
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


def test_a_shape_that_was_not_fitted_is_told(found):
    mass, speed, angle = NEW[0]
    tests = {"mass_kg": [mass], "speed_mps": [speed], "angle_deg": [angle]}
    block = {"shape": "RectangularPrism", "corner_radius_ratio": [0.3]}
    text = str(predict(found, tests | block))
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


def predicted(study, variant, values):
    objective, x = of_variant(study, variant, values)
    return objective.values(x).predicted[0]


ROWS = [(*row, 0.2, 0.2) for row in FITTED[:3]]


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
flow = "FluidityRate"
gamma_v = 4.0
"""
    study = read_study(write_study(tmp_path, text, ROWS))
    grounds = (
        Soil(flow=PowerNucleus(nucleus_exponent=1.5), c_v=2.0),
        Soil(flow=FluidityRate(gamma_v=4.0), c_v=2.0),
    )
    for variant, ground in zip(study.variants, grounds, strict=True):
        expected = measured(FITTED[:3], ground)
        found = predicted(study, variant, [2.0])
        np.testing.assert_allclose(found, expected, rtol=1e-6)
    assert study.variants[1].name == "flow FluidityRate, gamma_v 4.0"


def test_a_nuisance_and_a_column_of_a_law(tmp_path):
    """A value a campaign of one parameter, a value a test of the other."""
    text = """\
data = "tests.csv"
[soil]
flow = "my_laws.py:Saturating"
[parameters]
c_v = {}
[nuisance.my_limit]
by = "campaign"
prior = { mean = 0.3, sd = 0.05 }
"""
    path = write_study(tmp_path, text)
    rates, campaigns = (3.0, 5.0, 8.0), ("a", "b", "a")
    rows = [(*r, *x) for r, *x in zip(ROWS, rates, campaigns, strict=True)]
    names = (*COLUMNS, *SIGMA, "my_rate", "campaign")
    write_rows(tmp_path / "tests.csv", names, rows)
    study = read_study(path)
    objective, x = of_variant(study, study.variants[0], [2.0, 0.2, 0.4])
    points = objective(x)
    assert objective.model.engine == "machine code"
    law = study.tests.base.soil.flow
    flow = type(law)(my_rate=np.array(rates), my_limit=np.array([0.2, 0.4, 0.2]))
    expected = measured(FITTED[:3], Soil(flow=flow, c_v=2.0))
    np.testing.assert_allclose(points.predicted[0], expected, rtol=1e-6)
    step = 1e-4 * np.eye(3)[[1]]
    ahead, back = (objective.values(x + s).predicted[0] for s in (step, -step))
    slope = (ahead - back) / 2e-4
    np.testing.assert_allclose(points.jacobian[0, :, :, 1], slope, rtol=1e-2)


def test_shapes_of_tests(tmp_path):
    """A column of shapes, and one shape for all of them."""
    prism = RectangularPrism(corner_radius_ratio=0.4, aspect_ratio=1.5)
    text = 'data = "tests.csv"\n[parameters]\nc_v = {}\n'
    path = write_study(tmp_path, text)
    rows = [(*row, "RectangularPrism", "0.4", "1.5") for row in ROWS[:2]]
    rows.append((*ROWS[2], "EllipticCylinder", "", "1.2"))
    names = (*COLUMNS, *SIGMA, "shape", "corner_radius_ratio", "aspect_ratio")
    write_rows(tmp_path / "tests.csv", names, rows)
    study = read_study(path)
    masses = [np.array([float(mass)]) for mass, *_ in FITTED[:3]]
    shapes = prism, prism, EllipticCylinder(aspect_ratio=1.2)
    expected = [
        measured([row], Soil(c_v=2.0), Block(mass=mass, shape=shape))[0]
        for row, mass, shape in zip(FITTED, masses, shapes, strict=False)
    ]
    found = predicted(study, study.variants[0], [2.0])
    np.testing.assert_allclose(found, expected, rtol=1e-5)
    # Held for all, where no table says it.
    block = '[block]\nshape = "RectangularPrism"\ncorner_radius_ratio = 0.4\n'
    write_study(tmp_path, text + block + "aspect_ratio = 1.5\n", ROWS)
    study = read_study(path)
    found = predicted(study, study.variants[0], [2.0])
    np.testing.assert_allclose(found[:2], expected[:2], rtol=1e-5)


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

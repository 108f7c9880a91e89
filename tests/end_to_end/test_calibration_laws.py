"""Calibration with laws of the user's own and with other shapes: fitted, predicted,
kept and refused."""

import json

import jax
import numpy as np
import pytest
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
from jaximpact.calibration.fitted_ground import read_fitted
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.laws import FluidityRate, PowerNucleus
from jaximpact.shapes import EllipticCylinder, RectangularPrism

pytestmark = pytest.mark.slow

LAWS = '''\
"""A flow that saturates, and dashpots of one number."""

import jax.numpy as jnp

from jaximpact.laws import (
    AbstractDamping,
    AbstractFlow,
    Damping,
    displacement_rates,
    overstress,
    parameter,
)


class Saturating(AbstractFlow):
    my_rate: object = parameter(4.0, "m/s", "(0, inf)", "fluidity")
    my_limit: object = parameter(0.1, "-", "[0, 10]", "saturation")

    def __call__(self, load, hardening, foundation, *, branch=None):
        over = overstress(load.size, hardening, branch=branch)
        rate = self.my_rate * over / (1.0 + self.my_limit * over)
        return displacement_rates(rate, load, 0.0, branch=branch)


class OneRatio(AbstractDamping):
    my_ratio: object = parameter(0.0, "-", "[0, inf)", "damping ratio")

    def __call__(self, stiffness, mass, inertia):
        def of(k, m):
            return 2.0 * self.my_ratio * jnp.sqrt(k * m)

        return Damping(
            of(stiffness.normal, mass),
            of(stiffness.tangential, mass),
            of(stiffness.rotational, inertia),
        )

    def acts(self):
        import numpy as np

        works = ~(np.asarray(self.my_ratio) <= 0.0)
        return works, works


class SecondRate(OneRatio):
    my_rate: object = parameter(0.0, "-", "[0, inf)", "of the flow's name")
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
def written(folder):
    """Where the command line wrote its fit."""
    out = folder / "out"
    assert main(["calibrate", str(folder / "study.toml"), "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def found(folder):
    """The fit in one call."""
    bounds = {"my_rate": (0.5, 50.0), "my_limit": (0.01, 5.0)}
    wanted = {n: {"lower": low, "upper": up} for n, (low, up) in bounds.items()}
    return calibrate(
        folder / "tests.csv",
        fit=wanted | {"c_v": {}},
        ground=Soil(flow=f"{folder / 'my_laws.py'}:Saturating"),
        sigma=SIGMA,
    )


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


def test_a_study_finds_the_same(found, written):
    """What a file says is what a call says."""
    tree = json.loads((written / "fit.json").read_text())
    for name, one in tree["variants"][0]["parameters"].items():
        assert one["value"] == pytest.approx(found.parameters[name]["value"], rel=1e-3)
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


BAD = {
    "parameter": ("my_rate = { start", "my_rat = { start", "did you mean my_rate?"),
    "of another law": (
        "my_limit = { start",
        "nucleus_exponent = { start",
        "PowerNucleus",
    ),
    "file": ("my_laws.py:", "your_laws.py:", "soil.flow", "your_laws.py"),
    "class": (":Saturating", ":Satuating", "did you mean Saturating?"),
    "base": (":Saturating", ":OneRatio", "must derive from AbstractFlow"),
    "one name twice": (
        "[parameters]",
        '[[variants]]\ndamping = "my_laws.py:SecondRate"\n[parameters]',
        "variants[1]",
        "two parameters of one name",
    ),
    "no name": ('"my_laws.py:Saturating"', "3", "soil.flow", "must be a name"),
    "value": ("[soil]", "[soil]\nmy_limt = 1", "soil.my_limt", "mean my_limit?"),
    "range": ("c_v = {}", "c_v = {}\n[block]\naspect_ratio = -1", "above 0"),
    "bounds": (", lower = 0.01, upper = 5.0", "", "say lower and upper"),
    "block": ("[parameters]", '[block]\nshape = "Cube"\n[parameters]', "block.shape"),
    "of another shape": (
        "[parameters]",
        "[block]\ncorner_radius_ratio = 0.1\n[parameters]",
        "RectangularPrism",
    ),
    "variant": (
        "[default_sigma]",
        '[[variants]]\n[[variants]]\nname = "b"\nflow = "Perzyna"\n[default_sigma]',
        "is no parameter of variant 'b', whose laws are flow Perzyna",
    ),
}


@pytest.mark.parametrize("case", BAD.values(), ids=BAD)
def test_bad_studies_are_one_line(tmp_path, capsys, case):
    old, new, *words = case
    assert old in STUDY
    path = write_study(tmp_path, STUDY.replace(old, new, 1))
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "study.toml", *words)


def test_bad_calls(tmp_path):
    write_study(tmp_path)
    tests = tmp_path / "tests.csv"
    with pytest.raises(InputError, match="belongs to the flow PowerNucleus"):
        calibrate(tests, fit=["nucleus_exponent"])
    with pytest.raises(InputError, match="my_rate has no default bounds"):
        calibrate(tests, fit=["my_rate"], ground={"flow": write_laws(tmp_path)})
    with pytest.raises(InputError, match="did you mean Perzyna"):
        calibrate(tests, ground={"flow": "Perzina"})
    with pytest.raises(InputError, match="block must be of type Block"):
        calibrate(tests, block=3)


def predicted_by(study, variant, values):
    """What the objective of a variant gives for values of its unknowns."""
    model = models_of(study)[study.variants.index(variant)]
    objective = Objective(study, variant, model)
    x = objective.bounds.coordinate(np.array([values], float))
    return objective(x), objective


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
        points, _ = predicted_by(study, variant, [2.0])
        expected = measured(FITTED[:3], ground)
        np.testing.assert_allclose(points.predicted[0], expected, rtol=1e-6)
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
    points, objective = predicted_by(study, study.variants[0], [2.0, 0.2, 0.4])
    assert objective.model.engine == "machine code"
    law = study.tests.base.soil.flow
    flow = type(law)(my_rate=np.array(rates), my_limit=np.array([0.2, 0.4, 0.2]))
    expected = measured(FITTED[:3], Soil(flow=flow, c_v=2.0))
    np.testing.assert_allclose(points.predicted[0], expected, rtol=1e-6)
    step = np.zeros((1, 3))
    step[0, 1] = 1e-4
    change = [objective(points.x + s).predicted[0] for s in (step, -step)]
    differences = (change[0] - change[1]) / 2e-4
    np.testing.assert_allclose(points.jacobian[0, :, :, 1], differences, rtol=1e-2)


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
    points, _ = predicted_by(study, study.variants[0], [2.0])
    masses = [np.array([float(mass)]) for mass, *_ in FITTED[:3]]
    shapes = prism, prism, EllipticCylinder(aspect_ratio=1.2)
    expected = [
        measured([row], Soil(c_v=2.0), Block(mass=mass, shape=shape))[0]
        for row, mass, shape in zip(FITTED, masses, shapes, strict=False)
    ]
    np.testing.assert_allclose(points.predicted[0], expected, rtol=1e-5)
    # Held for all, where no table says it.
    block = '[block]\nshape = "RectangularPrism"\ncorner_radius_ratio = 0.4\n'
    write_study(tmp_path, text + block + "aspect_ratio = 1.5\n", ROWS)
    study = read_study(path)
    points, _ = predicted_by(study, study.variants[0], [2.0])
    np.testing.assert_allclose(points.predicted[0, :2], expected[:2], rtol=1e-5)


def test_a_shape_stands_in_one_place(tmp_path, capsys):
    path = write_study(tmp_path, STUDY + '[block]\nshape = "EllipticCylinder"\n')
    write_rows(
        tmp_path / "tests.csv",
        (*COLUMNS, *SIGMA, "shape"),
        [(*row, "Ellipsoid") for row in ROWS],
    )
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "block.shape", "stands in tests.csv too")


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

"""Calibration: transforms, Jacobian, known values recovered, verdicts, bad studies."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from command_line import assert_one_line_error

from jaximpact import Block, Impact, Soil, simulate
from jaximpact.calibration.fit import Reason, fit, spread_starts
from jaximpact.calibration.run import run_study
from jaximpact.calibration.solver import Stepper, fresh_lanes
from jaximpact.calibration.study import case_of
from jaximpact.calibration.study_file import read_study
from jaximpact.calibration.transforms import Bounds
from jaximpact.calibration.uncertainty import estimate
from jaximpact.calibration.verdict import combination
from jaximpact.cli import main

TRUE = {"c_v": 2.0, "gamma_v": 5.0, "k_E": 1500.0}
TESTS = ((100.0, 6.0), (500.0, 15.0), (50.0, 25.0))
TARGETS = ("e_n", "max_penetration_m", "max_normal_force_N")
STUDY = """\
data = "tests.csv"
starts = 4
seed = 1
accuracy = "reference"
[parameters]
c_v = { start = 1.0, lower = 0.1, upper = 20.0 }
gamma_v = { start = 10.0, lower = 0.5, upper = 100.0 }
k_E = { start = 900.0, lower = 50.0, upper = 20000.0 }
alpha_s = { start = 0.9, lower = 0.1, upper = 2.0 }
[default_sigma]
e_n = 0.01
max_penetration_m = 0.005
max_normal_force_N = 5000.0
"""


def write_study(folder, text=STUDY, measured=None):
    """A study in a folder, its targets the ones given, else ones."""
    measured = np.ones((len(TESTS), len(TARGETS))) if measured is None else measured
    lines = [",".join(("mass_kg", "speed_mps", *TARGETS))]
    for test, values in zip(TESTS, measured, strict=True):
        lines.append(",".join(repr(float(x)) for x in (*test, *values)))
    (folder / "tests.csv").write_text("\n".join(lines) + "\n")
    path = folder / "study.toml"
    path.write_text(text)
    return path


def stepper_of(path):
    """The compiled step of a study, which all tests share."""
    from jaximpact.calibration.residuals import Program
    from jaximpact.laws import Laws
    from jaximpact.model import PLANAR
    from jaximpact.simulation import Assembly

    study = read_study(path)
    names = tuple(parameter.name for parameter in study.parameters)
    program = Program(Assembly(Laws(), PLANAR, ledger=False), names, study.targets)
    case = case_of(study, study.variants[0])
    return study, Stepper(program, case, study.starts)


def true_reals(bounds):
    return bounds.real(np.array([*TRUE.values(), 1.0]))


@pytest.fixture(scope="module")
def predicted(tmp_path_factory):
    """What the model gives for the true soil: noise-free targets."""
    study, stepper = stepper_of(write_study(tmp_path_factory.mktemp("predicted")))
    z = np.repeat(true_reals(stepper.case.bounds)[None], study.starts, axis=0)
    lanes = stepper.step(fresh_lanes(stepper.case, z))
    return 1.0 + study.sigma * lanes.residuals[0].reshape(study.sigma.shape)


@pytest.fixture(scope="module")
def twin(tmp_path_factory, predicted):
    """The study of noise-free targets, and where it wrote."""
    folder = tmp_path_factory.mktemp("twin")
    path = write_study(folder, measured=predicted)
    return run_study(path, folder / "out"), folder / "out"


def some_bounds():
    return Bounds(
        jnp.array([0.01, -1.0]), jnp.array([50.0, 3.0]), jnp.array([True, False])
    )


@pytest.mark.parametrize("p", [(0.011, -0.99), (1.0, 0.0), (49.9, 2.999)])
def test_transform_round_trip(p):
    bounds = some_bounds()
    back = bounds.parameter(jnp.asarray(bounds.real(np.array(p))))
    np.testing.assert_allclose(back, p, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(
        bounds.at_part(bounds.part(np.array(p))), p, rtol=1e-12, atol=1e-12
    )


@pytest.mark.parametrize("z", [-800.0, -40.0, 0.0, 40.0, 800.0])
def test_transform_keeps_to_its_bounds_with_finite_slope(z):
    bounds = some_bounds()
    z = jnp.full(2, z)
    p, slope = bounds.parameter(z), jax.jacfwd(bounds.parameter)(z)
    assert np.all((p >= bounds.lower - 1e-12) & (p <= bounds.upper + 1e-12))
    assert np.all(np.isfinite(slope))


def test_slope_of_the_coordinate_of_the_errors():
    bounds, z = some_bounds(), jnp.array([0.7, -0.3])

    def coordinate(z):
        p = bounds.parameter(z)
        return jnp.stack([jnp.log(p[0]), p[1] / 2.0])

    expected = jnp.diag(jax.jacfwd(coordinate)(z))
    np.testing.assert_allclose(bounds.slope(z), expected, rtol=1e-12, atol=1e-12)


def test_bounds_are_noticed():
    bounds = some_bounds()
    assert bounds.bound_reached(np.array([0.0101, 0.0])) == ["lower", None]
    assert bounds.bound_reached(np.array([1.0, 2.99])) == [None, "upper"]


def test_starts_are_spread_and_repeat():
    bounds, given = some_bounds(), [1.0, 0.5]
    starts = spread_starts(bounds, given, 9, seed=3)
    np.testing.assert_array_equal(starts, spread_starts(bounds, given, 9, seed=3))
    assert not np.array_equal(starts, spread_starts(bounds, given, 9, seed=4))
    np.testing.assert_allclose(bounds.parameter(jnp.asarray(starts[0])), given)
    part = 1.0 / (1.0 + np.exp(-starts[1:]))
    strata = np.floor((part - 0.05) / 0.9 * 8).astype(int)
    for column in strata.T:  # each stratum once
        np.testing.assert_array_equal(np.sort(column), np.arange(8))
    assert spread_starts(bounds, given, 1, seed=0).shape == (1, 2)


def test_uncertainty_of_a_linear_fit():
    """Against the textbook: y = a + b x with a sigma of 1."""
    x = np.linspace(0.0, 1.0, 11)
    jacobian = np.stack([np.ones(11), x], axis=1)
    found = estimate(np.zeros(11), np.zeros(11), jacobian, sigma_given=True)
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    np.testing.assert_allclose(found.standard_errors**2, np.diag(covariance))
    assert found.degrees_of_freedom == 9


def test_a_parameter_without_influence_leaves_the_others_their_errors():
    x = np.linspace(0.0, 1.0, 11)
    jacobian = np.stack([np.ones(11), np.zeros(11), x], axis=1)
    found = estimate(0.1 * np.ones(11), np.zeros(11), jacobian, sigma_given=False)
    assert found.standard_errors[1] > 1e6
    assert np.all(found.standard_errors[[0, 2]] < 1.0)


def test_failed_residuals_say_nothing():
    jacobian = np.array([[1.0], [1.0], [0.0]])
    found = estimate([0.0, 1.0, 1e3], [0.0, 0.0, 1.0], jacobian, sigma_given=False)
    assert found.variance == 1.0
    assert found.degrees_of_freedom == 1


def test_a_combination_in_words():
    bounds = Bounds(jnp.ones(3), 2.0 * jnp.ones(3), jnp.array([True] * 3))
    vector = np.array([0.8, -0.4, 0.01])
    assert combination(("c_v", "gamma_v", "k_E"), bounds, vector) == "c_v gamma_v^-0.50"


def test_predictions_are_those_of_the_model(predicted):
    soil = Soil(**TRUE, alpha_s=1.0)
    mass, speed = TESTS[1]
    impact = Impact(speed=speed)
    result = simulate(Block(mass=mass), soil, impact, accuracy="reference")
    expected = (result.e_n, result.max_penetration, result.max_normal_force)
    np.testing.assert_allclose(predicted[1], expected, rtol=1e-6)


def test_jacobian_equals_central_differences(tmp_path):
    """Far below the tolerance of any preset, so that differences are not its noise."""
    _, stepper = stepper_of(write_study(tmp_path))
    stepper.case = stepper.case._replace(tolerance=jnp.asarray(1e-11))
    z = true_reals(stepper.case.bounds)
    width = 1e-3
    steps = width * np.eye(len(z))
    around = np.concatenate([z[None], z + steps, z - steps])
    lanes = stepper.step(fresh_lanes(stepper.case, around))
    plus, minus = np.split(lanes.residuals[1:], 2)
    differences = ((plus - minus) / (2.0 * width)).T
    largest = np.max(np.abs(differences))
    np.testing.assert_allclose(
        lanes.jacobian[0], differences, rtol=0.0, atol=1e-5 * largest
    )


def test_twin_is_recovered(twin):
    result, _ = twin
    variant = result.variants[0]
    found = dict(
        zip([v.name for v in variant.verdicts], variant.parameters, strict=True)
    )
    for name, value in TRUE.items():
        assert found[name] == pytest.approx(value, rel=1e-4)
    assert variant.failed == 0
    assert len(variant.start_costs) == 4


def test_verdicts_of_the_twin(twin):
    """Friction under the block has no influence where nothing slides."""
    result, _ = twin
    variant = result.variants[0]
    determined = {v.name: v.determined for v in variant.verdicts}
    assert determined == {"c_v": True, "gamma_v": True, "k_E": True, "alpha_s": False}
    assert "no influence" in variant.verdicts[3].reason
    held = variant.profiles["alpha_s"]
    assert np.max(held.rise) < 1e-3
    assert held.low is None
    assert held.high is None


def test_files_of_the_twin(twin):
    result, out = twin
    assert sorted(p.name for p in out.iterdir()) == [
        "fit.json",
        "fit.png",
        "fitted.csv",
        "report.txt",
    ]
    report = (out / "report.txt").read_text()
    assert "The data do not determine alpha_s" in report
    line = next(x for x in report.splitlines() if x.strip().startswith("alpha_s"))
    assert "not determined" in line
    content = json.loads((out / "fit.json").read_text())
    alpha_s = content["variants"][0]["parameters"]["alpha_s"]
    assert alpha_s["standard_error"] is None
    assert content["manifest"]["data"]["sha256"] == result.study.table.sha256
    assert content["manifest"]["seed"] == 1
    rows = (out / "fitted.csv").read_text().splitlines()
    assert len(rows) == 1 + len(TESTS) * len(TARGETS)


def test_adam_lowers_the_cost(tmp_path, predicted, monkeypatch):
    _, stepper = stepper_of(write_study(tmp_path, measured=predicted))
    monkeypatch.setattr("jaximpact.calibration.fit.ADAM_STEPS", 25)
    z = np.repeat(true_reals(stepper.case.bounds)[None], 4, axis=0)
    z = z + 0.3 * np.eye(4)
    before = stepper.step(fresh_lanes(stepper.case, z)).cost
    after = fit(stepper, z, method="adam")
    assert np.all(after.cost[:3] < 0.5 * before[:3])
    assert set(after.reasons) <= {Reason.step_limit, Reason.converged}


BAD = {
    "unknown key": ("starts = 4", "strats = 4", ("key strats", "starts")),
    "unknown parameter": ("k_E = {", "kE = {", ("parameters.kE", "k_E")),
    "block parameter": ("k_E = {", "mass_kg = {", ("parameters.mass_kg",)),
    "unknown bound": ("lower = 50.0", "low = 50.0", ("parameters.k_E.low", "lower")),
    "start outside": ("start = 900.0", "start = 9.0", ("parameters.k_E.start", "50")),
    "no bounds": (", lower = 0.1, upper = 2.0", "", ("parameters.alpha_s.lower",)),
    "negative bound": ("lower = 0.1,", "lower = -0.1,", ("parameters.c_v.lower",)),
    "wrong type": ("starts = 4", "starts = 4.5", ("key starts", "whole number")),
    "missing data": ("tests.csv", "nowhere.csv", ("nowhere.csv", "cannot be read")),
    "unknown target": ("seed = 1", 'targets = ["en"]', ("key targets", "e_n")),
    "absent target": ("seed = 1", 'targets = ["e_bar"]', ("targets", "no column")),
    "no target": ("seed = 1", "targets = []", ("key targets",)),
    "method": ("seed = 1", 'method = "adm"', ("key method", "adam")),
    "accuracy": (
        'accuracy = "reference"',
        'accuracy = "fats"',
        ("key accuracy", "fast"),
    ),
    "sigma": ("e_n = 0.01", "e_n = 0.0", ("default_sigma.e_n", "above 0")),
    "sigma of one": ("e_n = 0.01\n", "", ("default_sigma", "e_n has no sigma")),
    "fixed soil": ("[default_sigma]", "[soil]\nk_F = 1.0\n[default_sigma]", ("k_E",)),
    "twice": ("[default_sigma]", "[soil]\nk_E = 1.0\n[default_sigma]", ("is fitted",)),
    "variant": (
        "[default_sigma]",
        "[[variants]]\nx = 1\n[default_sigma]",
        ("variants",),
    ),
    "not TOML": ("starts = 4", "starts =", ("not valid TOML",)),
}


@pytest.mark.parametrize(("old", "new", "parts"), BAD.values(), ids=BAD)
def test_bad_study_is_one_line(tmp_path, capsys, old, new, parts):
    assert old in STUDY
    path = write_study(tmp_path, STUDY.replace(old, new, 1))
    out = tmp_path / "out"
    assert main(["calibrate", str(path), "--out", str(out)]) == 2
    assert_one_line_error(capsys, str(tmp_path), *parts)
    assert not out.exists()


def test_bad_target_names_row_and_column(tmp_path, capsys):
    path = write_study(tmp_path)
    table = tmp_path / "tests.csv"
    lines = table.read_text().splitlines()
    lines[2] = "500.0,15.0,nan,1.0,1.0"
    table.write_text("\n".join(lines))
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "tests.csv", "row 3", "column e_n", "finite")


def test_no_measured_result(tmp_path, capsys):
    path = write_study(tmp_path)
    (tmp_path / "tests.csv").write_text("mass_kg\n1.0\n")
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "tests.csv", "no measured result")


def test_tangential_restitution_at_vertical_incidence_is_refused(tmp_path, capsys):
    path = write_study(tmp_path)
    (tmp_path / "tests.csv").write_text("mass_kg,e_t\n1.0,0.5\n")
    text = STUDY[: STUDY.index("[default_sigma]")]
    path.write_text(text)
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, "tests.csv", "e_t")

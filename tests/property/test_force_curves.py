"""Forces against time as targets of a fit."""

import hashlib

import numpy as np
import pytest
from error_messages import assert_one_line
from text_files import write_rows

from jaximpact import Block, Impact, Soil, simulate
from jaximpact.calibration import read_study
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.diagnostics.cross_validation import leave_out_each
from jaximpact.calibration.diagnostics.results import StudyResult
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.estimation.sigma import settle
from jaximpact.calibration.estimation.starts import fit
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective
from jaximpact.calibration.report.files import as_json
from jaximpact.errors import InputError

TIMES = np.linspace(-0.002, 0.06, 32)
"""From before the touch to after the end of some contacts."""
MASS, SPEED, ANGLE = [500.0, 200.0], [10.0, 8.0], [0.0, 30.0]
NOISE = 2000.0
TRUTH = {"gamma_v": 5.0, "k_E": 1200.0}
STUDY = """data = "tests.csv"
[parameters]
gamma_v = { start = 8.0, lower = 1.0, upper = 50.0 }
k_E = { start = 900.0, lower = 100.0, upper = 10000.0 }
"""


@pytest.fixture(scope="module")
def histories():
    impact = Impact(speed=np.array(SPEED), angle=np.deg2rad(ANGLE))
    block = Block(mass=np.array(MASS))
    found = simulate(block, Soil(**TRUTH), impact, save_at=TIMES, accuracy="reference")
    return found.history, np.asarray(found.e_n)


@pytest.fixture(scope="module")
def objective(histories, tmp_path_factory):
    """Two tests, one with a curve of both forces and one of the normal force."""
    folder, (history, e_n) = tmp_path_factory.mktemp("curves"), histories
    random = np.random.default_rng(3)
    rows = []
    for test, (mass, speed, angle) in enumerate(zip(MASS, SPEED, ANGLE, strict=True)):
        names = ["time_s", "normal_force_N", "tangential_force_N"][: 2 + test]
        forces = history.normal_force[test], history.tangential_force[test]
        columns = [TIMES, *map(np.asarray, forces[: 1 + test])]
        noise = random.normal(0.0, NOISE, (len(columns) - 1, len(TIMES)))
        columns[1:] = [c + n for c, n in zip(columns[1:], noise, strict=True)]
        write_rows(folder / f"{test}.csv", names, np.transpose(columns).tolist())
        inputs = f"drop {test}", mass, speed, angle
        inputs = f"drop {test}", mass, speed, angle
        rows.append([*inputs, float(e_n[test]), f"{test}.csv"])
    head = ["name", "mass_kg", "speed_mps", "angle_deg", "e_n", "force_curve"]
    write_rows(folder / "tests.csv", head, rows)
    (folder / "study.toml").write_text(STUDY)
    study = read_study(folder / "study.toml")
    return Objective(study, study.variants[0], models_of(study)[0])


@pytest.mark.slow
def test_points_of_curves_are_rows(objective):
    study, count = objective.study, len(TIMES)
    assert study.targets == ("e_n", "normal_force_N", "tangential_force_N")
    assert np.sum(study.known, axis=0).tolist() == [2, 2 * count, count]
    assert study.tests.first_of_row.tolist() == [0, 1] + [0] * count + [1] * count
    assert study.tests.name(0) == "drop 0"
    assert study.tests.name(2 + count + 5) == f"drop 1 at {TIMES[5]:.4g} s"


@pytest.mark.parametrize(
    ("old", "new"), [("0.01,2e4", "0.01,2.5e4"), ("0.01,2e4", "0.012,2e4")]
)
def test_an_edited_curve_is_noticed_as_an_edited_table(old, new, tmp_path):
    """Its checksum is another."""
    curve = "time_s,normal_force_N\n0.005,3e4\n0.01,2e4\n"
    (tmp_path / "curve.csv").write_text(curve)
    head, row = ["angle_deg", "e_n", "force_curve"], [0.0, 0.3, "curve.csv"]
    write_rows(tmp_path / "tests.csv", head, [row, row])
    (tmp_path / "study.toml").write_text(STUDY)

    def files():
        """The files with their checksums."""
        study = read_study(tmp_path / "study.toml")
        assert study.inputs[1:] == [tmp_path / "tests.csv", tmp_path / "curve.csv"]
        return as_json(StudyResult(study, [], 0.0, ""), [])["manifest"]["data"]

    checksum = hashlib.sha256(curve.encode()).hexdigest()
    table, of_curve = files()
    assert of_curve == {"file": "curve.csv", "sha256": checksum}
    (tmp_path / "curve.csv").write_text(curve.replace(old, new))
    same, changed = files()
    assert same == table
    assert changed["sha256"] != checksum


@pytest.mark.slow
def test_forces_are_those_of_a_simulation_and_so_are_derivatives(objective, histories):
    (history, e_n), count = histories, len(TIMES)
    x = objective.bounds.coordinate(np.array([list(TRUTH.values())]))
    found = objective(x)
    predicted = found.predicted[0]
    forces = np.asarray(history.normal_force), np.asarray(history.tangential_force)
    normal = predicted[2:, 1].reshape(2, count)
    # The same machine code, rounding aside.
    np.testing.assert_allclose(normal, forces[0], rtol=1e-9, atol=1e-3)
    np.testing.assert_allclose(predicted[2 + count :, 2], forces[1][1], rtol=1e-9)
    np.testing.assert_allclose(predicted[:2, 0], e_n, rtol=1e-9)
    np.testing.assert_array_equal(
        objective.values(x).predicted[0, 2:, 1], predicted[2:, 1]
    )
    step = 1e-5
    for unknown in range(2):
        moved = np.repeat(x, 2, axis=0)
        moved[:, unknown] += [step, -step]
        ahead, back = objective.values(moved).predicted
        slope = (ahead - back) / (2.0 * step)
        known = objective.study.known
        own = found.jacobian[0, ..., unknown]
        # As of other targets; at the end of a contact the force has a kink.
        apart = np.abs(own - slope)[known] > 2e-3 * np.max(np.abs(own[known]))
        assert np.sum(apart) <= 2


@pytest.mark.slow
def test_a_fit_to_curves_gets_the_parameters_back(objective):
    begin = objective.bounds.coordinate(np.array([[9.0, 800.0]]))
    begun = fit(objective, begin)
    settled, best = settle(objective, begun, fit)
    uncertainty = estimate(settled, best.points)
    apart = best.points.x[0] - objective.bounds.coordinate(np.array([*TRUTH.values()]))
    assert np.all(np.abs(apart) < 3.0 * uncertainty.standard_errors)
    assert np.all(uncertainty.standard_errors < 0.05)
    # 64 and 32 values: 4 standard errors of 9 and 12 %.
    assert settled.sigma[0, 1:] == pytest.approx(NOISE, rel=0.5)
    left = leave_out_each(settled, best.points, uncertainty)
    assert left.groups == ("drop 0", "drop 1")


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("none.csv", "", "which is no file"),
        ("a.csv", "time_s,e_n\n0.1,0.5\n", "belongs into tests.csv"),
        ("a.csv", "time_s\n0.1\n", "must have time_s and normal_force_N"),
    ],
)
def test_what_is_no_curve_is_refused(name, text, words, tmp_path):
    (tmp_path / "a.csv").write_text(text)
    write_rows(tmp_path / "tests.csv", ["e_n", "force_curve"], [[0.3, name]])
    with pytest.raises(InputError) as error:
        read_study(tmp_path / "tests.csv")
    assert_one_line(error.value, words)


def test_a_force_needs_its_time():
    with pytest.raises(InputError) as error:
        study_given({"normal_force_N": [1e5]}, *(None,) * 7)
    assert_one_line(error.value, "needs time_s")

"""Forces against time as targets of a fit."""

import dataclasses
import hashlib

import numpy as np
import pytest
from calibration_studies import fitted, objective_of, write_study_of
from text_files import write_rows

from jaximpact.calibration import read_study
from jaximpact.calibration.diagnostics.cross_validation import leave_out_each
from jaximpact.calibration.diagnostics.results import StudyResult
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.report.files import as_json

TIMES = np.linspace(-0.002, 0.06, 32)
"""From before the touch to after the end of some contacts."""
NOISE = 2000.0
TRUTH = {"gamma_v": 5.0, "k_E": 1200.0}
STUDY = """data = "tests.csv"
[parameters]
gamma_v = { start = 8.0, lower = 1.0, upper = 50.0 }
k_E = { start = 900.0, lower = 100.0, upper = 10000.0 }
"""


@pytest.fixture(scope="module")
def objective(tmp_path_factory):
    """Two tests that the model made with noise, one with a curve of the normal force
    and one of both forces."""
    folder, count = tmp_path_factory.mktemp("curves"), len(TIMES)
    forces = ["normal_force_N", "tangential_force_N"]
    for test, names in enumerate((forces[:1], forces)):
        rows = np.column_stack([TIMES, np.ones((count, len(names)))])
        write_rows(folder / f"{test}.csv", ["time_s", *names], rows.tolist())
    head = ["name", "mass_kg", "aspect_ratio", "speed_mps", "angle_deg", "e_n"]
    head.append("force_curve")
    # Kernels of the planar and of the round model; those of the vertical one are
    # tested by the histories.
    rows = [
        ["drop 0", 500.0, 1.2, 10.0, 15.0, 0.1, "0.csv"],
        ["drop 1", 200.0, 1.0, 8.0, 30.0, 0.1, "1.csv"],
    ]
    found = objective_of(write_study_of(folder, STUDY, head, rows))
    exact = found.values(at(found, TRUTH.values())).predicted[0]
    noise = np.random.default_rng(3).normal(0.0, NOISE, exact.shape)
    noise[:, 0] = 0.0
    measured = np.where(found.study.known, exact + noise, np.nan)
    return found._changed(study=dataclasses.replace(found.study, measured=measured))


def at(objective, values):
    return objective.bounds.coordinate([*values])[None]


@pytest.mark.slow
def test_points_of_curves_are_rows(objective):
    study, count = objective.study, len(TIMES)
    assert study.targets == ("e_n", "normal_force_N", "tangential_force_N")
    assert np.sum(study.known, axis=0).tolist() == [2, 2 * count, count]
    assert study.tests.first_of_row.tolist() == [0, 1] + [0] * count + [1] * count
    assert study.tests.name(0) == "drop 0"
    assert study.tests.name(2 + count + 5) == f"drop 1 at {TIMES[5]:.4g} s"


def test_an_edited_curve_is_noticed_as_an_edited_table(tmp_path):
    """Its checksum is another."""
    curve = "time_s,normal_force_N\n0.005,3e4\n0.01,2e4\n"
    (tmp_path / "curve.csv").write_text(curve)
    head, row = ["angle_deg", "e_n", "force_curve"], [0.0, 0.3, "curve.csv"]
    path = write_study_of(tmp_path, STUDY, head, [row, row])

    def files():
        """The files with their checksums."""
        study = read_study(path)
        assert study.inputs[1:] == [tmp_path / "tests.csv", tmp_path / "curve.csv"]
        return as_json(StudyResult(study, [], 0.0, ""), [])["manifest"]["data"]

    checksum = hashlib.sha256(curve.encode()).hexdigest()
    table, of_curve = files()
    assert of_curve == {"file": "curve.csv", "sha256": checksum}
    (tmp_path / "curve.csv").write_text(curve.replace("2e4", "2.5e4"))
    same, changed = files()
    assert same == table
    assert changed["sha256"] != checksum


@pytest.mark.slow
def test_a_fit_to_curves_gets_the_parameters_back(objective):
    settled, best = fitted(objective, at(objective, (9.0, 800.0)))
    uncertainty = estimate(settled, best.points)
    apart = best.points.x[0] - at(objective, TRUTH.values())[0]
    assert np.all(np.abs(apart) < 3.0 * uncertainty.standard_errors)
    assert np.all(uncertainty.standard_errors < 0.05)
    # 64 and 32 values: 4 standard errors of 9 and 12 %.
    assert settled.sigma[0, 1:] == pytest.approx(NOISE, rel=0.5)
    left = leave_out_each(settled, best.points, uncertainty)
    assert left.groups == ("drop 0", "drop 1")

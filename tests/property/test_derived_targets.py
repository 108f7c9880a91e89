"""Targets that follow from velocities: energies, angle of rebound, impulses."""

import numpy as np
import pytest

from jaximpact import Block, Impact, Scene, Soil, simulate_batch
from jaximpact.calibration.arguments import study_given, table_given
from jaximpact.calibration.problem.config import study_of
from jaximpact.calibration.problem.dataset import joined_tables
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective
from jaximpact.quantities import DERIVED_COLUMNS, TARGET_COLUMNS

TARGETS = ("e_n", *DERIVED_COLUMNS, "final_sinking_m", "max_tangential_force_N")
INPUTS = {
    "mass_kg": [50.0, 300.0, 900.0],
    "speed_mps": [6.0, 12.0, 20.0],
    "angle_deg": [15.0, 40.0, -30.0],
    "slope_deg": [5.0, 20.0, 10.0],
}


@pytest.fixture(scope="module")
def columns():
    return INPUTS | {name: np.ones(3) for name in TARGETS}


@pytest.fixture(scope="module")
def objective(columns):
    """Slope, mass and speed that are not known well."""
    study = study_of(
        joined_tables((table_given(columns),)),
        {
            "nuisance": {
                "slope_deg": {"by": "row", "prior": {"mean": 0.0, "sd": 3.0}},
                "mass_kg": {"by": "row", "prior": {"mean": 0.0, "sd": 5.0}},
                "speed_mps": {"by": "row", "prior": {"mean": 0.0, "sd": 0.5}},
            },
        },
    )
    return Objective(study, study.variants[0], models_of(study)[0])


def test_values_are_those_of_the_velocities(columns):
    study = study_given(columns, *(None,) * 7)
    objective = Objective(study, study.variants[0], models_of(study)[0])
    x = objective.bounds.coordinate([[p.start for p in study.parameters]])
    predicted = objective.values(x).predicted[0].T
    found = dict(zip(study.targets, predicted, strict=True))
    mass, speed = np.array(INPUTS["mass_kg"]), np.array(INPUTS["speed_mps"])
    angle = np.deg2rad(INPUTS["angle_deg"])
    impact = Impact(speed=speed, angle=angle, slope=np.deg2rad(INPUTS["slope_deg"]))
    result = simulate_batch(
        Scene(Block(mass=mass), Soil(), impact), accuracy="reference"
    )
    v_n = np.asarray(result.normal_velocity)
    v_t = np.asarray(result.tangential_velocity)
    expected = {
        "translational_ratio": (v_n**2 + v_t**2) / speed**2,
        "rebound_angle_deg": np.rad2deg(np.arctan2(v_t, -v_n)),
        "normal_impulse_Ns": mass * (speed * np.cos(angle) - v_n),
        "tangential_impulse_Ns": mass * (speed * np.sin(angle) - v_t),
        "final_sinking_m": np.asarray(result.final_sinking),
        "max_tangential_force_N": np.asarray(result.max_tangential_force),
    }
    for name, values in expected.items():
        # The same impacts: rounding alone.
        assert found[name] == pytest.approx(values, rel=1e-9), name


def test_derivatives_with_respect_to_soil_and_nuisances(objective):
    """By central differences; the impacts are exact to 1e-9, the step is 1e-5 of a
    range, and second differences are below 1e-3 of it."""
    bounds = objective.bounds
    start = [p.start for p in objective.study.parameters]
    values = np.concatenate(
        [start, [2.0, -1.0, 1.5], [1.0, -2.0, 3.0], [0.1, 0.0, -0.2]]
    )
    x = bounds.coordinate(values)[None]
    jacobian, step = objective(x).jacobian[0], 1e-5
    for unknown in range(x.shape[1]):
        ahead, back = x.copy(), x.copy()
        ahead[0, unknown] += step
        back[0, unknown] -= step
        change = objective.values(ahead).predicted - objective.values(back).predicted
        size = np.maximum(np.max(np.abs(jacobian), axis=(0, 2)), 1e-3)
        apart = jacobian[..., unknown] - change[0] / (2.0 * step)
        assert np.max(np.abs(apart) / size) < 2e-3, objective.study.targets


def test_every_target_has_a_unit_and_a_meaning():
    assert {*DERIVED_COLUMNS} < {*TARGET_COLUMNS}
    assert all(column.unit and column.meaning for column in TARGET_COLUMNS.values())

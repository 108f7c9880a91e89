"""Vertical drops that the model made without noise on a known ground, in two campaigns,
and their calibration, which all tests share as the fixture `twin`.

Friction under the block, alpha_s, has no influence where nothing slides.
"""

import tomllib
from typing import NamedTuple

import numpy as np
from calibration_studies import study_of_columns, write_study_of

from jaximpact import Block, Impact, Scene, Soil, calibrate, simulate_batch

TRUE = {"c_v": 2.0, "gamma_v": 5.0, "k_E": 1500.0}
DROPS = {
    "name": ["A", "B", "C", "D", "E", "F"],
    "campaign": ["north", "south"] * 3,
    "mass_kg": [100.0, 500.0, 50.0, 2000.0, 300.0, 800.0],
    "speed_mps": [6.0, 15.0, 25.0, 10.0, 12.0, 20.0],
}
STUDY = """\
title = "A <twin> & more"
data = "tests.csv"
starts = 8
seed = 1
[soil]
dilatancy = 0.5
[parameters]
c_v = { start = 1.0, lower = 0.1, upper = 20.0 }
gamma_v = { start = 10.0, lower = 0.5, upper = 100.0 }
k_E = { start = 900.0, lower = 50.0, upper = 20000.0 }
alpha_s = { start = 0.9, lower = 0.1, upper = 2.0 }
[default_sigma]
e_n = 0.01
max_penetration_m = 0.005
[further_tests]
candidates = { speed_mps = [5, 20], angle_deg = [0, 40] }
"""


def results_of_model(columns, soil=None, **shape):
    """What the model gives for tests on a soil, else the true one, and of a shape, else
    of ellipsoids."""
    soil = soil or Soil(**TRUE, dilatancy=0.5)
    speed = np.array(columns["speed_mps"])
    angle = np.array(columns.get("angle_deg", np.zeros(len(speed))))
    impact = Impact.from_degrees(speed, angle)
    names = {"aspect_ratio"} & set(columns)
    shape = shape or {name: np.array(columns[name]) for name in names}
    scene = Scene(Block(mass=np.array(columns["mass_kg"]), **shape), soil, impact)
    found = simulate_batch(scene, accuracy="reference")
    return {
        "e_n": np.asarray(found.e_n).tolist(),
        "max_penetration_m": np.asarray(found.max_penetration).tolist(),
    }


def twin_study(results):
    """The study of the drops with these results."""
    content = tomllib.loads(STUDY)
    del content["data"]
    return study_of_columns(DROPS | results, **content)


class Twin(NamedTuple):
    """The calibration, its tests by column, and where its files are."""

    found: object
    tests: dict
    out: object


def calibrated_twin(folder) -> Twin:
    """Calibrate in a folder, whatever NumPy does about probabilities that underflow
    far from a measurement."""
    tests = DROPS | results_of_model(DROPS)
    path = write_study_of(folder, STUDY, tests)
    with np.errstate(all="raise"):
        found = calibrate(path, out=folder / "out")
        assert np.geterr()["under"] == "raise"
    return Twin(found, tests, folder / "out")

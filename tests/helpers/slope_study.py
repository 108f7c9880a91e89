"""A run-out study with barriers and a place on the map, and all that its command
writes."""

import contextlib
import io
from pathlib import Path
from typing import NamedTuple

import xarray as xr
from error_messages import assert_one_line_error

from jaximpact.cli import main
from jaximpact.runout import SlopeStudy, read_slope_study, run_slope_study

SLOPE = """
count = 90
seed = 7
collectors_m = [40, 60]
bins = 20
export_trajectories = 70

[profile]
points_m = [[0, 50], [50, 20], [55, 20], [80, 0], [200, 0]]
origin = [2600000, 1200000]
azimuth_deg = 90
crs = "EPSG:2056"

[ground.segment.2]
c_v = 0.5

[block]
mass_kg = { mean = 100, sd = 60, least = 20 }
aspect_ratio = [1, 1.5, 2]

[release]
x_m = { from = 2, to = 6 }
clearance_m = 0.5
speed_mps = 5

[contacts]
law = "frictional ellipsoid"
e_contact = 0.3
friction_coefficient = 0.6

[[barriers]]
name = "upper, fence"
x_m = 60
height_m = 1
capacity_kJ = 20

[[barriers]]
x_m = 85
height_m = 2
capacity_kJ = 1
"""


FRICTIONAL = """
law = "frictional ellipsoid"
e_contact = 0.3
friction_coefficient = 0.6
"""
CONSTANT = """
law = "constant coefficients"
e_n = 0.3
e_t = 0.8
"""

FAR = """
count = 20
collectors_m = [2600029]

[profile]
points_m = [[2600000, 1520], [2600015, 1505], [2600730, 1400]]

[block]
mass_kg = 100

[release]
x_m = { from = 2600001.25, to = 2600002.5 }
clearance_m = 1
speed_mps = 2

[contacts]
law = "constant coefficients"
e_n = 0.3
e_t = 0.8
"""
"""A study in coordinates of a national grid, with bins of 14.6 m."""


def slope_text(
    top="seed = 7",
    profile="points_m = [[0, 50], [50, 20], [80, 0], [200, 0]]",
    ground="",
    block="mass_kg = 100",
    release="x_m = { from = 2, to = 6 }",
    contacts=FRICTIONAL,
):
    """The text of a study: what stands before its tables, and in each of them."""
    tables = {"profile": profile, "block": block, "contacts": contacts}
    tables["release"] = f"{release}\nclearance_m = 0.5\nspeed_mps = 5"
    named = "\n\n".join(f"[{name}]\n{text}" for name, text in tables.items())
    return f"{top}\n\n{ground}\n\n{named}\n"


def assert_refused(capsys, message, study="slope.toml"):
    """The command refuses a study in one line, with the parts of a message between
    dots."""
    assert main(["runout", str(study), "--out", "out"]) == 2
    return assert_one_line_error(capsys, *message.split(" ... "))


class SlopeResults(NamedTuple):
    """Results of the study."""

    folder: Path
    """Files that the command has written."""
    study: SlopeStudy
    dataset: xr.Dataset
    printed: str
    """What the command printed."""
    said: str
    """What it said of its progress."""


def slope_results_in(folder):
    """Compute the study in a folder, by the command and in Python."""
    path = folder / "slope.toml"
    path.write_text(SLOPE)
    printed, said = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(said):
        assert main(["runout", str(path), "--out", str(folder / "out")]) == 0
    study = read_slope_study(path)
    return SlopeResults(
        folder=folder / "out",
        study=study,
        dataset=run_slope_study(study),
        printed=printed.getvalue(),
        said=said.getvalue(),
    )

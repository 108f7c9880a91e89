"""A study with materials, fields, volumes, distributions and a line of releases."""

import json

import numpy as np
import pytest
from text_files import rows_of

from jaximpact import read_netcdf
from jaximpact.cli import main
from jaximpact.runout import read_slope_study

pytestmark = pytest.mark.slow

STUDY = """
count = 80
seed = 2
collectors_m = [60]
bins = 10

[profile]
csv = "p.csv"

[ground.materials.debris]
roughness_deg = 2

[ground.materials.talus]
rolling_friction_angle_deg = { mean = 25, sd = 3, least = 15, most = 35, \
correlation_length_m = 10 }
roughness_deg = { from = 2, to = 6, correlation_length_m = 30 }

[ground.materials.meadow]
k_E = { median = 200, geometric_sd = 1.5 }
rolling_friction_angle_deg = 32

[block]
volume_m3 = { exponent = 0.5, least = 0.01, most = 1 }

[release]
along_x_m = [2, 30]
clearance_m = 0.5
speed_mps = 5

[contacts]
law = "frictional ellipsoid"
e_contact = 0.3
friction_coefficient = 0.6
"""
PROFILE = "x_m,y_m,material\n0,50,debris\n30,35,talus\n80,10,meadow\n300,0,\n"


@pytest.fixture
def study(folder):
    (folder / "p.csv").write_text(PROFILE)
    (folder / "slope.toml").write_text(STUDY)
    return folder / "slope.toml"


def test_the_command_takes_all(study, tmp_path, capsys):
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    assert "80 blocks" in capsys.readouterr().out
    dataset = read_netcdf(tmp_path / "out" / "blocks.nc")
    read = read_slope_study(study)
    np.testing.assert_array_equal(dataset.mass_kg, read.release.block.mass)
    np.testing.assert_array_equal(
        dataset.ground_materials_meadow_k_E,
        read.inputs.ground_samples["materials_meadow_k_E"],
    )
    assert 2.0 <= dataset.release_x_m.min() < dataset.release_x_m.max() <= 30.0
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    said = manifest["ground"]["materials"]["talus"]["roughness_deg"]
    assert said == {"from": 2, "to": 6, "correlation_length_m": 30}
    assert set(manifest["files"]) == {"slope.toml", "p.csv"}
    assert len(rows_of(tmp_path / "out" / "stops.csv")) == 80

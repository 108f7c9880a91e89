"""Materials of the ground: by ranges of x, and by a column of the profile."""

import json

import numpy as np
import pytest
from slope_study import CONSTANT, slope_text

from jaximpact import read_netcdf
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.runout import read_profile, read_slope_study
from jaximpact.runout.study.run_study import inputs_of

SLOPE = slope_text(
    ground="""
[ground.materials.scree]
from_x_m = 0
to_x_m = 62.5
c_v = 0.5
gamma_v = { from = 2, to = 4 }
roughness_deg = 2

[ground.materials.meadow]
from_x_m = 62.5
to_x_m = 200
k_E = 300
rolling_friction_angle_deg = 32
""",
    release="x_m = 2",
    contacts=CONSTANT,
)
CSV = """x_m,y_m,material
0,50,scree
50,20,scree
80,0,meadow
200,0,
"""
RANGES = (
    ("from_x_m = 0\nto_x_m = 62.5\n", ""),
    ("from_x_m = 62.5\nto_x_m = 200\n", ""),
)
POINTS = "points_m = [[0, 50], [50, 20], [80, 0], [200, 0]]"


@pytest.fixture
def slope(slope):
    slope.with_name("p.csv").write_text(CSV)
    return slope


def test_a_range_cuts_the_segment_in_which_it_begins(slope):
    study = read_slope_study(slope)
    np.testing.assert_array_equal(study.profile.x, [0, 50, 62.5, 80, 200])
    np.testing.assert_allclose(study.profile.y, [50, 20, 35 / 3, 0, 0], atol=1e-9)
    soil = study.ground.soil
    np.testing.assert_array_equal(soil.c_v, [0.5, 0.5, 1.0, 1.0])
    np.testing.assert_array_equal(soil.k_E, [900.0, 900.0, 300.0, 300.0])
    np.testing.assert_allclose(np.degrees(study.ground.roughness), [2, 2, 0, 0])
    np.testing.assert_allclose(
        np.degrees(study.ground.rolling_friction_angle), [20, 20, 32, 32]
    )
    assert study.release.count == 1000
    drawn = study.inputs.ground_samples["materials.scree.gamma_v"]
    np.testing.assert_array_equal(soil.gamma_v[:, 0], drawn)
    np.testing.assert_array_equal(soil.gamma_v[:, 1], drawn)
    np.testing.assert_array_equal(soil.gamma_v[:, 2:], 8.7)
    assert drawn.min() >= 2.0
    assert drawn.max() <= 4.0


def test_a_column_names_materials(slope, changed):
    study = read_slope_study(changed(*RANGES, (POINTS, 'csv = "p.csv"')))
    np.testing.assert_array_equal(study.profile.x, [0, 50, 80, 200])
    np.testing.assert_array_equal(study.ground.soil.c_v, [0.5, 0.5, 1.0])
    np.testing.assert_array_equal(study.ground.soil.k_E, [900.0, 900.0, 300.0])
    # Beside columns of the soil, which no material says.
    (slope.parent / "p.csv").write_text(
        CSV.replace("material\n", "material,relative_density\n")
        .replace("scree\n", "scree,0.5\n")
        .replace("meadow\n", "meadow,0.6\n")
        .replace("0,\n", "0,,0.6\n")
    )
    study = read_slope_study(slope)
    np.testing.assert_array_equal(study.ground.soil.relative_density, [0.5, 0.5, 0.6])


def test_names_of_materials_have_the_letters_of_any_language(slope, changed):
    slope.with_name("p.csv").write_text(CSV.replace("scree", "Geröll"), "utf-8")
    named = changed(*RANGES, (POINTS, 'csv = "p.csv"'), (".scree", '."Geröll"'))
    study = read_slope_study(named)
    assert study.inputs.materials == ("Geröll", "Geröll", "meadow")
    assert [*study.inputs.ground_samples] == ["materials.Geröll.gamma_v"]


def test_variables_are_named_by_quantity_whatever_the_material_is_called(changed):
    random = ("k_E = 300", "friction_angle_deg = { from = 28, to = 35 }")
    study = read_slope_study(changed((".meadow", ".rolling"), random))
    variables = inputs_of(study)
    names = [name for name in variables if name.startswith("ground_")]
    assert names == [
        "ground_materials_scree_gamma_v",
        "ground_materials_rolling_friction_angle_deg",
    ]
    _, values, about = variables[names[1]]
    assert about["long_name"] == "friction angle phi' of materials rolling"
    assert 28.0 <= np.min(values) < np.max(values) <= 35.0


def test_materials_whose_variables_would_have_one_name_are_refused(changed):
    study = changed(
        (".meadow", ".scree_rolling"),
        ("k_E = 300", "friction_angle_deg = { from = 28, to = 35 }"),
        ("c_v = 0.5", "rolling_friction_angle_deg = { from = 18, to = 25 }"),
    )
    words = "materials.scree_rolling.friction_angle_deg: and ground.materials.scree."
    with pytest.raises(InputError, match=words):
        read_slope_study(study)


def test_samples_are_those_of_the_study_without_cuts(slope, changed):
    by_range = read_slope_study(slope)
    by_column = read_slope_study(changed(*RANGES, (POINTS, 'csv = "p.csv"')))
    np.testing.assert_array_equal(
        by_range.inputs.ground_samples["materials.scree.gamma_v"],
        by_column.inputs.ground_samples["materials.scree.gamma_v"],
    )


@pytest.mark.slow
def test_the_command_names_materials(slope, changed, tmp_path):
    """With a field, volumes of a power law and a line of releases beside them."""
    field = "{ from = 20, to = 30, correlation_length_m = 10 }"
    changed(
        *RANGES,
        (POINTS, 'csv = "p.csv"'),
        ("seed = 7", "count = 5"),
        ("rolling_friction_angle_deg = 32", f"rolling_friction_angle_deg = {field}"),
        ("mass_kg = 100", "volume_m3 = { exponent = 0.5, least = 0.01, most = 1 }"),
        ("x_m = 2", "along_x_m = [2, 30]"),
    )
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    dataset = read_netcdf(tmp_path / "out" / "blocks.nc")
    drawn = dataset.ground_materials_scree_gamma_v
    assert drawn.attrs["long_name"] == "fluidity of materials scree"
    names = [v.attrs.get("long_name", "") for v in dataset.variables.values()]
    assert not set(",;:()") & set("".join(names))
    study = read_slope_study(slope)
    np.testing.assert_array_equal(
        drawn, study.inputs.ground_samples["materials.scree.gamma_v"]
    )
    np.testing.assert_array_equal(dataset.mass_kg, study.release.block.mass)
    assert 2.0 <= dataset.release_x_m.min() < dataset.release_x_m.max() <= 30.0
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    said = manifest["ground"]["materials"]["meadow"]["rolling_friction_angle_deg"]
    assert said == {"from": 20, "to": 30, "correlation_length_m": 10}
    assert set(manifest["files"]) == {"slope.toml", "p.csv"}


def test_ground_without_a_material_is_told(slope, changed):
    gap = ("from_x_m = 62.5", "from_x_m = 70")
    base = ("[ground.materials.scree]", "[ground]\nc_v = 0.9\n[ground.materials.scree]")
    changed(gap, base)
    with pytest.warns(UserWarning, match="no material is at x = 62.5 to 70 m"):
        study = read_slope_study(slope)
    np.testing.assert_array_equal(study.ground.soil.c_v, [0.5, 0.5, 0.9, 0.9, 0.9])


def test_ranges_may_reach_beyond_the_profile(slope, changed):
    changed(("from_x_m = 0", "from_x_m = -1e9"), ("x_m = 200", "x_m = 1e9"))
    np.testing.assert_array_equal(
        read_slope_study(slope).ground.soil.c_v, [0.5, 0.5, 1.0, 1.0]
    )


def test_a_profile_alone_has_no_materials(slope):
    with pytest.raises(InputError, match=r"column material: .*\[ground.materials\]"):
        read_profile(slope.parent / "p.csv")

"""Materials of the ground: by ranges of x, and by a column of the profile."""

import numpy as np
import pytest
from error_messages import assert_one_line_error
from slope_study import CONSTANT, slope_text

from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.runout import read_profile, read_slope_study, run_slope_study

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
    drawn = study.inputs.ground_samples["materials_scree_gamma_v"]
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


def test_samples_are_those_of_the_study_without_cuts(slope, changed):
    by_range = read_slope_study(slope)
    by_column = read_slope_study(changed(*RANGES, (POINTS, 'csv = "p.csv"')))
    np.testing.assert_array_equal(
        by_range.inputs.ground_samples["materials_scree_gamma_v"],
        by_column.inputs.ground_samples["materials_scree_gamma_v"],
    )


def test_the_dataset_names_materials(changed):
    dataset = run_slope_study(read_slope_study(changed(("seed = 7", "count = 5"))))
    about = dataset.ground_materials_scree_gamma_v.attrs
    assert about["long_name"].startswith("of materials scree: ")
    assert dataset.ground_materials_scree_gamma_v.shape == (5,)


def test_ground_without_a_material_is_told(slope, changed, capsys):
    gap = ("from_x_m = 62.5", "from_x_m = 70")
    changed(gap)
    assert main(["runout", "slope.toml", "--out", "out"]) == 2
    assert_one_line_error(capsys, "ground.materials", "leave x = 62.5 to 70 m without")
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


@pytest.mark.parametrize(
    ("pairs", "parts"),
    [
        (
            [("from_x_m = 62.5", "from_x_m = 40")],
            ("overlap: scree and meadow", "x = 40"),
        ),
        ([("from_x_m = 62.5\n", "")], ("materials.meadow", "from_x_m and to_x_m")),
        ([("to_x_m = 200", "to_x_m = 20")], ("materials.meadow", "the larger one")),
        ([("c_v = 0.5", "c_w = 0.5")], ("materials.scree.c_w", "did you mean c_v?")),
        (
            [("to_x_m = 200", "to_xm = 200")],
            ("materials.meadow.to_xm", "did you mean to_x_m?"),
        ),
        ([("k_E = 300", "k_E = -3")], ("materials.meadow.k_E", "above 0")),
        ([("k_E = 300", 'flow = "FluidityRate"')], ("flow", "a law of one part")),
        ([("meadow", "'a meadow'")], ("a meadow", "letters, digits")),
        (
            [
                ("62.5\nto_x_m = 200", "300\nto_x_m = 400"),
                ("to_x_m = 62.5", "to_x_m = 999"),
            ],
            ("materials.meadow", "nowhere on the slope", "from x = 0 to 200"),
        ),
        (
            [("[block]", "[ground.segment.1]\nc_v = 1\n[block]")],
            ("key ground", "segments and materials"),
        ),
        ([RANGES[0]], ("materials.scree", "or a column material")),
        (
            [(POINTS, 'csv = "p.csv"')],
            ("materials.scree", "column material; leave one"),
        ),
        (
            [*RANGES, (POINTS, 'csv = "p.csv"'), ("meadow", "medow")],
            ("ground.materials", "define the material 'meadow'", "mean 'medow'?"),
        ),
        (
            [
                *RANGES,
                (POINTS, 'csv = "p.csv"'),
                ("[block]", "[ground.materials.rock]\n[block]"),
            ],
            ("materials.rock", "no row of the profile names it"),
        ),
    ],
)
def test_bad_materials_are_refused_in_one_line(changed, capsys, pairs, parts):
    changed(*pairs)
    assert main(["runout", "slope.toml", "--out", "out"]) == 2
    assert_one_line_error(capsys, "slope.toml", *parts)


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("50,20,scree", "50,20,", ("row 3, column material", "is empty")),
        ("y_m,material", "y_m,materials", ("did you mean material?",)),
        ("material\n", "material,c_v\n", ("has 3 cells, but the header has 4",)),
    ],
)
def test_bad_columns_are_refused_in_one_line(slope, changed, capsys, old, new, parts):
    changed(*RANGES, (POINTS, 'csv = "p.csv"'))
    (slope.parent / "p.csv").write_text(CSV.replace(old, new))
    assert main(["runout", "slope.toml", "--out", "out"]) == 2
    assert_one_line_error(capsys, "p.csv", *parts)


def test_a_quantity_is_said_once(slope, changed, capsys):
    (slope.parent / "p.csv").write_text(
        "x_m,y_m,material,c_v\n0,50,scree,1\n80,0,meadow,1\n200,0,,1\n"
    )
    changed(*RANGES, (POINTS, 'csv = "p.csv"'))
    assert main(["runout", "slope.toml", "--out", "out"]) == 2
    assert_one_line_error(capsys, "materials.scree.c_v", "is also a column of p.csv")


def test_a_profile_alone_has_no_materials(slope):
    with pytest.raises(InputError, match=r"column material: .*\[ground.materials\]"):
        read_profile(slope.parent / "p.csv")

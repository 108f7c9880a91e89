"""Studies of slopes that are refused: in one line, with the key and what is needed."""

import pytest
from slope_study import FAR, SLOPE, assert_refused, slope_text
from text_files import write_changed

RANGES = ("from_x_m = 0\nto_x_m = 62.5\n", "from_x_m = 62.5\nto_x_m = 200\n")
ROCK, BEYOND = "[ground.materials.rock]\n", "from_x_m = 300\nto_x_m = 400\n"
VOLUME = "{ exponent = 0.5, least = 0.01, most = 2 }"
MATERIALS = f"""
count = 400

[profile]
points_m = [[0, 50], [50, 20], [80, 0], [200, 0]]

[ground.materials.scree]
{RANGES[0]}c_v = {{ median = 0.5, geometric_sd = 1.5, correlation_length_m = 20 }}
roughness_deg = 2

[ground.materials.meadow]
{RANGES[1]}k_E = {{ mean = 700, sd = 100, least = 300 }}

[block]
volume_m3 = {VOLUME}

[release]
along_x_m = [20, 90]
clearance_m = 0.5
speed_mps = 5
"""
BY_COLUMN = (
    MATERIALS.replace(RANGES[0], "")
    .replace(RANGES[1], "")
    .replace("points_m = [[0, 50], [50, 20], [80, 0], [200, 0]]", 'csv = "p.csv"')
)
HEAD, SCREE, MEADOW, END = "x_m,y_m,material", "0,50,scree", "80,0,meadow", "200,0,"


def rows(*lines):
    return "\n".join(lines) + "\n"


OF_SLOPES = (
    ("key cuont ... did you mean count?", "count = 90", "cuont = 60"),
    ("key count ... at least 1", "count = 90", "count = 0"),
    ("key seed ... at least 0", "seed = 7", "seed = -1"),
    ("key collectors_m ... between the ends", "[40, 60]", "[60, 240]"),
    ("key collectors_m ... twice", "[40, 60]", "[60, 60]"),
    ("profile.points_m ... x that increases", "[50, 20], ", "[90, 20], "),
    ("profile.points_m ... list of [x, y]", "[50, 20], ", "[50], "),
    ("profile.points_m ... finite", "[50, 20], ", "[50, nan], "),
    ("profile.points_m ... list of [x, y]", "[50, 20], ", '["50", 20], '),
    ("profile.ponits_m ... did you mean points_m?", "points_m", "ponits_m"),
    ("profile.layer ... of a dxf only", "points_m", 'layer = "T"\npoints_m'),
    ("one of points_m, csv and dxf", "points_m", 'dxf = "slope.dxf"\npoints_m'),
    ("did you mean azimuth_deg?", "azimuth_deg = 90", "azimut_deg = 90"),
    ("profile.smooth_m ... above 0 m", "points_m", "smooth_m = 0\npoints_m"),
    ("a tenth of the profile's 200 m", "points_m", "smooth_m = 50\npoints_m"),
    ("ground.segment.02 ... number of a segment", "segment.2", "segment.02"),
    ("ground.segment.two ... number of a segment", "segment.2", "segment.two"),
    ("ground.segment.9 ... from 1 to 4", "segment.2", "segment.9"),
    ("ground.segment.2.c_w ... did you mean c_v?", "c_v = 0.5", "c_w = 0.5"),
    ("ground.segment.2.c_v ... at least 0", "c_v = 0.5", "c_v = -1"),
    ("ground.segment.2.c_v ... empty list", "c_v = 0.5", "c_v = []"),
    ("segment.2.c_v ... { mean, sd }", "c_v = 0.5", "c_v = { mean = 0.5 }"),
    ("c_v ... at least 0 ... for block", "c_v = 0.5", "c_v = { mean = 0, sd = 1 }"),
    ("in [0, 30] deg", "c_v = 0.5", "roughness_deg = 31"),
    ("did you mean roughness_deg?", "c_v = 0.5", "roughnes_deg = 4"),
    ("block.mass_kg ... holds nothing between", "least = 20", "least = 20000"),
    ("block.mass_kg.lest ... did you mean least?", "least = 20", "lest = 20"),
    ("block.mass_kg ... above 0 kg ... for block", ", least = 20", ""),
    ("is for quantities of the ground", "least = 20", "correlation_length_m = 3"),
    ("block.aspect_ratio ... empty list", "[1, 1.5, 2]", "[]"),
    ("block.aspect_ratio ... must be a number", "[1, 1.5, 2]", '"round"'),
    ("release.x_m ... { from, to }", "from = 2, to = 6", "from = 2"),
    ("release.x_m ... go up", "from = 2, to = 6", "from = 6, to = 2"),
    ("key release ... is released at x", "from = 2, to = 6", "from = -2, to = 6"),
    ("key release ... in the ground", "clearance_m = 0.5", "y_m = 40"),
    ("key release ... y_m or clearance_m", "clearance_m = 0.5", ""),
    ("release.clearance_m ... least 0", "clearance_m = 0.5", "clearance_m = -1"),
    ("release ... speed_mps and v_x", "clearance_m", "v_x_mps = 5\nclearance_m"),
    ("did you mean frictional ell", "frictional ", "frictionless "),
    ("contacts.e_contact ... is needed", "e_contact = 0.3", ""),
    ("contacts.e_contact ... in [0, 1]", "e_contact = 0.3", "e_contact = 1.3"),
    ("contacts.law ... takes none", "seed = 7", 'accuracy = "fast"'),
    ("at least 1", "export_trajectories = 70", "export_trajectories = 0"),
    ("barriers.2.x_m ... between the ends", "x_m = 85", "x_m = 285"),
)
OF_MATERIALS = (
    ("overlap: scree and meadow ... x = 40", "m = 62.5\nto_x", "m = 40\nto_x"),
    ("leave x = 62.5 to 70 m without", "from_x_m = 62.5", "from_x_m = 70"),
    ("materials.meadow ... from_x_m and to_x_m", "from_x_m = 62.5\n", ""),
    ("materials.meadow ... the larger one", "to_x_m = 200", "to_x_m = 20"),
    ("materials.rock ... from x = 0 to 200", "[block]", f"{ROCK}{BEYOND}[block]"),
    ("materials.scree ... or a column material", RANGES[0], ""),
    ("scree.c_v.corr ... above 0 m", "length_m = 20", "length_m = 0"),
    ("scree.c_w ... did you mean c_v?", "c_v =", "c_w ="),
    ("meadow.to_xm ... did you mean to_x_m?", "to_x_m = 200", "to_xm = 200"),
    ("flow ... a law of one part", "roughness_deg = 2", 'flow = "FluidityRate"'),
    ("a meadow ... letters, digits", ".meadow", ".'a meadow'"),
    ("not valid TOML ... than a to z is written in double quotes", ".meadow", ".Hügel"),
    ("segments and materials", "[block]", "[ground.segment.1]\nc_v = 1\n[block]"),
    # Distributions and fields.
    ("k_E ... above 0 ... for block", "sd = 100, least = 300", "sd = 700"),
    ("materials.meadow.k_E ... { mean, sd }", ", sd = 100, least = 300", ""),
    ("correlation_length_m ... a number", "length_m = 20", 'length_m = "a"'),
    ("mean correlation_length_m?", "correlation_length", "correlation_lenght"),
    ("c_v.corr ... 8e+04 cells of 0.0025 m", "length_m = 20", "length_m = 0.01"),
    # Volumes and lines of releases.
    ("mass_kg or volume_m3, not", "[block]", "[block]\nmass_kg = 3"),
    ("block.volume ... did you mean volume_m3?", "volume_m3", "volume"),
    ("volume_m3 ... above 0 m3", VOLUME, "0"),
    ("volume_m3 ... above 0 m3 ... for block", VOLUME, "{ mean = 1, sd = 1 }"),
    ("key release ... x_m or along_x_m, not", "[20, 90]", "[20, 90]\nx_m = 3"),
    ("release: needs x_m or along_x_m, but has neither", "along_x_m = [20, 90]\n", ""),
    ("release.along_x_m ... list of two x", "[20, 90]", "30"),
    ("release.along_x_m ... list of two x", "[20, 90]", "[20, 30, 90]"),
    ("release.along_x_m ... must go up", "[20, 90]", "[90, 20]"),
    ("release.along_x_m ... 0 and 200", "[20, 90]", "[20, 201]"),
    ("release.along_x_m ... finite", "[20, 90]", "[20, nan]"),
    ("spacing_m ... above 0", "[20, 90]", "[20, 90]\nspacing_m = 0"),
    ("spacing_m ... 81.0", "[20, 90]", "[20, 90]\nspacing_m = 91"),
    ("spacing_m ... 100000 places", "[20, 90]", "[20, 90]\nspacing_m = 1e-9"),
    ("spacing_m ... along_x_m", "along_x_m = [20, 90]", "x_m = 3\nspacing_m = 2"),
)
OF_COLUMNS = (
    ("key profile ... one of points_m, csv and dxf", 'csv = "p.csv"\n', ""),
    ("scree ... column material; leave one", ".scree]\n", f".scree]\n{RANGES[0]}"),
    ("define the material 'meadow' ... mean 'medow'?", ".meadow", ".medow"),
    ("materials.rock ... no row of the profile", "[block]", f"{ROCK}[block]"),
)

START = "x_m = { from = 2600001.25, to = 2600002.5 }"
FAR_ROCK = ROCK + BEYOND.replace("300", "2600800").replace("400", "2600900")
IN_NATIONAL_COORDINATES = (
    ("2600730.5 ... from 2600000 to 2600730", START, "x_m = 2600730.5"),
    (
        "x_m ... from 2600002.5 to 2600001",
        START,
        "x_m = { from = 2600002.5, to = 2600001 }",
    ),
    ("2600000 and 2600730, but", START, "along_x_m = [2600001, 2600731]"),
    ("from x = 2600000 to 2600730", "[block]", f"{FAR_ROCK}[block]"),
)


@pytest.mark.parametrize(
    ("text", "message", "old", "new"),
    [
        *((SLOPE, *row) for row in OF_SLOPES),
        *((MATERIALS, *row) for row in OF_MATERIALS),
        *((BY_COLUMN, *row) for row in OF_COLUMNS),
        *((FAR, *row) for row in IN_NATIONAL_COORDINATES),
    ],
    ids=lambda value: None if "\n\n" in value else value,
)
def test_studies(folder, capsys, text, message, old, new):
    (folder / "p.csv").write_text(rows(HEAD, SCREE, "50,20,scree", MEADOW, END))
    write_changed(folder / "slope.toml", text, (old, new))
    assert_refused(capsys, f"slope.toml ... {message}")


@pytest.mark.parametrize(
    ("message", "content"),
    [
        ("row 3, column material ... is empty", rows(HEAD, SCREE, "50,20,", END)),
        ("did you mean material?", rows(HEAD + "s", SCREE, MEADOW, END)),
        ("has 3 cells, but the header has 4", rows(HEAD + ",c_v", SCREE, MEADOW, END)),
        (
            "materials.scree.c_v ... is also a column of p.csv",
            rows(HEAD + ",c_v", SCREE + ",1", MEADOW + ",1", END + ",1"),
        ),
    ],
)
def test_columns_of_materials(folder, capsys, message, content):
    (folder / "p.csv").write_text(content)
    (folder / "slope.toml").write_text(BY_COLUMN)
    assert_refused(capsys, message)


@pytest.mark.parametrize("value", ["[0.5, 1]", "0.5", "{ from = 0.1, to = 1 }"])
@pytest.mark.parametrize("table", ["ground", "ground.segment.2"])
def test_a_quantity_beside_a_column_of_the_profile(folder, capsys, table, value):
    (folder / "p.csv").write_text(rows("x_m,y_m,c_v", "0,50,1", "80,0,0.2", "200,0,0"))
    text = slope_text(profile='csv = "p.csv"', ground=f"[{table}]\nc_v = {value}")
    (folder / "slope.toml").write_text(text)
    assert_refused(capsys, f"key {table}.c_v ... is also a column of p.csv")

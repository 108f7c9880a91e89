"""Slope profiles from DXF drawings."""

import sys
import warnings

import numpy as np
import pytest
from error_messages import assert_one_line_error

from jaximpact.cli import main
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.runout import read_slope_study
from jaximpact.runout.dxf_profile import read_dxf_points

UNUSUAL = "jaximpact.errors.UnusualValueWarning"
X, Y = [0.0, 400.0, 1000.0], [230.0, 0.0, 0.0]
HEAD = "0\nSECTION\n2\nENTITIES\n"
TAIL = "0\nENDSEC\n0\nEOF\n"


@pytest.fixture
def drawing():
    ezdxf = pytest.importorskip("ezdxf")
    return ezdxf.new("R2010")


def read(drawing, path, layer=None):
    drawing.saveas(path / "slope.dxf")
    return read_dxf_points(path / "slope.dxf", layer)


def line(x_0, y_0, x_1, y_1, layer="0"):
    """A LINE as the oldest version has it."""
    return f"0\nLINE\n8\n{layer}\n10\n{x_0}\n20\n{y_0}\n11\n{x_1}\n21\n{y_1}\n"


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("kind", ["lwpolyline", "polyline2d", "polyline3d"])
def test_a_polyline_is_a_profile(drawing, tmp_path, kind, backwards):
    points = list(zip(X, Y, [7.0] * 3, strict=True))
    if kind == "lwpolyline":
        points = [(x, y) for x, y, _ in points]
    space = drawing.modelspace()
    getattr(space, f"add_{kind}")(points[::-1] if backwards else points)
    x, y = read(drawing, tmp_path)
    np.testing.assert_array_equal(x, X)
    np.testing.assert_array_equal(y, Y)


def test_a_line_that_is_drawn_twice_is_one(drawing, tmp_path):
    space = drawing.modelspace()
    space.add_line((0, 230), (400, 0))
    space.add_line((400, 0), (0, 230))
    np.testing.assert_array_equal(read(drawing, tmp_path)[0], [0.0, 400.0])


def test_lines_in_any_order_are_joined(tmp_path):
    pytest.importorskip("ezdxf")
    text = HEAD + line(1000, 0, 400, 0) + line(0, 230, 100, 172.5)
    text += line(400, 1e-7, 100, 172.5) + TAIL
    (tmp_path / "slope.dxf").write_text(text)
    x, y = read_dxf_points(tmp_path / "slope.dxf")
    np.testing.assert_array_equal(x, [0.0, 100.0, 400.0, 1000.0])
    np.testing.assert_allclose(y, [230.0, 172.5, 0.0, 0.0], atol=1e-6)


def test_arcs_of_polylines_are_cut_to_chords(drawing, tmp_path):
    # A quarter of a circle of 100 m.
    bulge = np.tan(np.pi / 8.0)
    drawing.modelspace().add_lwpolyline(
        [(0, 100, bulge), (100, 0, 0), (200, 0, 0)], format="xyb"
    )
    x, y = read(drawing, tmp_path)
    arc = x <= 100.0
    distance = np.hypot(x[arc] - 100.0, y[arc] - 100.0)
    # The cubic curves that ezdxf takes for a quarter of a circle.
    np.testing.assert_allclose(distance, 100.0, rtol=3e-4)
    middle = np.hypot(0.5 * (x[1:] + x[:-1]) - 100, 0.5 * (y[1:] + y[:-1]) - 100)
    assert np.max(np.abs(middle[:-1] - 100.0)) <= 0.01 + 0.03


def test_control_points_of_a_fitted_polyline_are_not_its_points(drawing, tmp_path):
    points = [(0.0, 230.0), (150.0, 400.0), (400.0, 0.0), (1000.0, 0.0)]
    polyline = drawing.modelspace().add_polyline2d(points)
    polyline.dxf.flags |= 4
    polyline.vertices[1].dxf.flags |= 16
    np.testing.assert_array_equal(read(drawing, tmp_path)[0], X)


def test_points_that_stand_twice_are_dropped(drawing, tmp_path):
    drawing.modelspace().add_lwpolyline([(0, 5), (0, 5), (9, 1), (9, 1)])
    np.testing.assert_array_equal(read(drawing, tmp_path)[0], [0.0, 9.0])


def test_arcs_that_join_lines_are_part_of_the_profile(drawing, tmp_path):
    space = drawing.modelspace()
    space.add_line((0, 100), (50, 100))
    space.add_arc((50, 50), 50, 0, 90)
    x, y = read(drawing, tmp_path)
    arc = x >= 50.0
    assert np.count_nonzero(arc) > 10
    np.testing.assert_allclose(np.hypot(x[arc] - 50, y[arc] - 50), 50.0, rtol=3e-4)


@pytest.mark.filterwarnings(f"always::{UNUSUAL}")
@pytest.mark.parametrize(
    ("number", "unit", "metre"),
    [
        *((1, "inches", 0.0254), (2, "feet", 0.3048), (4, "millimetres", 1e-3)),
        *((5, "centimetres", 1e-2), (7, "kilometres", 1e3), (10, "yards", 0.9144)),
        *((14, "decimetres", 0.1), (21, "US survey feet", 1200.0 / 3937.0)),
        (23, "US survey yards", 3600.0 / 3937.0),
    ],
)
def test_the_unit_of_a_drawing_is_heeded_with_a_word(
    drawing, tmp_path, number, unit, metre
):
    drawing.modelspace().add_lwpolyline([(x, y) for x, y in zip(X, Y, strict=True)])
    drawing.header["$INSUNITS"] = number
    with pytest.warns(UnusualValueWarning, match=rf"slope.dxf: is in {unit} by its"):
        x, y = read(drawing, tmp_path)
    np.testing.assert_allclose(x, metre * np.array(X), rtol=1e-15)
    np.testing.assert_allclose(y, metre * np.array(Y), rtol=1e-15)


@pytest.mark.parametrize("number", [0, 6])
def test_metres_and_no_unit_are_taken_as_they_are(drawing, tmp_path, number):
    drawing.modelspace().add_lwpolyline([(x, y) for x, y in zip(X, Y, strict=True)])
    drawing.header["$INSUNITS"] = number
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        np.testing.assert_array_equal(read(drawing, tmp_path)[0], X)


def test_a_unit_of_no_slope_is_refused(drawing, tmp_path):
    drawing.modelspace().add_line((0, 9), (9, 0))
    drawing.header["$INSUNITS"] = 20
    with pytest.raises(InputError, match="INSUNITS 20, which is no unit of slopes"):
        read(drawing, tmp_path)


@pytest.mark.filterwarnings(f"always::{UNUSUAL}")
def test_what_is_not_read_beside_lines_is_told(drawing, tmp_path):
    space = drawing.modelspace()
    space.add_line((0, 9), (9, 0))
    space.add_text("section 3")
    space.add_blockref("ROCK", (9, 0))
    space.add_mline([(9, 0), (20, 0)], dxfattribs={"layer": "T"})
    space.add_polymesh((3, 3), dxfattribs={"layer": "T"})
    insert = "1 INSERT whose block is in no or in another file"
    with pytest.warns(UnusualValueWarning, match=f"{insert}, 1 MLINE, 1 mesh, which"):
        read(drawing, tmp_path)
    with pytest.warns(UnusualValueWarning, match=f"{insert}, which"):
        read(drawing, tmp_path, "0")


def insert_of_lines(drawing, at=(0.0, 0.0), **attributes):
    """Insert a block that has the profile on layer 0 into the model space."""
    block = drawing.blocks.new("SECTION")
    block.add_lwpolyline(list(zip(X, Y, strict=True)))
    drawing.modelspace().add_blockref("SECTION", at, dxfattribs=attributes)


def turned(x, y, degrees):
    return np.exp(1j * np.radians(degrees)) * (np.asarray(x) + 1j * np.asarray(y))


@pytest.mark.parametrize(
    ("attributes", "x", "y"),
    [
        ({}, np.array(X) + 10.0, np.array(Y) + 20.0),
        ({"xscale": 0.5, "yscale": 2.0}, 0.5 * np.array(X) + 10, 2 * np.array(Y) + 20),
        ({"xscale": -1.0}, 10.0 - np.array(X[::-1]), np.array(Y[::-1]) + 20.0),
        (
            {"rotation": 10.0, "zscale": 3.0},
            turned(X, Y, 10.0).real + 10.0,
            turned(X, Y, 10.0).imag + 20.0,
        ),
    ],
)
def test_what_is_drawn_in_a_block_is_read_where_it_is_inserted(
    drawing, tmp_path, attributes, x, y
):
    insert_of_lines(drawing, (10.0, 20.0), **attributes)
    # Rounding of coordinates up to 1000 m.
    np.testing.assert_allclose(read(drawing, tmp_path), [x, y], atol=1e-9)


def test_blocks_in_blocks_keep_their_curves_and_take_the_layer_of_the_insertion(
    drawing, tmp_path
):
    inner = drawing.blocks.new("INNER")
    inner.add_line((0, 100), (50, 100))
    inner.add_arc((50, 50), 50, 0, 90, dxfattribs={"layer": "T"})
    outer = drawing.blocks.new("OUTER")
    outer.add_blockref("INNER", (5, 5), dxfattribs={"yscale": 0.5})
    space = drawing.modelspace()
    space.add_blockref("OUTER", (-10, 0), dxfattribs={"xscale": 2.0, "layer": "T"})
    space.add_line((0, 900), (1, 800))
    x, y = read(drawing, tmp_path, "t")
    np.testing.assert_allclose([x[0], y[0]], [0.0, 55.0], atol=1e-9)
    ellipse = np.hypot((x[1:] - 100.0) / 100.0, (y[1:] - 30.0) / 25.0)
    # As far as ezdxf's cubic curves are from an arc.
    np.testing.assert_allclose(ellipse, 1.0, rtol=3e-4)
    assert len(x) > 10


def test_a_block_that_is_no_part_of_the_line_is_refused_by_name(drawing, tmp_path):
    insert_of_lines(drawing)
    drawing.modelspace().add_line((0, 900), (1, 800))
    with pytest.raises(InputError, match="not join, some of them in the blocks SECT"):
        read(drawing, tmp_path)


def test_a_block_in_itself_is_refused(drawing, tmp_path):
    insert_of_lines(drawing)
    drawing.blocks.get("SECTION").add_blockref("SECTION", (1, 1))
    with pytest.raises(InputError, match="the block 'SECTION' contains itself"):
        read(drawing, tmp_path)


AREA = [*zip(X, Y, strict=True), (1000.0, -50.0), (300.0, -90.0), (0.0, -50.0)]
"""Section drawn as a closed area, with vertical sides."""


@pytest.mark.filterwarnings(f"always::{UNUSUAL}")
@pytest.mark.parametrize("shift", [0, 1, 4])
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("origin", [0.0, 2.6e6])
@pytest.mark.parametrize("kind", ["closed", "repeated point", "lines"])
def test_the_upper_part_of_a_closed_line_is_the_profile(
    drawing, tmp_path, kind, origin, backwards, shift
):
    points = [(x + origin, y) for x, y in AREA[shift:] + AREA[:shift]]
    points, space = points[::-1] if backwards else points, drawing.modelspace()
    if kind == "closed":
        space.add_lwpolyline(points, close=True)
    elif kind == "repeated point":
        space.add_lwpolyline([*points, points[0]])
    else:
        for start, end in zip(points, [*points[1:], points[0]], strict=True):
            space.add_line(start, end)
    with pytest.warns(UnusualValueWarning, match="has a closed line; its upper part"):
        x, y = read(drawing, tmp_path)
    np.testing.assert_array_equal(x - origin, X)
    np.testing.assert_array_equal(y, Y)


def lines_with_gaps(drawing, gap):
    """Two gaps, of which the second is half of the first."""
    space = drawing.modelspace()
    space.add_line((0, 230), (100, 170))
    space.add_line((400, 0), (100 + gap, 170))
    space.add_line((400, 0.5 * gap), (1000, 0))


@pytest.mark.filterwarnings(f"always::{UNUSUAL}")
@pytest.mark.parametrize("gap", [1e-4, 1e-3, 2e-3])
def test_gaps_of_a_millimetre_or_two_are_closed_with_a_word(drawing, tmp_path, gap):
    lines_with_gaps(drawing, gap)
    said = rf"closed: 2, the largest {1e3 * gap:g} mm at \(100, 170\) m"
    with pytest.warns(UnusualValueWarning, match=said):
        x, y = read(drawing, tmp_path)
    np.testing.assert_allclose(x, [0.0, 100.0, 400.0, 1000.0], atol=gap)
    np.testing.assert_allclose(y, [230.0, 170.0, 0.0, 0.0], atol=gap)


@pytest.mark.parametrize("gap", [0.01, 0.05, 3.0])
def test_larger_gaps_are_refused_with_their_place(drawing, tmp_path, gap):
    lines_with_gaps(drawing, gap)
    said = rf"has 3 lines .* are {0.5 * gap:g} m apart, at \(400, 0\) m and \(400, "
    with pytest.raises(InputError, match=said):
        read(drawing, tmp_path)


def test_a_line_that_forks_is_refused_with_its_place(drawing, tmp_path):
    space = drawing.modelspace()
    for end in ((0, 230), (400, 0), (200, 170)):
        space.add_line((100, 170), end)
    with pytest.raises(InputError, match=r"more than two ends meet at \(100, 170\) m"):
        read(drawing, tmp_path)


def test_what_is_on_other_layers_is_not_looked_at(drawing, tmp_path):
    space = drawing.modelspace()
    space.add_line((0, 9), (9, 0), dxfattribs={"layer": "T"})
    space.add_polyline3d([(0, 0, 230), (400, 0, 0)], dxfattribs={"layer": "CONTOURS"})
    np.testing.assert_array_equal(read(drawing, tmp_path, "T")[0], [0.0, 9.0])


@pytest.mark.parametrize("bulge", [1e9, 1e100, 1e300, np.inf, np.nan])
def test_bulges_without_bound_are_refused(drawing, tmp_path, bulge):
    drawing.modelspace().add_lwpolyline(
        [(0, 100, bulge), (100, 0, 0), (200, 0, 0)], format="xyb"
    )
    with pytest.raises(
        InputError, match=r"slope.dxf: (has a curve|is no DXF)"
    ) as error:
        read(drawing, tmp_path)
    assert "\n" not in str(error.value)


def test_a_large_arc_has_few_chords(drawing, tmp_path):
    # A radius of 25 000 km, whose chords within a centimetre would be 100 000.
    drawing.modelspace().add_lwpolyline(
        [(0, 100, 1e6), (100, 0, 0), (200, 0, 0)], format="xyb"
    )
    assert len(read(drawing, tmp_path)[0]) < 5000


def test_many_lines_are_joined_in_no_time(drawing, tmp_path):
    """Each compared with each, 5000 take a minute."""
    x = np.linspace(0.0, 1000.0, 5001)
    for i in np.random.default_rng(0).permutation(5000):
        ends = [(x[i], 100.0 - 0.1 * x[i]), (x[i + 1], 100.0 - 0.1 * x[i + 1])]
        drawing.modelspace().add_line(*(ends if i % 3 else ends[::-1]))
    np.testing.assert_array_equal(read(drawing, tmp_path)[0], x)


def test_a_layer_chooses(drawing, tmp_path):
    space = drawing.modelspace()
    points = list(zip(X, Y, strict=True))
    space.add_lwpolyline(points, dxfattribs={"layer": "TERRAIN"})
    space.add_line((0, 240), (900, 10), dxfattribs={"layer": "ROCK"})
    np.testing.assert_array_equal(read(drawing, tmp_path, "TERRAIN")[0], X)
    said = (
        r"2 layers \('TERRAIN': 1, 'ROCK': 1\); layer .* are 10 m apart, at \(0, 230\)"
    )
    with pytest.raises(InputError, match=said):
        read(drawing, tmp_path)
    with pytest.raises(InputError, match="'TERAIN'; did you mean 'TERRAIN'"):
        read(drawing, tmp_path, "TERAIN")
    space.add_line((0, 250), (900, 20), dxfattribs={"layer": "ROCK"})
    with pytest.raises(InputError, match="has 2 lines on the layer 'ROCK' that do not"):
        read(drawing, tmp_path, "ROCK")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is no DXF drawing that can be read"),
        ("x_m,y_m\n0,1\n", "is no DXF drawing that can be read"),
        (HEAD + line(0, 5, 9, 1), "is no DXF drawing that can be read"),
        (HEAD + line(0, "high", 9, 1) + TAIL, "is no DXF drawing that can be read"),
        (HEAD + TAIL, "has no LINE, LWPOLYLINE, .* or SPLINE"),
        (HEAD + line(3, 3, 3, 3) + TAIL, "has no LINE"),
        (HEAD + "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n5\n" + TAIL, "has no LINE"),
        (
            HEAD + "0\nLINE\n8\nT\n10\n0\n20\n5\n30\n0\n11\n9\n21\n1\n31\n4\n" + TAIL,
            "layer 'T' whose z changes",
        ),
    ],
)
def test_what_is_no_profile_is_refused_in_a_line(tmp_path, text, said):
    pytest.importorskip("ezdxf")
    path = tmp_path / "slope.dxf"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as error:
        read_dxf_points(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


STUDY = """
[profile]
dxf = "slope.dxf"
layer = "T"

[release]
x_m = 2
clearance_m = 1
"""


@pytest.fixture
def slope(folder):
    text = HEAD + line(0, 230, 400, 0, "T") + line(400, 0, 1000, 0, "T")
    (folder / "slope.dxf").write_text(text + line(0, 9, 9, 9) + TAIL)
    (folder / "slope.toml").write_text(STUDY)
    return folder / "slope.toml"


def test_a_study_takes_a_drawing(slope):
    pytest.importorskip("ezdxf")
    study = read_slope_study(slope)
    np.testing.assert_array_equal(study.profile.x, X)
    assert set(study.inputs.checksums_by_name) == {"slope.toml", "slope.dxf"}


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ('dxf = "slope.dxf"', 'csv = "slope.dxf"', ("profile.layer", "of a dxf only")),
        ('"T"', '"T"\npoints_m = []', ("key profile", "one of points_m, csv and dxf")),
        ('dxf = "slope.dxf"\n', "", ("key profile", "one of points_m, csv and dxf")),
        ('"slope.dxf"', '"slop.dxf"', ("slop.dxf", "cannot be read")),
        ('"T"', "3", ("layer", "must be a text")),
    ],
)
def test_bad_studies_are_refused_in_one_line(slope, capsys, old, new, parts):
    slope.write_text(STUDY.replace(old, new))
    assert main(["runout", "slope.toml", "--out", "out"]) == 2
    assert_one_line_error(capsys, *parts)


def test_a_vertical_wall_is_refused(slope, capsys):
    pytest.importorskip("ezdxf")
    text = HEAD + line(0, 230, 400, 50, "T") + line(400, 50, 400, 0, "T") + TAIL
    (slope.parent / "slope.dxf").write_text(text)
    assert main(["runout", "slope.toml", "--out", "out"]) == 2
    assert_one_line_error(capsys, "slope.dxf", "a wall needs some width")


def test_without_the_package_it_is_named(slope, capsys, monkeypatch):
    for name in ("ezdxf", "ezdxf.filemanagement", "ezdxf.path"):
        monkeypatch.setitem(sys.modules, name, None)
    assert main(["runout", "slope.toml", "--out", "out"]) == 2
    assert_one_line_error(capsys, "slope.dxf", "pip install ezdxf")

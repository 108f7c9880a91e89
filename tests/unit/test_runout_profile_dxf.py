"""Slope profiles from DXF drawings."""

import sys

import numpy as np
import pytest
from error_messages import warned_once

from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.runout import read_slope_study
from jaximpact.runout.dxf_profile import read_dxf_points

ezdxf = pytest.importorskip("ezdxf")

X, Y = [0.0, 400.0, 1000.0], [230.0, 0.0, 0.0]
POINTS = list(zip(X, Y, strict=True))
HEAD = "0\nSECTION\n2\nENTITIES\n"
TAIL = "0\nENDSEC\n0\nEOF\n"


@pytest.fixture
def drawing():
    return ezdxf.new("R2010")


def read(drawing, path, layer=None):
    drawing.saveas(path / "slope.dxf")
    return read_dxf_points(path / "slope.dxf", layer)


def line(x_0, y_0, x_1, y_1, layer="0"):
    """A LINE as the oldest version has it."""
    return f"0\nLINE\n8\n{layer}\n10\n{x_0}\n20\n{y_0}\n11\n{x_1}\n21\n{y_1}\n"


def fitted_polyline(space):
    """A polyline with a control point, which is no point of it."""
    polyline = space.add_polyline2d([POINTS[0], (150.0, 400.0), *POINTS[1:]])
    polyline.dxf.flags |= 4
    polyline.vertices[1].dxf.flags |= 16


def beside_contours(space, contours=True):
    """On two layers, and on one more contour lines, whose z changes."""
    for height, layer in ((0, "T"), (10, "ROCK"), (20, "ROCK")):
        points = [(x, y + height) for x, y in POINTS]
        space.add_lwpolyline(points, dxfattribs={"layer": layer})
    if contours:
        layer = {"layer": "CONTOURS"}
        space.add_polyline3d([(0, 0, 9), (9, 0, 0)], dxfattribs=layer)


@pytest.mark.parametrize(
    ("draw", "layer"),
    [
        *(
            (lambda space, by=by: space.add_lwpolyline(POINTS[::by]), None)
            for by in (1, -1)
        ),
        (lambda space: space.add_polyline2d(POINTS), None),
        (lambda space: space.add_polyline3d([(*p, 7.0) for p in POINTS[::-1]]), None),
        (lambda space: space.add_lwpolyline(np.repeat(POINTS, 2, axis=0)), None),
        (fitted_polyline, None),
        (beside_contours, "T"),
        (beside_contours, "t"),
    ],
)
def test_a_polyline_is_a_profile(drawing, tmp_path, draw, layer):
    """Either way, with points that stand twice, on one of many layers."""
    draw(drawing.modelspace())
    x, y = read(drawing, tmp_path, layer)
    np.testing.assert_array_equal(x, X)
    np.testing.assert_array_equal(y, Y)


def drawn_again(space, *lines):
    """The profile as two lines and more, each by the numbers of its points."""
    for start, end in ((0, 1), (1, 2), *lines):
        space.add_line(POINTS[start], POINTS[end])


@pytest.mark.parametrize(
    "draw",
    [
        lambda space: drawn_again(space, (0, 1)),
        lambda space: drawn_again(space, (1, 0)),
        lambda space: drawn_again(space, (1, 2)),
        lambda space: drawn_again(space, (2, 1), (0, 1), (0, 1), (1, 2)),
        lambda space: [space.add_lwpolyline(POINTS[::by]) for by in (1, 1, 1)],
        lambda space: [space.add_lwpolyline(POINTS[::by]) for by in (1, -1)],
        lambda space: [
            space.add_lwpolyline(POINTS, dxfattribs={"layer": layer})
            for layer in ("T", "COPY")
        ],
        lambda space: [
            space.add_lwpolyline([(x + by, y - by) for x, y in POINTS])
            for by in (0.0, 1e-9)
        ],
    ],
)
def test_a_line_that_is_drawn_twice_is_one(drawing, tmp_path, draw):
    """In either direction, on another layer, or moved by a rounding."""
    draw(drawing.modelspace())
    x, y = read(drawing, tmp_path)
    np.testing.assert_array_equal(x, X)
    np.testing.assert_array_equal(y, Y)


def test_lines_in_any_order_are_joined(tmp_path):
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


def test_arcs_that_join_lines_are_part_of_the_profile(drawing, tmp_path):
    space = drawing.modelspace()
    space.add_line((0, 100), (50, 100))
    space.add_arc((50, 50), 50, 0, 90)
    x, y = read(drawing, tmp_path)
    arc = x >= 50.0
    assert np.count_nonzero(arc) > 10
    np.testing.assert_allclose(np.hypot(x[arc] - 50, y[arc] - 50), 50.0, rtol=3e-4)


@pytest.mark.parametrize(
    ("number", "unit", "metre"),
    [
        *((1, "inches", 0.0254), (2, "feet", 0.3048), (4, "millimetres", 1e-3)),
        *((5, "centimetres", 1e-2), (7, "kilometres", 1e3), (10, "yards", 0.9144)),
        *((14, "decimetres", 0.1), (21, "US survey feet", 1200.0 / 3937.0)),
        *((23, "US survey yards", 3600.0 / 3937.0), (0, None, 1.0), (6, None, 1.0)),
    ],
)
def test_the_unit_of_a_drawing_is_heeded_with_a_word(
    drawing, tmp_path, number, unit, metre
):
    drawing.modelspace().add_lwpolyline(POINTS)
    drawing.header["$INSUNITS"] = number
    said = unit and rf"slope\.dxf: is in {unit} by its"
    with warned_once(UnusualValueWarning, said):
        x, y = read(drawing, tmp_path)
    np.testing.assert_allclose(x, metre * np.array(X), rtol=1e-15)
    np.testing.assert_allclose(y, metre * np.array(Y), rtol=1e-15)


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


def beyond_the_end(drawing, layer, **attributes):
    """The profile on a layer T, and a line on another layer that goes on from it."""
    drawing.modelspace().add_lwpolyline(POINTS, dxfattribs={"layer": "T"})
    attributes["layer"] = layer
    drawing.modelspace().add_line(POINTS[-1], (1500, 300), dxfattribs=attributes)


@pytest.mark.parametrize("how", ["off", "freeze", "invisible"])
def test_what_a_drawing_hides_is_no_part_of_the_profile(drawing, tmp_path, how):
    layer = drawing.layers.add("OLD")
    if how == "invisible":
        beyond_the_end(drawing, "OLD", invisible=1)
    else:
        beyond_the_end(drawing, "OLD")
        getattr(layer, how)()
    said = r"slope\.dxf: lines that are invisible, or .* passed over \('OLD': 1\); show"
    with warned_once(UnusualValueWarning, said):
        x, y = read(drawing, tmp_path)
    np.testing.assert_array_equal(x, X)
    np.testing.assert_array_equal(y, Y)
    with warned_once(UnusualValueWarning, None):
        x, y = read(drawing, tmp_path, "T")
    np.testing.assert_array_equal(x, X)


@pytest.mark.parametrize("how", ["off", "freeze"])
def test_a_hidden_layer_that_is_named_is_read(drawing, tmp_path, how):
    getattr(drawing.layers.add("Old"), how)()
    beyond_the_end(drawing, "Old")
    x, y = read(drawing, tmp_path, "OLD")
    np.testing.assert_array_equal([x, y], [[1000.0, 1500.0], [0.0, 300.0]])


def test_a_drawing_of_hidden_lines_alone_is_refused(drawing, tmp_path):
    drawing.layers.add("OLD").freeze()
    drawing.modelspace().add_lwpolyline(POINTS, dxfattribs={"layer": "OLD"})
    said = r"has no line to be read: .* \('OLD': 1\); show .* or let layer name the lay"
    with pytest.raises(InputError, match=said):
        read(drawing, tmp_path)


@pytest.mark.parametrize(
    ("how", "hidden"), [("off", "'ROW': 1"), ("freeze", "'ROW': 1, 'A': 1")]
)
def test_a_hidden_insertion_hides_its_block(drawing, tmp_path, how, hidden):
    """One on a frozen layer all of it, one that is off what the block has there."""
    block = drawing.blocks.new("SECTION")
    block.add_line((1000, 0), (1500, 300))
    block.add_line((1000, 0), (1200, 0), dxfattribs={"layer": "A"})
    getattr(drawing.layers.add("ROW"), how)()
    space = drawing.modelspace()
    space.add_lwpolyline(POINTS)
    space.add_blockref("SECTION", (0, 0), dxfattribs={"layer": "ROW"})
    with pytest.warns(UnusualValueWarning, match=rf"passed over \({hidden}\); show"):
        x, _ = read(drawing, tmp_path)
    # The line on A goes on from the profile.
    np.testing.assert_array_equal(x, [*X, 1200.0] if how == "off" else X)


def insert_of_lines(drawing, at=(0.0, 0.0), **attributes):
    """Insert a block that has the profile on layer 0 into the model space."""
    block = drawing.blocks.new("SECTION")
    block.add_lwpolyline(POINTS)
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


AREA = [*POINTS, (1000.0, -50.0), (300.0, -90.0), (0.0, -50.0)]
"""Section drawn as a closed area, with vertical sides."""


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


@pytest.mark.parametrize("gap", [1e-4, 1e-3, 2e-3])
def test_gaps_of_a_millimetre_or_two_are_closed_with_a_word(drawing, tmp_path, gap):
    lines_with_gaps(drawing, gap)
    said = rf"closed: 2, the largest {1e3 * gap:g} mm at \(100, 170\) m"
    with pytest.warns(UnusualValueWarning, match=said):
        x, y = read(drawing, tmp_path)
    np.testing.assert_allclose(x, [0.0, 100.0, 400.0, 1000.0], atol=gap)
    np.testing.assert_allclose(y, [230.0, 170.0, 0.0, 0.0], atol=gap)


def forks(drawing):
    for end in ((0, 230), (400, 0), (200, 170)):
        drawing.modelspace().add_line((100, 170), end)


def layers(drawing):
    beside_contours(drawing.modelspace(), contours=False)


def contours(drawing):
    beside_contours(drawing.modelspace())


def of_no_slope(drawing):
    drawing.modelspace().add_line((0, 9), (9, 0))
    drawing.header["$INSUNITS"] = 20


def not_of_the_line(drawing):
    insert_of_lines(drawing)
    drawing.modelspace().add_line((0, 900), (1, 800))


def in_itself(drawing):
    insert_of_lines(drawing)
    drawing.blocks.get("SECTION").add_blockref("SECTION", (1, 1))


@pytest.mark.parametrize(
    ("message", "draw", "layer"),
    [
        *(
            (
                rf"has 3 lines .* are {0.5 * gap:g} m apart, at \(400, 0\) m and",
                lambda drawing, gap=gap: lines_with_gaps(drawing, gap),
                None,
            )
            for gap in (0.01, 0.05, 3.0)
        ),
        (r"more than two ends meet at \(100, 170\) m", forks, None),
        ("INSUNITS 20, which is no unit of slopes", of_no_slope, None),
        ("not join, some of them in the blocks SECT", not_of_the_line, None),
        ("the block 'SECTION' contains itself", in_itself, None),
        (r"\('T': 1, 'ROCK': 2\); .* 10 m apart, at \(0, 230\)", layers, None),
        ("'ROC'; did you mean 'ROCK'", layers, "ROC"),
        ("has 2 lines on the layer 'ROCK' that do not", layers, "ROCK"),
        ("layer 'CONTOURS' whose z changes", contours, "CONTOURS"),
    ],
)
def test_drawings_of_no_profile_are_refused(drawing, tmp_path, message, draw, layer):
    draw(drawing)
    with pytest.raises(InputError, match=message):
        read(drawing, tmp_path, layer)


@pytest.mark.parametrize("bulge", [1e9, 1e100, 1e300, np.inf, np.nan])
def test_bulges_without_bound_are_refused(drawing, tmp_path, bulge):
    drawing.modelspace().add_lwpolyline(
        [(0, 100, bulge), (100, 0, 0), (200, 0, 0)], format="xyb"
    )
    said = r"slope.dxf: (has a curve|is no DXF)[^\n]*$"
    with pytest.raises(InputError, match=said):
        read(drawing, tmp_path)


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


@pytest.mark.parametrize(
    ("said", "text"),
    [
        ("is no DXF drawing that can be read", ""),
        ("is no DXF drawing that can be read", "x_m,y_m\n0,1\n"),
        ("is no DXF drawing that can be read", HEAD + line(0, 5, 9, 1)),
        ("is no DXF drawing that can be read", HEAD + line(0, "high", 9, 1) + TAIL),
        ("has no LINE, LWPOLYLINE, .* or SPLINE", HEAD + TAIL),
        ("has no LINE", HEAD + line(3, 3, 3, 3) + TAIL),
        ("has no LINE", HEAD + "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n5\n" + TAIL),
    ],
)
def test_files_of_no_profile_are_refused_in_a_line(tmp_path, said, text):
    path = tmp_path / "slope.dxf"
    path.write_text(text)
    with pytest.raises(InputError, match=f"slope.dxf: {said}[^\n]*$"):
        read_dxf_points(path)
    with pytest.raises(InputError, match=r"none\.dxf: cannot be read"):
        read_dxf_points(tmp_path / "none.dxf")


STUDY = """
[profile]
dxf = "slope.dxf"
layer = "T"
[release]
x_m = 2
clearance_m = 1
"""


def test_a_study_takes_a_drawing(tmp_path):
    path, dxf = tmp_path / "slope.toml", tmp_path / "slope.dxf"
    path.write_text(STUDY)
    text = HEAD + line(0, 230, 400, 0, "T") + line(400, 0, 1000, 0, "T")
    dxf.write_text(text + line(0, 9, 9, 9) + TAIL)
    study = read_slope_study(path)
    np.testing.assert_array_equal(study.profile.x, X)
    assert set(study.inputs.checksums_by_name) == {"slope.toml", "slope.dxf"}
    wall = line(0, 230, 400, 50, "T") + line(400, 50, 400, 0, "T")
    dxf.write_text(HEAD + wall + TAIL)
    with pytest.raises(InputError, match=r"slope\.dxf.* a wall needs some width"):
        read_slope_study(path)
    path.write_text(STUDY.replace('"T"', "3"))
    with pytest.raises(InputError, match=r"key profile\.layer: must be a text"):
        read_slope_study(path)


def test_without_the_package_it_is_named(tmp_path, monkeypatch):
    for name in ("ezdxf", "ezdxf.filemanagement", "ezdxf.path"):
        monkeypatch.setitem(sys.modules, name, None)
    (tmp_path / "slope.dxf").write_text(HEAD + TAIL)
    with pytest.raises(InputError, match=r"slope\.dxf.* pip install ezdxf"):
        read_dxf_points(tmp_path / "slope.dxf")

"""Slope profiles from files: CSV, and DXF drawings, read by the optional ezdxf."""

import collections
import dataclasses
import io
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import KDTree

from .._numpy_settings import numpy_settings
from ..errors import InputError, UnusualValueWarning, nearest
from ..io.files import as_text, check_text, read_input
from ..io.scene_table import reads_as_number, records_of
from ..quantities import columns_of_part
from ..scene import Soil
from ..scene_quantities import SLOTS
from .coordinates import LARGEST, problem_with
from .terrain import ANGLE_COLUMNS, ROLLING_FRICTION_ANGLE, Profile

POINT_COLUMNS = ("x_m", "y_m")
MATERIAL_COLUMN = "material"
"""Column that names the material of the ground from a point to the next."""


class ProfileTable(NamedTuple):
    """Profile as its CSV file has it."""

    profile: Profile
    quantities: tuple[str, ...]
    """Quantities of the ground that have a column."""
    materials: tuple[str, ...] | None
    """Material of each segment; None without a column of materials."""


@numpy_settings()
def read_profile(
    path: Path,
    soil: Soil | None = None,
    rolling_friction_angle: float = ROLLING_FRICTION_ANGLE,
    roughness: float = 0.0,
) -> Profile:
    """Read a profile from a CSV file.

    The first row names the columns: `x_m` and `y_m`, and if wanted any quantity of the
    soil or of its laws, `rolling_friction_angle_deg` and `roughness_deg`. A row is a
    point; its ground holds from there to the next point, so that the last row's ground
    is not used.

    Args:
        path: the file, UTF-8, separated by commas.
        soil: gives the laws, and the quantities without a column, scalars.
        rolling_friction_angle, roughness: angles without a column [rad].

    Raises InputError, naming file and row, for whatever cannot be used; also for a
    column of materials, which only a study defines.
    """
    table = read_profile_table(path, soil, rolling_friction_angle, roughness)
    if table.materials is not None:
        raise InputError(
            "names materials, which a study defines under [ground.materials]; read the "
            "study, or put the quantities of the soil into columns",
            file=path,
            column=MATERIAL_COLUMN,
        )
    return table.profile


def read_profile_table(
    path: Path,
    soil: Soil | None = None,
    rolling_friction_angle: float = ROLLING_FRICTION_ANGLE,
    roughness: float = 0.0,
) -> ProfileTable:
    """Read a profile, and what its columns are; see `read_profile`."""
    path, soil = Path(path), soil or Soil()
    of_soil = columns_of_part("soil", soil)
    known = of_soil | ANGLE_COLUMNS
    line, header, rows = records_of_file(path)
    names = [name.strip() for name in header]
    _check_header(path, line, names, (*POINT_COLUMNS, MATERIAL_COLUMN, *known))
    cells = {name: [row[i].strip() for _, row in rows] for i, name in enumerate(names)}
    lines = [line for line, _ in rows]
    materials = cells.pop(MATERIAL_COLUMN, None)
    numbers = {name: _numbers(path, name, cells[name], lines) for name in cells}
    x, y = (numbers.pop(name) for name in POINT_COLUMNS)
    for column, values in zip(POINT_COLUMNS, (x, y), strict=True):
        if problem := problem_with(values, column.removesuffix("_m")):
            place, told = problem
            raise InputError(told, file=path, row=lines[place], column=column)
    fields: dict[str, ArrayLike] = {}
    angles: dict[str, ArrayLike] = {
        "rolling_friction_angle": rolling_friction_angle,
        "roughness": roughness,
    }
    for name, values in numbers.items():
        target = fields if name in of_soil else angles
        target[known[name].field] = known[name].factor * values[:-1]
    try:
        profile = Profile(x, y, dataclasses.replace(soil, **fields), **angles)
    except ValueError as error:
        raise InputError(str(error), file=path) from None
    if materials is not None:
        materials = _materials(path, materials[:-1], lines)
    return ProfileTable(profile, tuple(numbers), materials)


def records_of_file(path: Path) -> tuple[int, list[str], list[tuple[int, list[str]]]]:
    """Read the header with its line, and the rows with theirs, of as many cells; empty
    lines are passed over.

    Raises InputError, naming file and row, for rows of other lengths and for a file
    without a header.
    """
    data = read_input(path, once=False)
    check_text(path, data)
    file = io.StringIO(as_text(path, data), newline="")
    rows = [
        (line, cells)
        for line, _, cells in records_of(path, file)
        if any(map(str.strip, cells))
    ]
    if not rows:
        raise InputError("is empty; a header and rows are needed", file=path)
    (first, header), *rows = rows
    for line, cells in rows:
        if len(cells) != len(header):
            raise InputError(
                f"has {len(cells)} cells, but the header has {len(header)}",
                file=path,
                row=line,
            )
    return first, header, rows


def _numbers(path: Path, name: str, cells: list[str], lines: list[int]) -> np.ndarray:
    for line, cell in zip(lines, cells, strict=True):
        if not reads_as_number(cell):
            raise InputError(
                f"must be a number, but is {cell!r}", file=path, row=line, column=name
            )
    return np.array([float(cell) for cell in cells])


def _materials(path: Path, cells: list[str], lines: list[int]) -> tuple[str, ...]:
    """Check that each point but the last, whose ground is not used, has a material."""
    for line, cell in zip(lines, cells, strict=False):
        if not cell:
            raise InputError(
                "is empty; the name of a material is needed",
                file=path,
                row=line,
                column=MATERIAL_COLUMN,
            )
    return tuple(cells)


def _check_header(path: Path, line: int, names: list[str], known: tuple) -> None:
    for mark, marks in ((";", "semicolons"), ("\t", "tabs")):
        if len(names) == 1 and mark in names[0]:
            raise InputError(
                f"needs commas between columns, but has {marks}", file=path, row=line
            )
    for place, name in enumerate(names):
        if name in SLOTS:
            raise InputError(
                f"names a law, but a profile has one {name} for all its segments; name "
                "it under [ground] or in the soil",
                file=path,
                row=line,
                column=name,
            )
        if name not in known:
            raise InputError(
                f"is unknown; did you mean {nearest(name, known)}?",
                file=path,
                row=line,
                column=name or str(place + 1),
            )
        if name in names[:place]:
            raise InputError(
                "stands twice in the header", file=path, row=line, column=name
            )
    for name in POINT_COLUMNS:
        if name not in names:
            raise InputError(f"needs a column {name}", file=path, row=line)


KINDS = ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "ELLIPSE", "SPLINE")
"""Entities that a profile is read from."""
SILENT = (
    *("TEXT", "MTEXT", "ATTDEF", "DIMENSION", "ARC_DIMENSION", "LEADER", "MULTILEADER"),
    *("TOLERANCE", "HATCH", "MPOLYGON", "POINT", "CIRCLE", "SOLID", "IMAGE", "WIPEOUT"),
    *("XLINE", "RAY", "VIEWPORT", "ACAD_TABLE", "LIGHT", "SUN", "SECTION"),
)
"""Entities that no ground is drawn with: writing, measures, fillings, pictures."""
SAGITTA, FINEST = 0.01, 1e-6
"""Largest distance of the chords from an arc [m], which ezdxf takes for cubic curves
within 3e-4 of its radius, and its least as a fraction of the arc's size, so that no arc
has more than some thousand chords."""
METRES = 6
"""$INSUNITS of metres; 0 stands for no unit."""
DXF_UNITS = {
    **{1: ("inches", 0.0254), 2: ("feet", 0.3048), 3: ("miles", 1609.344)},
    **{4: ("millimetres", 1e-3), 5: ("centimetres", 1e-2), METRES: ("metres", 1.0)},
    **{7: ("kilometres", 1e3), 10: ("yards", 0.9144), 14: ("decimetres", 0.1)},
    **{15: ("decametres", 10.0), 16: ("hectometres", 100.0)},
    21: ("US survey feet", 1200.0 / 3937.0),
}
"""Units of lengths on the ground by their $INSUNITS: names and sizes [m]."""
MEETING = 8
"""Number of ends at one place that are looked at; where a profile goes on, two meet."""
TOUCHING = 1e-6
"""Distance of ends of lines that are joined, as a fraction of the drawing's size."""


def read_dxf_points(
    path: Path, layer: str | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Read the points of a profile from a DXF drawing.

    A profile is a polyline (LWPOLYLINE, POLYLINE) or several lines (LINE, ARC, ELLIPSE,
    SPLINE, or polylines again) that join end to end, in either direction; arcs are cut
    to chords. The drawing's unit ($INSUNITS) is converted to metres, with a warning; a
    drawing without a unit is in metres. Entities that are not read, such as blocks, are
    warned of.

    Args:
        path: the file, DXF of any version.
        layer: layer of the profile; needed if lines on several do not join.

    Returns:
        x and y of the points [m], `(points,)` each, from left to right.

    Raises InputError, naming the file, for whatever makes no single line.
    """
    by_layer = _lines_by_layer(Path(path), layer)
    if not by_layer:
        raise InputError(
            f"has no {', '.join(KINDS[:-1])} or {KINDS[-1]} in its model space, which "
            "a profile is read from",
            file=path,
        )
    if layer is not None and layer not in by_layer:
        raise InputError(
            f"has no line on a layer {layer!r}; did you mean "
            f"{nearest(layer, by_layer)!r}?",
            file=path,
        )
    layers = [layer] if layer is not None else list(by_layer)
    chains = _joined([line for name in layers for line in by_layer[name]])
    if len(chains) > 1 and len(layers) > 1:
        counts = ", ".join(f"{name!r}: {len(by_layer[name])}" for name in layers)
        raise InputError(
            f"has lines that do not join on {len(layers)} layers ({counts}); layer "
            "must say which is the profile",
            file=path,
        )
    if len(chains) > 1:
        (x, y), (other, height) = chains[0][-1], chains[1][0]
        raise InputError(
            f"has {len(chains)} lines on the layer {layers[0]!r} that do not join: one "
            f"ends at ({x:g}, {y:g}), another begins at ({other:g}, {height:g}); a "
            "profile is one line",
            file=path,
        )
    points = chains[0]
    if points[0, 0] > points[-1, 0]:
        points = points[::-1]
    return points[:, 0].copy(), points[:, 1].copy()


def _lines_by_layer(path: Path, layer: str | None) -> dict[str, list[np.ndarray]]:
    """Read the lines of the model space, points `(points, 2)` each [m].

    Args:
        layer: the only one whose entities that are not read are warned of; None: all.
    """
    read_input(path, once=False)
    try:
        from ezdxf.filemanagement import (  # pyright: ignore[reportMissingImports]
            readfile,
        )
        from ezdxf.path import make_path  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise InputError(
            "needs the package ezdxf to be read: pip install ezdxf",
            file=path,
        ) from None
    found: dict[str, list[np.ndarray]] = {}
    passed_over: collections.Counter[str] = collections.Counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            drawing = readfile(path)
            number = drawing.header.get("$INSUNITS", 0) or METRES
            if number not in DXF_UNITS:
                raise InputError(
                    f"has $INSUNITS {number}, which is no unit of slopes; set its "
                    "units to metres",
                    file=path,
                )
            unit, metre = DXF_UNITS[number]
            for entity in drawing.modelspace():
                kind, on = entity.dxftype(), entity.dxf.get("layer", "0")
                if kind in KINDS:
                    points = _chords(path, make_path(entity), metre)
                    if len(points) and np.any(points != points[0]):
                        found.setdefault(on, []).append(points)
                elif kind not in SILENT and layer in (None, on):
                    passed_over[kind] += 1
        except InputError:
            raise
        except Exception as error:  # of many kinds, for damaged files
            told = str(error) or type(error).__name__
            raise InputError(
                f"is no DXF drawing that can be read: {told}", file=path
            ) from None
    if metre != 1.0:
        _warn(
            path,
            f"is in {unit} by its $INSUNITS: coordinates are taken times {metre:g} as "
            "metres; if they are metres already, set its units to metres",
        )
    if passed_over and found:
        told = ", ".join(f"{count} {kind}" for kind, count in passed_over.items())
        _warn(
            path,
            f"holds {told}, which no profile is read from; explode what is ground into "
            "lines",
        )
    return {name: [_flat(path, name, p) for p in of] for name, of in found.items()}


def _warn(path: Path, text: str) -> None:
    text = f"{path}: {text}"
    warnings.warn(UnusualValueWarning(text, text), stacklevel=1)


def _chords(path: Path, curve, metre: float) -> np.ndarray:
    """Cut a curve to chords, points `(points, 3)` [m].

    Args:
        curve: path of ezdxf.
        metre: the drawing's unit [m].
    """
    # A bulge without bound makes an arc of any size, and without end of chords.
    corners = metre * np.array([tuple(v) for v in curve.control_vertices()], float)
    if not np.all(np.abs(corners) <= LARGEST):
        raise InputError(
            f"has a {'curve' if curve.has_curves else 'line'} that goes beyond "
            f"{LARGEST:g} m from the origin; draw it nearer to the origin, and bulges "
            "of arcs smaller",
            file=path,
        )
    size = np.max(np.ptp(corners, axis=0), initial=0.0) if len(corners) else 0.0
    vertices = curve.flattening(max(SAGITTA, FINEST * size) / metre)
    return metre * np.array([tuple(v) for v in vertices], float)


def _flat(path: Path, layer: str, points: np.ndarray) -> np.ndarray:
    """Drop z, which must be the same everywhere, and points that stand twice."""
    if np.ptp(points[:, 2]) > 0.0:
        raise InputError(
            f"has a line on the layer {layer!r} whose z changes; a profile is drawn in "
            "x, to the right, and y, up",
            file=path,
        )
    moved = np.any(np.diff(points[:, :2], axis=0) != 0.0, axis=1)
    return points[np.append(True, moved), :2]


def _joined(lines: list[np.ndarray]) -> list[np.ndarray]:
    """Join lines whose ends touch, until none do."""
    size = np.max(np.ptp(np.concatenate(lines), axis=0))
    # End 2 i is the first point of line i, and 2 i + 1 its last.
    ends = np.concatenate([line[[0, -1]] for line in lines])
    tree = KDTree(ends)
    within = np.nextafter(TOUCHING * size, np.inf)
    _, near = tree.query(ends, MEETING, p=np.inf, distance_upper_bound=within)
    # In the order of the file; `len(ends)` stands for none.
    touching = np.sort(near, axis=1)
    waiting = dict.fromkeys(range(len(lines)))
    chains = []
    while waiting:
        first = next(iter(waiting))
        del waiting[first]
        after, before = (
            _followed(lines, touching, 2 * first + last, waiting) for last in (1, 0)
        )
        # A joint has the point of the line that was there before.
        chain = [line[::-1][:-1] for line in reversed(before)]
        chains.append(
            np.concatenate([*chain, lines[first], *(line[1:] for line in after)])
        )
    return chains


def _followed(
    lines: list[np.ndarray], touching: np.ndarray, end: int, waiting: dict
) -> list[np.ndarray]:
    """Take from the lines that wait those that follow an end, one after the other, each
    from the joint on.

    Args:
        touching: ends that touch each end, `(ends, MEETING)`.
        waiting: indices of the lines, of which those taken are removed.
    """
    found = []
    while True:
        other = next((e for e in touching[end].tolist() if e // 2 in waiting), None)
        if other is None:
            return found
        del waiting[other // 2]
        line = lines[other // 2]
        found.append(line[::-1] if other % 2 else line)
        end = other ^ 1

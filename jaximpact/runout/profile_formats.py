"""Slope profiles from files: CSV, and DXF drawings, read by the optional ezdxf."""

import dataclasses
import io
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError, nearest
from ..io.files import read_input, read_text
from ..io.scene_table import reads_as_number, records_of
from ..quantities import columns_of_part
from ..scene import Soil
from ..scene_quantities import SLOTS
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
    file = io.StringIO(read_text(path, once=False), newline="")
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


KINDS = ("LINE", "LWPOLYLINE", "POLYLINE")
"""Entities that a profile is read from."""
SAGITTA = 0.01
"""Largest distance of the chords from an arc [m], which ezdxf takes for cubic curves
within 3e-4 of its radius."""
TOUCHING = 1e-6
"""Distance of ends of lines that are joined, as a fraction of the drawing's size."""


def read_dxf_points(
    path: Path, layer: str | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Read the points of a profile from a DXF drawing.

    A profile is a polyline (LWPOLYLINE, POLYLINE) or several lines (LINE, or polylines
    again) that join end to end, in either direction; arcs of polylines are cut to
    chords. x and y of the drawing are taken as metres.

    Args:
        path: the file, DXF of any version.
        layer: layer of the profile; needed if lines on several do not join.

    Returns:
        x and y of the points [m], `(points,)` each, from left to right.

    Raises InputError, naming the file, for whatever makes no single line.
    """
    by_layer = _lines_by_layer(Path(path))
    if not by_layer:
        raise InputError(
            "has no LINE, LWPOLYLINE or POLYLINE in its model space, which a profile "
            "is read from",
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


def _lines_by_layer(path: Path) -> dict[str, list[np.ndarray]]:
    """Read the lines of the model space, points `(points, 2)` each."""
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
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            entities = readfile(path).modelspace().query(" ".join(KINDS))
            for entity in entities:
                vertices = make_path(entity).flattening(SAGITTA)
                points = np.array([tuple(v) for v in vertices], float)
                if len(points) and np.any(points != points[0]):
                    found.setdefault(entity.dxf.layer, []).append(points)
        except Exception as error:  # of many kinds, for damaged files
            told = str(error) or type(error).__name__
            raise InputError(
                f"is no DXF drawing that can be read: {told}", file=path
            ) from None
    return {name: [_flat(path, name, p) for p in of] for name, of in found.items()}


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
    waiting = list(lines)
    chains = []
    while waiting:
        chain = waiting.pop(0)
        place = 0
        while place < len(waiting):
            longer = _join(chain, waiting[place], TOUCHING * size)
            if longer is None:
                place += 1
            else:
                chain = longer
                del waiting[place]
                place = 0
        chains.append(chain)
    return chains


def _join(first: np.ndarray, second: np.ndarray, within: float) -> np.ndarray | None:
    """Join two lines at ends that touch; None if there are none."""
    for one in (first, first[::-1]):
        for other in (second, second[::-1]):
            if np.max(np.abs(one[-1] - other[0])) <= within:
                return np.concatenate([one, other[1:]])
    return None

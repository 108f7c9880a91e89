"""Slope profiles from CSV files."""

import dataclasses
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._settings import numpy_settings
from ..errors import InputError, did_you_mean, located
from ..io.checks import warn_unusual
from ..io.files import check_text, read_input
from ..io.scene_table import (
    check_separator,
    reads_as_number,
    records_of,
    warn_of_unusual,
)
from ..quantities import columns_of_part
from ..scene import Soil
from ..scene_quantities import SLOTS
from .coordinates import first_turning_back, problem_with
from .terrain import ANGLE_COLUMNS, ROLLING_FRICTION_ANGLE, Profile

POINT_COLUMNS = ("x_m", "y_m")
MATERIAL_COLUMN = "material"
"""Column that names the material of the ground from a point to the next."""
THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}\.\d{3}")
"""Number whose point may separate thousands, as in German."""


class ProfileTable(NamedTuple):
    """Profile as its CSV file has it."""

    profile: Profile
    quantities: tuple[str, ...]  # quantities of the ground that have a column
    materials: tuple[str, ...] | None  # of each segment, if there is a column


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
    *,
    warn: bool = False,
) -> ProfileTable:
    """Read a profile, and what its columns are; see `read_profile`.

    Args:
        warn: also warn of unusual ground, of which `simulate_runout` does.
    """
    path, soil = Path(path), soil or Soil()
    of_soil = columns_of_part("soil", soil)
    known = of_soil | ANGLE_COLUMNS
    line, header, rows = records_of_file(path)
    names = [name.strip() for name in header]
    _check_header(path, line, names, (*POINT_COLUMNS, MATERIAL_COLUMN, *known))
    cells = {name: [row[i].strip() for _, row in rows] for i, name in enumerate(names)}
    lines = [line for line, _ in rows]
    materials = cells.pop(MATERIAL_COLUMN, None)
    if materials is not None:
        # The ground of the last point is not used.
        materials = tuple(materials[:-1])
        for line, cell in zip(lines, materials, strict=False):
            if not cell:
                problem = "is empty; the name of a material is needed"
                raise cell_error(path, problem, line, MATERIAL_COLUMN)
    numbers: dict[str, np.ndarray] = {}
    for name, column in cells.items():
        for line, cell in zip(lines, column, strict=True):
            if not reads_as_number(cell):
                problem = f"must be a number, but is {cell!r}"
                raise cell_error(path, problem, line, name)
        numbers[name] = np.array([float(cell) for cell in column])
    x, y = (numbers.pop(name) for name in POINT_COLUMNS)
    for column, values in zip(POINT_COLUMNS, (x, y), strict=True):
        if bad := problem_with(values, column.removesuffix("_m")):
            place, problem = bad
            raise cell_error(path, problem, lines[place], column)
    _warn_of_thousands(path, cells["y_m"], lines)
    fields: dict[str, ArrayLike] = {}
    angles: dict[str, ArrayLike] = {
        "rolling_friction_angle": rolling_friction_angle,
        "roughness": roughness,
    }
    for name, values in numbers.items():
        column = known[name]
        allowed = column.is_allowed(values)
        allowed[-1] = True  # the ground of the last point is not used
        if not np.all(allowed):
            place = int(np.argmin(allowed))
            number = column.describe(values[place], column.unit)
            problem = f"must be {column.requirement}, but is {number}"
            raise cell_error(path, problem, lines[place], name)
        if warn:
            warn_of_unusual(path, column, values[:-1], lines)
        target = fields if name in of_soil else angles
        target[known[name].field] = known[name].factor * values[:-1]
    try:
        profile = Profile(x, y, dataclasses.replace(soil, **fields), **angles)
    except ValueError as error:
        back = first_turning_back(x)
        row = None if back is None else lines[back + 1]
        raise InputError(str(error), file=path, row=row) from None
    return ProfileTable(profile, tuple(numbers), materials)


def _warn_of_thousands(path: Path, cells: list[str], lines: list[int]) -> None:
    """Warn of heights in which a point separates thousands, as in 1.120 beside 998: all
    points stand before three last digits, and without them the highest step of the
    profile would be less than half as high."""
    with_point = np.array(["." in cell for cell in cells])
    if not 0 < np.count_nonzero(with_point) < len(cells):
        return
    if not all(THOUSANDS.fullmatch(cell) for cell in cells if "." in cell):
        return
    y = np.array(cells, float)
    without = np.where(with_point, 1e3 * y, y)
    step, smaller = (np.max(np.abs(np.diff(heights))) for heights in (y, without))
    if smaller < 0.5 * step:
        i = int(np.argmax(with_point))
        warn_unusual(
            f"is {y[i]:g} m; if the point separates thousands, write {without[i]:.0f}",
            "y_m",
            file=path,
            row=lines[i],
            column="y_m",
        )


def cell_error(path: Path, problem: str, line: int, column: str) -> InputError:
    """Make the error of a cell in a file."""
    return InputError(problem, file=path, row=line, column=column)


def records_of_file(path: Path) -> tuple[int, list[str], list[tuple[int, list[str]]]]:
    """Read the header with its line, and the rows with theirs; empty lines are passed
    over, and so are columns without a name or a cell, as Excel writes them. Raises
    InputError, naming file and row, for rows of other lengths than the header, and for
    a file without one."""
    data = read_input(path, once=False)
    check_text(path, data)
    with located(file=path):
        rows = [
            (line, cells)
            for line, _, cells in records_of(data)
            if any(map(str.strip, cells))
        ]
    if not rows:
        raise InputError("is empty; a header and rows are needed", file=path)
    (first, header), *rows = rows
    with located(file=path):
        check_separator(first, header)
    for line, cells in rows:
        if len(cells) != len(header):
            problem = f"has {len(cells)} cells, but the header has {len(header)}"
            raise InputError(problem, file=path, row=line)
    columns = zip(header, *(cells for _, cells in rows), strict=True)
    kept = [
        place for place, column in enumerate(columns) if any(map(str.strip, column))
    ]
    rows = [(line, [cells[place] for place in kept]) for line, cells in rows]
    return first, [header[place] for place in kept], rows


def _check_header(path: Path, line: int, names: list[str], known: tuple) -> None:
    for place, name in enumerate(names):
        problem = None
        if not name:
            problem = "has no name"
        elif name in SLOTS:
            problem = (
                f"names a law, but a profile has one {name} for all its segments; name "
                "it under [ground] or in the soil"
            )
        elif name not in known:
            problem = f"is unknown; {did_you_mean(name, known)}"
        elif name in names[:place]:
            problem = "stands twice in the header"
        if problem:
            raise cell_error(path, problem, line, name or str(place + 1))
    for name in POINT_COLUMNS:
        if name not in names:
            raise InputError(f"needs a column {name}", file=path, row=line)

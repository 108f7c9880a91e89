"""What to tabulate, from a TOML file."""

import dataclasses
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..accuracy import PRESETS
from ..errors import InputError
from ..io.checks import NUMBERS_PER_IMPACT, check_memory
from ..io.toml import (
    allowed,
    check_keys,
    choice,
    known_table,
    load_toml,
    number,
    quantity,
    typed,
    whole,
    with_named_parts,
)
from ..parameters import parts_of
from ..quantities import INPUT_COLUMNS, columns_of_part
from ..scene import Block, Soil
from ..units import DEGREE
from .orientation_map import DIMENSIONS, MapAxes
from .tabulation import SPEEDS, Nodes

TABLES = ("block", "ground", "table", "map")
TABLE_KEYS = ("slopes_deg", "total_speeds_mps", "nodes")
MAP_KEYS = (
    *("speeds_mps", "angles_deg", "angular_velocities_degps", "slope_deg"),
    "orientations",
)
PARTS = {"block": ("block", Block), "ground": ("soil", Soil)}


class TableStudy(NamedTuple):
    """What the file says."""

    block: Block
    soil: Soil
    accuracy: str
    """Name of a preset."""
    slopes: np.ndarray
    """Of the table [rad]."""
    speeds: tuple[float, float]
    """First and last total speed of the table [m/s]."""
    nodes: Nodes
    map_axes: MapAxes


def read_table_study(path: Path, accuracy: str | None = None) -> TableStudy:
    """Read what to tabulate; `jaximpact tabulate --help` describes the file.

    Args:
        path: the file.
        accuracy: in place of the file's.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    content = load_toml(path)
    check_keys(path, "", content, (*TABLES, "accuracy"))
    table = known_table(path, content, "table", TABLE_KEYS)
    slopes = _ascending(path, table, "table", "slopes_deg", "slope_deg", [0.0])
    ends = _list(path, table, "table", "total_speeds_mps", list(SPEEDS))
    if len(ends) != 2 or not 0.0 < ends[0] < ends[1]:
        raise InputError(
            f"must be the first and the last, ascending from above 0, but is {ends}",
            file=path,
            key="table.total_speeds_mps",
        )
    counts = typed(path, table, "nodes", dict, {})
    check_keys(path, "table.nodes", counts, Nodes._fields)
    nodes = Nodes(
        *(
            whole(path, counts, name, default, 1 if name == "orientation" else 2)
            for name, default in Nodes()._asdict().items()
        )
    )
    _check_size(path, "table.nodes", (*nodes, len(slopes)))
    if accuracy is None:
        accuracy = choice(path, content, "accuracy", "fast", tuple(PRESETS))
    return TableStudy(
        _part(path, content, "block"),
        _part(path, content, "ground"),
        accuracy,
        DEGREE * np.array(slopes),
        (ends[0], ends[1]),
        nodes,
        _map_axes(path, content),
    )


def _part(path: Path, content: dict, name: str) -> Any:
    """Read the block or the ground; what the file does not say has its default."""
    part, kind = PARTS[name]
    table = typed(path, content, name, dict, {})
    whole = with_named_parts(path, name, table, kind())
    columns, slots = columns_of_part(part, whole), tuple(parts_of(kind))
    fields = {}
    for key, value in known_table(path, content, name, (*columns, *slots)).items():
        if key not in slots:
            column = columns[key]
            where = f"{name}.{key}"
            fields[column.field] = column.factor * quantity(path, where, column, value)
    return dataclasses.replace(whole, **fields)


def _map_axes(path: Path, content: dict) -> MapAxes:
    table, default = known_table(path, content, "map", MAP_KEYS), MapAxes()
    axes = [
        tuple(_ascending(path, table, "map", key, column, list(values)))
        for key, column, values in zip(
            MAP_KEYS[:3], DIMENSIONS, default[:3], strict=True
        )
    ]
    slope = table.get("slope_deg", default.slope_deg)
    slope = allowed(path, "map.slope_deg", INPUT_COLUMNS["slope_deg"], slope)
    orientations = whole(path, table, "orientations", default.orientations, 2)
    _check_size(path, "map", (*map(len, axes), orientations))
    return MapAxes._make((*axes, slope, orientations))


def _check_size(path: Path, key: str, counts: tuple[int, ...]) -> None:
    impacts = math.prod(counts)
    check_memory(impacts * NUMBERS_PER_IMPACT, f"{impacts} impacts", file=path, key=key)


def _ascending(
    path: Path, table: dict, where: str, key: str, column: str, default: list
) -> list[float]:
    """A list of values that ascend and that the column may hold."""
    values = _list(path, table, where, key, default)
    for value in values:
        allowed(path, f"{where}.{key}", INPUT_COLUMNS[column], value)
    if np.any(np.diff(values) <= 0.0):
        raise InputError("must ascend", file=path, key=f"{where}.{key}")
    return values


def _list(path: Path, table: dict, where: str, key: str, default: list) -> list[float]:
    values = table.get(key, default)
    if not isinstance(values, list) or not values:
        raise InputError(
            f"must be a list of numbers, but is {values!r}",
            file=path,
            key=f"{where}.{key}",
        )
    return [number(path, f"{where}.{key}", value) for value in values]

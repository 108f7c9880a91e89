"""Studies of tables: block, ground, and nodes, from a TOML file."""

import dataclasses
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..accuracy import PRESETS
from ..io.checks import NUMBERS_PER_IMPACT, check_memory
from ..io.toml import (
    Key,
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
from .tabulation import SPEEDS, Nodes

TABLES = ("block", "ground", "table")
TABLE_KEYS = ("slopes_deg", "total_speeds_mps", "nodes")
PARTS = {"block": ("block", Block), "ground": ("soil", Soil)}


class TableStudy(NamedTuple):
    """Content of the file."""

    block: Block
    soil: Soil
    accuracy: str  # name of a preset
    slopes: np.ndarray  # slopes of the table [rad]
    speeds: tuple[float, float]  # first and last total speed of the table [m/s]
    nodes: Nodes


def read_table_study(path: Path, accuracy: str | None = None) -> TableStudy:
    """Read what to tabulate, with an accuracy in place of the file's if one is given;
    `jaximpact tabulate --help` describes the file.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    top, content = Key(path), load_toml(path)
    check_keys(top, content, (*TABLES, "accuracy"))
    table = known_table(top, content, "table", TABLE_KEYS)
    slopes = _ascending_slopes(top["table"]["slopes_deg"], table.get("slopes_deg", [0]))
    key = top["table"]["total_speeds_mps"]
    ends = _numbers(key, table.get("total_speeds_mps", [*SPEEDS]))
    if len(ends) != 2 or not 0.0 < ends[0] < ends[1]:
        raise key.error(
            f"must be the first and the last, ascending from above 0, but is {ends}"
        )
    key, counts = top["table"]["nodes"], typed(top["table"], table, "nodes", dict, {})
    check_keys(key, counts, Nodes._fields)
    nodes = Nodes(
        *(
            whole(key, counts, name, default, 1 if name == "orientation" else 2)
            for name, default in Nodes()._asdict().items()
        )
    )
    impacts = math.prod((*nodes, len(slopes)))
    check_memory(impacts * NUMBERS_PER_IMPACT, f"{impacts} impacts", **key.place)
    if accuracy is None:
        accuracy = choice(top, content, "accuracy", "fast", tuple(PRESETS))
    return TableStudy(
        _part(top, content, "block"),
        _part(top, content, "ground"),
        accuracy,
        DEGREE * np.array(slopes),
        (ends[0], ends[1]),
        nodes,
    )


def _part(top: Key, content: dict, name: str) -> Any:
    """Read the block or the ground; what the file does not say has its default."""
    part, kind = PARTS[name]
    table = typed(top, content, name, dict, {})
    whole = with_named_parts(top[name], table, kind())
    columns, slots = columns_of_part(part, whole), tuple(parts_of(kind))
    fields = {}
    for key, value in known_table(top, content, name, (*columns, *slots)).items():
        if key not in slots:
            column = columns[key]
            where = top[name][key]
            fields[column.field] = column.factor * quantity(where, column, value)
    return dataclasses.replace(whole, **fields)


def _ascending_slopes(key: Key, values: Any) -> list[float]:
    slopes = _numbers(key, values)
    for slope in slopes:
        allowed(key, INPUT_COLUMNS["slope_deg"], slope)
    if np.any(np.diff(slopes) <= 0.0):
        raise key.error("must ascend")
    return slopes


def _numbers(key: Key, values: Any) -> list[float]:
    if not isinstance(values, list) or not values:
        raise key.error(f"must be a list of numbers, but is {values!r}")
    return [number(key, value) for value in values]

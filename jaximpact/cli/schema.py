"""`jaximpact schema`: JSON schemas of the TOML files, for editors."""

import argparse
import functools
import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..io.output_files import output_files
from . import options

if TYPE_CHECKING:
    from ..quantities import InputColumn

FILES = ("simulate", "sweep", "calibrate", "runout", "tabulate")
"""Commands that take a TOML file."""
OF_A_SCENE = ("simulate", "sweep")
"""Commands whose files say the whole scene themselves, with its laws and shapes."""
OWN = ":"
"""Pattern of the name of a law or a shape of the user's own."""
DESCRIPTION = """\
Write the JSON schema of the TOML files of a command. An editor that knows it completes
keys, shows units, ranges and meanings, and marks what is misspelt: in VS Code the
extension Even Better TOML, elsewhere the language server taplo. Not marked are keys of
tables that may hold those of a law or shape of your own.

    jaximpact schema calibrate --out study.schema.json

and as the first line of study.toml

    #:schema ./study.schema.json"""
Schema = dict[str, Any]
TEXT: Schema = {"type": "string"}
TEXTS: Schema = {"anyOf": [TEXT, {"type": "array", "items": TEXT}]}
NUMBERS: Schema = {"type": "array", "items": {"type": "number"}}


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = options.add_command(
        commands,
        "schema",
        run,
        help="JSON schemas of TOML files, for editors",
        description=DESCRIPTION,
    )
    parser.add_argument("command", choices=FILES, help="whose files")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="file to write; default: stdout"
    )


def run(arguments: argparse.Namespace) -> None:
    """Run the command."""
    from ..io.files import write_text

    text = json.dumps(toml_schema(arguments.command), indent=2, ensure_ascii=False)
    if arguments.out is None:
        print(text)
        return
    options.check_ending("--out", arguments.out, ".json")
    with output_files({"--out": arguments.out}):
        write_text(arguments.out, text + "\n")


def toml_schema(command: str) -> Schema:
    """Make the JSON schema, draft 7, of the TOML files of one of `FILES`, of what laws,
    shapes and the readers of files declare. Laws and shapes of a user's own may bring
    keys of their own, which pass where such may stand."""
    from ..accuracy import PRESETS

    tables = {
        "simulate": _scene,
        "sweep": _sweep,
        "calibrate": _study,
        "runout": _slope,
        "tabulate": _table,
    }[command]()
    tables = tables | {"accuracy": _words(PRESETS)}
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": f"jaximpact {command}",
        **(_closed_but_for_own if command in OF_A_SCENE else _closed)(tables),
    }


def _words(known: Iterable[str]) -> Schema:
    return {"enum": list(known)}


def _closed(properties: Mapping[str, Schema]) -> Schema:
    return {
        "type": "object",
        "properties": dict(properties),
        "additionalProperties": False,
    }


def _open(properties: Mapping[str, Schema]) -> Schema:
    return {"type": "object", "properties": dict(properties)}


def _closed_but_for_own(properties: Mapping[str, Schema]) -> Schema:
    """Describe a file that holds unknown keys, in any open table, only where it names a
    law or a shape of the user's own."""
    from ..quantities import SLOTS

    named = {"type": "string", "pattern": OWN}
    own = {"anyOf": [named, {"type": "array", "contains": named}]}
    here = [{"required": [slot], "properties": {slot: own}} for slot in SLOTS]
    levels = [{"type": "object", "anyOf": here}]
    for _ in range(2):  # in a table of the file, and in a table of that
        in_none = {"additionalProperties": {"not": levels[-1]}}
        levels.append({"type": "object", "not": in_none})
    table = _open(properties)
    return table | {"if": {"anyOf": levels}, "else": _strict(table)}


def _strict(table: Schema) -> Schema:
    """Return what marks unknown keys in an open table, and in those inside it."""
    known, others = table["properties"], table.get("additionalProperties")
    inner = {
        name: _strict(of)
        for name, of in known.items()
        if of.get("type") == "object" and of.get("additionalProperties") is not False
    }
    if others is None:
        return {"propertyNames": _words(known), "properties": inner}
    # Of [axes], in which tables have any names.
    groups = {"type": "object"} | _strict(others["anyOf"][-1])
    return {"properties": _each(known, {}), "additionalProperties": groups}


def _each(names: Iterable[str], value: Schema) -> dict[str, Schema]:
    return dict.fromkeys(names, value)


def _count(least: int = 0) -> Schema:
    return {"type": "integer", "minimum": least}


# --- Columns, laws and shapes.


@functools.cache
def _columns() -> dict[str, "InputColumn"]:
    """Collect all columns of a scene, with those of all laws and shapes of ours."""
    from ..quantities import INPUT_COLUMNS, SLOTS, columns_of_class, shipped_parts

    known = dict(INPUT_COLUMNS)
    for slot in SLOTS:
        for kind in shipped_parts(slot):
            known = columns_of_class(slot, kind) | known
    return known


def _number(column: "InputColumn") -> Schema:
    limits = {
        name if is_allowed else f"exclusive{name.capitalize()}": end
        for name, end, is_allowed in (
            ("minimum", column.lower, column.lower_allowed),
            ("maximum", column.upper, column.upper_allowed),
        )
        if math.isfinite(end)
    }
    default = "" if math.isnan(column.default) else f"; default {column.default:g}"
    words = f"{column.meaning} [{column.unit}], {column.range_text}{default}"
    return {"type": "number", "description": words} | limits


def _values(part: str, random: bool = False) -> dict[str, Schema]:
    """Describe the keys of a part of the scene: its columns, its laws or shape."""
    from ..quantities import SLOTS

    numbers = {
        name: _quantity(column) if random else _number(column)
        for name, column in _columns().items()
        if column.part == part
    }
    return numbers | {slot: _law(slot) for slot in SLOTS if SLOTS[slot] == part}


def _quantity(column: "InputColumn") -> Schema:
    """Describe a number, a list or a distribution."""
    from ..runout.study.quantity import KEYS, LENGTH

    drawn = _closed(_each((*KEYS, LENGTH), {"type": "number"}))
    one = _number(column)
    return {"description": one["description"], "anyOf": [one, NUMBERS, drawn]}


def _law(slot: str) -> Schema:
    from ..quantities import shipped_parts

    names = [kind.__name__ for kind in shipped_parts(slot)]
    words = f"{', '.join(names)}; or one of your own, file.py:Name or module:Name"
    return {
        "description": words,
        "anyOf": [_words(names), {"type": "string", "pattern": OWN}],
    }


def _scene() -> dict[str, Schema]:
    from ..quantities import SLOTS
    from ..scene import PARTS

    has_laws = {*SLOTS.values()}
    tables = {p: (_open if p in has_laws else _closed)(_values(p)) for p in PARTS}
    return {name: value for part in PARTS for name, value in _values(part).items()} | (
        tables
    )


# --- Files of commands.


def _sweep() -> dict[str, Schema]:
    from ..sweeping import LABELS, RANGE_KEYS, SPACINGS

    over = _each(RANGE_KEYS[:3], {"type": "number"}) | {"spacing": _words(SPACINGS)}
    axis = {"anyOf": [NUMBERS, _closed(over)]}
    named = {
        name: {**axis, "description": _number(column)["description"]}
        for name, column in _columns().items()
    } | {"shape": TEXTS}
    together = _open(named | {LABELS: TEXTS})
    others = {"additionalProperties": {"anyOf": [axis, together]}}
    return _scene() | {"axes": _open(named) | others}


def _study() -> dict[str, Schema]:
    from ..calibration.problem.candidates import KEYS as FURTHER
    from ..calibration.problem.config import KEYS, METHODS, CompareTable
    from ..calibration.problem.noise import LOSSES, SCATTERS
    from ..quantities import LABEL_COLUMNS, TARGET_COLUMNS

    number: Schema = {"type": "number"}
    prior = _closed({"mean": number, "sd": {**number, "exclusiveMinimum": 0}})
    by = _words((*LABEL_COLUMNS, "row"))
    fitted = _closed(
        {"start": number, "lower": number, "upper": number, "prior": prior}
        | {"expression": TEXT, "by": by, "group_sd": number}
    )
    nuisance = _closed({"by": by, "prior": prior})
    soil = [name for name, column in _columns().items() if column.part == "soil"]
    scatter = _words(SCATTERS)
    known = {
        **_each(("title", "source", "notes"), TEXT),
        "data": TEXTS,
        "targets": {"type": "array", "items": _words(TARGET_COLUMNS)},
        "starts": _count(1),
        "seed": _count(),
        "method": _words(METHODS),
        "loss": _words(LOSSES),
        "parameters": _open(_each(soil, fitted)),
        "nuisance": _open(_each(_columns(), nuisance)),
        "soil": _open(_values("soil")),
        "block": _open(_values("block")),
        **_each(("default_sigma", "weights"), _closed(_each(TARGET_COLUMNS, number))),
        "scatter": {"anyOf": [scatter, _closed(_each(TARGET_COLUMNS, scatter))]},
        "variants": {
            "type": "array",
            "items": _open(_values("soil") | {"name": TEXT}),
        },
        "further_tests": _closed(_each(FURTHER, {})),
        "compare": _closed(_each(CompareTable._fields, TEXTS)),
    }
    return _each(KEYS, {}) | known


def _slope() -> dict[str, Schema]:
    from ..runout.back_analysis.observed import KEYS as OBSERVED
    from ..runout.study.barriers import KEYS as BARRIERS
    from ..runout.study.block_file import RELEASE_KEYS, VOLUME
    from ..runout.study.profile_file import MAP_KEYS, SMOOTHING, SOURCES
    from ..runout.study.slope_file import NUMBERS as SETTINGS
    from ..runout.study.slope_file import TABLES

    shapes = {"anyOf": [_law("shape"), {"type": "array", "items": _law("shape")}]}
    profile = _each((*SOURCES, "layer", SMOOTHING, *MAP_KEYS), {})
    return {
        **_each((*TABLES, *SETTINGS), {}),
        "title": TEXT,
        "count": _count(1),
        "seed": _count(),
        "collectors_m": NUMBERS,
        "profile": _closed(profile),
        "ground": _open(_values("soil", random=True)),
        "block": _open(_values("block", random=True) | {VOLUME: {}, "shape": shapes}),
        "release": _closed(_each(RELEASE_KEYS, {})),
        "barriers": {"type": "array", "items": _closed(_each(BARRIERS, {}))},
        "observed": _closed(_each(OBSERVED, {})),
    }


def _table() -> dict[str, Schema]:
    from ..lookup.table_study import TABLE_KEYS
    from ..lookup.tabulation import Nodes

    table: Schema = dict(zip(TABLE_KEYS, (NUMBERS, NUMBERS, {}), strict=True))
    table["nodes"] = _closed(_each(Nodes._fields, _count(1)))
    return {
        "block": _open(_values("block")),
        "ground": _open(_values("soil")),
        "table": _closed(table),
    }

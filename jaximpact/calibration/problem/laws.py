"""Laws and shape of a study: by name in a file, as objects, or from fit.json."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from ..._fixed_fields import fixed_fields
from ...errors import InputError
from ...identity import code_digest
from ...io.toml import Key, quantity, unknown
from ...parameters import Composite, Part
from ...quantities import BASES, SLOTS, USUAL, InputColumn, columns_of_part
from ...scene import Block, Scene, Soil
from ...scene_quantities import part_named, text_of

KINDS: dict[str, type[Composite]] = {"soil": Soil, "block": Block}


def unusual(parts: Mapping[str, Part]) -> dict[str, Part]:
    """Select the laws and shape that are not the default."""
    return {slot: part for slot, part in parts.items() if type(part) is not USUAL[slot]}


def in_words(parts: Mapping[str, Part], between: str = ", ") -> str:
    """Name the slot and the class of each."""
    return between.join(f"{slot} {type(part).__name__}" for slot, part in parts.items())


def scene_of(parts: Mapping[str, Part]) -> Scene:
    """Make a scene with these laws and this shape, and defaults otherwise.

    Raises InputError for two parameters of one name.
    """
    soil, block = (
        {slot: part for slot, part in parts.items() if SLOTS[slot] == whole}
        for whole in ("soil", "block")
    )
    return Scene(soil=Soil(**soil), block=Block(**block))


def parts_and_values(
    table: Key, entries: Mapping, whole: str, directory: Path
) -> tuple[dict[str, Part], dict]:
    """Separate the laws and shapes in a table of a study, of "soil" or "block", from
    its other entries. Files of laws are relative to the directory.

    Raises InputError, naming the key, for a law that cannot be had.
    """
    parts, values = {}, {}
    for name, entry in entries.items():
        if SLOTS.get(name) != whole:
            values[name] = entry
            continue
        if isinstance(entry, BASES[name]):
            parts[name] = entry
        elif isinstance(entry, str):
            with table[name].located():
                parts[name] = part_named(name, entry, directory)
        else:
            raise table[name].error(
                f"must be a name, like {USUAL[name].__name__!r} or "
                f"'my_laws.py:MyLaw', but is {entry!r}"
            )
    return parts, values


def values_by_column(
    what: str, whole: Composite, slots: Iterable[str], *, whole_too: bool = True
) -> dict[str, float]:
    """Collect values of a ground or a block in the units of the tables: parameters of
    some of its parts, and its own if wanted."""
    values = {}
    part = "soil" if isinstance(whole, Soil) else "block"
    slots = set(slots)
    for name, column in columns_of_part(part, whole).items():
        path = whole.path_of(column.field)
        if not (path[0] in slots if len(path) > 1 else whole_too):
            continue
        value = np.asarray(getattr(whole, column.field))
        if value.ndim:
            raise InputError(
                f"{what} must be one {part}, but its {column.field} has shape "
                f"{value.shape}"
            )
        values[name] = float(value) / column.factor
    return values


def checked_values(
    table: Key, values: Mapping, columns: Mapping[str, InputColumn]
) -> dict[str, float]:
    """Check the numbers of a table, in the units of their columns.

    Raises InputError, naming the key, for a number that is unknown or out of range.
    """
    checked = {}
    for name, value in values.items():
        if name not in columns:
            raise unknown(table, name, columns)
        checked[name] = quantity(table[name], columns[name], value)
    return checked


def as_entries(parts: Mapping[str, Part]) -> dict[str, dict]:
    """Write laws and shape for fit.json, so that `parts_of_entries` finds them."""
    return {
        slot: {
            "name": text_of(type(part)),
            "source": code_digest(type(part)),
            "fixed": _fixed_fields(part),
        }
        for slot, part in parts.items()
    }


def parts_of_entries(entries: Mapping[str, Mapping], file: Path) -> dict[str, Part]:
    """Find the laws and the shape of fit.json, with default parameters.

    A file of laws that was moved is looked for beside fit.json.

    Raises InputError for one that is not there, or is not what it was.
    """
    parts = {}
    for slot, entry in entries.items():
        try:
            part = part_named(slot, _name_near(entry["name"], file))
        except InputError as error:
            raise InputError(
                f"was fitted with a {slot} that is not there: {error}", file=file
            ) from error
        if code_digest(type(part)) != entry["source"]:
            raise InputError(
                f"was fitted with {slot} {entry['name']}, which has changed since; "
                "calibrate again",
                file=file,
            )
        if _fixed_fields(part) != entry["fixed"]:
            raise InputError(
                f"was fitted with {slot} {entry['name']} of other fixed fields, "
                f"{entry['fixed']}, which cannot be made again; use the result of "
                "calibrate itself",
                file=file,
            )
        parts[slot] = part
    return parts


def _name_near(name: str, file: Path) -> str:
    place, colon, kind = name.rpartition(":")
    if place.endswith(".py") and not Path(place).is_file():
        beside = file.absolute().parent / Path(place).name
        if beside.is_file():
            return f"{beside}{colon}{kind}"
    return name


def _fixed_fields(part: Part) -> dict[str, str]:
    """Collect the fields that are no parameters."""
    return {name: repr(getattr(part, name)) for name in fixed_fields(type(part))}

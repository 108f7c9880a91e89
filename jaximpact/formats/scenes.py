"""Scenes from quantities as users write them, and back."""

import dataclasses
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError, nearest
from ..finding import find_part
from ..parameters import Composite, Part, parameters_of, parts_of
from ..scene import PARTS, Scene
from .columns import InputColumn, columns_of

SLOTS: dict[str, str] = {
    slot: part
    for part, kind in {
        f.name: f.default_factory for f in dataclasses.fields(Scene)
    }.items()
    for slot in parts_of(kind)
}
"""What laws and shapes are for, as keys of files -> the part of the scene they belong
to."""


def with_parts(
    scene: Scene, names: Mapping[str, str], directory: Path | None = None
) -> Scene:
    """The scene with other laws or another shape, by their names.

    What a new law or shape shares by name with the one before keeps its value; its
    other parameters have their defaults.

    Args:
        names: slot to a name, as `finding.find_part` takes it.
        directory: from which files are looked for.
    """
    wholes = {part: getattr(scene, part) for part in PARTS}
    changed: dict[str, dict[str, Part]] = {}
    for slot, name in names.items():
        part = SLOTS[slot]
        kind = parts_of(type(wholes[part]))[slot]
        changed.setdefault(part, {})[slot] = find_part(slot, kind, name, directory)
    for part, slots in changed.items():
        wholes[part] = replaced_parts(wholes[part], slots)
    return Scene(**wholes)


def replaced_parts(whole: Composite, slots: Mapping[str, Part]) -> Composite:
    """The soil or block with other laws or another shape; values of parameters that
    both have are kept."""
    kept = {}
    for slot, new in slots.items():
        before = getattr(whole, slot)
        for name in parameters_of(new):
            if name in parameters_of(before):
                kept[name] = getattr(before, name)
    return dataclasses.replace(whole, **slots, **kept)


def scene_with(scene: Scene, values: Mapping[str, ArrayLike]) -> Scene:
    """The scene with other values of some parameters, in the units of their columns."""
    columns = columns_of(scene)
    changed: dict[str, dict] = {}
    for name, value in values.items():
        column = known_column(columns, name)
        si = column.factor * np.asarray(value, float)
        changed.setdefault(column.part, {})[column.field] = si
    parts = {part: getattr(scene, part) for part in PARTS}
    for part, fields in changed.items():
        parts[part] = dataclasses.replace(parts[part], **fields)
    return Scene(**parts)


def scene_of_values(
    values: Mapping[str, ArrayLike | str], directory: Path | None = None
) -> Scene:
    """A scene from quantities in the units of their columns and names of laws and
    shapes; what is not given has its default."""
    names = {name: value for name, value in values.items() if name in SLOTS}
    numbers = {name: value for name, value in values.items() if name not in SLOTS}
    return scene_with(with_parts(Scene(), names, directory), numbers)


def scene_values(scene: Scene) -> dict:
    """The scene as `scene_of_values` takes it, ready for JSON."""
    values = {}
    usual = {field.name: field.default_factory for field in dataclasses.fields(Scene)}
    for slot, part in SLOTS.items():
        kind = type(getattr(getattr(scene, part), slot))
        fields = {f.name: f for f in dataclasses.fields(usual[part])}
        if kind is not fields[slot].default_factory:
            values[slot] = text_of(kind)
    for column in columns_of(scene).values():
        values[column.name] = value_of(scene, column).tolist()
    return values


def text_of(kind: type[Part]) -> str:
    """The name by which `finding.find_class` finds a class again."""
    if kind.__module__.partition(".")[0] == __name__.partition(".")[0]:
        return kind.__name__
    module = sys.modules.get(kind.__module__)
    spec = getattr(module, "__spec__", None)
    file = getattr(module, "__file__", None)
    if file and (spec is None or (spec.parent == "" and "_" in spec.name)):
        return f"{file}:{kind.__qualname__}"
    return f"{kind.__module__}:{kind.__qualname__}"


def value_of(scene: Scene, column: InputColumn) -> np.ndarray:
    """The parameter of a scene, in the unit of its column."""
    value = np.asarray(getattr(getattr(scene, column.part), column.field))
    return value / column.factor


def known_column(columns: Mapping[str, InputColumn], name: str) -> InputColumn:
    """The column of a name. Raises InputError, with the nearest known."""
    if name not in columns:
        raise InputError(f"{name} is unknown; did you mean {nearest(name, columns)}?")
    return columns[name]

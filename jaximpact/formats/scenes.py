"""Scenes from quantities as users write them, and back."""

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..finding import file_of, find_part
from ..parameters import Composite, Part, parameters_of
from ..scene import PARTS, Scene
from ..shapes import AbstractShape, MixedShapes, shape_of_each
from .columns import BASES, SLOTS, USUAL, InputColumn, columns_of, why_unknown

SHAPE = "shape"
"""The slot of which every lane may have its own."""


def with_parts(
    scene: Scene, names: Mapping[str, str], directory: Path | None = None
) -> Scene:
    """The scene with other laws or another shape, by their names.

    A value that was given is kept if the new law or shape has a parameter of that name;
    its other parameters have their own defaults.

    Args:
        names: slot to a name, as `finding.find_part` takes it.
        directory: from which files are looked for.

    Raises InputError for a name that cannot be used, and for parameters of two laws
    with one name.
    """
    changed: dict[str, dict[str, Part]] = {}
    for slot, name in names.items():
        part = SLOTS[slot]
        changed.setdefault(part, {})[slot] = part_named(slot, name, directory)
    wholes = {part: getattr(scene, part) for part in PARTS}
    for part, slots in changed.items():
        wholes[part] = replaced_parts(wholes[part], slots)
    return Scene(**wholes)


def with_shapes(scene: Scene, kinds: Sequence[type[AbstractShape]]) -> Scene:
    """The scene with a shape for each of its lanes; values that were given are
    kept."""
    block = replaced_parts(scene.block, {SHAPE: shape_of_each(kinds)})
    return Scene(block, scene.soil, scene.impact)


def part_named(slot: str, text: str, directory: Path | None = None) -> Part:
    """A law or a shape for a slot, with its defaults, as `finding.find_part` finds
    it."""
    return find_part(slot, BASES[slot], text, directory)


def replaced_parts(whole: Composite, slots: Mapping[str, Part]) -> Composite:
    """The soil or block with other laws or another shape. A value is kept if the new
    law has a parameter of that name too and it is not the old law's default: what
    nobody gave has the new law's default."""
    kept = {}
    for slot, new in slots.items():
        before = getattr(whole, slot)
        for name in parameters_of(new):
            if name not in parameters_of(before):
                continue
            value = getattr(before, name)
            if not np.array_equal(value, parameters_of(before)[name].si_default):
                kept[name] = value
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
    shapes, of which that of the shape may be a list; what is not given has its
    default."""
    names = {name: value for name, value in values.items() if name in SLOTS}
    numbers = {name: value for name, value in values.items() if name not in SLOTS}
    scene = Scene()
    if not isinstance(names.get(SHAPE, ""), str):
        scene = with_shapes(
            scene,
            [type(part_named(SHAPE, text, directory)) for text in names.pop(SHAPE)],
        )
    return scene_with(with_parts(scene, names, directory), numbers)


def scene_values(scene: Scene) -> dict:
    """The scene as `scene_of_values` takes it, ready for JSON."""
    values: dict = unusual_parts(scene)
    shape = scene.block.shape
    if isinstance(shape, MixedShapes):
        texts = np.array([text_of(kind) for kind in shape.kinds])
        values[SHAPE] = texts[np.asarray(shape.index, int)].tolist()
    for column in columns_of(scene).values():
        values[column.name] = value_of(scene, column).tolist()
    return values


def unusual_parts(scene: Scene) -> dict[str, str]:
    """Names of the laws and the shape that are not the usual ones, by what each is for;
    of several shapes none."""
    held = {slot: getattr(getattr(scene, part), slot) for slot, part in SLOTS.items()}
    return {
        slot: text_of(type(part))
        for slot, part in held.items()
        if type(part) is not USUAL[slot] and not isinstance(part, MixedShapes)
    }


def text_of(kind: type[Part]) -> str:
    """The name by which `finding.find_class` finds a class again."""
    if kind.__module__.partition(".")[0] == __name__.partition(".")[0]:
        return kind.__name__
    file = file_of(kind)
    return f"{file or kind.__module__}:{kind.__qualname__}"


def value_of(scene: Scene, column: InputColumn) -> np.ndarray:
    """The parameter of a scene, in the unit of its column."""
    value = np.asarray(getattr(getattr(scene, column.part), column.field))
    return value / column.factor


def known_column(columns: Mapping[str, InputColumn], name: str) -> InputColumn:
    """The column of a name. Raises InputError, with what may have been meant."""
    if name not in columns:
        raise InputError(f"{name} is unknown; {why_unknown(name, columns)}")
    return columns[name]

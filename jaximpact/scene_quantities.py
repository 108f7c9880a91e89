"""Scenes from quantities as users write them, and back."""

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from .errors import InputError
from .finding import file_of, find_part
from .parameters import Composite, Part, parameters_of
from .quantities import BASES, SLOTS, USUAL, InputColumn, columns_of, why_unknown
from .scene import PARTS, Scene
from .shapes import AbstractShape, MixedShapes, shape_of_each

SHAPE = "shape"
"""Slot in which every lane may have its own part."""
Whole = TypeVar("Whole", bound=Composite)


def with_parts(
    scene: Scene, names: Mapping[str, str], directory: Path | None = None
) -> Scene:
    """Return the scene with other laws or another shape: slot to name, as
    `finding.find_part` takes it.

    A value that was given is kept if the new law or shape has a parameter of that name;
    its other parameters have their own defaults.
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
    """Return the scene with a shape for each of its lanes; given values are kept."""
    block = replaced_parts(scene.block, {SHAPE: shape_of_each(kinds)})
    return Scene(block, scene.soil, scene.impact)


def part_named(slot: str, text: str, directory: Path | None = None) -> Part:
    """Find a law or a shape for a slot, with its defaults, by its name."""
    return find_part(slot, BASES[slot], text, directory)


def shape_named(text: str, directory: Path | None = None) -> type[AbstractShape]:
    """Find a class of shapes by its name."""
    kind: Any = type(part_named(SHAPE, text, directory))
    return kind


def replaced_parts(whole: Whole, slots: Mapping[str, Part]) -> Whole:
    """Return the soil or block with other laws or another shape. A value is kept if the
    new law has a parameter of that name and the value is not the old law's default:
    what nobody gave has the new law's default."""
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
    """Return the scene with other values of some parameters, in the units of their
    columns."""
    columns = columns_of(scene)
    changed: dict[str, dict] = {}
    for name, value in values.items():
        if name not in columns:
            raise InputError(f"{name} is unknown; {why_unknown(name, columns)}")
        column = columns[name]
        si = column.factor * np.asarray(value, float)
        changed.setdefault(column.part, {})[column.field] = si
    parts = {part: getattr(scene, part) for part in PARTS}
    for part, fields in changed.items():
        parts[part] = dataclasses.replace(parts[part], **fields)
    return Scene(**parts)


def scene_of_values(values: Mapping[str, ArrayLike | str]) -> Scene:
    """Make a scene of quantities in the units of their columns and of names of laws and
    shapes, of which that of the shape may be a list; what is not given has its
    default."""
    names: dict[str, Any] = {n: value for n, value in values.items() if n in SLOTS}
    numbers: dict[str, Any] = {n: v for n, v in values.items() if n not in SLOTS}
    scene = Scene()
    if not isinstance(names.get(SHAPE, ""), str):
        scene = with_shapes(scene, [shape_named(text) for text in names.pop(SHAPE)])
    return scene_with(with_parts(scene, names), numbers)


def scene_values(scene: Scene) -> dict:
    """Return the scene as `scene_of_values` takes it, ready for JSON."""
    values: dict = unusual_parts(scene)
    shape = scene.block.shape
    if isinstance(shape, MixedShapes):
        texts = np.array([text_of(kind) for kind in shape.kinds])
        values[SHAPE] = texts[np.asarray(shape.index, int)].tolist()
    for column in columns_of(scene).values():
        values[column.name] = value_of(scene, column).tolist()
    return values


def unusual_parts(scene: Scene) -> dict[str, str]:
    """Return the names of the laws and the shape that are not the usual ones, by their
    slots; of several shapes none."""
    part_of = {
        slot: getattr(getattr(scene, part), slot) for slot, part in SLOTS.items()
    }
    return {
        slot: text_of(type(part))
        for slot, part in part_of.items()
        if type(part) is not USUAL[slot] and not isinstance(part, MixedShapes)
    }


def text_of(kind: type[Part]) -> str:
    """Return the name by which `finding.find_class` finds a class again."""
    if kind.__module__.partition(".")[0] == __name__.partition(".")[0]:
        return kind.__name__
    file = file_of(kind)
    return f"{file or kind.__module__}:{kind.__qualname__}"


def value_of(scene: Scene, column: InputColumn) -> np.ndarray:
    """Return a parameter of a scene in the unit of its column."""
    value = np.asarray(getattr(getattr(scene, column.part), column.field))
    return value / column.factor

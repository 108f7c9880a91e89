"""Quantities of the scenes of many impacts: their values, and along what they vary."""

from typing import NamedTuple

import numpy as np

from ..parameters import declared_of
from ..scene import Scene
from ..shapes import MixedShapes
from .columns import InputColumn, columns_of
from .scenes import value_of


class Input(NamedTuple):
    """A quantity of many scenes."""

    column: InputColumn
    values: np.ndarray
    """In the unit of the column, one for each scene."""
    axes: tuple[int, ...]
    """The axes of the scenes along which the values differ."""


def inputs_of(scene: Scene, shape: tuple[int, ...]) -> dict[str, Input]:
    """Every quantity of scenes whose fields broadcast to a shape, by its column."""
    found = {}
    for name, column in columns_of(scene).items():
        values = np.broadcast_to(value_of(scene, column), shape)
        found[name] = Input(column, values, varying_axes(values))
    return found


def varying_axes(values: np.ndarray) -> tuple[int, ...]:
    """The axes along which values are not all the same."""
    return tuple(
        axis
        for axis in range(values.ndim)
        if values.size and np.any(values != values.take([0], axis))
    )


def along(values: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    """Values that vary along these axes alone, without the other axes."""
    return values[tuple(slice(None) if k in axes else 0 for k in range(values.ndim))]


def kind_of_each(scene: Scene, shape: tuple[int, ...]) -> np.ndarray | None:
    """The class of each scene's shape; None where there is one class for all."""
    mixed = scene.block.shape
    if not isinstance(mixed, MixedShapes):
        return None
    kinds = np.empty(len(mixed.kinds), object)
    kinds[:] = mixed.kinds
    return kinds[np.broadcast_to(np.asarray(mixed.index, int), shape)]


def is_of_some(column: InputColumn, scene: Scene) -> bool:
    """Whether a quantity is a parameter of some of the scenes' shapes, and not of
    all."""
    shape = scene.block.shape
    if column.part != "block" or not isinstance(shape, MixedShapes):
        return False
    has = [column.field in declared_of(kind) for kind in shape.kinds]
    return any(has) and not all(has)

"""What is varied and what is watched, by the names of the tables."""

import dataclasses
from collections.abc import Iterable, Mapping

import jax
import numpy as np
from numpy.typing import ArrayLike

from ..formats.checks import checked_names
from ..formats.columns import (
    INPUT_COLUMNS,
    RESULT_COLUMNS,
    InputColumn,
    ResultColumn,
    column_of_field,
)
from ..scene import PARTS, Scene
from ..sweeping import OUTPUT_COLUMNS

DEFAULT_PARAMETERS = ("c_v", "gamma_v", "k_E")
DEFAULT_OUTPUTS = tuple(RESULT_COLUMNS)
WATCHED = {name: c for name, c in OUTPUT_COLUMNS.items() if name != "steps"}
"""The numbers that belong to the impact, not to how it was computed."""


def parameter_columns(names: Iterable[str]) -> tuple[InputColumn, ...]:
    """The columns of parameters. Raises InputError for a name that is unknown or stands
    twice, and for none."""
    names = checked_names("parameter", names, INPUT_COLUMNS)
    return tuple(INPUT_COLUMNS[name] for name in names)


def output_columns(names: Iterable[str]) -> tuple[ResultColumn, ...]:
    """The columns of outputs. Raises InputError as `parameter_columns` does."""
    return tuple(WATCHED[name] for name in checked_names("output", names, WATCHED))


def value_of(scene: Scene, column: InputColumn) -> np.ndarray:
    """The parameter of a scene, in the unit of its column."""
    return np.asarray(getattr(getattr(scene, column.part), column.field)) / (
        column.factor
    )


def scene_with(scene: Scene, values: Mapping[str, ArrayLike]) -> Scene:
    """The scene with other values of some parameters, in the units of their columns."""
    parts = {part: getattr(scene, part) for part in PARTS}
    for name, value in values.items():
        column = INPUT_COLUMNS[name]
        changed = {column.field: column.factor * np.asarray(value, float)}
        parts[column.part] = dataclasses.replace(parts[column.part], **changed)
    return Scene(**parts)


def leaf_of(column: InputColumn) -> int:
    """Place of a parameter among the leaves of a scene."""
    paths = jax.tree_util.tree_flatten_with_path(Scene())[0]
    places = [
        column_of_field(*(key.name for key in path)).name == column.name
        for path, _ in paths
    ]
    return places.index(True)

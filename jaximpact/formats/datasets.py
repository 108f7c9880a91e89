"""Impacts as datasets: numbers with units, and what they were computed from."""

import dataclasses
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..errors import InputError
from ..identity import name_of, part_names
from ..scene import Scene
from ..shapes import AbstractShape
from .columns import (
    ENERGY_COLUMNS,
    FURTHER_COLUMNS,
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    RESULT_COLUMNS,
    InputColumn,
    ResultColumn,
)
from .inputs import along, inputs_of, is_of_some, kind_of_each, varying_axes
from .provenance import versions
from .results import count_outcomes, outcomes_in_words
from .scenes import SHAPE, scene_values, text_of

if TYPE_CHECKING:
    from ..result import ImpactResult

SHAPES = "shapes"
"""Attribute of a dataset over shapes: label -> the name by which each is found, and
what it was."""
OUTPUT_COLUMNS = RESULT_COLUMNS | FURTHER_COLUMNS
"""The numbers that a dataset holds."""
SCENE_DIMENSION = "scene"
"""Dimension of scenes side by side."""


def dataset_of(
    result: "ImpactResult",
    dimensions: Sequence[str],
    shape: tuple[int, ...],
    coordinates: Mapping,
    base: Scene,
    values: Mapping,
    kinds: Iterable[type[AbstractShape]] = (),
) -> xr.Dataset:
    """The numbers of impacts with units, outcome and provenance.

    Args:
        result: one impact, or as many as `shape` has places.
        dimensions: their names. shape: their lengths.
        coordinates: as `xr.Dataset` takes them.
        base: laws and shape. values: of it, as `scene_values` gives them.
        kinds: classes of shapes, where they vary.
    """

    def variable(values, column: ResultColumn):
        values = np.asarray(values).reshape(shape)
        return dimensions, values, attributes_of(column)

    variables = {
        name: variable(getattr(result, column.field), column)
        for name, column in OUTPUT_COLUMNS.items()
    }
    if result.energy is not None:
        variables |= {
            name: variable(getattr(result.energy, column.field), column)
            for name, column in ENERGY_COLUMNS.items()
        }
    variables[OUTCOME_COLUMN] = (
        dimensions,
        outcomes_in_words(result.outcome_code).reshape(shape),
        {"long_name": OUTCOME_MEANING},
    )
    shapes = {label_of(kind, kinds): [text_of(kind), name_of(kind)] for kind in kinds}
    return xr.Dataset(
        variables,
        coordinates,
        attrs={
            "title": "jaximpact: impacts of rock blocks on deformable ground",
            "base": json.dumps(values),
            "accuracy": json.dumps(dataclasses.asdict(result.accuracy)),
            "model_tolerance": result.model_tolerance,
            "laws": json.dumps(part_names(base.soil, base.block)),
            "versions": json.dumps(versions()),
            "outcomes": json.dumps(count_outcomes(result)),
        }
        | ({SHAPES: json.dumps(shapes)} if shapes else {}),
    )


def attributes_of(column: InputColumn | ResultColumn) -> dict[str, str]:
    """Unit and meaning of a quantity, as attributes of a variable."""
    return {"units": column.unit, "long_name": column.meaning}


def label_of(kind: type[AbstractShape], kinds: Iterable[type[AbstractShape]]) -> str:
    """What a shape is called among others: its class's name, if that says which."""
    same = {other for other in kinds if other.__name__ == kind.__name__}
    return kind.__name__ if len(same) == 1 else text_of(kind)


def shape_coordinate(dimensions, kinds: np.ndarray) -> tuple:
    """Classes of shapes as a coordinate of a dataset."""
    different = set(kinds.flat)
    labels = {kind: label_of(kind, different) for kind in different}
    values = np.array([labels[kind] for kind in kinds.flat]).reshape(kinds.shape)
    return dimensions, values, {"long_name": SHAPE}


def dataset_of_result(
    result: "ImpactResult", dims: Sequence[str] | None = None
) -> xr.Dataset:
    """The dataset that `ImpactResult.to_xarray` gives."""
    shape = result.shape
    dimensions = dimension_names(len(shape)) if dims is None else dims
    _check_dimensions(dimensions, shape)
    if 0 in shape:
        raise InputError(
            f"a dataset needs at least one impact, but the result has shape {shape}"
        )
    coordinates = scene_coordinates(result.scene, shape, dimensions)
    for name in dimensions:
        if name in coordinates and coordinates[name][0] != (name,):
            raise InputError(
                f"{name} cannot be the name of a dimension, as it varies along "
                f"{' and '.join(coordinates[name][0])}"
            )
    kinds = kind_of_each(result.scene, shape)
    kinds = sorted(set(kinds.flat), key=text_of) if SHAPE in coordinates else ()
    base = result[(0,) * len(shape)].scene
    # The shape stays: it is that of the laws, whichever the coordinate names.
    values = {
        name: value
        for name, value in scene_values(base).items()
        if name == SHAPE or name not in coordinates
    }
    return dataset_of(result, dimensions, shape, coordinates, base, values, kinds)


def dimension_names(count: int) -> tuple[str, ...]:
    """Names of the axes of impacts that nobody named."""
    if count == 1:
        return (SCENE_DIMENSION,)
    return tuple(f"{SCENE_DIMENSION}_{place}" for place in range(count))


def scene_coordinates(
    scene: Scene, shape: tuple[int, ...], dimensions: Sequence[str]
) -> dict[str, tuple]:
    """Coordinates of many scenes: the quantities that vary, along the dimensions along
    which they do.

    A quantity after which a dimension is named is a coordinate even if it is the same
    everywhere; so is, beside shapes, what only some of them have as a parameter.
    """
    coordinates = {}

    def names(axes: Iterable[int]) -> tuple[str, ...]:
        return tuple(dimensions[axis] for axis in axes)

    kinds = kind_of_each(scene, shape)
    of_shape = () if kinds is None else varying_axes(kinds)
    if of_shape:
        coordinates[SHAPE] = shape_coordinate(names(of_shape), along(kinds, of_shape))
    for name, (column, values, axes) in inputs_of(scene, shape).items():
        if not axes and name in dimensions:
            axes = (list(dimensions).index(name),)
        if not axes and is_of_some(column, scene):
            axes = of_shape
        if axes:
            values = along(values, axes)
            coordinates[name] = names(axes), values, attributes_of(column)
    return coordinates


def _check_dimensions(dimensions: Sequence[str], shape: tuple[int, ...]) -> None:
    """Raise InputError for what cannot be the names of the axes."""
    texts = isinstance(dimensions, Sequence) and not isinstance(dimensions, str)
    if not texts or not all(isinstance(name, str) for name in dimensions):
        raise InputError(f"dims must be a tuple of names, but is {dimensions!r}")
    if len(set(dimensions)) != len(dimensions) or len(dimensions) != len(shape):
        raise InputError(
            f"dims must be {len(shape)} different names, one for each axis of the "
            f"shape {shape}, but is {dimensions!r}"
        )
    taken = {*OUTPUT_COLUMNS, *ENERGY_COLUMNS, OUTCOME_COLUMN}
    for name in dimensions:
        if name in taken:
            raise InputError(
                f"{name} cannot be the name of a dimension, as it is that of a result"
            )

"""Parametric sweeps: impacts over any quantities of the scene, with names and units."""

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .batch import simulate_batch
from .block import Block
from .errors import InputError
from .fields import expect, real_numbers
from .formats.checks import NUMBERS_PER_IMPACT, check_memory, check_scene
from .formats.columns import (
    OUTCOME_COLUMN,
    SLOTS,
    InputColumn,
    columns_of,
    why_unknown,
)
from .formats.datasets import (
    OUTPUT_COLUMNS,
    SHAPES,
    attributes_of,
    dataset_of,
    shape_coordinate,
)
from .formats.scenes import (
    SHAPE,
    part_named,
    scene_of_values,
    scene_values,
    scene_with,
    with_shapes,
)
from .identity import name_of, part_names
from .scene import Impact, Scene, as_scene
from .shapes import AbstractShape
from .soil import Soil

LABELS = "name"
"""Key of a group of quantities that gives the labels along its dimension."""

Axes = Mapping[str, ArrayLike | Mapping[str, ArrayLike]]


class _Axis(NamedTuple):
    """One dimension of a sweep."""

    name: str
    values: dict[str, np.ndarray]
    """Quantities that vary along it, in the units of their columns; of the shape, its
    classes."""
    labels: np.ndarray | None
    length: int


def sweep(
    base: Scene | Block | tuple[Block, Soil, Impact],
    axes: Axes,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    model_tolerance: float = 0.0,
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Impacts at every combination of the values along the axes.

    Args:
        base: the scene, as for `simulate`, scalars only, in SI units; what no axis says
            is as here.
        axes: dimension -> values, in its order. A dimension named as an input column
            (`"angle_deg"`) takes a list of that quantity, in the unit of its name;
            columns are those of the base's own laws and shapes. `"shape"` takes names
            of shapes, as `Block` does; a parameter that a shape does not have changes
            nothing for it. Any other name stands for quantities that vary together: a
            mapping from input columns to lists of one length, and from `"name"` to
            labels, if wanted.
        accuracy, model_tolerance, journal, progress: as for `simulate_batch`.

    Returns:
        A dataset with a variable for each number of an impact, named and in units as in
        the tables, and `outcome` in words. Coordinates are the quantities of the axes.
        Points that fail are NaN with the outcome `failed`; counts of outcomes, the
        base, accuracy, laws and versions stand in the attributes, enough for
        `repeat_sweep`.

    Raises:
        InputError: an unknown quantity, a value out of its range, lists that do not
            match, naming the axis.
        ValueError: a base that is no single scene.
    """
    base = as_scene(base)
    check_scene(base)
    setting = get_accuracy(accuracy)
    grid = check_axes(axes, base)
    shape = tuple(axis.length for axis in grid)
    scene = spread(base, grid, shape)
    result = simulate_batch(
        scene,
        accuracy=setting,
        model_tolerance=model_tolerance,
        journal=journal,
        progress=progress,
    )
    return dataset_of(
        result,
        [axis.name for axis in grid],
        shape,
        coordinates_of(grid, scene),
        base,
        scene_values(base),
        [kind for axis in grid for kind in axis.values.get(SHAPE, ())],
    )


def repeat_sweep(dataset: xr.Dataset, **how) -> xr.Dataset:
    """Compute a sweep again, from nothing but what the dataset says about itself.

    Args:
        dataset: from `sweep`, whole or a selection that keeps its dimensions and, for
            each parameter that varies, a shape that has it.
        how: `journal` and `progress` of `sweep`.

    Raises InputError if the dataset is no sweep, or was made with laws that are not
    found again as they were.
    """
    expect("dataset", dataset, xr.Dataset)
    try:
        values = json.loads(dataset.attrs["base"])
        accuracy = Accuracy(**json.loads(dataset.attrs["accuracy"]))
        stored_laws = json.loads(dataset.attrs["laws"])
        model_tolerance = float(dataset.attrs["model_tolerance"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"the dataset does not say what it was computed from ({error!r}); "
            "a dataset from sweep is needed"
        ) from None
    base = scene_of_values(values)
    for slot, name in part_names(base.soil, base.block).items():
        _check_same(slot, stored_laws.get(slot), name)
    axes = axes_of(dataset)
    shapes = json.loads(dataset.attrs.get(SHAPES, "{}"))
    for along in (axes, *(along for along in axes.values() if _is_group(along))):
        if SHAPE in along:
            along[SHAPE] = [_same_shape(*shapes[label]) for label in along[SHAPE]]
    return sweep(
        base,
        axes,
        accuracy=accuracy,
        model_tolerance=model_tolerance,
        **how,
    )


def _check_same(slot: str, stored: str | None, found: str) -> None:
    if stored != found:
        raise InputError(
            f"the dataset was computed with {slot} {stored}, but there is {found} now"
        )


def _same_shape(text: str, stored: str) -> type[AbstractShape]:
    """The class of shapes of a name, if it is what it was."""
    kind = type(part_named(SHAPE, text))
    _check_same(SHAPE, stored, name_of(kind))
    return kind


def axes_of(dataset: xr.Dataset) -> dict[str, ArrayLike | dict[str, ArrayLike]]:
    """The axes of a sweep, as `sweep` takes them."""
    for name, coordinate in dataset.coords.items():
        if coordinate.ndim > 1:
            raise InputError(
                f"{name} varies along {' and '.join(coordinate.dims)}, but a quantity "
                "of a sweep varies along one dimension"
            )
    axes = {}
    for dimension in dataset[OUTCOME_COLUMN].dims:
        along = {
            name: coordinate.values
            for name, coordinate in dataset.coords.items()
            if coordinate.dims == (dimension,)
        }
        own = list(along) == [dimension]
        if own and (dimension == SHAPE or along[dimension].dtype.kind != "U"):
            axes[dimension] = along[dimension]
        else:
            # Labels are the dimension's own coordinate.
            axes[dimension] = {
                LABELS if name == dimension else name: values
                for name, values in along.items()
            }
    return axes


def check_axes(axes: Axes, base: Scene) -> list[_Axis]:
    """The axes, checked. Raises InputError as `sweep` does."""
    expect("axes", axes, Mapping)
    if not axes:
        raise InputError("a sweep needs at least one axis, but got none")
    columns = columns_of_axes(axes, base)
    grid, seen = [], {}
    for name, given in axes.items():
        read = _read_group if _is_group(given) else _read_one
        axis = read(name, given, columns)
        for quantity in axis.values:
            if quantity in seen:
                raise InputError(
                    f"axis {name}: {quantity} already varies along {seen[quantity]}"
                )
            seen[quantity] = name
        grid.append(axis)
    points = math.prod(axis.length for axis in grid)
    check_memory(points * NUMBERS_PER_IMPACT, f"{points} points")
    return grid


def _is_group(given) -> bool:
    return isinstance(given, Mapping)


def columns_of_axes(axes: Axes, base: Scene) -> dict[str, InputColumn]:
    """The columns that may vary: of the base and, where shapes vary, of all of them."""
    return columns_of(_of_shapes(base, _shapes_of(axes)))


def _shapes_of(axes: Axes) -> list[type[AbstractShape]]:
    """The shapes that vary along the axes."""
    for name, given in axes.items():
        if _is_group(given) and SHAPE in given:
            return list(_kinds(f"axis {name}: {SHAPE}", given[SHAPE]))
        if name == SHAPE and not _is_group(given):
            return list(_kinds(f"axis {SHAPE}", given))
    return []


def _of_shapes(base: Scene, kinds: Sequence[type[AbstractShape]]) -> Scene:
    return with_shapes(base, kinds) if len(kinds) else base


def _kinds(where: str, given) -> np.ndarray:
    """Classes of shapes, by their names."""
    several = isinstance(given, Iterable) and not isinstance(given, str)
    texts = list(given) if several else []
    kinds = np.empty(len(texts), object)
    for place, text in enumerate(texts):
        if isinstance(text, type) and issubclass(text, AbstractShape):
            kinds[place] = text
        elif isinstance(text, str):
            kinds[place] = type(part_named(SHAPE, text))
        else:
            texts = []
            break
    if not texts:
        raise InputError(f"{where} must be a list of names of shapes, but is {given!r}")
    return kinds


def _read_one(name: str, given: ArrayLike, columns: Mapping[str, InputColumn]) -> _Axis:
    if name == SHAPE:
        kinds = _kinds(f"axis {name}", given)
        return _Axis(name, {name: kinds}, None, len(kinds))
    if name not in columns:
        raise InputError(f"axis {name} is unknown; {why_unknown_axis(name, columns)}")
    values = _numbers(name, columns[name], given)
    return _Axis(name, {name: values}, None, len(values))


def _read_group(
    name: str, given: Mapping[str, ArrayLike], columns: Mapping[str, InputColumn]
) -> _Axis:
    taken = {*columns, *OUTPUT_COLUMNS, OUTCOME_COLUMN, SHAPE}
    if name in taken:
        raise InputError(
            f"axis {name} varies several quantities together and needs a name of its "
            f"own, but {name} is a quantity"
        )
    labels, values = None, {}
    for quantity, numbers in given.items():
        if quantity == LABELS:
            labels = _labels(name, numbers)
        elif quantity == SHAPE:
            values[quantity] = _kinds(f"axis {name}: {quantity}", numbers)
        elif quantity not in columns:
            why = why_unknown_axis(quantity, columns, LABELS)
            raise InputError(f"axis {name}: {quantity} is unknown; {why}")
        else:
            values[quantity] = _numbers(name, columns[quantity], numbers)
    if not values:
        raise InputError(f"axis {name} varies no quantity; give at least one")
    lengths = {quantity: len(numbers) for quantity, numbers in values.items()}
    if labels is not None:
        lengths[LABELS] = len(labels)
    if len(set(lengths.values())) > 1:
        counts = ", ".join(f"{key} {count}" for key, count in lengths.items())
        raise InputError(
            f"axis {name} varies quantities together, which takes lists of one length, "
            f"but they have {counts}"
        )
    return _Axis(name, values, labels, next(iter(lengths.values())))


def why_unknown_axis(
    name: str, columns: Mapping[str, InputColumn], *others: str
) -> str:
    """What may have been meant by a quantity that cannot vary."""
    if name in SLOTS:
        return f"a sweep has one {name}, that of its base"
    return why_unknown(name, (*columns, SHAPE, *others))


def _labels(axis: str, given) -> np.ndarray:
    several = isinstance(given, Iterable) and not isinstance(given, str)
    texts = list(given) if several else []
    if not texts or not all(isinstance(text, str) for text in texts):
        raise InputError(f"axis {axis}: {LABELS} must be texts, but is {given!r}")
    return np.array(texts)


def _numbers(axis: str, column: InputColumn, given: ArrayLike) -> np.ndarray:
    """Values of a quantity, checked."""
    quantity = column.name
    where = f"axis {axis}" if axis == quantity else f"axis {axis}: {quantity}"
    values = np.asarray(real_numbers(where, given), float)
    if values.ndim != 1 or values.size == 0:
        raise InputError(
            f"{where} must be a list of at least one number, but has shape "
            f"{values.shape}"
        )
    bad = ~column.is_allowed(values)
    if np.any(bad):
        value = values[bad][0]
        raise InputError(
            f"{where} must be {column.requirement}, but holds {value:g}"
            f"{column.hint(value, column.unit)}"
        )
    return values


def spread(base: Scene, grid: list[_Axis], shape: tuple[int, ...]) -> Scene:
    """The scenes of all points, one after another, the last axis fastest."""
    along = {}
    for place, axis in enumerate(grid):
        lie = [-1 if i == place else 1 for i in range(len(grid))]
        for name, values in axis.values.items():
            along[name] = np.broadcast_to(values.reshape(lie), shape).ravel()
    return scene_with(_of_shapes(base, along.pop(SHAPE, ())), along)


def coordinates_of(grid: list[_Axis], scene: Scene) -> dict:
    """The quantities of the axes as coordinates of a dataset.

    Args:
        scene: of all points.
    """
    columns, coordinates = columns_of(scene), {}
    for axis in grid:
        if axis.labels is not None:
            coordinates[axis.name] = (axis.name, axis.labels)
        for name, values in axis.values.items():
            if name == SHAPE:
                coordinates[name] = shape_coordinate(axis.name, values)
                continue
            coordinates[name] = (axis.name, values, attributes_of(columns[name]))
    return coordinates

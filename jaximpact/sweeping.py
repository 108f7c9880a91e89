"""Parametric sweeps: impacts over any quantities of the scene, with names and units."""

import concurrent.futures
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import jax
import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike

from ._checks import expect, real_numbers
from ._settings import numpy_settings
from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .backend.rows import in_parts
from .batch import broadcast_scene, simulate_batch
from .errors import InputError
from .impact.results import SERIES, check_beside_series
from .io.checks import (
    NUMBERS_PER_IMPACT,
    check_memory,
    check_scene,
    check_times,
    check_units,
)
from .io.datasets import (
    OUTPUT_COLUMNS,
    attributes_of,
    dataset_of,
    shape_coordinate,
)
from .io.toml import (
    Key,
    check_keys,
    choice,
    load_toml,
    number,
    of_kind,
    scene_from,
    typed,
    whole,
)
from .io.toml import (
    quantity as read_quantity,
)
from .lazy.impacts import Chunks, lazy_grid
from .progress import Progress, ProgressFunction, as_progress
from .quantities import OUTCOME_COLUMN, SLOTS, InputColumn, columns_of, why_unknown
from .result import ImpactResult
from .scene import PARTS, Scene, SceneLike, as_scene
from .scene_quantities import (
    SHAPE,
    scene_values,
    scene_with,
    shape_named,
    with_shapes,
)
from .shapes import AbstractShape
from .simulation import simulate

LABELS = "name"
"""Key, in a group of quantities, of the labels along its dimension."""

Group = Mapping | pd.DataFrame
"""Quantities that vary together: lists, or columns, by their names."""
Axes = Mapping[str, ArrayLike | Group]


class _Axis(NamedTuple):
    name: str
    values: dict[str, Any]
    """Quantities that vary along the axis -> arrays in the units of their columns; of
    the shape, an array of its classes."""
    labels: np.ndarray | None
    """Labels of the points, if there are any."""
    length: int
    """Number of points."""


@numpy_settings()
def sweep(
    base: SceneLike,
    axes: Axes,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    save_at: ArrayLike | None = None,
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
    chunks: Chunks | None = None,
    executor: concurrent.futures.Executor | None = None,
) -> xr.Dataset:
    """Compute impacts at every combination of the values along the axes.

    Args:
        base: the scene, as for `simulate`, scalars only, in SI units; the values of
            what varies along no axis.
        axes: dimension -> values. A dimension named as an input column (`"angle_deg"`)
            takes a list of that quantity, in the unit of its name; columns are those of
            the base's own laws and shapes. `"shape"` takes names of shapes, as `Block`
            does; a parameter that a shape does not have changes nothing for it. Any
            other name stands for quantities that vary together: a mapping (or a data
            frame) from input columns to lists of one length, and optionally from
            `"name"` to labels.
        accuracy, journal, progress, executor: as for `simulate_batch`.
        save_at: times since touch [s] at which forces and motion are wanted, one list
            for all points: variables over `time`, as `simulate` gives them.
        chunks: lengths of blocks along all axes or each, or `"auto"`: nothing is
            computed until results are asked for, block by block, one thread each, by
            whatever scheduler or client of Dask there is. Needs `jaximpact[cluster]`.
            Such a sweep may be larger than memory (`write_zarr`), has the same numbers
            to the last bit, and no attribute `outcomes`, as nobody has counted yet.

    Returns:
        A dataset with a variable for each number of an impact, with names and units as
        in the tables, and `outcome` in words. Coordinates are the quantities of the
        axes. Points that fail are NaN with the outcome `failed`. Counts of outcomes,
        base, accuracy, laws and versions are attributes.

    Raises:
        InputError: an unknown quantity, a value out of its range or in another unit by
            its attribute `units`, lists that do not match, naming the axis.
        ValueError: a base that is no single scene.
    """
    base = as_scene(base)
    check_scene(base)
    setting = get_accuracy(accuracy)
    grid = check_axes(axes, base, in_memory=chunks is None)
    kinds = [kind for axis in grid for kind in axis.values.get(SHAPE, ())]
    if save_at is not None:
        if not (chunks is None and journal is None and executor is None):
            raise InputError(
                "a sweep with save_at is computed at once, here: give it no chunks, "
                "journal or executor"
            )
        times, _ = check_times(save_at, ())
        if np.ndim(times) > 1:
            raise InputError("save_at must be one list of times, for all points")
        check_beside_series(axis.name for axis in grid)
        points = math.prod(axis.length for axis in grid)
        what = f"{points} points at {len(times)} times"
        check_memory(points * len(times) * len(SERIES), what)
    if chunks is not None:
        if not (journal is None and progress is None and executor is None):
            raise InputError(
                "a sweep in chunks is computed later: give it no journal, progress or "
                "executor, but write_zarr, which has progress and can be interrupted"
            )
        return lazy_grid(
            base,
            {axis.name: axis.values for axis in grid},
            coordinates_of(grid, with_shapes(base, kinds) if kinds else base),
            setting,
            chunks,
        )
    shape = tuple(axis.length for axis in grid)
    scene = spread(base, grid, shape)
    if save_at is None:
        result = simulate_batch(
            scene,
            accuracy=setting,
            journal=journal,
            progress=progress,
            executor=executor,
        )
    else:
        result = _with_histories(scene, setting, save_at, as_progress(progress))
    return dataset_of(
        result,
        setting,
        [axis.name for axis in grid],
        shape,
        coordinates_of(grid, scene),
        base,
        scene_values(base),
        kinds,
    )


def _with_histories(
    scene: Scene, accuracy: Accuracy, times: ArrayLike, progress: Progress
) -> ImpactResult:
    """Simulate scenes with their histories, some at a time."""
    scene, count = broadcast_scene(scene)
    results = []
    for part in in_parts(np.arange(count)):
        some = jax.tree.map(lambda leaf, part=part: leaf[part], scene)
        results.append(simulate(some, accuracy=accuracy, save_at=times))
        progress("impacts", int(part[-1]) + 1, count)
    return jax.tree.map(lambda *parts: np.concatenate(parts), *results)


def check_axes(axes: Axes, base: Scene, *, in_memory: bool = True) -> list[_Axis]:
    """Check axes and their values. Raises InputError as `sweep` does, and where the
    points would not fit into memory if they have to."""
    expect("axes", axes, Mapping)
    if not axes:
        raise InputError("a sweep needs at least one axis, but got none")
    columns = columns_of_axes(axes, base)
    grid, seen = [], {}
    for name, values in axes.items():
        expect("the name of an axis", name, str)
        if not name:
            raise InputError("the name of an axis must have a letter, but is ''")
        axis = _checked_axis(name, values, columns)
        for quantity in axis.values:
            if quantity in seen:
                raise InputError(
                    f"axis {name}: {quantity} already varies along {seen[quantity]}"
                )
            seen[quantity] = name
        grid.append(axis)
    points = math.prod(axis.length for axis in grid)
    if in_memory:
        check_memory(points * NUMBERS_PER_IMPACT, f"{points} points")
    return grid


def columns_of_axes(axes: Axes, base: Scene) -> dict[str, InputColumn]:
    """Return the columns that may vary: those of the base and, where shapes vary, of
    all these shapes."""
    for name, of_axis in axes.items():
        for quantity, values in _quantities_of(name, of_axis).items():
            if quantity == SHAPE:
                return columns_of(
                    with_shapes(base, _kinds(_place(name, SHAPE), values))
                )
    return columns_of(base)


def _quantities_of(name: str, values) -> Mapping[str, ArrayLike]:
    return dict(values) if isinstance(values, Group) else {name: values}


def _place(axis: str, quantity: str) -> str:
    """Name a quantity of an axis in messages."""
    return f"axis {axis}" if axis == quantity else f"axis {axis}: {quantity}"


def _checked_axis(
    name: str,
    of_axis: ArrayLike | Group,
    columns: Mapping[str, InputColumn],
) -> _Axis:
    grouped = isinstance(of_axis, Group)
    if grouped and name in {*columns, *OUTPUT_COLUMNS, OUTCOME_COLUMN, SHAPE}:
        raise InputError(
            f"axis {name} varies several quantities together and needs a name of its "
            f"own, but {name} is a quantity"
        )
    labels, values = None, {}
    for quantity, entries in _quantities_of(name, of_axis).items():
        place = _place(name, quantity)
        if quantity == LABELS and grouped:
            labels = _labels(place, entries)
        elif quantity == SHAPE:
            values[quantity] = _kinds(place, entries)
        elif quantity in columns:
            values[quantity] = _numbers(place, columns[quantity], entries)
        else:
            why = why_unknown_axis(quantity, columns, *[LABELS] * grouped)
            raise InputError(f"{place} is unknown; {why}")
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
    """Say what may have been meant by a quantity that cannot vary."""
    if name in SLOTS:
        return f"a sweep has one {name}, that of its base"
    return why_unknown(name, (*columns, SHAPE, *others))


def _entries(values) -> list:
    several = isinstance(values, Iterable) and not isinstance(values, str)
    # An array of xarray's would give arrays.
    values = np.asarray(values) if hasattr(values, "__array__") else values
    return list(values) if several else []


def _kinds(place: str, values) -> Any:
    """Return an array of classes of shapes, given by their names or themselves."""
    classes = [shape_named(e) if isinstance(e, str) else e for e in _entries(values)]
    if not classes or not all(
        isinstance(kind, type) and issubclass(kind, AbstractShape) for kind in classes
    ):
        raise InputError(
            f"{place} must be a list of names of shapes, but is {values!r}"
        )
    kinds = np.empty(len(classes), object)
    kinds[:] = classes
    return kinds


def _labels(place: str, values) -> np.ndarray:
    texts = _entries(values)
    if not texts or not all(isinstance(text, str) for text in texts):
        raise InputError(f"{place} must be texts, but is {values!r}")
    return np.array(texts)


def _numbers(place: str, column: InputColumn, entries: ArrayLike) -> np.ndarray:
    check_units(place, column, entries)
    values = np.asarray(real_numbers(place, entries), float)
    if values.ndim != 1 or values.size == 0:
        raise InputError(
            f"{place} must be a list of at least one number, but has shape "
            f"{values.shape}"
        )
    bad = ~column.is_allowed(values)
    if np.any(bad):
        value = values[bad][0]
        raise InputError(
            f"{place} must be {column.requirement_of(value)}, but holds {value:g}"
            f"{column.hint(value, column.unit)}"
        )
    return values


def spread(base: Scene, grid: list[_Axis], shape: tuple[int, ...]) -> Scene:
    """Return the scenes of all points, one after another, the last axis fastest."""
    along = {}
    for axis, places in zip(grid, np.indices(shape), strict=True):
        for name, values in axis.values.items():
            along[name] = values[places.ravel()]
    kinds = along.pop(SHAPE, None)
    if not along and kinds is not None and len(set(kinds)) == 1:
        # One class of shape, without a number that varies, is no array.
        along["mass_kg"] = np.full(len(kinds), float(base.block.mass))
    return scene_with(base if kinds is None else with_shapes(base, kinds), along)


def coordinates_of(grid: list[_Axis], scene: Scene) -> dict:
    """Return the quantities of the axes as coordinates of a dataset; the scene has the
    laws and shapes of all points."""
    columns, coordinates = columns_of(scene), {}
    for axis in grid:
        if axis.labels is not None:
            coordinates[axis.name] = (axis.name, axis.labels)
        for name, values in axis.values.items():
            coordinates[name] = (
                shape_coordinate(axis.name, values)
                if name == SHAPE
                else (axis.name, values, attributes_of(columns[name]))
            )
    return coordinates


# --- From a file.

RANGE_KEYS = ("from", "to", "count", "spacing")
SPACINGS = {"linear": np.linspace, "logarithmic": np.geomspace}


def read_sweep_study(path: Path) -> tuple[Scene, Axes, str | None]:
    """Read a sweep: a scene as `read_scene` reads it, and a table `[axes]`.

    An axis is a list of numbers, or a range `{from = 1, to = 4, count = 7}` that holds
    both ends, with `spacing = "logarithmic"` if wanted; `shape` is a list of names of
    shapes. A table of axes inside it, `[axes.ground]`, holds quantities that vary
    together, and `name` for labels. What varies has no value in the scene.

    Returns base, axes, and the name of the accuracy, None where the file has none.
    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    top, content = Key(path), load_toml(path)
    base, accuracy = scene_from(path, content, ("axes",))
    key = top["axes"]
    if "axes" not in content:
        raise key.error("is needed: which quantities vary, and over what")
    tables = _with_shapes(key, typed(top, content, "axes", dict))
    with top.located():
        columns = columns_of_axes(tables, base)
    axes = {n: _axis(key[n], n, value, columns) for n, value in tables.items()}
    _check_said_once(key, content, axes)
    with top.located():
        # A store need not fit into memory.
        grid = check_axes(axes, base, in_memory=False)
    _warn_of_unusual(key, grid, columns)
    return base, axes, accuracy


def _check_said_once(key: Key, content: dict, axes: Axes) -> None:
    """Raise InputError for a quantity that varies and has a value of the scene too,
    which would count for nothing."""
    places = dict.fromkeys(content, "before all tables")
    for part in PARTS:
        places |= dict.fromkeys(content.get(part, ()), f"in [{part}]")
    for name, of_axis in axes.items():
        for quantity in _quantities_of(name, of_axis):
            # The shape of the scene says which parameters it may give values to.
            if quantity in places and quantity != SHAPE:
                where = _key_of(key, name, quantity)
                raise where.error(f"stands {places[quantity]} too; remove one")


def _warn_of_unusual(
    key: Key, grid: list[_Axis], columns: Mapping[str, InputColumn]
) -> None:
    """Warn of the first unusual value of each quantity."""
    for axis in grid:
        for name, values in axis.values.items():
            if name == SHAPE:
                continue
            unusual = values[columns[name].is_unusual(values)]
            if unusual.size:
                where = _key_of(key, axis.name, name)
                read_quantity(where, columns[name], float(unusual[0]))


def _key_of(key: Key, axis: str, name: str) -> Key:
    """Return the key of a quantity that varies along an axis."""
    return key[axis] if axis == name else key[axis][name]


def _with_shapes(key: Key, axes: dict) -> dict:
    """Return the axes with classes in place of the names of shapes."""
    changed = {}
    for name, value in axes.items():
        where = key[name]
        if name == SHAPE and isinstance(value, list):
            texts = [of_kind(where, text, str) for text in value]
            with where.located():
                changed[name] = [shape_named(x, key.file.parent) for x in texts]
        else:
            inner = isinstance(value, dict)
            changed[name] = _with_shapes(where, value) if inner else value
    return changed


def _axis(key: Key, name: str, value, columns):
    if name in columns or name == SHAPE:
        return _values(key, name, value)
    if not isinstance(value, dict) or set(value) <= set(RANGE_KEYS):
        raise key.error(f"is unknown; {why_unknown_axis(name, columns)}")
    return {
        quantity: _values(key[quantity], quantity, values)
        for quantity, values in value.items()
    }


def _values(key: Key, name: str, value):
    """Return a list of numbers, labels or shapes, or the values of a range."""
    if isinstance(value, list):
        is_text = name in (LABELS, SHAPE)
        return value if is_text else [number(key, one) for one in value]
    if not isinstance(value, dict):
        raise key.error(
            "must be a list of numbers, or a range {from, to, count}, but is "
            f"{value!r}"
        )
    check_keys(key, value, RANGE_KEYS)
    for name in ("from", "to", "count"):
        if name not in value:
            raise key.error(f"needs {name}")
    ends = [number(key[end], value[end]) for end in ("from", "to")]
    count = whole(key, value, "count", 1, 1)
    if count == 1 and ends[0] != ends[1]:
        raise key["count"].error(
            f"must be at least 2 for a range that holds both ends, {ends[0]:g} and "
            f"{ends[1]:g}, but is 1"
        )
    check_memory(count, f"{count} values", **key["count"].place)
    spacing = choice(key, value, "spacing", "linear", tuple(SPACINGS))
    if spacing == "logarithmic" and min(ends) <= 0.0:
        raise key.error(
            f"must run between positive numbers to be logarithmic, but runs from "
            f"{ends[0]:g} to {ends[1]:g}"
        )
    return SPACINGS[spacing](*ends, count)

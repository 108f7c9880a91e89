"""Impacts over datasets and grids: at once, or lazily, block by block."""

import functools
import json
import math
import warnings
from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import jax
import numpy as np
import xarray as xr

from .._checks import expect
from .._packages import needed
from .._precision import require_float64
from ..accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ..batch import compute_part, summary_of
from ..errors import InputError
from ..io.checks import check_memory, check_scene, check_units
from ..io.datasets import (
    OUTCOMES,
    OUTPUT_COLUMNS,
    attributes_of,
    impact_attributes,
    shapes_attribute,
)
from ..io.result_table import count_words, outcomes_in_words
from ..quantities import (
    LABEL_COLUMNS,
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    columns_of,
    why_unknown,
)
from ..scene import Scene, SceneLike, as_scene
from ..scene_quantities import (
    SHAPE,
    scene_values,
    scene_with,
    shape_named,
    with_shapes,
)
from ..shapes import AbstractShape
from ..tasks import Task
from ..units import variable_attributes

BLOCK_BYTES = 8 * 2**17
"""Bytes of one number of all impacts of a block where chunks are "auto": 131 072
impacts, some seconds of work of a core, which a scheduler can wait for and a worker may
lose. All numbers of them take 26 MB."""
Chunks = int | str | tuple | Mapping[str, Any]
"""Lengths of blocks: as `xarray.Dataset.chunk` and `dask.array` take them."""


def simulate_dataset(
    dataset: xr.Dataset,
    base: SceneLike | None = None,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
) -> xr.Dataset:
    """Simulate the impacts of a dataset.

    Args:
        dataset: quantities of scenes as variables or coordinates, under their names in
            the tables and in the units of these names, along any dimensions; every
            combination along different dimensions is an impact. `shape` holds names of
            shapes. Coordinates that are no quantities are carried along. Arrays are
            NumPy's or in chunks.
        base: scene of what the dataset does not hold, scalars only; the defaults if not
            given.
        accuracy: as for `simulate_batch`.

    Returns:
        The dataset with a variable for each number of an impact, and `outcome` in
        words; all numbers have units. Where a quantity is in chunks the results are
        too, block by block: nothing is computed until it is asked for, then by whatever
        scheduler or client of Dask there is, one thread a block. Else they are computed
        at once, on all cores. Numbers are the same to the last bit, whatever the
        chunks.

        Attributes say base, accuracy, laws and versions; `outcomes`, the counts, only
        where they were computed. An impact that cannot be integrated is NaN with the
        outcome `failed`.

    Raises:
        InputError: an unknown quantity, with what may have been meant; an attribute
            `units` that is another unit than that of the name; a value out of its
            range, which of lazy arrays is known only as they are computed; a base that
            is no single scene.
    """
    require_float64()
    expect("dataset", dataset, xr.Dataset)
    scene = Scene() if base is None else as_scene(base)
    check_scene(scene)
    arrays, kinds = _quantities(dataset, scene)
    setting = get_accuracy(accuracy)
    varied = {dim for array in arrays.values() for dim in array.dims}
    dimensions = tuple(dim for dim in dataset.sizes if dim in varied)
    variables = _result_variables(scene, arrays, kinds, setting, dimensions)
    attributes = impact_attributes(scene, setting, scene_values(scene))
    attributes |= shapes_attribute(kinds)
    outcomes = variables[OUTCOME_COLUMN]
    if outcomes.chunks is None:
        attributes[OUTCOMES] = json.dumps(count_words(outcomes.values))
    result = dataset.assign(variables).assign_attrs(attributes)
    for name, quantity in arrays.items():
        result[name].attrs.update(quantity.attrs)
    return result


def lazy_grid(
    base: Scene,
    axes: Mapping[str, Mapping[str, np.ndarray]],
    coordinates: Mapping[str, Any],
    accuracy: Accuracy,
    chunks: Chunks,
) -> xr.Dataset:
    """Return the dataset of a sweep whose variables are computed when they are asked
    for.

    Args:
        axes: dimension -> quantities that vary along it, checked, in the units of their
            columns; of the shape, classes.
        chunks: a length for all dimensions, `"auto"`, or lengths by dimension.

    Raises InputError for chunks that do not fit or are too many, and where Dask is not
    installed.
    """
    along = {
        name: (dimension, values)
        for dimension, quantities in axes.items()
        for name, values in quantities.items()
    }
    kinds = [*along[SHAPE][1]] if SHAPE in along else []
    different = tuple(dict.fromkeys(kinds))
    # Of unusual values it warns where the sweep is asked for, not where it is computed.
    values = {name: values for name, (_, values) in along.items() if name != SHAPE}
    scene = with_shapes(base, kinds) if kinds else base
    check_scene(scene_with(scene, values), batched=True, warn=True, of="entry")
    sizes = {name: len(next(iter(of.values()))) for name, of in axes.items()}
    lengths = _lengths(sizes, chunks)
    blocks = math.prod(map(len, lengths.values()))
    check_memory(
        256 * blocks,  # the least memory that Dask needs for their tasks
        f"tasks for {blocks} blocks (larger chunks make fewer)",
    )
    arrays = {}
    for name, (dimension, values) in along.items():
        if name == SHAPE:
            values = np.array([different.index(kind) for kind in values])
        variable = xr.Variable((dimension,), values)
        arrays[name] = variable.chunk({dimension: lengths[dimension]})
    variables = _result_variables(base, arrays, different, accuracy, tuple(axes))
    attributes = impact_attributes(base, accuracy, scene_values(base))
    return xr.Dataset(variables, coordinates, attributes | shapes_attribute(different))


def _lengths(sizes: Mapping[str, int], chunks: Chunks) -> dict[str, tuple[int, ...]]:
    core = needed("dask.array.core", "a sweep in chunks")
    asked: Any = chunks
    if isinstance(chunks, Mapping):
        for name in chunks:
            if name not in sizes:
                raise InputError(
                    f"chunks must name axes ({', '.join(sizes)}), but holds {name!r}"
                )
        asked = tuple(chunks.get(name, -1) for name in sizes)
    shape = tuple(sizes.values())
    try:
        lengths = core.normalize_chunks(asked, shape, limit=BLOCK_BYTES, dtype=float)
        if any(length < 0 for blocks in lengths for length in blocks):
            raise ValueError("a length is negative")  # which Dask takes
    except (ValueError, TypeError, NotImplementedError, ZeroDivisionError) as error:
        raise InputError(
            f"chunks must be lengths that add up to the axes "
            f"({', '.join(f'{n} {k}' for n, k in sizes.items())}), but is {chunks!r}: "
            f"{error}"
        ) from error
    # For one axis Dask takes a tuple of all its lengths too.
    by_axis = isinstance(asked, tuple | list) and len(asked) == len(sizes)
    each = asked if by_axis else [asked] * len(sizes)
    # Blocks that Dask chose are made equal: a short last one leaves a worker waiting.
    equal = tuple(
        -(-size // len(blocks)) if isinstance(of_axis, str) else blocks
        for size, blocks, of_axis in zip(shape, lengths, each, strict=True)
    )
    return dict(zip(sizes, core.normalize_chunks(equal, shape), strict=True))


def _quantities(
    dataset: xr.Dataset, base: Scene
) -> tuple[dict[str, xr.Variable], tuple[type[AbstractShape], ...]]:
    """Return the quantities of a dataset, and the shapes that its index of shapes
    means."""
    kinds: tuple[type[AbstractShape], ...] = ()
    quantities: dict[str, xr.Variable] = {}
    if SHAPE in dataset.variables:
        shapes = dataset.variables[SHAPE]
        names, index = np.unique(np.asarray(shapes.values, str), return_inverse=True)
        kinds = tuple(shape_named(str(name)) for name in names)
        quantities[SHAPE] = xr.Variable(shapes.dims, index.reshape(shapes.shape))
        base = with_shapes(base, kinds)
    columns = columns_of(base)
    for name, variable in dataset.variables.items():
        if name in (*OUTPUT_COLUMNS, OUTCOME_COLUMN):
            raise InputError(
                f"{name} is a result, which the dataset must not hold already"
            )
        if name in columns:
            if variable.dtype.kind not in "iuf":
                raise InputError(
                    f"{name} must hold numbers, but holds {variable.dtype}"
                )
            column, quantity = columns[str(name)], variable.to_base_variable()
            check_units(column.name, column, quantity)
            quantity.attrs["units"] = column.unit
            quantities[column.name] = quantity
        elif name not in (SHAPE, *LABEL_COLUMNS) and name not in dataset.coords:
            raise InputError(f"{name} is unknown; {why_unknown(str(name), columns)}")
    if not quantities:
        raise InputError(
            "the dataset holds no quantity of a scene; name one as the tables do, such "
            "as angle_deg"
        )
    return quantities, kinds


def _result_variables(
    base: Scene,
    arrays: Mapping[str, xr.Variable],
    kinds: Sequence[type[AbstractShape]],
    accuracy: Accuracy,
    dimensions: Sequence[Hashable],
) -> dict[str, xr.Variable]:
    """Return the numbers and outcomes of impacts, lazily if an array is.

    Args:
        arrays: quantities in the units of their columns; the shape is an index among
            `kinds`. What they do not hold is that of `base`.
        dimensions: order of the dimensions of the results.
    """
    lazy = any(array.chunks is not None for array in arrays.values())
    # Errors count an impact within its block.
    called = "impact of a block, number" if lazy else "scene"
    common = jax.tree.map(np.asarray, base), (*arrays,), tuple(kinds), accuracy, called
    names = *OUTPUT_COLUMNS, OUTCOME_COLUMN
    with warnings.catch_warnings():
        # A grid has many times the blocks of any of its axes: no mistake.
        warnings.filterwarnings("ignore", "Increasing number of chunks")
        results = xr.apply_ufunc(
            (Task if lazy else functools.partial)(_impact_numbers, *common),
            *arrays.values(),
            dask="parallelized",
            output_core_dims=[[] for _ in names],
            output_dtypes=[*[float] * len(OUTPUT_COLUMNS), outcomes_in_words([]).dtype],
        )
    variables = {
        name: variable.transpose(*dimensions)
        for name, variable in zip(names, results, strict=True)
    }
    for name, column in OUTPUT_COLUMNS.items():
        variables[name].attrs = attributes_of(column)
    variables[OUTCOME_COLUMN].attrs = variable_attributes(OUTCOME_MEANING)
    return variables


def needs_impacts(array: Any) -> bool:
    """Tell whether impacts are computed for an array of Dask, which calls what it has
    to do after the functions."""
    name = _impact_numbers.__name__.strip("_")
    return any(step.startswith(f"{name}-") for step in array.dask.layers)


def _impact_numbers(
    base: Scene,
    names: Sequence[str],
    kinds: Sequence[type[AbstractShape]],
    accuracy: Accuracy,
    called: str,
    *values: np.ndarray,
) -> tuple[np.ndarray, ...]:
    """Return the numbers of the impacts of a block, one array for each column of
    results, and their outcomes in words.

    Args:
        names: of the values; that of the shape is an index among `kinds`.
        called: what errors call an impact.
        values: the block's quantities, of shapes that broadcast to that of the results.
    """
    shape = np.broadcast_shapes(*map(np.shape, values))
    count = math.prod(shape)
    if count == 0:
        empty = np.empty(shape)
        return *[empty] * len(OUTPUT_COLUMNS), outcomes_in_words(empty)
    flat = {
        name: np.broadcast_to(of_name, shape).ravel()
        for name, of_name in zip(names, values, strict=True)
    }
    index = flat.pop(SHAPE, None)
    if index is not None:
        base = with_shapes(base, [kinds[place] for place in index.tolist()])
    scene = scene_with(base, flat)
    # The laws were checked by who sent them.
    check_scene(scene, batched=True, of=called, laws=False)
    scene = jax.tree.map(np.asarray, scene)
    summary = summary_of(compute_part(scene, count, accuracy))
    numbers = [getattr(summary, column.field) for column in OUTPUT_COLUMNS.values()]
    words = outcomes_in_words(summary.outcome_code)
    return tuple(of_column.reshape(shape) for of_column in (*numbers, words))

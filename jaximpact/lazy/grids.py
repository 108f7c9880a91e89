"""Lazy sweeps: grids of impacts whose points are computed block by block."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from .._packages import needed
from ..accuracy import Accuracy
from ..errors import InputError
from ..io.checks import check_memory, check_scene
from ..io.datasets import impact_attributes, shapes_attribute
from ..scene import Scene
from ..scene_quantities import SHAPE, scene_values, scene_with, with_shapes
from .impacts import result_variables

BLOCK_BYTES = 8 * 2**17
"""Bytes of one number of all impacts of a block where chunks are "auto": 131 072
impacts, some seconds of work of a core, which a scheduler can wait for and a worker may
lose. All numbers of them take 26 MB."""
NUMBERS_PER_BLOCK = 256
"""Least memory that Dask needs for a block's tasks, in numbers of eight bytes."""
Chunks = int | str | tuple | Mapping[str, Any]
"""Lengths of blocks: as `xarray.Dataset.chunk` and `dask.array` take them."""


def lazy_grid(
    base: Scene,
    axes: Mapping[str, Mapping[str, np.ndarray]],
    coordinates: Mapping[str, Any],
    accuracy: Accuracy,
    model_tolerance: float,
    chunks: Chunks,
) -> xr.Dataset:
    """Return the dataset of a sweep whose variables are computed when they are asked
    for.

    Args:
        base: a single scene, checked.
        axes: dimension -> quantities that vary along it, checked, in the units of their
            columns; of the shape, classes.
        coordinates: of the dataset.
        chunks: a length for all dimensions, `"auto"`, or lengths by dimension.

    Raises InputError for chunks that do not fit or are too many, and where Dask is not
    installed.
    """
    kinds = [kind for axis in axes.values() for kind in axis.get(SHAPE, ())]
    different = tuple(dict.fromkeys(kinds))
    along = {
        name: (dimension, values)
        for dimension, quantities in axes.items()
        for name, values in quantities.items()
    }
    _warn_of_unusual(base, kinds, along)
    sizes = {name: len(next(iter(of.values()))) for name, of in axes.items()}
    lengths = _lengths(sizes, chunks)
    blocks = math.prod(map(len, lengths.values()))
    check_memory(
        blocks * NUMBERS_PER_BLOCK,
        f"tasks for {blocks} blocks (larger chunks make fewer)",
    )
    arrays = {}
    for name, (dimension, values) in along.items():
        if name == SHAPE:
            values = np.array([different.index(kind) for kind in values])
        variable = xr.Variable((dimension,), values)
        arrays[name] = variable.chunk({dimension: lengths[dimension]})
    variables = result_variables(
        base, arrays, different, accuracy, model_tolerance, tuple(axes)
    )
    attributes = impact_attributes(base, accuracy, model_tolerance, scene_values(base))
    attributes |= shapes_attribute(different)
    return xr.Dataset(variables, coordinates, attributes)


def _warn_of_unusual(base: Scene, kinds: list, along: Mapping) -> None:
    """Warn of unusual values where the sweep is asked for, not where it is computed."""
    scene = with_shapes(base, kinds) if kinds else base
    values = {name: values for name, (_, values) in along.items() if name != SHAPE}
    check_scene(scene_with(scene, values), batched=True, warn=True, of="entry")


def _lengths(sizes: Mapping[str, int], chunks: Chunks) -> dict[str, tuple[int, ...]]:
    """Lengths of the blocks along each dimension."""
    core = needed("dask.array.core", "a sweep in chunks")
    given: Any = chunks
    if isinstance(chunks, Mapping):
        for name in chunks:
            if name not in sizes:
                raise InputError(
                    f"chunks must name axes ({', '.join(sizes)}), but holds {name!r}"
                )
        given = tuple(chunks.get(name, -1) for name in sizes)
    try:
        found = core.normalize_chunks(
            given, tuple(sizes.values()), limit=BLOCK_BYTES, dtype=float
        )
    except (ValueError, TypeError, NotImplementedError) as error:
        raise InputError(
            f"chunks must be lengths that add up to the axes "
            f"({', '.join(f'{n} {k}' for n, k in sizes.items())}), but is {chunks!r}: "
            f"{error}"
        ) from error
    return dict(zip(sizes, found, strict=True))

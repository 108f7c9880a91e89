"""Impacts as data frames and datasets, with units and provenance; datasets in files."""

import dataclasses
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import jax
import numpy as np
import pandas as pd
import xarray as xr

from .._packages import versions
from .._settings import numpy_settings
from ..accuracy import Accuracy
from ..errors import InputError
from ..identity import name_of, part_names
from ..impact.results import (
    SCENE_DIMENSION,
    History,
    ImpactSummary,
    dimension_names,
)
from ..parameters import declared_of
from ..quantities import (
    ENERGY_COLUMNS,
    FURTHER_COLUMNS,
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    RESULT_COLUMNS,
    InputColumn,
    ResultColumn,
    columns_of,
)
from ..scene import Scene, Selection
from ..scene_quantities import SHAPE, scene_values, text_of, unusual_parts, value_of
from ..shapes import AbstractShape, MixedShapes
from ..units import variable_attributes
from .files import read_input, replacing
from .result_table import count_outcomes, outcomes_in_words

OUTPUT_COLUMNS = RESULT_COLUMNS | FURTHER_COLUMNS
"""The numbers that a dataset holds."""
SHAPES = "shapes"
"""Attribute of a dataset over shapes: label -> the name by which each is found, and
what it was."""
OUTCOMES = "outcomes"
"""Attribute of a dataset: words of outcomes -> how many impacts ended so."""
NETCDF_ENGINE = "scipy"
"""NetCDF 3 with 64-bit offsets, which every program reads and JAX's own dependencies
write."""
NETCDF_MAGIC = b"CDF"
"""First bytes of such a file."""


class Input(NamedTuple):
    """A quantity of many scenes."""

    column: InputColumn
    values: np.ndarray
    """One value for each scene, in the unit of the column."""
    axes: tuple[int, ...]
    """The axes of the scenes along which the values differ."""
    kinds: tuple[type[AbstractShape], ...]
    """Shapes that have it as a parameter, where others of the scenes' have not."""


def inputs_of(scene: Scene, shape: tuple[int, ...]) -> dict[str, Input]:
    """Return every quantity of scenes whose fields broadcast to a shape, by its
    column."""
    inputs = {}
    mixed = scene.block.shape
    for name, column in columns_of(scene).items():
        values = np.broadcast_to(value_of(scene, column), shape)
        kinds = ()
        if isinstance(mixed, MixedShapes) and column.part == "block":
            kinds = tuple(k for k in mixed.kinds if column.field in declared_of(k))
            kinds = kinds if len(kinds) < len(mixed.kinds) else ()
        inputs[name] = Input(column, values, varying_axes(values), kinds)
    return inputs


def varying_axes(values: np.ndarray) -> tuple[int, ...]:
    """Find the axes along which values are not all the same."""
    return tuple(
        axis
        for axis in range(values.ndim)
        if values.size and np.any(values != values.take([0], axis))
    )


def kind_of_each(scene: Scene, shape: tuple[int, ...]) -> np.ndarray | None:
    """Return the class of each scene's shape; None where there is one class for all."""
    mixed = scene.block.shape
    if not isinstance(mixed, MixedShapes):
        return None
    kinds = np.empty(len(mixed.kinds), object)
    kinds[:] = mixed.kinds
    return kinds[np.broadcast_to(np.asarray(mixed.index, int), shape)]


def frame_of(summary: ImpactSummary, scene: Scene, all_inputs: bool) -> pd.DataFrame:
    """Make the data frame that `ImpactResult.to_dataframe` gives: one row an impact,
    under the names of the tables."""
    shape = np.shape(summary.outcome_code)
    columns: dict[str, object] = {}
    kinds = kind_of_each(scene, shape)
    if all_inputs:
        columns |= unusual_parts(scene)
    if kinds is not None and (all_inputs or varying_axes(kinds)):
        columns[SHAPE] = [text_of(kind) for kind in kinds.flat]
    for name, (_, values, axes, of_kinds) in inputs_of(scene, shape).items():
        if not axes and not all_inputs:
            continue
        columns[name] = values.ravel()
        if kinds is not None and of_kinds:
            has = [kind in of_kinds for kind in kinds.flat]
            columns[name] = np.where(has, values.ravel(), np.nan)
    for name, column in RESULT_COLUMNS.items():
        columns[name] = np.ravel(np.asarray(getattr(summary, column.field)))
    columns[OUTCOME_COLUMN] = np.ravel(outcomes_in_words(summary.outcome_code))
    if len(shape) > 1:
        names = dimension_names(len(shape))
        rows = pd.MultiIndex.from_product([range(n) for n in shape], names=names)
    else:
        rows = pd.RangeIndex(*(shape or (1,)), name=SCENE_DIMENSION)
    return pd.DataFrame(columns, index=rows)


def dataset_of_impacts(
    summary: ImpactSummary,
    scene: Scene,
    accuracy: Accuracy,
    dims: Sequence[str] | None = None,
) -> xr.Dataset:
    """Make the dataset that `ImpactResult.to_xarray` gives."""
    shape = np.shape(summary.outcome_code)
    dimensions = dimension_names(len(shape)) if dims is None else dims
    _check_dimensions(dimensions, shape)
    if 0 in shape:
        raise InputError(
            f"a dataset needs at least one impact, but the result has shape {shape}"
        )
    kinds = kind_of_each(scene, shape)
    coordinates = scene_coordinates(scene, shape, dimensions)
    for name in dimensions:
        if name in coordinates and coordinates[name][0] != (name,):
            raise InputError(
                f"{name} cannot be the name of a dimension, as it varies along "
                f"{' and '.join(coordinates[name][0])}"
            )
    different = []
    if kinds is not None and SHAPE in coordinates:
        different = sorted(set(kinds.flat), key=text_of)
    base = Selection(shape, (0,) * len(shape), scene).of_scene(scene)
    # The shape stays: it is that of the laws, whichever the coordinate names.
    values = {
        name: value
        for name, value in scene_values(base).items()
        if name == SHAPE or name not in coordinates
    }
    return dataset_of(
        summary, accuracy, dimensions, shape, coordinates, base, values, different
    )


def dataset_of(
    summary: ImpactSummary,
    accuracy: Accuracy,
    dimensions: Sequence[str],
    shape: tuple[int, ...],
    coordinates: Mapping,
    base: Scene,
    values: Mapping,
    kinds: Iterable[type[AbstractShape]] = (),
) -> xr.Dataset:
    """Make a dataset of the numbers of impacts with units, outcome and provenance.

    Args:
        summary: one impact, or as many as `shape` holds, with histories over `time` if
            it has them at times common to all.
        dimensions: their names. shape: their lengths.
        base: laws and shape. values: its quantities, as `scene_values` gives them.
        kinds: classes of shapes, where they vary.
    """
    columns = {name: (summary, column) for name, column in OUTPUT_COLUMNS.items()}
    if summary.energy is not None:
        columns |= {name: (summary.energy, c) for name, c in ENERGY_COLUMNS.items()}
    variables = {}
    for name, (holder, column) in columns.items():
        numbers = np.asarray(getattr(holder, column.field)).reshape(shape)
        variables[name] = dimensions, numbers, attributes_of(column)
    variables[OUTCOME_COLUMN] = (
        dimensions,
        outcomes_in_words(summary.outcome_code).reshape(shape),
        variable_attributes(OUTCOME_MEANING),
    )
    coordinates = dict(coordinates)
    history = getattr(summary, "history", None)
    if history is not None and _has_one_time_base(history):
        history = jax.tree.map(
            lambda series: np.reshape(series, (*shape, np.shape(series)[-1])), history
        )
        series = history.to_xarray(dimensions)
        variables |= series.data_vars
        coordinates |= series.coords
    attributes = {
        **impact_attributes(base, accuracy, values),
        OUTCOMES: json.dumps(count_outcomes(summary)),
        **shapes_attribute(kinds),
    }
    return xr.Dataset(variables, coordinates, attributes)


def _has_one_time_base(history: History) -> bool:
    """Tell whether all impacts have the times that were asked for with `save_at`."""
    time = np.asarray(history.time)
    first = time[(0,) * (time.ndim - 1)]
    return history.in_contact is not None and bool(np.all(time == first))


def impact_attributes(
    base: Scene, accuracy: Accuracy, values: Mapping
) -> dict[str, Any]:
    """Title and provenance of a dataset of impacts."""
    title = "jaximpact: impacts of rock blocks on deformable ground"
    return {"title": title, **provenance(base, accuracy, values)}


def shapes_attribute(kinds: Iterable[type[AbstractShape]]) -> dict[str, str]:
    """Describe the labels of shapes, as an attribute; none without shapes."""
    shapes = {_label_of(kind, kinds): [text_of(kind), name_of(kind)] for kind in kinds}
    return {SHAPES: json.dumps(shapes)} if shapes else {}


def provenance(
    base: Scene, accuracy: Accuracy, values: Mapping | None = None, **settings
) -> dict[str, Any]:
    """Scene, settings, laws and versions, as attributes of a dataset.

    Args:
        values: of the scene, in place of all that `scene_values` gives.
        settings: others than the accuracy.
    """
    return {
        "base": json.dumps(scene_values(base) if values is None else values),
        "accuracy": json.dumps(dataclasses.asdict(accuracy)),
        **settings,
        "laws": json.dumps(part_names(base.soil, base.block)),
        "versions": json.dumps(versions()),
    }


def attributes_of(column: InputColumn | ResultColumn) -> dict[str, str]:
    """Unit and meaning of a quantity, as attributes of a variable."""
    return variable_attributes(column.meaning, column.unit)


def _label_of(kind: type[AbstractShape], kinds: Iterable[type[AbstractShape]]) -> str:
    """Return the label of a shape among others: its class's name, if that says
    which."""
    same = {other for other in kinds if other.__name__ == kind.__name__}
    return kind.__name__ if len(same) == 1 else text_of(kind)


def shape_coordinate(dimensions, kinds: np.ndarray) -> tuple:
    """Return the classes of shapes as a coordinate of a dataset."""
    different = set(kinds.flat)
    labels = {kind: _label_of(kind, different) for kind in different}
    values = np.array([labels[kind] for kind in kinds.flat]).reshape(kinds.shape)
    return dimensions, values, {"long_name": SHAPE}


def scene_coordinates(
    scene: Scene, shape: tuple[int, ...], dimensions: Sequence[str]
) -> dict[str, tuple]:
    """Coordinates of many scenes: the quantities that vary, along the dimensions along
    which they do.

    A quantity after which a dimension is named is a coordinate even if it is the same
    everywhere; so is, beside shapes, what only some of them have as a parameter.
    """
    coordinates = {}

    def along(axes: tuple[int, ...], values: np.ndarray) -> tuple:
        names = tuple(dimensions[axis] for axis in axes)
        first = (slice(None) if k in axes else 0 for k in range(values.ndim))
        return names, values[tuple(first)]

    kinds = kind_of_each(scene, shape)
    of_shape = () if kinds is None else varying_axes(kinds)
    if kinds is not None and of_shape:
        coordinates[SHAPE] = shape_coordinate(*along(of_shape, kinds))
    for name, (column, values, axes, of_kinds) in inputs_of(scene, shape).items():
        if not axes and name in dimensions:
            axes = (list(dimensions).index(name),)
        if not axes and of_kinds:
            axes = of_shape
        if axes:
            coordinates[name] = (*along(axes, values), attributes_of(column))
    return coordinates


def _check_dimensions(dimensions: Sequence[str], shape: tuple[int, ...]) -> None:
    texts = isinstance(dimensions, Sequence) and not isinstance(dimensions, str)
    if not texts or not all(isinstance(name, str) for name in dimensions):
        raise InputError(f"dims must be a tuple of names, but is {dimensions!r}")
    if len(set(dimensions)) != len(dimensions) or len(dimensions) != len(shape):
        raise InputError(
            f"dims must be {len(shape)} different names, one for each axis of the "
            f"shape {shape}, but is {dimensions!r}"
        )
    results = {*OUTPUT_COLUMNS, *ENERGY_COLUMNS, OUTCOME_COLUMN}
    for name in dimensions:
        if name in results:
            raise InputError(
                f"{name} cannot be the name of a dimension, as it is that of a result"
            )


@numpy_settings()
def write_netcdf(path: Path, dataset: xr.Dataset) -> None:
    """Write a dataset to a NetCDF file.

    The file appears whole or not at all; one of the same name is replaced.

    Raises OSError where the file system refuses, and InputError for what NetCDF 3 does
    not hold.
    """
    with replacing(Path(path)) as temporary:
        try:
            written = _with_names(dataset, _as_bytes_of_utf8)
            written.to_netcdf(temporary, engine=NETCDF_ENGINE)
        except (TypeError, ValueError) as error:
            raise InputError(
                f"the dataset cannot be written as NetCDF 3: {error}", file=path
            ) from error


@numpy_settings()
def read_netcdf(path: Path) -> xr.Dataset:
    """Read a dataset that `write_netcdf` wrote, whole into memory.

    Raises InputError if the file cannot be read or is no such file.
    """
    path = Path(path)
    start = read_input(path, once=False)[: len(NETCDF_MAGIC)]
    try:
        dataset = xr.load_dataset(path, engine=NETCDF_ENGINE)
        return _with_names(dataset, _from_bytes_of_utf8)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"cannot be read: {why}", file=path) from error
    except Exception as error:  # SciPy raises whatever the bytes lead it to
        # What it says of other files is of libraries to install.
        damaged = start == NETCDF_MAGIC
        why = "is a damaged NetCDF 3 file" if damaged else "is not a NetCDF 3 file"
        raise InputError(why, file=path) from error


def _with_names(dataset: xr.Dataset, recode: Callable[[str], str]) -> xr.Dataset:
    names = {name: recode(str(name)) for name in (*dataset.dims, *dataset.variables)}
    renamed = dataset.rename({old: new for old, new in names.items() if old != new})
    for holder in (renamed, *renamed.variables.values()):
        holder.attrs = {recode(str(key)): value for key, value in holder.attrs.items()}
    return renamed


def _as_bytes_of_utf8(name: str) -> str:
    """Write each byte of a name's UTF-8, which NetCDF asks for, as a character: SciPy
    writes names in Latin-1, and fails for others."""
    return name.encode().decode("latin-1")


def _from_bytes_of_utf8(name: str) -> str:
    try:
        return name.encode("latin-1").decode()
    except UnicodeError:  # of another program
        return name

"""Stores of Zarr that are written region by region, and taken up where they stopped.

The store is there first, with its coordinates and attributes, which are the manifest.
Whichever process computes a block writes it to its region and then marks the region, in
the group `_regions` of the same store. So nothing passes through the process that asks,
and what is marked is whole. Zarr replaces files of a directory in one move.
"""

import json
import math
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .._checks import expect
from .._numpy_settings import numpy_settings
from .._packages import needed
from ..errors import IncompleteError, InputError
from ..impact.events import Outcome
from ..interruption import remove, remove_for_good, unfinished
from ..io.datasets import OUTCOMES
from ..io.files import check_writable, locked, naming
from ..progress import Progress, ProgressFunction, as_progress
from ..quantities import OUTCOME_COLUMN
from .regions import compute_regions

FORMAT = 2
"""Format of the stores: the one in which texts of a fixed length are specified."""
MARKS = "_regions"
"""Group of the marks: for each region how many impacts ended in which way, or -1."""


class WrittenRegions(NamedTuple):
    """Regions of a store that was written."""

    total: int
    found: int
    """Regions that were there before."""
    computed: int
    """Regions that this call computed."""


class _Layout(NamedTuple):
    """Regions of a dataset."""

    dims: tuple[str, ...]
    """Dimensions that have several chunks."""
    lengths: tuple[tuple[int, ...], ...]
    """Lengths of the regions along each of them."""
    names: tuple[str, ...]
    """Variables over all of these dimensions, which are written by region."""

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(map(len, self.lengths))

    def regions(self) -> np.ndarray:
        """Return number, first index and end of each region, as an array of the
        regions' shape: a block is given its own, whatever the number of all."""
        rank = len(self.dims)
        kind = [("number", int), ("start", int, (rank,)), ("stop", int, (rank,))]
        found = np.empty(self.shape, kind)
        found["number"] = np.arange(found.size).reshape(self.shape)
        for axis, lengths in enumerate(self.lengths):
            along = [1] * rank
            along[axis] = -1
            stops = np.cumsum(lengths)
            found["stop"][..., axis] = stops.reshape(along)
            found["start"][..., axis] = (stops - lengths).reshape(along)
        return found

    def chunks(self, variable: xr.DataArray) -> tuple[int, ...]:
        """Lengths of the chunks of a variable in the store: those of its regions."""
        lengths = dict(zip(self.dims, self.lengths, strict=True))
        return tuple(
            max(1, *lengths.get(str(dim), (size,)))
            for dim, size in zip(variable.dims, variable.shape, strict=True)
        )


@numpy_settings()
def write_zarr(
    path: Path | str,
    dataset: xr.Dataset,
    *,
    progress: Progress | ProgressFunction | None = None,
) -> WrittenRegions:
    """Write a dataset to a directory of Zarr, each block to its region.

    Blocks that are lazy are computed by whatever scheduler or client of Dask there is,
    and written there: workers must see the directory. A store that an earlier call
    began is taken up: what is marked as whole in it is not computed again. Where
    workers die Dask computes their blocks elsewhere; where none are left it waits for
    others, with a NoWorkersWarning after some seconds.

    Args:
        path: the directory; made if need be.
        dataset: from `sweep` or `simulate_dataset`, or another whose largest variables
            have the same dimensions and chunks; these are written by region, all others
            at the beginning.
        progress: called as `progress(done, regions)`; the first call tells what was
            there.

    Returns:
        How many regions there are, were found, and were computed.

    Raises:
        InputError: a store of something else, or computed with other settings, laws or
            versions; chunks of unequal lengths; Dask or Zarr that are not installed.
        IncompleteError: workers were lost for good; the same call goes on from there.
        BlockingIOError: another process on this machine writes the store.
    """
    for package in ("dask", "zarr"):
        needed(package, "a store of Zarr")
    expect("dataset", dataset, xr.Dataset)
    path, told = Path(os.path.abspath(path)), as_progress(progress)
    dataset = dataset.unify_chunks()
    layout = _layout_of(dataset)
    if os.path.lexists(path) and not path.is_dir():
        raise InputError(
            "is there, and is no store that was written by region; move it, or choose "
            "another name",
            file=path,
        )
    check_writable(path / "x" if path.is_dir() else path, option="the store")
    with locked(path, beside=True):
        if path.exists():
            _check_same(path, dataset, layout)
        else:
            _begin(path, dataset, layout)
        with unfinished(path, _remove_partial):
            _remove_partial(path)
            marks = _read_marks(path)
            missing = np.flatnonzero(marks[:, 0] < 0)
            found = len(marks) - len(missing)
            told("regions", found, len(marks))
            if len(missing):
                _compute(path, dataset, layout, missing, told, found)
            _finish(path, dataset)
    return WrittenRegions(len(marks), found, len(missing))


def _remove_partial(path: os.PathLike) -> bool:
    """Remove what Zarr has not written whole to a store; tell whether there was any."""
    files = [*Path(path).rglob("*.partial")]
    return any([remove(file) for file in files])


def _layout_of(dataset: xr.Dataset) -> _Layout:
    """Find the regions; InputError where chunks do not make any."""
    several = {dim: of for dim, of in dataset.chunksizes.items() if len(of) > 1}
    for dim, parts in several.items():
        sizes = [length for length in parts if length]
        if len({*sizes[:-1]}) > 1 or (sizes and sizes[-1] > sizes[0]):
            raise InputError(
                f"chunks along {dim} must have one length, but for a last one that may "
                f"be shorter, but have lengths {parts[:8]}; use dataset.chunk"
            )
    dims = tuple(str(dim) for dim in dataset.sizes if dim in several)
    names = [
        str(name)
        for name, variable in dataset.data_vars.items()
        if variable.chunks is not None and {*dims} <= {*variable.dims}
    ]
    if not names:
        raise InputError(
            "the dataset holds no lazy variable over all dimensions that have several "
            "chunks; use dataset.chunk, or to_zarr of xarray for what is computed"
        )
    return _Layout(dims, tuple(several[dim] for dim in dims), tuple(names))


def _begin(path: Path, dataset: xr.Dataset, layout: _Layout) -> None:
    """Make the store without its regions; it appears whole or not at all."""
    array = needed("dask.array", "a store of Zarr")
    zarr = needed("zarr", "a store of Zarr")
    template, encoding = dataset.drop_vars(layout.names).compute(), {}
    for name in layout.names:
        held = dataset[name]
        lengths = layout.chunks(held)
        empty = array.empty(held.shape, dtype=held.dtype, chunks=lengths)
        template[name] = (held.dims, empty, held.attrs)
        encoding[name] = {"chunks": lengths}
    for variable in template.variables.values():
        variable.encoding = {}
        if variable.chunks is None and variable.size:
            # xarray 2025.1 says None to Zarr 3.1 otherwise, which refuses it.
            variable.encoding["chunks"] = variable.shape
    new = path.with_name(f".{path.name}.{os.getpid()}.partial")
    remove(new)
    with unfinished(new), naming(path):
        try:
            template.to_zarr(
                new, encoding=encoding, compute=False, zarr_format=FORMAT, mode="w"
            )
            count = math.prod(layout.shape)
            marks = zarr.open_group(str(new), mode="r+", use_consolidated=False)
            marks.create_group(MARKS).create_array(
                "outcomes",
                shape=(count, len(Outcome)),
                chunks=(1, len(Outcome)),
                dtype="int64",
                fill_value=-1,
            )
            os.rename(new, path)
        except BaseException:
            remove_for_good(new)  # which Zarr's own thread may be writing still
            raise


def _check_same(path: Path, dataset: xr.Dataset, layout: _Layout) -> None:
    """Raise InputError unless a store was begun for the same dataset."""
    try:
        there = xr.open_zarr(path, chunks=None, consolidated=False, zarr_format=FORMAT)
        _read_marks(path)
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise InputError(
            f"is there, and is no store that was written by region: {error}; move it, "
            "or choose another name",
            file=path,
        ) from error
    stored = {k: v for k, v in there.attrs.items() if k != OUTCOMES}
    asked = {k: v for k, v in dataset.attrs.items() if k != OUTCOMES}
    for key in sorted({*stored, *asked}):
        # xarray takes what JSON gives back, such as a list for a tuple, as the same.
        held, wanted = (xr.Dataset(attrs={key: of.get(key)}) for of in (stored, asked))
        if not held.identical(wanted):
            raise InputError(
                f"was begun with {key} {stored.get(key)}, but is asked for with "
                f"{asked.get(key)}; move it, or choose another name",
                file=path,
            )
    for name in {*map(str, there.variables), *map(str, dataset.variables)}:
        if name in layout.names and name in there:
            held, asked_for = there[name], dataset[name]
            same = (held.sizes, held.dtype) == (asked_for.sizes, asked_for.dtype)
            same &= held.encoding["chunks"] == layout.chunks(asked_for)
        else:
            same = name in there.variables and name in dataset.variables
            same = same and there[name].variable.identical(
                dataset[name].variable.compute()
            )
        if not same:
            raise InputError(
                f"was begun with another {name}, or other chunks of it; move it, or "
                "choose another name",
                file=path,
            )


def _marks(path: Path, mode: str) -> Any:
    zarr = needed("zarr", "a store of Zarr")
    place = f"{path}/{MARKS}/outcomes"
    return zarr.open_array(place, mode=mode, zarr_format=FORMAT)


def _read_marks(path: Path) -> np.ndarray:
    """Return the counts of outcomes of each region; -1 for regions that are not
    there."""
    return np.asarray(_marks(path, "r")[:])


class _Writer:
    """Function that writes a block to its region, and marks it."""

    __name__ = "write_region"  # by which Dask shows it

    def __init__(self, path: Path, layout: _Layout, of_each: tuple[tuple, ...]):
        self.path, self.of_each = path, of_each
        self.dims, self.names = layout.dims, layout.names

    def __call__(self, place: np.ndarray, *values: np.ndarray) -> np.ndarray:
        number, start, stop = place.item()
        mark = self.path / MARKS / "outcomes" / f"{number}.0"
        # A region that a signal cuts short counts as missing.
        with unfinished(mark), naming(self.path):
            self._write(number, start, stop, values)
        return np.ones(place.shape, bool)

    def _write(self, number: int, start, stop, values: tuple[np.ndarray, ...]) -> None:
        region = {
            dim: slice(int(first), int(end))
            for dim, first, end in zip(self.dims, start, stop, strict=True)
        }
        counts = np.zeros(len(Outcome), int)
        if all(of.stop > of.start for of in region.values()):
            pairs = zip(self.of_each, values, strict=True)
            xr.Dataset(dict(zip(self.names, pairs, strict=True))).to_zarr(
                self.path,
                region=region,
                consolidated=False,
                zarr_format=FORMAT,
            )
            if OUTCOME_COLUMN in self.names:
                words = values[self.names.index(OUTCOME_COLUMN)]
                counts[:] = [np.sum(words == str(outcome)) for outcome in Outcome]
        _marks(self.path, "r+")[number] = counts


def _compute(
    path: Path,
    dataset: xr.Dataset,
    layout: _Layout,
    missing: np.ndarray,
    told: Progress,
    found: int,
) -> None:
    """Compute and write the regions that are missing."""
    array = needed("dask.array", "a store of Zarr")
    total, rank = math.prod(layout.shape), len(layout.dims)
    places = array.from_array(layout.regions(), chunks=1)
    operands: list = [places, layout.dims]
    dims = []
    for name in layout.names:
        ordered = dataset[name]
        if ordered.dims[:rank] != layout.dims:  # else it would cost a task a region
            ordered = ordered.transpose(*layout.dims, ...)
        # Other dimensions, which have one chunk, are taken whole.
        further = tuple(f"{name} {dim}" for dim in ordered.dims[rank:])
        operands += [ordered.data, (*layout.dims, *further)]
        dims.append(ordered.dims)
    written = array.blockwise(
        _Writer(path, layout, tuple(dims)),
        layout.dims,
        *operands,
        dtype=bool,
        align_arrays=False,
        concatenate=True,
        adjust_chunks=dict.fromkeys(layout.dims, 1),
        meta=np.empty((0,) * rank, bool),
    )
    compute_regions(written, missing, lambda done: told("regions", found + done, total))


def _finish(path: Path, dataset: xr.Dataset) -> None:
    """Tell the counts of outcomes, now that all are known."""
    zarr = needed("zarr", "a store of Zarr")
    counts = _read_marks(path)
    if np.any(counts < 0):
        raise IncompleteError(
            f"{path}: {int(np.sum(counts[:, 0] < 0))} regions are not there after all"
        )
    if OUTCOME_COLUMN in dataset:
        pairs = zip(Outcome, counts.sum(axis=0).tolist(), strict=True)
        told = {str(outcome): count for outcome, count in pairs if count}
        group = zarr.open_group(str(path), mode="r+", use_consolidated=False)
        group.attrs[OUTCOMES] = json.dumps(told)
    zarr.consolidate_metadata(str(path), zarr_format=FORMAT)

"""Stores of Zarr that are written region by region, and taken up where they stopped.

The store is there first, with its coordinates and attributes. Whichever process
computes a block writes it to its region, so that no results pass through the process
that asks. That process then adds the region to a journal inside the store: what stands
there is whole. Zarr replaces files of a directory in one move.
"""

import functools
import hashlib
import itertools
import json
import math
import os
import time
from collections.abc import Callable, Hashable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .._checks import expect
from .._packages import needed
from .._settings import numpy_settings
from ..errors import IncompleteError, InputError
from ..impact.events import Outcome
from ..interruption import remove, remove_for_good, unfinished
from ..io.datasets import OUTCOMES
from ..io.files import check_writable, locked, naming
from ..io.journal import Journal
from ..progress import Progress, ProgressFunction, as_progress
from ..quantities import OUTCOME_COLUMN
from ..tasks import WorkerlessWarner, loss_of
from .impacts import needs_impacts

FORMAT = 2
"""Format of the stores: the one in which texts of a fixed length are specified."""
GROUP, ARRAY = "_regions", "journal"
JOURNAL = Path(GROUP, ARRAY, "rows")
"""File in a store: for each region that is whole how many impacts ended in which way.
It is in the folder of an array, as Zarr warns of files elsewhere that are not its."""
PARTIAL = ".partial"
"""Ending of what is not written whole, which Zarr uses too."""
ZARRS_OWN = ".zgroup"
"""File of every store of this format; no variable has its name."""
DIGEST = "U64"
"""Type of an array of digests in hexadecimal figures."""
POLL = 0.05
"""Seconds between looks for finished regions, as often as Dask's own."""


class WrittenRegions(NamedTuple):
    """Regions of a store that was written."""

    total: int
    found: int
    """Regions that were there before."""
    computed: int
    """Regions that this call computed."""


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
    began is taken up: regions that are whole in it are not computed again. Where
    workers die Dask computes their blocks elsewhere; where none are left it waits for
    others, with a NoWorkersWarning after some seconds.

    Args:
        path: the directory; made if need be.
        dataset: from `sweep` or `simulate_dataset`, or another whose largest variables
            have the same dimensions and chunks; these are written by region, all others
            at the beginning. Numbers that impacts are computed from are read twice, as
            a store is of the values that it was begun with. No account is taken of
            those that the dataset does not hold any more, nor of what is done to
            results before they are written.
        progress: called as `progress(done, regions)`; the first call says what was
            there.

    Returns:
        How many regions there are, were found, and were computed.

    Raises:
        InputError: a store of something else, or computed from other numbers, with
            other settings, laws or versions; chunks of unequal lengths; names that no
            folder of a store can have; Dask or Zarr that are not installed.
        IncompleteError: workers were lost for good; the same call goes on from there.
        BlockingIOError: another process on this machine writes the store.
    """
    for package in ("dask", "zarr"):
        needed(package, "a store of Zarr")
    expect("dataset", dataset, xr.Dataset)
    path, tell = Path(os.path.abspath(path)), as_progress(progress)
    dataset = dataset.unify_chunks()
    regions = _regions_of(dataset)
    template = dataset.drop_vars(regions.names).compute()
    if os.path.lexists(path) and not (path / JOURNAL).is_file():
        raise _no_store_of_this(path, "is there, but is no store written by region")
    check_writable(path / ZARRS_OWN if path.is_dir() else path, option="the store")
    subject = _subject(template, dataset, regions)
    with locked(path, beside=True):
        if not path.exists():
            _begin(path, template, dataset, regions, subject)
        with (
            _open_journal(path, subject, regions) as journal,
            unfinished(path, _remove_partial),
        ):
            _remove_partial(path)
            there, _ = journal.rows()
            missing = np.setdiff1d(np.arange(regions.count), there).tolist()
            tell("regions", len(there), regions.count)
            done = itertools.count(len(there) + 1)

            def mark(number: int, outcomes: np.ndarray) -> None:
                journal.append(np.array([number]), outcomes.reshape(1, -1))
                tell("regions", next(done), regions.count)

            if missing:
                _compute_blocks(_written(path, dataset, regions), missing, mark)
            _, outcomes = journal.rows()
            _finish(path, dataset, outcomes.sum(axis=0))
    return WrittenRegions(regions.count, len(there), len(missing))


class _Regions(NamedTuple):
    lengths: dict[str, tuple[int, ...]]
    """Dimensions that have several chunks -> lengths of the regions along each."""
    names: list[str]
    """Variables over all of these dimensions, which are written by region."""

    @property
    def count(self) -> int:
        return math.prod(map(len, self.lengths.values()))


def _regions_of(dataset: xr.Dataset) -> _Regions:
    for name in (*dataset.sizes, *dataset.variables):
        expect("the name of a dimension or variable of a store", name, str)
    for name in map(str, dataset.variables):
        # Each is a folder of the store, in which Zarr, the journal and what is not
        # written whole have names too.
        taken = name.startswith(".") or name.endswith(PARTIAL) or name == GROUP
        if taken or not name or not {"/", "\\"}.isdisjoint(name):
            raise InputError(
                f"a store cannot hold a variable or an axis named {name!r}: a name "
                "must not be empty, contain a slash, begin with a dot, end in "
                f"{PARTIAL} or be {GROUP}; rename it"
            )
    lengths = {
        str(dim): dataset.chunksizes[dim]
        for dim in dataset.sizes
        if len(dataset.chunksizes.get(dim, ())) > 1
    }
    for dim, parts in lengths.items():
        sizes = [length for length in parts if length]
        if len({*sizes[:-1]}) > 1 or (sizes and sizes[-1] > sizes[0]):
            raise InputError(
                f"chunks along {dim} must have one length, but for a last one that "
                f"may be shorter, but have lengths {parts[:8]}; use dataset.chunk"
            )
    names = [
        str(name)
        for name, variable in dataset.data_vars.items()
        if variable.chunks is not None and lengths.keys() <= {*variable.dims}
    ]
    if not names:
        raise InputError(
            "the dataset holds no lazy variable over all dimensions that have several "
            "chunks; use dataset.chunk, or to_zarr of xarray for what is computed"
        )
    return _Regions(lengths, names)


def _begin(
    path: Path,
    template: xr.Dataset,
    dataset: xr.Dataset,
    regions: _Regions,
    subject: dict,
) -> None:
    """Make the store without its regions; it appears whole or not at all."""
    array = needed("dask.array", "a store of Zarr")
    zarr = needed("zarr", "a store of Zarr")
    template, encoding = template.copy(), {}
    for name in regions.names:
        variable = dataset[name]
        chunks = tuple(
            max(1, *regions.lengths.get(str(dim), (size,)))
            for dim, size in variable.sizes.items()
        )
        empty = array.empty(variable.shape, dtype=variable.dtype, chunks=chunks)
        template[name] = (variable.dims, empty, variable.attrs)
        encoding[name] = {"chunks": chunks}
    for variable in template.variables.values():
        variable.encoding = {}
        if variable.chunks is None and variable.size:
            # xarray 2025.1 says None to Zarr 3.1 otherwise, which refuses it.
            variable.encoding["chunks"] = variable.shape
    new = path.with_name(f".{path.name}.{os.getpid()}{PARTIAL}")
    remove(new)
    with unfinished(new), naming(path):
        try:
            template.to_zarr(
                new, encoding=encoding, compute=False, zarr_format=FORMAT, mode="w"
            )
            group = zarr.open_group(str(new), mode="r+", use_consolidated=False)
            marks = group.create_group(GROUP)
            marks.create_array(ARRAY, shape=(0,), chunks=(1,), dtype="int8")
            with _open_journal(new, subject, regions):
                pass  # Its first line says from now on what the store is of.
            os.rename(new, path)
        except BaseException:
            remove_for_good(new)  # which Zarr's own thread may be writing still
            raise


def _subject(template: xr.Dataset, dataset: xr.Dataset, regions: _Regions) -> dict:
    """Return what a store is of: everything but the numbers that are to be computed."""
    template = template.copy()
    template.attrs.pop(OUTCOMES, None)
    variables = {
        name: (dataset[name].dims, dataset[name].dtype.str, dataset[name].attrs)
        for name in regions.names
    }
    inputs = _digests_of_inputs(dataset, regions)
    content = [template.to_dict(), variables, regions, inputs]
    text = json.dumps(content, default=str)
    return {"dataset": hashlib.sha256(text.encode()).hexdigest()}


def _digests_of_inputs(dataset: xr.Dataset, regions: _Regions) -> dict[str, list]:
    """Return, for each variable that impacts are computed from, a digest of each block.

    Names that Dask gives to arrays would cost nothing, but change with the time of a
    file and the lines of a script. Without impacts whatever is costly may be among the
    variables, and is not computed twice.
    """
    base = needed("dask.base", "a store of Zarr")
    arrays = {name: dataset[name].data for name in regions.names}
    inputs = {name: of for name, of in arrays.items() if not needs_impacts(of)}
    if len(inputs) == len(arrays):
        return {}
    digests = [
        array.map_blocks(
            _digest,
            chunks=[(1,) * count for count in array.numblocks],
            meta=np.empty((0,) * array.ndim, DIGEST),
        )
        for array in inputs.values()
    ]
    lists = [digest.tolist() for digest in base.compute(*digests)]
    return dict(zip(inputs, lists, strict=True))


def _digest(block: np.ndarray) -> np.ndarray:
    """Return an array of one digest, of the values of a block."""
    digest = hashlib.sha256(block.tobytes()).hexdigest()
    return np.full((1,) * block.ndim, digest, DIGEST)


def _open_journal(path: Path, subject: dict, regions: _Regions) -> Journal:
    """Open the journal of a store. Raises InputError unless the store was begun for
    this subject."""
    columns = [str(outcome) for outcome in Outcome]
    try:
        return Journal(path / JOURNAL, subject, columns, regions.count, stays=True)
    except InputError as error:
        raise _no_store_of_this(
            path,
            "was begun for another dataset, other chunks, settings, laws or versions",
        ) from error


def _no_store_of_this(path: Path, why: str) -> InputError:
    return InputError(f"{why}; move it, or choose another name", file=path)


def _remove_partial(path: os.PathLike) -> bool:
    """Remove what Zarr has not written whole to a store; tell whether there was any."""
    return any([remove(file) for file in Path(path).rglob(f"*{PARTIAL}")])


def _written(path: Path, dataset: xr.Dataset, regions: _Regions) -> Any:
    """Return an array of Dask whose blocks each write a region and are the counts of
    its outcomes.

    It is made here, and not of a delayed `to_zarr` for each region: that took a
    scheduler 80 to 130 ms each.
    """
    array = needed("dask.array", "a store of Zarr")
    operands: list = []
    for dim, lengths in regions.lengths.items():
        stops = np.cumsum(lengths)
        ends = np.column_stack([stops - lengths, stops])
        operands += [array.from_array(ends, chunks=(1, 2)), (dim, "ends")]
    dims = (*regions.lengths,)
    dims_of_each: dict[str, tuple] = {}
    for name in regions.names:
        ordered = dataset[name]
        if ordered.dims[: len(dims)] != dims:  # else it would cost a task a region
            ordered = ordered.transpose(*dims, ...)
        dims_of_each[name] = ordered.dims
        # Other dimensions, which have one chunk, are taken whole.
        further = (f"{name} {dim}" for dim in ordered.dims[len(dims) :])
        operands += [ordered.data, (*dims, *further)]
    return array.blockwise(
        functools.partial(_write_region, path, dims, dims_of_each),
        (*dims, "outcome"),
        *operands,
        new_axes={"outcome": len(Outcome)},
        dtype=float,
        align_arrays=False,
        concatenate=True,
        adjust_chunks=dict.fromkeys(dims, 1),
        meta=np.empty((0,) * (len(dims) + 1)),
    )


def _write_region(
    path: Path,
    dims: tuple[str, ...],
    dims_of_each: Mapping[str, tuple[Hashable, ...]],
    *operands: np.ndarray,
) -> np.ndarray:
    """Write a block to its region, and count its outcomes.

    Args:
        operands: first index and end along each of the dims, then the variables.
    """
    ends, values = operands[: len(dims)], operands[len(dims) :]
    region = {dim: slice(*of[0].tolist()) for dim, of in zip(dims, ends, strict=True)}
    counts = np.zeros(len(Outcome))
    if all(of.stop > of.start for of in region.values()):
        pairs = zip(dims_of_each.values(), values, strict=True)
        block = xr.Dataset(dict(zip(dims_of_each, pairs, strict=True)))
        with naming(path):
            block.to_zarr(
                path,
                mode="r+",
                region=region or None,  # xarray 2025.1 takes {} for no variable's
                consolidated=False,
                zarr_format=FORMAT,
            )
        if OUTCOME_COLUMN in block:
            words = block[OUTCOME_COLUMN].values
            counts[:] = [np.sum(words == str(outcome)) for outcome in Outcome]
    return counts.reshape(*[1] * len(dims), -1)


def _compute_blocks(
    blocks: Any, missing: list[int], mark: Callable[[int, np.ndarray], None]
) -> None:
    """Compute blocks of an array of Dask by the scheduler that is set, or by that of a
    client, and mark each with its number and its result as it is done.

    Raises what a block raises, and IncompleteError where workers were lost for good.
    """
    base, core = needed("dask.base", "a store"), needed("dask.core", "a store")
    keys = [*core.flatten(blocks.__dask_keys__())]
    numbers = {keys[number]: number for number in missing}
    graph = blocks.dask.cull({*numbers})
    engine = base.get_scheduler(collections=[blocks])
    client = getattr(engine, "__self__", None)
    if client is not None and hasattr(client, "scheduler_info"):
        _on_client(client, graph, numbers, mark)
        return

    def mark_block(key, result, *_) -> None:
        if key in numbers:
            mark(numbers[key], result)

    with needed("dask.callbacks", "a store").Callback(posttask=mark_block):
        engine(graph, [*numbers])


def _on_client(
    client: Any, graph: Any, numbers: dict, mark: Callable[[int, np.ndarray], None]
) -> None:
    """Have a client compute blocks. What a killed worker had is computed by another;
    where Dask gives a block up since too many workers died over it, the others go
    on."""
    futures = client.get(graph, [*numbers], sync=False)
    waiting = needed("distributed", "a client").as_completed(futures)
    warn, lost = WorkerlessWarner(client), []
    try:
        while not waiting.is_empty():
            finished = waiting.next_batch(block=False)
            warn(finished=bool(finished))
            for future in finished:
                if (loss := loss_of(future)) is None:
                    mark(numbers[future.key], future.result())
                else:
                    lost.append(loss)
            if not finished:
                time.sleep(POLL)
    finally:
        client.cancel(futures)
    if lost:
        raise IncompleteError(
            f"{len(lost)} regions lost their workers ({lost[0]}); the same call goes "
            "on from there"
        )


def _finish(path: Path, dataset: xr.Dataset, outcomes: np.ndarray) -> None:
    zarr = needed("zarr", "a store of Zarr")
    if OUTCOME_COLUMN in dataset:
        counts = {str(of): int(n) for of, n in zip(Outcome, outcomes, strict=True) if n}
        group = zarr.open_group(str(path), mode="r+", use_consolidated=False)
        group.attrs[OUTCOMES] = json.dumps(counts)
    zarr.consolidate_metadata(str(path), zarr_format=FORMAT)

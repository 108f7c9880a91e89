"""Run-out study: many blocks, computed in portions, kept as they come, and summarised.

Each block leaves one row of numbers, whatever the length of its trajectory: how it
ended, its first passage of each collector, and its largest height, speed and energy in
each bin of x. Rows go to the journal; the pieces of trajectories are not kept.
"""

import concurrent.futures
import contextlib
import json
import time
from pathlib import Path

import numpy as np
import xarray as xr

from ..._packages import versions
from ...batch import Collector
from ...io.journal import Journal
from ...progress import Progress, ProgressFunction, as_progress
from ...quantities import columns_of_part
from ...scene_quantities import SHAPE, text_of
from ...shapes import MixedShapes
from ...tasks import check_executor, run_tasks
from ...units import DEGREE
from ..analysis import Maxima
from ..blocks import Release
from ..scheduler import WIDTH
from ..terrain import ground_columns
from ..trajectory import Ending
from .barriers import barrier_variables
from .block_rows import (
    BLOCK_NUMBERS,
    ENVELOPES,
    PASSAGE_NUMBERS,
    columns_of_rows,
    edges_of,
    places_of,
    simulate,
    summarise,
    task_of,
)
from .slope_file import SlopeStudy

PERCENTILES = (50, 90, 95, 99)
FIRST_PORTION = 64
"""Number of blocks of the first portion."""
PORTIONS = 64
"""Number of portions that an executor gets, if they are neither small nor large."""
LARGEST_PORTION = 1024
"""Largest number of blocks of such a portion, which a worker may lose."""
ABOUT_ENDING = {"long_name": "why it ended"}
QUICK = 2.0
"""Time of a portion [s] below which the next has twice the size."""


def run_slope_study(
    study: SlopeStudy,
    *,
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
    executor: concurrent.futures.Executor | None = None,
) -> xr.Dataset:
    """Compute all blocks of a study.

    Args:
        study: result of `read_slope_study`.
        journal: file that keeps finished blocks: those in it already are not computed
            again. The caller has to remove it.
        progress: called as `progress(done, blocks)`.
        executor: computes portions of the blocks in other processes, as for
            `simulate_batch`. No result depends on it.

    Returns:
        A dataset over blocks, collectors if there are any, and bins along the profile;
        every variable has its units and a long name. Percentiles are of blocks that did
        not fail, those along the profile and at collectors of the ones that came there;
        the counts of blocks behind them stand beside them, those of endings in the
        attributes.

    Raises InputError for a journal of something else.
    """
    columns, count = columns_of_rows(study), study.release.count
    opened = contextlib.nullcontext()
    if journal is not None:
        opened = Journal(journal, _subject(study), columns, count)
    with opened as kept:
        collector = Collector(
            len(columns), count, kept, as_progress(progress), "blocks"
        )
        if executor is None:
            _run_here(study, collector)
        else:
            _run_elsewhere(executor, study, collector)
    return _dataset(study, collector.numbers.T)


def _run_here(study: SlopeStudy, collector: Collector) -> None:
    """Compute the blocks that are not done, portion by portion."""
    size, waiting = FIRST_PORTION, np.flatnonzero(collector.missing)
    while len(waiting):
        portion, waiting = waiting[:size], waiting[size:]
        start = time.monotonic()
        runs = simulate(study, portion, collector.under_way)
        collector.take(portion, summarise(study, runs))
        if time.monotonic() - start < QUICK:
            size = min(2 * size, WIDTH)


def _run_elsewhere(
    executor: concurrent.futures.Executor, study: SlopeStudy, collector: Collector
) -> None:
    """Compute the blocks that are not done by the workers of an executor."""
    check_executor(executor)
    waiting = np.flatnonzero(collector.missing)
    size = int(np.clip(-(-len(waiting) // PORTIONS), FIRST_PORTION, LARGEST_PORTION))
    portions = [waiting[i : i + size] for i in range(0, len(waiting), size)]
    run_tasks(
        executor,
        (task_of(study, portion) for portion in portions),
        lambda number, found: collector.take(portions[number], found),
    )


def _subject(study: SlopeStudy) -> dict:
    return {
        "runout": study.checksums,
        "contacts": study.law,
        "laws": study.laws,
        "versions": versions() | {"numpy": np.__version__},
    }


def _dataset(study: SlopeStudy, rows: np.ndarray) -> xr.Dataset:
    blocks, places = len(rows), len(places_of(study))
    codes, rest = rows[:, 0].astype(int), rows[:, 1:]
    sizes = [len(BLOCK_NUMBERS), places * len(PASSAGE_NUMBERS)]
    of_block, of_passage, of_bins = np.split(rest, np.cumsum(sizes), axis=1)
    of_passage = of_passage.reshape(blocks, places, len(PASSAGE_NUMBERS))
    maxima = Maxima(*np.split(of_bins, len(ENVELOPES), axis=1))
    valid = codes != Ending.failed
    variables: dict[str, tuple] = {
        "ending": ("block", endings_in_words(codes), ABOUT_ENDING)
    }
    variables |= inputs_of(study.release) | ground_of(study)
    for values, (name, words_of) in zip(of_block.T, BLOCK_NUMBERS.items(), strict=True):
        variables[name] = ("block", values, about(*words_of))
    # NetCDF 3 takes a dimension of no length for one that grows.
    if len(study.collectors):
        here = np.searchsorted(places_of(study), study.collectors)
        variables |= _passages(of_passage[:, here], valid)
    here = [places_of(study).index(barrier.x) for barrier in study.barriers]
    at_barriers = np.moveaxis(of_passage[:, here], 2, 0)
    of_barriers, barriers = barrier_variables(
        study.barriers, dict(zip(PASSAGE_NUMBERS, at_barriers, strict=True))
    )
    variables |= of_barriers
    variables |= _envelopes(maxima, valid)
    return xr.Dataset(
        variables,
        coordinates_of(study)
        | barriers
        | {"percentile": ("percentile", np.array(PERCENTILES), about("%", ""))},
        attributes_of(study, codes),
    )


def endings_in_words(codes: np.ndarray) -> np.ndarray:
    """Give the words of endings, as an array of the shape of their codes."""
    return np.array([str(ending) for ending in Ending])[codes.astype(int)]


def coordinates_of(study: SlopeStudy) -> dict:
    """Describe blocks, collectors if there are any, and bins, as coordinates."""
    edges = edges_of(study)
    at = {"collector": ("collector", study.collectors, about("m", "x"))}
    return (at if len(study.collectors) else {}) | {
        "block": np.arange(study.release.count),
        "bin": ("bin", 0.5 * (edges[1:] + edges[:-1]), about("m", "x, middle")),
        "bin_left_m": ("bin", edges[:-1], about("m", "x, left end of the bin")),
        "bin_right_m": ("bin", edges[1:], about("m", "x, right end of the bin")),
    }


def attributes_of(study: SlopeStudy, codes: np.ndarray) -> dict[str, str]:
    """Describe title, inputs and endings as attributes of a dataset."""
    told = provenance_of(study, codes)
    return {"title": study.title, **{k: json.dumps(v) for k, v in told.items()}}


def _envelopes(maxima: Maxima, valid: np.ndarray) -> dict:
    """Describe largest values in bins: of each block, and percentiles of the valid
    blocks' ones."""
    variables: dict[str, tuple] = {}
    variables["blocks_in_bin"] = (
        "bin",
        np.sum(np.isfinite(maxima.speed[valid]), axis=0),
        about("-", "blocks that come into the bin, without those that failed"),
    )
    for values, (name, (unit, meaning)) in zip(maxima, ENVELOPES.items(), strict=True):
        variables[f"envelope_{name}_percentiles"] = (
            ("percentile", "bin"),
            _percentiles(values[valid]),
            about(unit, f"{meaning} in the bin: percentiles of the blocks in it"),
        )
        variables[f"envelope_{name}_max"] = (
            "bin",
            _percentiles(values[valid], (100,))[0],
            about(unit, f"{meaning} in the bin, of all blocks"),
        )
        variables[f"max_{name}"] = (
            "block",
            _largest(values),
            about(unit, f"{meaning} on its way"),
        )
        # Of half the size, and precise enough for curves.
        variables[f"{name}_in_bin"] = (
            ("block", "bin"),
            values.astype(np.float32),
            about(unit, f"{meaning} in the bin; nan for a block that is never there"),
        )
    return variables


def _passages(of_passage: np.ndarray, valid: np.ndarray) -> dict:
    """Describe first passages `(blocks, collectors, numbers)`, and percentiles of the
    valid blocks' ones."""
    variables = {}
    for values, (name, (unit, meaning)) in zip(
        np.moveaxis(of_passage, 2, 0), PASSAGE_NUMBERS.items(), strict=True
    ):
        variables[name] = (("block", "collector"), values, about(unit, meaning))
        if name not in ("passages", "passage_time_s"):
            variables[f"{name}_percentiles"] = (
                ("percentile", "collector"),
                _percentiles(values[valid]),
                about(unit, f"{meaning}: percentiles of the blocks that pass"),
            )
    variables["blocks_passing"] = (
        "collector",
        np.sum(of_passage[valid, :, 0] > 0, axis=0),
        about("-", "blocks that pass the collector, without those that failed"),
    )
    return variables


def provenance_of(study: SlopeStudy, codes: np.ndarray) -> dict:
    """Describe the inputs and endings of a result, ready for JSON."""
    return {
        "files": study.checksums,
        "contacts": study.law,
        "laws": study.laws,
        "ground": study.ground_told,
        "seed": study.seed,
        "blocks": len(codes),
        "time_limit_s": study.limits.time,
        "event_limit": study.limits.events,
        "hop_threshold": study.limits.hop_threshold,
        "endings": {
            str(ending): int(np.sum(codes == ending))
            for ending in Ending
            if np.any(codes == ending)
        },
        "versions": versions() | {"numpy": np.__version__},
    }


def inputs_of(release: Release) -> dict:
    """List the samples of blocks and releases, in the units of their names."""
    variables = {}
    shape = release.block.shape
    kinds = shape.kinds if isinstance(shape, MixedShapes) else (type(shape),)
    names = np.array([text_of(kind) for kind in kinds])
    index = shape.index if isinstance(shape, MixedShapes) else np.zeros(release.count)
    variables[SHAPE] = (
        "block",
        names[np.asarray(index, int)],
        {"long_name": "shape of the block"},
    )
    for column in columns_of_part("block", release.block).values():
        values = np.asarray(getattr(release.block, column.field)) / column.factor
        variables[column.name] = ("block", values, about(column.unit, column.meaning))
    for name, values, unit, meaning in (
        ("release_x_m", release.x, "m", "of the centre"),
        ("release_y_m", release.y, "m", "of the centre"),
        ("release_v_x_mps", release.v_x, "m/s", "to the right"),
        ("release_v_y_mps", release.v_y, "m/s", "upwards"),
        (
            "release_orientation_deg",
            release.orientation / DEGREE,
            "deg",
            "from the vertical, clockwise, to the major axis",
        ),
        (
            "release_angular_velocity_degps",
            release.angular_velocity / DEGREE,
            "deg/s",
            "clockwise",
        ),
    ):
        variables[name] = ("block", values, about(unit, f"at release, {meaning}"))
    return variables


def ground_of(study: SlopeStudy) -> dict:
    """List the samples of the ground, in the units of the names."""
    variables, columns = {}, ground_columns(study.ground.soil)
    for name, values in study.ground_samples.items():
        # Of all columns that a name may end with, the longest.
        ends = [c for c in columns if f"_{name}".endswith(f"_{c}")]
        column = columns[max(ends, key=len)]
        part = name.removesuffix(column.name).removesuffix("_")
        where = part.replace("_", " ", 1) or "the ground"
        attributes = about(column.unit, f"of {where}: {column.meaning}")
        variables[f"ground_{name}"] = ("block", values, attributes)
    return variables


def _percentiles(values: np.ndarray, of: tuple[int, ...] = PERCENTILES) -> np.ndarray:
    """Compute percentiles over the finite blocks, `(of, places)`; NaN without any."""
    found = np.full((len(of), values.shape[1]), np.nan)
    for place, column in enumerate(values.T):
        finite = column[np.isfinite(column)]
        if len(finite):
            found[:, place] = np.percentile(finite, of)
    return found


def _largest(values: np.ndarray) -> np.ndarray:
    """Give the largest finite number of each row; NaN without any."""
    largest = np.max(np.where(np.isfinite(values), values, -np.inf), axis=1)
    return np.where(np.isfinite(largest), largest, np.nan)


def about(unit: str, meaning: str) -> dict[str, str]:
    return {"units": unit, "long_name": meaning}

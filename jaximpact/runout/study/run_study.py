"""Run-out study: many blocks, computed in portions, kept as they come, and summarised.

Each block leaves one row of numbers, whatever the length of its trajectory: how it
ended, its first passage of each collector, and its largest height, speed and energy in
each bin of x. Rows go to the journal; the pieces of trajectories are not kept.
"""

import concurrent.futures
import contextlib
import json
import time
import warnings
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import xarray as xr

from ..._packages import versions
from ..._settings import numpy_settings
from ...batch import Collector
from ...errors import UnusualValueWarning
from ...io.journal import Journal
from ...progress import Progress, ProgressFunction, as_progress
from ...quantities import columns_of_part
from ...scene_quantities import SHAPE, text_of
from ...shapes import MixedShapes
from ...tasks import Task, computing, run_tasks
from ...units import DEGREE
from ..analysis import first_passages, maxima_along, passages
from ..blocks import Release, select
from ..coordinates import FASTEST
from ..scheduler import WIDTH, follow
from ..terrain import ground_columns
from ..trajectory import Ending, Runs, state_after, stretches_of
from .barriers import barrier_variables
from .slope_file import SlopeStudy

BLOCK_NUMBERS = {
    "x_m": ("m", "where it ended: the centre; nan where a contact failed"),
    "y_m": ("m", "where it ended: the centre; nan where a contact failed"),
    "time_s": ("s", "when it ended, since release"),
    "impacts": ("-", "impacts, without touches too slow to be one"),
    "hops": ("-", "contacts after which it rolled in place of a low flight"),
    "events": ("-", "contacts and legs along the ground"),
    "energy_at_release_J": ("J", "kinetic energy at release"),
    "energy_at_end_J": ("J", "kinetic energy at its end; 0 for a block that stopped"),
}
PASSAGE_NUMBERS = {
    "passages": ("-", "how often the centre passes the collector"),
    "passage_time_s": ("s", "first passage, since release"),
    "passage_v_x_mps": ("m/s", "velocity at first passage, to the right"),
    "passage_v_y_mps": ("m/s", "velocity at first passage, upwards"),
    "passage_speed_mps": ("m/s", "speed at first passage"),
    "passage_spin_radps": ("rad/s", "angular velocity at first passage, clockwise"),
    "passage_translational_energy_J": ("J", "at first passage"),
    "passage_rotational_energy_J": ("J", "at first passage"),
    "passage_energy_J": ("J", "kinetic energy at first passage"),
    "passage_centre_height_m": ("m", "of the centre above the ground, first passage"),
    "passage_lowest_height_m": (
        "m",
        "of the lowest point above the ground below the centre, first passage",
    ),
}
ENVELOPES = {
    "height_m": ("m", "largest height of the centre above the ground"),
    "speed_mps": ("m/s", "largest speed"),
    "energy_J": ("J", "largest kinetic energy"),
}


def simulate(
    study: SlopeStudy,
    chosen: np.ndarray | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> Runs:
    """Simulate the trajectories of some blocks of a study, or of all."""
    part = study if chosen is None else _part_of(study, chosen)
    # All that `simulate_runout` checks was checked as the study was read.
    return follow(
        profile=part.profile,
        release=part.release,
        ground=part.ground,
        limits=part.settings.limits,
        contacts=part.law.contacts,
        progress=as_progress(progress),
    )


def _part_of(study: SlopeStudy, chosen: np.ndarray) -> SlopeStudy:
    """Select some blocks of a study."""
    return study._replace(
        release=study.release.of_blocks(chosen),
        ground=study.ground.of_blocks(chosen),
        inputs=study.inputs._replace(ground_samples={}),
    )


def edges_of(study: SlopeStudy) -> np.ndarray:
    """Give the edges of the bins of x [m], `(bins + 1,)`."""
    return np.linspace(study.profile.x[0], study.profile.x[-1], study.settings.bins + 1)


def summarise(study: SlopeStudy, runs: Runs) -> np.ndarray:
    """Summarise each block in a row of numbers, in the order of `columns_of_rows`."""
    blocks, stretches = runs.release.count, stretches_of(runs)
    contacts = runs.contacts
    impacts = contacts.trajectory[contacts.outcome >= 0].astype(int)
    hops = contacts.trajectory[contacts.hop.astype(bool)].astype(int)
    start, end = _energies(runs)
    numbers = {
        "ending": runs.ending,
        "x_m": runs.x,
        "y_m": runs.y,
        "time_s": runs.time,
        "impacts": np.bincount(impacts, minlength=blocks),
        "hops": np.bincount(hops, minlength=blocks),
        "events": runs.events,
        "energy_at_release_J": start,
        "energy_at_end_J": end,
    }
    for x in places_of(study):
        count, first = first_passages(passages(runs, x, stretches), blocks)
        of_passage = {
            "passages": count,
            "passage_time_s": first.time,
            "passage_v_x_mps": first.v_x,
            "passage_v_y_mps": first.v_y,
            "passage_speed_mps": first.speed,
            "passage_spin_radps": first.angular_velocity,
            "passage_translational_energy_J": first.translational_energy,
            "passage_rotational_energy_J": first.rotational_energy,
            "passage_energy_J": first.energy,
            "passage_centre_height_m": first.centre_height,
            "passage_lowest_height_m": first.lowest_height,
        }
        numbers |= {f"{name} at {x!r}": of_passage[name] for name in PASSAGE_NUMBERS}
    maxima = maxima_along(runs, edges_of(study), stretches)
    for name, values in zip(ENVELOPES, maxima, strict=True):
        numbers |= {f"{name} in bin {i}": column for i, column in enumerate(values.T)}
    return np.stack([numbers[name] for name in columns_of_rows(study)], axis=1)


def _energies(runs: Runs) -> tuple[np.ndarray, np.ndarray]:
    """Compute the kinetic energy of each block at release, and at its end [J]."""
    mass, inertia = runs.release.mass_properties
    body = runs.release.body
    speeds = body.v_x**2 + body.v_y**2
    start = 0.5 * (mass * speeds + inertia * body.angular_velocity**2)
    p = runs.pieces
    last = np.searchsorted(p.trajectory, np.arange(len(mass)), "right") - 1
    final = state_after(select(p, last), p.duration[last])
    speeds = final.v_x**2 + final.v_y**2
    end = 0.5 * (mass * speeds + inertia * final.angular_velocity**2)
    return start, np.where(runs.ending == Ending.stopped, 0.0, end)


def places_of(study: SlopeStudy) -> list[float]:
    """List the places at which passages are found: collectors and barriers [m]."""
    return sorted(
        {*study.settings.collectors.tolist(), *(b.x for b in study.settings.barriers)}
    )


def columns_of_rows(study: SlopeStudy) -> list[str]:
    """List the names of the numbers of a row."""
    return [
        "ending",
        *BLOCK_NUMBERS,
        *(f"{n} at {x!r}" for x in places_of(study) for n in PASSAGE_NUMBERS),
        *(f"{n} in bin {i}" for n in ENVELOPES for i in range(study.settings.bins)),
    ]


def _rows_of(study: SlopeStudy) -> np.ndarray:
    return summarise(study, simulate(study))


PERCENTILES = (50, 90, 95, 99)
FIRST_PORTION = 64
"""Number of blocks of the first portion."""
PORTIONS = 64
"""Number of portions that an executor gets, if they are neither small nor large."""
LARGEST_PORTION = 1024
"""Largest number of blocks of such a portion, which a worker may lose."""
QUICK = 2.0
"""Time of a portion [s] below which the next has twice the size."""


@numpy_settings()
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
    with computing(progress=progress, executor=executor), opened as kept:
        collector = Collector(len(columns), count, kept, "blocks")
        if executor is None:
            _run_here(study, collector)
        else:
            _run_elsewhere(executor, study, collector)
    dataset = _dataset(study, collector.numbers.T)
    _warn_of_speed(dataset)
    return dataset


def _warn_of_speed(dataset: xr.Dataset) -> None:
    """Warn of blocks faster than nearly all on Earth: a slope in feet may be as long as
    others in metres, but its blocks are nearly twice as fast."""
    speeds = dataset.max_speed_mps.values[dataset.ending.values != str(Ending.failed)]
    fastest = np.max(speeds, initial=0.0)
    if fastest > FASTEST:
        text = (
            f"a block reaches {fastest:.4g} m/s, while usual are up to {FASTEST:g}; is "
            "the profile in feet, or another unit than metres?"
        )
        warnings.warn(UnusualValueWarning(text, "max_speed_mps"), stacklevel=3)


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
    waiting = np.flatnonzero(collector.missing)
    size = int(np.clip(-(-len(waiting) // PORTIONS), FIRST_PORTION, LARGEST_PORTION))
    portions = [waiting[i : i + size] for i in range(0, len(waiting), size)]
    run_tasks(
        executor,
        (Task(_rows_of, _part_of(study, portion)) for portion in portions),
        lambda number, found: collector.take(portions[number], found),
    )


def _subject(study: SlopeStudy) -> dict:
    return {
        "runout": study.inputs.checksums_by_name,
        "contacts": study.law.description,
        "laws": study.laws,
        "versions": versions() | {"numpy": np.__version__},
    }


class _BlockRows:
    """Numbers of blocks by name, from rows in the order of `columns_of_rows`."""

    def __init__(self, study: SlopeStudy, rows: np.ndarray):
        self.study, self.rows = study, rows
        self.place = {name: i for i, name in enumerate(columns_of_rows(study))}

    def of(self, name: str) -> np.ndarray:
        """Give a number, `(blocks,)`."""
        return self.rows[:, self.place[name]]

    def at(self, name: str, places: Iterable[float]) -> np.ndarray:
        """Give a number of first passages, `(blocks, places)`."""
        return self.rows[:, [self.place[f"{name} at {x!r}"] for x in places]]

    def in_bins(self, name: str) -> np.ndarray:
        """Give a largest value in each bin, `(blocks, bins)`."""
        bins = range(self.study.settings.bins)
        return self.rows[:, [self.place[f"{name} in bin {i}"] for i in bins]]


def _dataset(study: SlopeStudy, numbers: np.ndarray) -> xr.Dataset:
    rows, codes = _BlockRows(study, numbers), numbers[:, 0].astype(int)
    valid = codes != Ending.failed
    endings = np.array([str(ending) for ending in Ending])[codes]
    variables = {"ending": ("block", endings, {"long_name": "why it ended"})}
    variables |= _inputs_of(study.release) | _ground_of(study)
    for name, (unit, meaning) in BLOCK_NUMBERS.items():
        variables[name] = "block", rows.of(name), _about(unit, meaning)
    # NetCDF 3 takes a dimension of no length for one that grows.
    if len(study.settings.collectors):
        variables |= _passages(rows, valid)
    places = [barrier.x for barrier in study.settings.barriers]
    of_barriers, barriers = barrier_variables(
        study.settings.barriers,
        {name: rows.at(name, places) for name in PASSAGE_NUMBERS},
    )
    variables |= of_barriers | _envelopes(rows, valid)
    percentiles = ("percentile", np.array(PERCENTILES), _about("%", ""))
    coordinates = _coordinates_of(study) | barriers | {"percentile": percentiles}
    return xr.Dataset(variables, coordinates, _attributes_of(study, codes))


def _coordinates_of(study: SlopeStudy) -> dict:
    """Describe blocks, collectors if there are any, and bins, as coordinates."""
    edges = edges_of(study)
    at = {"collector": ("collector", study.settings.collectors, _about("m", "x"))}
    return (at if len(study.settings.collectors) else {}) | {
        "block": np.arange(study.release.count),
        "bin": ("bin", 0.5 * (edges[1:] + edges[:-1]), _about("m", "x, middle")),
        "bin_left_m": ("bin", edges[:-1], _about("m", "x, left end of the bin")),
        "bin_right_m": ("bin", edges[1:], _about("m", "x, right end of the bin")),
    }


def _attributes_of(study: SlopeStudy, codes: np.ndarray) -> dict[str, str]:
    """Describe title, inputs and endings as attributes of a dataset, in JSON."""
    endings = (ending for ending in Ending if np.any(codes == ending))
    told = {
        "files": study.inputs.checksums_by_name,
        "contacts": study.law.description,
        "laws": study.laws,
        "ground": study.inputs.ground_table,
        **(
            {"profile": study.inputs.smoothing._asdict()}
            if study.inputs.smoothing
            else {}
        ),
        "seed": study.inputs.seed,
        "blocks": len(codes),
        "time_limit_s": study.settings.limits.time,
        "event_limit": study.settings.limits.events,
        "hop_threshold": study.settings.limits.hop_threshold,
        "endings": {str(e): int(np.sum(codes == e)) for e in endings},
        "versions": versions() | {"numpy": np.__version__},
    }
    return {"title": study.inputs.title} | {k: json.dumps(v) for k, v in told.items()}


def _envelopes(rows: _BlockRows, valid: np.ndarray) -> dict[str, tuple]:
    """Describe largest values in bins: of each block, and percentiles of the valid
    blocks' ones."""
    there = np.isfinite(rows.in_bins("speed_mps")[valid])
    meaning = "blocks that come into the bin, without those that failed"
    variables: dict[str, tuple] = {
        "blocks_in_bin": ("bin", np.sum(there, axis=0), _about("-", meaning))
    }
    for name, (unit, meaning) in ENVELOPES.items():
        values = rows.in_bins(name)
        variables[f"envelope_{name}_percentiles"] = (
            ("percentile", "bin"),
            _percentiles(values[valid]),
            _about(unit, f"{meaning} in the bin: percentiles of the blocks in it"),
        )
        variables[f"envelope_{name}_max"] = (
            "bin",
            _percentiles(values[valid], (100,))[0],
            _about(unit, f"{meaning} in the bin, of all blocks"),
        )
        variables[f"max_{name}"] = (
            "block",
            np.fmax.reduce(values, axis=1),  # NaN only for a block without any
            _about(unit, f"{meaning} on its way"),
        )
        # Of half the size, and precise enough for curves.
        variables[f"{name}_in_bin"] = (
            ("block", "bin"),
            values.astype(np.float32),
            _about(unit, f"{meaning} in the bin; nan for a block that is never there"),
        )
    return variables


def _passages(rows: _BlockRows, valid: np.ndarray) -> dict[str, tuple]:
    """Describe first passages of collectors, and percentiles of the valid blocks'
    ones."""
    variables = {}
    for name, (unit, meaning) in PASSAGE_NUMBERS.items():
        values = rows.at(name, rows.study.settings.collectors.tolist())
        variables[name] = ("block", "collector"), values, _about(unit, meaning)
        if name not in ("passages", "passage_time_s"):
            variables[f"{name}_percentiles"] = (
                ("percentile", "collector"),
                _percentiles(values[valid]),
                _about(unit, f"{meaning}: percentiles of the blocks that pass"),
            )
    meaning = "blocks that pass the collector, without those that failed"
    counts = np.sum(variables["passages"][1][valid] > 0, axis=0)
    variables["blocks_passing"] = "collector", counts, _about("-", meaning)
    return variables


def _inputs_of(release: Release) -> dict:
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
        variables[column.name] = ("block", values, _about(column.unit, column.meaning))
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
        variables[name] = ("block", values, _about(unit, f"at release, {meaning}"))
    return variables


def _ground_of(study: SlopeStudy) -> dict:
    """List the samples of the ground, in the units of the names."""
    variables, columns = {}, ground_columns(study.ground.soil)
    for name, values in study.inputs.ground_samples.items():
        # Of all columns that a name may end with, the longest.
        ends = [c for c in columns if f"_{name}".endswith(f"_{c}")]
        column = columns[max(ends, key=len)]
        part = name.removesuffix(column.name).removesuffix("_")
        where = part.replace("_", " ", 1) or "the ground"
        attributes = _about(column.unit, f"of {where}: {column.meaning}")
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


def _about(unit: str, meaning: str) -> dict[str, str]:
    return {"units": unit, "long_name": meaning}

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
from typing import Any

import jax
import numpy as np
import xarray as xr

from ..._packages import versions
from ..._settings import numpy_settings
from ...batch import Collector
from ...code_state import digest, walk
from ...identity import name_of, name_with_fields
from ...io.checks import warn_unusual
from ...io.journal import Journal
from ...parameters import Part
from ...progress import Progress, ProgressFunction, as_progress
from ...quantities import columns_of_part
from ...scene_quantities import SHAPE, text_of
from ...shapes import MixedShapes
from ...tasks import Task, computing, run_tasks
from ...units import DEGREE, variable_attributes
from ..analysis import first_passages, maxima_along, passages
from ..blocks import Release, select
from ..contacts.contact_models import ClosedForm
from ..coordinates import FASTEST
from ..scheduler import WIDTH, follow
from ..terrain import ground_columns
from ..trajectory import NOTABLE_E_N, Ending, Runs, state_after, stretches_of
from .barriers import barrier_variables
from .results import PREFIX, valid_blocks
from .second_run import (
    LEFT_OUT,
    Run,
    differences,
    kinematics_of,
    second_run_of,
)
from .slope_file import SlopeStudy, variable_of_ground

BLOCK_NUMBERS = {
    "x_m": ("m", "x at the end, of the centre; nan where a contact failed"),
    "y_m": ("m", "y at the end, of the centre; nan where a contact failed"),
    "time_s": ("s", "time at the end, since release"),
    "impacts": ("-", "impacts, without touches too slow to be one"),
    "hops": ("-", "hops, contacts after which it rolled in place of a low flight"),
    "events": ("-", "contacts and legs along the ground"),
    "energy_at_impacts_J": ("J", "kinetic energy at touch, sum over its impacts"),
    "arm_work_given_J": ("J", "arm work of impacts that gave it energy"),
    "arm_work_taken_J": ("J", "arm work of impacts that took energy from it"),
    "impacts_of_high_e_n": ("-", f"impacts with e_n above {NOTABLE_E_N}"),
    "energy_of_high_e_n_J": ("J", "kinetic energy at touch, sum over these"),
    "impacts_that_gain": ("-", "impacts after which it had more energy than before"),
    "energy_at_release_J": ("J", "kinetic energy at release"),
    "energy_at_end_J": ("J", "kinetic energy at its end; 0 for a block that stopped"),
}
PASSAGE_NUMBERS = {
    "passages": ("-", "passages of the collector"),
    "passage_time_s": ("s", "time of first passage, since release"),
    "passage_v_x_mps": ("m/s", "velocity at first passage, to the right"),
    "passage_v_y_mps": ("m/s", "velocity at first passage, upwards"),
    "passage_speed_mps": ("m/s", "speed at first passage"),
    "passage_spin_radps": ("rad/s", "angular velocity at first passage, clockwise"),
    "passage_translational_energy_J": ("J", "translational energy at first passage"),
    "passage_rotational_energy_J": ("J", "rotational energy at first passage"),
    "passage_energy_J": ("J", "kinetic energy at first passage"),
    "passage_centre_height_m": (
        "m",
        "height of the centre at first passage, above the ground",
    ),
    "passage_lowest_height_m": (
        "m",
        "height of the lowest point at first passage, above the ground there",
    ),
}
ENVELOPES = {
    "height_m": ("m", "largest height of the centre above the ground"),
    "speed_mps": ("m/s", "largest speed"),
    "energy_J": ("J", "largest kinetic energy"),
}
RELEASE_NUMBERS = {
    "x_m": ("x", "m", "x at release, of the centre"),
    "y_m": ("y", "m", "y at release, of the centre"),
    "v_x_mps": ("v_x", "m/s", "velocity at release, to the right"),
    "v_y_mps": ("v_y", "m/s", "vertical velocity at release, upwards"),
    "orientation_deg": (
        "orientation",
        "deg",
        "orientation at release, from the vertical, clockwise, to the major axis",
    ),
    "angular_velocity_degps": (
        "angular_velocity",
        "deg/s",
        "spin at release, clockwise",
    ),
}
"""Field of the release, unit and meaning."""
PERCENTILES = (50, 90, 95, 99)
FIRST_PORTION = 64
"""Number of blocks of the first portion, and the least that a worker gets."""
QUICK = 2.0
"""Time of a portion [s] below which the next is `GROWTH` times as large."""
GROWTH = 4
"""Factor by which portions grow. Blocks advance in rounds, and a round of few blocks
takes almost as long as one of many."""


def simulate(
    study: SlopeStudy,
    chosen: np.ndarray | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> Runs:
    """Simulate the trajectories of some blocks of a study, or of all."""
    part = study if chosen is None else _part_of(study, chosen)
    # All that `simulate_runout` refuses or warns of was as the study was read, but for
    # single samples of distributions, of which the parameters were warned of.
    return follow(
        profile=part.profile,
        release=part.release,
        ground=part.ground,
        limits=part.settings.limits,
        contacts=part.law.contacts,
        progress=as_progress(progress),
    )


def _part_of(study: SlopeStudy, chosen: np.ndarray) -> SlopeStudy:
    return study._replace(
        release=study.release.of_blocks(chosen),
        ground=study.ground.of_blocks(chosen),
        inputs=study.inputs._replace(ground_samples={}),
    )


def edges_of(study: SlopeStudy) -> np.ndarray:
    """Give the edges of the bins of x [m], `(bins + 1,)`."""
    return np.linspace(study.profile.x[0], study.profile.x[-1], study.settings.bins + 1)


def places_of(study: SlopeStudy) -> list[float]:
    """List the places at which passages are found: collectors and barriers [m]."""
    barriers = (barrier.x for barrier in study.settings.barriers)
    return sorted({*study.settings.collectors.tolist(), *barriers})


def columns_of_rows(study: SlopeStudy) -> list[str]:
    """List the names of the numbers of a row."""
    return [
        *("ending", *BLOCK_NUMBERS),
        *(f"{n} at {x!r}" for x in places_of(study) for n in PASSAGE_NUMBERS),
        *(f"{n} in bin {i}" for n in ENVELOPES for i in range(study.settings.bins)),
    ]


def summarise(study: SlopeStudy, runs: Runs) -> np.ndarray:
    """Summarise each block in a row of numbers, in the order of `columns_of_rows`."""
    blocks, stretches = runs.release.count, stretches_of(runs)
    contacts = runs.contacts
    impacts = contacts.trajectory[contacts.outcome >= 0].astype(int)
    hops = contacts.trajectory[contacts.hop.astype(bool)].astype(int)
    columns = [
        *(runs.ending, runs.x, runs.y, runs.time),
        np.bincount(impacts, minlength=blocks),
        np.bincount(hops, minlength=blocks),
        runs.events,
        *runs.impact_energies().sums(blocks).values(),
        *_energies(runs),
    ]
    for x in places_of(study):
        count, first = first_passages(passages(runs, x, stretches), blocks)
        columns += [count, first.time, first.v_x, first.v_y, first.speed]
        columns += [first.angular_velocity, first.translational_energy]
        columns += [first.rotational_energy, first.energy]
        columns += [first.centre_height, first.lowest_height]
    maxima = maxima_along(runs, edges_of(study), stretches)
    columns += [column for values in maxima for column in values.T]
    return np.stack(columns, axis=1)


def _energies(runs: Runs) -> tuple[np.ndarray, np.ndarray]:
    """Compute the kinetic energy of each block at release, and at its end [J]."""
    of_blocks, body = runs.release.mass_properties, runs.release.body
    p, count = runs.pieces, runs.release.count
    start = of_blocks.kinetic_energy(body.v_x, body.v_y, body.angular_velocity)
    last = np.searchsorted(p.trajectory, np.arange(count), "right") - 1
    # A block that is released at an end of the profile leaves it at once.
    moved = np.bincount(p.trajectory, minlength=count) > 0
    last, end = last[moved], start.copy()
    body = state_after(select(p, last), p.duration[last])
    end[moved] = select(of_blocks, moved).kinetic_energy(
        body.v_x, body.v_y, body.angular_velocity
    )
    return start, np.where(runs.ending == Ending.stopped, 0.0, end)


@numpy_settings()
def run_slope_study(
    study: SlopeStudy,
    *,
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
    executor: concurrent.futures.Executor | None = None,
    second_run: bool = True,
) -> xr.Dataset:
    """Compute all blocks of a study.

    Args:
        study: result of `read_slope_study`.
        journal: file that keeps finished blocks: those in it already are not computed
            again. The caller has to remove it.
        progress: called as `progress(done, blocks)`.
        executor: computes portions of the blocks in other processes, as for
            `simulate_batch`. No result depends on it.
        second_run: run elongated blocks by the full model once more, with the same
            random numbers and the other kinematics of the soil; what they come to has
            names that begin with second_run_, and the attribute second_run says where
            design values differ by more than their intervals.

    Returns:
        A dataset over blocks, collectors if there are any, and bins along the profile;
        every variable has its units and a long name. Percentiles are of blocks that did
        not fail, those along the profile and at collectors of the ones that came there;
        the counts of blocks behind them stand beside them, those of endings in the
        attributes.

    Raises InputError for a journal of something else.
    """
    columns, count = columns_of_rows(study), study.release.count
    second = second_run_of(study) if second_run else LEFT_OUT
    again = second if isinstance(second, Run) else None
    parts = [Run(study, np.arange(count), 0), *([again] if again else [])]
    total = sum(len(part.blocks) for part in parts)
    opened = contextlib.nullcontext()
    if journal is not None:
        subject = _subject(study) | {"second run": again is not None}
        subject["values"] = _digest_of_values(study)
        opened = Journal(journal, subject, columns, total)
    with computing(progress=progress, executor=executor), opened as kept:
        collector = Collector(len(columns), total, kept, "blocks")
        for part in parts:
            if executor is None:
                _run_here(part, collector)
            else:
                _run_elsewhere(executor, part, collector)
    rows = collector.numbers.T
    dataset = _dataset(study, rows[:count])
    _warn_of_speed(dataset)
    if again is None:
        return dataset.assign_attrs(second_run=json.dumps(second))
    others = rows[:count].copy()
    others[again.blocks] = rows[count:]
    return _with_second(dataset, again.study, others)


def _with_second(
    dataset: xr.Dataset, study: SlopeStudy, rows: np.ndarray
) -> xr.Dataset:
    """Add what the second run gave, and where it differs."""
    second = _dataset(study, rows)
    results = {"ending", "blocks_passing", *BLOCK_NUMBERS, *PASSAGE_NUMBERS}
    results |= {name for name in map(str, second) if name.startswith("barrier_")}
    results |= {f"{name}_percentiles" for name in PASSAGE_NUMBERS}
    kinematics = kinematics_of(study)
    about = {"kinematics": kinematics, "differences": []}
    both = dataset.assign(
        {
            f"{PREFIX}{name}": values.assign_attrs(
                long_name=f"{values.attrs['long_name']} by {kinematics}"
            )
            for name, values in second.items()
            if name in results
        }
    ).assign_attrs(second_run=json.dumps(about))
    about["differences"] = differences(both)
    return both.assign_attrs(second_run=json.dumps(about))


def _warn_of_speed(dataset: xr.Dataset) -> None:
    """Warn of blocks faster than nearly all on Earth: a slope in feet may be as long as
    others in metres, but its blocks are nearly twice as fast."""
    speeds = dataset.max_speed_mps.values[valid_blocks(dataset)]
    # A block that ends at its release may have none.
    fastest = np.fmax.reduce(speeds, initial=0.0)
    if fastest > FASTEST:
        warn_unusual(
            f"a block reaches {fastest:.4g} m/s, while usual are up to {FASTEST:g}; is "
            "the profile in feet, or another unit than metres?",
            "max_speed_mps",
        )


def _run_here(part: Run, collector: Collector) -> None:
    size, waiting = FIRST_PORTION, _waiting(part, collector)
    while len(waiting):
        portion, waiting = waiting[:size], waiting[size:]
        start = time.monotonic()
        runs = simulate(part.study, part.blocks[portion], collector.under_way)
        collector.take(part.first + portion, summarise(part.study, runs))
        if time.monotonic() - start < QUICK:
            size = min(GROWTH * size, WIDTH)


def _waiting(part: Run, collector: Collector) -> np.ndarray:
    """Give the places of the blocks of a part that are not computed yet."""
    return np.flatnonzero(collector.missing[part.first :][: len(part.blocks)])


def _run_elsewhere(
    executor: concurrent.futures.Executor, part: Run, collector: Collector
) -> None:
    waiting = _waiting(part, collector)
    # 64 portions keep many workers busy; a lost worker costs 1024 blocks at most.
    size = int(np.clip(-(-len(waiting) // 64), FIRST_PORTION, 1024))
    portions = [waiting[i : i + size] for i in range(0, len(waiting), size)]
    run_tasks(
        executor,
        (
            Task(_rows_of, _part_of(part.study, part.blocks[portion]))
            for portion in portions
        ),
        lambda number, rows: collector.take(part.first + portions[number], rows),
    )


def _rows_of(study: SlopeStudy) -> np.ndarray:
    return summarise(study, simulate(study))


def _subject(study: SlopeStudy) -> dict[str, Any]:
    """Describe what the rows of blocks depend on, ready for JSON."""
    return {
        "runout": study.inputs.checksums_by_name,
        "contacts": study.law.description,
        "kinematics": kinematics_of(study),
        "laws": study.laws,
        "versions": versions() | {"numpy": np.__version__},
    }


def _digest_of_values(study: SlopeStudy) -> str:
    """Give the SHA-256 of the values that the trajectories are computed from: a study
    that was changed in Python still names the file that it was read from."""
    profile, release, ground = study.profile, study.release, study.ground
    contacts = study.law.contacts
    law: Any = contacts.law if isinstance(contacts, ClosedForm) else contacts
    values = (
        (profile.x, profile.y, release.block, release.body),
        (ground.soil, ground.rolling_friction_angle, ground.roughness),
        (ground.seed, ground.numbers, study.settings.limits, law),
    )
    # Leaves alone: a user's class may count its calls, which is no change of it.
    name = name_with_fields(law) if isinstance(law, Part) else name_of(type(law))
    return digest(walk([name, *jax.tree.leaves(values)]))


Variables = dict[str, tuple[Any, ...]]
"""Dimensions, values and attributes of the variables of a dataset, by name."""


def _variable(dimensions, values: np.ndarray, unit: str, meaning: str) -> tuple:
    return dimensions, values, variable_attributes(meaning, unit)


def _dataset(study: SlopeStudy, rows: np.ndarray) -> xr.Dataset:
    places, blocks = places_of(study), len(rows)
    ends = np.cumsum([1 + len(BLOCK_NUMBERS), len(places) * len(PASSAGE_NUMBERS)])
    of_blocks, at_places, in_bins = np.split(rows, ends, axis=1)
    at_places = at_places.reshape(blocks, len(places), len(PASSAGE_NUMBERS))
    first = dict(zip(PASSAGE_NUMBERS, np.moveaxis(at_places, -1, 0), strict=True))
    codes = rows[:, 0].astype(int)
    endings = np.array([str(ending) for ending in Ending])[codes]
    variables: Variables = {"ending": ("block", endings, {"long_name": "ending"})}
    variables |= inputs_of(study)
    for i, (name, about) in enumerate(BLOCK_NUMBERS.items(), 1):
        variables[name] = _variable("block", of_blocks[:, i], *about)
    valid, collectors = codes != Ending.failed, study.settings.collectors
    # NetCDF 3 takes a dimension of no length for one that grows.
    if len(collectors):
        chosen = [places.index(x) for x in collectors.tolist()]
        variables |= _passages({n: v[:, chosen] for n, v in first.items()}, valid)
    chosen = [places.index(barrier.x) for barrier in study.settings.barriers]
    of_barriers, coordinates = barrier_variables(
        study.settings.barriers, {n: v[:, chosen] for n, v in first.items()}
    )
    in_bins = in_bins.reshape(blocks, len(ENVELOPES), study.settings.bins)
    variables |= of_barriers | _envelopes(in_bins, valid)
    if len(collectors):
        coordinates["collector"] = _variable("collector", collectors, "m", "x")
    edges = edges_of(study)
    coordinates |= {
        "block": np.arange(blocks),
        "bin": _variable("bin", 0.5 * (edges[1:] + edges[:-1]), "m", "x, middle"),
        "bin_left_m": _variable("bin", edges[:-1], "m", "x, left end of the bin"),
        "bin_right_m": _variable("bin", edges[1:], "m", "x, right end of the bin"),
        "percentile": _variable("percentile", np.array(PERCENTILES), "%", ""),
    }
    return xr.Dataset(variables, coordinates, _attributes_of(study, codes))


def _attributes_of(study: SlopeStudy, codes: np.ndarray) -> dict[str, str]:
    """Describe title, inputs and endings as attributes of a dataset, in JSON."""
    inputs, limits, subject = study.inputs, study.settings.limits, _subject(study)
    counts = {str(e): int(np.sum(codes == e)) for e in Ending}
    described = {
        "files": subject.pop("runout"),
        **subject,
        "ground": inputs.ground_table,
        "seed": inputs.seed,
        "blocks": len(codes),
        "time_limit_s": limits.time,
        "event_limit": limits.events,
        "hop_threshold": limits.hop_threshold,
        "endings": {ending: count for ending, count in counts.items() if count},
    }
    if inputs.smoothing is not None:
        described["profile"] = inputs.smoothing._asdict()
    return {"title": inputs.title} | {k: json.dumps(v) for k, v in described.items()}


def _envelopes(in_bins: np.ndarray, valid: np.ndarray) -> Variables:
    """Describe largest values in bins: of each block, and percentiles of the valid
    blocks' ones."""
    meaning = "blocks that come into the bin, without those that failed"
    there = np.sum(np.isfinite(in_bins[valid, 0]), axis=0)
    variables = {"blocks_in_bin": _variable("bin", there, "-", meaning)}
    for i, (name, (unit, meaning)) in enumerate(ENVELOPES.items()):
        values = in_bins[:, i]
        variables[f"envelope_{name}_percentiles"] = _variable(
            ("percentile", "bin"),
            _percentiles(values[valid]),
            unit,
            f"{meaning} in the bin: percentiles of the blocks in it",
        )
        largest = _percentiles(values[valid], (100,))[0]
        variables[f"envelope_{name}_max"] = _variable(
            "bin", largest, unit, f"{meaning} in the bin, of all blocks"
        )
        # NaN only for a block without any.
        largest = np.fmax.reduce(values, axis=1)
        about = unit, f"{meaning} on its way"
        variables[f"max_{name}"] = _variable("block", largest, *about)
        # Of half the size, and precise enough for curves.
        single = values.astype(np.float32)
        about = unit, f"{meaning} in the bin; nan for a block that is never there"
        variables[f"{name}_in_bin"] = _variable(("block", "bin"), single, *about)
    return variables


def _passages(first: dict[str, np.ndarray], valid: np.ndarray) -> Variables:
    """Describe first passages of collectors, and percentiles of the valid blocks'
    ones."""
    variables = {}
    for name, (unit, meaning) in PASSAGE_NUMBERS.items():
        values = first[name]
        variables[name] = _variable(("block", "collector"), values, unit, meaning)
        if name not in ("passages", "passage_time_s"):
            variables[f"{name}_percentiles"] = _variable(
                ("percentile", "collector"),
                _percentiles(values[valid]),
                unit,
                f"{meaning}: percentiles of the blocks that pass",
            )
    meaning = "blocks that pass the collector, without those that failed"
    counts = np.sum(first["passages"][valid] > 0, axis=0)
    variables["blocks_passing"] = _variable("collector", counts, "-", meaning)
    return variables


def inputs_of(study: SlopeStudy) -> Variables:
    """List what each block gets: samples of blocks, releases and ground, in the units
    of their names."""
    return _releases_of(study.release) | _ground_of(study)


def _releases_of(release: Release) -> Variables:
    """List the samples of blocks and releases, in the units of their names."""
    shape = release.block.shape
    is_mixed = isinstance(shape, MixedShapes)
    names = [text_of(kind) for kind in (shape.kinds if is_mixed else (type(shape),))]
    index = shape.index if is_mixed else np.zeros(release.count)
    shapes = np.array(names)[np.asarray(index, int)]
    variables: Variables = {
        SHAPE: ("block", shapes, {"long_name": "shape of the block"})
    }
    for column in columns_of_part("block", release.block).values():
        values = np.asarray(getattr(release.block, column.field)) / column.factor
        about = column.unit, column.meaning
        variables[column.name] = _variable("block", values, *about)
    for name, (field, unit, meaning) in RELEASE_NUMBERS.items():
        values = getattr(release, field) / (DEGREE if "deg" in unit else 1.0)
        variables[f"release_{name}"] = _variable("block", values, unit, meaning)
    return variables


def _ground_of(study: SlopeStudy) -> Variables:
    """List the samples of the ground, in the units of the names."""
    variables, columns = {}, ground_columns(study.ground.soil)
    for key, values in study.inputs.ground_samples.items():
        *part, name = key.split(".")
        column = columns[name]
        words = variable_attributes(column.meaning)["long_name"]
        meaning = f"{words} of {' '.join(part) or 'the ground'}"
        variable = variable_of_ground(f"ground.{key}")
        variables[variable] = _variable("block", values, column.unit, meaning)
    return variables


def _percentiles(values: np.ndarray, of: tuple[int, ...] = PERCENTILES) -> np.ndarray:
    """Compute percentiles over the finite blocks, `(of, places)`; NaN without any."""
    percentiles = np.full((len(of), values.shape[1]), np.nan)
    for place, column in enumerate(values.T):
        finite = column[np.isfinite(column)]
        if len(finite):
            percentiles[:, place] = np.percentile(finite, of)
    return percentiles

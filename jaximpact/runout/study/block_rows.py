"""Rows of numbers, one for each block of a study.

A row holds how the block ended, its first passage of each collector, and its largest
height, speed and energy in each bin of x.
"""

import numpy as np

from ...progress import Progress, ProgressFunction, as_progress
from ...tasks import Task
from ..analysis import first_passages, maxima_along, passages
from ..blocks import select
from ..scheduler import follow
from ..trajectory import Ending, Runs, state_after, stretches_of
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
    chosen: np.ndarray,
    progress: Progress | ProgressFunction | None = None,
) -> Runs:
    """Simulate the trajectories of some blocks of a study."""
    return _simulate(_part_of(study, chosen), as_progress(progress))


def _part_of(study: SlopeStudy, chosen: np.ndarray) -> SlopeStudy:
    """Select some blocks of a study."""
    return study._replace(
        release=study.release.of_blocks(chosen),
        ground=study.ground.of_blocks(chosen),
        ground_samples={},
    )


def _simulate(study: SlopeStudy, progress: Progress) -> Runs:
    # All that `simulate_runout` checks was checked as the study was read.
    return follow(
        *(study.profile, study.release, study.ground, study.limits),
        contacts=study.contacts,
        progress=progress,
    )


def edges_of(study: SlopeStudy) -> np.ndarray:
    """Give the edges of the bins of x [m], `(bins + 1,)`."""
    return np.linspace(study.profile.x[0], study.profile.x[-1], study.bins + 1)


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
    return sorted({*study.collectors.tolist(), *(b.x for b in study.barriers)})


def columns_of_rows(study: SlopeStudy) -> list[str]:
    """List the names of the numbers of a row."""
    return [
        "ending",
        *BLOCK_NUMBERS,
        *(f"{n} at {x!r}" for x in places_of(study) for n in PASSAGE_NUMBERS),
        *(f"{n} in bin {i}" for n in ENVELOPES for i in range(study.bins)),
    ]


def task_of(study: SlopeStudy, chosen: np.ndarray) -> Task:
    """Make the task that computes the rows of some blocks, and holds no others."""
    return Task(_rows_of, _part_of(study, chosen))


def _rows_of(study: SlopeStudy) -> np.ndarray:
    return summarise(study, _simulate(study, Progress()))

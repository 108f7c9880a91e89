"""Numbers of trajectories by their names, of which derivatives are asked for."""

from collections.abc import Iterable

import numpy as np

from ..errors import InputError
from ..formats.checks import checked_names
from .collectors import Passages, passages
from .dual import plain
from .envelopes import candidates
from .runs import Runs
from .stretches import stretches_of

OF_ENDS = {
    "x_m": ("m", lambda runs: runs.x),
    "y_m": ("m", lambda runs: runs.y),
    "time_s": ("s", lambda runs: runs.time),
}
"""Where and when a block ended."""
LARGEST = {"max_height_m": "m", "max_speed_mps": "m/s", "max_energy_J": "J"}
"""On its whole way: of the centre's height above the ground, speed, kinetic energy."""
OF_PASSAGES = {
    "passage_time_s": ("s", lambda found: found.time),
    "passage_speed_mps": ("m/s", lambda found: found.speed),
    "passage_energy_J": ("J", lambda found: found.energy),
    "passage_spin_radps": ("rad/s", lambda found: found.angular_velocity),
    "passage_centre_height_m": ("m", lambda found: found.centre_height),
    "passage_lowest_height_m": ("m", lambda found: found.lowest_height),
}
"""Of the first passage of each collector; see `Passages`."""
KNOWN = (*OF_ENDS, *LARGEST, *OF_PASSAGES)


def chosen_outputs(names: Iterable[str], collectors: Iterable[float]) -> dict[str, str]:
    """Units of all outputs by their full names, those of passages for each collector.

    Raises InputError for a name that is unknown, with the nearest known, or stands
    twice, and where there is none.
    """
    collectors, units = tuple(map(float, collectors)), {}
    for name in checked_names("output", names, KNOWN):
        if name in OF_PASSAGES:
            if not collectors:
                raise InputError(f"output {name} needs a collector, but there is none")
            units |= {f"{name} at {x!r}": OF_PASSAGES[name][0] for x in collectors}
        else:
            units[name] = LARGEST[name] if name in LARGEST else OF_ENDS[name][0]
    return units


def outputs_of(runs: Runs, names: Iterable[str]) -> tuple[list, list]:
    """The outputs of some full names, `(blocks,)` each, NaN where there is no value,
    and the times at which they stand [s]: inf for those of the end.

    They carry the derivatives that the runs carry; the times carry none.
    """
    found, times, way, largest = [], [], stretches_of(runs), None
    never = np.full(runs.release.count, np.inf)
    passed = {}
    for name in names:
        kind, _, place = name.partition(" at ")
        if kind in OF_ENDS:
            found.append(OF_ENDS[kind][1](runs))
            times.append(never)
        elif kind in LARGEST:
            largest = largest or _largest(runs, way)
            value, time = largest[kind]
            found.append(value)
            times.append(time)
        else:
            if place not in passed:
                passed[place] = passages(runs, float(place), way)
            value, time = _of_first(runs, passed[place], OF_PASSAGES[kind][1])
            found.append(value)
            times.append(time)
    return found, times


def _of_first(runs: Runs, found: Passages, quantity):
    blocks = runs.release.count
    passing, first = np.unique(found.trajectory, return_index=True)
    if not len(first):
        return np.full(blocks, np.nan), np.full(blocks, np.nan)
    place = np.zeros(blocks, int)
    place[passing] = first
    has_passed = np.isin(np.arange(blocks), passing)
    return (
        np.where(has_passed, quantity(found)[place], np.nan),
        np.where(has_passed, plain(found.time)[place], np.nan),
    )


def _largest(runs: Runs, way) -> dict:
    trajectory, _, start, *kinds = candidates(runs, runs.profile.x[[0, -1]], way)
    found = {}
    for name, columns in zip(LARGEST, kinds, strict=True):
        values = np.concatenate(columns)
        owner, time = (np.tile(column, len(columns)) for column in (trajectory, start))
        # Of each block the last when sorted; what a failed contact left is no number.
        order = np.lexsort((np.nan_to_num(plain(values), nan=-np.inf), owner))
        last = np.searchsorted(owner[order], np.arange(runs.release.count), "right") - 1
        found[name] = values[order[last]], time[order[last]]
    speed, time = found["max_speed_mps"]
    found["max_speed_mps"] = np.sqrt(speed), time
    return found

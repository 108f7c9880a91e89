"""Outputs of a run-out that can be differentiated, by name."""

from collections.abc import Iterable

import numpy as np

from ...errors import InputError
from ...io.checks import checked_names
from ..analysis import Passages, extremes, passages
from ..dual import primal
from ..trajectory import Runs, stretches_of

OF_ENDS = {
    "x_m": ("m", lambda runs: runs.x),
    "y_m": ("m", lambda runs: runs.y),
    "time_s": ("s", lambda runs: runs.time),
}
"""Place and time of the end of a trajectory."""
LARGEST = {"max_height_m": "m", "max_speed_mps": "m/s", "max_energy_J": "J"}
"""Largest values on the whole trajectory: height of the centre above the ground, speed,
kinetic energy."""
OF_PASSAGES = {
    "passage_time_s": ("s", lambda found: found.time),
    "passage_speed_mps": ("m/s", lambda found: found.speed),
    "passage_energy_J": ("J", lambda found: found.energy),
    "passage_spin_radps": ("rad/s", lambda found: found.angular_velocity),
    "passage_centre_height_m": ("m", lambda found: found.centre_height),
    "passage_lowest_height_m": ("m", lambda found: found.lowest_height),
}
"""Quantities of the first passage of each collector; see `Passages`."""
KNOWN = (*OF_ENDS, *LARGEST, *OF_PASSAGES)


def chosen_outputs(names: Iterable[str], collectors: Iterable[float]) -> dict[str, str]:
    """List the units of outputs by full name, those of passages for each collector.

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
    """Compute outputs, and the times by which they are settled.

    Args:
        names: full names, from `chosen_outputs`.

    Returns:
        Outputs, `(blocks,)` each, NaN where there is no value, with the derivatives
        that the runs carry; and times [s], inf for outputs of the end, without
        derivatives.
    """
    found, times, stretches, largest = [], [], stretches_of(runs), None
    never = np.full(runs.release.count, np.inf)
    passed = {}
    for name in names:
        kind, _, place = name.partition(" at ")
        if kind in OF_ENDS:
            found.append(OF_ENDS[kind][1](runs))
            times.append(never)
        elif kind in LARGEST:
            largest = largest or _largest(runs, stretches)
            value, time = largest[kind]
            found.append(value)
            times.append(time)
        else:
            if place not in passed:
                passed[place] = passages(runs, float(place), stretches)
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
        np.where(has_passed, primal(found.time)[place], np.nan),
    )


def _largest(runs: Runs, stretches) -> dict:
    edges = runs.profile.x[[0, -1]]
    trajectory, _, start, *kinds = extremes(runs, edges, stretches)
    found = {}
    for name, columns in zip(LARGEST, kinds, strict=True):
        values = np.concatenate(columns)
        owner, time = (np.tile(column, len(columns)) for column in (trajectory, start))
        # The last of each block when sorted; a failed contact leaves NaN.
        order = np.lexsort((np.nan_to_num(primal(values), nan=-np.inf), owner))
        last = np.searchsorted(owner[order], np.arange(runs.release.count), "right") - 1
        found[name] = values[order[last]], time[order[last]]
    speed, time = found["max_speed_mps"]
    found["max_speed_mps"] = np.sqrt(speed), time
    return found

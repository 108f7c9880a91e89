"""Trajectories with the derivatives that they carry, and outputs read off them by
name."""

import operator
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ...io.checks import checked_names
from ...progress import Progress
from ..analysis import Moment, extremes, find_passages, passage, values_at
from ..blocks import BlockOutline, MassProperties, select
from ..lane_programs import Carried, Values, call, closed_form, root
from ..scheduler import WIDTH, advance, result_of
from ..state import Limits, State
from ..trajectory import Pieces, Runs, Stretches, stretches_of
from .parameters import Case, Parameter, directions_of


class Result(NamedTuple):
    """Trajectories, with the derivatives that they carry."""

    runs: Runs
    blocks: Carried
    """`BlockState` at the end, arrays `(blocks,)`."""
    contacts: Carried
    """`ContactRecord`."""
    pieces: Carried
    """`Pieces`."""
    constants: Carried
    """`BlockConstants`."""


def follow_case(
    case: Case, limits: Limits, parameters: tuple[Parameter, ...] = ()
) -> Result:
    """Follow all blocks, with derivatives with respect to some parameters."""
    directions = directions_of(case, parameters) if parameters else None
    state = State.at_release(
        case.profile, case.release, case.ground, limits, directions
    )
    advance(state, case.contacts, WIDTH, Progress())
    return Result(
        runs=result_of(state),
        blocks=state.blocks,
        contacts=state.contacts.whole(),
        pieces=state.pieces.whole(),
        constants=state.constants,
    )


OF_ENDS = {"x_m": ("m", "body.x"), "y_m": ("m", "body.y"), "time_s": ("s", "time")}
"""Place and time of the end of a trajectory: unit, and field of `BlockState`."""
LARGEST = {"max_height_m": "m", "max_speed_mps": "m/s", "max_energy_J": "J"}
"""Largest values on the whole trajectory: height of the centre above the ground, speed,
kinetic energy."""
OF_PASSAGES = {
    "passage_time_s": "s",
    "passage_speed_mps": "m/s",
    "passage_energy_J": "J",
    "passage_spin_radps": "rad/s",
    "passage_centre_height_m": "m",
    "passage_lowest_height_m": "m",
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
            units |= {f"{name} at {x!r}": OF_PASSAGES[name] for x in collectors}
        else:
            units[name] = LARGEST[name] if name in LARGEST else OF_ENDS[name][0]
    return units


class Output(NamedTuple):
    """Output of each block."""

    value: Carried
    """`(blocks,)`; NaN where there is no value."""
    when: np.ndarray
    """Time by which it is settled [s], `(blocks,)`; inf for outputs of the end."""


def outputs_of(result: Result, names: Iterable[str]) -> list[Output]:
    """Compute outputs, with the derivatives that the trajectories carry.

    Args:
        names: full names, from `chosen_outputs`.
    """
    runs = result.runs
    stretches, never = stretches_of(runs), np.full(runs.release.count, np.inf)
    found, largest, passed = [], {}, {}
    for name in names:
        kind, _, place = name.partition(" at ")
        if kind in OF_ENDS:
            field = operator.attrgetter(OF_ENDS[kind][1])
            found.append(Output(result.blocks.map(field), never))
        elif kind in LARGEST:
            largest = largest or _largest(result, stretches)
            found.append(largest[kind])
        else:
            if place not in passed:
                passed[place] = _of_first_passages(result, float(place), stretches)
            found.append(passed[place][kind])
    return found


def _of_first_passages(
    result: Result, x: float, stretches: Stretches
) -> dict[str, Output]:
    """Compute the quantities of the first passages of a collector."""
    runs = result.runs
    piece, moment = find_passages(runs, x, stretches)
    passing, first = np.unique(runs.pieces.trajectory[piece], return_index=True)
    found = call(
        _of_passage,
        result.pieces.at(piece[first]),
        select(moment, first),
        result.constants.part("outline").at(passing),
        result.constants.part("mass_properties").at(passing),
        runs.profile.height(x),
    )

    def of_all(values: np.ndarray) -> np.ndarray:
        spread = np.full((*values.shape[:-1], runs.release.count), np.nan)
        spread[..., passing] = values
        return spread

    when = of_all(found.value["passage_time_s"])
    return {
        name: Output(found.map(lambda tree, n=name: of_all(tree[n])), when)
        for name in OF_PASSAGES
    }


@closed_form
def _of_passage(
    piece: Pieces,
    moment: Moment,
    outline: BlockOutline,
    mass_properties: MassProperties,
    ground: Values,
) -> dict[str, Values]:
    found = passage.function(piece, moment, outline, mass_properties, ground)
    return {
        "passage_time_s": found.time,
        "passage_speed_mps": root(found.v_x**2 + found.v_y**2),
        "passage_energy_J": found.energy,
        "passage_spin_radps": found.angular_velocity,
        "passage_centre_height_m": found.centre_height,
        "passage_lowest_height_m": found.lowest_height,
    }


def _largest(result: Result, stretches: Stretches) -> dict[str, Output]:
    """Compute the largest values on whole trajectories."""
    runs = result.runs
    parts = extremes(runs, runs.profile.x[[0, -1]], stretches)
    speeds = [np.sqrt(squared) for squared in parts.squared_speeds]
    found = {}
    for place, (name, columns) in enumerate(
        zip(LARGEST, (parts.heights, speeds, parts.energies), strict=True)
    ):
        values = np.concatenate(columns)
        owner = np.tile(parts.trajectory, len(columns))
        # The last of each block when sorted; a failed contact leaves NaN.
        order = np.lexsort((np.nan_to_num(values, nan=-np.inf), owner))
        blocks = np.arange(runs.release.count)
        last = order[np.searchsorted(owner[order], blocks, "right") - 1]
        part = last % len(parts.piece)
        piece = parts.piece[part]
        moments = parts.moments[: len(columns)]
        moment = Moment(*(np.concatenate(c)[last] for c in zip(*moments, strict=True)))
        at_moment = call(
            values_at,
            *(result.pieces.at(piece), moment, parts.gradient[part]),
            result.constants.part("mass_properties").at(blocks),
        )
        value = Carried(values[last], at_moment.tangent and at_moment.tangent[place])
        found[name] = Output(value, runs.pieces.time[piece])
    return found

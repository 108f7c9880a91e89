"""Trajectories of a case, with the derivatives that they carry."""

from typing import NamedTuple

from ...progress import Progress
from ..lane_programs import Carried, Values
from ..scheduler import WIDTH, advance, result_of
from ..state import Limits, State
from ..trajectory import Runs
from .parameters import Case, Parameter, directions_of


class Ends(NamedTuple):
    """Ends of trajectories, arrays `(blocks,)`."""

    x: Values
    y: Values
    time: Values


class Result(NamedTuple):
    """Trajectories, with the derivatives that they carry."""

    runs: Runs
    ends: Carried
    """`Ends`."""
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
    blocks = state.blocks
    return Result(
        runs=result_of(state),
        ends=blocks.map(lambda block: Ends(block.body.x, block.body.y, block.time)),
        contacts=state.contacts.whole(),
        pieces=state.pieces.whole(),
        constants=state.constants,
    )

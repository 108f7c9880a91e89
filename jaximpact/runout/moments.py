"""Moments on pieces of trajectories, and what they follow as the pieces change."""

import enum
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from .derivative_rules import found_by_search
from .lane_programs import Values
from .trajectory import Pieces, Runs, Stretches, state_after


class Follows(enum.IntEnum):
    """What a time on a piece follows as the piece changes."""

    nothing = 0
    end = 1
    """The end of the piece."""
    turn = 2
    """The time at which x turns back."""
    place = 3
    """The time at which the centre is at a place x."""


class Moment(NamedTuple):
    """Time on a piece."""

    time: Values
    """From the start of the piece [s]."""
    follows: Values
    """Code of `Follows`."""


def moving_time(piece: Pieces, moment: Moment) -> Values:
    """Give a time on a piece, with its derivative."""
    follows = moment.follows
    then = state_after(piece, moment.time)
    turning = -piece.v_x / jnp.where(piece.a_x == 0.0, 1.0, piece.a_x)
    of_end = jnp.where(follows == Follows.end, piece.duration, turning)
    moved = jnp.where(follows == Follows.place, then.x, of_end)
    slope = jnp.where(follows == Follows.place, -1.0 / then.v_x, 1.0)
    slope = jnp.where(follows == Follows.nothing, 0.0, slope)
    return found_by_search(moment.time, moved, slope)


def starts_of(chosen: Stretches) -> Moment:
    """Give the starts of stretches."""
    follows = np.where(chosen.start > 0.0, Follows.turn, Follows.nothing)
    return Moment(chosen.start, follows)


def stops_of(runs: Runs, chosen: Stretches) -> Moment:
    """Give the ends of stretches."""
    goes_on = chosen.stop < runs.pieces.duration[chosen.piece]
    return Moment(chosen.stop, np.where(goes_on, Follows.turn, Follows.end))

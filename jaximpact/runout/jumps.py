"""Jumps: flights, and the highest point of each above the ground.

The height of the centre over a segment is a quadratic in time, so that its largest
value stands at an end of the flight's part over that segment, or where its derivative
vanishes: exact, and no samples.
"""

from typing import NamedTuple

import numpy as np

from .record import Way
from .runs import Runs
from .stretches import pieces_at, state_after


class Jumps(NamedTuple):
    """Flights, arrays `(jumps,)`, trajectory after trajectory, in time."""

    trajectory: np.ndarray
    piece: np.ndarray
    """Its place among the pieces of the way."""
    after_contact: np.ndarray
    """False for the flight that a block was released in, or that begins at a convex
    break."""
    height: np.ndarray
    """Largest, of the centre above the ground below it [m]."""
    rise: np.ndarray
    """By how much that is more than at the start of the flight [m]."""


def jumps(runs: Runs) -> Jumps:
    """All flights of some trajectories."""
    profile, all_pieces = runs.profile, runs.pieces
    flights = np.flatnonzero(all_pieces.way == Way.flight)
    p = pieces_at(runs, flights)
    start = p.y - profile.height(p.x)
    end = state_after(p, p.duration)
    highest = np.maximum(start, end.y - profile.height(end.x))
    gradients = np.diff(profile.y) / np.diff(profile.x)
    for left, right, y, gradient in zip(
        profile.x[:-1], profile.x[1:], profile.y[:-1], gradients, strict=True
    ):
        # Of the flight over the whole line of the segment, then within its columns.
        summit = (p.v_y - gradient * p.v_x) / -p.a_y
        for time in (summit, _time_at(p, left), _time_at(p, right)):
            then = state_after(p, np.clip(time, 0.0, p.duration))
            over = (then.x >= left) & (then.x <= right)
            height = then.y - (y + gradient * (then.x - left))
            highest = np.where(over, np.maximum(highest, height), highest)
    before = np.maximum(flights - 1, 0)
    same = all_pieces.trajectory[before] == all_pieces.trajectory[flights]
    follows = all_pieces.way[before] == Way.contact
    return Jumps(
        trajectory=p.trajectory.astype(int),
        piece=flights,
        after_contact=same & follows & (before < flights),
        height=highest,
        rise=highest - start,
    )


def rise_before(runs: Runs, flights: Jumps) -> np.ndarray:
    """Rise of the flight that each contact ends [m], `(contacts,)`; NaN for one that
    ends no flight, or takes no time."""
    way = runs.pieces.way
    rise = np.full(len(way), np.nan)
    rise[flights.piece] = flights.rise
    # Pieces of contacts and contacts stand in the same order.
    places = np.flatnonzero(way == Way.contact)
    same = runs.pieces.trajectory[places - 1] == runs.pieces.trajectory[places]
    before = np.full(len(runs.contacts.time), np.nan)
    takes_time = runs.contacts.duration > 0.0
    before[takes_time] = np.where(same & (places > 0), rise[places - 1], np.nan)
    return before


def _time_at(p, x: float) -> np.ndarray:
    """When flights pass x; never is the start."""
    moves = p.v_x != 0.0
    return np.where(moves, (x - p.x) / np.where(moves, p.v_x, 1.0), 0.0)

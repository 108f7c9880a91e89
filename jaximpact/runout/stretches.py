r"""The way of the blocks in stretches along which x only grows, or only falls.

On a piece of the way $x(t) = x_0 + v t + a t^2/2$. A stretch is such a piece, or a part
of it up to where $v + at = 0$, or from there on. The velocity at a place X is
$w = \pm\sqrt{v^2 + 2a(X - x_0)}$ with the sign of the stretch, and the time there
$2(X - x_0)/(v + w)$ or $(w - v)/a$, whichever does not cancel.
"""

from typing import NamedTuple

import numpy as np

from .motion import Body
from .record import Pieces
from .runs import Runs


class Stretches(NamedTuple):
    """Arrays `(stretches,)`, trajectory after trajectory, in time."""

    piece: np.ndarray
    """Of which each is part."""
    start: np.ndarray
    """Since the start of the piece [s]."""
    stop: np.ndarray
    sign: np.ndarray
    """1 to the right, -1 to the left, 0 where x stays."""
    x_start: np.ndarray
    """[m]"""
    x_stop: np.ndarray


def stretches_of(runs: Runs) -> Stretches:
    """All stretches of some trajectories."""
    p = runs.pieces
    bends = p.a_x != 0.0
    turning = np.where(bends, -p.v_x / np.where(bends, p.a_x, 1.0), -1.0)
    turns = np.flatnonzero((turning > 0.0) & (turning < p.duration))
    piece = np.concatenate([np.arange(len(p.x)), turns])
    start = np.concatenate([np.zeros(len(p.x)), turning[turns]])
    stop = np.concatenate([p.duration, p.duration[turns]])
    stop[turns] = turning[turns]
    order = np.argsort(piece, kind="stable")
    piece, start, stop = piece[order], start[order], stop[order]
    p = pieces_at(runs, piece)
    middle = state_after(p, 0.5 * (start + stop))
    return Stretches(
        piece,
        start,
        stop,
        np.sign(middle.v_x),
        state_after(p, start).x,
        state_after(p, stop).x,
    )


def pieces_at(runs: Runs, places: np.ndarray) -> Pieces:
    """Some of the pieces of the way."""
    return Pieces(*(column[places] for column in runs.pieces))


def state_after(p: Pieces, time: np.ndarray) -> Body:
    """The block on pieces of its way, a time after the start of each [s]."""
    return Body(
        x=p.x + (p.v_x + 0.5 * p.a_x * time) * time,
        y=p.y + (p.v_y + 0.5 * p.a_y * time) * time,
        v_x=p.v_x + p.a_x * time,
        v_y=p.v_y + p.a_y * time,
        orientation=p.orientation
        + (p.angular_velocity + 0.5 * p.angular_acceleration * time) * time,
        angular_velocity=p.angular_velocity + p.angular_acceleration * time,
    )


def time_at(runs: Runs, chosen: Stretches, x: np.ndarray) -> np.ndarray:
    """When some stretches are at x, since the start of their pieces [s]; where they do
    not reach it, when they are nearest."""
    v, a = runs.pieces.v_x[chosen.piece], runs.pieces.a_x[chosen.piece]
    way = x - runs.pieces.x[chosen.piece]
    there = chosen.sign * np.sqrt(np.maximum(v**2 + 2.0 * a * way, 0.0))
    straight = chosen.sign * v >= 0.0
    total = np.where(v + there == 0.0, 1.0, v + there)
    turned = (there - v) / np.where(straight, 1.0, a)
    time = np.where(straight, 2.0 * way / total, turned)
    return np.clip(time, chosen.start, chosen.stop)


def take(stretches: Stretches, chosen: np.ndarray) -> Stretches:
    """Some of the stretches."""
    return Stretches(*(column[chosen] for column in stretches))

"""Hops: flights of blocks that leave the path of their centres for a moment.

A flight is followed if it comes higher above the path than a hop, or if a round block
ends it with an impact. One that is not followed is a part of rolling: the block goes on
along the path at its energy, and over the corners and edges below the hop without
noticing them.
"""

from typing import NamedTuple

import numpy as np

from ...scene import GRAVITY
from ..centre_path import LEFT_BEHIND, CentrePath, in_small_turns
from .riders import Riders

FIRST_LOOKAHEAD = 8
"""Number of elements that a search for the end of a hop evaluates first."""


class Hops(NamedTuple):
    """Hops, followed as flights or not; arrays `(blocks,)`."""

    flies: np.ndarray
    """True for a flight that is followed."""
    landing_x: np.ndarray
    """x at which one that is not comes back to the path [m]."""


def find_hops(
    path: CentrePath,
    riders: Riders,
    element: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
    n_x: np.ndarray,
    n_y: np.ndarray,
    squared: np.ndarray,
) -> Hops:
    """Find out which flights are followed, and where the others end.

    Args:
        element: elements at which blocks leave the path, `(blocks,)`.
        x, y: their centres there [m], x in the mirror for those that move to the left.
        n_x, n_y: normals there.
        squared: squared speeds there [m2/s2].
    """
    flies, landing_x = np.zeros(len(x), bool), x.copy()
    asking, width = np.arange(len(x)), FIRST_LOOKAHEAD
    here = element, x, y
    slope, along = -n_x / n_y, squared * n_y**2
    bend = 0.5 * GRAVITY / along
    while len(asking):
        h = riders.radius[asking]
        ahead = in_small_turns(path.ahead(*here, h, width), h)
        # Over each element the path is a straight line, the flight a parabola.
        one, two = ahead.start_x - x[asking, None], ahead.stop_x - x[asking, None]
        run = np.maximum(two - one, 0.0)
        rise = ahead.stop_y - ahead.start_y
        chord = np.sqrt(run**2 + rise**2)
        flat = run > 1e-12 * chord
        grade = np.where(flat, rise / np.where(flat, run, 1.0), 0.0)
        cos = np.where(flat, run / np.where(flat, chord, 1.0), 1.0)
        over, bends = slope[asking, None] - grade, bend[asking, None]
        base = ahead.start_y - y[asking, None] - grade * one
        top = np.clip(0.5 * over / bends, one, two)
        at_top, at_end = ((over - bends * at) * at - base for at in (top, two))
        high = cos * at_top >= riders.hop[asking, None]
        lands = at_end < -LEFT_BEHIND * h[:, None]
        root = np.sqrt(np.maximum(over**2 - 4.0 * bends * base, 0.0))
        landing = np.clip(0.5 * (over + root) / bends, one, two)
        closing = along[asking, None] * (root * cos) ** 2
        hard = closing >= riders.closing[asking, None] * cos
        hard &= riders.barrier[asking, None] == 0.0
        ends = ~ahead.exists & (ahead.next_element == ahead.element)
        decided = ends | (ahead.exists & (high | lands))
        rows, column = np.arange(len(asking)), np.argmax(decided, axis=1)
        followed = ends | high | hard
        flies[asking] = followed[rows, column]
        landing_x[asking] = x[asking] + landing[rows, column]
        open_yet = np.flatnonzero(~np.any(decided, axis=1))
        known = np.count_nonzero(ahead.exists[open_yet], axis=1)
        last = np.maximum(known - 1, 0)
        here = tuple(
            np.where(known > 0, after[open_yet, last], before[open_yet])
            for after, before in zip(
                (ahead.next_element, ahead.stop_x, ahead.stop_y), here, strict=True
            )
        )
        asking, width = asking[open_yet], 2 * width
    return Hops(flies, landing_x)

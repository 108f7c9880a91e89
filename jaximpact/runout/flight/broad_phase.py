"""Broad phase: which segments a block in flight can reach, and when at the earliest.

A block inside its circumscribed circle reaches a segment only while its centre is
within the circle's radius of the segment's column and no higher over the segment's
line: a parabola between two times, in closed form, for every segment of the profile.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...scene import GRAVITY
from ..blocks import Body
from ..lane_programs import Values
from ..terrain import Profile
from .narrow_phase import NEVER, Piece

FAR = Piece(1e9, 0.0, 2e9, 0.0)
"""Placeholder that is never reached, where a search watches fewer segments."""
FEWEST = 2
"""Least number of segments to watch: those at both sides of a break."""
AHEAD = 0.5
"""Fraction of its size that a block moves before it has to watch other segments."""


class Candidates(NamedTuple):
    """Segments that a search has to watch."""

    pieces: tuple[Piece, ...]
    """Ends of the segments, each an array `(lanes,)`."""
    segments: np.ndarray
    """Numbers of the segments, `(lanes, pieces)`; -1 where there is none."""
    until: np.ndarray
    """Time from which other segments might be reached [s], `(lanes,)`."""


def watched_segments(
    body: Body, largest: Values, profile: Profile
) -> Iterator[tuple[np.ndarray, Candidates]]:
    """Choose the segments that each lane has to watch to move by a good part of its
    size.

    Args:
        body, largest: as for `earliest`.

    Yields:
        Which of the lanes have to watch as many, bool `(lanes,)`, and their segments.
    """
    times = earliest(body, largest, profile)
    needed = _count_needed(body, largest, times)
    for count in np.unique(needed):
        chosen = needed == count
        yield chosen, _nearest_segments(times[chosen], count, profile)


def earliest(body: Body, largest: Values, profile: Profile) -> np.ndarray:
    """Compute times before which segments cannot be reached [s], `(lanes, segments)`.

    Args:
        body: blocks in flight, arrays `(lanes,)`.
        largest: radius of the circumscribed circle [m].
    """
    x, y, v_x, v_y = (np.asarray(value)[:, None] for value in body[:4])
    largest = np.asarray(largest)[:, None]
    slope = profile.slope
    sin, cos = np.sin(slope), np.cos(slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        first = (profile.x[:-1] - largest - x) / v_x
        last = (profile.x[1:] + largest - x) / v_x
    first, last = np.minimum(first, last), np.maximum(first, last)
    inside = (x >= profile.x[:-1] - largest) & (x <= profile.x[1:] + largest)
    still = v_x == 0.0
    first = np.where(still, np.where(inside, 0.0, NEVER), np.maximum(first, 0.0))
    last = np.where(still, np.where(inside, NEVER, -1.0), last)
    height = sin * (x - profile.x[:-1]) + cos * (y - profile.y[:-1]) - largest
    rise = sin * v_x + cos * v_y
    fall = GRAVITY * cos
    # Low enough before `down` and after `up`, or always.
    discriminant = rise**2 + 2.0 * fall * height
    root = np.sqrt(np.maximum(discriminant, 0.0))
    leaves, returns = (rise - root) / fall, (rise + root) / fall
    is_low = (discriminant <= 0.0) | (first <= leaves) | (first >= returns)
    times = np.where(is_low, first, returns)
    reached = times <= last
    # A little early, for rounding.
    return np.where(reached, np.maximum(times * (1.0 - 1e-12) - 1e-12, 0.0), NEVER)


def _count_needed(body: Body, largest: Values, times: np.ndarray) -> np.ndarray:
    """Count the segments that each lane has to watch: powers of two, so that few
    programs are compiled."""
    speed = np.abs(body.v_x) + np.abs(body.v_y) + np.sqrt(GRAVITY * largest)
    horizon = AHEAD * largest / speed
    in_reach = np.count_nonzero(times <= horizon[:, None], axis=1)
    needed = np.full(len(times), FEWEST)
    while np.any(short := needed <= in_reach):
        needed[short] *= 2
    return needed


def _nearest_segments(times: np.ndarray, count: int, profile: Profile) -> Candidates:
    """Choose the segments that can be reached first, at these times."""
    if count >= profile.segments:
        order = np.full((len(times), count), -1)
        order[:, : profile.segments] = np.arange(profile.segments)
        until = np.full(len(times), NEVER)
    else:
        nearest = np.argpartition(times, count, axis=1)
        until = np.take_along_axis(times, nearest[:, count : count + 1], axis=1)[:, 0]
        order = np.sort(nearest[:, :count], axis=1)
    pieces = []
    for segment in order.T:
        x, y, there = profile.x, profile.y, segment >= 0
        ends = x[segment], y[segment], x[segment + 1], y[segment + 1]
        pieces.append(
            Piece(*(np.where(there, a, b) for a, b in zip(ends, FAR, strict=True)))
        )
    return Candidates(tuple(pieces), order, until)

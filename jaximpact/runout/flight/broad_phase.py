"""Broad phase: which segments a block in flight can reach, and when at the earliest.

A block inside its circumscribed circle reaches a segment only while its centre is
within the circle's radius of the segment's column and no higher over the segment's
line: a parabola between two times, in closed form, for every segment of the profile.

That is for profiles of few segments, of which a block has to watch few. On all others
a search goes through the tree of covers: `ground_search`.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...scene import GRAVITY
from ..blocks import Body, select
from ..lane_programs import Values
from ..terrain import Profile
from .narrow_phase import NEVER, Piece

FAR = Piece(1e9, 0.0, 2e9, 0.0)
"""Placeholder that is never reached, where a search watches fewer segments."""
FEW = 64
"""Number of segments of a profile up to which all are looked at."""
WATCHED = 2, 4
"""Numbers of segments to watch: those at both sides of a break, or more. There is a
program for each, whose compilation takes longer the more they are."""
CACHED = 2**15
"""Number of lanes times segments at once, for which the processor's caches have
room."""
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
) -> Iterator[tuple[np.ndarray, Candidates | None]]:
    """Choose the segments that each lane has to watch to move by a good part of its
    size.

    Args:
        body, largest: as for `earliest`.

    Yields:
        Which of the lanes have to watch as many, bool `(lanes,)`, and their segments;
        None for lanes that have too many to watch.
    """
    if profile.segments > FEW:
        yield np.ones(len(body.x), bool), None
        return
    times = earliest(body, largest, profile)
    in_reach = _count_in_reach(body, largest, times)
    fewest = 0
    for count in WATCHED:
        chosen = (in_reach >= fewest) & (in_reach < count)
        if np.any(chosen):
            yield chosen, _nearest_segments(times[chosen], count, profile)
        fewest = count
    if np.any(chosen := in_reach >= fewest):
        yield chosen, None


def earliest(body: Body, largest: Values, profile: Profile) -> np.ndarray:
    """Compute times before which segments cannot be reached [s], `(lanes, segments)`.

    Args:
        body: blocks in flight, arrays `(lanes,)`.
        largest: radius of the circumscribed circle [m].
    """
    lanes = max(1, CACHED // profile.segments)
    starts = range(0, len(body.x), lanes)
    parts = (slice(start, start + lanes) for start in starts)
    times = [_earliest(select(body, part), largest[part], profile) for part in parts]
    return np.concatenate(times)


def _earliest(body: Body, largest: Values, profile: Profile) -> np.ndarray:
    x, y, v_x, v_y = (np.asarray(value)[:, None] for value in body[:4])
    largest = np.asarray(largest)[:, None]
    sin, cos = profile.normal
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


def _count_in_reach(body: Body, largest: Values, times: np.ndarray) -> np.ndarray:
    """Count the segments that each lane can reach before it has moved by a good part of
    its size."""
    speed = np.abs(body.v_x) + np.abs(body.v_y) + np.sqrt(GRAVITY * largest)
    horizon = AHEAD * largest / speed
    return np.count_nonzero(times <= horizon[:, None], axis=1)


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

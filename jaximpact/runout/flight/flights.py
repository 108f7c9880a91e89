"""Flights to their ends: a contact, an end of the profile, or the limit of time.

Broad phase: which segments a block in flight can reach, and when at the earliest. A
block inside its circumscribed circle reaches a segment only while its centre is within
the circle's radius of the segment's column and no higher over the segment's line: a
parabola between two times, in closed form, for every segment of the profile. That is
for profiles of few segments, of which a block has to watch few. On all others a search
goes through the tree of covers: `ground_search`.
"""

from collections.abc import Iterator
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...backend.simd.tables import address_of
from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, fly, select
from ..lane_programs import Values, closed_form
from ..state import NONE, BlockState, Phase, RunState
from ..terrain import Profile
from ..trajectory import Ending, MotionMode, Pieces
from .ground_search import first_contact
from .narrow_phase import NEVER, Piece
from .time_of_impact import search

FEW = 64
"""Number of segments of a profile up to which all are looked at."""


class NearSegments(NamedTuple):
    """Segments that a search has to watch."""

    pieces: tuple[Piece, ...]  # ends of the segments, each an array `(lanes,)`
    segments: np.ndarray  # numbers, `(lanes, pieces)`; -1 for none
    until: np.ndarray  # time from which other segments might be reached [s], `(lanes,)`


def watched_segments(
    body: Body, largest: Values, profile: Profile
) -> Iterator[tuple[np.ndarray, NearSegments | None]]:
    """Choose the segments that each lane has to watch to move by a good part of its
    size.

    Yields:
        Which of the lanes have to watch as many, bool `(lanes,)`, and their segments;
        None for lanes that have too many to watch.
    """
    if profile.segments > FEW:
        yield np.ones(len(body.x), bool), None
        return
    times = earliest(body, largest, profile)
    # Until it has moved by half its size.
    speed = np.abs(body.v_x) + np.abs(body.v_y) + np.sqrt(GRAVITY * largest)
    horizon = 0.5 * largest / speed
    in_reach = np.count_nonzero(times <= horizon[:, None], axis=1)
    fewest = 0
    # The segments at both sides of a break, or more. There is a program for each
    # number, whose compilation takes longer the more they are.
    for count in (2, 4):
        chosen = (in_reach >= fewest) & (in_reach < count)
        if np.any(chosen):
            yield chosen, _nearest_segments(times[chosen], count, profile)
        fewest = count
    if np.any(chosen := in_reach >= fewest):
        yield chosen, None


def earliest(body: Body, largest: Values, profile: Profile) -> np.ndarray:
    """Compute times before which blocks in flight cannot reach segments [s], `(lanes,
    segments)`, given the radii of their circumscribed circles [m]."""
    # As many lanes at once as the processor's caches have room for.
    lanes = max(1, 2**15 // profile.segments)
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


def _nearest_segments(times: np.ndarray, count: int, profile: Profile) -> NearSegments:
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
    never_reached = 1e9, 0.0, 2e9, 0.0
    for segment in order.T:
        x, y, there = profile.x, profile.y, segment >= 0
        ends = x[segment], y[segment], x[segment + 1], y[segment + 1]
        ends = zip(ends, never_reached, strict=True)
        pieces.append(Piece(*(np.where(there, a, b) for a, b in ends)))
    return NearSegments(tuple(pieces), order, until)


class FlightEnd(NamedTuple):
    """End of a flight, as the search finds it; of many, arrays `(lanes,)`. In programs
    truths are 1 and 0."""

    time: Values  # duration of the flight [s]
    touched: Values  # true where the block touches the ground
    left: Values  # true where the centre passes an end of the profile
    failed: Values  # true where the search was given up
    segment: Values  # number of the segment touched, else -1
    normal_x: Values  # normal out of the ground at the contact; 0 for none
    normal_y: Values
    gap: Values  # at the contact [m]; negative for a start in the ground


@closed_form
def land(block: BlockState, end: FlightEnd) -> tuple[BlockState, Pieces]:
    """End a flight: the block touches the ground, or has ended. Gives the block, and
    the flight."""
    body, touched = block.body, end.touched > 0.0
    flight = Pieces(
        0.0, MotionMode.flight, block.time, end.time, *body[:4], 0.0, -GRAVITY,
        *body[4:], 0.0,
    )  # fmt: skip
    ending = jnp.where(end.left > 0.0, Ending.left_profile, Ending.time_limit)
    ending = jnp.where(end.failed > 0.0, Ending.failed, ending)
    landed = block._replace(
        time=block.time + end.time,
        body=fly(body, end.time),
        phase=jnp.where(touched, float(Phase.touching), float(Phase.ended)),
        ending=jnp.where(touched, NONE, ending),
        segment=end.segment,
        normal_x=end.normal_x,
        normal_y=end.normal_y,
        gap=end.gap,
    )
    return landed, flight


def follow_flights(
    body: Body, outline: BlockOutline, profile: Profile, time_limit: np.ndarray
) -> FlightEnd:
    """Find where flights end, of time limits [s], arrays `(lanes,)`.

    A flight that ends neither in a contact nor at an end of the profile, nor fails, has
    come to the limit. A lane's end does not depend on the other lanes.
    """
    count = len(body.x)
    ends = FlightEnd(
        time=np.zeros(count),
        touched=np.zeros(count, bool),
        left=np.zeros(count, bool),
        failed=np.zeros(count, bool),
        segment=np.full(count, -1),
        normal_x=np.zeros(count),
        normal_y=np.zeros(count),
        gap=np.zeros(count),
    )
    leaving = _time_to_leave(body, profile)
    limit = np.minimum(leaving, time_limit)
    going = np.arange(count)
    # Searches, each with other segments, after which a flight is given up.
    for _ in range(100_000):
        if not len(going):
            break
        now = fly(select(body, going), ends.time[going])
        for chosen, watched in watched_segments(now, outline.largest[going], profile):
            lanes, flying = going[chosen], select(now, chosen)
            _search(ends, lanes, flying, outline, profile, watched, limit)
        going = going[~(ends.touched | ends.failed)[going] & (ends.time < limit)[going]]
    ends.failed[going] = True
    free = ~(ends.touched | ends.failed)
    return ends._replace(left=free & (leaving <= time_limit))


def _time_to_leave(body: Body, profile: Profile) -> np.ndarray:
    """Compute when the centre passes an end of the profile [s]; inf for never."""
    right = np.asarray(body.v_x) > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        time = (np.where(right, profile.x[-1], profile.x[0]) - body.x) / body.v_x
    return np.where(np.asarray(body.v_x) == 0.0, np.inf, np.maximum(time, 0.0))


def _search(
    ends: FlightEnd,
    lanes: np.ndarray,
    now: Body,
    outline: BlockOutline,
    profile: Profile,
    watched: NearSegments | None,
    limit: np.ndarray,
) -> None:
    """Advance some flights, as far as the segments that they watch allow; without
    those, to their ends."""
    left = limit[lanes] - ends.time[lanes]
    size = np.maximum(np.abs(now.y), profile.size)
    outline = select(outline, lanes)
    if watched is None:
        # A name of its own, so that the table lives as long as the search.
        until, covers = left, profile.covers
        contact = first_contact(now, outline, address_of(covers), size, until)
        segments = contact.number.astype(int)
    else:
        until = np.minimum(watched.until, left)
        contact = search(now, outline, watched.pieces, size, until)
        place = contact.number.astype(int)
        segments = watched.segments[np.arange(len(lanes)), place]
    touched = contact.touched > 0.0
    ends.failed[lanes] = contact.given_up > 0.0
    # Where the search came to its limit, time must come to it too.
    to_limit = ~touched & (until == left) & (contact.time >= until)
    ends.time[lanes] = np.where(to_limit, limit[lanes], ends.time[lanes] + contact.time)
    ends.touched[lanes] = touched
    ends.segment[lanes] = np.where(touched, segments, -1)
    ends.normal_x[lanes] = np.where(touched, contact.normal_x, 0.0)
    ends.normal_y[lanes] = np.where(touched, contact.normal_y, 0.0)
    ends.gap[lanes] = np.where(touched, contact.gap, 0.0)


def fly_on(state: RunState, lanes: np.ndarray) -> None:
    """Advance blocks in the air to the ends of their flights."""
    blocks, outline = select((state.blocks, state.constants.outline), lanes)
    left = np.maximum(state.limits.time - blocks.time, 0.0)
    after, flight = land(
        blocks, follow_flights(blocks.body, outline, state.profile, left)
    )
    state.move(lanes, after, flight)

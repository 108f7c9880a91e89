"""Flights to their ends: a contact, an end of the profile, or the limit of time."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...backend.simd.tables import address_of
from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, fly, select
from ..lane_programs import Values, closed_form
from ..state import UNDER_WAY, BlockState, Phase, State
from ..terrain import Profile
from ..trajectory import Ending, MotionMode, Pieces
from .broad_phase import Candidates, watched_segments
from .ground_search import first_contact
from .time_of_impact import search


class FlightEnd(NamedTuple):
    """End of a flight, as the search finds it; of many, arrays `(lanes,)`. In programs
    truths are 1 and 0."""

    time: Values
    """Duration of the flight [s]."""
    touched: Values
    """True where the block touches the ground."""
    left: Values
    """True where the centre passes an end of the profile."""
    failed: Values
    """True where the search was given up."""
    segment: Values
    """Number of the segment touched, else -1."""
    normal_x: Values
    """Normal out of the ground at the contact; 0 for none."""
    normal_y: Values
    gap: Values
    """Gap at the contact [m]; negative where the block started in the ground."""


@closed_form
def land(block: BlockState, end: FlightEnd) -> tuple[BlockState, Pieces]:
    """End a flight: the block touches the ground, or has ended.

    Returns:
        The block, and the flight.
    """
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
        ending=jnp.where(touched, UNDER_WAY, ending),
        segment=end.segment,
        normal_x=end.normal_x,
        normal_y=end.normal_y,
        gap=end.gap,
    )
    return landed, flight


TURNS = 100_000
"""Number of searches, each with other segments, after which a flight is given up."""


def follow_flights(
    body: Body, outline: BlockOutline, profile: Profile, time_limit: np.ndarray
) -> FlightEnd:
    """Find where flights end.

    Args:
        body, outline: blocks at the start, arrays `(lanes,)`.
        profile: the ground.
        time_limit: longest flight to follow [s], `(lanes,)`.

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
    for _ in range(TURNS):
        if not len(going):
            break
        now = fly(select(body, going), ends.time[going])
        for chosen, watched in watched_segments(now, outline.largest[going], profile):
            lanes, some = going[chosen], select(now, chosen)
            _search(ends, lanes, some, outline, profile, watched, limit)
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
    watched: Candidates | None,
    limit: np.ndarray,
) -> None:
    """Advance some flights, as far as the segments that they watch allow; without
    those, to their ends."""
    left = limit[lanes] - ends.time[lanes]
    size = np.maximum(np.abs(now.y), profile.size)
    own = select(outline, lanes)
    if watched is None:
        # A name of its own, so that the table lives as long as the search.
        until, covers = left, profile.covers
        found = first_contact(now, own, address_of(covers), size, until)
        segments = found.segment.astype(int)
    else:
        until = np.minimum(watched.until, left)
        found = search(now, own, watched.pieces, size, until)
        place = found.piece.astype(int)
        segments = watched.segments[np.arange(len(lanes)), place]
    touched = found.touched > 0.0
    ends.failed[lanes] = found.given_up > 0.0
    # Where the search came to its limit, time must come to it too.
    to_limit = ~touched & (until == left) & (found.time >= until)
    ends.time[lanes] = np.where(to_limit, limit[lanes], ends.time[lanes] + found.time)
    ends.touched[lanes] = touched
    ends.segment[lanes] = np.where(touched, segments, -1)
    ends.normal_x[lanes] = np.where(touched, found.normal_x, 0.0)
    ends.normal_y[lanes] = np.where(touched, found.normal_y, 0.0)
    ends.gap[lanes] = np.where(touched, found.gap, 0.0)


def fly_on(state: State, lanes: np.ndarray) -> None:
    """Advance blocks in the air to the ends of their flights."""
    blocks, outline = select((state.blocks, state.constants.outline), lanes)
    left = np.maximum(state.limits.time - blocks.time, 0.0)
    after, flight = land(
        blocks, follow_flights(blocks.body, outline, state.profile, left)
    )
    state.move(lanes, after, flight)

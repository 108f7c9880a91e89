r"""Flights to their ends: a contact, an end of the profile, or the limit of time.

A flight that ends in a contact ends at the first zero of the gap $g(t, p)$ between
block and ground, which a search finds, so that its time changes with a parameter p by

$$ \frac{dt}{dp} = -\frac{\partial g/\partial p}{\partial g/\partial t}. $$

At a corner of the ground the gap is that along the block's normal there, which turns as
the block does. A block that touches as it starts, as in a corner after it was set back
on one side of it, touches at once for other parameters too: its gap changes, its time
does not. Derivatives are NaN where a flight failed, and where a block that started in
the ground touches later: its depth is left to the search.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...backend.simd.tables import address_of
from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, fly, select
from ..lane_programs import Values, call, closed_form, found_by_search
from ..state import UNDER_WAY, BlockState, Limits, Phase, State
from ..terrain import SAME_PLANE, Profile
from ..trajectory import Ending, MotionMode, Pieces
from .broad_phase import Candidates, watched_segments
from .ground_search import first_contact
from .narrow_phase import Gap, gap_along, normal_through
from .time_of_impact import search

IN_THE_GROUND = 1e-8
"""Fraction of the larger semi-axis beyond which a block that touches has started in the
ground."""


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


class Surroundings(NamedTuple):
    """Ground at the end of a flight, as for `FlightEnd`."""

    at_corner: Values
    """True where the block touches a point of the profile by a leaning plane."""
    point_x: Values
    """A point of what it touches [m]."""
    point_y: Values
    border: Values
    """x of the end of the profile towards which it flies [m]."""


@closed_form
def land(
    block: BlockState,
    outline: BlockOutline,
    end: FlightEnd,
    around: Surroundings,
    limits: Limits,
) -> tuple[BlockState, Pieces]:
    """End a flight: the block touches the ground, or has ended.

    Returns:
        The block, and the flight.
    """
    body, touched = block.body, end.touched > 0.0
    time, gap = _time_and_gap(block, outline, end, around, limits)
    after = fly(body, time)
    normal_x, normal_y = _normal(after, outline, end, around)
    flight = Pieces(
        0.0, MotionMode.flight, block.time, time, body.x, body.y, body.v_x, body.v_y,
        0.0, -GRAVITY, body.orientation, body.angular_velocity, 0.0,
    )  # fmt: skip
    ending = jnp.where(end.left > 0.0, Ending.left_profile, Ending.time_limit)
    ending = jnp.where(end.failed > 0.0, Ending.failed, ending)
    landed = block._replace(
        time=block.time + time,
        body=after,
        phase=jnp.where(touched, float(Phase.touching), float(Phase.ended)),
        ending=jnp.where(touched, UNDER_WAY, ending),
        segment=end.segment,
        normal_x=found_by_search(end.normal_x, normal_x),
        normal_y=found_by_search(end.normal_y, normal_y),
        gap=gap,
    )
    return landed, flight


def _time_and_gap(
    block: BlockState,
    outline: BlockOutline,
    end: FlightEnd,
    around: Surroundings,
    limits: Limits,
) -> tuple[Values, Values]:
    """Give time and gap of the contact as they were found, with their derivatives."""
    body, touched = block.body, end.touched > 0.0
    at_end = fly(body, end.time)
    here = _gap(at_end, outline, end, around)
    at_once = touched & (end.time == 0.0)
    leaving = jnp.maximum((around.border - body.x) / body.v_x, 0.0)
    left = jnp.maximum(limits.time - block.time, 0.0)
    moved = jnp.where(touched, here.width, jnp.where(end.left > 0.0, leaving, left))
    slope = jnp.where(touched, jnp.where(at_once, 0.0, -1.0 / here.opening), 1.0)
    slope = jnp.where(end.failed > 0.0, jnp.nan, slope)
    was_in = jnp.abs(end.gap) > IN_THE_GROUND * outline.largest
    of_gap = jnp.where(at_once, 1.0, jnp.where(was_in, jnp.nan, 0.0))
    return (
        found_by_search(end.time, moved, slope),
        found_by_search(end.gap, here.width, of_gap),
    )


def _normal(
    body: Body, outline: BlockOutline, end: FlightEnd, around: Surroundings
) -> tuple[Values, Values]:
    """Compute the normal of the plane that a block touches."""
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    point = around.point_x, around.point_y
    n_x, n_y = normal_through(body, outline, axis, point)
    at_corner = around.at_corner > 0.0
    return (
        jnp.where(at_corner, n_x, end.normal_x),
        jnp.where(at_corner, n_y, end.normal_y),
    )


def _gap(
    body: Body, outline: BlockOutline, end: FlightEnd, around: Surroundings
) -> Gap:
    """Compute the gap to what the block touches, as it is to go on with its normal."""
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    point = around.point_x, around.point_y
    has_faces = outline.shape.largest_bending(outline.axes) is None
    # On a flat face the lowest point is the ground's point that it touches.
    touches = around.at_corner > 0.0 if has_faces else None
    normal = _normal(body, outline, end, around)
    return gap_along(body, outline, axis, normal, point, touches)


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
    blocks, outline = state.blocks.at(lanes), state.constants.part("outline").at(lanes)
    body = blocks.value.body
    left = np.maximum(state.limits.time - blocks.value.time, 0.0)
    end = follow_flights(body, outline.value, state.profile, left)
    around = _surroundings(end, body, state.profile)
    landed = call(land, blocks, outline, end, around, state.limits)
    after, flight = landed.split()
    state.move(lanes, after, flight)


def _surroundings(end: FlightEnd, body: Body, profile: Profile) -> Surroundings:
    """Find what of the profile flights end at."""
    slope = profile.slope[end.segment]
    between = end.normal_x * np.cos(slope) - end.normal_y * np.sin(slope)
    leans = end.touched & (np.abs(between) > SAME_PLANE) & (end.normal_y > 0.0)
    # Planes at the left end of a segment lean to the left of it.
    point = np.where(leans & (between > 0.0), end.segment + 1, end.segment)
    return Surroundings(
        at_corner=leans,
        point_x=profile.x[point],
        point_y=profile.y[point],
        border=np.where(body.v_x > 0.0, profile.x[-1], profile.x[0]),
    )

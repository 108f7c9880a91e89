"""Flights to their ends: a contact, an end of the profile, or the limit of time."""

import dataclasses

import jax.numpy as jnp
import numpy as np

from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, fly, select, support_of
from ..dual import Dual, Values, as_dual, primal, tangent_count
from ..lane_programs import closed_form
from ..state import Phase, State
from ..terrain import SAME_PLANE, Profile
from ..trajectory import Ending, MotionMode
from .broad_phase import count_needed, earliest, nearest_segments
from .narrow_phase import normal_through
from .time_of_impact import search

TURNS = 100_000
"""Number of searches, each with other segments, after which a flight is given up."""
IN_THE_GROUND = 1e-8
"""Fraction of the larger semi-axis beyond which a block that touches has started in the
ground."""


@dataclasses.dataclass
class FlightEnds:
    """Ends of flights; arrays `(lanes,)`."""

    time: Values
    """Duration of the flight [s]."""
    touched: np.ndarray
    """True where the block touches the ground."""
    left: np.ndarray
    """True where the centre passes an end of the profile."""
    failed: np.ndarray
    """True where the search was given up."""
    segment: np.ndarray
    """Number of the segment touched, else -1."""
    normal: Values
    """Normal out of the ground at the contact, x and y, `(2, lanes)`."""
    gap: Values
    """Gap at the contact [m]; negative where the block started in the ground."""


def follow_flights(
    body: Body, outline: BlockOutline, profile: Profile, time_limit: np.ndarray
) -> FlightEnds:
    """Find where flights end.

    Args:
        body, outline: blocks at the start, arrays `(lanes,)`.
        profile: the ground.
        time_limit: longest flight to follow [s], `(lanes,)`.

    A flight that ends neither in a contact nor at an end of the profile, nor fails, has
    come to the limit. A lane's end does not depend on the other lanes.
    """
    lanes = len(body.x)
    ends = FlightEnds(
        time=np.zeros(lanes),
        touched=np.zeros(lanes, bool),
        left=np.zeros(lanes, bool),
        failed=np.zeros(lanes, bool),
        segment=np.full(lanes, -1),
        normal=np.zeros((2, lanes)),
        gap=np.zeros(lanes),
    )
    largest = outline.largest
    leaving = _time_to_leave(body, profile)
    limit = np.minimum(leaving, time_limit)
    going = np.arange(lanes)
    for _ in range(TURNS):
        if not len(going):
            break
        now = fly(select(body, going), ends.time[going])
        times = earliest(now, largest[going], profile)
        needed = count_needed(now, largest[going], times)
        for count in np.unique(needed):
            chosen = needed == count
            _search(
                ends,
                going[chosen],
                select(now, chosen),
                outline,
                profile,
                times[chosen],
                count,
                limit,
            )
        going = going[~(ends.touched | ends.failed)[going] & (ends.time < limit)[going]]
    ends.failed[going] = True
    free = ~(ends.touched | ends.failed)
    ends.left = free & (leaving <= time_limit)
    return ends


def _time_to_leave(body: Body, profile: Profile) -> np.ndarray:
    """Compute when the centre passes an end of the profile [s]; inf for never."""
    right = np.asarray(body.v_x) > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        time = (np.where(right, profile.x[-1], profile.x[0]) - body.x) / body.v_x
    return np.where(np.asarray(body.v_x) == 0.0, np.inf, np.maximum(time, 0.0))


def _search(
    ends: FlightEnds,
    lanes: np.ndarray,
    now: Body,
    outline: BlockOutline,
    profile: Profile,
    times: np.ndarray,
    count: int,
    limit: np.ndarray,
) -> None:
    """Advance some flights, as far as the given number of segments allows."""
    watched = nearest_segments(times, count, profile)
    left = limit[lanes] - ends.time[lanes]
    until = np.minimum(watched.until, left)
    size = np.maximum(
        np.max(np.abs(profile.x)), np.maximum(np.abs(now.y), np.max(np.abs(profile.y)))
    )
    found = search(now, select(outline, lanes), watched.pieces, size, until)
    touched = found.touched > 0.0
    ends.failed[lanes] = found.given_up > 0.0
    # Where the search came to its limit, time must come to it too.
    to_limit = ~touched & (until == left) & (found.time >= until)
    ends.time[lanes] = np.where(to_limit, limit[lanes], ends.time[lanes] + found.time)
    ends.touched[lanes] = touched
    place = found.piece.astype(int)
    segments = watched.segments[np.arange(len(lanes)), place]
    ends.segment[lanes] = np.where(touched, segments, -1)
    ends.normal[:, lanes] = np.where(touched, [found.normal_x, found.normal_y], 0.0)
    ends.gap[lanes] = np.where(touched, found.gap, 0.0)


def fly_on(state: State, lanes: np.ndarray) -> None:
    """Advance blocks in the air to the ends of their flights."""
    body, outline = select(state.body, lanes), select(state.outline, lanes)
    left = np.maximum(state.limits.time - state.time[lanes], 0.0)
    parameters = tangent_count(body)
    ends = follow_flights(primal(body), primal(outline), state.profile, primal(left))
    if parameters:
        ends = differentiate_ends(ends, body, outline, state.profile, left, parameters)
    state.pieces.add(
        lanes, MotionMode.flight, state.time[lanes], ends.time,
        *(body.x, body.y, body.v_x, body.v_y, 0.0, -GRAVITY),
        *(body.orientation, body.angular_velocity, 0.0),
    )  # fmt: skip
    state.set_body(lanes, **fly(body, ends.time)._asdict())
    state.time[lanes] += ends.time
    state.phase[lanes] = Phase.touching
    state.segment[lanes] = ends.segment
    state.normal[:, lanes] = ends.normal
    state.gap[lanes] = ends.gap
    state.end(lanes[~ends.touched], Ending.time_limit)
    state.end(lanes[ends.left], Ending.left_profile)
    state.end(lanes[ends.failed], Ending.failed)


def differentiate_ends(
    ends: FlightEnds,
    body: Body,
    outline: BlockOutline,
    profile: Profile,
    time_limit: np.ndarray,
    parameters: int,
) -> FlightEnds:
    r"""Add the derivatives of times, normals and gaps to the ends of flights.

    A flight ends at the first zero of the gap $g(t, p)$ between block and ground, so
    that its time changes with a parameter p by

    $$ \frac{dt}{dp} = -\frac{\partial g/\partial p}{\partial g/\partial t}. $$

    At a corner of the ground the gap is that along the block's normal there, which
    turns as the block does.

    A block that touches as it starts, as in a corner after it was set back on one side
    of it, touches at once for other parameters too: its gap changes, its time does not.
    Derivatives are NaN where a flight failed, and where a block that started in the
    ground touches later: its depth is left to the search.

    Args:
        ends: result of `follow_flights`.
        body, outline, profile, time_limit: as there; some of them carry derivatives.
        parameters: number of parameters.
    """
    body = Body(*(as_dual(value, parameters) for value in body))
    corner, point_x, point_y = _points(ends, profile)

    def normals(of: Body) -> Dual:
        """Compute the normals of the planes that blocks touch."""
        normal = as_dual(ends.normal, parameters)
        if len(corner):
            normal[:, corner] = _normal_at(
                *(select(of, corner), select(outline, corner)),
                *(point_x[corner], point_y[corner]),
            )
        return normal

    at_end = fly(body, ends.time)
    n_x, n_y = normals(at_end)
    lowest = support_of(outline, at_end.orientation - np.arctan2(n_x, n_y))
    width = n_x * (at_end.x - point_x) + n_y * (at_end.y - point_y) - lowest.radius
    arm = primal(lowest.arm)
    if primal(outline.shape).largest_bending(primal(outline.axes)) is None:
        # On a flat face the lowest point is the ground's point that it touches.
        d_x, d_y = point_x - primal(at_end.x), point_y - primal(at_end.y)
        of_point = primal(n_y) * d_x - primal(n_x) * d_y
        arm[corner] = of_point[corner]
    opening = n_x * at_end.v_x + n_y * at_end.v_y - arm * body.angular_velocity
    at_once = ends.touched & (ends.time == 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        of_touch = np.where(at_once, 0.0, -width.tangent / opening.value)
        border = np.where(body.v_x.value > 0.0, profile.x[-1], profile.x[0])
        of_leaving = np.maximum((border - body.x) / body.v_x, 0.0).tangent
    of_limit = as_dual(time_limit, parameters).tangent
    tangent = np.where(ends.left, of_leaving, of_limit)
    tangent = np.where(ends.touched, of_touch, tangent)
    tangent = np.where(ends.failed, np.nan, tangent)
    time = Dual(ends.time, tangent)
    was_in = np.abs(ends.gap) > IN_THE_GROUND * primal(outline.largest)
    of_gap = np.where(was_in, np.nan, np.zeros_like(tangent))
    gap = Dual(ends.gap, np.where(at_once, width.tangent, of_gap))
    normal = normals(fly(body, time))
    return FlightEnds(
        time, ends.touched, ends.left, ends.failed, ends.segment, normal, gap
    )


def _points(ends: FlightEnds, profile: Profile):
    """Find the lanes that touch a point of the profile by a leaning plane; and for each
    lane a point of what it touches."""
    slope, (n_x, n_y) = profile.slope[ends.segment], ends.normal
    between = n_x * np.cos(slope) - n_y * np.sin(slope)
    leans = ends.touched & (np.abs(between) > SAME_PLANE) & (n_y > 0.0)
    # Planes at the left end of a segment lean to the left of it.
    point = np.where(leans & (between > 0.0), ends.segment + 1, ends.segment)
    return np.flatnonzero(leans), profile.x[point], profile.y[point]


@closed_form
def _normal_at(body: Body, outline: BlockOutline, point_x, point_y):
    """Compute the inward normal of a block at a point of its outline, x and y."""
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    return normal_through(body, outline, axis, (point_x, point_y))

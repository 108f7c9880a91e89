"""Flights to their ends: a contact, an end of the profile, or the limit of time."""

import numpy as np

from ..blocks import BlockOutline, Body, fly, select
from ..state import State
from ..tangents import call
from ..terrain import SAME_PLANE, Profile
from .broad_phase import count_needed, earliest, nearest_segments
from .landing import FlightEnd, Surroundings, land
from .time_of_impact import search

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
    lanes = len(body.x)
    ends = FlightEnd(
        time=np.zeros(lanes),
        touched=np.zeros(lanes, bool),
        left=np.zeros(lanes, bool),
        failed=np.zeros(lanes, bool),
        segment=np.full(lanes, -1),
        normal_x=np.zeros(lanes),
        normal_y=np.zeros(lanes),
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
    state.blocks.put(lanes, after)
    state.pieces.add(lanes, flight)


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

"""Flights to their ends: a contact, an end of the profile, or the limit of time."""

import dataclasses

import numpy as np

from .contact_search import search
from .motion import Body, Outline, fly, take
from .profile import Profile
from .reach import earliest, pieces_needed, reach

TURNS = 100_000
"""Times that a flight's search may be taken up again with other pieces."""


@dataclasses.dataclass
class FlightEnds:
    """How flights end; arrays `(lanes,)`."""

    time: np.ndarray
    """Of the end, from the start of the flight [s]."""
    touched: np.ndarray
    """True where the block touches the ground."""
    left: np.ndarray
    """True where its centre passes an end of the profile."""
    failed: np.ndarray
    """True where the search was given up."""
    segment: np.ndarray
    """The segment touched, else -1."""
    normal: np.ndarray
    """Out of the ground at the contact, x and y, `(2, lanes)`."""
    gap: np.ndarray
    """At the contact [m]; negative where the block was in the ground from the start."""


def follow_flights(
    body: Body, outline: Outline, profile: Profile, time_limit: np.ndarray
) -> FlightEnds:
    """Where flights end.

    Args:
        body: at the start, arrays `(lanes,)`.
        outline: likewise.
        profile: the ground.
        time_limit: longest flight to be followed [s], `(lanes,)`.

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
        now = fly(take(body, going), ends.time[going])
        times = earliest(now, largest[going], profile)
        needed = pieces_needed(now, largest[going], times)
        for count in np.unique(needed):
            chosen = needed == count
            _search(
                ends,
                going[chosen],
                take(now, chosen),
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
    """When the centre passes an end of the profile [s]; inf where it never does."""
    right = np.asarray(body.v_x) > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        time = (np.where(right, profile.x[-1], profile.x[0]) - body.x) / body.v_x
    return np.where(np.asarray(body.v_x) == 0.0, np.inf, np.maximum(time, 0.0))


def _search(
    ends: FlightEnds,
    lanes: np.ndarray,
    now: Body,
    outline: Outline,
    profile: Profile,
    times: np.ndarray,
    count: int,
    limit: np.ndarray,
) -> None:
    """Take some flights on, as far as so many pieces of the ground allow."""
    watched = reach(times, count, profile)
    left = limit[lanes] - ends.time[lanes]
    until = np.minimum(watched.until, left)
    size = np.maximum(
        np.max(np.abs(profile.x)), np.maximum(np.abs(now.y), np.max(np.abs(profile.y)))
    )
    found = search(now, take(outline, lanes), watched.pieces, size, until)
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

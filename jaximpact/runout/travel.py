"""How far a block gets along the plane that it strikes, before other ground is in its
way."""

import numpy as np

from .dual import plain
from .motion import Body, Outline, take
from .motion import support_of as support
from .profile import Profile

IN_THE_GROUND = 1e-6
"""Depth of a block in a segment, by its smaller semi-axis, from which on that segment
is behind or above it."""


def free_share(
    profile: Profile,
    segment: np.ndarray,
    body: Body,
    outline: Outline,
    x: np.ndarray,
    y: np.ndarray,
    orientation: np.ndarray,
    travel: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    """Share of its travel during a contact that a block can make, in [0, 1].

    It ends where the block comes to the line of another segment, which is before it
    comes to the segment. Arrays `(lanes,)`; plain numbers, without derivatives: those
    of a block that is held up are left to the comparison with differences.

    Args:
        segment: that is struck, which is not in the way.
        body, outline: the block at touch.
        x, y, orientation: of the block after the contact, without its travel.
        travel: along x and y [m].
    """
    body, outline, x, y, orientation, (d_x, d_y) = plain(
        (body, outline, x, y, orientation, travel)
    )
    largest, smallest = outline.largest, outline.smallest
    way = np.where(d_x > 0.0, 1, -1)
    share = np.ones(len(x))
    normal_x, normal_y = np.sin(profile.slope), np.cos(profile.slope)
    place, lanes = segment + way, np.arange(len(x))
    while True:
        inside = (place >= 0) & (place < profile.segments)
        place, lanes = place[inside], lanes[inside]
        near = profile.x[np.where(way[lanes] > 0, place, place + 1)]
        reached = way[lanes] * (near - x[lanes] - d_x[lanes]) < largest[lanes]
        place, lanes = place[reached], lanes[reached]
        if not len(lanes):
            return share
        n_x, n_y, slope = normal_x[place], normal_y[place], profile.slope[place]
        some = take(outline, lanes)

        def gap(at_x, at_y, theta):
            reach = support(some, theta[lanes] - slope).radius  # noqa: B023
            height = n_x * (at_x[lanes] - profile.x[place])  # noqa: B023
            height += n_y * (at_y[lanes] - profile.y[place])  # noqa: B023
            return height - reach

        clear = gap(body.x, body.y, body.orientation)
        left = np.maximum(gap(x, y, orientation), 0.0)
        closing = -(n_x * d_x[lanes] + n_y * d_y[lanes])
        stops = (clear > -IN_THE_GROUND * smallest[lanes]) & (closing > left)
        ends = np.where(stops, left / np.where(stops, closing, 1.0), 1.0)
        share[lanes] = np.minimum(share[lanes], ends)
        place = place + way[lanes]

"""Places of a profile that are narrower than blocks.

Which they are is found once, for the largest of the blocks; everywhere else a block on
the ground meets the next segment and no other.
"""

import dataclasses

import numpy as np

from .terrain import Profile

ROUNDING = 1e-9
"""Fraction of a block's size by which places may differ by rounding."""
NONE = -1
"""Number of a segment that is not there."""


@dataclasses.dataclass(frozen=True)
class NarrowPlaces:
    """Segments that blocks may touch beside the one that they are on."""

    along: np.ndarray
    """Segments, for each segment, that a block on it may touch besides, `(segments,
    most)`, then `NONE`; none at all where only those beside it are in reach."""
    about: np.ndarray
    """Segments, for each point, that a block may touch that turns about it, `(points,
    most)`, then `NONE`."""

    @classmethod
    def of(cls, profile: Profile, radius: float) -> "NarrowPlaces":
        """Find the narrow places of a profile.

        Args:
            radius: height of the centre of the largest block over the ground [m]. What
                smaller blocks touch, this one touches.
        """
        slope = profile.slope
        points = np.stack([profile.x, profile.y], axis=1)
        normals = np.stack([np.sin(slope), np.cos(slope)], axis=1)
        # Centres on a segment lie between these two; those of a turn about a point
        # between the second of one segment and the first of the next.
        first, second = points[:-1] + radius * normals, points[1:] + radius * normals
        along = _within_reach(profile, first, second, radius, 0, radius)
        turn = np.maximum(np.diff(slope), 0.0)
        # The way of the centre is an arc over the chord.
        reach = radius * (2.0 - np.cos(0.5 * turn))
        about = _within_reach(profile, second[:-1], first[1:], reach, 1, radius)
        about = [found if turn[i] > 0.0 else [] for i, found in enumerate(about)]
        return cls(_padded(along), _padded([[], *about, []]))


def _within_reach(
    profile: Profile,
    starts: np.ndarray,
    ends: np.ndarray,
    reach: np.ndarray | float,
    own: int,
    radius: float,
) -> list[list[int]]:
    """List the segments within reach of each way of the centre, where there are any
    beside those that follow each other at the way.

    Args:
        starts, ends: of the ways, one for each segment, or point between two.
        reach: distance from the way that counts as touched [m].
        own: 0 for the ways along segments, 1 for those about points.
    """
    count, last = len(starts), profile.segments - 1
    points = np.stack([profile.x, profile.y], axis=1)
    reach = np.broadcast_to(np.asarray(reach) * (1.0 + ROUNDING), count)
    found: list[list[int]] = [[] for _ in range(count)]
    numbers = np.arange(count)
    for side in (-1, 1):
        # The first that is not beside the way, and on from there.
        place = numbers - 2 + own if side < 0 else numbers + 2
        going = numbers[(place >= 0) & (place <= last)]
        while len(going):
            j = place[going]
            near = profile.x[j + (side < 0)]
            own_end = profile.x[going + (own if side < 0 else 1)]
            going = going[side * (near - own_end) < 2.0 * radius]
            j = place[going]
            apart = _segments_apart(
                starts[going], ends[going], points[j], points[j + 1]
            )
            for i in going[apart < reach[going]]:
                found[i].append(int(place[i]))
            place += side
            going = going[(place[going] >= 0) & (place[going] <= last)]
    for i, others in enumerate(found):
        if others:
            beside = (i - 1, i + 1) if own == 0 else (i, i + 1)
            others.extend(j for j in beside if 0 <= j <= last)
    return found


def _padded(lists: list[list[int]]) -> np.ndarray:
    table = np.full((len(lists), max(1, *map(len, lists))), NONE)
    for row, numbers in zip(table, lists, strict=True):
        row[: len(numbers)] = sorted(numbers)
    return table


def _segments_apart(a, b, c, d) -> np.ndarray:
    """Compute the distances between segments from a to b and from c to d [m]."""

    def cross(u, v):
        return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]

    def to_point(p, start, end):
        along = end - start
        squared = np.maximum(np.sum(along**2, axis=1), 1e-300)
        part = np.clip(np.sum((p - start) * along, axis=1) / squared, 0.0, 1.0)
        return np.hypot(*(p - start - part[:, None] * along).T)

    crossed = (cross(b - a, c - a) * cross(b - a, d - a) < 0.0) & (
        cross(d - c, a - c) * cross(d - c, b - c) < 0.0
    )
    pairs = ((a, c, d), (b, c, d), (c, a, b), (d, a, b))
    apart = np.min([to_point(*pair) for pair in pairs], axis=0)
    return np.where(crossed, 0.0, apart)

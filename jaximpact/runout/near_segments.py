"""Segments near blocks, in pairs of a lane and a segment."""

from collections.abc import Iterator

import numpy as np

from .terrain import Profile

PAIRS = 2**18
"""Number of pairs at once, by which the memory for them is bounded."""


def columns_between(
    profile: Profile, left: np.ndarray, right: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Find the first and the last segment whose columns lie between two places, or
    reach into there, for each lane."""
    first = np.searchsorted(profile.x, left, side="left") - 1
    last = np.searchsorted(profile.x, right, side="right") - 1
    return np.maximum(first, 0), np.minimum(last, profile.segments - 1)


def in_pairs(
    first: np.ndarray, last: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pair each lane with its segments.

    Args:
        first, last: segments of the lanes, `(lanes,)`; none where the last is less.

    Yields:
        Lanes and segments of some pairs.
    """
    count = np.maximum(last - first + 1, 0)
    ends = np.cumsum(count)
    start, begun = 0, 0
    while start < len(count):
        stop = max(start + 1, int(np.searchsorted(ends, begun + PAIRS, side="right")))
        lanes = np.repeat(np.arange(start, stop), count[start:stop])
        before = (ends - count)[lanes]
        yield lanes, first[lanes] + np.arange(begun, begun + len(lanes)) - before
        start, begun = stop, int(ends[stop - 1])

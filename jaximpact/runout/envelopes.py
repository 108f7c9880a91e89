r"""The largest height, speed and energy of each block along the slope.

Over a part of a piece of the way that lies over one segment, the height of the centre
above the ground is a quadratic in time, and its largest value stands at an end or where
its derivative vanishes; squared speeds are convex, and largest at an end. So these are
exact, and no samples.
"""

from typing import NamedTuple

import numpy as np

from .dual import plain
from .runs import Runs
from .stretches import Stretches, pieces_at, state_after, stretches_of, take, time_at


class Maxima(NamedTuple):
    """Largest values of each block in each bin, `(blocks, bins)`; NaN where a block's
    centre never was."""

    height: np.ndarray
    """Of the centre above the ground [m]."""
    speed: np.ndarray
    """Of the centre [m/s]."""
    energy: np.ndarray
    """Kinetic, of translation and rotation [J]."""


def maxima_along(
    runs: Runs, edges: np.ndarray, stretches: Stretches | None = None
) -> Maxima:
    """Largest values in bins of x.

    Args:
        edges: of the bins [m], increasing, `(bins + 1,)`; what lies beyond the outer
            ones is counted to the outer bins.
        stretches: of the runs, where they are known.
    """
    trajectory, place, _, heights, speeds, energies = candidates(runs, edges, stretches)
    largest = (
        np.maximum.reduce(heights),
        np.sqrt(np.maximum(*speeds)),
        np.maximum(*energies),
    )
    shape = (runs.release.count, len(edges) - 1)
    found = Maxima(*(np.full(shape, -np.inf) for _ in Maxima._fields))
    for values, new in zip(found, largest, strict=True):
        np.maximum.at(values, (trajectory, place), new)
    return Maxima(*(np.where(np.isfinite(v), v, np.nan) for v in found))


def candidates(
    runs: Runs, edges: np.ndarray, stretches: Stretches | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, list, list, list]:
    """Where largest values may stand, for each part of a way over one bin and segment.

    Returns:
        Trajectory and bin of each part, and the time at which its piece of the way
        starts; its heights at both ends and the summit; squared speeds and energies at
        both ends.
    """
    whole = stretches_of(runs) if stretches is None else stretches
    inner = runs.profile.x[(runs.profile.x > edges[0]) & (runs.profile.x < edges[-1])]
    cells = np.union1d(edges, inner)
    bin_of = np.searchsorted(edges, 0.5 * (cells[1:] + cells[:-1])) - 1
    low = plain(np.minimum(whole.x_start, whole.x_stop))
    high = plain(np.maximum(whole.x_start, whole.x_stop))
    last_cell = len(cells) - 2
    first = np.clip(np.searchsorted(cells, low, "right") - 1, 0, last_cell)
    last = np.clip(np.searchsorted(cells, high, "left") - 1, first, last_cell)
    # One part for each cell that a stretch lies over.
    counts = last - first + 1
    of = np.repeat(np.arange(len(counts)), counts)
    cell = np.arange(len(of)) - np.repeat(np.cumsum(counts) - counts - first, counts)
    part = take(whole, of)
    back = part.sign < 0.0
    at_low = np.where(back, part.stop, part.start)
    at_high = np.where(back, part.start, part.stop)
    begin = np.where(cell == first[of], at_low, time_at(runs, part, cells[cell]))
    end = np.where(cell == last[of], at_high, time_at(runs, part, cells[cell + 1]))
    # Where the height above the segment is stationary.
    middle = 0.5 * (cells[cell] + cells[cell + 1])
    segment = np.clip(
        np.searchsorted(runs.profile.x, middle) - 1, 0, runs.profile.segments - 1
    )
    slope = (np.diff(runs.profile.y) / np.diff(runs.profile.x))[segment]
    p = pieces_at(runs, part.piece)
    rising, bending = p.v_y - slope * p.v_x, p.a_y - slope * p.a_x
    summit = np.where(bending < 0.0, -rising / np.where(bending < 0.0, bending, 1.0), 0)
    summit = np.clip(summit, np.minimum(begin, end), np.maximum(begin, end))

    trajectory = p.trajectory.astype(int)
    mass, inertia = (value[trajectory] for value in runs.release.matter)
    ends = [state_after(p, time) for time in (begin, end)]
    speeds = [body.v_x**2 + body.v_y**2 for body in ends]
    energies = [
        0.5 * (mass * squared + inertia * body.angular_velocity**2)
        for squared, body in zip(speeds, ends, strict=True)
    ]
    heights = [
        body.y - runs.profile.height(body.x) for body in (*ends, state_after(p, summit))
    ]
    return trajectory, bin_of[cell], plain(p.time), heights, speeds, energies

"""Collectors: what passes a place of the slope, and how.

Where pieces of the way follow on each other with a jump, as when an ellipse goes on as
a round block, a place between the two is passed at the end of the first.
"""

from typing import NamedTuple

import numpy as np

from .motion import support_of
from .motion import take as take_lanes
from .runs import Runs
from .stretches import Stretches, pieces_at, state_after, stretches_of, take, time_at


class Passages(NamedTuple):
    """Passages of the centres of blocks, arrays `(passages,)`, trajectory after
    trajectory, in time."""

    trajectory: np.ndarray
    time: np.ndarray
    """Since release [s]."""
    v_x: np.ndarray
    """[m/s], positive to the right: passages to the left count too."""
    v_y: np.ndarray
    angular_velocity: np.ndarray
    """[rad/s], clockwise positive."""
    translational_energy: np.ndarray
    """Kinetic [J]."""
    rotational_energy: np.ndarray
    """Kinetic [J]."""
    centre_height: np.ndarray
    """Of the centre above the ground [m]."""
    lowest_height: np.ndarray
    """Of the block's lowest point above the ground below its centre [m]; on a slope it
    is not the point that touches first."""

    @property
    def speed(self) -> np.ndarray:
        """[m/s]"""
        return np.hypot(self.v_x, self.v_y)

    @property
    def energy(self) -> np.ndarray:
        """Kinetic, in all [J]."""
        return self.translational_energy + self.rotational_energy


def passages(runs: Runs, x: float, stretches: Stretches | None = None) -> Passages:
    """Every passage at x, exactly: where the pieces of the way are there.

    Args:
        x: of the collector [m].
        stretches: of the runs, where they are known.

    A block that is released at x, or stops there, passes it if it comes from, or goes
    to, the left of it.
    """
    all_of = stretches_of(runs) if stretches is None else stretches
    trajectory = runs.pieces.trajectory[all_of.piece].astype(int)
    # The next stretch begins where this one ends: so none is missed or counted twice.
    same = np.append(trajectory[1:] == trajectory[:-1], False)
    ends = np.where(same, np.append(all_of.x_start[1:], 0.0), runs.x[trajectory])
    # Where a contact failed, nothing is known from there on.
    ends = np.where(np.isfinite(ends), ends, all_of.x_stop)
    passes = np.flatnonzero((all_of.x_start >= x) != (ends >= x))
    chosen = take(all_of, passes)
    time = time_at(runs, chosen, x)
    jumps = (chosen.x_start >= x) == (chosen.x_stop >= x)
    time = np.where(jumps, chosen.stop, time)
    pieces = pieces_at(runs, chosen.piece)
    body = state_after(pieces, time)
    trajectory = trajectory[passes]
    mass, inertia = (value[trajectory] for value in runs.release.matter)
    outline = take_lanes(runs.release.outline, trajectory)
    height = body.y - runs.profile.height(x)
    reach = support_of(outline, body.orientation).radius
    return Passages(
        trajectory=trajectory,
        time=pieces.time + time,
        v_x=body.v_x,
        v_y=body.v_y,
        angular_velocity=body.angular_velocity,
        translational_energy=0.5 * mass * (body.v_x**2 + body.v_y**2),
        rotational_energy=0.5 * inertia * body.angular_velocity**2,
        centre_height=height,
        lowest_height=height - reach,
    )


def first_passages(found: Passages, blocks: int) -> tuple[np.ndarray, Passages]:
    """How often each block passes, and its first passage, NaN for one that does not.

    Arrays `(blocks,)`.
    """
    count = np.bincount(found.trajectory, minlength=blocks)
    passing, first = np.unique(found.trajectory, return_index=True)

    def spread(column: np.ndarray) -> np.ndarray:
        values = np.full(blocks, np.nan)
        values[passing] = column[first]
        return values

    spread_out = (spread(column) for column in found[1:])
    return count, Passages(np.arange(blocks), *spread_out)

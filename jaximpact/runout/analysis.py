"""Quantities derived from trajectories, exactly: passages of collectors, and largest
values along the slope."""

from functools import partial
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from .._checks import expect, real_number, real_numbers, whole_number
from .._settings import numpy_settings
from ..errors import InputError
from ..shapes import shape_by_shape
from .blocks import BlockOutline, MassProperties, select, support
from .lane_programs import Values, closed_form
from .trajectory import (
    Pieces,
    Runs,
    Stretches,
    state_after,
    stretches_of,
    time_at,
)


class Passages(NamedTuple):
    """Passages of a collector by the centres of blocks.

    Arrays `(passages,)`, trajectory after trajectory, in time.
    """

    trajectory: Values
    """Number of the block, from 0."""
    time: Values
    """Time since release [s]."""
    v_x: Values
    """Velocity to the right [m/s]: passages to the left count too."""
    v_y: Values
    """Velocity upwards [m/s]."""
    angular_velocity: Values
    """Angular velocity [rad/s], clockwise positive."""
    translational_energy: Values
    """Kinetic energy of translation [J]."""
    rotational_energy: Values
    """Kinetic energy of rotation [J]."""
    centre_height: Values
    """Height of the centre above the ground [m]."""
    lowest_height: Values
    """Height of the block's lowest point above the ground below its centre [m]; on a
    slope it is not the point that touches first."""

    @property
    def speed(self) -> Values:
        """Speed of the centre [m/s]."""
        return np.hypot(self.v_x, self.v_y)

    @property
    def energy(self) -> Values:
        """Total kinetic energy [J]."""
        return self.translational_energy + self.rotational_energy


@numpy_settings()
def passages(runs: Runs, x: float, stretches: Stretches | None = None) -> Passages:
    """Find every passage of a collector, exactly, from the pieces of the trajectories.

    A block that is released at x, or stops there, passes it if it comes from, or goes
    to, the left of it. Pieces join but for rounding; a place between two is passed at
    the end of the first.

    Args:
        x: place of the collector [m].
        stretches: result of `stretches_of(runs)`, computed if not given.

    Raises InputError for a place that is no finite number.
    """
    x = real_number("x", x)
    all_of = stretches_of(runs) if stretches is None else stretches
    trajectory = runs.pieces.trajectory[all_of.piece].astype(int)
    # The next stretch begins where this one ends: no passage is missed or counted
    # twice.
    same = np.append(trajectory[1:] == trajectory[:-1], False)
    ends = np.where(same, np.append(all_of.x_start[1:], 0.0), runs.x[trajectory])
    # Where a contact failed, nothing is known from there on.
    ends = np.where(np.isfinite(ends), ends, all_of.x_stop)
    passes = (all_of.x_start >= x) != (ends >= x)
    chosen, trajectory = select(all_of, passes), trajectory[passes]
    if not len(trajectory):
        # Of mixed shapes none would be left to compute by.
        return Passages(trajectory, *np.empty((len(Passages._fields) - 1, 0)))
    jumps = (chosen.x_start >= x) == (chosen.x_stop >= x)
    release = runs.release
    passed = shape_by_shape(
        partial(_passage, runs.profile.height(x)),
        select(release.outline, trajectory),
        select(release.mass_properties, trajectory),
        select(runs.pieces, chosen.piece),
        np.where(jumps, chosen.stop, time_at(runs, chosen, x)),
    )
    return passed._replace(trajectory=trajectory)


@closed_form
def _passage(
    ground: Values,
    outline: BlockOutline,
    mass_properties: MassProperties,
    piece: Pieces,
    time: Values,
) -> Passages:
    """Describe a passage at a time from the start of a piece [s], above the ground's
    height there [m]; whose it is stays open."""
    mass, inertia = mass_properties
    body = state_after(piece, time)
    height = body.y - ground
    sin, cos = jnp.sin(body.orientation), jnp.cos(body.orientation)
    reach, _ = support(outline, sin, cos)
    return Passages(
        trajectory=jnp.zeros_like(time),
        time=piece.time + time,
        v_x=body.v_x,
        v_y=body.v_y,
        angular_velocity=body.angular_velocity,
        translational_energy=0.5 * mass * (body.v_x**2 + body.v_y**2),
        rotational_energy=0.5 * inertia * body.angular_velocity**2,
        centre_height=height,
        lowest_height=height - reach,
    )


@numpy_settings()
def first_passages(every: Passages, blocks: int) -> tuple[np.ndarray, Passages]:
    """Count the passages of each block, and choose the first.

    Args:
        every: result of `passages`.
        blocks: number of blocks.

    Returns:
        Counts and first passages, arrays `(blocks,)`; NaN for a block that does not
        pass.

    Raises InputError for fewer blocks than have passages.
    """
    expect("every", every, Passages)
    least = int(np.max(every.trajectory, initial=-1)) + 1
    blocks = whole_number("blocks", blocks, least)
    count = np.bincount(every.trajectory, minlength=blocks)
    passing, first = np.unique(every.trajectory, return_index=True)

    def spread(column: np.ndarray) -> np.ndarray:
        values = np.full(blocks, np.nan)
        values[passing] = column[first]
        return values

    spread_out = (spread(column) for column in every[1:])
    return count, Passages(np.arange(blocks), *spread_out)


class Maxima(NamedTuple):
    """Largest values of each block in each bin, `(blocks, bins)`.

    NaN in a bin that the block's centre does not enter.
    """

    height: np.ndarray
    """Height of the centre above the ground [m]."""
    speed: np.ndarray
    """Speed of the centre [m/s]."""
    energy: np.ndarray
    """Total kinetic energy [J]."""


@numpy_settings()
def maxima_along(
    runs: Runs, edges: np.ndarray, stretches: Stretches | None = None
) -> Maxima:
    """Find the largest values of each block in bins of x, exactly.

    Args:
        edges: edges of the bins [m], increasing, `(bins + 1,)`; what lies beyond the
            outer edges counts to the outer bins.
        stretches: result of `stretches_of(runs)`, computed if not given.

    Raises InputError for edges that are no increasing numbers, or fewer than two.
    """
    edges = np.asarray(real_numbers("edges", edges))
    increasing = edges.ndim == 1 and len(edges) > 1 and np.all(np.diff(edges) > 0.0)
    if not (increasing and np.all(np.isfinite(edges))):
        raise InputError(
            f"edges must be increasing numbers, at least two, but are {edges}"
        )
    whole = stretches_of(runs) if stretches is None else stretches
    trajectory, number, largest = _largest_of_parts(runs, edges, whole)
    shape = (runs.release.count, len(edges) - 1)
    maxima = Maxima(*(np.full(shape, -np.inf) for _ in Maxima._fields))
    for values, new in zip(maxima, largest, strict=True):
        np.maximum.at(values, (trajectory, number), new)
    return Maxima(*(np.where(np.isfinite(v), v, np.nan) for v in maxima))


def _largest_of_parts(
    runs: Runs, edges: np.ndarray, whole: Stretches
) -> tuple[np.ndarray, np.ndarray, Maxima]:
    """Compute the largest values on each part of a trajectory over one bin and segment:
    its block, its bin, and the values, arrays `(parts,)`.

    The height of the centre above the ground is there a quadratic in time, and its
    largest value stands at an end or where its derivative vanishes; squared speeds are
    convex, and largest at an end. So these are exact, and no samples.
    """
    x, y = runs.profile.x, runs.profile.y
    cells = np.union1d(edges, x)
    of, cell, at_low, at_high = _over_cells(whole, cells)
    part = select(whole, of)
    back = part.sign < 0.0

    def end(of_stretch, is_stop, border) -> np.ndarray:
        """Find when parts are at the end of a stretch, or at the border of a cell."""
        at_end = np.where(is_stop, part.stop, part.start)
        return np.where(of_stretch, at_end, time_at(runs, part, cells[border]))

    begin, stop = end(at_low, back, cell), end(at_high, ~back, cell + 1)
    middle = 0.5 * (cells[cell] + cells[cell + 1])
    segment = np.clip(np.searchsorted(x, middle) - 1, 0, runs.profile.segments - 1)
    gradient = (np.diff(y) / np.diff(x))[segment]
    p = select(runs.pieces, part.piece)
    # When the height above the segment is stationary, or the nearest end.
    rising, bending = p.v_y - gradient * p.v_x, p.a_y - gradient * p.a_x
    summit = np.where(bending < 0.0, -rising / np.where(bending < 0.0, bending, 1.0), 0)
    summit = np.clip(summit, np.minimum(begin, stop), np.maximum(begin, stop))
    bodies = [state_after(p, time) for time in (begin, stop, summit)]
    trajectory = p.trajectory.astype(int)
    of_parts = select(runs.release.mass_properties, trajectory)
    heights = [body.y - runs.profile.height(body.x) for body in bodies]
    squares = [body.v_x**2 + body.v_y**2 for body in bodies[:2]]
    energies = [
        of_parts.kinetic_energy(body.v_x, body.v_y, body.angular_velocity)
        for body in bodies[:2]
    ]
    bin_of = np.searchsorted(edges, 0.5 * (cells[1:] + cells[:-1])) - 1
    bin_of = np.clip(bin_of, 0, len(edges) - 2)
    largest = Maxima(
        np.maximum.reduce(heights),
        np.sqrt(np.maximum(*squares)),
        np.maximum(*energies),
    )
    return trajectory, bin_of[cell], largest


def _over_cells(whole: Stretches, cells: np.ndarray) -> tuple[np.ndarray, ...]:
    """Divide stretches at the borders of cells: for each part its stretch and its cell,
    and whether it has the lower and the upper end of the stretch."""
    low = np.minimum(whole.x_start, whole.x_stop)
    high = np.maximum(whole.x_start, whole.x_stop)
    last_cell = len(cells) - 2
    first = np.clip(np.searchsorted(cells, low, "right") - 1, 0, last_cell)
    last = np.clip(np.searchsorted(cells, high, "left") - 1, first, last_cell)
    counts = last - first + 1
    of = np.repeat(np.arange(len(counts)), counts)
    cell = np.arange(len(of)) - np.repeat(np.cumsum(counts) - counts - first, counts)
    return of, cell, cell == first[of], cell == last[of]

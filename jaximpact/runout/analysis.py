"""Quantities derived from trajectories, exactly: passages of collectors, largest values
along the slope, jumps, and coefficients of restitution."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ..scene import GRAVITY
from .blocks import BlockOutline, MassProperties, select, support
from .extremes import Follows, Moment, extremes, moving_time, stops_of
from .lane_programs import Values, closed_form
from .trajectory import (
    MotionMode,
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


def passages(runs: Runs, x: float, stretches: Stretches | None = None) -> Passages:
    """Find every passage of a collector, exactly, from the pieces of the trajectories.

    A block that is released at x, or stops there, passes it if it comes from, or goes
    to, the left of it. Where pieces follow on each other with a jump, as when an
    ellipse continues as a round block, a place between the two is passed at the end of
    the first.

    Args:
        x: place of the collector [m].
        stretches: result of `stretches_of(runs)`, computed if not given.
    """
    piece, moment = find_passages(runs, x, stretches)
    trajectory = runs.pieces.trajectory[piece].astype(int)
    found = passage(
        select(runs.pieces, piece),
        moment,
        select(runs.release.outline, trajectory),
        select(runs.release.mass_properties, trajectory),
        runs.profile.height(x),
    )
    return found._replace(trajectory=trajectory)


def find_passages(
    runs: Runs, x: float, stretches: Stretches | None = None
) -> tuple[np.ndarray, Moment]:
    """Find the pieces on which blocks pass a collector, and when; see `passages`."""
    all_of = stretches_of(runs) if stretches is None else stretches
    trajectory = runs.pieces.trajectory[all_of.piece].astype(int)
    # The next stretch begins where this one ends: no passage is missed or counted
    # twice.
    same = np.append(trajectory[1:] == trajectory[:-1], False)
    ends = np.where(same, np.append(all_of.x_start[1:], 0.0), runs.x[trajectory])
    # Where a contact failed, nothing is known from there on.
    ends = np.where(np.isfinite(ends), ends, all_of.x_stop)
    passes = np.flatnonzero((all_of.x_start >= x) != (ends >= x))
    chosen = select(all_of, passes)
    jumps = (chosen.x_start >= x) == (chosen.x_stop >= x)
    at_stop = stops_of(runs, chosen)
    return chosen.piece, Moment(
        np.where(jumps, at_stop.time, time_at(runs, chosen, x)),
        np.where(jumps, at_stop.follows, Follows.place),
    )


@closed_form
def passage(
    piece: Pieces,
    moment: Moment,
    outline: BlockOutline,
    mass_properties: MassProperties,
    ground: Values,
) -> Passages:
    """Describe a passage; whose it is stays open.

    Args:
        ground: height of the ground there [m].
    """
    time, (mass, inertia) = moving_time(piece, moment), mass_properties
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


def first_passages(found: Passages, blocks: int) -> tuple[np.ndarray, Passages]:
    """Count the passages of each block, and choose the first.

    Args:
        found: result of `passages`.
        blocks: number of blocks.

    Returns:
        Counts and first passages, arrays `(blocks,)`; NaN for a block that does not
        pass.
    """
    count = np.bincount(found.trajectory, minlength=blocks)
    passing, first = np.unique(found.trajectory, return_index=True)

    def spread(column: np.ndarray) -> np.ndarray:
        values = np.full(blocks, np.nan)
        values[passing] = column[first]
        return values

    spread_out = (spread(column) for column in found[1:])
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


def maxima_along(
    runs: Runs, edges: np.ndarray, stretches: Stretches | None = None
) -> Maxima:
    """Find the largest values of each block in bins of x, exactly.

    Args:
        edges: edges of the bins [m], increasing, `(bins + 1,)`; what lies beyond the
            outer edges counts to the outer bins.
        stretches: result of `stretches_of(runs)`, computed if not given.
    """
    found = extremes(runs, edges, stretches)
    largest = (
        np.maximum.reduce(found.heights),
        np.sqrt(np.maximum(*found.squared_speeds)),
        np.maximum(*found.energies),
    )
    shape = (runs.release.count, len(edges) - 1)
    maxima = Maxima(*(np.full(shape, -np.inf) for _ in Maxima._fields))
    for values, new in zip(maxima, largest, strict=True):
        np.maximum.at(values, (found.trajectory, found.bin), new)
    return Maxima(*(np.where(np.isfinite(v), v, np.nan) for v in maxima))


class Jumps(NamedTuple):
    """Flights, arrays `(jumps,)`, trajectory after trajectory, in time."""

    trajectory: np.ndarray
    """Number of the block, from 0."""
    piece: np.ndarray
    """Index of the flight among the pieces of the trajectories."""
    after_contact: np.ndarray
    """False for the flight of the release, and for one that begins at a convex
    break."""
    height: np.ndarray
    """Largest height of the centre above the ground below it [m]."""
    rise: np.ndarray
    """Largest height less that at the start of the flight [m]."""


def jumps(runs: Runs) -> Jumps:
    """Find the flights of trajectories, and the highest point of each, exactly."""
    profile, all_pieces = runs.profile, runs.pieces
    flights = np.flatnonzero(all_pieces.motion == MotionMode.flight)
    p = select(runs.pieces, flights)
    start = p.y - profile.height(p.x)
    end = state_after(p, p.duration)
    highest = np.maximum(start, end.y - profile.height(end.x))
    gradients = np.diff(profile.y) / np.diff(profile.x)
    for left, right, y, gradient in zip(
        profile.x[:-1], profile.x[1:], profile.y[:-1], gradients, strict=True
    ):
        # The summit over the segment's line, and the flight at both ends of its column.
        summit = (p.v_y - gradient * p.v_x) / -p.a_y
        for time in (summit, _time_at(p, left), _time_at(p, right)):
            then = state_after(p, np.clip(time, 0.0, p.duration))
            over = (then.x >= left) & (then.x <= right)
            height = then.y - (y + gradient * (then.x - left))
            highest = np.where(over, np.maximum(highest, height), highest)
    before = np.maximum(flights - 1, 0)
    same = all_pieces.trajectory[before] == all_pieces.trajectory[flights]
    follows = all_pieces.motion[before] == MotionMode.contact
    return Jumps(
        trajectory=p.trajectory.astype(int),
        piece=flights,
        after_contact=same & follows & (before < flights),
        height=highest,
        rise=highest - start,
    )


def _time_at(p, x: float) -> np.ndarray:
    """Compute when flights pass x [s]; 0 for never."""
    moves = p.v_x != 0.0
    return np.where(moves, (x - p.x) / np.where(moves, p.v_x, 1.0), 0.0)


class Restitutions(NamedTuple):
    """Apparent coefficients of restitution, arrays `(contacts,)`, as the record of
    contacts."""

    e_n: np.ndarray
    """Normal coefficient; NaN where the centre does not come down to the plane: a block
    that turns can strike while its centre rises."""
    e_t: np.ndarray
    """Tangential coefficient; NaN there too, and where the centre does not move along
    the plane."""


def restitutions(runs: Runs, *, out_of_the_crater: bool = True) -> Restitutions:
    r"""Compute the apparent coefficients of restitution of every contact.

    $$ e_n = -\frac{v_n}{v_n^{in}}, \qquad e_t = \frac{v_t}{v_t^{in}} $$

    in the frame of the plane that is struck; NaN for touches that are no impact.

    Args:
        out_of_the_crater: take the velocities with which the trajectory continues; else
            those at the end of the impact, before the climb out of the ground. A block
            that cannot climb has stopped, with coefficients of zero, either way.

    Source: Dattola et al. (2023), section 2.3.
    """
    c = runs.contacts
    fraction = np.ones_like(c.time)
    if not out_of_the_crater:
        mass, inertia = select(runs.release.mass_properties, c.trajectory.astype(int))
        left = 0.5 * (
            mass * (c.normal_velocity**2 + c.tangential_velocity**2)
            + inertia * c.angular_velocity**2
        )
        climb = mass * GRAVITY * np.cos(c.slope) * np.maximum(c.sinking, 0.0)
        fraction = np.sqrt(1.0 + climb / np.where(left > 0.0, left, np.inf))
    comes_down = (c.outcome >= 0) & (c.normal_velocity_before > 0.0)
    moves = comes_down & (c.tangential_velocity_before != 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        e_n = -fraction * c.normal_velocity / c.normal_velocity_before
        e_t = fraction * c.tangential_velocity / c.tangential_velocity_before
    return Restitutions(np.where(comes_down, e_n, np.nan), np.where(moves, e_t, np.nan))

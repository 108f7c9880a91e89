r"""The paper's slope of two planes, the blocks released on it, and what its diagrams
show of their trajectories: jumps, and coefficients of restitution.

A plane 230 m high and 400 m long in plan, which the paper rounds to 30 degrees, then
600 m of level ground. Blocks of 100 kg start at 20 m/s, at 10 degrees to the
horizontal, with spins up to 20 000 deg/s. Shapes have the same energy of translation
and of rotation: spins $\Omega\sqrt{I_s/I}$, with $I_s$ of the sphere.

Source: Dattola et al. (2023), section 3.3. What it leaves open are the fields
of `BiplanarCase`, with our readings as defaults.
"""

import dataclasses
import itertools
import math
from typing import NamedTuple

import numpy as np
import xarray as xr

from jaximpact.runout import passages
from jaximpact.runout.blocks import Release, select
from jaximpact.runout.terrain import ROLLING_FRICTION_ANGLE, Profile
from jaximpact.runout.trajectory import MotionMode, Runs, state_after, stretches_of
from jaximpact.scene import GRAVITY, Block, Soil
from jaximpact.units import DEGREE

HEIGHT, SLOPE_LENGTH, FLAT_LENGTH = 230.0, 400.0, 600.0
"""Height and lengths in plan [m]."""
SLOPE = math.atan2(HEIGHT, SLOPE_LENGTH)
"""Angle of the upper plane [rad]."""
SPEED = 20.0
"""Speed at release [m/s]."""
ASPECT_RATIOS = (1.0, 1.5, 2.0, 3.0, 4.0)
"""Aspect ratios of the blocks; the paper has 1 to 4, the steps are ours."""
SPINS_DEGPS = tuple(np.linspace(0.0, 20_000.0, 9).tolist())
"""Spins of the sphere [deg/s]."""
COMPARED_X = np.arange(10.0, 251.0, 10.0)
"""Places where paths are compared [m]: the paper has them superimpose up to 250 m."""
COEFFICIENTS = (-1.0, 3.0)
"""Range of coefficients of restitution in the diagrams: those of grazing impacts have
no bounds."""


@dataclasses.dataclass(frozen=True)
class BiplanarCase:
    """Choices that the paper leaves open."""

    direction: float = 10.0 * DEGREE
    """Angle of the velocity above the horizontal [rad]: 10 degrees are upwards."""
    height: float = 1.0
    """Height of the centres above the crest, at x = 0, at release [m]. Every block is
    clear of the ground there, and all start from one point."""
    orientation: float = 0.0
    """Angle from the vertical to the major axis [rad]; the paper says "oriented along
    the major axis"."""
    spin_sense: float = 1.0
    """1 for spins that roll down the slope, -1 for those against."""
    equal_energy: bool = True
    """True if shapes have the sphere's energy of rotation; else they have its spin."""
    rolling_friction_angle: float = ROLLING_FRICTION_ANGLE
    """Angle of rolling friction [rad]."""

    def profile(self, soil: Soil) -> Profile:
        """Make the profile, of one soil."""
        return Profile(
            [0.0, SLOPE_LENGTH, SLOPE_LENGTH + FLAT_LENGTH],
            [HEIGHT, 0.0, 0.0],
            soil,
            self.rolling_friction_angle,
        )

    def release(self, block: Block | None = None) -> Release:
        """Release blocks of every aspect ratio at every spin, the spin fastest.

        Args:
            block: gives mass and density; 100 kg by default.
        """
        block = block or Block()
        shapes, spins = np.transpose(
            list(itertools.product(ASPECT_RATIOS, SPINS_DEGPS))
        )
        blocks = dataclasses.replace(block, aspect_ratio=shapes)
        spins = self.spin_sense * DEGREE * spins
        if self.equal_energy:
            sphere = dataclasses.replace(block, aspect_ratio=1.0)
            spins = spins * np.sqrt(sphere.inertia / np.asarray(blocks.inertia))
        return Release(
            blocks,
            x=0.0,
            y=HEIGHT + self.height,
            v_x=SPEED * math.cos(self.direction),
            v_y=SPEED * math.sin(self.direction),
            orientation=self.orientation,
            angular_velocity=spins,
        )


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


def run_numbers(
    runs: Runs, *, released_flight_jumps: bool, out_of_the_crater: bool
) -> xr.Dataset:
    """Collect numbers of trajectories over the aspect ratio and the spin of the sphere,
    of the paths without spin over the aspect ratio, and of all jumps and impacts in a
    row. Impacts after which a block hops are counted apart.

    Args:
        released_flight_jumps: count the flight that a block is released in too.
        out_of_the_crater: as for `restitutions`.
    """
    flights, contacts = jumps(runs), runs.contacts
    shape = len(ASPECT_RATIOS), len(SPINS_DEGPS)
    first_contact, first_flight = map(
        first_rows, (contacts.trajectory, flights.trajectory)
    )
    of_trajectories = {
        "first_impact_x_m": contacts.x[first_contact],
        "off_the_parabola_m": off_the_parabola(runs),
        "first_flight_m": flights.height[first_flight],
        **bounces(runs, flights),
    }
    counted = flights.after_contact.copy()
    counted[first_flight] |= released_flight_jumps
    coefficients = restitutions(runs, out_of_the_crater=out_of_the_crater)
    hops = contacts.hop.astype(bool)
    valid = np.isfinite(coefficients.e_n)
    impacts = valid & ~hops
    of_block = np.repeat(ASPECT_RATIOS, len(SPINS_DEGPS))
    grid = {
        "aspect_ratio": np.array(ASPECT_RATIOS),
        "angular_velocity_degps": np.array(SPINS_DEGPS),
    }
    variables = {
        name: (tuple(grid), values.reshape(shape))
        for name, values in of_trajectories.items()
    }
    variables |= {
        "paths_apart_m": ("aspect_ratio", paths_apart(runs)),
        "jump_height_m": ("jump", flights.height[counted]),
        "jump_aspect_ratio": ("jump", of_block[flights.trajectory[counted]]),
        "e_n": ("impact", coefficients.e_n[impacts]),
        "e_t": ("impact", coefficients.e_t[impacts]),
        "impact_aspect_ratio": (
            "impact",
            of_block[contacts.trajectory[impacts].astype(int)],
        ),
        "e_n_before_hops": ("hop", coefficients.e_n[valid & hops]),
    }
    return xr.Dataset(variables, grid)


def first_rows(trajectory: np.ndarray) -> np.ndarray:
    """Find the index of the first row of each trajectory; every one has a row."""
    return np.unique(trajectory, return_index=True)[1]


def off_the_parabola(runs: Runs) -> np.ndarray:
    """How far from the parabola of its release each centre is at its first contact, at
    the x that it has there [m]."""
    body = runs.release.body
    first = first_rows(runs.contacts.trajectory)
    x, y = runs.contacts.x[first], runs.contacts.y[first]
    time = (x - body.x) / body.v_x
    return np.abs(y - (body.y + (body.v_y - 0.5 * GRAVITY * time) * time))


def paths_apart(runs: Runs) -> np.ndarray:
    """How far the path of each shape without spin is from the sphere's, vertically, at
    the worst of `COMPARED_X` [m]; NaN for one that does not come so far."""
    still = np.arange(len(ASPECT_RATIOS)) * len(SPINS_DEGPS)
    apart = np.zeros(len(still))
    stretches = stretches_of(runs)
    for x in COMPARED_X:
        at_x = passages(runs, x, stretches)
        heights = [at_x.centre_height[at_x.trajectory == block] for block in still]
        for place, height in enumerate(heights):
            passed = len(height) and len(heights[0])
            worst = np.max(np.abs(height - heights[0][0])) if passed else np.nan
            apart[place] = np.maximum(apart[place], worst)
    return apart


def bounces(runs: Runs, flights: Jumps) -> dict[str, np.ndarray]:
    """Flights between the first impact of each trajectory and its first rolling: how
    many, the largest and the middle one of their rises [m], 0 for none, and whether the
    block rolls then."""
    rolling = np.flatnonzero(runs.pieces.motion == MotionMode.rolling)
    rollers = runs.pieces.trajectory[rolling].astype(int)
    count, highest, middle, rolls = np.zeros((4, runs.release.count))
    for block in range(runs.release.count):
        after = np.flatnonzero(flights.trajectory == block)[1:]
        until = np.min(rolling[rollers == block], initial=len(runs.pieces.motion))
        rolls[block] = until < len(runs.pieces.motion)
        after = after[flights.piece[after] < until]
        rises = flights.rise[after]
        count[block] = len(rises)
        highest[block] = np.max(rises, initial=0.0)
        middle[block] = np.median(rises) if len(rises) else 0.0
    return {
        "bounces": count,
        "highest_bounce_m": highest,
        "middle_bounce_m": middle,
        "rolls": rolls > 0.0,
    }

r"""A block that stays on the ground: rolling, or sliding where it cannot roll.

**Rolling.** The block is replaced by a round one of the same perimeter, mass and
inertia. Its radius r is the mean of r_y over a turn, since a turn takes the block on by
its perimeter. With $k = I/(m r^2)$ and the rolling-friction angle,

$$ a = g\,\frac{\sin w - \tan\varphi_r \cos w}{1 + k} $$

along the way that it goes, up to the end of the segment or to rest. What the block's
corners do to it meanwhile, hops included, is not followed.

**Where it cannot roll.** On its way the block has to get over its long axis, higher by
$r_{max} - r$ than the mean. Where $\tan w > (H^2 - R^2)/(2 H R) + \tan\varphi_r$ it
falls over it by itself: $r_y'/r_y$ is nowhere larger than that fraction. Elsewhere a
block whose kinetic energy is less than $m g \cos w\,(r_{max} - r)$ lies down on its
flat side and slides, with the ground's friction, $\tan\varphi_b =
\alpha_s\tan\varphi'$.
"""

from typing import NamedTuple

import jax.numpy as jnp

from ..safe import safe_sqrt
from ..scene import GRAVITY
from ..shapes import RoundBlock
from .contact import Matter
from .motion import Outline, Scalar
from .programs import closed_form
from .separation import NEVER


def mean_radius(outline: Outline) -> Scalar:
    """Radius of the circle of equal perimeter [m]."""
    return _round(outline).radius


def _round(outline: Outline) -> RoundBlock:
    return outline.shape.round_block(outline.axes)


def barrier(
    outline: Outline, matter: Matter, slope: Scalar, rolling_friction: Scalar
) -> Scalar:
    """Kinetic energy that it takes to roll [J], 0 where the slope sees to it.

    Args:
        slope: w [rad], of either sign.
        rolling_friction: tan phi_r.
    """
    whole = _round(outline)
    steep = jnp.abs(jnp.tan(slope)) > whole.turning_slope + rolling_friction
    height = whole.tallest - whole.radius
    energy = matter.mass * GRAVITY * jnp.cos(slope) * height
    return jnp.where(steep, 0.0, energy)


class Going(NamedTuple):
    """How a block goes on along the ground."""

    rolls: Scalar
    """1 if it rolls, 0 if it slides."""
    way: Scalar
    """1 along t, -1 against it."""
    speed_squared: Scalar
    """[m2/s2]; negative where the slope turns a block over that lies so low that it
    has to go down first."""
    stays: Scalar
    """1 where the block lies too deep to come up."""


def _go(
    outline: Outline,
    matter: Matter,
    slope: Scalar,
    rolling_friction: Scalar,
    height: Scalar,
    tangential_velocity: Scalar,
    angular_velocity: Scalar,
) -> Going:
    """How a block on the ground goes on.

    It is brought to rolling by an impulse at the ground, which leaves the angular
    momentum about the contact as it is and costs the energy of the slip; its centre
    comes to the height of the round block, which costs or gives energy. If what is left
    takes it over its long axis it rolls. Else it slides at the velocity that it has
    along the ground, and what it turns by is lost.

    Args:
        height: of the centre over the plane [m].
    """
    mass, inertia = matter
    radius = mean_radius(outline)
    whole = mass * radius**2 + inertia
    spin = (mass * radius * tangential_velocity + inertia * angular_velocity) / whole
    lift = mass * GRAVITY * jnp.cos(slope) * (radius - height)
    energy = 0.5 * whole * spin**2 - lift
    needed = barrier(outline, matter, slope, rolling_friction)
    rolls = (needed <= 0.0) | (energy >= needed)
    steep = jnp.abs(jnp.tan(slope)) > _round(outline).turning_slope + rolling_friction
    rounding = 1e-9 * mass * GRAVITY * radius
    energy = jnp.where(jnp.abs(energy) < rounding, jnp.maximum(energy, 0.0), energy)
    # One that lies down loses its height, but does not gain any for nothing.
    rise = jnp.maximum(outline.smallest - height, 0.0)
    sliding = tangential_velocity**2 - 2.0 * GRAVITY * jnp.cos(slope) * rise
    along = jnp.where(rolls, spin, tangential_velocity)
    # A block at rest starts down-slope.
    way = jnp.where(along == 0.0, slope, along)
    return Going(
        rolls=rolls.astype(float),
        way=jnp.where(way >= 0.0, 1.0, -1.0),
        speed_squared=jnp.where(
            rolls, 2.0 * radius**2 * energy / whole, jnp.maximum(sliding, 0.0)
        ),
        stays=jnp.where(
            rolls, (energy < 0.0) & ~steep, sliding < -1e-9 * GRAVITY * radius
        ).astype(float),
    )


class Leg(NamedTuple):
    """A way along one segment."""

    time: Scalar
    """[s]"""
    distance: Scalar
    """[m], positive."""
    speed: Scalar
    """At its end [m/s], positive."""
    acceleration: Scalar
    """Along the way [m/s2]."""
    arrives: Scalar
    """1 at the end of the segment, 0 where the block has become too slow to go on as it
    went."""


def _leg(
    speed: Scalar,
    descent: Scalar,
    distance: Scalar,
    friction: Scalar,
    inertia_ratio: Scalar,
    least_speed: Scalar,
) -> Leg:
    """A way along one segment, at constant acceleration.

    Args:
        speed: at the start [m/s], not negative.
        descent: angle at which the way descends [rad]; negative where it rises.
        distance: to the end of the segment [m].
        friction: tangent of the angle of rolling or sliding friction.
        inertia_ratio: k, 0 for a block that slides.
        least_speed: at which the block has become too slow [m/s].
    """
    drive = jnp.sin(descent) - friction * jnp.cos(descent)
    acceleration = GRAVITY * drive / (1.0 + inertia_ratio)
    distance = jnp.maximum(distance, 0.0)
    slows = acceleration < 0.0
    brake = jnp.where(slows, -acceleration, 1.0)
    to_slow = jnp.maximum(speed**2 - least_speed**2, 0.0) / (2.0 * brake)
    stands = ~slows & (speed <= 0.0) & (acceleration <= 0.0)
    arrives = (~slows | (to_slow > distance)) & ~stands
    end = safe_sqrt(speed**2 + 2.0 * acceleration * distance)
    time_to_end = 2.0 * distance / jnp.maximum(speed + end, 1.0 / NEVER)
    time_to_slow = jnp.maximum(speed - least_speed, 0.0) / brake
    return Leg(
        time=jnp.where(arrives, time_to_end, jnp.where(stands, 0.0, time_to_slow)),
        distance=jnp.where(arrives, distance, jnp.where(stands, 0.0, to_slow)),
        speed=jnp.where(arrives, end, jnp.minimum(speed, least_speed)),
        acceleration=acceleration,
        arrives=arrives.astype(float),
    )


mean_radius_of = closed_form(mean_radius)
barrier_of = closed_form(barrier)
go = closed_form(_go)
leg = closed_form(_leg)

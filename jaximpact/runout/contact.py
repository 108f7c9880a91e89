"""From a touch to an impact, and from its end back to a block on the ground."""

from typing import NamedTuple

import jax.numpy as jnp

from ..safe import safe_sqrt
from ..scene import GRAVITY, Impact
from .motion import Body, Outline, Scalar, support, turned_on
from .programs import closed_form

STEEPEST = 1e-4
"""Least N_y of a plane that is struck: a wall is taken to lean by that much."""


class Matter(NamedTuple):
    """Of the block."""

    mass: Scalar
    """[kg]"""
    inertia: Scalar
    """[kg m2]"""


class Touch(NamedTuple):
    """A block that touches a plane, in the frame of the plane."""

    slope: Scalar
    """w [rad]."""
    orientation: Scalar
    """Theta [rad]."""
    normal_velocity: Scalar
    """v_n [m/s], into the ground."""
    tangential_velocity: Scalar
    angular_velocity: Scalar
    closing: Scalar
    """Velocity at which the lowest point goes into the ground [m/s]."""


def _touch(body: Body, outline: Outline, normal_x: Scalar, normal_y: Scalar) -> Touch:
    """The body in the frame of the plane that it touches, by the plane's N."""
    slope = jnp.arctan(normal_x / jnp.maximum(normal_y, STEEPEST))
    sin, cos = jnp.sin(slope), jnp.cos(slope)
    theta = turned_on(outline, body.orientation - slope, body.angular_velocity)
    _, arm = support(outline, jnp.sin(theta), jnp.cos(theta))
    v_n = -(body.v_x * sin + body.v_y * cos)
    v_t = body.v_x * cos - body.v_y * sin
    closing = v_n + arm * body.angular_velocity
    return Touch(slope, theta, v_n, v_t, body.angular_velocity, closing)


def _impact(touch: Touch) -> Impact:
    """The impact that a touch is.

    The angle may pass 90 degrees: a turning block can strike while its centre rises.
    """
    v_n, v_t = touch.normal_velocity, touch.tangential_velocity
    speed = jnp.maximum(jnp.sqrt(v_n**2 + v_t**2), 1e-12)
    # Half the angle, from the side on which nothing cancels.
    steep = v_n >= 0.0
    towards = v_t / jnp.where(steep, speed + v_n, 1.0)
    away = (speed - v_n) / jnp.where(v_t == 0.0, 1e-300, v_t)
    return Impact(
        speed=speed,
        angle=2.0 * jnp.arctan(jnp.where(steep, towards, away)),
        orientation=touch.orientation,
        angular_velocity=touch.angular_velocity,
        slope=touch.slope,
    )


class Blow(NamedTuple):
    """What an impact does to a block."""

    normal_velocity: Scalar
    """v_n after [m/s]."""
    tangential_velocity: Scalar
    angular_velocity: Scalar
    duration: Scalar
    """[s]"""
    rotation: Scalar
    """During contact [rad]."""
    sinking: Scalar
    """Of the block's deepest point at the end [m]."""


class Settled(NamedTuple):
    """A block after a contact, tangent to the plane again."""

    orientation: Scalar
    """Theta [rad]."""
    rise: Scalar
    """Of the centre along N, from touch to now [m]."""
    travel: Scalar
    """Along t [m]."""
    normal_velocity: Scalar
    tangential_velocity: Scalar
    angular_velocity: Scalar
    leaving: Scalar
    """Velocity at which the lowest point leaves the ground [m/s]."""
    climbs: Scalar
    """1 where the block's energy lifts it out of the ground."""


def _settle(
    outline: Outline, matter: Matter, touch: Touch, gap: Scalar, blow: Blow
) -> Settled:
    """The block set back on the plane.

    It ends its contact some way in the ground and has to climb out of it: m g cos w
    times that depth is taken from its kinetic energy, from all velocities alike. With
    it goes what it was in the ground by, or above it, as it touched. The model does not
    follow how far the block gets along the plane during contact: that is the duration
    times the mean of v_t before and after.

    Args:
        gap: between block and plane at touch [m]; negative where it was in the ground.
    """
    theta = touch.orientation + blow.rotation
    before, _ = support(outline, jnp.sin(touch.orientation), jnp.cos(touch.orientation))
    radius, arm = support(outline, jnp.sin(theta), jnp.cos(theta))
    v_n, v_t, spin = blow[:3]
    kinetic = 0.5 * (matter.mass * (v_n**2 + v_t**2) + matter.inertia * spin**2)
    climb = matter.mass * GRAVITY * jnp.cos(touch.slope) * (blow.sinking - gap)
    left = kinetic - climb
    share = safe_sqrt(left / jnp.where(kinetic > 0.0, kinetic, 1.0))
    v_n, v_t, spin = share * v_n, share * v_t, share * spin
    return Settled(
        orientation=theta,
        # One that cannot climb stays as deep as it is.
        rise=radius - before - jnp.where(left > 0.0, gap, blow.sinking),
        travel=0.5
        * (touch.tangential_velocity + blow.tangential_velocity)
        * blow.duration,
        normal_velocity=v_n,
        tangential_velocity=v_t,
        angular_velocity=spin,
        leaving=-(v_n + arm * spin),
        climbs=(left > 0.0).astype(float),
    )


touch = closed_form(_touch)
impact_of = closed_form(_impact)
settle = closed_form(_settle)

r"""A block on the ground at a break of the slope.

Angles here descend along the way that the block goes.

At a **convex** break the round block turns about the edge, from one segment to the
next, as long as its weight holds it there: $v^2 \le g r\cos\alpha$ with $\alpha$ going
from one descent to the other. Where that ends it flies. On the way over a crest it has
to be lifted by $r(\cos\alpha - \cos w)$; one that is too slow goes back. A block that
slides flies if it does at once, with the radius of curvature of its flat side.

At a **concave** break it runs into the next segment.
"""

from typing import NamedTuple

import jax.numpy as jnp

from ..safe import safe_sqrt
from ..scene import GRAVITY
from .contact import Matter
from .motion import Outline, Scalar, support
from .programs import closed_form
from .rolling import mean_radius

PAST_THE_EDGE = 1e-3
"""Turn beyond the one at which a block leaves the edge, at which its flight begins
[rad]; at the very one it would leave too slowly to be told from staying."""


class Crossing(NamedTuple):
    """What a block does at a break."""

    goes_back: Scalar
    """1 where it does not get over a crest."""
    stays: Scalar
    """1 where its energy takes it nowhere."""
    flies: Scalar
    """1 where it leaves the ground."""
    descent: Scalar
    """Where it leaves: angle at which it moves, downwards [rad]."""
    speed: Scalar
    """At the start of the next segment, or as it goes back [m/s]."""
    normal_velocity: Scalar
    """Where it leaves: v_n of the centre [m/s]."""
    tangential_velocity: Scalar
    """Along the way [m/s]."""
    angular_velocity: Scalar
    """Positive as it rolls along the way [rad/s]."""


def _cross(
    outline: Outline,
    matter: Matter,
    speed_squared: Scalar,
    before: Scalar,
    after: Scalar,
    orientation: Scalar,
    rolls: Scalar,
) -> Crossing:
    """A block at a convex break. (At a concave one, where a block may come to stand
    that was in the ground, it goes on without an impact.)

    A block that flies has its ellipse over the edge, turning about it without slip, and
    the energy of the round block as it left.

    Args:
        speed_squared: along the way, with the centre over the edge [m2/s2]; negative
            if its energy does not suffice for that place.
        before, after: descents of the plane on which it stands and of the next
            segment [rad].
        orientation: from the vertical to the major axis, positive towards the way.
        rolls: 1 if it rolls, 0 if it slides.
    """
    mass, inertia = matter
    rolling = rolls > 0.0
    radius = jnp.where(rolling, mean_radius(outline), outline.smallest)
    ratio = jnp.where(rolling, inertia / (mass * radius**2), 0.0)
    whole = 1.0 + ratio
    least, most = jnp.minimum(before, after), jnp.maximum(before, after)
    top = jnp.clip(0.0, least, most)
    gain = 2.0 * GRAVITY * radius / whole
    crest = gain * (jnp.cos(top) - jnp.cos(before))
    end_squared = speed_squared + gain * (jnp.cos(before) - jnp.cos(after))
    short = (crest > 0.0) & (speed_squared < crest)
    goes_back = short & (speed_squared >= 0.0)
    stays = (short & (speed_squared < 0.0)) | (end_squared < 0.0)
    # v^2 / (g r) at the edge, as it was before the turn.
    froude = speed_squared / (GRAVITY * radius)
    at_once = froude > jnp.cos(before)
    cos = (froude + 2.0 / whole * jnp.cos(before)) / (1.0 + 2.0 / whole)
    cos = jnp.clip(cos, -1.0 + 1e-12, 1.0)
    angle = 2.0 * jnp.arctan(safe_sqrt((1.0 - cos) / (1.0 + cos))) + PAST_THE_EDGE
    angle = jnp.where(at_once, before, angle)
    at_angle = safe_sqrt(speed_squared + gain * (jnp.cos(before) - jnp.cos(angle)))
    # The ellipse in the round block's place.
    theta = orientation - angle
    height, arm = support(outline, jnp.sin(theta), jnp.cos(theta))
    lift = (height - radius) * jnp.cos(angle) + arm * jnp.sin(angle)
    kinetic = 0.5 * mass * whole * at_angle**2 - mass * GRAVITY * lift
    about_edge = mass * (height**2 + arm**2) + inertia
    spin = safe_sqrt(2.0 * kinetic / about_edge)
    loose = (kinetic > 0.0) & (height * spin**2 > GRAVITY * jnp.cos(angle))
    curvature = outline.largest**2 / outline.smallest
    slips = speed_squared > GRAVITY * curvature * jnp.cos(before)
    slips &= before + PAST_THE_EDGE < after
    flies = jnp.where(rolling, (angle < after) & loose, slips) & ~short & ~stays
    speed = safe_sqrt(speed_squared)
    return Crossing(
        goes_back=goes_back.astype(float),
        stays=stays.astype(float),
        flies=flies.astype(float),
        descent=jnp.where(rolling, angle, before),
        speed=jnp.where(goes_back, speed, safe_sqrt(end_squared)),
        normal_velocity=jnp.where(rolling, -arm * spin, 0.0),
        tangential_velocity=jnp.where(rolling, height * spin, speed),
        angular_velocity=jnp.where(rolling, spin, 0.0),
    )


cross = closed_form(_cross)

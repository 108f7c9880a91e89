r"""Coordinates of an impact that is looked up in a table.

With $u_n = v_n + T\Omega$ and $u_t = v_t - r\Omega$ of the point that touches, and
$s = \Omega R$, the total speed $w = \sqrt{u_n^2 + u_t^2 + s^2}$ and two angles say how
a block arrives: the elevation $\epsilon = \arcsin(u_n/w)$, in $(0, \pi/2]$ for every
impact, and the azimuth $\alpha = \mathrm{atan2}(s, k u_t)$. So the table holds impacts
that close and no others, those included that strike while their centre rises. The
factor k sets more azimuths where blocks roll, $u_t = 0$, as they do in a run-out.
"""

import math
from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..block import Block
from ..scene import GRAVITY, Impact

Scalar = Float[Array, ""]

SLIP_FACTOR = 3.0
"""k."""
FLATTEST = 5e-4
"""Smallest elevation in a table [rad]."""
BEND = 3.0
"""Nodes of elevation are even in its root of this degree: dense where blocks graze."""
STEEPEST = 0.5 * math.pi
"""Largest elevation [rad]."""


class Direction(NamedTuple):
    """How a block arrives."""

    total_speed: Scalar
    """w [m/s]."""
    elevation: Scalar
    """epsilon [rad]; not positive: the point moves away."""
    azimuth: Scalar
    """alpha [rad]."""


def gravity_speed(block: Block) -> Scalar:
    """sqrt(g R) [m/s]: below it gravity takes part in an impact."""
    return jnp.sqrt(GRAVITY * block.semi_axes.minor)


def _arms(block: Block, orientation: Scalar) -> tuple[Scalar, Scalar]:
    axes, shape = block.semi_axes, block.shape

    def at(sin, cos):
        return shape.support(axes, sin, cos), shape.tangency_arm(axes, sin, cos)

    # Shapes are for scalars.
    return jnp.vectorize(at)(jnp.sin(orientation), jnp.cos(orientation))


def direction_of(block: Block, impact: Impact) -> Direction:
    """The coordinates of an impact."""
    radius, arm = _arms(block, impact.orientation)
    spin = impact.angular_velocity
    closing = impact.normal_velocity + arm * spin
    slip = impact.tangential_velocity - radius * spin
    turning = spin * block.semi_axes.minor
    flat = jnp.hypot(slip, turning)
    return Direction(
        jnp.hypot(closing, flat),
        jnp.arctan2(closing, flat),
        jnp.arctan2(turning, SLIP_FACTOR * slip),
    )


def impact_from(
    block: Block, direction: Direction, orientation: Scalar, slope: Scalar
) -> Impact:
    """The impact of these coordinates; its angle may pass 90 degrees."""
    radius, arm = _arms(block, orientation)
    true = jnp.arctan2(
        SLIP_FACTOR * jnp.sin(direction.azimuth), jnp.cos(direction.azimuth)
    )
    flat = direction.total_speed * jnp.cos(direction.elevation)
    spin = flat * jnp.sin(true) / block.semi_axes.minor
    normal = direction.total_speed * jnp.sin(direction.elevation) - arm * spin
    tangential = flat * jnp.cos(true) + radius * spin
    return Impact(
        speed=jnp.hypot(normal, tangential),
        angle=jnp.arctan2(tangential, normal),
        orientation=orientation,
        angular_velocity=spin,
        slope=slope,
    )

"""A round block leaves the ground as the section that it stands for."""

from typing import NamedTuple

import jax.numpy as jnp

from ...scene import GRAVITY
from ..blocks import support
from ..lane_programs import Values, closed_form
from ..state import BlockConstants, BlockState, Phase


class TakeOff(NamedTuple):
    """Block that leaves the ground."""

    block: BlockState
    flies: Values
    """1 where the section leaves the ground too; else the block rolls on."""


@closed_form
def take_off(
    block: BlockState, constants: BlockConstants, normal_x: Values, normal_y: Values
) -> TakeOff:
    """Let blocks leave the ground.

    A block that rolled has its section over the point that it touched, turning about it
    without slip, with the energy of the round block. It flies if it is fast enough for
    that. A block that slid flies as it lies.

    Args:
        normal_x, normal_y: normal of the path where it leaves.
    """
    mass, inertia = constants.mass_properties
    direction, body, rolls = block.direction, block.body, block.is_rolling
    radius = constants.centre_height(block.rolls)
    speed = block.speed
    theta = body.orientation - jnp.arctan2(normal_x, normal_y)
    height, arm = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    height = jnp.where(rolls, height, radius)
    arm = jnp.where(rolls, arm, 0.0)
    rise = (height - radius) * normal_y + arm * normal_x
    whole = mass * radius**2 + inertia
    kinetic = 0.5 * whole * (speed / radius) ** 2 - mass * GRAVITY * rise
    about_edge = mass * (height**2 + arm**2) + inertia
    spin = direction * jnp.sqrt(2.0 * jnp.maximum(kinetic, 0.0) / about_edge)
    loose = (kinetic > 0.0) & (height * spin**2 > GRAVITY * normal_y)
    v_n = jnp.where(rolls, -arm * spin, 0.0)
    v_t = jnp.where(rolls, height * spin, direction * speed)
    flying = block._replace(
        phase=jnp.full_like(block.phase, float(Phase.airborne))
    ).moved(
        x=body.x + (height - radius) * normal_x - arm * normal_y,
        y=body.y + rise,
        v_x=v_t * normal_y - v_n * normal_x,
        v_y=-v_t * normal_x - v_n * normal_y,
        angular_velocity=jnp.where(rolls, spin, 0.0),
    )
    return TakeOff(flying, loose | ~rolls)

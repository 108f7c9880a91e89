"""A block on the ground strikes what the path of its centre turns up against."""

from typing import NamedTuple

import jax.numpy as jnp

from ..blocks import support
from ..lane_programs import Values, closed_form
from ..state import BlockConstants, BlockState, Phase
from .rolling import small_speed


class Corner(NamedTuple):
    """Corner of the path of a block's centre; directions are normals out of the
    ground."""

    here_x: Values
    """Normal of the path along which the block came."""
    here_y: Values
    ahead_x: Values
    """Normal of the plane that it strikes."""
    ahead_y: Values
    segment: Values
    """Number of the segment that it strikes."""


@closed_form
def strike_corner(
    block: BlockState, constants: BlockConstants, corner: Corner
) -> BlockState:
    """Let a block strike the ground ahead, with its velocity along the path.

    The round block strikes; where the ellipse in its place would turn away from the
    plane, it does so along its nearest axis.
    """
    direction, body = block.direction, block.body
    speed = block.speed
    height = constants.centre_height(block.rolls)
    spin = jnp.where(block.is_rolling, direction * speed / height, 0.0)
    sin, cos = corner.ahead_x, corner.ahead_y
    slope = jnp.arctan2(sin, cos)
    turn = direction * (corner.here_x * cos - corner.here_y * sin)
    closing = speed * turn
    theta = body.orientation - slope
    _, arm = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    small = small_speed(constants.outline.smallest, slope)
    upright = jnp.floor(theta / (0.5 * jnp.pi) + 0.5) * (0.5 * jnp.pi)
    theta = jnp.where(closing + arm * spin < small, upright, theta)
    reach, _ = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    return block._replace(
        segment=corner.segment,
        phase=jnp.full_like(block.phase, float(Phase.touching)),
        normal_x=sin,
        normal_y=cos,
        gap=height - reach,
    ).moved(
        v_x=direction * speed * corner.here_y,
        v_y=-direction * speed * corner.here_x,
        angular_velocity=spin,
        orientation=theta + slope,
    )

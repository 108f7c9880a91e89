"""Blocks that come to lie or roll on the ground, and how slow counts as still."""

import jax.numpy as jnp

from ...scene import GRAVITY
from ..lane_programs import Values
from ..state import BlockConstants, BlockState
from ..trajectory import Ending
from .rolling import begin_ground_motion

SMALL_RISE = 1e-2
"""Fraction of the smaller semi-axis; energies that would lift a block by less count as
none: hops so low are not followed, and touches so slow are no impacts. They take less
time than a contact does; with a tenth of it a sphere that has come to rolling continues
in hundreds of hops of 0.2 mm."""


def small_speed(smallest: Values, slope: Values) -> Values:
    """Compute the speed across a plane below which there is no hop or impact [m/s].

    Args:
        smallest: height of the centre of the block lying on its flat side [m].
    """
    return jnp.sqrt(2.0 * GRAVITY * jnp.cos(slope) * SMALL_RISE * smallest)


def begin_on_ground(
    block: BlockState,
    constants: BlockConstants,
    plane: Values,
    rolling_friction: Values,
    height: Values,
    tangential_velocity: Values,
    angular_velocity: Values,
) -> BlockState:
    """Begin motion along the ground: decide whether a block rolls, where to, how fast.

    The block lies on `block.segment`, or on an edge if that is set.

    Args:
        plane: angle of the plane on which it rests [rad].
        rolling_friction: that of the segment.
        height: height of its centre over the plane [m].
        tangential_velocity, angular_velocity: velocities along it [m/s], and of
            rotation [rad/s].
    """
    motion = begin_ground_motion(
        *(constants, plane, rolling_friction),
        *(height, tangential_velocity, angular_velocity),
    )
    stays, body = motion.stays > 0.0, block.body
    over = jnp.where(stays, 0.0, constants.centre_height(motion.rolls) - height)
    lying = lying_orientation(body.orientation, constants, plane)
    begun = block._replace(
        rolls=motion.rolls,
        direction=motion.direction,
        speed_squared=motion.speed_squared,
        plane=plane,
    ).moved(
        x=body.x + over * jnp.sin(plane),
        y=body.y + over * jnp.cos(plane),
        orientation=jnp.where(motion.rolls > 0.0, body.orientation, lying),
    )
    return begun.ended(Ending.stopped, stays)


def lying_orientation(
    orientation: Values, constants: BlockConstants, plane: Values
) -> Values:
    """Turn the nearest flat side of a block to the ground [rad]."""
    axes = constants.outline.axes
    quarter = jnp.where(axes.major >= axes.minor, 0.5 * jnp.pi, 0.0)
    turns = jnp.floor((orientation - plane - quarter) / jnp.pi + 0.5)
    return plane + turns * jnp.pi + quarter

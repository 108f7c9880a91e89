"""A block on the ground runs into other ground: an impact, or it goes on there."""

from typing import NamedTuple

import jax.numpy as jnp

from ..blocks import support
from ..lane_programs import Values
from ..state import BlockConstants, BlockState, Phase, choose
from ..trajectory import Ending
from .rolling import begin_on_ground, small_speed


class Plane(NamedTuple):
    """Plane that a block on the ground runs into: that of a segment, or the one between
    two segments at the point where they meet."""

    x: Values
    """A point of the plane [m]."""
    y: Values
    slope: Values
    """Angle w of the plane [rad]."""
    segment: Values
    """Number of the segment."""
    point: Values
    """Number of the point between two; -1 for a segment."""
    rolling_friction: Values
    """Tangent of the angle of rolling friction there."""
    turn: Values
    """Angle by which the ground turns up to it, in the direction of motion [rad]."""


def run_into(
    block: BlockState,
    constants: BlockConstants,
    plane: Plane,
    here: Values,
    rolling_friction: Values,
) -> BlockState:
    """Let a block strike a plane; one too slow for an impact continues along it or
    stops.

    Args:
        here: angle of the plane along which it came [rad].
        rolling_friction: tangent of the angle of rolling friction there.
    """
    body, direction, after = block.body, block.direction, plane.slope
    speed = block.speed
    spin = direction * speed / constants.centre_height(block.rolls)
    spin = jnp.where(block.is_rolling, spin, 0.0)
    sin, cos = jnp.sin(after), jnp.cos(after)
    over = sin * (body.x - plane.x) + cos * (body.y - plane.y)
    closing = speed * jnp.sin(plane.turn)
    small = small_speed(constants.outline.smallest, after)
    slow = closing < small
    theta = body.orientation - after
    _, arm = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    # The round block strikes; where the ellipse in its place would turn away from the
    # plane, it does so along its nearest axis.
    turns_away = closing + arm * spin < small
    upright = jnp.floor(theta / (0.5 * jnp.pi) + 0.5) * (0.5 * jnp.pi)
    theta = jnp.where(turns_away & ~slow, upright, theta)
    reach, _ = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    strikes = block._replace(
        segment=plane.segment,
        phase=jnp.full_like(block.phase, float(Phase.touching)),
        normal_x=sin,
        normal_y=cos,
        gap=over - reach,
    ).moved(
        v_x=direction * speed * jnp.cos(here),
        v_y=-direction * speed * jnp.sin(here),
        angular_velocity=spin,
        orientation=theta + after,
    )
    between = plane.point >= 0.0
    goes_on = begin_on_ground(
        strikes._replace(
            phase=jnp.where(between, float(Phase.at_edge), float(Phase.grounded)),
            edge=jnp.where(between, plane.point, block.edge),
        ),
        *(constants, after, plane.rolling_friction, over),
        *(direction * speed * jnp.cos(plane.turn), spin),
    )
    rises = jnp.sin(direction * after) < rolling_friction * cos
    stops = (speed < small) & rises
    slowly = choose(stops, strikes.ended(Ending.stopped), goes_on)
    return choose(slow, slowly, strikes)

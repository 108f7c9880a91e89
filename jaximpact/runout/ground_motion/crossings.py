"""Transition of blocks over convex breaks: into the air, on, back, or off the
profile."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...scene import GRAVITY
from ..blocks import support
from ..lane_programs import Values, call, closed_form, root
from ..state import BlockConstants, BlockState, Limits, Phase, State, choose
from ..trajectory import Ending
from .rolling import SMALL_RISE, Crossing, begin_on_ground, cross_break


class Side(NamedTuple):
    """Segment at one side of an edge."""

    exists: Values
    """1 where there is one."""
    segment: Values
    """Its number."""
    slope: Values
    """Its angle [rad]."""


class Edge(NamedTuple):
    """Break of the profile, or one of its ends, and the segments at both sides."""

    x: Values
    """The profile's point [m]."""
    y: Values
    left: Side
    right: Side


class EdgeFrictions(NamedTuple):
    """Tangents of the angles of rolling friction at both sides of an edge."""

    left: Values
    right: Values


def cross_edges(state: State, lanes: np.ndarray) -> None:
    """Move blocks over convex breaks, into the air, back, or off the profile."""
    profile, blocks = state.profile, state.blocks.at(lanes)
    point = blocks.value.edge.astype(int)
    left, right = np.maximum(point - 1, 0), np.minimum(point, profile.segments - 1)

    def frictions(ground) -> EdgeFrictions:
        rolling = ground.rolling_friction
        return EdgeFrictions(rolling[..., lanes, left], rolling[..., lanes, right])

    crossed = call(
        _cross,
        blocks,
        state.constants.at(lanes),
        Edge(
            *(profile.x[point], profile.y[point]),
            left=Side(point > 0, point - 1, state.slope[left]),
            right=Side(point < profile.segments, point, state.slope[right]),
        ),
        state.ground.map(frictions),
        state.limits,
    )
    state.blocks.put(lanes, crossed)


@closed_form
def _cross(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    frictions: EdgeFrictions,
    limits: Limits,
) -> BlockState:
    """Move a block over an edge, or back from it."""
    direction, plane = block.direction, block.plane
    beyond, friction = _side(edge, frictions, direction)
    height = constants.centre_height(block.rolls)
    whole = 1.0 + constants.inertia_ratio(block.rolls)
    # Bringing the centre over the edge costs or gives energy.
    rise = edge.y + height * jnp.cos(plane) - block.body.y
    squared = block.speed_squared - 2.0 * GRAVITY * rise / whole
    # Rounding of the position must not turn back a block that is at the edge.
    there = jnp.abs(rise) < 1e-9 * height
    squared = jnp.where(there, block.speed_squared, squared)
    outline = constants.outline
    # A flight is not followed that lifts the block by less than it heaves as it rolls,
    # or by next to nothing.
    hop = jnp.maximum(
        limits.hop_threshold * outline.heave, SMALL_RISE * outline.smallest
    )
    crossing = cross_break(
        constants,
        speed_squared=squared,
        before=direction * plane,
        after=direction * beyond.slope,
        orientation=direction * block.body.orientation,
        rolls=block.rolls,
        hop=hop,
    )
    crossed = choose(
        crossing.flies > 0.0,
        _fly_off(block, constants, edge, crossing),
        _begin_segment(block, constants, edge, beyond, friction, crossing.speed),
    )
    crossed = choose(crossing.stays > 0.0, block.ended(Ending.stopped), crossed)
    back = _go_back(block, constants, edge, frictions, crossing.speed)
    crossed = choose(crossing.goes_back > 0.0, back, crossed)
    left = block.ended(Ending.left_profile)
    return choose(beyond.exists > 0.0, crossed, left).counted(limits)


def _side(
    edge: Edge, frictions: EdgeFrictions, direction: Values
) -> tuple[Side, Values]:
    """Give the segment beyond an edge in a direction, and its rolling friction."""
    right = direction > 0.0
    side = choose(right, edge.right, edge.left)
    return side, jnp.where(right, frictions.right, frictions.left)


def _go_back(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    frictions: EdgeFrictions,
    speed: Values,
) -> BlockState:
    """Return a block that does not get over a crest to the segment on this side of it;
    stop one that lacks the energy for it."""
    block = block._replace(direction=-block.direction)
    side, friction = _side(edge, frictions, block.direction)
    height = constants.centre_height(block.rolls)
    # Loss of squared speed with height [m/s2].
    rate = 2.0 * GRAVITY / (1.0 + constants.inertia_ratio(block.rolls))
    rise = height * (jnp.cos(side.slope) - jnp.cos(block.plane))
    squared = speed**2 - rate * rise
    # Only rounding is left for a block that came from that segment.
    squared = jnp.where(jnp.abs(squared) < 1e-9 * rate * height, 0.0, squared)
    goes = _begin_segment(block, constants, edge, side, friction, root(squared))
    back = choose(squared < 0.0, block.ended(Ending.stopped), goes)
    return choose(side.exists > 0.0, back, block.ended(Ending.left_profile))


def _fly_off(
    block: BlockState, constants: BlockConstants, edge: Edge, crossing: Crossing
) -> BlockState:
    """Let a block leave the ground over an edge."""
    direction = block.direction
    slope = direction * crossing.descent
    sin, cos = jnp.sin(slope), jnp.cos(slope)
    theta = block.body.orientation - slope
    height, arm = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    arm = jnp.where(block.is_rolling, arm, 0.0)
    v_n, v_t = crossing.normal_velocity, direction * crossing.tangential_velocity
    return block._replace(
        phase=jnp.full_like(block.phase, float(Phase.airborne))
    ).moved(
        x=edge.x - arm * cos + height * sin,
        y=edge.y + arm * sin + height * cos,
        v_x=v_t * cos - v_n * sin,
        v_y=-v_t * sin - v_n * cos,
        angular_velocity=direction * crossing.angular_velocity,
    )


def _begin_segment(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    side: Side,
    rolling_friction: Values,
    speed: Values,
) -> BlockState:
    """Begin motion along a segment at an edge."""
    direction, slope = block.direction, side.slope
    height = constants.centre_height(block.rolls)
    spin = jnp.where(block.is_rolling, direction * speed / height, 0.0)
    begun = block._replace(
        segment=side.segment,
        phase=jnp.full_like(block.phase, float(Phase.grounded)),
    ).moved(x=edge.x + height * jnp.sin(slope), y=edge.y + height * jnp.cos(slope))
    return begin_on_ground(
        *(begun, constants, slope, rolling_friction),
        *(height, direction * speed, spin),
    )

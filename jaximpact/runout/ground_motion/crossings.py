"""Transition of blocks over convex breaks: into the air, on, back, or off the
profile."""

from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...scene import GRAVITY
from ..blocks import select, support
from ..lane_programs import ClosedProgram, Values, closed_form
from ..narrow_places import NONE
from ..state import BlockConstants, BlockState, Limits, Phase, State, choose
from ..terrain import SAME_PLANE
from ..trajectory import Ending
from .obstacles import Obstacle, obstacles_about, plane_at, turn_to
from .rolling import SMALL_RISE, Crossing, begin_on_ground, cross_break
from .running_into import run_into


class Side(NamedTuple):
    """Segment at one side of an edge."""

    exists: Values
    """1 where there is one."""
    segment: Values
    """Index of the segment."""
    slope: Values
    """Slope angle of the segment [rad]."""


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
    others = state.narrow.about[state.blocks.edge[lanes].astype(int)]
    narrow = others[:, 0] != NONE
    if np.any(narrow):
        there, others = lanes[narrow], others[narrow]
        meets, obstacle = _obstacles(state, there, others, 1.0)
        behind, _ = _obstacles(state, there, others, -1.0)
        _advance(state, _turn_to_obstacle, there[meets], select(obstacle, meets))
        _advance(state, _cross_before_obstacle, there[behind & ~meets])
        narrow[narrow] = meets | behind
    _advance(state, _cross, lanes[~narrow])


def _obstacles(
    state: State, lanes: np.ndarray, others: np.ndarray, way: float
) -> tuple[np.ndarray, Obstacle]:
    """Find what blocks run into as they turn about points.

    Args:
        others: segments that they may touch, a row of `NarrowPlaces.about` for each.
        way: 1 for the turn in the direction of motion, -1 for the turn back.
    """
    block, constants = select((state.blocks, state.constants), lanes)
    point, direction = block.edge.astype(int), way * block.direction
    beyond = np.where(direction > 0.0, point, point - 1)
    exists = (beyond >= 0) & (beyond < state.profile.segments)
    after = direction * state.slope[np.where(exists, beyond, 0)]
    meets, obstacle = obstacles_about(
        *(state.profile, others, point, (direction * block.plane, after), direction),
        height=np.where(
            block.rolls > 0.0, constants.round.radius, constants.outline.smallest
        ),
    )
    return meets & exists, obstacle


def _advance(
    state: State,
    transition: ClosedProgram,
    lanes: np.ndarray,
    obstacle: Obstacle | None = None,
) -> None:
    """Move blocks over breaks by one of the transitions."""
    if not len(lanes):
        return
    profile, rolling = state.profile, state.ground.rolling_friction
    blocks, constants = select((state.blocks, state.constants), lanes)
    point = blocks.edge.astype(int)
    left, right = np.maximum(point - 1, 0), np.minimum(point, profile.segments - 1)
    edge = Edge(
        *(profile.x[point], profile.y[point]),
        left=Side(point > 0, point - 1, state.slope[left]),
        right=Side(point < profile.segments, point, state.slope[right]),
    )
    more: tuple = ()
    if obstacle is not None:
        segment = obstacle.segment.astype(int)
        more = obstacle, rolling[lanes, segment]
    frictions = EdgeFrictions(rolling[lanes, left], rolling[lanes, right])
    crossed = transition(blocks, constants, edge, frictions, *more, state.limits)
    state.move(lanes, crossed)


@closed_form
def _cross(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    frictions: EdgeFrictions,
    limits: Limits,
) -> BlockState:
    """Move a block over an edge, or back from it."""
    return _crossed(block, constants, edge, frictions, limits, _go_back)


@closed_form
def _cross_before_obstacle(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    frictions: EdgeFrictions,
    limits: Limits,
) -> BlockState:
    """Move a block over an edge, or back from it where an obstacle is in that way."""
    return _crossed(block, constants, edge, frictions, limits, _turn_back)


def _crossed(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    frictions: EdgeFrictions,
    limits: Limits,
    go_back: Callable,
) -> BlockState:
    direction = block.direction
    beyond, friction = _side(edge, frictions, direction)
    crossing = _crossing(block, constants, edge, direction * beyond.slope, limits)
    crossed = choose(
        crossing.flies > 0.0,
        _fly_off(block, constants, edge, crossing),
        _begin_segment(block, constants, edge, beyond, friction, crossing.speed),
    )
    crossed = choose(crossing.stays > 0.0, block.ended(Ending.stopped), crossed)
    back = go_back(block, constants, edge, frictions, crossing.speed)
    crossed = choose(crossing.goes_back > 0.0, back, crossed)
    left = block.ended(Ending.left_profile)
    return choose(beyond.exists > 0.0, crossed, left).counted(limits)


@closed_form
def _turn_to_obstacle(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    frictions: EdgeFrictions,
    obstacle: Obstacle,
    obstacle_friction: Values,
    limits: Limits,
) -> BlockState:
    """Turn a block about an edge towards what it runs into before the end of the turn,
    or back.

    Args:
        obstacle_friction: tangent of the angle of rolling friction there.
    """
    direction, height = block.direction, constants.centre_height(block.rolls)
    _, friction = _side(edge, frictions, -direction)
    angle = turn_to(obstacle, (edge.x, edge.y), direction, height)
    angle = jnp.maximum(angle, direction * block.plane)
    crossing = _crossing(block, constants, edge, angle, limits)
    here = direction * angle
    there = _turned(block, constants, edge, here, crossing.speed)
    plane = plane_at(obstacle, there.body, here, direction, obstacle_friction)
    crossed = choose(
        crossing.flies > 0.0,
        _fly_off(block, constants, edge, crossing),
        run_into(there, constants, plane, here, friction),
    )
    crossed = choose(crossing.stays > 0.0, block.ended(Ending.stopped), crossed)
    back = _turn_back(block, constants, edge, frictions, crossing.speed)
    return choose(crossing.goes_back > 0.0, back, crossed).counted(limits)


def _turn_back(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    frictions: EdgeFrictions,
    speed: Values,
) -> BlockState:
    """Let a block that does not get over a crest turn back about the edge, where it may
    run into something; one that came along the segment goes back there."""
    side, _ = _side(edge, frictions, -block.direction)
    on_side = jnp.abs(jnp.sin(block.plane - side.slope)) <= SAME_PLANE
    turned = _turned(block, constants, edge, block.plane, speed)
    turned = turned._replace(direction=-block.direction)
    back = _go_back(block, constants, edge, frictions, speed)
    return choose(on_side | (back.phase == Phase.ended), back, turned)


def _turned(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    plane: Values,
    speed: Values,
) -> BlockState:
    """Place a block on an edge, with a speed and the plane on which it rests."""
    height = constants.centre_height(block.rolls)
    return block._replace(plane=plane, speed_squared=speed**2).moved(
        x=edge.x + height * jnp.sin(plane), y=edge.y + height * jnp.cos(plane)
    )


def _crossing(
    block: BlockState,
    constants: BlockConstants,
    edge: Edge,
    after: Values,
    limits: Limits,
) -> Crossing:
    """Compute the motion of a block over an edge, to the plane of an angle `after`,
    which descends in the direction of motion [rad]."""
    direction, plane = block.direction, block.plane
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
    return cross_break(
        constants,
        speed_squared=squared,
        before=direction * plane,
        after=after,
        orientation=direction * block.body.orientation,
        rolls=block.rolls,
        hop=hop,
    )


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
    goes = _begin_segment(
        *(block, constants, edge, side, friction),
        speed=jnp.sqrt(jnp.maximum(squared, 0.0)),
    )
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

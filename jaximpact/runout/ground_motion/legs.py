"""Transition of blocks that move along a segment, to its end or as far as they get."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...scene import GRAVITY
from ..blocks import select
from ..lane_programs import Values, closed_form
from ..narrow_places import NONE
from ..state import BlockConstants, BlockState, Limits, Phase, State, choose
from ..terrain import SAME_PLANE
from ..trajectory import Ending, MotionMode, Pieces
from .obstacles import Obstacle, distance_to, obstacles_along, plane_at
from .rolling import Leg, barrier, follow_segment, lying_orientation
from .running_into import Plane, run_into


class End(NamedTuple):
    """End of a segment, and the segment beyond it."""

    point: Values
    """Number of the profile's point."""
    x: Values
    """The point [m]."""
    y: Values
    exists: Values
    """1 where there is a segment beyond it."""
    segment: Values
    """Index of the segment."""
    slope: Values
    """Slope angle of the segment [rad]."""


class LocalGround(NamedTuple):
    """Segment that a block is on."""

    left: End
    right: End
    length: Values
    """Length of the segment [m]."""
    slope: Values
    """Angle w of the segment [rad]."""


class Frictions(NamedTuple):
    """Tangents of angles of friction on a segment and those beside it."""

    rolling: Values
    sliding: Values
    rolling_left: Values
    rolling_right: Values


class _Break(NamedTuple):
    """End of the segment towards which a block moves."""

    end: End
    rolling_friction: Values
    """Tangent of the angle of rolling friction beyond it."""
    turn: Values
    """Angle by which the ground turns up there [rad]; 0 at the profile's ends."""


def move_along(state: State, lanes: np.ndarray) -> None:
    """Move blocks along their segments, to the end or as far as they get."""
    _find_segments(state, lanes)
    place = state.blocks.segment[lanes].astype(int)
    others = state.narrow.along[place]
    narrow = others[:, 0] != NONE
    if np.any(narrow):
        meets, obstacle = _obstacles(state, lanes[narrow], others[narrow])
        narrow[narrow] = meets
        _advance(state, lanes[narrow], select(obstacle, meets))
    _advance(state, lanes[~narrow])


def _obstacles(
    state: State, lanes: np.ndarray, others: np.ndarray
) -> tuple[np.ndarray, Obstacle]:
    """Find what blocks in narrow places run into on their way."""
    block, constants = select((state.blocks, state.constants), lanes)
    own, profile = block.segment.astype(int), state.profile
    start, foot = _start(block, constants, _local_ground(state, own))
    right, length = start.direction > 0.0, state.length[own]
    return obstacles_along(
        *(profile, others, own, (start.body.x, start.body.y), start.direction),
        height=np.where(
            start.rolls > 0.0, constants.round.radius, constants.outline.smallest
        ),
        room=np.where(right, length - foot, foot),
    )


def _advance(state: State, lanes: np.ndarray, obstacle: Obstacle | None = None) -> None:
    """Move blocks along their segments, towards obstacles if there are any."""
    if not len(lanes):
        return
    blocks, constants = select((state.blocks, state.constants), lanes)
    place, rolling = blocks.segment.astype(int), state.ground.rolling_friction
    last = state.profile.segments - 1
    frictions = Frictions(
        rolling[lanes, place],
        state.ground.sliding_friction[lanes, place],
        rolling[lanes, np.maximum(place - 1, 0)],
        rolling[lanes, np.minimum(place + 1, last)],
    )
    given = blocks, constants, _local_ground(state, place), frictions
    if obstacle is None:
        after, leg = _move(*given, state.limits)
    else:
        friction = rolling[lanes, obstacle.segment.astype(int)]
        after, leg = _move_to_obstacle(*given, obstacle, friction, state.limits)
    state.move(lanes, after, leg)


def _local_ground(state: State, place: np.ndarray) -> LocalGround:
    """Describe segments, and their ends."""
    x, y, last = state.profile.x, state.profile.y, state.profile.segments - 1

    def end(point: np.ndarray, beyond: np.ndarray, exists: np.ndarray) -> End:
        slope = state.slope[np.clip(beyond, 0, last)]
        return End(point, x[point], y[point], exists, beyond, slope)

    return LocalGround(
        left=end(place, place - 1, place > 0),
        right=end(place + 1, place + 1, place < last),
        length=state.length[place],
        slope=state.slope[place],
    )


def _find_segments(state: State, lanes: np.ndarray) -> None:
    """Assign blocks that a contact took past the end of their segment to the next ones,
    as long as these go straight on."""
    block = state.blocks
    while len(lanes):
        place = block.segment[lanes].astype(int)
        x, y = block.body.x[lanes], block.body.y[lanes]
        slope, profile = state.slope[place], state.profile
        foot = np.cos(slope) * (x - profile.x[place])
        foot -= np.sin(slope) * (y - profile.y[place])
        right = block.direction[lanes] > 0.0
        past = np.where(right, foot > state.length[place], foot < 0.0)
        beyond = np.where(right, place + 1, place - 1)
        exists = (beyond >= 0) & (beyond < state.profile.segments)
        beyond = np.where(exists, beyond, place)
        turn = np.sin(state.slope[beyond] - state.slope[place])
        goes = past & exists & (np.abs(turn) <= SAME_PLANE)
        block.segment[lanes[goes]] = beyond[goes]
        lanes = lanes[goes]


@closed_form
def _move(
    block: BlockState,
    constants: BlockConstants,
    ground: LocalGround,
    frictions: Frictions,
    limits: Limits,
) -> tuple[BlockState, Pieces]:
    """Move a block along its segment, and decide how it goes on.

    Returns:
        The block, and its motion along the segment.
    """
    slope, rolls = ground.slope, block.rolls
    block, foot = _roll_down_to_mean_height(block, constants, ground)
    ahead = _break_ahead(block, ground, frictions)
    corner = ahead.turn > 0.0
    direction, height = block.direction, constants.centre_height(rolls)
    distance = jnp.where(direction > 0.0, ground.length - foot, foot)
    distance -= jnp.where(corner, height * jnp.tan(0.5 * ahead.turn), 0.0)
    block, arrives, needed, piece = _follow(
        block, constants, slope, frictions, distance
    )
    at_edge = block._replace(
        phase=jnp.full_like(block.phase, float(Phase.at_edge)),
        edge=ahead.end.point,
        plane=slope,
    )
    next_segment = Plane(
        *(ahead.end.x, ahead.end.y, ahead.end.slope, ahead.end.segment),
        *(-1.0, ahead.rolling_friction, ahead.turn),
    )
    corner_struck = run_into(block, constants, next_segment, slope, frictions.rolling)
    slow = _slow_down(block, constants, slope, frictions, needed)
    arrived = choose(corner, corner_struck, at_edge)
    moved = choose(arrives > 0.0, arrived, slow)
    moved = moved.ended(Ending.time_limit, block.time > limits.time)
    return moved.counted(limits), piece


@closed_form
def _move_to_obstacle(
    block: BlockState,
    constants: BlockConstants,
    ground: LocalGround,
    frictions: Frictions,
    obstacle: Obstacle,
    obstacle_friction: Values,
    limits: Limits,
) -> tuple[BlockState, Pieces]:
    """Move a block along its segment towards what it runs into before the end.

    Args:
        obstacle_friction: tangent of the angle of rolling friction there.

    Returns:
        The block, and its motion along the segment.
    """
    slope = ground.slope
    block, _ = _roll_down_to_mean_height(block, constants, ground)
    direction, height = block.direction, constants.centre_height(block.rolls)
    along = direction * jnp.cos(slope), -direction * jnp.sin(slope)
    block, arrives, needed, piece = _follow(
        *(block, constants, slope, frictions),
        distance_to(obstacle, block.body, along, height),
    )
    plane = plane_at(obstacle, block.body, slope, direction, obstacle_friction)
    struck = run_into(block, constants, plane, slope, frictions.rolling)
    slow = _slow_down(block, constants, slope, frictions, needed)
    moved = choose(arrives > 0.0, struck, slow)
    moved = moved.ended(Ending.time_limit, block.time > limits.time)
    return moved.counted(limits), piece


def _follow(
    block: BlockState,
    constants: BlockConstants,
    slope: Values,
    frictions: Frictions,
    distance: Values,
) -> tuple[BlockState, Values, Values, Pieces]:
    """Move a block along its segment by a distance, or as far as it gets.

    Returns:
        The block; 1 where it arrives; the least energy for rolling [J]; the motion.
    """
    ratio = constants.inertia_ratio(block.rolls)
    needed = barrier(constants, slope, frictions.rolling)
    needed = jnp.where(block.is_rolling, needed, 0.0)
    least = 2.0 * needed / (constants.mass_properties.mass * (1.0 + ratio))
    leg = follow_segment(
        speed=block.speed,
        descent=block.direction * slope,
        distance=distance,
        friction=jnp.where(block.is_rolling, frictions.rolling, frictions.sliding),
        inertia_ratio=ratio,
        least_speed=jnp.sqrt(jnp.maximum(least, 0.0)),
    )
    height = constants.centre_height(block.rolls)
    block, piece = _advanced(block, leg, slope, height)
    return block, leg.arrives, needed, piece


def _roll_down_to_mean_height(
    block: BlockState, constants: BlockConstants, ground: LocalGround
) -> tuple[BlockState, Values]:
    """Roll a block down that lacks the energy to roll.

    Returns:
        The block, and the distance of its centre along the segment from the left end
        [m].
    """
    body, slope = block.body, ground.slope
    sin, cos = jnp.sin(slope), jnp.cos(slope)
    foot = cos * (body.x - ground.left.x) - sin * (body.y - ground.left.y)
    short = block.is_rolling & (block.speed_squared < 0.0)
    whole = 1.0 + constants.inertia_ratio(block.rolls)
    missing = jnp.where(short, -block.speed_squared, 0.0) * whole
    steep = jnp.where(short, jnp.abs(sin), 1.0)
    down = jnp.where(slope >= 0.0, 1.0, -1.0)
    shift = down * missing / (2.0 * GRAVITY * steep)
    rolled = block._replace(
        speed_squared=jnp.where(short, 0.0, block.speed_squared),
        direction=jnp.where(short, down, block.direction),
    ).moved(x=body.x + shift * cos, y=body.y - shift * sin)
    return rolled, foot + shift


_start = closed_form(_roll_down_to_mean_height)


def _break_ahead(
    block: BlockState, ground: LocalGround, frictions: Frictions
) -> _Break:
    """Describe the end of the segment towards which a block moves."""
    right = block.direction > 0.0
    end = choose(right, ground.right, ground.left)
    turn = block.direction * (ground.slope - end.slope)
    return _Break(
        end,
        jnp.where(right, frictions.rolling_right, frictions.rolling_left),
        turn=jnp.where(end.exists > 0.0, turn, 0.0),
    )


def _advanced(
    block: BlockState, leg: Leg, slope: Values, height: Values
) -> tuple[BlockState, Pieces]:
    """Move a block to the end of a leg, and describe that motion."""
    body, speed = block.body, block.speed
    t_x, t_y = block.direction * jnp.cos(slope), -block.direction * jnp.sin(slope)
    turn = jnp.where(block.is_rolling, block.direction / height, 0.0)
    rolling, sliding = float(MotionMode.rolling), float(MotionMode.sliding)
    piece = Pieces(
        trajectory=0.0,
        motion=jnp.where(block.is_rolling, rolling, sliding),
        time=block.time,
        duration=leg.time,
        x=body.x,
        y=body.y,
        v_x=speed * t_x,
        v_y=speed * t_y,
        a_x=leg.acceleration * t_x,
        a_y=leg.acceleration * t_y,
        orientation=body.orientation,
        angular_velocity=turn * speed,
        angular_acceleration=turn * leg.acceleration,
    )
    moved = block._replace(
        time=block.time + leg.time, speed_squared=leg.speed**2
    ).moved(
        x=body.x + leg.distance * t_x,
        y=body.y + leg.distance * t_y,
        orientation=body.orientation + turn * leg.distance,
    )
    return moved, piece


def _slow_down(
    block: BlockState,
    constants: BlockConstants,
    slope: Values,
    frictions: Frictions,
    needed: Values,
) -> BlockState:
    """Let a slow block lie down if it rolled, else start down-slope or stop.

    Args:
        needed: least kinetic energy for rolling [J].
    """
    body = block.body
    lies_down = block.is_rolling & (needed > 0.0)
    drop = constants.round.radius - constants.outline.smallest
    flat = block._replace(rolls=jnp.zeros_like(block.rolls)).moved(
        x=body.x - drop * jnp.sin(slope),
        y=body.y - drop * jnp.cos(slope),
        orientation=lying_orientation(body.orientation, constants, slope),
    )
    friction = jnp.where(block.is_rolling, frictions.rolling, frictions.sliding)
    starts = jnp.abs(jnp.tan(slope)) > friction
    started = block._replace(
        direction=jnp.where(slope >= 0.0, 1.0, -1.0),
        speed_squared=jnp.zeros_like(block.speed_squared),
    )
    stands = choose(starts, started, block.ended(Ending.stopped))
    return choose(lies_down, flat, stands)

"""Transitions of blocks on the ground: along segments, into corners, over edges."""

import numpy as np

from ...scene import GRAVITY
from ..blocks import select, support_of
from ..dual import Values, primal
from ..state import Phase, State
from ..terrain import SAME_PLANE
from ..trajectory import Ending, MotionMode
from .rolling import barrier_of, begin_ground_motion, cross_break, follow_segment

SMALL_RISE = 1e-2
"""Fraction of the smaller semi-axis; energies that would lift a block by less count as
none: hops so low are not followed, and touches so slow are no impacts. They take less
time than a contact does; with a tenth of it a sphere that has come to rolling continues
in hundreds of hops of 0.2 mm."""


def small_speed(state: State, lanes: np.ndarray, slope: Values) -> Values:
    """Compute the speed across a plane below which there is no hop or impact [m/s]."""
    rise = SMALL_RISE * state.smallest[lanes]
    return np.sqrt(2.0 * GRAVITY * np.cos(slope) * rise)


def _hop_height(state: State, lanes: np.ndarray) -> Values:
    """Compute the height of a flight up to which it is not followed [m]: one that lifts
    a block by less than it heaves as it rolls, or by next to nothing."""
    outline = select(state.outline, lanes)
    return np.maximum(
        state.limits.hop_threshold * outline.heave, SMALL_RISE * state.smallest[lanes]
    )


def begin_on_ground(
    state: State,
    lanes: np.ndarray,
    plane: Values,
    height: Values,
    tangential_velocity: Values,
    angular_velocity: Values,
) -> None:
    """Begin motion along the ground: decide whether blocks roll, where to, how fast.

    The blocks lie on `state.segment`, or on an edge if that is set.

    Args:
        plane: angle of the plane on which they rest [rad].
        height: heights of their centres over it [m].
        tangential_velocity, angular_velocity: velocities along it [m/s], and of
            rotation [rad/s].
    """
    outline, mass_properties = (
        select(state.outline, lanes),
        select(state.mass_properties, lanes),
    )
    segment = state.segment[lanes]
    motion = begin_ground_motion(
        outline,
        mass_properties,
        plane,
        state.rolling_friction[lanes, segment],
        height,
        tangential_velocity,
        angular_velocity,
    )
    rolls = motion.rolls > 0.0
    state.rolls[lanes] = rolls
    state.direction[lanes] = motion.direction
    state.speed_squared[lanes] = motion.speed_squared
    state.plane[lanes] = plane
    stays = motion.stays > 0.0
    state.end(lanes[stays], Ending.stopped)
    over = _centre_height(state, lanes) - height
    over = np.where(stays, 0.0, over)
    state.body.x[lanes] += over * np.sin(plane)
    state.body.y[lanes] += over * np.cos(plane)
    lie_down(state, lanes[~rolls], plane[~rolls])


def _centre_height(state: State, lanes: np.ndarray) -> np.ndarray:
    """Give the height of the centre over the ground [m]: the round block's radius for a
    block that rolls, that of its flat side for one that slides."""
    return np.where(state.rolls[lanes], state.radius[lanes], state.smallest[lanes])


def lie_down(state: State, lanes: np.ndarray, plane: Values) -> None:
    """Turn the flat sides of blocks to the ground."""
    theta = state.body.orientation[lanes] - plane
    axes = state.outline.axes
    quarter = 0.5 * np.pi * (axes.major >= axes.minor)[lanes]
    lying = np.round((theta - quarter) / np.pi) * np.pi + quarter
    state.body.orientation[lanes] = plane + lying


def move_along(state: State, lanes: np.ndarray) -> None:
    """Move blocks along their segments, to the end or as far as they get."""
    _find_segments(state, lanes)
    profile, segment = state.profile, state.segment[lanes]
    slope, length = state.slope[segment], state.length[segment]
    outline, mass_properties = (
        select(state.outline, lanes),
        select(state.mass_properties, lanes),
    )
    rolls, direction = state.rolls[lanes], state.direction[lanes]
    radius = _centre_height(state, lanes)
    foot = _foot_on(state, lanes, segment)
    foot = _roll_down_to_mean_height(state, lanes, foot, slope, mass_properties, radius)
    direction = state.direction[lanes]
    target = np.where(direction > 0.0, segment + 1, segment)
    beyond = np.where(direction > 0.0, segment + 1, segment - 1)
    exists = (beyond >= 0) & (beyond < profile.segments)
    after = np.where(exists, state.slope[np.clip(beyond, 0, profile.segments - 1)], 0)
    turn = np.where(exists, direction * (slope - after), 0.0)
    corner = turn > 0.0
    distance = np.where(direction > 0.0, length - foot, foot)
    distance = distance - np.where(corner, radius * np.tan(0.5 * turn), 0.0)
    rolling = state.rolling_friction[lanes, segment]
    friction = np.where(rolls, rolling, state.sliding_friction[lanes, segment])
    ratio = np.where(
        rolls, mass_properties.inertia / (mass_properties.mass * radius**2), 0.0
    )
    needed = np.where(rolls, barrier_of(outline, mass_properties, slope, rolling), 0.0)
    least = np.sqrt(2.0 * needed / (mass_properties.mass * (1.0 + ratio)))
    speed = np.sqrt(np.maximum(state.speed_squared[lanes], 0.0))
    leg = follow_segment(speed, direction * slope, distance, friction, ratio, least)
    _record_leg(state, lanes, leg, speed, slope, radius)
    arrives = leg.arrives > 0.0
    state.speed_squared[lanes] = leg.speed**2
    late = state.time[lanes] > state.limits.time
    at_edge = arrives & ~corner
    state.phase[lanes[at_edge]] = Phase.at_edge
    state.edge[lanes[at_edge]] = target[at_edge]
    state.plane[lanes[at_edge]] = slope[at_edge]
    strikes = arrives & corner
    _strike_corner(
        state,
        lanes[strikes],
        beyond[strikes],
        turn[strikes],
        after[strikes],
        rolling[strikes],
    )
    _slow_down(state, lanes[~arrives], slope, friction, needed, ~arrives)
    state.end(lanes[late], Ending.time_limit)


def _find_segments(state: State, lanes: np.ndarray) -> None:
    """Assign blocks that a contact took past the end of their segment to the next ones,
    as long as these go straight on."""
    while len(lanes):
        segment = state.segment[lanes]
        foot = primal(_foot_on(state, lanes, segment))
        right = primal(state.direction[lanes]) > 0.0
        past = np.where(right, foot > state.length[segment], foot < 0.0)
        beyond = np.where(right, segment + 1, segment - 1)
        exists = (beyond >= 0) & (beyond < state.profile.segments)
        beyond = np.where(exists, beyond, segment)
        turn = np.sin(state.slope[beyond] - state.slope[segment])
        goes = past & exists & (np.abs(turn) <= SAME_PLANE)
        state.segment[lanes[goes]] = beyond[goes]
        lanes = lanes[goes]


def _foot_on(state: State, lanes: np.ndarray, segment: np.ndarray) -> Values:
    """Compute the distance of the centre along a segment from its left end [m]."""
    slope, profile = state.slope[segment], state.profile
    return np.cos(slope) * (state.body.x[lanes] - profile.x[segment]) - np.sin(
        slope
    ) * (state.body.y[lanes] - profile.y[segment])


def _roll_down_to_mean_height(
    state, lanes, foot, slope, mass_properties, radius
) -> Values:
    """Roll blocks down that lack the energy to roll, and give their new feet."""
    short = state.rolls[lanes] & (state.speed_squared[lanes] < 0.0)
    ratio = mass_properties.inertia / (mass_properties.mass * radius**2)
    missing = np.where(short, -state.speed_squared[lanes], 0.0) * (1.0 + ratio)
    steep = np.where(short, np.abs(np.sin(slope)), 1.0)
    shift = np.where(slope >= 0.0, 1.0, -1.0) * missing / (2.0 * GRAVITY * steep)
    state.speed_squared[lanes[short]] = 0.0
    state.direction[lanes[short]] = np.where(slope[short] >= 0.0, 1.0, -1.0)
    state.body.x[lanes] += shift * np.cos(slope)
    state.body.y[lanes] -= shift * np.sin(slope)
    return foot + shift


def _record_leg(state, lanes, leg, speed, slope, radius) -> None:
    """Record a leg along a segment, and move the block to its end."""
    direction, rolls = state.direction[lanes], state.rolls[lanes]
    body = select(state.body, lanes)
    t_x, t_y = direction * np.cos(slope), -direction * np.sin(slope)
    turn = np.where(rolls, direction / radius, 0.0)
    state.pieces.add(
        lanes, np.where(rolls, MotionMode.rolling, MotionMode.sliding),
        state.time[lanes], leg.time, *(body.x, body.y, speed * t_x, speed * t_y),
        *(leg.acceleration * t_x, leg.acceleration * t_y), *(body.orientation, turn *
        speed, turn * leg.acceleration),
    )  # fmt: skip
    state.set_body(
        lanes,
        x=body.x + leg.distance * t_x,
        y=body.y + leg.distance * t_y,
        orientation=body.orientation + turn * leg.distance,
    )
    state.time[lanes] += leg.time


def _slow_down(state, lanes, slope, friction, needed, chosen) -> None:
    """Let slow blocks lie down if they rolled, else start down-slope or stop."""
    slope, friction, needed = slope[chosen], friction[chosen], needed[chosen]
    sinks = state.rolls[lanes] & (needed > 0.0)
    down = state.radius[lanes] - state.smallest[lanes]
    down = np.where(sinks, down, 0.0)
    state.body.x[lanes] -= down * np.sin(slope)
    state.body.y[lanes] -= down * np.cos(slope)
    lie_down(state, lanes[sinks], slope[sinks])
    state.rolls[lanes[sinks]] = False
    starts = ~sinks & (np.abs(np.tan(slope)) > friction)
    state.direction[lanes[starts]] = np.where(slope[starts] >= 0.0, 1.0, -1.0)
    state.speed_squared[lanes[starts]] = 0.0
    state.end(lanes[~sinks & ~starts], Ending.stopped)


def _strike_corner(state, lanes, beyond, turn, after, rolling) -> None:
    """Let blocks at a concave break strike the next segment; those too slow for an
    impact continue along it or stop."""
    outline, direction = select(state.outline, lanes), state.direction[lanes]
    speed = np.sqrt(state.speed_squared[lanes])
    here = state.slope[state.segment[lanes]]
    radius = _centre_height(state, lanes)
    spin = np.where(state.rolls[lanes], direction * speed / radius, 0.0)
    state.set_body(
        lanes,
        v_x=direction * speed * np.cos(here),
        v_y=-direction * speed * np.sin(here),
        angular_velocity=spin,
    )
    state.segment[lanes] = beyond
    sin, cos = np.sin(after), np.cos(after)
    over = sin * (state.body.x[lanes] - state.profile.x[beyond]) + cos * (
        state.body.y[lanes] - state.profile.y[beyond]
    )
    closing = speed * np.sin(turn)
    slow = closing < small_speed(state, lanes, after)
    theta = state.body.orientation[lanes] - after
    _, arm = support_of(outline, theta)
    # The round block strikes; where the ellipse in its place would turn away from the
    # plane, it does so along its nearest axis.
    turns_away = closing + arm * spin < small_speed(state, lanes, after)
    upright = np.round(theta / (0.5 * np.pi)) * (0.5 * np.pi)
    theta = np.where(turns_away & ~slow, upright, theta)
    state.body.orientation[lanes] = theta + after
    state.phase[lanes] = Phase.touching
    state.normal[:, lanes] = sin, cos
    state.gap[lanes] = over - support_of(outline, theta).radius
    rises = np.sin(direction * after) < rolling * np.cos(after)
    weak = speed < small_speed(state, lanes, after)
    goes = slow & ~(weak & rises)
    state.phase[lanes[goes]] = Phase.grounded
    begin_on_ground(
        state, lanes[goes], after[goes], over[goes],
        (direction * speed * np.cos(turn))[goes], spin[goes],
    )  # fmt: skip
    state.end(lanes[slow & ~goes], Ending.stopped)


def cross_edges(state: State, lanes: np.ndarray) -> None:
    """Move blocks over convex breaks, into the air, back, or off the profile."""
    profile, direction = state.profile, state.direction[lanes]
    edge, plane = state.edge[lanes], state.plane[lanes]
    beyond = np.where(direction > 0.0, edge, edge - 1)
    exists = (beyond >= 0) & (beyond < profile.segments)
    state.end(lanes[~exists], Ending.left_profile)
    lanes, direction, edge, plane, beyond = (
        values[exists] for values in (lanes, direction, edge, plane, beyond)
    )
    outline, mass_properties = (
        select(state.outline, lanes),
        select(state.mass_properties, lanes),
    )
    rolls = state.rolls[lanes]
    radius = _centre_height(state, lanes)
    ratio = np.where(
        rolls, mass_properties.inertia / (mass_properties.mass * radius**2), 0.0
    )
    # Bringing the centre over the edge costs or gives energy.
    rise = profile.y[edge] + radius * np.cos(plane) - state.body.y[lanes]
    squared = state.speed_squared[lanes] - 2.0 * GRAVITY * rise / (1.0 + ratio)
    # Rounding of the position must not turn back a block that is at the edge.
    squared = np.where(
        np.abs(rise) < 1e-9 * radius, state.speed_squared[lanes], squared
    )
    after = state.slope[beyond]
    crossing = cross_break(
        outline, mass_properties, squared, direction * plane, direction * after,
        direction * state.body.orientation[lanes], rolls.astype(float),
        _hop_height(state, lanes),
    )  # fmt: skip
    flies, back = crossing.flies > 0.0, crossing.goes_back > 0.0
    stays = crossing.stays > 0.0
    _fly_off(state, lanes[flies], crossing, flies, edge[flies], radius[flies])
    over = ~(flies | back | stays)
    state.end(lanes[stays], Ending.stopped)
    _begin_segment(state, lanes[over], beyond[over], edge[over], crossing.speed[over])
    lanes, edge, plane = lanes[back], edge[back], plane[back]
    drop = radius[back] * np.cos(plane), 2.0 * GRAVITY / (1.0 + ratio[back])
    _go_back(state, lanes, edge, crossing.speed[back], *drop)


def _go_back(state, lanes, edge, speed, height, rate) -> None:
    """Return blocks that do not get over a crest to the segment on this side of it;
    stop those that lack the energy for it.

    Args:
        height: heights of their centres over the edge [m].
        rate: loss of squared speed with height [m/s2].
    """
    state.direction[lanes] *= -1.0
    segment = np.where(state.direction[lanes] > 0.0, edge, edge - 1)
    exists = (segment >= 0) & (segment < state.profile.segments)
    state.end(lanes[~exists], Ending.left_profile)
    radius = _centre_height(state, lanes)
    slope = state.slope[np.clip(segment, 0, state.profile.segments - 1)]
    squared = speed**2 - rate * (radius * np.cos(slope) - height)
    # Only rounding is left for a block that came from that segment.
    squared = np.where(np.abs(squared) < 1e-9 * rate * radius, 0.0, squared)
    state.end(lanes[exists & (squared < 0.0)], Ending.stopped)
    goes = exists & (squared >= 0.0)
    _begin_segment(
        state, lanes[goes], segment[goes], edge[goes], np.sqrt(squared[goes])
    )


def _fly_off(state, lanes, crossing, chosen, edge, radius) -> None:
    """Let blocks leave the ground over an edge."""
    direction = state.direction[lanes]
    slope = direction * crossing.descent[chosen]
    sin, cos = np.sin(slope), np.cos(slope)
    theta = state.body.orientation[lanes] - slope
    outline = select(state.outline, lanes)
    height, arm = support_of(outline, theta)
    arm = np.where(state.rolls[lanes], arm, 0.0)
    v_n = crossing.normal_velocity[chosen]
    v_t = direction * crossing.tangential_velocity[chosen]
    state.set_body(
        lanes,
        x=state.profile.x[edge] - arm * cos + height * sin,
        y=state.profile.y[edge] + arm * sin + height * cos,
        v_x=v_t * cos - v_n * sin,
        v_y=-v_t * sin - v_n * cos,
        angular_velocity=direction * crossing.angular_velocity[chosen],
    )
    state.phase[lanes] = Phase.airborne


def _begin_segment(state, lanes, segment, edge, speed) -> None:
    """Begin motion along the next segment at an edge."""
    slope, direction, rolls = (
        state.slope[segment],
        state.direction[lanes],
        state.rolls[lanes],
    )
    radius = _centre_height(state, lanes)
    state.segment[lanes] = segment
    state.phase[lanes] = Phase.grounded
    state.set_body(
        lanes,
        x=state.profile.x[edge] + radius * np.sin(slope),
        y=state.profile.y[edge] + radius * np.cos(slope),
    )
    spin = np.where(rolls, direction * speed / radius, 0.0)
    begin_on_ground(state, lanes, slope, radius, direction * speed, spin)

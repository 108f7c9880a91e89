"""Blocks on the ground: along segments and into corners."""

import numpy as np

from ..scene import GRAVITY
from .motion import support_of as support
from .record import Way
from .rolling import barrier_of, go, leg
from .runs import Ending
from .state import Phase, State

SMALL_RISE = 1e-2
"""Energies that would lift a block by less than this part of its smaller semi-axis
count as none: hops so low are not followed, and touches so slow are no impacts. They
take less time than a contact does; with a tenth of it a sphere that has come to rolling
goes on in hundreds of hops of 0.2 mm."""


def small_speed(state: State, lanes: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Speed out of a plane, or into it, below which there is no hop or impact [m/s]."""
    rise = SMALL_RISE * state.smallest[lanes]
    return np.sqrt(2.0 * GRAVITY * np.cos(slope) * rise)


def stand(
    state: State,
    lanes: np.ndarray,
    plane: np.ndarray,
    height: np.ndarray,
    tangential_velocity: np.ndarray,
    angular_velocity: np.ndarray,
) -> None:
    """Blocks come to go on along the ground: whether they roll, which way, how fast.

    Args:
        plane: angle of the plane on which they stand [rad].
        height: of their centres over it [m].
        tangential_velocity, angular_velocity: along it, and of rotation.

    The blocks lie on `state.segment`, or on an edge if that is set.
    """
    outline, matter = state.of(lanes, state.outline), state.of(lanes, state.matter)
    segment = state.segment[lanes]
    going = go(
        outline,
        matter,
        plane,
        state.rolling_friction[lanes, segment],
        height,
        tangential_velocity,
        angular_velocity,
    )
    rolls = going.rolls > 0.0
    state.rolls[lanes] = rolls
    state.way[lanes] = going.way
    state.speed_squared[lanes] = going.speed_squared
    state.plane[lanes] = plane
    stays = going.stays > 0.0
    state.end(lanes[stays], Ending.stopped)
    over = np.where(rolls, state.radius[lanes], state.smallest[lanes]) - height
    over = np.where(stays, 0.0, over)
    state.body.x[lanes] += over * np.sin(plane)
    state.body.y[lanes] += over * np.cos(plane)
    lie_down(state, lanes[~rolls], plane[~rolls])


def lie_down(state: State, lanes: np.ndarray, plane: np.ndarray) -> None:
    """Blocks turn their flat side to the ground."""
    theta = state.body.orientation[lanes] - plane
    axes = state.outline.axes
    quarter = 0.5 * np.pi * (axes.major >= axes.minor)[lanes]
    lying = np.round((theta - quarter) / np.pi) * np.pi + quarter
    state.body.orientation[lanes] = plane + lying


def go_along(state: State, lanes: np.ndarray, time_limit: float) -> None:
    """Take blocks along their segments, to the end or as far as they get."""
    profile, segment = state.profile, state.segment[lanes]
    slope, length = state.slope[segment], state.length[segment]
    outline, matter = state.of(lanes, state.outline), state.of(lanes, state.matter)
    rolls, way = state.rolls[lanes], state.way[lanes]
    radius = np.where(rolls, state.radius[lanes], state.smallest[lanes])
    foot = foot_on(state, lanes, segment)
    foot = _down_to_mean_height(state, lanes, foot, slope, matter, radius)
    way = state.way[lanes]
    target = np.where(way > 0.0, segment + 1, segment)
    beyond = np.where(way > 0.0, segment + 1, segment - 1)
    there_is = (beyond >= 0) & (beyond < profile.segments)
    after = np.where(there_is, state.slope[np.clip(beyond, 0, profile.segments - 1)], 0)
    turn = np.where(there_is, way * (slope - after), 0.0)
    corner = turn > 0.0
    distance = np.where(way > 0.0, length - foot, foot)
    distance = distance - np.where(corner, radius * np.tan(0.5 * turn), 0.0)
    rolling = state.rolling_friction[lanes, segment]
    friction = np.where(rolls, rolling, state.sliding_friction[lanes, segment])
    ratio = np.where(rolls, matter.inertia / (matter.mass * radius**2), 0.0)
    needed = np.where(rolls, barrier_of(outline, matter, slope, rolling), 0.0)
    least = np.sqrt(2.0 * needed / (matter.mass * (1.0 + ratio)))
    speed = np.sqrt(np.maximum(state.speed_squared[lanes], 0.0))
    gone = leg(speed, way * slope, distance, friction, ratio, least)
    _write_leg(state, lanes, gone, speed, slope, radius)
    arrives = gone.arrives > 0.0
    state.speed_squared[lanes] = gone.speed**2
    late = state.time[lanes] > time_limit
    at_edge = arrives & ~corner
    state.phase[lanes[at_edge]] = Phase.at_edge
    state.edge[lanes[at_edge]] = target[at_edge]
    state.plane[lanes[at_edge]] = slope[at_edge]
    meets = arrives & corner
    _meet_corner(
        state, lanes[meets], beyond[meets], turn[meets], after[meets], rolling[meets]
    )
    _slow_down(state, lanes[~arrives], slope, friction, needed, ~arrives)
    state.end(lanes[late], Ending.time_limit)


def foot_on(state: State, lanes: np.ndarray, segment: np.ndarray) -> np.ndarray:
    """Where the centre stands along a segment, from its left end [m]."""
    slope, profile = state.slope[segment], state.profile
    return np.cos(slope) * (state.body.x[lanes] - profile.x[segment]) - np.sin(
        slope
    ) * (state.body.y[lanes] - profile.y[segment])


def _down_to_mean_height(state, lanes, foot, slope, matter, radius) -> np.ndarray:
    """The foot of blocks that have to roll down first to have the energy to roll."""
    short = state.rolls[lanes] & (state.speed_squared[lanes] < 0.0)
    ratio = matter.inertia / (matter.mass * radius**2)
    missing = np.where(short, -state.speed_squared[lanes], 0.0) * (1.0 + ratio)
    steep = np.where(short, np.abs(np.sin(slope)), 1.0)
    shift = np.where(slope >= 0.0, 1.0, -1.0) * missing / (2.0 * GRAVITY * steep)
    state.speed_squared[lanes[short]] = 0.0
    state.way[lanes[short]] = np.where(slope[short] >= 0.0, 1.0, -1.0)
    state.body.x[lanes] += shift * np.cos(slope)
    state.body.y[lanes] -= shift * np.sin(slope)
    return foot + shift


def _write_leg(state, lanes, gone, speed, slope, radius) -> None:
    """Record a way along a segment, and take the block to its end."""
    way, rolls, body = state.way[lanes], state.rolls[lanes], state.of(lanes, state.body)
    t_x, t_y = way * np.cos(slope), -way * np.sin(slope)
    turn = np.where(rolls, way / radius, 0.0)
    state.pieces.add(
        lanes, np.where(rolls, Way.rolling, Way.sliding), state.time[lanes], gone.time,
        *(body.x, body.y, speed * t_x, speed * t_y),
        *(gone.acceleration * t_x, gone.acceleration * t_y),
        *(body.orientation, turn * speed, turn * gone.acceleration),
    )  # fmt: skip
    state.place(
        lanes,
        x=body.x + gone.distance * t_x,
        y=body.y + gone.distance * t_y,
        orientation=body.orientation + turn * gone.distance,
    )
    state.time[lanes] += gone.time


def _slow_down(state, lanes, slope, friction, needed, chosen) -> None:
    """Blocks too slow to go on: those that rolled lie down, those at rest start
    down-slope or stop."""
    slope, friction, needed = slope[chosen], friction[chosen], needed[chosen]
    sinks = state.rolls[lanes] & (needed > 0.0)
    down = state.radius[lanes] - state.smallest[lanes]
    down = np.where(sinks, down, 0.0)
    state.body.x[lanes] -= down * np.sin(slope)
    state.body.y[lanes] -= down * np.cos(slope)
    lie_down(state, lanes[sinks], slope[sinks])
    state.rolls[lanes[sinks]] = False
    starts = ~sinks & (np.abs(np.tan(slope)) > friction)
    state.way[lanes[starts]] = np.where(slope[starts] >= 0.0, 1.0, -1.0)
    state.speed_squared[lanes[starts]] = 0.0
    state.end(lanes[~sinks & ~starts], Ending.stopped)


def _meet_corner(state, lanes, beyond, turn, after, rolling) -> None:
    """Blocks at a concave break: they strike the next segment, or, if they do so too
    slowly for an impact, go on along it or stop."""
    outline, way = state.of(lanes, state.outline), state.way[lanes]
    speed = np.sqrt(state.speed_squared[lanes])
    here = state.slope[state.segment[lanes]]
    radius = np.where(state.rolls[lanes], state.radius[lanes], state.smallest[lanes])
    spin = np.where(state.rolls[lanes], way * speed / radius, 0.0)
    state.place(
        lanes,
        v_x=way * speed * np.cos(here),
        v_y=-way * speed * np.sin(here),
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
    _, arm = support(outline, theta)
    # The round block strikes; where the ellipse in its place would turn away from the
    # plane, it does so along its nearest axis.
    turns_away = closing + arm * spin < small_speed(state, lanes, after)
    upright = np.round(theta / (0.5 * np.pi)) * (0.5 * np.pi)
    theta = np.where(turns_away & ~slow, upright, theta)
    state.body.orientation[lanes] = theta + after
    state.phase[lanes] = Phase.touching
    state.normal[:, lanes] = sin, cos
    state.gap[lanes] = over - support(outline, theta).radius
    rises = np.sin(way * after) < rolling * np.cos(after)
    weak = speed < small_speed(state, lanes, after)
    goes = slow & ~(weak & rises)
    state.phase[lanes[goes]] = Phase.grounded
    stand(
        state, lanes[goes], after[goes], over[goes],
        (way * speed * np.cos(turn))[goes], spin[goes],
    )  # fmt: skip
    state.end(lanes[slow & ~goes], Ending.stopped)

"""Blocks on the ground: along segments, over edges, into corners."""

import numpy as np

from ..scene import GRAVITY
from .breaks import cross
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
        state.rolling_friction[segment],
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
    quarter = 0.5 * np.pi * (state.outline.major >= state.outline.minor)[lanes]
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
    rolling = state.rolling_friction[segment]
    friction = np.where(rolls, rolling, state.sliding_friction[segment])
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


def cross_edges(state: State, lanes: np.ndarray) -> None:
    """Take blocks over convex breaks, into the air, back, or off the profile."""
    profile, way = state.profile, state.way[lanes]
    edge, plane = state.edge[lanes], state.plane[lanes]
    beyond = np.where(way > 0.0, edge, edge - 1)
    there_is = (beyond >= 0) & (beyond < profile.segments)
    state.end(lanes[~there_is], Ending.left_profile)
    lanes, way, edge, plane, beyond = (
        values[there_is] for values in (lanes, way, edge, plane, beyond)
    )
    outline, matter = state.of(lanes, state.outline), state.of(lanes, state.matter)
    rolls = state.rolls[lanes]
    radius = np.where(rolls, state.radius[lanes], state.smallest[lanes])
    ratio = np.where(rolls, matter.inertia / (matter.mass * radius**2), 0.0)
    # The block is brought over the edge, which costs or gives energy.
    rise = profile.y[edge] + radius * np.cos(plane) - state.body.y[lanes]
    squared = state.speed_squared[lanes] - 2.0 * GRAVITY * rise / (1.0 + ratio)
    # Rounding of the place must not turn back a block that stands at the edge.
    squared = np.where(
        np.abs(rise) < 1e-9 * radius, state.speed_squared[lanes], squared
    )
    after = state.slope[beyond]
    crossing = cross(
        outline, matter, squared, way * plane, way * after,
        way * state.body.orientation[lanes], rolls.astype(float),
    )  # fmt: skip
    flies, back = crossing.flies > 0.0, crossing.goes_back > 0.0
    stays = crossing.stays > 0.0
    _fly_off(state, lanes[flies], crossing, flies, edge[flies], radius[flies])
    over = ~(flies | back | stays)
    state.end(lanes[stays], Ending.stopped)
    _come_to(state, lanes[over], beyond[over], edge[over], crossing.speed[over])
    lanes, edge, plane = lanes[back], edge[back], plane[back]
    drop = radius[back] * np.cos(plane), 2.0 * GRAVITY / (1.0 + ratio[back])
    _go_back(state, lanes, edge, crossing.speed[back], *drop)


def _go_back(state, lanes, edge, speed, height, rate) -> None:
    """Blocks that do not get over a crest come to the segment on this side of it, or
    stop where that takes more than they have.

    Args:
        height: of their centres over the edge [m].
        rate: loss of squared speed with height [m/s2].
    """
    state.way[lanes] *= -1.0
    segment = np.where(state.way[lanes] > 0.0, edge, edge - 1)
    there_is = (segment >= 0) & (segment < state.profile.segments)
    state.end(lanes[~there_is], Ending.left_profile)
    rolls, smallest = state.rolls[lanes], state.smallest[lanes]
    radius = np.where(rolls, state.radius[lanes], smallest)
    slope = state.slope[np.clip(segment, 0, state.profile.segments - 1)]
    squared = speed**2 - rate * (radius * np.cos(slope) - height)
    # Rounding, where it came from that segment.
    squared = np.where(np.abs(squared) < 1e-9 * rate * radius, 0.0, squared)
    state.end(lanes[there_is & (squared < 0.0)], Ending.stopped)
    goes = there_is & (squared >= 0.0)
    _come_to(state, lanes[goes], segment[goes], edge[goes], np.sqrt(squared[goes]))


def _fly_off(state, lanes, crossing, chosen, edge, radius) -> None:
    """Blocks leave the ground over an edge."""
    way = state.way[lanes]
    slope = way * crossing.descent[chosen]
    sin, cos = np.sin(slope), np.cos(slope)
    theta = state.body.orientation[lanes] - slope
    outline = state.of(lanes, state.outline)
    reach, arm = support(outline, theta)
    arm = np.where(state.rolls[lanes], arm, 0.0)
    v_n = crossing.normal_velocity[chosen]
    v_t = way * crossing.tangential_velocity[chosen]
    state.place(
        lanes,
        x=state.profile.x[edge] - arm * cos + reach * sin,
        y=state.profile.y[edge] + arm * sin + reach * cos,
        v_x=v_t * cos - v_n * sin,
        v_y=-v_t * sin - v_n * cos,
        angular_velocity=way * crossing.angular_velocity[chosen],
    )
    state.phase[lanes] = Phase.airborne


def _come_to(state, lanes, segment, edge, speed) -> None:
    """Blocks begin the next segment at an edge."""
    slope, way, rolls = state.slope[segment], state.way[lanes], state.rolls[lanes]
    radius = np.where(rolls, state.radius[lanes], state.smallest[lanes])
    state.segment[lanes] = segment
    state.phase[lanes] = Phase.grounded
    state.place(
        lanes,
        x=state.profile.x[edge] + radius * np.sin(slope),
        y=state.profile.y[edge] + radius * np.cos(slope),
    )
    spin = np.where(rolls, way * speed / radius, 0.0)
    stand(state, lanes, slope, radius, way * speed, spin)

"""Blocks on the ground that come to an edge: over it, into the air, or back."""

import numpy as np

from ..scene import GRAVITY
from .breaks import cross
from .grounded import stand
from .motion import support_of as support
from .runs import Ending
from .state import Phase, State


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

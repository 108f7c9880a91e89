"""Blocks in flight, taken to the ends of their flights."""

import numpy as np

from ..scene import GRAVITY
from .dual import carries, plain
from .flight import follow_flights
from .flight_derivatives import differentiate_ends
from .motion import fly
from .record import Way
from .runs import Ending
from .state import Phase, State


def fly_on(state: State, lanes: np.ndarray, time_limit: float) -> None:
    """Follow the flights of some blocks to what ends them."""
    body, outline = state.of(lanes, state.body), state.of(lanes, state.outline)
    left = np.maximum(time_limit - state.time[lanes], 0.0)
    parameters = carries(body)
    ends = follow_flights(*plain((body, outline)), state.profile, plain(left))
    if parameters:
        ends = differentiate_ends(ends, body, outline, state.profile, left, parameters)
    state.pieces.add(
        lanes, Way.flight, state.time[lanes], ends.time,
        *(body.x, body.y, body.v_x, body.v_y, 0.0, -GRAVITY),
        *(body.orientation, body.angular_velocity, 0.0),
    )  # fmt: skip
    state.place(lanes, **fly(body, ends.time)._asdict())
    state.time[lanes] += ends.time
    state.phase[lanes] = Phase.touching
    state.segment[lanes] = ends.segment
    state.normal[:, lanes] = ends.normal
    state.gap[lanes] = ends.gap
    state.end(lanes[~ends.touched], Ending.time_limit)
    state.end(lanes[ends.left], Ending.left_profile)
    state.end(lanes[ends.failed], Ending.failed)

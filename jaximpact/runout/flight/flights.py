"""Flights to their ends: a contact, an end of the profile, or the limit of time."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...backend.simd.tables import address_of
from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, fly, select
from ..lane_programs import Values, closed_form
from ..state import NONE, BlockState, Phase, RunState
from ..terrain import Profile
from ..trajectory import Ending, MotionMode, Pieces
from .ground_search import first_contact


class FlightEnd(NamedTuple):
    """End of a flight, as the search finds it; of many, arrays `(lanes,)`. In programs
    truths are 1 and 0."""

    time: Values  # duration of the flight [s]
    touched: Values  # true where the block touches the ground
    left: Values  # true where the centre passes an end of the profile
    failed: Values  # true where the search was given up
    segment: Values  # number of the segment touched, else -1
    normal_x: Values  # normal out of the ground at the contact; 0 for none
    normal_y: Values
    gap: Values  # at the contact [m]; negative for a start in the ground


@closed_form
def land(block: BlockState, end: FlightEnd) -> tuple[BlockState, Pieces]:
    """End a flight: the block touches the ground, or has ended. Gives the block, and
    the flight."""
    body, touched = block.body, end.touched > 0.0
    flight = Pieces(
        0.0, MotionMode.flight, block.time, end.time, *body[:4], 0.0, -GRAVITY,
        *body[4:], 0.0,
    )  # fmt: skip
    ending = jnp.where(end.left > 0.0, Ending.left_profile, Ending.time_limit)
    ending = jnp.where(end.failed > 0.0, Ending.failed, ending)
    landed = block._replace(
        time=block.time + end.time,
        body=fly(body, end.time),
        phase=jnp.where(touched, float(Phase.touching), float(Phase.ended)),
        ending=jnp.where(touched, NONE, ending),
        segment=end.segment,
        normal_x=end.normal_x,
        normal_y=end.normal_y,
        gap=end.gap,
    )
    return landed, flight


def follow_flights(
    body: Body, outline: BlockOutline, profile: Profile, time_limit: np.ndarray
) -> FlightEnd:
    """Find where flights end, of time limits [s], arrays `(lanes,)`.

    A flight that ends neither in a contact nor at an end of the profile, nor fails, has
    come to the limit. A lane's end does not depend on the other lanes.
    """
    leaving = _time_to_leave(body, profile)
    limit = np.minimum(leaving, time_limit)
    scale = np.maximum(np.abs(body.y), profile.size)
    # The profile keeps the table for as long as the search runs.
    tree = address_of(profile.covers)
    found = first_contact(body, outline, tree, scale, limit)
    touched, failed = found.touched > 0.0, found.given_up > 0.0
    free = ~(touched | failed)
    return FlightEnd(
        time=np.where(free, limit, found.time),
        touched=touched,
        left=free & (leaving <= time_limit),
        failed=failed,
        segment=np.where(touched, found.segment, -1.0),
        normal_x=np.where(touched, found.normal_x, 0.0),
        normal_y=np.where(touched, found.normal_y, 0.0),
        gap=np.where(touched, found.gap, 0.0),
    )


def _time_to_leave(body: Body, profile: Profile) -> np.ndarray:
    """Compute when the centre passes an end of the profile [s]; inf for never."""
    right = np.asarray(body.v_x) > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        time = (np.where(right, profile.x[-1], profile.x[0]) - body.x) / body.v_x
    return np.where(np.asarray(body.v_x) == 0.0, np.inf, np.maximum(time, 0.0))


def fly_on(state: RunState, lanes: np.ndarray) -> None:
    """Advance blocks in the air to the ends of their flights."""
    blocks, outline = select((state.blocks, state.constants.outline), lanes)
    left = np.maximum(state.limits.time - blocks.time, 0.0)
    after, flight = land(
        blocks, follow_flights(blocks.body, outline, state.profile, left)
    )
    state.move(lanes, after, flight)

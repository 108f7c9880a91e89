"""Transition of blocks that touch the ground: their impacts, and how they continue."""

import numpy as np

from ...impact_response import ImpactResponse
from ..blocks import BlockOutline, Body, select, support_of
from ..lane_programs import Carried, call
from ..state import State
from ..terrain import Profile
from .contact_models import ClosedForm, Contacts, ask
from .departure import Seen, depart
from .plane_contact import impact_of, settle, touch
from .roughness import strike_facets

NO_IMPACT = -1
"""Outcome of a touch that is too slow to be an impact."""
IN_THE_GROUND = 1e-6
"""Depth of a block in a segment, as a fraction of its smaller semi-axis, from which on
that segment is behind or above it."""


def strike(state: State, lanes: np.ndarray, contacts: Contacts) -> None:
    """Compute the contacts of blocks with the ground, and how the blocks continue.

    A block touches a segment, or strikes a facet where the ground is rough. The contact
    model gives its velocities after; what it costs to climb out of the ground is taken
    from them. During the contact it travels along the plane until other ground is in
    its way. Then it flies on, moves along the ground, or has stopped.
    """
    blocks, constants = state.blocks.at(lanes), state.constants.at(lanes)
    segment = blocks.value.segment.astype(int)
    touched = call(touch, blocks, constants)
    is_impact = touched.value.contact.closing >= touched.value.slow
    struck = touched.part("contact")
    rough = is_impact & (state.roughness[lanes, segment] > 0.0)
    turn = np.zeros(len(lanes))
    if np.any(rough):
        struck = struck.copy()
        turn = strike_facets(state, lanes, touched, struck, rough)
    response, outcome = _respond(state, lanes, struck, is_impact, contacts)
    settled = call(settle, blocks, constants, struck, response)
    now, outline = settled.value, constants.value.outline
    free = free_fraction(
        *(state.profile, segment, blocks.value.body, outline, now.x, now.y),
        *(now.after.orientation + struck.value.slope, (now.along_x, now.along_y)),
    )
    departed = call(
        depart,
        *(blocks, constants, touched, struck, response, settled),
        Seen(is_impact, turn, outcome, free, state.slope[segment]),
        state.ground.part("rolling_friction").at(lanes, segment),
        state.limits,
    )
    after, record, piece = departed.split()
    state.blocks.put(lanes, after)
    state.contacts.add(lanes, record)
    takes_time = response.value.duration > 0.0
    if np.any(takes_time):
        state.pieces.add(lanes[takes_time], piece.at(takes_time))


def _respond(
    state: State,
    lanes: np.ndarray,
    struck: Carried,
    is_impact: np.ndarray,
    contacts: Contacts,
) -> tuple[Carried, np.ndarray]:
    """Ask the contact model; a touch without impact leaves the velocities alone."""
    response, outcome = struck.map(_as_before), np.full(len(lanes), NO_IMPACT)
    if np.any(is_impact):
        striking = lanes[is_impact]
        if isinstance(contacts, ClosedForm):
            contacts = contacts.at(striking)
        segment = state.blocks.value.segment[striking].astype(int)
        found, outcome[is_impact] = ask(
            contacts,
            state.block.at(striking),
            state.ground.part("soil").at(striking, segment),
            call(impact_of, struck.at(is_impact)),
            state.law_tangent,
        )
        response.put(is_impact, found)
    return response, outcome


def _as_before(struck) -> ImpactResponse:
    return ImpactResponse(
        struck.normal_velocity.copy(),
        struck.tangential_velocity.copy(),
        struck.angular_velocity.copy(),
        *(np.zeros_like(struck.closing) for _ in range(3)),
    )


def free_fraction(
    profile: Profile,
    segment: np.ndarray,
    body: Body,
    outline: BlockOutline,
    x: np.ndarray,
    y: np.ndarray,
    orientation: np.ndarray,
    travel: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    """Compute the fraction of its travel during a contact that a block can make.

    The travel ends where the block comes to the line of another segment, which is
    before it comes to the segment.

    Args:
        segment: the segment that is struck, which is not in the way.
        body, outline: the block at touch.
        x, y, orientation: the block after the contact, without its travel.
        travel: travel along x and y [m].

    Returns:
        Fractions in [0, 1], `(lanes,)`.
    """
    d_x, d_y = travel
    largest, smallest = outline.largest, outline.smallest
    direction = np.where(d_x > 0.0, 1, -1)
    fraction = np.ones(len(x))
    normal_x, normal_y = np.sin(profile.slope), np.cos(profile.slope)

    def gap(lanes, place, x, y, theta):
        """Compute the gaps of blocks to the lines of segments [m]."""
        slope = profile.slope[place]
        reach = support_of(select(outline, lanes), theta[lanes] - slope).radius
        height = normal_x[place] * (x[lanes] - profile.x[place])
        height += normal_y[place] * (y[lanes] - profile.y[place])
        return height - reach

    place, lanes = segment + direction, np.arange(len(x))
    while True:
        inside = (place >= 0) & (place < profile.segments)
        place, lanes = place[inside], lanes[inside]
        near = profile.x[np.where(direction[lanes] > 0, place, place + 1)]
        reached = direction[lanes] * (near - x[lanes] - d_x[lanes]) < largest[lanes]
        place, lanes = place[reached], lanes[reached]
        if not len(lanes):
            return fraction
        clear = gap(lanes, place, body.x, body.y, body.orientation)
        left = np.maximum(gap(lanes, place, x, y, orientation), 0.0)
        closing = -(normal_x[place] * d_x[lanes] + normal_y[place] * d_y[lanes])
        little = IN_THE_GROUND * smallest[lanes]
        # Rounding of a straight slope's points must not hold a block up.
        stops = (clear > -little) & (closing > left + little)
        ends = np.where(stops, left / np.where(stops, closing, 1.0), 1.0)
        fraction[lanes] = np.minimum(fraction[lanes], ends)
        place = place + direction[lanes]

r"""Transition of blocks that touch the ground: their impacts, and how they continue.

**Hops.** The centre of an elongated block heaves by $r_{max} - r_{min}$ as it rolls. A
flight that would lift it by less than a fraction $\chi$ of that,

$$ h = \frac{\max(-v_n, 0)^2}{2 g \cos w} < \chi\,(r_{max} - r_{min}), $$

is a part of rolling: it is not followed, and the block goes on along the ground. The
energy of its motion across the ground is lost. $\chi$ is `hop_threshold`; with 0 every
hop is a flight that ends in an impact, some hundreds for each block. Spheres do not
heave, and never hop.

Source: our reading [R]; Dattola et al. (2023), section 3.3, have elongated blocks roll
after their first impact and do not say how.
"""

from typing import NamedTuple

import numpy as np

from ...impact.termination import Outcome
from ...impact_response import ImpactResponse
from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, select, support_of
from ..dual import Values, primal
from ..ground_motion.on_ground import SMALL_RISE, begin_on_ground, small_speed
from ..state import Phase, State
from ..terrain import SAME_PLANE, Profile
from ..trajectory import Ending, MotionMode
from .contact_models import Contacts
from .plane_contact import (
    PlaneContact,
    PostImpact,
    contact_with_plane,
    impact_of,
    settle,
)
from .roughness import facets_struck, lift

NO_IMPACT = -1
"""Outcome of a touch that is too slow to be an impact."""
IN_THE_GROUND = 1e-6
"""Depth of a block in a segment, as a fraction of its smaller semi-axis, from which on
that segment is behind or above it."""


class Continuation(NamedTuple):
    """Motion of blocks after their contacts, seen from the segment that they
    touched."""

    x: Values
    """Centre [m]."""
    y: Values
    orientation: Values
    """Angle Theta from the segment [rad]."""
    tangential_velocity: Values
    """Velocity along the segment [m/s]."""
    over: np.ndarray
    """Height above the segment [m]; more than 0 only after a facet was struck."""
    rising: np.ndarray
    """Velocity of the centre out of the segment [m/s]."""
    leaves: np.ndarray
    """True for a block whose lowest point leaves the ground."""
    stuck: np.ndarray
    """True for a block that lacks the energy to climb out of the ground."""


def strike(state: State, lanes: np.ndarray, contacts: Contacts) -> None:
    """Compute the contacts of blocks with the ground, and how the blocks continue.

    A block touches a segment, or strikes a facet where the ground is rough. The contact
    model gives its velocities after; what it costs to climb out of the ground is taken
    from them. During the contact it travels along the plane until other ground is in
    its way. Then it flies on, moves along the ground, or has stopped.
    """
    outline = select(state.outline, lanes)
    mass_properties = select(state.mass_properties, lanes)
    body, gap = select(state.body, lanes), state.gap[lanes]
    touched = contact_with_plane(body, outline, *state.normal[:, lanes])
    slow = small_speed(state, lanes, touched.slope)
    is_impact = touched.closing >= slow
    struck = _planes_struck(state, lanes, touched, is_impact, slow)
    response, outcome = _respond(state, lanes, struck, is_impact, contacts)
    after = settle(outline, mass_properties, struck, gap, response)
    after, x, y = _travel(state, lanes, body, outline, mass_properties, struck, after)
    on = Continuation(
        *(x, y, after.orientation, after.tangential_velocity),
        over=np.zeros(len(lanes)),
        rising=-primal(after.normal_velocity),
        leaves=after.leaving >= slow,
        stuck=after.climbs == 0.0,
    )
    turned = struck.slope != touched.slope
    lifted = None
    if np.any(turned):
        lifted = lift(outline, mass_properties, touched, struck, gap, after)
        smallest = state.smallest[lanes]
        after, on = _lift_off_facets(
            turned, lifted, after, on, touched.slope, slow, smallest
        )
    hops = on.leaves & ~on.stuck & _is_hop(state, lanes, outline, touched.slope, on)
    on = on._replace(leaves=on.leaves & ~hops)
    if lifted is not None:
        stays = turned & ~on.leaves & ~on.stuck
        on = _come_down(stays, on, lifted, touched.slope)
    _record(state, lanes, body, struck, response, after, on, outcome, hops)
    _continue(state, lanes, touched, struck, after, on, outcome)


def _is_hop(state, lanes, outline, slope, on: Continuation) -> np.ndarray:
    """Tell flights that would lift a block by less than it heaves as it rolls."""
    normal_gravity = GRAVITY * np.cos(slope)
    height = on.over + np.maximum(on.rising, 0.0) ** 2 / (2.0 * normal_gravity)
    return primal(height) < state.limits.hop_threshold * primal(outline.heave)


def _planes_struck(state, lanes, touched, is_impact, slow) -> PlaneContact:
    """Choose facets for impacts on rough ground, else the planes touched."""
    rough = state.roughness[lanes, state.segment[lanes]] > 0.0
    is_impact = is_impact & rough
    if not np.any(is_impact):
        return touched
    struck = PlaneContact(*(column.copy() for column in touched))
    facets = facets_struck(
        state, lanes[is_impact], select(touched, is_impact), slow[is_impact]
    )
    for column, values in zip(struck, facets, strict=True):
        column[is_impact] = values
    return struck


def _respond(
    state, lanes, struck, is_impact, contacts
) -> tuple[ImpactResponse, np.ndarray]:
    """Ask the contact model; a touch without impact leaves the velocities alone."""
    still = np.zeros_like(struck.closing)
    response = ImpactResponse(
        struck.normal_velocity.copy(),
        struck.tangential_velocity.copy(),
        struck.angular_velocity.copy(),
        *(still.copy() for _ in range(3)),
    )
    outcome = np.full(len(lanes), NO_IMPACT)
    if np.any(is_impact):
        striking = lanes[is_impact]
        found = contacts(
            select(state.release.block, striking),
            select(state.soil, (striking, state.segment[striking])),
            impact_of(select(struck, is_impact)),
        )
        for column, values in zip(response, found.response, strict=True):
            column[is_impact] = values
        outcome[is_impact] = found.outcome
        state.impacts[striking] += 1
    return response, outcome


def _travel(
    state, lanes, body, outline, mass_properties, struck, after
) -> tuple[PostImpact, Values, Values]:
    """Move blocks along the planes that they struck, until other ground is in the way.

    A block that is held up stays higher than gravity had moved it; the energy for that
    is taken from its velocities.
    """
    sin, cos = np.sin(struck.slope), np.cos(struck.slope)
    x, y = body.x + after.rise * sin, body.y + after.rise * cos
    along_x, along_y = after.travel * cos, -after.travel * sin
    free = free_fraction(
        *(state.profile, state.segment[lanes], body, outline, x, y),
        *(after.orientation + struck.slope, (along_x, along_y)),
    )
    x, y = x + free * along_x, y + free * along_y
    higher = (free - 1.0) * primal(along_y)
    mass, inertia = primal(mass_properties)
    v_n, v_t, spin = primal(after[3:6])
    kinetic = 0.5 * (mass * (v_n**2 + v_t**2) + inertia * spin**2)
    lost = mass * GRAVITY * np.maximum(higher, 0.0)
    left = np.maximum(kinetic - lost, 0.0)
    kept = left / np.where(kinetic > 0.0, kinetic, 1)
    kept = np.sqrt(np.where(lost > 0.0, kept, 1))
    return after.scaled(kept)._replace(leaving=kept * after.leaving), x, y


def _lift_off_facets(
    turned, lifted, after, on, slope, slow, smallest
) -> tuple[PostImpact, Continuation]:
    """Set blocks that a facet left in their segment back on it.

    Args:
        turned: true where a facet was struck.
        lifted: result of `lift`.
        slope: of the segment [rad].
        smallest: heights of the centres of blocks lying on their flat sides [m].
    """
    fraction = np.where(turned, lifted.fraction, 1.0)
    away = fraction * after.leaving >= slow
    away |= lifted.leaving >= slow
    away |= lifted.over > SMALL_RISE * smallest
    leaves = np.where(turned, away, on.leaves)
    stuck = on.stuck | (turned & (lifted.climbs == 0.0))
    on = Continuation(
        x=on.x + np.where(turned, lifted.lift * np.sin(slope), 0.0),
        y=on.y + np.where(turned, lifted.lift * np.cos(slope), 0.0),
        orientation=np.where(turned, lifted.orientation, on.orientation),
        tangential_velocity=np.where(
            turned, lifted.tangential_velocity, on.tangential_velocity
        ),
        over=primal(np.where(turned, lifted.over, 0.0)),
        rising=primal(np.where(turned, lifted.rising, on.rising)),
        leaves=leaves,
        stuck=stuck,
    )
    return after.scaled(fraction), on


def _come_down(lanes: np.ndarray, on: Continuation, lifted, slope) -> Continuation:
    """Bring blocks that a facet left above their segment down to it, some lanes."""
    drop = np.where(lanes, lifted.over, 0.0)
    return on._replace(x=on.x - drop * np.sin(slope), y=on.y - drop * np.cos(slope))


def _record(state, lanes, body, struck, response, after, on, outcome, hops) -> None:
    """Record contacts, and those that take time as pieces of the trajectory: from the
    velocities before to those after, at constant acceleration. The penetration is not
    part of the trajectory; it continues from where the block is set back."""
    state.contacts.add(
        lanes, state.time[lanes], state.segment[lanes], struck.slope, body.x, body.y,
        *struck[1:5], *after[3:6], on.x, on.y,
        response.duration, response.sinking, outcome, hops,
    )  # fmt: skip
    chosen = response.duration > 0.0
    lanes, slope = lanes[chosen], struck.slope[chosen]
    body, response = select(body, chosen), select(response, chosen)
    sin, cos, duration = np.sin(slope), np.cos(slope), response.duration
    v_x = response.tangential_velocity * cos - response.normal_velocity * sin
    v_y = -response.tangential_velocity * sin - response.normal_velocity * cos
    state.pieces.add(
        lanes, MotionMode.contact, state.time[lanes], duration,
        *body[:4], (v_x - body.v_x) / duration, (v_y - body.v_y) / duration,
        *body[4:], (response.angular_velocity - body.angular_velocity) / duration,
    )  # fmt: skip
    state.time[lanes] += duration


def _continue(state, lanes, touched, struck, after, on, outcome) -> None:
    """Let blocks fly on, move along the ground, or end."""
    sin, cos = np.sin(struck.slope), np.cos(struck.slope)
    state.set_body(
        lanes,
        x=on.x,
        y=on.y,
        v_x=after.tangential_velocity * cos - after.normal_velocity * sin,
        v_y=-after.tangential_velocity * sin - after.normal_velocity * cos,
        orientation=after.orientation + struck.slope,
        angular_velocity=after.angular_velocity,
    )
    failed = outcome == Outcome.failed
    stops = ~failed & ((outcome == Outcome.arrested) | on.stuck)
    state.phase[lanes] = Phase.airborne
    state.end(lanes[failed], Ending.failed)
    state.end(lanes[stops], Ending.stopped)
    stays = ~failed & ~stops & ~on.leaves
    lanes, slope, theta = lanes[stays], touched.slope[stays], on.orientation[stays]
    segment = state.segment[lanes]
    own = state.slope[segment]
    between = np.sin(slope - own)
    on_segment = np.abs(between) <= SAME_PLANE
    # Planes at the left end of a segment lean to the left of it.
    edge = np.where(between < 0.0, segment, segment + 1)
    state.phase[lanes] = np.where(on_segment, Phase.grounded, Phase.at_edge)
    state.edge[lanes] = np.where(on_segment, -1, edge)
    begin_on_ground(
        *(state, lanes, np.where(on_segment, own, slope)),
        height=support_of(select(state.outline, lanes), theta).radius,
        tangential_velocity=on.tangential_velocity[stays],
        angular_velocity=after.angular_velocity[stays],
    )


def free_fraction(
    profile: Profile,
    segment: np.ndarray,
    body: Body,
    outline: BlockOutline,
    x: Values,
    y: Values,
    orientation: Values,
    travel: tuple[Values, Values],
) -> np.ndarray:
    """Compute the fraction of its travel during a contact that a block can make.

    The travel ends where the block comes to the line of another segment, which is
    before it comes to the segment. Derivatives are dropped: those of a block that is
    held up are left to the comparison with differences.

    Args:
        segment: the segment that is struck, which is not in the way.
        body, outline: the block at touch.
        x, y, orientation: the block after the contact, without its travel.
        travel: travel along x and y [m].

    Returns:
        Fractions in [0, 1], `(lanes,)`.
    """
    body, outline, x, y, orientation, (d_x, d_y) = primal(
        (body, outline, x, y, orientation, travel)
    )
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

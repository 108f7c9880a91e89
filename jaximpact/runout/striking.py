"""Blocks that touch the ground: all their impacts at once, and how they go on."""

import numpy as np

from ..mechanics.outcomes import Outcome
from ..scene import GRAVITY
from .contact import Blow, Touch, impact_of, settle, touch
from .dual import plain
from .grounded import SMALL_RISE, small_speed, stand
from .motion import support_of as support
from .motion import take
from .rebounds import Contacts
from .record import Way
from .roughness import lift, meet
from .runs import Ending
from .state import Phase, State
from .travel import free_share

NO_IMPACT = -1
"""Outcome of a touch that is too slow to be an impact."""
SAME_PLANE = 1e-9
"""Sine of an angle between planes within which they are the same."""


def strike(state: State, lanes: np.ndarray, contacts: Contacts) -> None:
    """Work out the contacts of some blocks, and how they go on."""
    outline, matter = state.of(lanes, state.outline), state.of(lanes, state.matter)
    body, gap = state.of(lanes, state.body), state.gap[lanes]
    segment = state.segment[lanes]
    touched = touch(body, outline, *state.normal[:, lanes])
    slow = small_speed(state, lanes, touched.slope)
    is_impact = touched.closing >= slow
    met = _planes_met(state, lanes, touched, is_impact, slow)
    still = np.zeros_like(touched.closing)
    blow = Blow(
        met.normal_velocity.copy(),
        met.tangential_velocity.copy(),
        met.angular_velocity.copy(),
        still.copy(),
        still.copy(),
        still.copy(),
    )
    outcome = np.full(len(lanes), NO_IMPACT)
    if np.any(is_impact):
        striking = lanes[is_impact]
        blows = contacts(
            state.of(striking, state.release.block),
            state.of((striking, segment[is_impact]), state.soil),
            impact_of(take(met, is_impact)),
        )
        for column, values in zip(blow, blows.blow, strict=True):
            column[is_impact] = values
        outcome[is_impact] = blows.outcome
        state.impacts[striking] += 1
    settled = settle(outline, matter, met, gap, blow)
    sin, cos = np.sin(met.slope), np.cos(met.slope)
    x, y = body.x + settled.rise * sin, body.y + settled.rise * cos
    along_x, along_y = settled.travel * cos, -settled.travel * sin
    free = free_share(
        *(state.profile, segment, body, outline, x, y),
        *(settled.orientation + met.slope, (along_x, along_y)),
    )
    x, y = x + free * along_x, y + free * along_y
    kept = _kept(matter, settled, (free - 1.0) * plain(along_y))
    settled = settled._replace(
        normal_velocity=kept * settled.normal_velocity,
        tangential_velocity=kept * settled.tangential_velocity,
        angular_velocity=kept * settled.angular_velocity,
        leaving=kept * settled.leaving,
    )
    leaves = settled.leaving >= slow
    stuck = settled.climbs == 0.0
    theta, along = settled.orientation, settled.tangential_velocity
    turned = met.slope != touched.slope
    if np.any(turned):
        lifted = lift(outline, matter, touched, met, gap, settled)
        share = np.where(turned, lifted.share, 1.0)
        settled = settled._replace(
            normal_velocity=share * settled.normal_velocity,
            tangential_velocity=share * settled.tangential_velocity,
            angular_velocity=share * settled.angular_velocity,
        )
        away = share * settled.leaving >= slow
        away |= lifted.leaving >= slow
        away |= lifted.over > SMALL_RISE * state.smallest[lanes]
        leaves = np.where(turned, away, leaves)
        stuck = stuck | (turned & (lifted.climbs == 0.0))
        # One that stays on the ground comes down to it.
        rise = np.where(leaves | stuck, 0.0, -lifted.over) + lifted.lift
        x = x + np.where(turned, rise * np.sin(touched.slope), 0.0)
        y = y + np.where(turned, rise * np.cos(touched.slope), 0.0)
        theta = np.where(turned, lifted.orientation, theta)
        along = np.where(turned, lifted.tangential_velocity, along)
    state.contacts.add(
        lanes, state.time[lanes], segment, met.slope, body.x, body.y,
        *met[1:5], *settled[3:6], x, y, blow.duration, blow.sinking, outcome,
    )  # fmt: skip
    takes_time = blow.duration > 0.0
    _write(state, lanes, takes_time, body, blow, sin, cos)
    state.place(
        lanes,
        x=x,
        y=y,
        v_x=settled.tangential_velocity * cos - settled.normal_velocity * sin,
        v_y=-settled.tangential_velocity * sin - settled.normal_velocity * cos,
        orientation=settled.orientation + met.slope,
        angular_velocity=settled.angular_velocity,
    )
    state.time[lanes] += np.where(takes_time, blow.duration, 0.0)
    failed = outcome == Outcome.failed
    stops = ~failed & ((outcome == Outcome.arrested) | stuck)
    state.phase[lanes] = Phase.airborne
    state.end(lanes[failed], Ending.failed)
    state.end(lanes[stops], Ending.stopped)
    stands = ~failed & ~stops & ~leaves
    _stand_on(
        state,
        lanes[stands],
        touched.slope[stands],
        theta[stands],
        along[stands],
        settled.angular_velocity[stands],
    )


def _kept(matter, settled, higher: np.ndarray) -> np.ndarray:
    """Share of its velocities that a block keeps which was held up, and so stays higher
    than gravity had moved it in the contact [m]."""
    mass, inertia, v_n, v_t, spin = plain((*matter, *settled[3:6]))
    kinetic = 0.5 * (mass * (v_n**2 + v_t**2) + inertia * spin**2)
    lost = mass * GRAVITY * np.maximum(higher, 0.0)
    left = np.maximum(kinetic - lost, 0.0)
    return np.sqrt(np.where(lost > 0.0, left / np.where(kinetic > 0.0, kinetic, 1), 1))


def _planes_met(state, lanes, touched, is_impact, slow) -> Touch:
    """The planes of the contacts: facets where there is roughness, else those
    touched."""
    rough = state.roughness[lanes, state.segment[lanes]] > 0.0
    is_impact = is_impact & rough
    if not np.any(is_impact):
        return touched
    met = Touch(*(column.copy() for column in touched))
    facets = meet(state, lanes[is_impact], take(touched, is_impact), slow[is_impact])
    for column, values in zip(met, facets, strict=True):
        column[is_impact] = values
    return met


def _write(state, lanes, chosen, body, blow, sin, cos) -> None:
    """Record the contacts that take time: from the velocities before to those after, at
    constant acceleration. How deep the model has a block go is not on the way; it goes
    on from where it is set back."""
    lanes, body, blow = lanes[chosen], take(body, chosen), take(blow, chosen)
    sin, cos, duration = sin[chosen], cos[chosen], blow.duration
    v_x = blow.tangential_velocity * cos - blow.normal_velocity * sin
    v_y = -blow.tangential_velocity * sin - blow.normal_velocity * cos
    state.pieces.add(
        lanes, Way.contact, state.time[lanes], duration,
        *body[:4], (v_x - body.v_x) / duration, (v_y - body.v_y) / duration,
        *body[4:], (blow.angular_velocity - body.angular_velocity) / duration,
    )  # fmt: skip


def _stand_on(state, lanes, slope, theta, tangential_velocity, spin) -> None:
    """Blocks that stay on the ground: on planes of a slope, seen from which they are
    turned by theta and move along."""
    segment = state.segment[lanes]
    own = state.slope[segment]
    between = np.sin(slope - own)
    on_segment = np.abs(between) <= SAME_PLANE
    # Planes at the left end of a segment lean to the left of it.
    edge = np.where(between < 0.0, segment, segment + 1)
    outline = state.of(lanes, state.outline)
    height = support(outline, theta).radius
    state.phase[lanes] = np.where(on_segment, Phase.grounded, Phase.at_edge)
    state.edge[lanes] = np.where(on_segment, -1, edge)
    stand(
        state, lanes, np.where(on_segment, own, slope), height,
        tangential_velocity, spin,
    )  # fmt: skip

"""Blocks that touch the ground: all their impacts at once, and how they go on."""

import numpy as np

from ..outcomes import Outcome
from .contact import Blow, impact_of, settle, touch
from .grounded import small_speed, stand
from .motion import support_of as support
from .motion import take
from .rebounds import Contacts
from .record import Way
from .runs import Ending
from .state import Phase, State

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
    is_impact = touched.closing >= small_speed(state, lanes, touched.slope)
    still = np.zeros(len(lanes))
    blow = Blow(
        touched.normal_velocity.copy(),
        touched.tangential_velocity.copy(),
        touched.angular_velocity.copy(),
        still.copy(),
        still.copy(),
        still.copy(),
    )
    outcome = np.full(len(lanes), NO_IMPACT)
    if np.any(is_impact):
        blows = contacts(
            state.of(lanes[is_impact], state.release.block),
            state.profile.soil_of(segment[is_impact]),
            impact_of(take(touched, is_impact)),
        )
        for column, values in zip(blow, blows.blow, strict=True):
            column[is_impact] = values
        outcome[is_impact] = blows.outcome
    settled = settle(outline, matter, touched, gap, blow)
    sin, cos = np.sin(touched.slope), np.cos(touched.slope)
    x = body.x + settled.rise * sin + settled.travel * cos
    y = body.y + settled.rise * cos - settled.travel * sin
    state.contacts.add(
        lanes, state.time[lanes], segment, touched.slope, body.x, body.y,
        *touched[1:5], *settled[3:6], x, y, blow.duration, blow.sinking, outcome,
    )  # fmt: skip
    takes_time = blow.duration > 0.0
    _write(state, lanes, takes_time, body, x, y, blow)
    state.place(
        lanes,
        x=x,
        y=y,
        v_x=settled.tangential_velocity * cos - settled.normal_velocity * sin,
        v_y=-settled.tangential_velocity * sin - settled.normal_velocity * cos,
        orientation=settled.orientation + touched.slope,
        angular_velocity=settled.angular_velocity,
    )
    state.time[lanes] += np.where(takes_time, blow.duration, 0.0)
    failed = outcome == Outcome.failed
    stops = ~failed & ((outcome == Outcome.arrested) | (settled.climbs == 0.0))
    leaves = settled.leaving >= small_speed(state, lanes, touched.slope)
    state.phase[lanes] = Phase.airborne
    state.end(lanes[failed], Ending.failed)
    state.end(lanes[stops], Ending.stopped)
    stands = ~failed & ~stops & ~leaves
    _stand_on(state, lanes[stands], take(touched, stands), take(settled, stands))


def _write(state, lanes, chosen, body, x, y, blow) -> None:
    """Record the contacts that take time, as ways at constant velocity."""
    lanes, body, blow = lanes[chosen], take(body, chosen), take(blow, chosen)
    x, y, duration = x[chosen], y[chosen], blow.duration
    state.pieces.add(
        lanes, Way.contact, state.time[lanes], duration,
        *(body.x, body.y, (x - body.x) / duration, (y - body.y) / duration),
        *(0.0, 0.0, body.orientation, blow.rotation / duration, 0.0),
    )  # fmt: skip


def _stand_on(state, lanes, touched, settled) -> None:
    """Blocks that stay on the ground."""
    segment, slope = state.segment[lanes], touched.slope
    own = state.slope[segment]
    between = np.sin(slope - own)
    on_segment = np.abs(between) <= SAME_PLANE
    # Planes at the left end of a segment lean to the left of it.
    edge = np.where(between < 0.0, segment, segment + 1)
    theta = settled.orientation
    outline = state.of(lanes, state.outline)
    height = support(outline, theta).radius
    state.phase[lanes] = np.where(on_segment, Phase.grounded, Phase.at_edge)
    state.edge[lanes] = np.where(on_segment, -1, edge)
    stand(
        state, lanes, np.where(on_segment, own, slope), height,
        settled.tangential_velocity, settled.angular_velocity,
    )  # fmt: skip

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

import jax
import jax.numpy as jnp
import numpy as np

from ...impact.events import Outcome
from ...impact_response import ImpactResponse, ImpactResponses
from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, choose, put, select, support, support_of
from ..centre_path import CentrePath
from ..ground_motion.rolling import begin_on_ground
from ..lane_programs import Values, closed_form
from ..state import (
    NONE,
    BlockConstants,
    BlockState,
    Limits,
    Phase,
    RunState,
    velocities,
)
from ..terrain import Profile, in_pairs
from ..trajectory import ContactRecord, Ending, MotionMode, Pieces
from .contact_models import ClosedForm, Contacts
from .plane_contact import (
    Continuation,
    PlaneContact,
    PostImpact,
    Settled,
    impact_of,
    on_footprint,
    settle,
    touch,
)
from .roughness import lift_off_facet, strike_facets

NO_IMPACT = -1
"""Outcome of a touch that is too slow to be an impact."""
IN_THE_GROUND = 1e-6
"""Depth of a block in a segment, as a fraction of its smaller semi-axis, from which on
that segment is behind or above it."""


def strike(state: RunState, lanes: np.ndarray, contacts: Contacts) -> None:
    """Compute the contacts of blocks with the ground, and how the blocks continue.

    A block touches a segment, or strikes a facet where the ground is rough. What it
    costs to climb out of the ground is taken from its velocities after the contact.
    During the contact it travels along the plane until other ground is in its way,
    up-slope at most as far as the energy reaches that the contact took. Then it flies
    on, moves along the ground, or has stopped.
    """
    blocks, constants = select((state.blocks, state.constants), lanes)
    blocks = on_footprint(state.profile, blocks, constants)
    segment = blocks.segment.astype(int)
    struck = touched = touch(blocks, constants)
    is_impact = touched.closing >= touched.slow
    rough = is_impact & (state.roughness[lanes, segment] > 0.0)
    turn = np.zeros(len(lanes))
    if np.any(rough):
        struck = jax.tree.map(np.copy, struck)
        turn = strike_facets(state, lanes, touched, struck, rough)
    response, outcome, arm_work = _respond(state, lanes, struck, is_impact, contacts)
    outline = constants.outline
    settled = _held_up(
        profile=state.profile,
        segment=segment,
        blocks=blocks,
        outline=outline,
        settled=settle(blocks, constants, struck, response),
    )
    free = free_fraction(
        profile=state.profile,
        segment=segment,
        body=blocks.body,
        outline=outline,
        x=settled.x,
        y=settled.y,
        orientation=settled.after.orientation + struck.slope,
        travel=(settled.along_x, settled.along_y),
    )
    after, record, piece = depart(
        *(blocks, constants, touched, struck, response, settled),
        Seen(is_impact, turn, outcome, free, arm_work),
        state.ground.rolling_friction[lanes, segment],
        state.limits,
    )
    after = _falling(state.path, after, constants, response.duration)
    state.move(lanes, after, piece, sinks=True)
    state.contacts.add(lanes, record)


def _falling(
    path: CentrePath, after: BlockState, constants: BlockConstants, lasts: np.ndarray
) -> BlockState:
    """Let blocks fly that a contact, which lasts some time [s], carried past the end of
    the plane that they struck, and that touch no ground there; they keep their
    velocities along the plane."""
    stays = (after.phase == Phase.grounded) | (after.ending == Ending.stopped)
    staying = np.flatnonzero(stays & (lasts > 0.0))
    if not len(staying):
        return after
    block, there = select((after, constants), staying)
    largest = there.outline.largest
    _, highest = path.locate(block.body.x, largest, np.ones(len(staying)))
    falls = block.body.y > highest + IN_THE_GROUND * largest
    if not np.any(falls):
        return after
    block, there, staying = *select((block, there), falls), staying[falls]
    speed, spin = velocities(block, there)
    along = block.direction * speed
    flying = block._replace(
        phase=np.full(len(staying), float(Phase.airborne)),
        ending=np.full(len(staying), NONE),
    ).moved(
        v_x=along * block.normal_y,
        v_y=-along * block.normal_x,
        angular_velocity=spin,
    )
    after = jax.tree.map(np.copy, after)
    put(after, staying, flying)
    return after


def _respond(
    state: RunState,
    lanes: np.ndarray,
    struck: PlaneContact,
    is_impact: np.ndarray,
    contacts: Contacts,
) -> ImpactResponses:
    """Ask the contact model; a touch without impact leaves the velocities alone."""
    before = struck.normal_velocity, struck.tangential_velocity, struck.angular_velocity
    nothing = (np.zeros_like(struck.closing) for _ in range(3))
    response = ImpactResponse(*(velocity.copy() for velocity in before), *nothing)
    outcome, arm_work = np.full(len(lanes), NO_IMPACT), np.zeros(len(lanes))
    if np.any(is_impact):
        striking = lanes[is_impact]
        if isinstance(contacts, ClosedForm):
            contacts = contacts.at(striking)
        segment = state.blocks.segment[striking].astype(int)
        responses = contacts(
            select(state.release.block, striking),
            select(state.ground.soil, (striking, segment)),
            impact_of(select(struck, is_impact)),
        )
        put(response, is_impact, responses.response)
        outcome[is_impact] = responses.outcome
        arm_work[is_impact] = responses.arm_work
    return ImpactResponses(response, outcome, arm_work)


def _held_up(
    profile: Profile,
    segment: np.ndarray,
    blocks: BlockState,
    outline: BlockOutline,
    settled: Settled,
) -> Settled:
    """Keep blocks that are set back out of the ground from being set back into other
    ground, as between walls: their inscribed circle stays out of it."""
    lanes = np.flatnonzero(blocks.gap < -IN_THE_GROUND * outline.smallest)
    if not len(lanes):
        return settled
    body, now = select((blocks.body, settled), lanes)
    rise = now.x - body.x, now.y - body.y
    free = free_fraction(
        profile=profile,
        segment=segment[lanes],
        body=body,
        outline=select(outline, lanes),
        x=body.x,
        y=body.y,
        orientation=None,
        travel=rise,
    )
    x, y, stuck = settled.x.copy(), settled.y.copy(), free < 1.0
    x[lanes[stuck]] = (body.x + free * rise[0])[stuck]
    y[lanes[stuck]] = (body.y + free * rise[1])[stuck]
    return settled._replace(x=x, y=y)


def free_fraction(
    profile: Profile,
    segment: np.ndarray,
    body: Body,
    outline: BlockOutline,
    x: np.ndarray,
    y: np.ndarray,
    orientation: np.ndarray | None,
    travel: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    """Compute the fraction, in [0, 1], of its travel during a contact that a block can
    make: until it comes to the line of another segment, which is before it comes to the
    segment.

    Args:
        segment: the segment that is struck, which is not in the way.
        body, outline: the block at touch.
        x, y, orientation: the block after the contact, without its travel; with no
            orientation, it is its inscribed circle that has to stay free.
        travel: travel along x and y [m].
    """
    fraction = np.ones(len(x))
    moving = np.flatnonzero((travel[0] != 0.0) | (travel[1] != 0.0))
    if not len(moving):
        return fraction
    d_x, d_y = travel
    largest, smallest = outline.largest, outline.smallest
    normal_x, normal_y = profile.normal

    def gap(lanes, place, x, y, theta):
        """Compute the gaps of blocks to the lines of segments [m]."""
        reach = smallest[lanes]
        if orientation is not None:
            turned = theta[lanes] - profile.slope[place]
            reach, _ = support_of(select(outline, lanes), turned)
        height = normal_x[place] * (x[lanes] - profile.x[place])
        height += normal_y[place] * (y[lanes] - profile.y[place])
        return height - reach

    to_right = d_x > 0.0
    end = x + d_x + np.where(to_right, largest, -largest)
    nearest, farthest = profile.columns_between(end, end)
    first = np.where(to_right, segment + 1, nearest)[moving]
    last = np.where(to_right, farthest, segment - 1)[moving]
    for lanes, place in in_pairs(first, last):
        lanes = moving[lanes]
        closing = -(normal_x[place] * d_x[lanes] + normal_y[place] * d_y[lanes])
        against = closing > IN_THE_GROUND * smallest[lanes]
        lanes, place, closing = lanes[against], place[against], closing[against]
        if not len(lanes):
            continue
        clear = gap(lanes, place, body.x, body.y, body.orientation)
        left = np.maximum(gap(lanes, place, x, y, orientation), 0.0)
        little = IN_THE_GROUND * smallest[lanes]
        # Rounding of a straight slope's points must not hold a block up.
        stops = (clear > -little) & (closing > left + little)
        ends = np.where(stops, left / np.where(stops, closing, 1.0), 1.0)
        np.minimum.at(fraction, lanes, ends)
    return fraction


class Seen(NamedTuple):
    """Facts of a contact that NumPy finds, outside the programs."""

    is_impact: Values  # 1 for an impact, 0 for a touch too slow to be one
    turn: Values  # angle of the facet from the segment [rad]; 0 where none is struck
    outcome: Values  # code of `Outcome`, or -1 for no impact
    free: Values  # fraction of its travel during the contact that the block can make
    arm_work: Values  # of the contact [J]


@closed_form
def depart(
    block: BlockState,
    constants: BlockConstants,
    touched: PlaneContact,
    struck: PlaneContact,
    response: ImpactResponse,
    settled: Settled,
    seen: Seen,
    rolling_friction: Values,
    limits: Limits,
) -> tuple[BlockState, ContactRecord, Pieces]:
    """Decide how a block continues after its contact.

    Args:
        touched: contact with the segment, or the plane between two.
        struck: contact with the facet, or the same.
        response: velocities after the impact, before the climb out of the ground.
        settled: block set back on the plane that it struck.
        rolling_friction: tangent of the angle on the segment.

    Returns:
        The block; the record of the contact; and the contact as a piece of the
        trajectory, of no meaning where it takes no time.
    """
    slope, turned = touched.slope, seen.turn != 0.0
    after, x, y, lacks, free = _travelled(block, constants, struck, settled, seen.free)
    on = Continuation(
        x=x,
        y=y,
        orientation=after.orientation,
        tangential_velocity=after.tangential_velocity,
        over=jnp.zeros_like(x),
        rising=-after.normal_velocity,
        leaves=after.leaving >= touched.slow,
        stuck=(after.climbs == 0.0) | lacks,
    )
    off, on_segment = lift_off_facet(constants, touched, struck, block.gap, after, on)
    after, on = choose(turned, off, after), choose(turned, on_segment, on)
    hops = on.leaves & ~on.stuck & _is_hop(constants, slope, on, limits)
    on = on._replace(leaves=on.leaves & ~hops)
    # A block that a facet left above its segment comes down to it.
    drop = jnp.where(turned & ~on.leaves & ~on.stuck, on_segment.over, 0.0)
    on = on._replace(x=on.x - drop * jnp.sin(slope), y=on.y - drop * jnp.cos(slope))
    record, piece = _recorded(
        block=block,
        constants=constants,
        struck=struck,
        response=response,
        settled=settled,
        after=after,
        on=on,
        seen=seen,
        hops=hops,
        free=free,
    )
    continued = _continued(
        block, constants, slope, struck, after, on, seen, rolling_friction
    )
    departed = continued._replace(
        time=block.time + response.duration * free,
        impacts=block.impacts + seen.is_impact,
    )
    return departed.counted(limits), record, piece


def _travelled(
    block: BlockState,
    constants: BlockConstants,
    struck: PlaneContact,
    settled: Settled,
    free: Values,
) -> tuple[PostImpact, Values, Values, Values, Values]:
    """Move a block along the plane that it struck, until other ground is in the way.

    No block comes higher than its energy before the contact takes it. The travel is
    that at the mean velocity, which is too long up-slope where a block soon stops, and
    so ends where the energy that the contact took is used up. A block that is held up
    stays higher than gravity had moved it; the energy for that is taken from its
    velocities, and what they lack from its climb out of the ground.

    Returns:
        The block; its centre; whether it lacks the energy to climb; and the fraction of
        its travel that it made.
    """
    after, of_block = settled.after, constants.mass_properties
    weight = of_block.mass * GRAVITY
    begun, kinetic = (
        of_block.kinetic_energy(
            of.normal_velocity, of.tangential_velocity, of.angular_velocity
        )
        for of in (struck, after)
    )
    rise_y, up = settled.y - block.body.y, weight * settled.along_y
    dissipated = jnp.maximum(begun - kinetic - weight * rise_y, 0.0)
    ends = up > dissipated + 1e-9 * begun  # but for rounding
    most = jnp.where(ends, dissipated / jnp.where(ends, up, 1.0), 1.0)
    free = jnp.minimum(free, most)
    lost = weight * jnp.maximum((free - 1.0) * settled.along_y, 0.0)
    # A block that turned onto a lower side comes down onto it as far as it is free.
    held_y = rise_y - after.rise * jnp.cos(struck.slope)
    is_held = held_y > IN_THE_GROUND * constants.outline.smallest  # not for rounding
    lost += jnp.where(is_held, weight * held_y, 0.0)
    left = jnp.maximum(kinetic - lost, 0.0)
    kept = left / jnp.where(kinetic > 0.0, kinetic, 1.0)
    kept = jnp.sqrt(jnp.where(lost > 0.0, kept, 1.0))

    sin, cos = jnp.sin(struck.slope), jnp.cos(struck.slope)
    rise = (settled.x - block.body.x) * sin + rise_y * cos
    lacks = (lost > kinetic) & (rise > 0.0)
    back = jnp.minimum((lost - kinetic) / (weight * cos), rise)
    back = jnp.where(lacks, back, 0.0)
    return (
        after.scaled(kept)._replace(leaving=kept * after.leaving),
        settled.x + free * settled.along_x - back * sin,
        settled.y + free * settled.along_y - back * cos,
        lacks,
        free,
    )


def _is_hop(
    constants: BlockConstants, slope: Values, on: Continuation, limits: Limits
) -> Values:
    """Tell a flight that would lift a block by less than it heaves as it rolls."""
    normal_gravity = GRAVITY * jnp.cos(slope)
    height = on.over + jnp.maximum(on.rising, 0.0) ** 2 / (2.0 * normal_gravity)
    return height < limits.hop_threshold * constants.outline.heave


def _recorded(
    block: BlockState,
    constants: BlockConstants,
    struck: PlaneContact,
    response: ImpactResponse,
    settled: Settled,
    after: PostImpact,
    on: Continuation,
    seen: Seen,
    hops: Values,
    free: Values,
) -> tuple[ContactRecord, Pieces]:
    """Record a contact, and describe it as a piece of the trajectory: at constant
    acceleration, from the place and the velocities at touch along the plane, or at
    constant velocity. The way out of the ground is no part of it: in so short a time no
    block is so fast. It lasts as long as the block travels, and less than the contact
    where other ground is in its way."""
    body = block.body
    record = ContactRecord(
        0.0, block.time, block.segment, struck.slope, body.x, body.y,
        *struck[1:5], *after[3:6], on.x, on.y,
        response.duration, response.sinking, seen.outcome, hops.astype(float),
        seen.arm_work,
    )  # fmt: skip
    duration = response.duration * free
    time = jnp.where(duration > 0.0, duration, 1.0)
    way_x, way_y = free * settled.along_x, free * settled.along_y
    rise_x, rise_y = on.x - body.x - way_x, on.y - body.y - way_y
    # One that sinks and is too slow to have fallen so far sinks as it travels, if it is
    # no faster at the end of it than that height lets it be: where other ground is in
    # its way at once, nothing is left of the contact's duration.
    squared = after.normal_velocity**2 + after.tangential_velocity**2
    flies = on.leaves & ~on.stuck & (0.5 * squared >= -GRAVITY * rise_y)
    end_x = 2.0 * (way_x + rise_x) / time - body.v_x
    end_y = 2.0 * (way_y + rise_y) / time - body.v_y
    fastest = jnp.maximum(squared, body.v_x**2 + body.v_y**2) - 2.0 * GRAVITY * rise_y
    sinks = (rise_y < 0.0) & ~flies & (end_x**2 + end_y**2 <= fastest)
    way_x, way_y = (
        jnp.where(sinks, way + rise, way)
        for way, rise in ((way_x, rise_x), (way_y, rise_y))
    )
    v_x, v_y, spin = way_x / time, way_y / time, body.angular_velocity
    turn = response.angular_velocity - spin
    end_x, end_y = 2.0 * v_x - body.v_x, 2.0 * v_y - body.v_y
    # Where that would end with a tenth more energy than it begins with it is uniform:
    # the velocity changes at once, and then no more.
    mass, inertia = constants.mass_properties
    gain = end_x**2 - body.v_x**2 + end_y**2 - body.v_y**2 + 2.0 * GRAVITY * way_y
    gain += inertia / mass * turn * (turn + 2.0 * spin)
    begun = body.v_x**2 + body.v_y**2 + inertia / mass * spin**2
    uniform = gain > 0.1 * begun
    v_x, v_y = jnp.where(uniform, v_x, body.v_x), jnp.where(uniform, v_y, body.v_y)
    spin = jnp.where(uniform, spin + 0.5 * turn, spin)
    piece = Pieces(
        0.0, float(MotionMode.contact), block.time, duration, body.x, body.y, v_x, v_y,
        jnp.where(uniform, 0.0, 2.0 * (way_x - v_x * time) / time**2),
        jnp.where(uniform, 0.0, 2.0 * (way_y - v_y * time) / time**2),
        body.orientation, spin, jnp.where(uniform, 0.0, turn / time),
    )  # fmt: skip
    return record, piece


def _continued(
    block: BlockState,
    constants: BlockConstants,
    slope: Values,
    struck: PlaneContact,
    after: PostImpact,
    on: Continuation,
    seen: Seen,
    rolling_friction: Values,
) -> BlockState:
    """Let a block fly on, move along the ground, or end."""
    v_n, v_t = after.normal_velocity, after.tangential_velocity
    sin, cos = jnp.sin(struck.slope), jnp.cos(struck.slope)
    flies = block._replace(
        phase=jnp.full_like(block.phase, float(Phase.airborne))
    ).moved(
        x=on.x,
        y=on.y,
        v_x=v_t * cos - v_n * sin,
        v_y=-v_t * sin - v_n * cos,
        orientation=after.orientation + struck.slope,
        angular_velocity=after.angular_velocity,
    )
    theta = on.orientation
    height, _ = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    stays = begin_on_ground(
        block=flies,
        constants=constants,
        plane=slope,
        rolling_friction=rolling_friction,
        height=height,
        tangential_velocity=on.tangential_velocity,
        angular_velocity=after.angular_velocity,
    )
    failed = seen.outcome == Outcome.failed
    stops = (seen.outcome == Outcome.arrested) | on.stuck
    continued = choose(on.leaves, flies, stays)
    continued = choose(stops, flies.ended(Ending.stopped), continued)
    return choose(failed, flies.ended(Ending.failed), continued)

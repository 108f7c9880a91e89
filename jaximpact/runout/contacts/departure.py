r"""Transition of a block that has made contact: how it continues.

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

from ...impact.events import Outcome
from ...impact_response import ImpactResponse
from ...scene import GRAVITY
from ..blocks import support
from ..ground_motion.rolling import SMALL_RISE, begin_on_ground
from ..lane_programs import Values, closed_form
from ..state import BlockConstants, BlockState, Limits, Phase, choose
from ..terrain import SAME_PLANE
from ..trajectory import ContactRecord, Ending, MotionMode, Pieces
from .plane_contact import PlaneContact, PostImpact, Settled, Touch
from .roughness import Lifted, lift


class Seen(NamedTuple):
    """What is found of a contact without derivatives."""

    is_impact: Values
    """1 for an impact, 0 for a touch too slow to be one."""
    turn: Values
    """Angle of the facet from the segment [rad]; 0 where none is struck."""
    outcome: Values
    """Code of `Outcome`, or -1 for no impact."""
    free: Values
    """Fraction of its travel during the contact that the block can make."""
    slope: Values
    """Angle of the segment [rad]."""


class Continuation(NamedTuple):
    """Motion of a block after its contact, seen from the segment that it touched."""

    x: Values
    """Centre [m]."""
    y: Values
    orientation: Values
    """Angle Theta from the segment [rad]."""
    tangential_velocity: Values
    """Velocity along the segment [m/s]."""
    over: Values
    """Height above the segment [m]; more than 0 only after a facet was struck."""
    rising: Values
    """Velocity of the centre out of the segment [m/s]."""
    leaves: Values
    """True for a block whose lowest point leaves the ground."""
    stuck: Values
    """True for a block that lacks the energy to climb out of the ground."""


@closed_form
def depart(
    block: BlockState,
    constants: BlockConstants,
    touched: Touch,
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
    slope, turned = touched.contact.slope, seen.turn != 0.0
    after, x, y = _travelled(constants, settled, seen.free)
    on = Continuation(
        *(x, y, after.orientation, after.tangential_velocity),
        over=jnp.zeros_like(x),
        rising=-after.normal_velocity,
        leaves=after.leaving >= touched.slow,
        stuck=after.climbs == 0.0,
    )
    lifted = lift(constants, touched.contact, struck, block.gap, after)
    off, on_segment = _lift_off_facet(lifted, after, on, constants, touched)
    after, on = choose(turned, off, after), choose(turned, on_segment, on)
    hops = on.leaves & ~on.stuck & _is_hop(constants, slope, on, limits)
    on = on._replace(leaves=on.leaves & ~hops)
    # A block that a facet left above its segment comes down to it.
    drop = jnp.where(turned & ~on.leaves & ~on.stuck, lifted.over, 0.0)
    on = on._replace(x=on.x - drop * jnp.sin(slope), y=on.y - drop * jnp.cos(slope))
    record, piece = _recorded(block, struck, response, after, on, seen, hops)
    continued = _continued(
        block, constants, slope, struck, after, on, seen, rolling_friction
    )
    departed = continued._replace(
        time=block.time + response.duration, impacts=block.impacts + seen.is_impact
    )
    return departed.counted(limits), record, piece


def _travelled(
    constants: BlockConstants, settled: Settled, free: Values
) -> tuple[PostImpact, Values, Values]:
    """Move a block along the plane that it struck, until other ground is in the way.

    A block that is held up stays higher than gravity had moved it; the energy for that
    is taken from its velocities. Its derivatives are dropped: they are left to the
    comparison with differences.
    """
    after, (mass, inertia) = settled.after, constants.mass_properties
    v_n, v_t = after.normal_velocity, after.tangential_velocity
    kinetic = 0.5 * (mass * (v_n**2 + v_t**2) + inertia * after.angular_velocity**2)
    higher = (free - 1.0) * settled.along_y
    lost = mass * GRAVITY * jnp.maximum(higher, 0.0)
    left = jnp.maximum(kinetic - lost, 0.0)
    kept = left / jnp.where(kinetic > 0.0, kinetic, 1.0)
    kept = jax.lax.stop_gradient(jnp.sqrt(jnp.where(lost > 0.0, kept, 1.0)))
    return (
        after.scaled(kept)._replace(leaving=kept * after.leaving),
        settled.x + free * settled.along_x,
        settled.y + free * settled.along_y,
    )


def _lift_off_facet(
    lifted: Lifted,
    after: PostImpact,
    on: Continuation,
    constants: BlockConstants,
    touched: Touch,
) -> tuple[PostImpact, Continuation]:
    """Set a block that a facet left in its segment back on it."""
    slope, slow = touched.contact.slope, touched.slow
    leaves = (lifted.fraction * after.leaving >= slow) | (lifted.leaving >= slow)
    leaves |= lifted.over > SMALL_RISE * constants.outline.smallest
    on = Continuation(
        x=on.x + lifted.lift * jnp.sin(slope),
        y=on.y + lifted.lift * jnp.cos(slope),
        orientation=lifted.orientation,
        tangential_velocity=lifted.tangential_velocity,
        over=lifted.over,
        rising=lifted.rising,
        leaves=leaves,
        stuck=on.stuck | ~lifted.climbs,
    )
    return after.scaled(lifted.fraction), on


def _is_hop(
    constants: BlockConstants, slope: Values, on: Continuation, limits: Limits
) -> Values:
    """Tell a flight that would lift a block by less than it heaves as it rolls."""
    normal_gravity = GRAVITY * jnp.cos(slope)
    height = on.over + jnp.maximum(on.rising, 0.0) ** 2 / (2.0 * normal_gravity)
    return height < limits.hop_threshold * constants.outline.heave


def _recorded(
    block: BlockState,
    struck: PlaneContact,
    response: ImpactResponse,
    after: PostImpact,
    on: Continuation,
    seen: Seen,
    hops: Values,
) -> tuple[ContactRecord, Pieces]:
    """Record a contact, and describe it as a piece of the trajectory: from the
    velocities before to those after, at constant acceleration. The penetration is not
    part of the trajectory; it continues from where the block is set back."""
    body = block.body
    record = ContactRecord(
        0.0, block.time, block.segment, struck.slope, body.x, body.y,
        *struck[1:5], *after[3:6], on.x, on.y,
        response.duration, response.sinking, seen.outcome, hops.astype(float),
    )  # fmt: skip
    duration = jnp.where(response.duration > 0.0, response.duration, 1.0)
    v_x, v_y = _to_slope(response, struck.slope)
    piece = Pieces(
        0.0, float(MotionMode.contact), block.time, response.duration,
        *body[:4], (v_x - body.v_x) / duration, (v_y - body.v_y) / duration,
        *body[4:], (response.angular_velocity - body.angular_velocity) / duration,
    )  # fmt: skip
    return record, piece


def _to_slope(
    motion: ImpactResponse | PostImpact, slope: Values
) -> tuple[Values, Values]:
    """Turn velocities from the frame of a plane to x and y."""
    v_n, v_t = motion.normal_velocity, motion.tangential_velocity
    sin, cos = jnp.sin(slope), jnp.cos(slope)
    return v_t * cos - v_n * sin, -v_t * sin - v_n * cos


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
    v_x, v_y = _to_slope(after, struck.slope)
    flies = block._replace(
        phase=jnp.full_like(block.phase, float(Phase.airborne))
    ).moved(
        x=on.x,
        y=on.y,
        v_x=v_x,
        v_y=v_y,
        orientation=after.orientation + struck.slope,
        angular_velocity=after.angular_velocity,
    )
    between = jnp.sin(slope - seen.slope)
    on_segment = jnp.abs(between) <= SAME_PLANE
    # Planes at the left end of a segment lean to the left of it.
    edge = jnp.where(between < 0.0, block.segment, block.segment + 1.0)
    theta = on.orientation
    height, _ = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    stays = begin_on_ground(
        flies._replace(
            phase=jnp.where(on_segment, float(Phase.grounded), float(Phase.at_edge)),
            edge=jnp.where(on_segment, -1.0, edge),
        ),
        constants,
        plane=jnp.where(on_segment, seen.slope, slope),
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

"""Events along an impact: switches of the laws, ends, and named outcomes.

The rates of the state are continuous where a law switches, their slopes are not. A step
that runs across a switch would be accurate to second order only in its value, and to
first order in its derivatives. So a step takes one `Branch` from start to end, and the
step size control lands on the switches as it lands on the end of the impact.
"""

import enum
from typing import NamedTuple

import jax
import jax.numpy as jnp

from .._types import Scalar
from ..laws import Branch
from ..scene import Soil
from .dynamics import (
    INITIAL_SINKING,
    Contact,
    ImpactConstants,
    Motion,
    elastic_energy,
    kinetic_energy,
    turned,
)

SWITCHED_OFF = 1e-11
"""Magnitude below which a switching function is ignored: it is zero by symmetry, and
its sign is that of the rounding."""


class Switches(NamedTuple):
    """Dimensionless functions of the state; each changes sign where a law switches."""

    pressing: Scalar
    """Normal force before it is cut off at zero."""
    yielding: Scalar
    """Overstress, negative below yield."""
    heave: Scalar
    """Normal part of the loading surface's unit gradient."""
    shear: Scalar
    """Tangential force, whose flow hardens in either direction."""
    rocking: Scalar
    """Moment, whose flow hardens in either direction."""
    slip_down: Scalar
    """Tangential force above the slider's limit, down-slope."""
    slip_up: Scalar
    """Tangential force above the slider's limit, up-slope."""
    section: Scalar
    """Length less width of the foundation, over R."""
    side: Scalar | None = None
    """Sign of the lowest corner of a shape with flat faces; None without such."""


def switches(
    ground: ImpactConstants, motion: Motion, now: Contact, force_scale: Scalar
) -> Switches:
    """Compute values of the switching functions.

    Args:
        ground, motion, now: constants, state and contact.
        force_scale: largest normal force so far [N], positive.
    """
    load = now.load
    radius = ground.axes.minor
    tangential = now.forces.tangential / force_scale
    limit = now.forces.normal * ground.slider_friction / force_scale
    gradient = jnp.sqrt(load.normal**2 + load.tangential**2 + load.rotational**2)
    return Switches(
        pressing=now.normal_force_before_cut / force_scale,
        yielding=load.size / motion.hardening - 1.0,
        heave=load.normal / gradient,
        shear=tangential,
        rocking=now.forces.moment / (force_scale * radius),
        slip_down=tangential - limit,
        slip_up=-tangential - limit,
        section=(now.foundation.length - now.foundation.width) / radius,
        side=ground.shape.side_of(*turned(ground, motion.rotation)),
    )


def at_start(ground: ImpactConstants, switches: Switches) -> Switches:
    """Return the switching functions at touch: a block that lies on a level face is on
    the side to which its spin turns it."""
    if switches.side is None or ground.start_side is None:
        return switches
    towards = jnp.where(ground.start_side, SWITCHED_OFF, -SWITCHED_OFF)
    is_level = jnp.abs(switches.side) <= SWITCHED_OFF
    return switches._replace(side=jnp.where(is_level, towards, switches.side))


def branch_of(switches: Switches) -> Branch:
    """Find the side taken at each switch."""
    return Branch(
        presses=switches.pressing > 0.0,
        yields=switches.yielding > 0.0,
        heaves=switches.heave < 0.0,
        shears_up=switches.shear < 0.0,
        rocks_back=switches.rocking < 0.0,
        slips_down=switches.slip_down > 0.0,
        slips_up=switches.slip_up > 0.0,
        oblong=switches.section > 0.0,
        side=None if switches.side is None else switches.side > 0.0,
    )


def in_force(switches: Switches, soil: Soil) -> Switches:
    """Tell which switches are active: those of flow while the soil flows, those of
    hardening where the soil's law has them."""
    flows = (switches.yielding > 0.0) | soil.flow.flows_below_yield
    by_sliding, by_rocking = soil.hardening.heeds_signs()
    always = jax.tree.map(lambda _: jnp.ones_like(flows), switches)
    return always._replace(
        heave=flows, shear=flows & by_sliding, rocking=flows & by_rocking
    )


TOPPLING_SINKING = 1e-3
"""Sinking over R above which a block can topple."""
ARREST_ENERGY = 1e-4
"""Energy over the incoming energy below which a block is arrested."""
TIME_LIMIT = 1.0
"""Longest contact that is integrated [s]."""


class Outcome(enum.IntEnum):
    """Why an impact ended. A member is equal to its code and to its word."""

    detached = 0
    """The normal force, or the sinking, came down to zero."""
    toppled = 1
    """The resultant reached the edge of the foundation under load (5 % of the largest
    normal force, or more): the block rolls over it."""
    arrested = 2
    """Kinetic and elastic energy fell below 1e-4 of the incoming energy."""
    in_contact = 3
    """Still in contact after 1 s."""
    separating = 4
    """The block was moving away from the ground: no impact, velocities unchanged."""
    failed = 5
    """The integration did not finish; every number but that of steps is NaN."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")

    def __format__(self, specification: str) -> str:
        return format(str(self), specification)

    def __eq__(self, other: object) -> bool:
        return str(self) == other if isinstance(other, str) else int(self) == other

    def __ne__(self, other: object) -> bool:
        return str(self) != other if isinstance(other, str) else int(self) != other

    def __hash__(self) -> int:
        return hash(int(self))


class Margins(NamedTuple):
    """Dimensionless distances to each end of the impact; positive while it goes on."""

    force: Scalar
    """Normal force over its largest value so far; or, if larger, the sinking velocity
    over the speed: a block that sinks goes on pressing, and a force that is zero to
    rounding at the onset is no end."""
    sinking: Scalar
    """Sinking above 0.5e-6 R, over R."""
    toppling: Scalar
    """N B_t/2 less |M|, over the force's scale times R; or, if larger, the sinking
    still missing before the block may topple, over R."""
    arrest: Scalar
    """Energy left above 1e-4 of the incoming one, over the incoming one."""


OUTCOME_OF_MARGIN = (
    Outcome.detached,
    Outcome.detached,
    Outcome.toppled,
    Outcome.arrested,
)


def closing_velocity(ground: ImpactConstants, motion: Motion) -> Scalar:
    """Compute the velocity at which the block's deepest point sinks at touch [m/s]; a
    block for which it is not positive is separating."""
    arm = ground.shape.arm_at_touch(
        ground.axes, ground.sin_start, ground.cos_start, motion.angular_velocity
    )
    return motion.normal_velocity + arm * motion.angular_velocity


def end_margins(
    ground: ImpactConstants,
    motion: Motion,
    now: Contact,
    force_scale: Scalar,
    speed_scale: Scalar,
    incoming_energy: Scalar,
) -> Margins:
    """Return the margins to the ends of the impact.

    Args:
        ground, motion, now: constants, state and contact.
        force_scale: largest normal force so far [N], positive. (Forces early in a
            contact are a billionth of what they grow to; by a fixed scale they would
            look like zero.)
        speed_scale: impact speed [m/s].
        incoming_energy: kinetic energy at impact [J].

    Continuous; kinked at M = 0 and where the larger of two conditions changes.
    """
    radius = ground.axes.minor
    base = now.foundation
    normal = now.normal_force_before_cut
    leverage = 0.5 * normal * base.length - jnp.abs(now.forces.moment)
    energy = kinetic_energy(ground, motion) + elastic_energy(motion, now.stiffness)
    return Margins(
        force=jnp.maximum(normal / force_scale, now.approach[0] / speed_scale),
        sinking=base.sinking / radius - 0.5 * INITIAL_SINKING,
        toppling=jnp.maximum(
            leverage / (force_scale * radius),
            TOPPLING_SINKING - base.sinking / radius,
        ),
        arrest=energy / incoming_energy - ARREST_ENERGY,
    )

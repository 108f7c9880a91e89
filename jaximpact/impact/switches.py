"""Switching functions: functions of the state that change sign where a law switches.

The rates of the state are continuous at a switch, their slopes are not. A step that
runs across one would be accurate to second order only in its value, and to first order
in its derivatives. So a step takes one `Branch` from start to end, and the step size
control lands on the switches as it lands on the end of the impact.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from .._types import Scalar
from ..laws import AbstractHardening, Branch
from .dynamics import Contact, Ground, Motion, turned

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
    ground: Ground, motion: Motion, now: Contact, force_scale: Scalar
) -> Switches:
    """Values of the switching functions.

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


def at_start(ground: Ground, switches: Switches) -> Switches:
    """Switching functions at touch: a block that lies on a level face is on the side to
    which its spin turns it."""
    if switches.side is None or ground.start_side is None:
        return switches
    towards = jnp.where(ground.start_side, SWITCHED_OFF, -SWITCHED_OFF)
    is_level = jnp.abs(switches.side) <= SWITCHED_OFF
    return switches._replace(side=jnp.where(is_level, towards, switches.side))


def branch_of(switches: Switches) -> Branch:
    """The side taken at each switch."""
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


def in_force(switches: Switches, hardening: AbstractHardening) -> Switches:
    """Tell which switches are active: those of flow while the soil yields, those of
    hardening where the soil's law has them."""
    yields = switches.yielding > 0.0
    by_sliding, by_rocking = hardening.heeds_signs()
    always = jax.tree.map(lambda _: jnp.ones_like(yields), switches)
    return always._replace(
        heave=yields, shear=yields & by_sliding, rocking=yields & by_rocking
    )

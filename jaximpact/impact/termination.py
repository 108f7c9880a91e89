"""Termination of an impact: margins to its ends, and named outcomes."""

import enum
from typing import NamedTuple

import jax.numpy as jnp

from .._types import Scalar
from .dynamics import (
    INITIAL_SINKING,
    Contact,
    Ground,
    Motion,
    elastic_energy,
    kinetic_energy,
)

TOPPLING_SINKING = 1e-3
"""Sinking over R above which a block can topple."""
ARREST_ENERGY = 1e-4
"""Energy over the incoming energy below which a block is arrested."""
TIME_LIMIT = 1.0
"""Longest contact that is integrated [s]."""


class Outcome(enum.IntEnum):
    """Why an impact ended."""

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
    """The integration did not finish; every number is NaN."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")


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


def closing_velocity(ground: Ground, motion: Motion) -> Scalar:
    """Velocity at which the block's deepest point sinks at touch [m/s]; a block for
    which it is not positive is separating."""
    arm = ground.shape.arm_at_touch(
        ground.axes, ground.sin_start, ground.cos_start, motion.angular_velocity
    )
    return motion.normal_velocity + arm * motion.angular_velocity


def end_margins(
    ground: Ground,
    motion: Motion,
    now: Contact,
    force_scale: Scalar,
    speed_scale: Scalar,
    incoming_energy: Scalar,
) -> Margins:
    """Margins to the ends of the impact.

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

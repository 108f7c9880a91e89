r"""Roughness: facets of the ground that are turned against their segment.

An impact strikes a facet: the plane turned where the block touches it, by an angle
sampled from a normal distribution. Its standard deviation is the roughness, and it is
truncated at three of them. Each impact has its own sample, by the seed, the number of
the block and that of the impact, and is computed with the facet's slope, in the facet's
frame. A facet on which the block does not close, or more slowly than makes an impact,
is rejected, and another sampled: a block that grazes the ground strikes facets that
face it.

**After it** the block continues from where the contact left it. If that is in the
segment it is lifted out, which costs $m g \cos w$ times the depth, and if its energy
does not suffice for that it stops. It stays on the ground if it leaves neither the
facet nor the segment. One that leaves the facet into the segment strikes it at once
again, on another facet. So no contact creates energy, and none sends a block through
the ground.

Touches too slow to be an impact, rolling and sliding see the segment.
"""

import jax.numpy as jnp
import numpy as np
from scipy.special import ndtr, ndtri

from ...scene import GRAVITY
from ..blocks import put, select, support
from ..ground_motion.rolling import SMALL_RISE
from ..lane_programs import Values
from ..random_inputs import key_of, uniforms_at
from ..state import BlockConstants, RunState
from .plane_contact import Continuation, PlaneContact, PostImpact, touch_facet

CUT = 3.0
"""Number of standard deviations at which the distribution of angles is truncated."""


def strike_facets(
    state: RunState,
    lanes: np.ndarray,
    touched: PlaneContact,
    struck: PlaneContact,
    rough: np.ndarray,
) -> np.ndarray:
    """Sample the facets that impacts on rough ground strike, and write the contacts
    with them to `struck`.

    Returns:
        Angles of the facets from the segments [rad], `(lanes,)`; 0 for a block that
        strikes the segment.
    """
    block = state.blocks
    deviation = state.roughness[lanes, block.segment[lanes].astype(int)]
    slope, slow = touched.slope, touched.slow
    turned = np.zeros(len(lanes))
    open_yet = np.flatnonzero(rough)
    key = key_of(state.seed, "roughness")
    low, high = ndtr(-CUT), ndtr(CUT)
    # Nearly half of all facets face even a block that grazes the ground: one that finds
    # none of 32 strikes the segment.
    for attempt in range(32):
        if not len(open_yet):
            break
        blocks = lanes[open_yet]
        number = state.numbers[blocks]
        uniform = uniforms_at(
            [block.impacts[blocks], attempt, number & 0xFFFFFFFF, number >> 32], key
        )
        turn = deviation[open_yet] * ndtri(low + (high - low) * uniform)
        facet = touch_facet(
            *select((block, state.constants), blocks), slope[open_yet], turn
        )
        # Not steeper than both 85 degrees and the segment.
        steepest = np.maximum(np.radians(85.0), np.abs(slope[open_yet]))
        good = np.abs(slope[open_yet] + turn) <= steepest
        good &= facet.closing >= slow[open_yet]
        put(struck, open_yet[good], select(facet, good))
        turned[open_yet[good]] = turn[good]
        open_yet = open_yet[~good]
    return turned


def lift_off_facet(
    constants: BlockConstants,
    touched: PlaneContact,
    struck: PlaneContact,
    gap: Values,
    after: PostImpact,
    on: Continuation,
) -> tuple[PostImpact, Continuation]:
    """Set a block that a facet left in its segment back on it, given its gap at touch
    [m], and the block on the facet after the contact and as it leaves it."""
    outline, mass = constants.outline, constants.mass_properties.mass
    slope, slow = touched.slope, touched.slow
    turn = struck.slope - slope
    sin, cos = jnp.sin(turn), jnp.cos(turn)
    theta = after.orientation + turn
    before, _ = support(
        outline, jnp.sin(touched.orientation), jnp.cos(touched.orientation)
    )
    radius, arm = support(outline, jnp.sin(theta), jnp.cos(theta))
    over = gap + before - radius + after.rise * cos - after.travel * sin
    depth = jnp.maximum(-over, 0.0)
    v_n, v_t = after.normal_velocity, after.tangential_velocity
    spin = after.angular_velocity
    kinetic = constants.mass_properties.kinetic_energy(v_n, v_t, spin)
    left = kinetic - mass * GRAVITY * jnp.cos(slope) * depth
    kept = left / jnp.where(kinetic > 0.0, kinetic, 1.0)
    fraction = jnp.sqrt(jnp.maximum(kept, 0.0))
    climbs = (left > 0.0) | (depth == 0.0)
    lift, over = jnp.where(climbs, depth, 0.0), jnp.maximum(over, 0.0)
    rising = -v_n * cos - v_t * sin
    leaves = fraction * after.leaving >= slow
    leaves |= fraction * (rising - arm * spin) >= slow
    leaves |= over > SMALL_RISE * outline.smallest
    lifted = Continuation(
        x=on.x + lift * jnp.sin(slope),
        y=on.y + lift * jnp.cos(slope),
        orientation=theta,
        tangential_velocity=fraction * (v_t * cos - v_n * sin),
        over=over,
        rising=fraction * rising,
        leaves=leaves,
        stuck=on.stuck | ~climbs,
    )
    return after.scaled(fraction), lifted

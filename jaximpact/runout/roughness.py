r"""Roughness: the ground is locally turned against its segment.

An impact meets a facet: the plane turned where the block touches it, by an angle drawn
from a normal distribution. Its standard deviation is the roughness, and it is cut off
at three of them. Each impact draws its own, by the seed, the number of the block and
that of the impact. It is computed with the facet's slope, in the facet's frame. Facets
on which the block does not close, or more slowly than makes an impact, are not met:
another is drawn. So a block that grazes the ground meets those that face it.

**After it** the block goes on from where the contact left it. If that is in the segment
it is lifted out, which costs $m g \cos w$ times the depth, and if its energy does not
suffice for that it stops. It stays on the ground if it leaves neither the facet nor the
segment. One that leaves the facet into the segment strikes it at once again, and meets
another facet. So no contact makes energy, and none sends a block through the ground.

Touches too slow to be an impact, rolling and sliding see the segment.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from scipy.special import ndtr, ndtri

from ..scene import GRAVITY
from .contact import Matter, Settled, Touch, touch
from .motion import Outline, Scalar, support
from .philox import shares_at
from .programs import closed_form
from .quantities import key_of
from .state import State

CUT = 3.0
"""Standard deviations at which the distribution is cut off."""
STEEPEST_FACET = np.radians(85.0)
"""Facets steeper than this, and than their segment, are not met [rad]."""
ATTEMPTS = 32
"""Facets drawn for an impact; then it meets the segment. Nearly half of all facets face
even a block that grazes the ground."""
STREAM = "roughness"


def meet(state: State, lanes: np.ndarray, touched: Touch, slow: np.ndarray) -> Touch:
    """The planes that impacts meet, in their frames.

    Args:
        lanes: blocks that strike rough ground.
        touched: the planes of the segments that they touch.
        slow: closing speeds that make an impact [m/s].
    """
    deviation = state.roughness[lanes, state.segment[lanes]]
    met = Touch(*(column.copy() for column in touched))
    places = np.arange(len(lanes))
    key = key_of(state.seed, STREAM)
    for attempt in range(ATTEMPTS):
        if not len(places):
            break
        some = lanes[places]
        number = state.numbers[some]
        share = shares_at(
            [state.impacts[some], attempt, number & 0xFFFFFFFF, number >> 32], key
        )
        slope = touched.slope[places] + deviation[places] * _cut_normal(share)
        facet = touch(
            state.of(some, state.body),
            state.of(some, state.outline),
            np.sin(slope),
            np.cos(slope),
        )
        steepest = np.maximum(STEEPEST_FACET, np.abs(touched.slope[places]))
        good = (np.abs(slope) <= steepest) & (facet.closing >= slow[places])
        for column, values in zip(met, facet, strict=True):
            column[places[good]] = values[good]
        places = places[~good]
    return met


def _cut_normal(share: np.ndarray) -> np.ndarray:
    """Standard normal numbers between -CUT and CUT, at shares of their distribution."""
    low, high = ndtr(-CUT), ndtr(CUT)
    return ndtri(low + (high - low) * share)


class Lifted(NamedTuple):
    """A block after it met a facet, as its segment sees it."""

    lift: Scalar
    """Along the segment's N, out of it [m]."""
    over: Scalar
    """How far it is above the segment [m]."""
    share: Scalar
    """Of its velocities, after the lift."""
    orientation: Scalar
    """Theta [rad], of the segment."""
    tangential_velocity: Scalar
    """Along the segment [m/s]."""
    leaving: Scalar
    """Velocity at which its lowest point leaves the segment [m/s]."""
    climbs: Scalar
    """1 where its energy suffices for the lift."""


def _lift(
    outline: Outline,
    matter: Matter,
    touched: Touch,
    met: Touch,
    gap: Scalar,
    settled: Settled,
) -> Lifted:
    """The block set back on its segment, where the facet left it in there.

    Args:
        touched: the segment at touch.
        met, settled: the facet at touch, and the block on it after.
        gap: at touch, as of `settle`.
    """
    turn = met.slope - touched.slope
    sin, cos = jnp.sin(turn), jnp.cos(turn)
    theta = settled.orientation + turn
    before, _ = support(
        outline, jnp.sin(touched.orientation), jnp.cos(touched.orientation)
    )
    radius, arm = support(outline, jnp.sin(theta), jnp.cos(theta))
    over = gap + before - radius + settled.rise * cos - settled.travel * sin
    lift = jnp.maximum(-over, 0.0)
    v_n, v_t = settled.normal_velocity, settled.tangential_velocity
    spin = settled.angular_velocity
    kinetic = 0.5 * (matter.mass * (v_n**2 + v_t**2) + matter.inertia * spin**2)
    left = kinetic - matter.mass * GRAVITY * jnp.cos(touched.slope) * lift
    share = jnp.sqrt(jnp.maximum(left, 0.0) / jnp.where(kinetic > 0.0, kinetic, 1.0))
    climbs = (left > 0.0) | (lift == 0.0)
    away = -v_n * cos - v_t * sin - arm * spin
    return Lifted(
        lift=jnp.where(climbs, lift, 0.0),
        over=jnp.maximum(over, 0.0),
        share=share,
        orientation=theta,
        tangential_velocity=share * (v_t * cos - v_n * sin),
        leaving=share * away,
        climbs=climbs.astype(float),
    )


lift = closed_form(_lift)

r"""Consequences of the support of a shape alone, whatever its section.

Parting: in a direction u the point p is outside of the block by
$f(u) = p\cdot u - r(u)$, with r the support. The largest of these is its distance from
the block. By symmetry the point may be taken to lie in the first quadrant, and the
direction with it. There f has no other maximum if the point is outside. Two directions
that enclose it, with the points q at which the block reaches farthest in them, give the
next one: in turns the normal of the chord between these points, which is the very
normal of a flat face, and the direction in which $(p - q)\cdot u'$ vanishes if it
changes linearly, which is that from a corner.

Rolling: a round block rolls in place of one of another shape.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .._types import Scalar


def farthest_direction(shape, axes, along, across):
    """Find the direction, a unit vector, in which a point is farthest outside of a
    block; of a point inside, a direction in which it is not deep."""
    p = jnp.abs(along), jnp.abs(across)
    first = _Try.of(shape, axes, p, jnp.ones_like(along), jnp.zeros_like(along))
    last = _Try.of(shape, axes, p, jnp.zeros_like(along), jnp.ones_like(along))
    best = first.or_better(last)
    for turn in range(16):
        between = first.chord_normal(last) if turn % 2 == 0 else first.straight(last)
        new = _Try.of(shape, axes, p, *between)
        best = best.or_better(new)
        rises = new.slope > 0.0
        first, last = new.where(rises, first), last.where(rises, new)
    return (
        jnp.where(along < 0.0, -best.u[0], best.u[0]),
        jnp.where(across < 0.0, -best.u[1], best.u[1]),
    )


class _Try:
    """A direction u in the first quadrant, the block's farthest point q in it, and how
    far outside the point is."""

    def __init__(self, u, q, excess, slope):
        self.u, self.q, self.excess, self.slope = u, q, excess, slope

    @classmethod
    def of(cls, shape, axes, p, cos, sin) -> "_Try":
        support = shape.support(axes, sin, cos)
        arm = shape.tangency_arm(axes, sin, cos)
        return cls(
            u=(cos, sin),
            q=(support * cos - arm * sin, support * sin + arm * cos),
            excess=p[0] * cos + p[1] * sin - support,
            slope=p[1] * cos - p[0] * sin - arm,
        )

    def where(self, chosen, other: "_Try") -> "_Try":
        """Choose this one where a condition holds, else the other."""
        mine = (*self.u, *self.q, self.excess, self.slope)
        its = (*other.u, *other.q, other.excess, other.slope)
        a, b, c, d, *rest = (
            jnp.where(chosen, x, y) for x, y in zip(mine, its, strict=True)
        )
        return _Try((a, b), (c, d), *rest)

    def or_better(self, other: "_Try") -> "_Try":
        return self.where(self.excess >= other.excess, other)

    def chord_normal(self, last: "_Try"):
        """Outward normal of the chord between what two directions reach; the middle of
        the directions where it is one of them already, or there is no chord."""
        down, up = self.q[0] - last.q[0], last.q[1] - self.q[1]
        x, y = _unit(jnp.maximum(up, 0.0), jnp.maximum(down, 0.0))
        after_first = y * self.u[0] - x * self.u[1]
        before_last = x * last.u[1] - y * last.u[0]
        # Directions within 1e-12 are one.
        known = (after_first <= 1e-12) | (before_last <= 1e-12)
        return _unit(
            jnp.where(known, self.u[0] + last.u[0], x),
            jnp.where(known, self.u[1] + last.u[1], y),
        )

    def straight(self, last: "_Try"):
        """Find where the slope vanishes between two directions if it changes
        linearly."""
        rise, fall = jnp.maximum(self.slope, 0.0), jnp.maximum(-last.slope, 0.0)
        level = rise + fall <= 0.0
        rise, fall = jnp.where(level, 1.0, rise), jnp.where(level, 1.0, fall)
        return _unit(
            fall * self.u[0] + rise * last.u[0], fall * self.u[1] + rise * last.u[1]
        )


def _unit(x, y):
    size = jnp.sqrt(x**2 + y**2)
    size = jnp.where(size > 0.0, size, 1.0)
    return x / size, y / size


ORIENTATIONS = 64
"""Number of orientations over a quarter of a turn."""


class RoundBlock(NamedTuple):
    """Quantities of the section in the plane of motion that rolling needs."""

    radius: Scalar
    """Radius of the circle of the same perimeter [m]: the mean of the support over a
    turn."""
    tallest: Scalar
    """Largest support [m]: the height of the centre as the block gets over its longest
    way across."""
    turning_slope: Scalar
    """Largest $|r_y'| / r_y$ [-]: tangent of the slope on which the block falls over
    from any side by itself."""


def round_block(shape, axes) -> RoundBlock:
    """Make the round block from the support at many orientations.

    The mean is that over the middles of equal intervals, the other two are the largest
    found: within some 1e-3.
    """
    quarter = 0.5 * np.pi
    middles = (np.arange(ORIENTATIONS) + 0.5) / ORIENTATIONS * quarter
    # And beside the axes, where the slope of the support is that beside a flat face.
    angles = np.concatenate([middles, [1e-6, quarter - 1e-6]])

    def at(sin, cos):
        return shape.support(axes, sin, cos), shape.tangency_arm(axes, sin, cos)

    support, arm = jax.vmap(at)(jnp.sin(angles), jnp.cos(angles))
    return RoundBlock(
        radius=jnp.mean(support[:ORIENTATIONS]),
        tallest=jnp.max(support),
        turning_slope=jnp.max(jnp.abs(arm) / support),
    )

"""The first contact of a block in flight with the ground.

Steps of certain length (`separation`), so nothing is passed through at any spin, and
quadratic convergence at the contact. The search watches some pieces of the ground, for
as long as no other can be reached (`reach`).
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from ..scene import GRAVITY
from .motion import Body, Outline, Scalar, fly
from .programs import Program
from .separation import (
    NEVER,
    Gap,
    Piece,
    bending_or_size,
    gaps,
    sure_time,
    widest,
)

TOUCHING = 1e-9
"""Gap, by the radius of the circle about the block, within which it touches; rounding
of the coordinates is added."""
APPROACHING = 1e-8
"""Closing speed that counts as one [m/s]; below it is rounding."""
MAX_STEPS = 20_000
"""Steps after which a search is given up. Some 10 are usual, some 100 where a fast spin
meets a slow approach."""


class Watch(NamedTuple):
    """What a search watches, and how far it is."""

    body: Body
    """At the start."""
    outline: Outline
    pieces: tuple[Piece, ...]
    depths: tuple[Scalar, ...]
    """How deep the block sits in each piece [m]: it is followed as if the piece lay
    deeper by that, until it is out of it. More than 0 only where it started in the
    ground."""
    slack: Scalar
    until: Scalar
    """Time for which the pieces suffice [s]."""
    time: Scalar
    steps: Scalar
    touched: Bool[Array, " lanes"]
    piece: Scalar
    """Which one was touched."""
    gap: Gap


class Sighting(NamedTuple):
    """What a search found."""

    time: Scalar
    """Of the contact [s], or up to which there is none."""
    touched: Float[Array, " lanes"]
    """1 where there is a contact."""
    given_up: Float[Array, " lanes"]
    """1 where the steps ran out."""
    piece: Scalar
    """Number of the piece touched."""
    normal_x: Scalar
    """Out of the ground at the contact."""
    normal_y: Scalar
    gap: Scalar
    """At the contact [m], 0 but for rounding, or negative where the block started
    inside the piece."""
    steps: Scalar


def begin(
    body: Body,
    outline: Outline,
    pieces: tuple[Piece, ...],
    scale: Scalar,
    until: Scalar,
) -> Watch:
    """A search at its start.

    Args:
        body, outline: the block.
        pieces: of the ground, to be watched.
        scale: size of the coordinates [m], for their rounding.
        until: time for which the pieces suffice [s].
    """
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    widths = [widest(gaps(body, outline, axis, piece)).width for piece in pieces]
    zero = jnp.zeros_like(body.x)
    return Watch(
        body=body,
        outline=outline,
        pieces=pieces,
        depths=tuple(jnp.maximum(-width, 0.0) for width in widths),
        slack=TOUCHING * outline.largest + 4e-15 * scale,
        until=until,
        time=zero,
        steps=zero,
        touched=zero > 0.0,
        piece=zero,
        gap=Gap(*(zero,) * len(Gap._fields)),
    )


def step(watch: Watch) -> tuple[Watch, Bool[Array, " lanes"]]:
    """One step of certain length, or the contact found."""
    body = fly(watch.body, watch.time)
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    bending = body.angular_velocity**2 * bending_or_size(watch.outline)
    advance = jnp.full_like(watch.time, NEVER)
    touched, place, met = watch.touched, watch.piece, watch.gap
    depths = []
    for number, (piece, depth) in enumerate(
        zip(watch.pieces, watch.depths, strict=True)
    ):
        candidates = gaps(body, watch.outline, axis, piece)
        gap = widest(candidates)
        # Where a block in the ground comes out of it one way it may go in another.
        opens = gap.opening >= -APPROACHING
        deeper = opens & (gap.width + depth < -watch.slack)
        depth = jnp.where(deeper, -gap.width, depth)
        # Once it is out, the piece lies where it lies.
        depth = jnp.where(gap.width > watch.slack, 0.0, depth)
        depths.append(depth)
        touches = (gap.width + depth <= watch.slack) & (gap.opening < -APPROACHING)
        first = touches & ~touched
        touched |= touches
        place = jnp.where(first, float(number), place)
        met = Gap(*(jnp.where(first, a, b) for a, b in zip(gap, met, strict=True)))
        sure = sure_time(
            body, watch.outline, axis, piece, candidates, depth, watch.slack
        )
        # A step must not take it out and in again: some of the time of such a fall.
        short = 0.5 * jnp.sqrt(depth / (GRAVITY + bending))
        sure = jnp.where(depth > watch.slack, jnp.minimum(sure, short), sure)
        advance = jnp.minimum(advance, sure)
    time = jnp.minimum(watch.time + advance, watch.until)
    steps = watch.steps + 1.0
    after = watch._replace(
        depths=tuple(depths),
        time=jnp.where(touched, watch.time, time),
        steps=steps,
        touched=touched,
        piece=place,
        gap=met,
    )
    return after, ~touched & (after.time < watch.until) & (steps < MAX_STEPS)


def finish(watch: Watch) -> Sighting:
    """What was found."""
    given_up = ~watch.touched & (watch.time < watch.until)
    return Sighting(
        time=watch.time,
        touched=watch.touched.astype(float),
        given_up=given_up.astype(float),
        piece=watch.piece,
        normal_x=watch.gap.normal_x,
        normal_y=watch.gap.normal_y,
        gap=watch.gap.width,
        steps=watch.steps,
    )


search = Program(begin, step, finish)
"""`search(body, outline, pieces, scale, until)`; see `begin`."""

"""Time of impact: the first contact of a block in flight with the ground.

Each step is as long as the block is certain to touch nothing (`narrow_phase`): it
passes through nothing at any spin, and converges quadratically at the contact. The
search watches some segments, for as long as no other can be reached (`flights`).
"""

from typing import NamedTuple

import jax.numpy as jnp

from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, choose, fly
from ..lane_programs import LaneProgram, Values
from .narrow_phase import (
    NEVER,
    Gap,
    Piece,
    bending_or_size,
    gaps,
    time_without_contact,
    widest,
)

APPROACHING = 1e-8
"""Closing speed that counts as one [m/s]; below it is rounding."""
MAX_STEPS = 20_000
"""Number of steps after which a search is given up. Some 10 are usual, some 100 where a
fast spin meets a slow approach."""


class Search(NamedTuple):
    """State of a search."""

    body: Body  # block at the start of the flight
    outline: BlockOutline
    pieces: tuple[Piece, ...]
    depths: tuple[Values, ...]
    """Depth of the block in each piece [m]: the piece is taken to lie lower by that,
    until the block is out of it. Above 0 only for a block that started in the
    ground."""
    slack: Values  # gap within which the block touches [m]
    until: Values  # time for which the pieces suffice [s]
    time: Values  # time reached [s]
    steps: Values  # number of steps so far
    touched: Values
    piece: Values  # number of the piece touched
    gap: Gap  # gap at the contact


class FirstContact(NamedTuple):
    """Result of a search."""

    time: Values  # time of the contact [s], or up to which there is none
    touched: Values  # 1 where there is a contact
    given_up: Values  # 1 where the steps ran out
    number: Values  # of the piece, or of the segment, that is touched
    normal_x: Values  # normal out of the ground at the contact
    normal_y: Values
    gap: Values  # at the contact [m]; negative for a start in the ground


def touching_gap(outline: BlockOutline, scale: Values) -> Values:
    """Compute the gap within which a block touches [m]: a part of its size, and the
    rounding of coordinates of this size [m]."""
    return 1e-9 * outline.largest + 4e-15 * scale


def begin(
    body: Body,
    outline: BlockOutline,
    pieces: tuple[Piece, ...],
    scale: Values,
    until: Values,
) -> Search:
    """Begin a search for the contact of a flight with some segments, which suffice
    until a time [s]; the scale is the size of the coordinates, for their rounding [m].
    """
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    widths = [widest(gaps(body, outline, axis, piece)).width for piece in pieces]
    zero = jnp.zeros_like(body.x)
    return Search(
        body=body,
        outline=outline,
        pieces=pieces,
        depths=tuple(jnp.maximum(-width, 0.0) for width in widths),
        slack=touching_gap(outline, scale),
        until=until,
        time=zero,
        steps=zero,
        touched=zero > 0.0,
        piece=zero,
        gap=Gap(*(zero,) * len(Gap._fields)),
    )


def step(now: Search) -> tuple[Search, Values]:
    """Advance by a time without contact, or find the contact."""
    body = fly(now.body, now.time)
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    bending = body.angular_velocity**2 * bending_or_size(now.outline)
    advance = jnp.full_like(now.time, NEVER)
    touched, touched_piece, contact = now.touched, now.piece, now.gap
    depths = []
    for number, (piece, depth) in enumerate(zip(now.pieces, now.depths, strict=True)):
        candidates = gaps(body, now.outline, axis, piece)
        gap = widest(candidates)
        depth, touches = depth_and_touch(gap, depth, now.slack)
        depths.append(depth)
        first = touches & ~touched
        touched |= touches
        touched_piece = jnp.where(first, float(number), touched_piece)
        contact = choose(first, gap, contact)
        free = time_without_contact(
            body, now.outline, axis, piece, candidates, depth, now.slack
        )
        advance = jnp.minimum(advance, not_out_and_in(free, depth, now.slack, bending))
    time = jnp.minimum(now.time + advance, now.until)
    steps = now.steps + 1.0
    after = now._replace(
        depths=tuple(depths),
        time=jnp.where(touched, now.time, time),
        steps=steps,
        touched=touched,
        piece=touched_piece,
        gap=contact,
    )
    return after, ~touched & (after.time < now.until) & (steps < MAX_STEPS)


def depth_and_touch(gap: Gap, depth: Values, slack: Values) -> tuple[Values, Values]:
    """Update the depth of a block in a piece, and tell whether it touches it."""
    # Where a block in the ground comes out of it one way it may go in another.
    opens = gap.opening >= -APPROACHING
    deeper = opens & (gap.width + depth < -slack)
    depth = jnp.where(deeper, -gap.width, depth)
    # Once it is out, the piece lies where it lies.
    depth = jnp.where(gap.width > slack, 0.0, depth)
    return depth, (gap.width + depth <= slack) & (gap.opening < -APPROACHING)


def not_out_and_in(
    free: Values, depth: Values, slack: Values, bending: Values
) -> Values:
    """Shorten a time without contact, so that it does not take a block in the ground
    out and in again: to half the time of such a fall."""
    short = 0.5 * jnp.sqrt(depth / (GRAVITY + bending))
    return jnp.where(depth > slack, jnp.minimum(free, short), free)


def finish(_, now: Search) -> FirstContact:
    """Report the contact, or the time up to which there is none."""
    given_up = ~now.touched & (now.time < now.until)
    return reported(now.time, now.touched, given_up, now.piece, now.gap)


def reported(
    time: Values, touched: Values, given_up: Values, number: Values, gap: Gap
) -> FirstContact:
    """Report the end of a search, with truths as 1 and 0."""
    return FirstContact(
        time=time,
        touched=touched.astype(float),
        given_up=given_up.astype(float),
        number=number,
        normal_x=gap.normal_x,
        normal_y=gap.normal_y,
        gap=gap.width,
    )


search = LaneProgram(begin, step, finish)
"""`search(body, outline, pieces, scale, until)`; see `begin`."""

"""First contact of a block in flight with the ground.

Each segment is searched for itself, and the earliest contact counts. Each step is as
long as the block is certain to touch nothing (`narrow_phase`): it passes through
nothing at any spin, and converges quadratically at the contact.

Most segments are never looked at: the search goes through the tree of `covers`. It
moves the block until it comes close to a cover, and goes into it, to the covers and
segments under it, from that time on; what it cannot reach before a contact that is
found already, it leaves out.
"""

from typing import NamedTuple

import jax.numpy as jnp

from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, choose, fly
from ..covers import END, ROOT, node
from ..lane_programs import LaneProgram, Values
from .narrow_phase import (
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


class GroundSearch(NamedTuple):
    """State of a search."""

    body: Body  # block at the start of the flight
    outline: BlockOutline
    tree: Values  # address of the table of the covers
    slack: Values  # gap within which the block touches [m]
    until: Values
    """Time of the earliest contact so far, or up to which to search [s]; later ones do
    not count."""
    at: Values  # row of the node that is looked at
    entered: Values  # time up to which nothing under the cover above is touched [s]
    time: Values  # time up to which the node is not touched [s]
    is_new: Values  # true for a node that has not been looked at
    depth: Values
    """Depth of the block in a segment [m]: the segment is taken to lie lower by that,
    until the block is out of it. Above 0 only for a block that started in the
    ground."""
    may_touch: Values  # true at the start, and a step after the block came so close
    steps: Values  # number of steps with this node
    given_up: Values  # true where the steps with a node ran out at the time `until`
    touched: Values
    segment: Values  # number of the segment touched, -1 for none
    gap: Gap  # gap at the contact


class FirstContact(NamedTuple):
    """Result of a search."""

    time: Values  # time of the contact [s], or up to which there is none
    touched: Values  # 1 where there is a contact
    given_up: Values  # 1 where the steps ran out
    segment: Values  # number of the segment touched, -1 for none
    normal_x: Values  # normal out of the ground at the contact
    normal_y: Values
    gap: Values  # at the contact [m]; negative for a start in the ground


def touching_gap(outline: BlockOutline, scale: Values) -> Values:
    """Compute the gap within which a block touches [m]: a part of its size, and the
    rounding of coordinates of this size [m]."""
    return 1e-9 * outline.largest + 4e-15 * scale


def begin(
    body: Body, outline: BlockOutline, tree: Values, scale: Values, until: Values
) -> GroundSearch:
    """Begin a search for the contact of a flight until a time [s], in the tree at an
    address; the scale is the size of the coordinates, for their rounding [m]."""
    zero = jnp.zeros_like(body.x)
    return GroundSearch(
        body=body,
        outline=outline,
        tree=tree,
        slack=touching_gap(outline, scale),
        until=until,
        at=zero + ROOT,
        entered=zero,
        time=zero,
        is_new=zero == 0.0,
        depth=zero,
        may_touch=zero == 0.0,
        steps=zero,
        given_up=zero > 0.0,
        touched=zero > 0.0,
        segment=zero - 1.0,
        gap=Gap(*(zero,) * len(Gap._fields)),
    )


def step(now: GroundSearch) -> tuple[GroundSearch, Values]:
    """Advance by a time without contact with the node, go into it, or leave it."""
    cover, to_left = node(now.tree, now.at), now.body.v_x < 0.0
    is_segment = cover.segment >= 0.0
    piece = Piece(*cover[:4])
    body = fly(now.body, now.time)
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    candidates = gaps(body, now.outline, axis, piece)
    gap = widest(candidates)
    begun_in = jnp.maximum(-gap.width, 0.0)
    depth = jnp.where(now.is_new, begun_in, now.depth)
    depth, is_close = depth_and_touch(gap, depth, now.slack)
    is_close &= is_segment
    # A step more, from within the slack to the touch itself. Where in the slack a
    # search comes to depends on its way through the tree, and a block that bounces
    # makes more of it from contact to contact.
    touches = is_close & (now.may_touch | (gap.width + depth <= 0.0))
    # Of several segments touched at once the one counts that the block closes on
    # fastest, in whatever order they come; of those at a point the first.
    faster = now.gap.opening - gap.opening
    alike = jnp.abs(faster) <= APPROACHING
    counts = jnp.where(alike, cover.segment < now.segment, faster > 0.0)
    first = touches & ((now.time < now.until) | counts | ~now.touched)
    until = jnp.where(first, now.time, now.until)

    # A search goes into a cover from a gap of a hundredth of the block's size on. Half
    # of that is left, so that the block does not come into it.
    close = 0.01 * now.outline.largest
    enters = ~is_segment & (gap.width <= close)
    lower = jnp.where(is_segment, depth, -0.5 * close)
    # A block that touches the ground without closing on it may sink in by the slack;
    # any other comes to the ground itself.
    grazes = ~is_close & (gap.width + lower <= now.slack)
    sinks = jnp.where(grazes, now.slack, 0.0)
    free = time_without_contact(
        body, now.outline, axis, piece, candidates, lower, sinks
    )
    # Half of it, so that one that leaves the ground comes to it from above again.
    free = jnp.where(grazes, 0.5 * free, free)
    bending = now.body.angular_velocity**2 * bending_or_size(now.outline)
    depth_left = jnp.maximum(lower, 0.0)
    time = now.time + not_out_and_in(free, depth_left, now.slack, bending)

    steps = now.steps + 1.0
    gives_up = ~enters & ~touches & (steps >= MAX_STEPS)
    gives_up &= time < until
    until = jnp.where(gives_up, time, until)
    leaves = ~enters & (touches | (time >= until))
    follows = jnp.where(to_left, cover.next_to_left, cover.next_to_right)
    child = jnp.where(to_left, cover.child_to_left, cover.child_to_right)
    at = jnp.where(enters, child, now.at)
    at = jnp.where(leaves, follows, at)
    # Only nodes under the same cover follow each other in the table.
    is_beside = jnp.abs(follows - now.at) == 1.0
    entered = jnp.where(leaves & ~is_beside, 0.0, now.entered)
    entered = jnp.where(enters, now.time, entered)
    is_new = enters | leaves
    after = now._replace(
        until=until,
        at=at,
        entered=entered,
        time=jnp.where(is_new, entered, time),
        is_new=is_new,
        depth=depth,
        may_touch=is_close | is_new,
        steps=jnp.where(is_new, 0.0, steps),
        given_up=(now.given_up & ~first) | gives_up,
        touched=(now.touched | first) & ~gives_up,
        segment=jnp.where(first, cover.segment, now.segment),
        gap=choose(first, gap, now.gap),
    )
    return after, at != END


def depth_and_touch(gap: Gap, depth: Values, slack: Values) -> tuple[Values, Values]:
    """Update the depth of a block in a segment, and tell whether it is close enough to
    touch it, and closes on it."""
    # Where a block in the ground comes out of it one way it may go in another.
    opens = gap.opening >= -APPROACHING
    deeper = opens & (gap.width + depth < -slack)
    depth = jnp.where(deeper, -gap.width, depth)
    # Once it is out, the segment lies where it lies.
    depth = jnp.where(gap.width > slack, 0.0, depth)
    return depth, (gap.width + depth <= slack) & (gap.opening < -APPROACHING)


def not_out_and_in(
    free: Values, depth: Values, slack: Values, bending: Values
) -> Values:
    """Shorten a time without contact, so that it does not take a block in the ground
    out and in again: to half the time of such a fall."""
    short = 0.5 * jnp.sqrt(depth / (GRAVITY + bending))
    return jnp.where(depth > slack, jnp.minimum(free, short), free)


def finish(_, now: GroundSearch) -> FirstContact:
    """Report the contact, or the time up to which there is none."""
    return FirstContact(
        time=now.until,
        touched=now.touched.astype(float),
        given_up=now.given_up.astype(float),
        segment=now.segment,
        normal_x=now.gap.normal_x,
        normal_y=now.gap.normal_y,
        gap=now.gap.width,
    )


first_contact = LaneProgram(begin, step, finish)
"""`first_contact(body, outline, tree, scale, until)`; see `begin`."""

"""First contact of a block with ground whose segments are short against it.

Each segment is searched for itself, as `time_of_impact` searches some at once, and the
earliest contact counts. Most segments are never looked at: the search goes through the
tree of `covers`. It moves the block until it comes close to a cover, and goes into it,
to the covers and segments under it, from that time on; what it cannot reach before a
contact that is found already, it leaves out.
"""

from typing import NamedTuple

import jax.numpy as jnp

from ..blocks import BlockOutline, Body, choose, fly
from ..covers import END, ROOT, node
from ..lane_programs import LaneProgram, Values
from . import time_of_impact
from .narrow_phase import (
    Gap,
    Piece,
    bending_or_size,
    gaps,
    time_without_contact,
    widest,
)
from .time_of_impact import (
    FirstContact,
    depth_and_touch,
    not_out_and_in,
    reported,
    touching_gap,
)


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
    depth: Values  # depth of the block in a segment [m]; see `time_of_impact`
    steps: Values  # number of steps with this node
    given_up: Values  # true where the steps with a node ran out at the time `until`
    touched: Values
    segment: Values  # number of the segment touched, -1 for none
    gap: Gap  # gap at the contact


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
    depth, touches = depth_and_touch(gap, depth, now.slack)
    touches &= is_segment
    # Of several segments touched at once the one counts that the block closes on
    # fastest, in whatever order they come; of those at a point the first.
    faster = now.gap.opening - gap.opening
    alike = jnp.abs(faster) <= time_of_impact.APPROACHING
    counts = jnp.where(alike, cover.segment < now.segment, faster > 0.0)
    first = touches & ((now.time < now.until) | counts | ~now.touched)
    until = jnp.where(first, now.time, now.until)

    # A search goes into a cover from a gap of a hundredth of the block's size on. Half
    # of that is left, so that the block does not come into it.
    close = 0.01 * now.outline.largest
    enters = ~is_segment & (gap.width <= close)
    lower = jnp.where(is_segment, depth, -0.5 * close)
    free = time_without_contact(
        body, now.outline, axis, piece, candidates, lower, now.slack
    )
    bending = now.body.angular_velocity**2 * bending_or_size(now.outline)
    depth_left = jnp.maximum(lower, 0.0)
    time = now.time + not_out_and_in(free, depth_left, now.slack, bending)

    steps = now.steps + 1.0
    gives_up = ~enters & ~touches & (steps >= time_of_impact.MAX_STEPS)
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
        steps=jnp.where(is_new, 0.0, steps),
        given_up=(now.given_up & ~first) | gives_up,
        touched=(now.touched | first) & ~gives_up,
        segment=jnp.where(first, cover.segment, now.segment),
        gap=choose(first, gap, now.gap),
    )
    return after, at != END


def finish(_, now: GroundSearch) -> FirstContact:
    """Report the contact, or the time up to which there is none."""
    return reported(now.until, now.touched, now.given_up, now.segment, now.gap)


first_contact = LaneProgram(begin, step, finish)
"""`first_contact(body, outline, tree, scale, until)`; see `begin`."""

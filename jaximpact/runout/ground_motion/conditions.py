"""Conditions for events on each element of the path ahead, evaluated for each alone."""

import math
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...scene import GRAVITY
from ..centre_path import LARGEST_TURN, LEFT_BEHIND, Ahead
from ..lane_programs import Values, closed_form
from .riders import Riders

MILD = LARGEST_TURN
"""Turn of the ground at a point up to which it is taken for a point of a curve [rad]:
points then lie closer than an eighth of the curve's radius."""
CURVE = 2.0
"""Radii of the block, at both sides, to which a single point may belong to a curve."""


class Motion(NamedTuple):
    """Motion over the elements ahead, arrays `(blocks, elements)`."""

    start_squared: np.ndarray
    """Squared speed at the start of an element [m2/s2]."""
    stop_squared: np.ndarray
    friction: np.ndarray
    """Tangent of the angle of friction."""


class Bend(NamedTuple):
    """Ground about a point."""

    shorter: Values
    """As in `Elements`."""
    on_curve: Values
    begins: Values
    """1 where the arc about the point begins, 0 for a later part of it."""


class Passage(NamedTuple):
    """Passage over an element."""

    length: Values
    """Length along the path [m]."""
    duration: Values
    """Time that it takes [s]."""
    speed: Values
    """Speed at the start [m/s]."""


class Conditions(NamedTuple):
    """Conditions for events on an element; 1 where true, 0 where false."""

    slow: Values
    """True where the block becomes too slow for its kind of motion."""
    loose: Values
    """True where the path falls away faster than the block does."""
    corner: Values
    """True where the path turns up behind the element by more than `MILD`."""
    hard: Values
    """True where that is an impact."""
    turn: Values
    """Angle by which the path turns, on the element and up behind it [rad]."""
    passage: Passage


def loss_with_height(riders: Riders) -> Values:
    """Compute the loss of squared speed with height, 2 g / (1 + k) [m/s2]."""
    return 2.0 * GRAVITY / (1.0 + riders.ratio)


def _least_squared(
    riders: Riders, n_x: Values, n_y: Values, friction: Values
) -> Values:
    steep = abs(n_x) > (riders.turning_slope + friction) * n_y
    return jnp.where(steep, 0.0, loss_with_height(riders) * riders.barrier * n_y)


least_squared = closed_form(_least_squared)
"""`least_squared(riders, n_x, n_y, friction)`: squared speeds below which blocks do not
roll on over their long axes [m2/s2], as `rolling.barrier` gives them."""


def _arc(ahead: Ahead, h: Values) -> Values:
    """Compute the angle of an arc [rad], which is small, from its chord."""
    d_x, d_y = ahead.stop_x - ahead.start_x, ahead.stop_y - ahead.start_y
    squared = 0.25 * (d_x**2 + d_y**2) / h**2
    series = 1.0 + squared * (
        1.0 / 6.0
        + squared * (3.0 / 40.0 + squared * (15.0 / 336.0 + squared * 105.0 / 3456.0))
    )
    return 2.0 * jnp.sqrt(squared) * series


def _passage(ahead: Ahead, motion: Motion, riders: Riders) -> Passage:
    h = riders.radius
    d_x, d_y = ahead.stop_x - ahead.start_x, ahead.stop_y - ahead.start_y
    straight = jnp.sqrt(d_x**2 + d_y**2)
    length = jnp.where(ahead.is_segment > 0.0, straight, h * _arc(ahead, h))
    speed = jnp.sqrt(jnp.maximum(motion.start_squared, 0.0))
    both = speed + jnp.sqrt(jnp.maximum(motion.stop_squared, 0.0))
    moves = (length > 0.0) & (both > 0.0)
    duration = jnp.where(moves, 2.0 * length / jnp.where(moves, both, 1.0), 0.0)
    return Passage(length, duration, speed)


passage = closed_form(_passage)
"""`passage(ahead, motion, riders)`: the passage over elements."""


@closed_form
def conditions_on(
    ahead: Ahead, motion: Motion, bend: Bend, riders: Riders
) -> Conditions:
    """Evaluate the conditions on an element, as if no event came before it."""
    is_arc, h = ~(ahead.is_segment > 0.0), riders.radius
    sin = ahead.stop_normal_x * ahead.next_normal_y
    sin -= ahead.stop_normal_y * ahead.next_normal_x
    cos = ahead.stop_normal_x * ahead.next_normal_x
    cos += ahead.stop_normal_y * ahead.next_normal_y
    corner = (sin > math.sin(MILD)) | (cos < 0.0)
    closing = motion.stop_squared * sin**2
    hard = corner & (closing >= riders.closing * ahead.next_normal_y)
    arc = jnp.where(is_arc, _arc(ahead, h), 0.0)
    passed = _passage(ahead, motion, riders)
    return Conditions(
        _is_slow(ahead, motion, riders, is_arc),
        _is_loose(ahead, motion, bend, riders, arc),
        corner,
        hard,
        arc + jnp.maximum(sin, 0.0),
        passed,
    )


def _is_slow(ahead: Ahead, motion: Motion, riders: Riders, is_arc: Values) -> Values:
    start, stop, friction = motion
    n_x, n_y = ahead.start_normal_x, ahead.start_normal_y
    m_x, m_y = ahead.stop_normal_x, ahead.stop_normal_y
    at_start = _least_squared(riders, n_x, n_y, friction)
    at_stop = _least_squared(riders, m_x, m_y, friction)
    # About a point, the speed is least where the path descends as friction does.
    top = jnp.sqrt(1.0 + friction**2)
    climb = riders.radius * (top - (n_y + friction * n_x))
    at_top = start - loss_with_height(riders) * climb
    over_top = is_arc & (n_x < friction * n_y) & (m_x > friction * m_y)
    length = ahead.stop_x - ahead.start_x + jnp.abs(ahead.stop_y - ahead.start_y)
    stands = (start <= 0.0) & (stop <= 0.0) & (length > LEFT_BEHIND * riders.radius)
    slow = (start < at_start) | (stop < at_stop)
    return slow | stands | (over_top & (at_top < at_start))


def _is_loose(
    ahead: Ahead, motion: Motion, bend: Bend, riders: Riders, arc: Values
) -> Values:
    h = riders.radius
    near = jnp.minimum(bend.shorter, 2.0 * CURVE * h)
    curve = jnp.where(bend.on_curve > 0.0, bend.shorter, near) + h * arc
    falls = GRAVITY * ahead.start_normal_y
    mild = motion.start_squared * arc > falls * curve
    at_start = motion.start_squared > falls * h
    at_stop = motion.stop_squared > GRAVITY * ahead.stop_normal_y * h
    slides = motion.start_squared > falls * riders.flat_curvature
    slides &= bend.begins > 0.0
    sharp = jnp.where(riders.rolls > 0.0, at_start | at_stop, slides)
    return (arc > 0.0) & jnp.where(ahead.is_whole > 0.0, mild, sharp)

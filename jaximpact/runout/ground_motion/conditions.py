"""Conditions for events on each element of the path ahead, evaluated for each alone.

Of flights that leave the path one is followed if it comes higher above it than a hop,
or if a round block ends it with an impact. One that is not followed is a part of
rolling: the block goes on along the path at its energy, and over the corners and edges
below the hop without noticing them (`find_hops`).
"""

import math
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...scene import GRAVITY
from ..centre_path import LARGEST_TURN, LEFT_BEHIND, Ahead, CentrePath, in_small_turns
from ..lane_programs import Values, closed_form


class Riders(NamedTuple):
    """Blocks on the ground, arrays `(blocks,)`."""

    radius: np.ndarray  # height of the centre over the ground [m]
    ratio: np.ndarray  # k = I/(m r^2); 0 for a block that slides
    rolls: np.ndarray  # true for a block that rolls
    barrier: np.ndarray  # height by which the long axis lifts a block that rolls [m]
    turning_slope: np.ndarray  # tangent of the slope that tips a block
    flat_curvature: np.ndarray  # radius at which a sliding block leaves an edge [m]
    hop: np.ndarray  # height of a flight that is not followed [m]
    closing: np.ndarray  # squared speed across level ground that makes an impact


MILD = LARGEST_TURN
"""Turn of the ground at a point up to which it is taken for a point of a curve [rad]:
points then lie closer than an eighth of the curve's radius."""


class MotionAhead(NamedTuple):
    """Motion over the elements ahead, arrays `(blocks, elements)`."""

    start_squared: np.ndarray  # squared speed at the start of an element [m2/s2]
    stop_squared: np.ndarray
    friction: np.ndarray  # tangent of the angle of friction


class Bend(NamedTuple):
    """Ground about a point."""

    shorter: Values  # as in `Elements`
    on_curve: Values
    begins: Values  # 1 where the arc about the point begins, 0 for a later part of it


class Passage(NamedTuple):
    """Passage over an element."""

    length: Values  # length along the path [m]
    duration: Values  # time that it takes [s]
    speed: Values  # speed at the start [m/s]


class Conditions(NamedTuple):
    """Conditions for events on an element; 1 where true, 0 where false."""

    slow: Values  # true where the block becomes too slow for its kind of motion
    loose: Values  # true where the path falls away faster than the block does
    corner: Values  # the path turns up behind it by more than `MILD`
    hard: Values  # true where that is an impact
    turn: Values  # angle by which the path turns, on the element and up behind it [rad]
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
roll on over their long axes [m2/s2], as `rolling.begin_on_ground` needs them."""


def _arc(ahead: Ahead, h: Values) -> Values:
    """Compute the angle of an arc [rad], which is small, from its chord."""
    d_x, d_y = ahead.stop_x - ahead.start_x, ahead.stop_y - ahead.start_y
    squared = 0.25 * (d_x**2 + d_y**2) / h**2
    series = 1.0 + squared * (
        1.0 / 6.0
        + squared * (3.0 / 40.0 + squared * (15.0 / 336.0 + squared * 105.0 / 3456.0))
    )
    return 2.0 * jnp.sqrt(squared) * series


def _passage(ahead: Ahead, motion: MotionAhead, riders: Riders) -> Passage:
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
    ahead: Ahead, motion: MotionAhead, bend: Bend, riders: Riders
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


def _is_slow(
    ahead: Ahead, motion: MotionAhead, riders: Riders, is_arc: Values
) -> Values:
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
    # A block that stands at the end of an element loses nothing but rounding on what is
    # left of it: it comes to the corner there.
    is_way = length > LEFT_BEHIND * riders.radius
    stands = (start <= 0.0) & (stop <= 0.0) & is_way
    slow = (start < at_start) | ((stop < at_stop) & is_way)
    return slow | stands | (over_top & (at_top < at_start))


def _is_loose(
    ahead: Ahead, motion: MotionAhead, bend: Bend, riders: Riders, arc: Values
) -> Values:
    h = riders.radius
    # A single point may belong to a curve of two radii of the block at both sides.
    near = jnp.minimum(bend.shorter, 4.0 * h)
    curve = jnp.where(bend.on_curve > 0.0, bend.shorter, near) + h * arc
    falls = GRAVITY * ahead.start_normal_y
    mild = motion.start_squared * arc > falls * curve
    at_start = motion.start_squared > falls * h
    at_stop = motion.stop_squared > GRAVITY * ahead.stop_normal_y * h
    slides = motion.start_squared > falls * riders.flat_curvature
    slides &= bend.begins > 0.0
    sharp = jnp.where(riders.rolls > 0.0, at_start | at_stop, slides)
    return (arc > 0.0) & jnp.where(ahead.is_whole > 0.0, mild, sharp)


def find_hops(
    path: CentrePath,
    riders: Riders,
    element: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
    n_x: np.ndarray,
    n_y: np.ndarray,
    squared: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Find out which flights are followed, and where the others come back to the path
    (x), of blocks that leave the path on elements: from their centres there [m], x in
    the mirror for those that move to the left, with normals and squared speeds
    [m2/s2]."""
    flies, landing_x = np.zeros(len(x), bool), x.copy()
    asking, width = np.arange(len(x)), 8  # elements, and twice as many if need be
    here = element, x, y
    slope, along = -n_x / n_y, squared * n_y**2
    bend = 0.5 * GRAVITY / along
    while len(asking):
        h = riders.radius[asking]
        ahead = in_small_turns(path.ahead(*here, h, width), h)
        # Over each element the path is a straight line, the flight a parabola.
        one, two = ahead.start_x - x[asking, None], ahead.stop_x - x[asking, None]
        run = np.maximum(two - one, 0.0)
        rise = ahead.stop_y - ahead.start_y
        chord = np.sqrt(run**2 + rise**2)
        flat = run > 1e-12 * chord
        grade = np.where(flat, rise / np.where(flat, run, 1.0), 0.0)
        cos = np.where(flat, run / np.where(flat, chord, 1.0), 1.0)
        over, bends = slope[asking, None] - grade, bend[asking, None]
        base = ahead.start_y - y[asking, None] - grade * one
        top = np.clip(0.5 * over / bends, one, two)
        at_top, at_end = ((over - bends * at) * at - base for at in (top, two))
        high = cos * at_top >= riders.hop[asking, None]
        lands = at_end < -LEFT_BEHIND * h[:, None]
        root = np.sqrt(np.maximum(over**2 - 4.0 * bends * base, 0.0))
        landing = np.clip(0.5 * (over + root) / bends, one, two)
        closing = along[asking, None] * (root * cos) ** 2
        hard = closing >= riders.closing[asking, None] * cos
        hard &= riders.barrier[asking, None] == 0.0
        ends = ~ahead.exists & (ahead.next_element == ahead.element)
        decided = ends | (ahead.exists & (high | lands))
        rows, column = np.arange(len(asking)), np.argmax(decided, axis=1)
        followed = ends | high | hard
        flies[asking] = followed[rows, column]
        landing_x[asking] = x[asking] + landing[rows, column]
        open_yet = np.flatnonzero(~np.any(decided, axis=1))
        known = np.count_nonzero(ahead.exists[open_yet], axis=1)
        last = np.maximum(known - 1, 0)
        here = tuple(
            np.where(known > 0, after[open_yet, last], before[open_yet])
            for after, before in zip(
                (ahead.next_element, ahead.stop_x, ahead.stop_y), here, strict=True
            )
        )
        asking, width = asking[open_yet], 2 * width
    return flies, landing_x

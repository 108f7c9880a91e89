r"""Ride: motion of a round block along the path of its centre, up to an event.

**Energy.** With $k = I/(m r^2)$, 0 for a block that slides, and the tangent $\mu$ of
the angle of friction, the speed along the path changes by

$$ \frac{dv^2}{ds} = \frac{2 g}{1 + k}\,(\sin w - \mu\cos w), \qquad
   v^2 = v_0^2 - \frac{2 g}{1 + k}\,(\Delta y + \mu |\Delta x|), $$

exactly, on segments and about points, since the path descends at w there. The friction
about a point is the mean of those beside it.

**Breaks.** A curve is a curve, however many points draw it. Where the path turns up at
a corner by less than `MILD`, it is taken for a part of a curve: the block goes on at
its speed. A sharper corner is one for the block: it strikes what is ahead, with the
velocity across it; one that is too slow for an impact goes on in the new direction with
the part of its angular momentum about the new contact,
$v' = v\,(\cos\delta + k)/(1 + k)$. At a convex break the block leaves the ground where
the path falls away faster than it does, $v^2\kappa > g\cos\alpha$, if the flight is
followed (`conditions`). Where the ground turns down by less than `MILD`, $\kappa$ is
that of the curve that the points draw, from the middle of the shorter segment beside
it; else it is that of the arc, $1/r$. A point that stands alone, where those beside it
do not bend the same way, draws a curve of two radii at most.

**Events**: a corner that is struck, or a slow one; the take-off; a speed that has
become too small; the end of the profile; the limit of time.

The bits of a ride do not depend on the other blocks: products, sums and roots alone are
computed, and added up in order.
"""

import enum
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..._safe import TINY
from ...scene import GRAVITY
from ..blocks import put, select
from ..centre_path import LEFT_BEHIND, Ahead, CentrePath, in_small_turns
from ..libm import arctan2, cos, sin
from ..trajectory import MotionMode, Pieces
from .conditions import (
    Bend,
    Conditions,
    MotionAhead,
    Passage,
    Riders,
    conditions_on,
    find_hops,
    least_squared,
    loss_with_height,
    passage,
)

PIECE_TURN, PIECE_LENGTH = 0.05, 8.0
"""Turn [rad] and length, in radii, up to which small elements are one piece of a
trajectory together. It is a parabola, which follows a curve: it lies apart from the
path by two hundredths of the radius, or 1 mm, at most."""
SMALL_PART = 0.25
"""Part of these up to which an element, or a corner, is small."""
SPEED_KEPT = 0.03
"""Relative error of the squared speed at the end of a piece of two elements up to which
they are one: that of the largest arc and a long segment behind it."""


class Event(enum.IntEnum):
    """What ends a ride."""

    none = 0
    continues = 1
    """No event yet: there are more elements ahead."""
    strikes = 2
    slow_corner = 3
    flies = 4
    slow = 5
    leaves = 6
    """The end of the profile."""
    time_limit = 7


class Place(NamedTuple):
    """Where riders are; arrays `(blocks,)`, x in the mirror for those that move to the
    left."""

    element: np.ndarray
    x: np.ndarray
    y: np.ndarray
    speed_squared: np.ndarray
    time: np.ndarray


class Ride(NamedTuple):
    """Rides up to their events; arrays `(blocks,)`, in the mirror as x is."""

    riders: Riders
    event: np.ndarray  # codes of `Event`
    end: Place
    normal_x: np.ndarray  # normal of the path at the end
    normal_y: np.ndarray
    next_normal_x: np.ndarray  # normal behind the corner at the end
    next_normal_y: np.ndarray
    friction: np.ndarray  # tangent of the angle of friction on the element there
    moved: np.ndarray  # true where the ride led on, by more than rounding
    turned: np.ndarray  # by rolling [rad], in the direction of motion
    passed: np.ndarray  # x in the mirror up to which corners are passed over [m]


FrictionOf = Callable[[np.ndarray], np.ndarray]
"""Gives tangents of angles of friction for numbers of segments, `(blocks, ...)`."""


def ride(
    path: CentrePath,
    friction_of: FrictionOf,
    riders: Riders,
    begin: Place,
    stays_on: np.ndarray,
    passed: np.ndarray,
    time_limit: float,
    width: int,
) -> tuple[Ride, Pieces]:
    """Move riders along the path, to an event or to the last element evaluated.

    Args:
        friction_of: friction on the segments.
        stays_on: elements that riders do not leave, -1 for none.
        passed: x in the mirror up to which riders pass over corners and edges in a hop
            that is not followed [m].
        time_limit: time at which a ride ends [s].
        width: number of elements to evaluate, from 2.

    Returns:
        The rides; and their pieces, rider after rider, in time. The pieces have x in
        the mirror, numbers of riders for trajectories, and orientations from the begin
        in the direction of motion.
    """
    ahead = path.ahead(begin.element, begin.x, begin.y, riders.radius, width)
    ahead = in_small_turns(ahead, riders.radius)
    motion = _motion(path, friction_of, riders, ahead, begin.speed_squared)
    conditions = _conditions(path, riders, ahead, motion)
    event, place, passed = _first_event(
        path, riders, ahead, motion, conditions, stays_on, passed
    )
    _cut(riders, ahead, motion, conditions, event, place)

    columns = np.arange(ahead.element.shape[1])
    done = columns < (place + ENDS_ON[event])[:, None]
    duration = np.where(done, conditions.passage.duration, 0.0)
    time = _sums(begin.time, duration)
    late = done & (time[:, 1:] > time_limit)
    is_late = np.any(late, axis=1)
    place = np.where(is_late, np.argmax(late, axis=1), place)
    event = np.where(is_late, Event.time_limit, event)
    done &= columns < (place + ENDS_ON[event])[:, None]
    if np.any(is_late):
        rows = np.flatnonzero(is_late)
        left = time_limit - time[rows, place[rows]]
        _cut_after(riders, ahead, motion, conditions, rows, place[rows], left)
        time = _sums(begin.time, np.where(done, conditions.passage.duration, 0.0))
    length = np.where(done, conditions.passage.length, 0.0)
    turn = np.where(riders.rolls[:, None], length / riders.radius[:, None], 0.0)
    turned = _sums(0.0, turn)
    pieces = _pieces(riders, ahead, conditions, done, time, length, turned)

    rows, last = np.arange(len(place)), np.count_nonzero(done, axis=1)
    here = np.minimum(place, len(columns) - 1)
    moved, behind = last > 0, np.maximum(last - 1, 0)
    # One that looks on stands behind what it passed; columns there may be filling.
    passed_all = (event == Event.continues) & (place > 0)
    at_corner = (event == Event.strikes) | (event == Event.slow_corner)
    onto_next = at_corner | passed_all
    at = rows, np.where(passed_all, place - 1, here)
    end = Place(
        element=np.where(onto_next, ahead.next_element[at], ahead.element[at]),
        x=np.where(moved, ahead.stop_x[rows, behind], begin.x),
        y=np.where(moved, ahead.stop_y[rows, behind], begin.y),
        speed_squared=np.where(
            moved, motion.stop_squared[rows, behind], begin.speed_squared
        ),
        time=time[rows, last],
    )
    way = np.abs(end.x - begin.x) + np.abs(end.y - begin.y)
    ridden = Ride(
        riders=riders,
        event=event,
        end=end,
        normal_x=ahead.stop_normal_x[rows, here],
        normal_y=ahead.stop_normal_y[rows, here],
        next_normal_x=ahead.next_normal_x[rows, here],
        next_normal_y=ahead.next_normal_y[rows, here],
        friction=_friction_on(path, friction_of, end.element),
        moved=way > LEFT_BEHIND * riders.radius,
        turned=turned[rows, last],
        passed=passed,
    )
    return ridden, pieces


def _friction_on(
    path: CentrePath, friction_of: FrictionOf, element: np.ndarray
) -> np.ndarray:
    """Compute tangents of the angles of friction on elements: about a point, the mean
    of those beside it."""
    ground = path.elements
    return 0.5 * (
        friction_of(ground.behind[element]) + friction_of(ground.ahead[element])
    )


def _motion(
    path: CentrePath,
    friction_of: FrictionOf,
    riders: Riders,
    ahead: Ahead,
    speed_squared: np.ndarray,
) -> MotionAhead:
    """Compute squared speeds over the elements ahead, as if nothing happened there."""
    friction = _friction_on(path, friction_of, ahead.element)
    loss = ahead.stop_y - ahead.start_y + friction * (ahead.stop_x - ahead.start_x)
    loss = loss_with_height(riders)[:, None] * np.where(ahead.exists, loss, 0.0)
    # One after the other, so that it does not matter where a window begins.
    squared = _sums(speed_squared, -loss)
    return MotionAhead(squared[:, :-1], squared[:, 1:], friction)


def _conditions(
    path: CentrePath, riders: Riders, ahead: Ahead, motion: MotionAhead
) -> Conditions:
    """Evaluate the conditions for events on the elements ahead."""
    ground, element = path.elements, ahead.element
    begins = np.ones(element.shape, bool)
    begins[:, 1:] = element[:, 1:] != element[:, :-1]
    bend = Bend(ground.shorter[element], ground.on_curve[element], begins)
    columns = Riders(*(column[:, None] for column in riders))
    return conditions_on(ahead, motion, bend, columns)


def _first_event(
    path: CentrePath,
    riders: Riders,
    ahead: Ahead,
    motion: MotionAhead,
    conditions: Conditions,
    stays_on: np.ndarray,
    passed: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Find the first event of each rider, and the place of its element, behind the last
    one where there is none; and how far it passes over corners."""
    slow, corner = conditions.slow > 0.0, conditions.corner > 0.0
    grounded = np.full(slow.shape, Event.none)
    grounded[corner] = Event.slow_corner
    grounded[conditions.hard > 0.0] = Event.strikes
    loose = (conditions.loose > 0.0) & ~slow & ahead.exists
    loose &= ahead.element != stays_on[:, None]
    grounded[slow] = Event.slow
    grounded[~ahead.exists] = Event.continues
    grounded[~ahead.exists & (ahead.element == path.last(ahead.element))] = Event.leaves
    asking, passed = np.arange(len(stays_on)), passed.copy()
    while True:
        over = ahead.stop_x <= passed[:, None]
        events = np.where(over & corner & ~slow & ahead.exists, Event.none, grounded)
        leaves = loose & (ahead.start_x >= passed[:, None])
        events[leaves] = Event.flies
        place, event = _first(events)
        asking = asking[event[asking] == Event.flies]
        if not len(asking):
            return event, place, passed
        asking_riders, at = select(riders, asking), (asking, place[asking])
        start = _leaving(asking_riders, *select((ahead, motion), at))
        flies, landing_x = find_hops(path, asking_riders, ahead.element[at], *start)
        asking, landing_x = asking[~flies], landing_x[~flies]
        loose[asking, place[asking]] = False
        passed[asking] = np.maximum(passed[asking], landing_x)


def _first(events: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the place of the first event of each row, and the event."""
    is_event = events != Event.none
    place = np.where(
        np.any(is_event, axis=1), np.argmax(is_event, axis=1), events.shape[1]
    )
    padded = np.concatenate(
        [events, np.full((len(events), 1), Event.continues)], axis=1
    )
    return place, padded[np.arange(len(events)), place]


def _leaving(
    riders: Riders, ahead: Ahead, motion: MotionAhead
) -> tuple[np.ndarray, ...]:
    """Compute where riders leave arcs: centres, normals and squared speeds."""
    h, rate, friction = riders.radius, loss_with_height(riders), motion.friction
    n_x, n_y = ahead.start_normal_x, ahead.start_normal_y
    # On the arc v^2 = g h cos(alpha), that is a cos + b sin = c.
    a, b = GRAVITY + rate, rate * friction
    c = motion.start_squared / h + rate * (n_y + friction * n_x)
    size = np.sqrt(a**2 + b**2)
    cos = np.clip(c / size, -1.0, 1.0)
    sin = np.sqrt(1.0 - cos**2)
    cos, sin = (cos * a - sin * b) / size, (sin * a + cos * b) / size
    # A little farther: at the very edge it would leave too slowly to be told from
    # staying.
    little, one = math.sin(1e-3), math.cos(1e-3)
    cos, sin = cos * one - sin * little, sin * one + cos * little
    beyond = sin * ahead.stop_normal_y > cos * ahead.stop_normal_x
    sin = np.where(beyond, ahead.stop_normal_x, sin)
    cos = np.where(beyond, ahead.stop_normal_y, cos)
    at_once = (
        ahead.is_whole | ~riders.rolls | (motion.start_squared > GRAVITY * h * n_y)
    )
    sin, cos = np.where(at_once, n_x, sin), np.where(at_once, n_y, cos)
    height = n_y - cos + friction * (n_x - sin)
    return (
        ahead.start_x + h * (sin - n_x),
        ahead.start_y + h * (cos - n_y),
        sin,
        cos,
        motion.start_squared + rate * h * height,
    )


def _cut(
    riders: Riders,
    ahead: Ahead,
    motion: MotionAhead,
    conditions: Conditions,
    event: np.ndarray,
    place: np.ndarray,
) -> None:
    """Let elements end where blocks become slow on them, or leave them."""
    for kind, where in ((Event.slow, _slowing), (Event.flies, _leaving)):
        rows = np.flatnonzero(event == kind)
        if not len(rows):
            continue
        at, of_rows = (rows, place[rows]), select(riders, rows)
        put(_stops(ahead, motion), at, where(of_rows, *select((ahead, motion), at)))
        put(conditions.passage, at, passage(*select((ahead, motion), at), of_rows))


def _stops(ahead: Ahead, motion: MotionAhead) -> tuple[np.ndarray, ...]:
    """Give where elements end: centres, normals and squared speeds."""
    normals = ahead.stop_normal_x, ahead.stop_normal_y
    return ahead.stop_x, ahead.stop_y, *normals, motion.stop_squared


def _along(
    ahead: Ahead, h: np.ndarray, way: np.ndarray, arc_x: np.ndarray, arc_y: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Compute centres and normals on elements: a way along a segment [m], or where the
    normal of an arc of radius h is (arc_x, arc_y)."""
    n_x, n_y, straight = ahead.start_normal_x, ahead.start_normal_y, ahead.is_segment
    return (
        ahead.start_x + np.where(straight, way * n_y, h * (arc_x - n_x)),
        ahead.start_y + np.where(straight, -way * n_x, h * (arc_y - n_y)),
        np.where(straight, n_x, arc_x),
        np.where(straight, n_y, arc_y),
    )


def _cut_after(
    riders: Riders,
    ahead: Ahead,
    motion: MotionAhead,
    conditions: Conditions,
    rows: np.ndarray,
    columns: np.ndarray,
    left: np.ndarray,
) -> None:
    """Let elements end after some time [s], at the acceleration along the path that
    `Pieces` have."""
    at = rows, columns
    length, duration, speed = (array[at] for array in conditions.passage)
    # One that comes to rest takes for ever.
    ends = np.isfinite(duration) & (duration > 0.0)
    whole = np.where(ends, duration, 1.0)
    acceleration = np.where(
        ends,
        2.0 * (length - speed * whole) / whole**2,
        -0.5 * speed**2 / np.maximum(length, TINY),
    )
    rest = np.where(acceleration < 0.0, speed / np.maximum(-acceleration, TINY), np.inf)
    left = np.clip(left, 0.0, duration)
    moves = np.minimum(left, rest)
    way = np.clip(moves * (speed + 0.5 * moves * acceleration), 0.0, length)
    part = way / np.maximum(length, TINY)
    element, h = select(ahead, at), riders.radius[rows]
    n_x, n_y = element.start_normal_x, element.start_normal_y
    to_x, to_y = element.stop_normal_x, element.stop_normal_y
    turn = part * arctan2(n_x * to_y - n_y * to_x, n_x * to_x + n_y * to_y)
    sin_turn, cos_turn = sin(turn), cos(turn)
    arc_x, arc_y = cos_turn * n_x - sin_turn * n_y, sin_turn * n_x + cos_turn * n_y
    squared = np.maximum(speed + acceleration * moves, 0.0) ** 2
    end = *_along(element, h, way, arc_x, arc_y), squared
    put(_stops(ahead, motion), at, end)
    conditions.passage.length[at] = way
    conditions.passage.duration[at] = left


def _slowing(
    riders: Riders, ahead: Ahead, motion: MotionAhead
) -> tuple[np.ndarray, ...]:
    """Compute where riders become too slow on elements: centres, normals and squared
    speeds."""
    n_x, n_y, friction = ahead.start_normal_x, ahead.start_normal_y, motion.friction
    h, rate = riders.radius, loss_with_height(riders)
    least = least_squared(riders, n_x, n_y, friction)
    spare = np.maximum(motion.start_squared - least, 0.0)
    brake = rate * (friction * n_y - n_x)
    d_x, d_y = ahead.stop_x - ahead.start_x, ahead.stop_y - ahead.start_y
    length = np.sqrt(d_x**2 + d_y**2)
    foot = np.where(brake > 0.0, spare / np.where(brake > 0.0, brake, 1.0), length)
    foot = np.minimum(foot, length)
    # On an arc cos + mu sin has grown to what the energy allows.
    top = np.sqrt(1.0 + friction**2)
    level = n_y + friction * n_x + spare / (rate * h)
    cos = np.minimum(level / top, 1.0)
    sin = np.sqrt(1.0 - cos**2)
    arc_x, arc_y = (friction * cos - sin) / top, (cos + friction * sin) / top
    stays = spare <= 0.0
    arc_x, arc_y = np.where(stays, n_x, arc_x), np.where(stays, n_y, arc_y)
    squared = np.minimum(np.maximum(motion.start_squared, 0.0), least)
    return *_along(ahead, h, foot, arc_x, arc_y), squared


ENDS_ON = np.isin(
    np.arange(len(Event)),
    [Event.strikes, Event.slow_corner, Event.flies, Event.slow, Event.time_limit],
)
"""Events at the end of an element, not at its start: True by their codes."""


def _sums(first: np.ndarray | float, changes: np.ndarray) -> np.ndarray:
    """Add up changes along rows, one after the other; what they start from comes
    first."""
    sums = np.empty((changes.shape[0], changes.shape[1] + 1))
    sums[:, 0], sums[:, 1:] = first, changes
    return np.cumsum(sums, axis=1)


def _pieces(
    riders: Riders,
    ahead: Ahead,
    conditions: Conditions,
    done: np.ndarray,
    time: np.ndarray,
    length: np.ndarray,
    turned: np.ndarray,
) -> Pieces:
    """Record the elements that were passed, at constant acceleration.

    Args:
        done: True for these, `(blocks, elements)`.
        time, turned: at the start of each element and at the end [s, rad].
        length: of the elements passed [m].
    """
    h = riders.radius[:, None]
    begins = _begin_pieces(ahead, conditions, length, h) & done
    rider, one = np.nonzero(begins)
    two = _last_of_pieces(begins, done)[rider, one]
    kept = time[rider, two + 1] > time[rider, one]
    rider, one, two = rider[kept], one[kept], two[kept]
    whole = time[rider, two + 1] - time[rider, one]
    speed = conditions.passage.speed[rider, one]
    v_x = speed * ahead.start_normal_y[rider, one]
    v_y = -speed * ahead.start_normal_x[rider, one]
    x, y = ahead.start_x[rider, one], ahead.start_y[rider, one]

    def to_join(way: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        return 2.0 * (way - velocity * whole) / whole**2

    ways = _sums(0.0, length)
    way = ways[rider, two + 1] - ways[rider, one]
    rolls = riders.rolls[rider]
    turn = np.where(rolls, 1.0 / riders.radius[rider], 0.0)
    return Pieces(
        trajectory=rider,
        motion=np.where(rolls, MotionMode.rolling, MotionMode.sliding),
        time=time[rider, one],
        duration=whole,
        x=x,
        y=y,
        v_x=v_x,
        v_y=v_y,
        a_x=to_join(ahead.stop_x[rider, two] - x, v_x),
        a_y=to_join(ahead.stop_y[rider, two] - y, v_y),
        orientation=turned[rider, one],
        angular_velocity=turn * speed,
        angular_acceleration=turn * to_join(way, speed),
    )


def _begin_pieces(
    ahead: Ahead, conditions: Conditions, length: np.ndarray, h: np.ndarray
) -> np.ndarray:
    """Tell which elements begin a piece: small ones go on with the piece before, as
    long as they do not turn or lead too far."""
    arc, turn = ~ahead.is_segment, conditions.turn
    longest = np.clip(PIECE_LENGTH * h, 0.5, 2.5)  # [m]
    small = turn < SMALL_PART * PIECE_TURN
    small &= length < SMALL_PART * longest
    begins = np.ones(length.shape, bool)
    begins[:, 1:] = ~(small[:, 1:] & small[:, :-1])
    for amount, most in ((turn, PIECE_TURN), (length, longest)):
        part = np.floor(np.cumsum(amount, axis=1) / most)
        begins[:, 1:] |= part[:, 1:] != part[:, :-1]
    # An arc and the long segment behind it are one piece, where they lie close enough.
    pair = arc[:, :-1] & ~arc[:, 1:] & ~small[:, 1:]
    pair &= turn[:, :-1] * length[:, 1:] < PIECE_TURN * longest
    rows, columns = np.nonzero(pair)
    both = ahead, conditions.passage
    pair[rows, columns] = _keep_speed(
        *select(both, (rows, columns)), *select(both, (rows, columns + 1))
    )
    begins[:, :-1] |= pair
    begins[:, 1:] &= ~pair
    return begins


def _keep_speed(
    one: Ahead, over_one: Passage, two: Ahead, over_two: Passage
) -> np.ndarray:
    """Tell where an element and the next as one piece end at the speed that the block
    has there, nearly: not if a sharp corner between them is passed over, or if a block
    starts from rest on an arc, which accelerates it less than the segment does."""
    moves = (over_one.duration > 0.0) & (over_two.duration > 0.0)
    time = np.where(moves, over_one.duration + over_two.duration, 1.0)
    last = np.where(moves, over_two.duration, 1.0)
    speed = 2.0 * over_two.length / last - over_two.speed
    begun_x = over_one.speed * one.start_normal_y
    begun_y = -over_one.speed * one.start_normal_x
    end_x = 2.0 * (two.stop_x - one.start_x) / time - begun_x
    end_y = 2.0 * (two.stop_y - one.start_y) / time - begun_y
    change = end_x**2 + end_y**2 - speed**2
    return moves & (np.abs(change) <= SPEED_KEPT * speed**2)


def _last_of_pieces(begins: np.ndarray, passed: np.ndarray) -> np.ndarray:
    """Give the place of the last element of the piece that each element belongs to."""
    columns = np.arange(begins.shape[1])
    last = np.count_nonzero(passed, axis=1)[:, None] - 1
    next_begin = np.where(begins, columns, begins.shape[1])
    next_begin = np.minimum.accumulate(next_begin[:, ::-1], axis=1)[:, ::-1]
    behind = np.full(begins.shape, len(columns))
    behind[:, :-1] = next_begin[:, 1:]
    return np.minimum(behind - 1, last)

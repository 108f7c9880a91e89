r"""Path of the centre of a round block that touches the ground.

A circle of radius $h$ on a polyline has its centre on the *offset curve*: parallels of
segments and arcs about points, as far as it comes to them (`element_reach`). It is the
graph of a function, since the ground is one: the highest that the elements allow,

$$ Y(X) = \max_q\left(y_q + \sqrt{h^2 - (X - x_q)^2}\right). $$

Where the circle touches two elements that do not continue each other the path has a
concave corner. So there are no narrow places: what a block cannot touch is not there.

All that is looked up is kept twice, for the profile and for its mirror image, since a
block that moves to the left moves to the right in the mirror. Directions are unit
vectors, not angles: sums, products and roots have the same bits for one block and for
many, in NumPy too.
"""

import dataclasses
import math
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ..backend.simd.tables import address_of, entries
from .blocks import select
from .element_reach import reaches
from .lane_programs import Values, closed_form
from .terrain import Profile, straight_lines

LEFT_BEHIND = 1e-9
"""Distance to the end of an element, as a fraction of the radius, that is rounding."""


class Elements(NamedTuple):
    """Points and segments of the ground, in the order in which blocks that move to the
    right come to them; arrays of any shape."""

    is_segment: np.ndarray
    x: np.ndarray  # the point, or the start of the segment [m]
    y: np.ndarray
    end_x: np.ndarray  # x of the point, or of the end of the segment [m]
    normal_x: np.ndarray  # of the segment, out of the ground; of a point unused
    normal_y: np.ndarray
    length: np.ndarray  # length of the segment [m]; 0 of a point
    behind: np.ndarray
    """Number of the profile's segment behind a point, or of the first of an element's
    segments."""
    ahead: np.ndarray
    """Number of the profile's segment ahead of a point, or of the last of an element's
    segments."""
    shorter: np.ndarray  # of the straight lines beside a point, its length [m]
    on_curve: np.ndarray
    """True of a point of a curve: both points beside it bend the same way, by at least
    half as much."""


class Ahead(NamedTuple):
    """Elements that blocks pass next, arrays `(blocks, elements)`, the first being the
    one that they touch; x is mirrored for blocks that move to the left."""

    element: np.ndarray  # places of the elements in `CentrePath.elements`
    next_element: np.ndarray  # places of those behind them
    exists: np.ndarray  # true where there is one behind, as far as was looked
    start_x: np.ndarray  # centre of the block as it comes to touch the element [m]
    start_y: np.ndarray
    stop_x: np.ndarray  # centre as it comes to touch the next one [m]
    stop_y: np.ndarray
    start_normal_x: np.ndarray  # of the path, from the ground to the centre
    start_normal_y: np.ndarray
    stop_normal_x: np.ndarray
    stop_normal_y: np.ndarray
    next_normal_x: np.ndarray  # of the path behind that place, on the next element
    next_normal_y: np.ndarray
    is_segment: np.ndarray
    is_whole: np.ndarray  # false for a part of an arc about a point


@dataclasses.dataclass(frozen=True)
class CentrePath:
    """Paths of the centres of round blocks over a profile."""

    elements: Elements  # of the profile, and behind them of its mirror image
    reach: np.ndarray  # largest radius of a circle that touches an element [m]
    points: np.ndarray  # x of the points at which the profile or its ground changes [m]
    table: np.ndarray  # what programs read of the elements; see `_Column`

    @classmethod
    def of(
        cls, profile: Profile, radius: float, changes: np.ndarray | None = None
    ) -> "CentrePath":
        """Find the paths over a profile for blocks up to a radius [m].

        Segments on a straight line are one element, but where the ground changes from a
        segment to the next, bool `(segments - 1,)`.
        """
        breaks = np.diff(straight_lines(profile.x, profile.y)) > 0
        if changes is not None:
            breaks |= changes
        inner = np.flatnonzero(breaks) + 1
        points = np.concatenate([[0], inner, [profile.segments]])
        x, y = profile.x[points], profile.y[points]
        reach = reaches(x, y, 1.001 * radius)
        first, last = points[:-1], points[1:] - 1
        forth = _elements(x, y, first, last)
        back = _elements(-x[::-1], y[::-1], last[::-1], first[::-1])
        both = Elements(*map(np.concatenate, zip(forth, back, strict=True)))
        columns = [getattr(both, name).astype(float) for name in _Column._fields]
        return cls(
            both,
            np.concatenate([reach, reach[::-1]]),
            x,
            np.ascontiguousarray(np.stack(columns, axis=1)),
        )

    @property
    def count(self) -> int:
        """Number of elements of the profile."""
        return len(self.reach) // 2

    def mirrored(self, element: np.ndarray) -> np.ndarray:
        """Give the places of the same elements in the mirror."""
        return len(self.reach) - 1 - element

    def last(self, element: np.ndarray) -> np.ndarray:
        """Give the place of the last element in the direction of motion, for blocks on
        some elements."""
        return np.where(element >= self.count, 2, 1) * self.count - 1

    def locate(
        self, x: np.ndarray, radius: np.ndarray, direction: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Find the elements that blocks touch with their centres at x, and the heights
        of the centres [m]. Between two elements it is the one ahead, in the direction
        of 1 to the right or -1 to the left."""
        x = np.clip(x, self.points[0], self.points[-1])
        last = len(self.points) - 1
        first = np.searchsorted(self.points, x - radius) - 1
        past = np.searchsorted(self.points, x + radius, side="right")
        first, past = np.maximum(first, 0), np.minimum(past, last)
        best = np.full(len(x), -np.inf)
        element = np.zeros(len(x), int)
        # Block after block, with few columns where few segments are near.
        width = 2 * (past - first) + 1
        for columns in np.unique(2 ** np.ceil(np.log2(width)).astype(int)):
            chosen = np.flatnonzero((width <= columns) & (2 * width > columns))
            places = 2 * first[chosen, None] + np.arange(columns)
            there = np.minimum(places, 2 * last)
            heights = self._heights(there, x[chosen], radius[chosen])
            right = direction[chosen] > 0.0
            # Of equal heights the one ahead: the last to the right, else the first.
            highest = np.max(heights, axis=1)
            rounding = LEFT_BEHIND * radius[chosen]
            same = heights >= (highest - rounding)[:, None]
            after = columns - 1 - np.argmax(same[:, ::-1], axis=1)
            column = np.where(right, after, np.argmax(same, axis=1))
            element[chosen] = there[np.arange(len(chosen)), column]
            best[chosen] = highest
        return np.where(direction > 0.0, element, self.mirrored(element)), best

    def _heights(
        self, element: np.ndarray, x: np.ndarray, radius: np.ndarray
    ) -> np.ndarray:
        """Compute the heights at which circles would touch elements [m]; -inf where
        they cannot."""
        ground, x, h = select(self.elements, element), x[:, None], radius[:, None]
        apart = h**2 - (x - ground.x) ** 2
        on_point = ground.y + np.sqrt(np.maximum(apart, 0.0))
        foot = x - h * ground.normal_x
        steep = ground.normal_x / np.where(ground.is_segment, ground.normal_y, 1.0)
        on_segment = ground.y - steep * (foot - ground.x) + h * ground.normal_y
        over = (foot >= ground.x) & (foot <= ground.end_x)
        height = np.where(ground.is_segment, on_segment, on_point)
        touches = np.where(ground.is_segment, over, apart >= 0.0)
        touches &= self.reach[element] > h
        return np.where(touches, height, -np.inf)

    def ahead(
        self,
        element: np.ndarray,
        x: np.ndarray,
        y: np.ndarray,
        radius: np.ndarray,
        width: int,
    ) -> Ahead:
        """Find the elements that blocks pass next, and where.

        Args:
            element: places of the elements that they touch, `(blocks,)`.
            x, y: centres [m], x in the mirror for those that move to the left.
            width: number of elements to look at, from 2; those that a block does not
                reach count, too.
        """
        last = self.last(element)
        window = element[:, None] + np.arange(width)
        there = np.minimum(window, last[:, None])
        h = radius[:, None]
        touched = (self.reach[there] > h) & (window <= last[:, None])
        touched[:, 0] = True
        if not np.all(touched):
            order = np.argsort(~touched, axis=1, kind="stable")
            rows = np.arange(len(order))[:, None]
            there, touched = there[rows, order], touched[rows, order]
            keep = max(2, int(np.max(np.count_nonzero(touched, axis=1))))
            there, touched = there[:, :keep], touched[:, :keep]
        one, two = there[:, :-1], there[:, 1:]
        (stop_x, stop_y), stop_normal, next_normal = _meet(
            address_of(self.table), one, two, h
        )
        # A block that stands at the end of its element is not set back.
        past = stop_x[:, 0] < x
        stop_x[:, 0] = np.where(past, x, stop_x[:, 0])
        stop_y[:, 0] = np.where(past, y, stop_y[:, 0])
        first_x, first_y = _normal(address_of(self.table), element, x, y, radius)

        def behind(first: np.ndarray, stops: np.ndarray) -> np.ndarray:
            return np.concatenate([first[:, None], stops[:, :-1]], axis=1)

        return Ahead(
            element=one,
            next_element=two,
            exists=touched[:, 1:],
            start_x=behind(x, stop_x),
            start_y=behind(y, stop_y),
            stop_x=stop_x,
            stop_y=stop_y,
            start_normal_x=behind(first_x, next_normal[0]),
            start_normal_y=behind(first_y, next_normal[1]),
            stop_normal_x=stop_normal[0],
            stop_normal_y=stop_normal[1],
            next_normal_x=next_normal[0],
            next_normal_y=next_normal[1],
            is_segment=self.elements.is_segment[one],
            is_whole=np.ones(one.shape, bool),
        )


LARGEST_TURN = 0.125
"""Turn of an arc up to which it is one piece of a trajectory [rad]."""


def in_small_turns(ahead: Ahead, radius: np.ndarray) -> Ahead:
    """Divide the arcs about points into parts that turn by `LARGEST_TURN` at most."""
    while True:
        longest = 4.0 * radius[:, None] ** 2 * math.sin(0.5 * LARGEST_TURN) ** 2
        chord = (ahead.stop_x - ahead.start_x) ** 2
        chord += (ahead.stop_y - ahead.start_y) ** 2
        halved = ~ahead.is_segment & ahead.exists & (chord > longest)
        if not np.any(halved):
            return ahead
        ahead = _halved(ahead, halved, radius)


def _halved(ahead: Ahead, halved: np.ndarray, radius: np.ndarray) -> Ahead:
    """Divide some elements in two; rows that become shorter than others are filled up
    with what does not exist."""
    place = np.cumsum(1 + halved, axis=1) - 1
    count, width = halved.shape
    rows = np.arange(count)[:, None]
    source = np.full((count, int(np.max(place)) + 1), -1)
    source[rows, place] = np.arange(width)
    block, column = np.nonzero(halved)
    behind = place[block, column]
    source[block, behind - 1] = column
    first = np.zeros(source.shape, bool)
    first[block, behind - 1] = True
    second = np.zeros(source.shape, bool)
    second[block, behind] = True
    filled = source < 0
    source[filled] = width - 1
    parts = select(ahead, (rows, source))
    # Half-way the normal is the mean of those at the ends.
    n_x = parts.start_normal_x + parts.stop_normal_x
    n_y = parts.start_normal_y + parts.stop_normal_y
    size = np.sqrt(n_x**2 + n_y**2)
    size = np.where(size > 0.0, size, 1.0)
    n_x, n_y, h = n_x / size, n_y / size, radius[:, None]
    x = parts.start_x + h * (n_x - parts.start_normal_x)
    y = parts.start_y + h * (n_y - parts.start_normal_y)
    middle = dict(x=x, y=y, normal_x=n_x, normal_y=n_y)

    def with_middle(end: str, where: np.ndarray) -> dict[str, np.ndarray]:
        return {
            f"{end}_{name}": np.where(where, value, getattr(parts, f"{end}_{name}"))
            for name, value in middle.items()
        }

    return parts._replace(
        **with_middle("start", second),
        **with_middle("stop", first),
        next_normal_x=np.where(first, n_x, parts.next_normal_x),
        next_normal_y=np.where(first, n_y, parts.next_normal_y),
        exists=parts.exists & ~filled,
        is_whole=parts.is_whole & ~first & ~second,
    )


def _elements(
    x: np.ndarray, y: np.ndarray, first: np.ndarray, last: np.ndarray
) -> Elements:
    """List the elements of a polyline, given the numbers of the segments of the profile
    that each of its lines begins and ends with."""
    d_x, d_y = np.diff(x), np.diff(y)
    length = np.sqrt(d_x**2 + d_y**2)

    def woven(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
        out = np.empty(len(points) + len(segments), np.result_type(points, segments))
        out[0::2], out[1::2] = points, segments
        return out

    zero = np.zeros(len(x))
    shorter, on_curve = _curves(x, y)
    no_length, nowhere = np.zeros(len(length)), np.zeros(len(length), bool)
    return Elements(
        is_segment=woven(zero > 1.0, length > 0.0),
        x=woven(x, x[:-1]),
        y=woven(y, y[:-1]),
        end_x=woven(x, x[1:]),
        normal_x=woven(zero, -d_y / length),
        normal_y=woven(zero, d_x / length),
        length=woven(zero, length),
        behind=woven(np.concatenate([first[:1], last]), first),
        ahead=woven(np.concatenate([first, last[-1:]]), last),
        shorter=woven(shorter, no_length),
        on_curve=woven(on_curve, nowhere),
    )


def _curves(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Give `Elements.shorter` and `Elements.on_curve` of the points of a polyline."""
    line = straight_lines(x, y)
    breaks = np.flatnonzero(np.diff(line)) + 1
    ends = np.concatenate([[0], breaks, [len(x) - 1]])
    d_x, d_y = np.diff(x[ends]), np.diff(y[ends])
    length = np.sqrt(d_x**2 + d_y**2)
    turn = np.zeros(len(ends))
    turn[1:-1] = d_y[:-1] * d_x[1:] - d_x[:-1] * d_y[1:]
    turn[1:-1] /= length[:-1] * length[1:]
    beside = np.minimum(turn[:-2], turn[2:])
    shorter, on_curve = length[np.append(line, line[-1])], np.zeros(len(x), bool)
    shorter[breaks] = np.minimum(length[1:], length[:-1])
    on_curve[breaks] = (turn[1:-1] > 0.0) & (beside >= 0.5 * turn[1:-1])
    return shorter, on_curve


class _Column(NamedTuple):
    """Element, as a row of `CentrePath.table` says."""

    is_segment: Values
    x: Values
    y: Values
    normal_x: Values
    normal_y: Values
    length: Values

    def normal_at(self, x: Values, y: Values, h: Values) -> tuple[Values, Values]:
        """Give the normal of the path where the centre is at x, y."""
        is_segment = self.is_segment > 0.0
        return (
            jnp.where(is_segment, self.normal_x, (x - self.x) / h),
            jnp.where(is_segment, self.normal_y, (y - self.y) / h),
        )


@closed_form
def _normal(table: Values, element: Values, x: Values, y: Values, h: Values):
    """Compute the normal of the path on an element, as `_meet` does."""
    return _Column(*entries(table, element, len(_Column._fields))).normal_at(x, y, h)


@closed_form
def _meet(table: Values, first: Values, second: Values, h: Values):
    """Compute the circle that touches an element and a later one: its centre, and the
    normals of the path there, on the first and on the second of them."""
    one, two = (
        _Column(*entries(table, row, len(_Column._fields))) for row in (first, second)
    )
    # On a segment, with the other's point, or its start, in the segment's frame: of a
    # point of its own, or of a segment behind a concave break, its end.
    d_x, d_y = two.x - one.x, two.y - one.y
    beside = second - first <= 2.0
    along = jnp.where(beside, one.length, one.normal_y * d_x - one.normal_x * d_y)
    across = jnp.where(beside, 0.0, one.normal_x * d_x + one.normal_y * d_y)
    sin = one.normal_x * two.normal_y - one.normal_y * two.normal_x
    cos = one.normal_x * two.normal_x + one.normal_y * two.normal_y
    to_line = h * sin / (1.0 + cos)
    to_line += jnp.where(beside, 0.0, across * cos / jnp.where(sin > 0.0, sin, 1.0))
    to_point = jnp.sqrt(jnp.maximum(across * (2.0 * h - across), 0.0))
    to_segment = two.is_segment > 0.0
    foot = along - jnp.where(to_segment, to_line, to_point)
    # On a point, with the other's line below it, or another point.
    over = -(two.normal_x * d_x + two.normal_y * d_y)
    over = jnp.where(second - first <= 1.0, 0.0, jnp.clip(over, 0.0, 2.0 * h))
    past = jnp.sqrt(over * (2.0 * h - over))
    apart = jnp.sqrt(d_x**2 + d_y**2)
    apart = jnp.where(apart > 0.0, apart, 1.0)
    rise = jnp.sqrt(jnp.maximum(h**2 - 0.25 * apart**2, 0.0)) / apart
    from_x = jnp.where(
        to_segment,
        (h - over) * two.normal_x + past * two.normal_y,
        0.5 * d_x - rise * d_y,
    )
    from_y = jnp.where(
        to_segment,
        (h - over) * two.normal_y - past * two.normal_x,
        0.5 * d_y + rise * d_x,
    )
    on_segment = one.is_segment > 0.0
    x = one.x + jnp.where(on_segment, foot * one.normal_y + h * one.normal_x, from_x)
    y = one.y + jnp.where(on_segment, h * one.normal_y - foot * one.normal_x, from_y)
    return (x, y), one.normal_at(x, y, h), two.normal_at(x, y, h)

r"""Reach: the largest circle that touches a part of the ground.

A round block touches the ground at a segment, or at a point between two. A circle that
grows while it touches one of these *elements* meets other ground at last, on both
sides; its radius then is the element's reach. A larger circle never comes to the
element, in places narrower than itself, and a smaller one does: what grows into a
circle has touched all that the circle touches. So the elements with a reach above $h$,
in their order, are all the ground that a circle of radius $h$ can touch.

**How it is found.** Circles grow from 0. Each element has a range in which they touch
it, between those of its neighbours in the list. Where the range ends, the element
leaves the list, and its neighbours become neighbours of each other; the smallest
radius comes first. A circle of radius h on a segment, with its foot at s, also touches
a point at (a, b) from the segment's left end, along and across, or the line of a
segment through it that turns up by $\delta$, where

$$ s = a - \sqrt{2 h b - b^2}, \qquad
   s = a - b/\tan\delta - h\tan(\delta/2), $$

and one on a point, with its centre at an angle $\alpha$ from the upright, touches a
point at a distance d in the direction $\beta$, or a line of slope w that lies o below
it, where

$$ \alpha = \beta - \arccos\frac{d}{2h}, \qquad
   \alpha = w + \arccos\left(1 - \frac{o}{h}\right). $$

These are for ground to the right; for that to the left all is mirrored.
"""

import heapq
import math

import numpy as np

from . import libm


def reaches(x: np.ndarray, y: np.ndarray, largest: float) -> np.ndarray:
    """Compute the reach of each element of a polyline [m]: point, segment, point and so
    on, `(2 points - 1,)`; 0 for a point in a concave break, which no circle touches,
    and inf beyond the largest radius that is of interest [m]."""
    ground = _Elements(x, y)
    count = 2 * len(x) - 1
    reach = np.full(count, np.inf)
    concave = np.flatnonzero(np.diff(ground.slopes) < 0.0) + 1
    reach[2 * concave] = 0.0
    listed = np.flatnonzero(reach > 0.0)
    before = np.full(count, -1)
    after = np.full(count, -1)
    before[listed[1:]], after[listed[:-1]] = listed[:-1], listed[1:]
    before, after = before.tolist(), after.tolist()
    due: list[tuple[float, int, int, int]] = []

    def watch(element: int, radius: float) -> None:
        left, right = before[element], after[element]
        if left >= 0 and right >= 0:
            ends = ground.radius_at_end(element, left, right, radius, largest)
            if ends < largest:
                heapq.heappush(due, (ends, element, left, right))

    for element in listed.tolist():
        watch(element, 0.0)
    gone = [False] * count
    while due:
        radius, element, left, right = heapq.heappop(due)
        if gone[element] or (before[element], after[element]) != (left, right):
            continue
        gone[element] = True
        reach[element] = radius
        after[left], before[right] = right, left
        watch(left, radius)
        watch(right, radius)
    return reach


class _Elements:
    """Points and segments of a polyline, as plain numbers: they are looked at one by
    one."""

    def __init__(self, x: np.ndarray, y: np.ndarray):
        self.slopes = -libm.arctan2(np.diff(y), np.diff(x))
        self.x, self.y = x.tolist(), y.tolist()
        self.slope = self.slopes.tolist()
        self.sin = libm.sin(self.slopes).tolist()
        self.cos = libm.cos(self.slopes).tolist()
        self.length = np.hypot(np.diff(x), np.diff(y)).tolist()

    def radius_at_end(
        self, element: int, left: int, right: int, radius: float, largest: float
    ) -> float:
        """Find the radius at which the range of an element between two others ends, up
        to the largest."""

        def left_over(h: float) -> float:
            return self.meets(element, right, h, 1) - self.meets(element, left, h, -1)

        at_largest = left_over(largest)
        if at_largest > 0.0:
            return math.inf
        # Regula falsi with Illinois' halving: the range shrinks as circles grow.
        low, high = radius, largest
        at_low, at_high = (left_over(low) if low > 0.0 else 1.0), at_largest
        if at_low <= 0.0:
            return low
        side = 0
        for _ in range(100):  # some ten are usual
            if high - low <= 1e-14 * high:
                break
            middle = (low * at_high - high * at_low) / (at_high - at_low)
            if not low < middle < high:
                middle = 0.5 * (low + high)
            here = left_over(middle)
            if here > 0.0:
                low, at_low = middle, here
                at_high *= 0.5 if side == 1 else 1.0
                side = 1
            else:
                high, at_high = middle, here
                at_low *= 0.5 if side == -1 else 1.0
                side = -1
        return high

    def meets(self, element: int, other: int, h: float, side: int) -> float:
        """Compute where a circle on an element also touches another, to its right
        (side 1) or left (-1): its foot on a segment [m], its angle on a point [rad]."""
        if element % 2:
            return self._from_segment(element // 2, other, h, side)
        return self._from_point(element // 2, other, h, side)

    def _from_segment(self, segment: int, other: int, h: float, side: int) -> float:
        own_end = 2 * segment + 1 + side
        if other == own_end:
            return self.length[segment] if side > 0 else 0.0
        sin, cos = self.sin[segment], self.cos[segment]
        # Of another segment, the end that is nearer.
        point = other // 2 if other % 2 == 0 else (other - side) // 2
        if other - own_end == side:
            along, across = (self.length[segment] if side > 0 else 0.0), 0.0
        else:
            d_x = self.x[point] - self.x[segment]
            d_y = self.y[point] - self.y[segment]
            along, across = cos * d_x - sin * d_y, sin * d_x + cos * d_y
        if other % 2 == 0:
            if across <= 0.0:
                return side * math.inf
            return along - side * math.sqrt(max(2.0 * h * across - across**2, 0.0))
        turn = side * (self.slope[segment] - self.slope[other // 2])
        if turn <= 0.0:
            return side * math.inf
        back = h * math.tan(0.5 * turn)
        if across != 0.0:
            back += across / math.tan(turn)
        return along - side * back

    def _from_point(self, point: int, other: int, h: float, side: int) -> float:
        if other % 2:
            segment = other // 2
            slope = self.slope[segment]
            if abs(other - 2 * point) == 1:
                return slope
            d_x, d_y = self.x[point] - self.x[segment], self.y[point] - self.y[segment]
            over = self.sin[segment] * d_x + self.cos[segment] * d_y
            return slope + side * math.acos(min(max(1.0 - over / h, -1.0), 1.0))
        d_x = self.x[other // 2] - self.x[point]
        d_y = self.y[other // 2] - self.y[point]
        apart = math.hypot(d_x, d_y)
        towards = math.atan2(d_x, d_y)
        return towards - side * math.acos(min(0.5 * apart / h, 1.0))

r"""Smoothing of measured profiles, which takes out the noise of their heights.

The height at a point becomes that of a parabola through the points about it, fitted by
least squares with the weights

$$ w_j = \exp\left(-\frac{(x_j - x_i)^2}{2 s^2}\right) $$

(local quadratic regression), where s is the length of the smoothing. It is exact for
straight lines and parabolas, up to the ends and whatever the spacing of the points, so
that crests and troughs much longer than s keep their heights; a moving average, or a
local line, would flatten them. Points that are much farther apart than s keep their
heights, as nothing tells their noise from the ground.
"""

import math
from typing import NamedTuple

import numpy as np

from .._checks import real_number
from ..errors import InputError
from ..io.checks import warn_unusual
from . import libm

REACH = 4.0
"""Distance over the length of a smoothing within which points count: farther ones have
weights below 3e-4."""
MANY = 300.0
"""Mean number of points within reach on a side from which on their sums are taken in
boxes; 30 000 points with fewer take a second one by one."""
BOX, TERMS = 0.5, 20
"""Width of a box over the length, and terms of the series in a b, which is 1.06 at
most: what is left out is below 1e-18."""


class Smoothing(NamedTuple):
    """What a smoothing did to the heights of a profile."""

    smooth_m: float
    """Standard deviation of the weights along x [m]."""
    largest_move_m: float
    """Largest change of a height [m]."""
    rms_move_m: float
    """Root mean square of the changes of the heights [m]."""

    @classmethod
    def between(cls, length: float, before: np.ndarray, after: np.ndarray):
        """Compare heights [m] before and after a smoothing."""
        moves = np.abs(after - before)
        return cls(length, float(np.max(moves)), float(np.sqrt(np.mean(moves**2))))

    def __str__(self) -> str:
        return (
            f"smoothed over {self.smooth_m:g} m, which moves heights by up to "
            f"{self.largest_move_m:.3g} m, {self.rms_move_m:.3g} m rms"
        )


def smooth_heights(x: np.ndarray, y: np.ndarray, length: float) -> np.ndarray:
    """Smooth the heights of a profile's points [m], x increasing, with weights of a
    standard deviation of `length` along x [m].

    Raises InputError for a length that is not above 0, or too large for the profile.
    Warns of a length that is smaller than the distances of the points, and of heights
    that change by more than 0.5 m.
    """
    length = real_number("the length of a smoothing", length)
    whole = float(x[-1] - x[0])
    if not 0.0 < length <= 0.1 * whole:
        raise InputError(
            f"the length of a smoothing must be above 0 and at most a tenth of the "
            f"profile's {whole:g} m, but is {length:g} m"
        )
    smooth = y + _moves(x, y, length)
    spacing, moved = float(np.median(np.diff(x))), np.abs(smooth - y)
    if spacing > length:
        warn_unusual(
            f"a smoothing over {length:g} m leaves most of the noise of points that "
            f"are {spacing:.3g} m apart; choose smooth_m several times as long",
            "smooth_m",
        )
    if np.max(moved) > 0.5:  # noise is smaller, walls are larger
        i = int(np.argmax(moved))
        warn_unusual(
            f"a smoothing over {length:g} m moves the profile by {moved[i]:.3g} m at "
            f"x = {x[i]:.10g} m: it rounds off walls and steps, which a shorter length "
            "keeps",
            "smooth_m",
        )
    return smooth


def _moves(x: np.ndarray, y: np.ndarray, length: float) -> np.ndarray:
    """Compute the changes of the heights [m]."""
    after = _points_after(x, length)
    summed = _summed_one_by_one if np.mean(after) < MANY else _summed_in_boxes
    powers, heights = summed(x, y, length, after)
    equations = np.moveaxis(powers[np.add.outer(np.arange(3), np.arange(3))], -1, 0)
    # Where too few points are near, the parabola of the smallest coefficients.
    inverse = np.linalg.pinv(equations, rcond=1e-10, hermitian=True)
    # The polynomial's value at the point itself.
    return np.einsum("pi,ip->p", inverse[:, 0], heights)


def _points_after(x: np.ndarray, length: float) -> np.ndarray:
    """Count the points after each one that are within reach of it."""
    last = np.searchsorted(x, x + REACH * length, side="right") - 1
    # Of points at the very reach rounding decides: by the distance, as elsewhere.
    last -= (x[last] - x) / length > REACH
    further = np.minimum(last + 1, len(x) - 1)
    last = np.where((x[further] - x) / length <= REACH, further, last)
    return last - np.arange(len(x))


def _summed_one_by_one(
    x: np.ndarray, y: np.ndarray, length: float, after: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sum the weights of the points about each one, times powers of their distances u
    over `length`: alone for u^0 to u^4, shape (5, points), and times their heights over
    that of the point for u^0 to u^2, shape (3, points)."""
    powers = np.zeros((5, len(x)))
    heights = np.zeros((3, len(x)))
    most = np.max(after)
    for offset in range(-most, most + 1):
        first = np.flatnonzero(after >= abs(offset))
        at = first + max(0, -offset)
        u = (x[at + offset] - x[at]) / length
        term = libm.exp(-0.5 * u**2)
        # Relative to the point's own height, which may be of thousands of metres.
        rise = y[at + offset] - y[at]
        for power in range(5):
            powers[power, at] += term
            if power < 3:
                heights[power, at] += term * rise
            term = term * u
    return powers, heights


def _summed_in_boxes(
    x: np.ndarray, y: np.ndarray, length: float, after: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the sums of `_summed_one_by_one`, but for rounding, in a time that grows
    as the number of points alone.

    With distances a of a point and b of another one from the middle of a box, over
    `length`, the weight is exp(-a^2/2) exp(-b^2/2) sum((a b)^k / k!) (Greengard and
    Strain 1991): sums over b are the same for all points in the box, but for where they
    begin and end.
    """
    powers = np.zeros((5, len(x)))
    heights = np.zeros((3, len(x)))
    ends = np.arange(len(x)) + after + 1
    begins = np.searchsorted(ends, np.arange(len(x)), side="right")
    start = 0
    while start < len(x):
        middle = x[start] + 0.5 * BOX * length
        stop = int(np.searchsorted(x, x[start] + BOX * length, side="right"))
        box, others = slice(start, stop), slice(begins[start], ends[stop - 1])
        a, b = (x[box] - middle) / length, (x[others] - middle) / length
        window = begins[box] - others.start, ends[box] - others.start
        rise = y[others] - y[start]
        weight, share = libm.exp(-0.5 * b**2), libm.exp(-0.5 * a**2)
        alone, times_rise = [], []
        for _ in range(TERMS + 4):
            alone.append(_sums_between(*window, weight))
            times_rise.append(_sums_between(*window, weight * rise))
            weight = weight * b
        # Sums of the weights times b^q.
        of_b, rises = np.zeros((5, len(a))), np.zeros((3, len(a)))
        for k in range(TERMS):
            of_b += share * alone[k : k + 5]
            rises += share * times_rise[k : k + 3]
            share = share * a / (k + 1)
        rises -= (y[box] - y[start]) * of_b[:3]
        powers[:, box], heights[:, box] = _about(a, of_b), _about(a, rises)
        start = stop
    return powers, heights


def _sums_between(
    begins: np.ndarray, ends: np.ndarray, values: np.ndarray
) -> np.ndarray:
    """Sum the values from each of the first indices to before the second."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return sums[ends] - sums[begins]


def _about(a: np.ndarray, of_b: np.ndarray) -> np.ndarray:
    """Make sums of terms times b^q, shape (q, points), those of terms times
    (b - a)^q."""
    rows = []
    for power in range(len(of_b)):
        parts = (math.comb(power, q) * (-a) ** (power - q) for q in range(power + 1))
        rows.append(sum(part * row for part, row in zip(parts, of_b, strict=False)))
    return np.array(rows)

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

from typing import NamedTuple

import numpy as np

from .._checks import real_number
from ..errors import InputError
from ..io.checks import warn_unusual
from . import libm


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
    # Farther points than four lengths have weights below 3e-4.
    reach, count = 4.0, np.arange(len(x))
    within = np.searchsorted(x, x + reach * length, side="right") - 1 - count
    # Sums over the points about each one of the powers of their distances.
    powers = np.zeros((5, len(x)))
    heights = np.zeros((3, len(x)))
    for offset in range(-np.max(within), np.max(within) + 1):
        at = count[max(0, -offset) : len(x) - max(0, offset)]
        u = (x[at + offset] - x[at]) / length
        term = np.where(np.abs(u) <= reach, libm.exp(-0.5 * u**2), 0.0)
        # Relative to the point's own height, which may be of thousands of metres.
        rise = y[at + offset] - y[at]
        for power in range(5):
            powers[power, at] += term
            if power < 3:
                heights[power, at] += term * rise
            term = term * u
    equations = np.moveaxis(powers[np.add.outer(np.arange(3), np.arange(3))], -1, 0)
    # Where too few points are near, the parabola of the smallest coefficients.
    inverse = np.linalg.pinv(equations, rcond=1e-10, hermitian=True)
    # The polynomial's value at the point itself.
    return np.einsum("pi,ip->p", inverse[:, 0], heights)

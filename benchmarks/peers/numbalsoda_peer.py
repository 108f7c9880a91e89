"""numbalsoda: LSODA in C++ on the compiled right-hand side, free of Python, on threads.

It cannot stop at an event, so an impact is integrated window by window and cut at the
first point of a grid beyond the end. The points come from LSODA's own interpolant and
cost next to nothing; between two of them the end is found on a cubic.
"""

import functools
import math

import numpy as np
from numba import carray, cfunc, njit
from numbalsoda import lsoda, lsoda_sig

from ..impacts import Answer
from . import model
from .shared import Compiled, solve_on_threads

WINDOW = 1.3
"""Length of a window, in times of R over the sum of the impact speed and the speed of
a fall from R/2, which is what slow blocks come to. Longer ones waste steps
beyond the end, shorter ones restart LSODA more often."""
POINTS = 48
"""Points of a window at tolerances of 1e-4 and more; the error of the cubic goes with
the fourth power of their distance."""
FLOOR = 1e-2
"""Absolute over relative tolerance, for unknowns scaled to one."""


@functools.cache
def _right_hand_side() -> int:
    """Address of the compiled right-hand side."""

    @cfunc(lsoda_sig, cache=True)
    def right_hand_side(t, y, dy, p):
        model.rates(
            carray(y, (model.STATES,)),
            carray(p, (model.PARAMETERS,)),
            carray(dy, (model.STATES,)),
        )

    return right_hand_side.address


@njit(nogil=True, error_model="numpy")
def _integrate(address, start, p, tolerance, floor, window, points, first, last, e_n):
    """Fill `e_n` from `first` to `last`; NaN where the integration failed."""
    a, b = np.empty(model.STATES), np.empty(model.STATES)
    y = np.empty(model.STATES)
    for i in range(first, last):
        begin, state = 0.0, start[i].copy()
        fall = math.sqrt(model.GRAVITY * p[i, model.R])
        full = window * p[i, model.R] / (p[i, model.SPEED] + fall)
        width = full
        e_n[i] = math.nan
        while begin < model.TIME_LIMIT:
            end = min(begin + width, model.TIME_LIMIT)
            times = np.linspace(begin, end, points)
            course, success = lsoda(
                address, state, times, p[i], tolerance, tolerance * floor, 20_000
            )
            if not success or not np.all(np.isfinite(course)):
                # It may have failed beyond the end: come nearer first.
                width *= 0.25
                if width < 1e-3 * full:
                    break
                continue
            beyond = 0
            for j in range(1, points):
                if model.margin(course[j], p[i]) <= 0.0:
                    beyond = j
                    break
            if beyond:
                before, after = course[beyond - 1], course[beyond]
                h = times[beyond] - times[beyond - 1]
                model.rates(before, p[i], a)
                model.rates(after, p[i], b)
                low, high = 0.0, 1.0
                for _ in range(40):
                    s = 0.5 * (low + high)
                    for k in range(model.STATES):
                        y[k] = (
                            (1.0 + 2.0 * s) * (1.0 - s) ** 2 * before[k]
                            + s * (1.0 - s) ** 2 * h * a[k]
                            + s * s * (3.0 - 2.0 * s) * after[k]
                            + s * s * (s - 1.0) * h * b[k]
                        )
                    if model.margin(y, p[i]) > 0.0:
                        low = s
                    else:
                        high = s
                e_n[i] = -y[2] / start[i, 2]
                break
            begin, state = end, course[points - 1].copy()
            if begin >= model.TIME_LIMIT:
                e_n[i] = -state[2] / start[i, 2]


class Numbalsoda(Compiled):
    """LSODA of numbalsoda."""

    name = "numbalsoda LSODA"
    family = "numbalsoda"
    tolerances = (1e-2, 3e-3, 2e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8)

    def solve(self, scenes, tolerance: float, batch: bool) -> Answer:
        """Impacts on every core at once, or one after another on one."""
        p, start = model.parameters_and_start(scenes, self.slider_time)
        points = math.ceil(POINTS * max(1.0, (1e-4 / tolerance) ** 0.25))
        setting = tolerance, FLOOR, WINDOW, points
        integrate = functools.partial(
            _integrate, _right_hand_side(), start, p, *setting
        )
        return solve_on_threads(integrate, p, start, batch)


def methods() -> list[Numbalsoda]:
    """What this module brings."""
    return [Numbalsoda()]

"""The classical Runge-Kutta method of order 4, compiled, on threads.

Its step is fixed but for the onset, where the foundation is small and rates are a
thousand times higher: there the step grows in proportion to time.
"""

import functools
import math

import numpy as np

from ..impacts import Answer
from . import model
from .shared import Compiled, solve_on_threads

ONSET = 1.5e-4
"""Largest step at the onset, as a part of the time since touch: the fastest rate times
that time is 5000 there."""
MOST_STEPS = 5_000_000


@model.compiled
def _integrate(start, p, largest, first, last, e_n):
    """Fill `e_n` from `first` to `last`; NaN where a state was not finite, or
    steps ran out."""
    stages = np.empty((4, model.STATES))
    probe = np.empty(model.STATES)
    for i in range(first, last):
        y = start[i].copy()
        after = np.empty(model.STATES)
        time, left = 0.0, model.margin(y, p[i])
        e_n[i] = math.nan
        touch = 1e-6 * p[i, model.R] / p[i, model.SPEED]
        for _ in range(MOST_STEPS):
            step = min(largest, ONSET * (touch + time))
            for stage in range(4):
                part = (0.0, 0.5, 0.5, 1.0)[stage] * step
                for k in range(model.STATES):
                    slope = stages[stage - 1, k] if stage else 0.0
                    probe[k] = y[k] + part * slope
                model.rates(probe, p[i], stages[stage])
            total = 0.0
            for k in range(model.STATES):
                after[k] = y[k] + step / 6.0 * (
                    stages[0, k]
                    + 2.0 * stages[1, k]
                    + 2.0 * stages[2, k]
                    + stages[3, k]
                )
                total += after[k]
            if not math.isfinite(total):
                break
            now = model.margin(after, p[i])
            time += step
            if now <= 0.0 or time >= model.TIME_LIMIT:
                part = left / (left - now) if now < 0.0 else 1.0
                e_n[i] = -(y[2] + part * (after[2] - y[2])) / start[i, 2]
                break
            y, after, left = after, y, now


class FixedStep(Compiled):
    """Runge-Kutta of order 4; its "tolerance" is the largest step [s]."""

    name = "RK4, fixed step"
    family = "explicit"
    tolerances = (2.5e-6, 1e-6)

    def solve(self, scenes, tolerance: float, batch: bool) -> Answer:
        """Impacts on every core at once, or one after another on one."""
        p, start = model.parameters_and_start(scenes, self.slider_time)
        integrate = functools.partial(_integrate, start, p, tolerance)
        return solve_on_threads(integrate, p, start, batch)


def methods() -> list[FixedStep]:
    """What this module brings."""
    return [FixedStep()]

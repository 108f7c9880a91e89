"""CVODE of SUNDIALS, through scikit-sundae, on compiled callbacks."""

import math

import numpy as np
from sksundae.cvode import CVODE

from ..impacts import Answer
from . import model
from .shared import Compiled, solve_scenes

FLOOR = 1e-4
"""Absolute over relative tolerance, for unknowns scaled to one. With more it takes the
errors of small loads at the onset for the end of the impact."""
_WORK = np.empty((3, model.STATES))


# scikit-sundae asks for the truth of `userdata`, which an array has not.
def _rates(t, y, dy, data):
    model.rates(y, data[0], dy)


def _jacobian(t, y, dy, matrix, data):
    model.jacobian(y, data[0], matrix, _WORK)


def _end(t, y, events, data):
    events[0] = model.margin(y, data[0])


_end.terminal, _end.direction = [True], [-1]


def _integrate(p, start, tolerance):
    solver = CVODE(
        _rates,
        userdata=(p,),
        method="BDF",
        rtol=tolerance,
        atol=FLOOR * tolerance,
        jacfn=_jacobian,
        eventsfn=_end,
        num_events=1,
        max_num_steps=100_000,
        first_step=1e-8 * p[model.R] / p[model.SPEED],
    )
    solution = solver.solve([0.0, model.TIME_LIMIT], start)
    if not solution.success:
        return math.nan
    return -solution.y[-1][2] / start[2]


class Cvode(Compiled):
    """Backward differentiation formulas of order 1 to 5."""

    name = "CVODE BDF"
    family = "CVODE"
    tolerances = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)

    def solve(self, scenes, tolerance: float, batch: bool) -> Answer:
        """Impacts in as many processes as cores, or one after another here."""
        p, start = model.parameters_and_start(scenes, self.slider_time)
        return solve_scenes(_integrate, p, start, tolerance, batch)


def methods() -> list[Cvode]:
    """What this module brings."""
    return [Cvode()]

"""SciPy's implicit solvers on the compiled right-hand side and Jacobian."""

import math
import warnings

import numpy as np
from scipy.integrate import solve_ivp

from ..impacts import Answer
from . import model
from .shared import Compiled, solve_scenes

FLOOR = 1e-2
"""Absolute over relative tolerance, for unknowns scaled to one."""
MOST_EVALUATIONS = 50_000
"""Evaluations of the right-hand side after which an impact is given up."""


def _integrate(p, start, tolerance, method):
    dy = np.empty(model.STATES)
    matrix = np.empty((model.STATES, model.STATES))
    work = np.empty((3, model.STATES))

    evaluations = 0

    def rates(t, y):
        nonlocal evaluations
        evaluations += 1
        if evaluations > MOST_EVALUATIONS:
            raise FloatingPointError
        model.rates(y, p, dy)
        return dy.copy()

    def jacobian(t, y, *_):
        model.jacobian(y, p, matrix, work)
        return matrix.copy()

    def end(t, y):
        return model.margin(y, p)

    end.terminal, end.direction = True, -1
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            solution = solve_ivp(
                rates,
                (0.0, model.TIME_LIMIT),
                start,
                method=method,
                jac=jacobian,
                rtol=tolerance,
                atol=FLOOR * tolerance,
                events=end,
                # A hundredth of the time in which the block sinks as deep as it starts
                first_step=1e-8 * p[model.R] / p[model.SPEED],
            )
        # Given up, or a matrix that is not finite in LAPACK
        except (ValueError, FloatingPointError):
            return math.nan
    if solution.status < 0:
        return math.nan
    y = solution.y_events[0][0] if solution.status == 1 else solution.y[:, -1]
    return -y[2] / start[2]


class Scipy(Compiled):
    """A method of `solve_ivp`."""

    family = "SciPy"

    def __init__(self, method: str, tolerances: tuple[float, ...]):
        self.method, self.tolerances = method, tolerances
        self.name = f"SciPy {method}"

    def solve(self, scenes, tolerance: float, batch: bool) -> Answer:
        """Impacts in as many processes as cores, or one after another here."""
        p, start = model.parameters_and_start(scenes, self.slider_time)
        return solve_scenes(_integrate, p, start, tolerance, batch, method=self.method)


def methods() -> list[Scipy]:
    """What this module brings."""
    return [
        # With coarser ones Newton's iteration fails so often that it costs more.
        Scipy("Radau", (3e-4, 1e-4, 1e-6)),
        Scipy("BDF", (1e-2, 1e-3, 1e-4, 1e-6)),
        Scipy("LSODA", (1e-2, 1e-3, 1e-4, 1e-6)),
    ]

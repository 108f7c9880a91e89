"""Fits by SciPy's trust-region method between bounds, one after the other."""

import enum
from collections.abc import Callable
from itertools import chain
from typing import NamedTuple

import numpy as np

from ...progress import tell
from ..problem.objective import Objective, Points

INSIDE = 1e-9
"""Distance from the bounds, as a fraction of the range, at which a fit starts: the
method needs interior points."""
NEAR_ZERO = 1e-4
"""Norm of the unknowns below which a fit starts at 0: the method's first trust region
is as large as that norm, and of size 1 at 0 itself. Of a region of 1e-11 it would take
the first step for the last."""
ROUNDING = 1e-12
"""Eigenvalue of a Hessian, over its largest, below which a direction changes no cost
that double precision could tell."""


class Reason(enum.Enum):
    """Reason for which a fit stopped: its words, and whether it is at a minimum."""

    converged = "converged: no step promises a lower cost", True
    flat = "converged: the cost no longer falls", True
    edge = "converged: at a jump of a prediction, no lower cost about it", True
    stuck = "stuck at a discontinuity: the outcome of an impact changes", False
    above = "in a local minimum above the best fit", False
    step_limit = "limit of steps reached", False
    failed = "failed: an impact could not be computed", False

    def __str__(self) -> str:
        return self.value[0]

    @property
    def at_minimum(self) -> bool:
        """Whether the fit ended at a minimum."""
        return self.value[1]


class Tolerance(NamedTuple):
    """Where a fit may end.

    The distance to the minimum is measured by the fall of the cost that a Gauss-Newton
    step promises: half the square of the distance in standard errors, times s^2 where
    the sigmas are not known.
    """

    promise: float
    """Promised fall, over max(1, s^2), at which a fit is at a minimum."""
    step: float
    """Change of the unknowns, over their size, below which no more steps are tried."""
    evaluations: int
    """Largest number of points at which the cost is computed."""


ROUGH = Tolerance(1e-2, 1e-3, 30)
"""For ranking and for profiles: about a tenth of a standard error."""
FINE = Tolerance(1e-4, 1e-7, 80)
"""Of the reported fit: a hundredth of a standard error. It is mostly far closer; where
it is not, the errors of integration hide the rest."""
FLAT = 1e-2
"""Promised fall, over max(1, s^2), at which a fit whose cost no longer falls is at a
minimum: beside a jump more is promised."""
ENOUGH = 1e-2
"""Part of the promise of a tolerance at which a fit ends at once."""


class Fits(NamedTuple):
    """Ends of fits, one a lane."""

    points: Points
    reasons: list[Reason]
    steps: np.ndarray
    """Number of points at which the cost of each was computed."""

    @property
    def best(self) -> int:
        """Lane of the least cost."""
        return int(np.argmin(self.points.cost))

    def take(self, lanes: list[int]) -> "Fits":
        """Select some of the fits."""
        reasons = [self.reasons[lane] for lane in lanes]
        return Fits(self.points.take(lanes), reasons, self.steps[lanes])


def fit(
    objective: Objective,
    x: np.ndarray,
    free: np.ndarray | None = None,
    *,
    tolerance: Tolerance = FINE,
) -> Fits:
    """Fit from every x, shape (lanes, unknowns).

    Args:
        free: mask of the unknowns that are fitted, the same shape; None for all.
        tolerance: where fits may end.
    """
    x = np.clip(x, objective.bounds.low, objective.bounds.high)
    free = np.ones(x.shape, bool) if free is None else free
    ends = []
    for lane, (start, moving) in enumerate(zip(x, free, strict=True)):
        ends.append(_fit_one(objective, start, moving, tolerance))
        lowest = min(float(end.points.cost[0]) for end in ends)
        tell(f"fit {lane + 1} of {len(x)}, lowest cost {lowest:.6g}")
    points, reasons, steps = zip(*ends, strict=True)
    parts = (np.concatenate(part) for part in zip(*points, strict=True))
    return Fits(Points(*parts), [*chain(*reasons)], np.concatenate(steps))


def _fit_one(
    objective: Objective, start: np.ndarray, free: np.ndarray, tolerance: Tolerance
) -> Fits:
    # SciPy's optimisers take their time to import.
    from scipy.optimize import least_squares as trust_region

    points = objective(start[None])
    steps, is_flat = 1, False
    promise = _promise(objective, points, free)
    if np.any(free) and promise > ENOUGH * tolerance.promise:
        bounds = objective.bounds
        low, high = bounds.low[free], bounds.high[free]
        at = _Evaluations(objective, points, free)
        room, begin = INSIDE * (high - low), start[free]
        if np.linalg.norm(begin) < NEAR_ZERO:
            begin = np.zeros_like(begin)
        # Beside a jump derivatives may be so steep that the method overflows.
        with np.errstate(all="ignore"):
            solution = trust_region(
                at.residuals,
                np.clip(begin, low + room, high - room),
                jac=at.jacobian,  # pyright: ignore[reportArgumentType]
                bounds=(low, high),
                ftol=_least_fall(objective, tolerance),
                xtol=tolerance.step,
                gtol=None,  # pyright: ignore[reportArgumentType]
                max_nfev=tolerance.evaluations,
            )
        # The method stays off the bounds that it approaches.
        x = np.where(solution.active_mask < 0, low, solution.x)
        x = np.where(solution.active_mask > 0, high, x)
        inner, end = at(solution.x), at(x)
        least = ENOUGH * tolerance.promise * float(objective.unit(inner.cost[0]))
        end = end if end.cost[0] <= inner.cost[0] + least else inner
        # A start at a bound is lower than what is inside where nothing moves it.
        points = end if end.cost[0] < points.cost[0] else points
        steps += solution.nfev
        is_flat = solution.status in (2, 4)
        promise = _promise(objective, points, free)
    reason = Reason.stuck
    if promise <= tolerance.promise:
        reason = Reason.converged
    elif np.any(objective.failed(points.predicted)):
        reason = Reason.failed
    elif is_flat and promise <= FLAT:
        reason = Reason.flat
    elif steps > tolerance.evaluations:
        reason = Reason.step_limit
    return Fits(points, [reason], np.array([steps]))


def _least_fall(objective: Objective, tolerance: Tolerance) -> float:
    """Compute the relative fall of the cost that ends a fit: the part of s^2 that is
    enough, over the cost that has this s^2."""
    return max(ENOUGH * tolerance.promise * float(objective.variance(1.0)), 1e-12)


def _promise(objective: Objective, points: Points, free: np.ndarray) -> float:
    """Compute the fall of the cost that a bounded Gauss-Newton step promises, over
    max(1, s^2)."""
    _, fall = bounded_step(objective, points, free)
    return fall / float(objective.unit(points.cost[0]))


class _Evaluations:
    """Residuals and Jacobian of one fit in its free unknowns, each point computed once.

    Args:
        points: start, of one lane, with derivatives.
        free: mask of the free unknowns, shape (unknowns,).
    """

    def __init__(self, objective: Objective, points: Points, free: np.ndarray):
        self.objective, self.start, self.free = objective, points.x[0], free
        self.last = points
        self.derived = True

    def _at(self, x: np.ndarray, derived: bool) -> Points:
        full = self.start.copy()
        full[self.free] = x
        known = np.array_equal(self.last.x[0], full)
        if not known or (derived and not self.derived):
            evaluate: Callable = self.objective if derived else self.objective.values
            self.last, self.derived = evaluate(full[None]), derived
        return self.last

    def __call__(self, x: np.ndarray) -> Points:
        """Compute a point with its derivatives."""
        return self._at(x, True)

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """Compute residuals of which half the sum of squares is the cost."""
        return self.objective.residuals(self._at(x, False))[0]

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Compute the derivatives of the residuals."""
        return self.objective.residuals(self._at(x, True))[1][:, self.free]


def bounded_step(
    objective: Objective, points: Points, free: np.ndarray | None = None
) -> tuple[np.ndarray, float]:
    """Compute the Gauss-Newton step between the bounds from points of one lane, shape
    (unknowns,), and the fall of the cost that it promises.

    Args:
        free: mask of the unknowns that may change; None for all.
    """
    from scipy.optimize import lsq_linear

    gradient, hessian = points.gradient[0], points.hessian[0]
    bounds, x = objective.bounds, points.x[0]
    free = np.ones(len(x), bool) if free is None else free
    free = free & (bounds.low < bounds.high)
    step = np.zeros(len(x))
    if not np.any(free) or not np.any(gradient[free]):
        return step, 0.0
    # Unknowns of very different influence keep their digits beside each other.
    diagonal = np.diag(hessian)[free]
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = hessian[np.ix_(free, free)] / (scale[:, None] * scale)
    values, vectors = np.linalg.eigh(scaled)
    kept = values > ROUNDING * max(values[-1], ROUNDING)
    if not np.any(kept):
        return step, 0.0
    root = np.sqrt(values[kept])
    rows = root[:, None] * vectors[:, kept].T
    right = -(vectors[:, kept].T @ (gradient[free] / scale)) / root
    room = [(end[free] - x[free]) * scale for end in (bounds.low, bounds.high)]
    # Where a bound is reached there is no room on one side; the solver wants some.
    low, high = np.minimum(room[0], -1e-300), np.maximum(room[1], 1e-300)
    solution = lsq_linear(rows, right, (low, high), method="bvls")
    step[free] = np.clip(
        solution.x / scale, (bounds.low - x)[free], (bounds.high - x)[free]
    )
    fall = -(gradient @ step + 0.5 * step @ hessian @ step)
    return step, max(float(fall), 0.0)

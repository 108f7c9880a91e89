"""The Levenberg-Marquardt method between bounds, for many fits side by side."""

import enum
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ...progress import tell
from ..problem.objective import Objective, Points
from .linear_algebra import solve_positive

DAMPING = 1e-3
"""Damping of the first step, over the largest diagonal entry of the Hessian."""
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e12
LEAST_FALL = 1e-4
"""Fraction of the predicted fall of the cost that an accepted step must bring."""
LONGEST = 2.0
"""Largest change of an unknown in a step, in x: a factor of seven, or the whole
range."""
ONE_MINIMUM = 0.3
"""Distance in standard errors within which fits are at one minimum."""
ONE_PATH = 0.1
"""Distance in x that is needed too, between fits that have not ended."""
ROUNDS = 10
"""Rounds of the active-set method for each unknown: a few are needed."""
ROUNDING = 1e-12
"""Fraction of the gradient below which an unknown is not released from its bound."""
REGULAR = 1e-12
"""Least damping, over the Hessian's largest diagonal entry: it keeps it regular."""


class Reason(enum.Enum):
    """Reason for which a fit stopped: its words, and whether it is at a minimum."""

    converged = "converged: gradient norm below tolerance", True
    noise = "converged: steps below the integration error of the impacts", True
    flat = "converged: the cost no longer falls", True
    joined = "converged: at the minimum of another start", True
    searched = "converged: found with other starts by differential evolution", True
    edge = "converged: at a jump of a prediction, on the branches of its impacts", True
    jump = "stuck at a discontinuity: the outcome of an impact changes", False
    stuck = "stuck: no step lowers the cost", False
    above = "in a local minimum above the best fit", False
    step_limit = "limit of steps reached", False
    failed = "failed: an impact could not be computed", False

    @property
    def words(self) -> str:
        """The reason in words, for reports."""
        return self.value[0]

    def __str__(self) -> str:
        return self.words

    @property
    def at_minimum(self) -> bool:
        """Whether the fit ended at a minimum."""
        return self.value[1]


class StoppingRule(NamedTuple):
    """Stopping rule of a fit.

    The distance to the minimum is measured by the fall of the cost that a full
    Gauss-Newton step predicts: half the square of the distance in standard errors if
    the sigmas are known; otherwise that, times s^2 = 2 cost / (degrees of freedom).
    """

    promise: float
    """Predicted fall of the cost below which a fit has converged."""
    part: float
    """Predicted fall, as a fraction of s^2, below which a fit has converged."""
    lost: float
    """Predicted fall, over max(1, s^2), below which a fit has converged once
    `FEW_REJECTED` steps in a row were rejected."""
    blurred: float
    """Predicted fall, over max(1, s^2), below which a fit has converged once `rejected`
    steps in a row were rejected."""
    rejected: int
    """Number of rejected steps in a row, each shorter, after which a fit ends."""
    flat: float
    """Relative fall of the cost over `FLAT_STEPS` accepted steps below which a fit
    ends."""
    steps: int
    """Largest number of steps."""
    joins: bool
    """Whether fits that meet another one continue as that one."""


FLAT_STEPS, FEW_REJECTED = 5, 2
ROUGH = StoppingRule(
    1e-4, 1e-2, 1e-2, 1e-2, rejected=6, flat=1e-2, steps=30, joins=True
)
"""Stopping rule for ranking starts and for profiles: about a tenth of a standard
error."""
FINE = StoppingRule(
    1e-10, 1e-6, 1e-8, 1e-4, rejected=10, flat=1e-6, steps=60, joins=False
)
"""Stopping rule of the reported fit: a thousandth of a standard error."""


class Fits(NamedTuple):
    """Ends of fits, one a lane."""

    points: Points
    reasons: list[Reason]
    steps: np.ndarray
    restarts: np.ndarray | int = 0
    """Number of restarts of each from a new point."""

    @property
    def best(self) -> int:
        """Lane of the least cost; of equals the first that converged by itself."""
        followed = Reason.joined, Reason.searched
        joined = [reason in followed for reason in self.reasons]
        return int(np.lexsort((np.array(joined), self.points.cost))[0])

    def ending(self, lanes, points: Points, reasons: Iterable[Reason]) -> "Fits":
        """Replace points and reasons of some lanes."""
        replaced = list(self.reasons)
        for lane, reason in zip(lanes, reasons, strict=True):
            replaced[lane] = reason
        points = self.points.put(lanes, points)
        return self._replace(points=points, reasons=replaced)


def levenberg_marquardt(
    objective: Objective,
    x: np.ndarray,
    free: np.ndarray | None,
    rule: StoppingRule,
) -> Fits:
    r"""Fit from every x, shape (lanes, unknowns), until the stopping rule ends each.

    A step solves, in the unknowns that are free and not fixed at a bound,

    $$ (H + \lambda d) \, \delta = -g, $$

    d the largest diagonal entry of H, or minimises the same quadratic model between the
    bounds. The damping follows from the ratio of actual to predicted fall of the cost
    (Nielsen 1999).
    """
    low, high = objective.bounds.low, objective.bounds.high
    x = np.clip(x, low, high)
    all_free = free is None
    free = np.ones(x.shape, bool) if free is None else free
    points = objective(x)
    state = _State(len(x))
    for number in range(rule.steps + 1):
        going = np.flatnonzero(state.going)
        here = points.take(going)
        room = here, free[going], low - here.x, high - here.x
        _, promise = bounded_step(*room, np.zeros(len(going)))
        variance = objective.variance(here.cost)
        failed = np.any(objective.failed(here.predicted), axis=(1, 2))
        for at, lane in enumerate(going):
            found = here.cost[at], variance[at], promise[at], failed[at]
            state.reasons[lane] = _reason(state, lane, *found, rule)
        if rule.joins and all_free:
            _join(objective, points, state)
        tell(step_line(number, points.cost, state.reasons))
        if number == rule.steps or not np.any(state.going):
            break
        on = state.going[going]
        going, here = going[on], here.take(on)
        room = here, free[going], low - here.x, high - here.x
        step, promise = bounded_step(*room, state.damping[going])
        tried = objective.values(np.clip(here.x + step, low, high))
        fall = here.cost - tried.cost
        taken = fall > LEAST_FALL * promise
        if np.any(taken):
            points = points.put(going[taken], objective(tried.x[taken]))
        state.update(going, taken, fall, promise, here, tried)
    reasons = [reason or Reason.step_limit for reason in state.reasons]
    return _with_leaders(Fits(points, reasons, state.steps), state.leader)


class _State:
    """Progress of each fit."""

    def __init__(self, lanes: int):
        self.reasons: list[Reason | None] = [None] * lanes
        self.steps = np.zeros(lanes, int)
        self.damping = np.full(lanes, DAMPING)
        self.factor = np.full(lanes, 2.0)
        self.rejected = np.zeros(lanes, int)
        self.since_jump = np.full(lanes, 10**6)
        """Steps since the last rejected one in which an outcome changed."""
        self.falls: list[list[float]] = [[] for _ in range(lanes)]
        """Falls of the cost in the accepted steps."""
        self.leader = np.arange(lanes)
        """Fit that each has joined, or itself."""

    @property
    def going(self) -> np.ndarray:
        return np.array([reason is None for reason in self.reasons])

    def update(self, lanes, taken, fall, promise, here: Points, tried: Points):
        """Update damping and counters after a step of these lanes."""
        self.steps[lanes] += 1
        ratio = fall / np.where(promise > 0.0, promise, 1.0)
        good = np.maximum(1.0 / 3.0, 1.0 - (2.0 * ratio - 1.0) ** 3)
        factor = np.where(taken, good, self.factor[lanes])
        damping = np.clip(self.damping[lanes] * factor, LEAST_DAMPING, MOST_DAMPING)
        self.damping[lanes] = damping
        self.factor[lanes] = np.where(taken, 2.0, 2.0 * self.factor[lanes])
        self.rejected[lanes] = np.where(taken, 0, self.rejected[lanes] + 1)
        changed = np.any(here.outcomes != tried.outcomes, axis=1)
        jumped = ~taken & changed
        self.since_jump[lanes] = np.where(jumped, 0, self.since_jump[lanes] + 1)
        for lane, was_taken, by in zip(lanes, taken, fall, strict=True):
            if was_taken:
                self.falls[lane].append(by)


def bounded_step(
    points: Points, free: np.ndarray, down: np.ndarray, up: np.ndarray, damping
) -> tuple[np.ndarray, np.ndarray]:
    """Compute a damped Gauss-Newton step within the bounds, and its predicted fall.

    Args:
        free: which unknowns may change, shape (lanes, unknowns).
        down, up: distances to the bounds, <= 0 and >= 0.
        damping: damping over the Hessian's largest diagonal entry, shape (lanes,).
    """
    gradient, hessian = points.gradient, points.hessian
    size = gradient.shape[1]
    diagonal = np.einsum("lpp->lp", hessian)
    largest = np.max(np.where(free, diagonal, 0.0), axis=1)
    scale = np.where(largest > 0.0, largest, 1.0)
    shift = scale * (np.asarray(damping) + REGULAR)
    damped = hessian + shift[:, None, None] * np.eye(size)
    least = np.maximum(down, -LONGEST)
    most = np.minimum(up, LONGEST)
    at_bound = ((down >= 0.0) & (gradient > 0.0)) | ((up <= 0.0) & (gradient < 0.0))
    moving = free & ~at_bound
    system = np.where(moving[:, :, None] & moving[:, None, :], damped, 0.0)
    system = system + np.where(moving, 0.0, scale[:, None])[..., None] * np.eye(size)
    right = np.where(moving, -gradient, 0.0)
    step = solve_positive(system, right)
    beyond = np.any((step < least) | (step > most), axis=1)
    # An unknown fixed at its bound may have to leave it once the others have moved.
    slope = gradient + np.einsum("lpq,lq->lp", damped, step)
    inward = np.where(down >= 0.0, slope < 0.0, slope > 0.0)
    beyond |= np.any(free & at_bound & inward, axis=1)
    least, most = np.where(free, least, 0.0), np.where(free, most, 0.0)
    step = np.clip(step, least, most)
    for lane in np.flatnonzero(beyond):
        model = gradient[lane], damped[lane], least[lane], most[lane]
        step[lane] = _least_between(*model)
    linear = np.einsum("lp,lp->l", gradient, step)
    square = np.einsum("lp,lpq,lq->l", step, hessian, step)
    return step, -(linear + 0.5 * square)


def is_near(
    objective: Objective, points: Points, lane, others: np.ndarray, place: float
) -> np.ndarray:
    """Find which of the others, of equal or lower cost, are at the minimum of a lane:
    within `place` in x, and a difference in cost that the data cannot resolve."""
    apart = points.x[others] - points.x[lane]
    distance = np.einsum("lp,lpq,lq->l", apart, points.hessian[others], apart)
    least = objective.unit(points.cost[others]) * ONE_MINIMUM**2
    more = points.cost[lane] - points.cost[others]
    near = np.all(np.abs(apart) <= place, axis=1) & (distance <= least)
    return near & (more >= 0.0) & (more <= least)


def _join(objective: Objective, points: Points, state: _State) -> None:
    """Let fits that have met another one continue as that one."""
    ahead = [reason is None or reason.at_minimum for reason in state.reasons]
    ahead = np.array(ahead) & (state.leader == np.arange(len(ahead)))
    for lane in np.flatnonzero(state.going):
        ahead[lane] = False
        others = np.flatnonzero(ahead)
        near = is_near(objective, points, lane, others, ONE_PATH)
        if np.any(near):
            state.leader[lane] = others[np.argmax(near)]
            state.reasons[lane] = Reason.joined
        else:
            ahead[lane] = True


def _with_leaders(fits: Fits, leader: np.ndarray) -> Fits:
    """Replace fits that joined another by the end of that one."""
    lanes = np.flatnonzero(leader != np.arange(len(leader)))
    while np.any(leader[leader] != leader):
        leader = leader[leader]
    ends = [fits.reasons[last] for last in leader[lanes]]
    reasons = [Reason.joined if end.at_minimum else end for end in ends]
    return fits.ending(lanes, fits.points.take(leader[lanes]), reasons)


def _least_between(gradient, hessian, least, most) -> np.ndarray:
    """Minimise the quadratic model of one fit between limits by active sets.

    The step is never worse than none, however the unknowns are correlated.
    """
    step = np.zeros_like(gradient)
    open_ = least < most
    moving = open_ & ~((least >= 0.0) & (gradient > 0.0))
    moving &= ~((most <= 0.0) & (gradient < 0.0))
    for _ in range(ROUNDS * len(step)):
        places = np.flatnonzero(moving)
        slope = gradient + hessian @ step
        system = hessian[np.ix_(places, places)]
        move = solve_positive(system, -slope[places])
        limit = np.where(move > 0.0, most[places], least[places])
        room = limit - step[places]
        beyond = np.abs(move) > np.abs(room)
        if np.any(beyond):
            fraction = np.full(len(places), np.inf)
            fraction[beyond] = room[beyond] / move[beyond]
            first = int(np.argmin(fraction))
            step[places] += fraction[first] * move
            step[places[first]] = limit[first]
            moving[places[first]] = False
            continue
        step[places] += move
        slope = gradient + hessian @ step
        inward = np.where(step <= least, -slope, slope)
        inward = np.where(open_ & ~moving, inward, 0.0) / np.sqrt(np.diag(hessian))
        if np.max(inward) <= ROUNDING * np.max(np.abs(gradient)):
            break
        moving[np.argmax(inward)] = True
    return step


def _reason(
    state: _State, lane, cost, variance, promise, failed, rule: StoppingRule
) -> Reason | None:
    """Apply the stopping rule, with s^2 at this cost, the fall of the cost that a full
    step promises, and whether a prediction is missing; None to continue."""
    rejected, falls = state.rejected[lane], state.falls[lane]
    if promise <= max(rule.promise, rule.part * variance):
        return Reason.failed if failed else Reason.converged
    promise = promise / max(1.0, variance)
    if rejected >= FEW_REJECTED and promise <= rule.lost:
        return Reason.noise
    at_jump = state.since_jump[lane] <= FLAT_STEPS
    if rejected >= rule.rejected:
        if promise <= rule.blurred:
            return Reason.noise
        return Reason.failed if failed else Reason.jump if at_jump else Reason.stuck
    enough = len(falls) >= FLAT_STEPS and rejected == 0
    if enough and sum(falls[-FLAT_STEPS:]) <= rule.flat * cost:
        return Reason.jump if at_jump else Reason.flat
    return None


def step_line(number: int, cost: np.ndarray, reasons: list[Reason | None]) -> str:
    """Say how far fits are, those without a reason to stop still going."""
    return (
        f"step {number}: {reasons.count(None)} of {len(cost)} fits go on, lowest cost "
        f"{np.min(cost):.6g}"
    )

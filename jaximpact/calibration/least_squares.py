"""Levenberg and Marquardt's method, for many fits side by side, between bounds."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .objective import Objective, Points
from .stopping import FEW_REJECTED, FLAT_STEPS, Patience, Reason

Progress = Callable[[str], None]

DAMPING = 1e-3
"""At the start, in units of the largest entry of the Hessian's diagonal."""
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e12
LEAST_FALL = 1e-4
"""Part of the promised fall that a step must bring to be taken."""
LONGEST = 2.0
"""Most that a step changes an unknown by, in x: a factor of seven, or the whole
range."""
ONE_MINIMUM = 0.3
"""Standard errors within which fits count as being at one place."""
ONE_PATH = 0.1
"""And how near they must be in x where they are under way."""
ROUNDS = 10
"""For each unknown, where a step meets a bound: a few are needed."""
ROUNDING = 1e-12
"""Part of the gradient below which none drives an unknown away from its bound."""
REGULAR = 1e-12
"""Part of the Hessian's largest diagonal entry that stands for none."""


class Fits(NamedTuple):
    """Fits at their ends."""

    points: Points
    reasons: list[Reason]
    steps: np.ndarray
    anew: np.ndarray | int = 0
    """How often each was begun anew, elsewhere."""

    @property
    def best(self) -> int:
        """The fit of least cost; of equals the first that has come there itself."""
        joined = [reason is Reason.joined for reason in self.reasons]
        return int(np.lexsort((joined, self.points.cost))[0])


def levenberg_marquardt(
    objective: Objective,
    x: np.ndarray,
    free: np.ndarray | None,
    patience: Patience,
    progress: Progress,
) -> Fits:
    r"""Fit from every x `(lanes, unknowns)` until each has a reason to stop.

    A step solves, in the unknowns that are free and not held by a bound,

    $$ (H + \lambda d) \, \delta = -g, $$

    d the largest entry of the diagonal of H, or the least of the same quadratic model
    between the bounds. The damping follows from the fall of the cost over the one
    promised (Nielsen 1999).
    """
    low, high = objective.bounds.low, objective.bounds.high
    x = np.clip(x, low, high)
    all_free = free is None
    free = np.ones(x.shape, bool) if free is None else free
    points = objective(x, free)
    state = _State(len(x))
    for number in range(patience.steps + 1):
        going = np.flatnonzero(state.going)
        here = points.take(going)
        room = here, free[going], low - here.x, high - here.x
        _, promise = bounded_step(*room, np.zeros(len(going)))
        variance = objective.variance(here.cost)
        for at, lane in enumerate(going):
            state.reasons[lane] = _reason(
                state,
                lane,
                here.cost[at],
                variance[at],
                promise[at],
                bool(np.any(objective.failed(here.predicted[at]))),
                patience,
            )
        if patience.joins and all_free:
            _join(objective, points, state)
        progress(_line(number, points.cost, int(np.sum(state.going))))
        if number == patience.steps or not np.any(state.going):
            break
        on = state.going[going]
        going, here = going[on], here.take(on)
        room = here, free[going], low - here.x, high - here.x
        step, promise = bounded_step(*room, state.damping[going])
        tried = objective.glance(np.clip(here.x + step, low, high), free[going])
        fall = here.cost - tried.cost
        taken = fall > LEAST_FALL * promise
        if np.any(taken):
            whole = objective.complete(tried.take(taken), free[going[taken]])
            points = points.put(going[taken], whole)
        state.update(going, taken, fall, promise, here, tried)
    reasons = [reason or Reason.step_limit for reason in state.reasons]
    return _with_leaders(Fits(points, reasons, state.steps), state.leader)


class _State:
    """How each fit is getting on."""

    def __init__(self, lanes: int):
        self.reasons: list[Reason | None] = [None] * lanes
        self.steps = np.zeros(lanes, int)
        self.damping = np.full(lanes, DAMPING)
        self.factor = np.full(lanes, 2.0)
        self.rejected = np.zeros(lanes, int)
        self.since_jump = np.full(lanes, 10**6)
        """Steps since one was refused in which an outcome changed."""
        self.falls: list[list[float]] = [[] for _ in range(lanes)]
        """Of the cost, in the steps taken."""
        self.leader = np.arange(lanes)
        """The fit that each has joined, or itself."""

    @property
    def going(self) -> np.ndarray:
        return np.array([reason is None for reason in self.reasons])

    def update(self, lanes, taken, fall, promise, here: Points, tried: Points):
        """After a step of these lanes."""
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
    """A damped Gauss-Newton step that keeps to the bounds, and the fall it promises.

    Args:
        free: which unknowns may move, `(lanes, unknowns)`.
        down, up: how far to the bounds, not positive and not negative.
        damping: `(lanes,)`.
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
    step = np.linalg.solve(system, right[..., None])[..., 0]
    beyond = np.any((step < least) | (step > most), axis=1)
    # One that was held at its bound may have to leave it when the others have moved.
    slope = gradient + np.einsum("lpq,lq->lp", damped, step)
    inward = np.where(down >= 0.0, slope < 0.0, slope > 0.0)
    beyond |= np.any(free & at_bound & inward, axis=1)
    least, most = np.where(free, least, 0.0), np.where(free, most, 0.0)
    step = np.clip(step, least, most)
    for lane in np.flatnonzero(beyond):
        step[lane] = _least_between(
            gradient[lane], damped[lane], least[lane], most[lane]
        )
    linear = np.einsum("lp,lp->l", gradient, step)
    square = np.einsum("lp,lpq,lq->l", step, hessian, step)
    return step, -(linear + 0.5 * square)


def is_near(
    objective: Objective, points: Points, lane: int, others: np.ndarray, place: float
) -> np.ndarray:
    """Which of the others, no dearer, are within `place` of a lane in x, and so near
    that the difference in cost is less than the data can tell."""
    apart = points.x[others] - points.x[lane]
    distance = np.einsum("lp,lpq,lq->l", apart, points.hessian[others], apart)
    least = objective.unit(points.cost[others]) * ONE_MINIMUM**2
    dearer = points.cost[lane] - points.cost[others]
    near = np.all(np.abs(apart) <= place, axis=1) & (distance <= least)
    return near & (dearer >= 0.0) & (dearer <= least)


def _join(objective: Objective, points: Points, state: _State) -> None:
    """Let fits that have come to where another is go on as that one."""
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
    """Fits of which those that joined another end where that one did."""
    points, reasons = fits.points, list(fits.reasons)
    for lane in np.flatnonzero(leader != np.arange(len(leader))):
        last = leader[lane]
        while leader[last] != last:
            last = leader[last]
        points = points.put([lane], points.take([last]))
        found = fits.reasons[last]
        reasons[lane] = Reason.joined if found.at_minimum else found
    return Fits(points, reasons, fits.steps)


def _least_between(gradient, hessian, least, most) -> np.ndarray:
    """The step of one fit to the least of the quadratic model between limits, by active
    sets: never worse than none, however the unknowns are correlated."""
    step = np.zeros_like(gradient)
    open_ = least < most
    moving = open_ & ~((least >= 0.0) & (gradient > 0.0))
    moving &= ~((most <= 0.0) & (gradient < 0.0))
    for _ in range(ROUNDS * len(step)):
        places = np.flatnonzero(moving)
        slope = gradient + hessian @ step
        system = hessian[np.ix_(places, places)]
        move = np.linalg.solve(system, -slope[places])
        limit = np.where(move > 0.0, most[places], least[places])
        room = limit - step[places]
        beyond = np.abs(move) > np.abs(room)
        if np.any(beyond):
            share = np.full(len(places), np.inf)
            share[beyond] = room[beyond] / move[beyond]
            first = int(np.argmin(share))
            step[places] += share[first] * move
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
    state: _State,
    lane: int,
    cost: float,
    variance: float,
    promise: float,
    failed: bool,
    patience: Patience,
) -> Reason | None:
    """Why to stop a fit; None to go on.

    Args:
        variance: s^2 at this cost.
        promise: fall of the cost by a full step.
        failed: whether a prediction is missing.
    """
    rejected, falls = state.rejected[lane], state.falls[lane]
    if promise <= max(patience.promise, patience.part * variance):
        return Reason.failed if failed else Reason.converged
    promise = promise / max(1.0, variance)
    if rejected >= FEW_REJECTED and promise <= patience.lost:
        return Reason.noise
    at_jump = state.since_jump[lane] <= FLAT_STEPS
    if rejected >= patience.rejected:
        if promise <= patience.blurred:
            return Reason.noise
        return Reason.failed if failed else Reason.jump if at_jump else Reason.stuck
    enough = len(falls) >= FLAT_STEPS and rejected == 0
    if enough and sum(falls[-FLAT_STEPS:]) <= patience.flat * cost:
        return Reason.jump if at_jump else Reason.flat
    return None


def _line(number: int, cost: np.ndarray, going: int) -> str:
    return (
        f"step {number}: {going} of {len(cost)} fits go on, lowest cost "
        f"{np.min(cost):.6g}"
    )

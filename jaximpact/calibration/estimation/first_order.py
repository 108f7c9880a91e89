"""First-order methods: Adam and L-BFGS of optax, for many fits side by side."""

import jax
import jax.numpy as jnp
import numpy as np
import optax

from ...progress import tell
from ..problem.objective import Objective, Points
from .least_squares import Fits, Reason

STEPS = 300
ADAM_RATE, ADAM_DECAY, ADAM_DECAY_STEPS = 0.1, 0.5, 60
"""First step of Adam in x, the factor by which it decays, and in how many steps."""
GRADIENT = 1e-6
"""Largest entry of the gradient over the cost below which a fit has converged; unknowns
at a bound that cannot move do not count."""
SHORTER, MOST_SHORTER = 0.25, 8
"""Factor by which a step of L-BFGS is shortened that does not lower the cost enough,
and how often."""
ENOUGH = 1e-4
"""Fraction of the fall predicted by the gradient that a step must bring."""
LONGEST = 1.0
"""Largest change of an unknown in a step of L-BFGS, in x."""


def adam(objective: Objective, x: np.ndarray) -> Fits:
    """Minimise by Adam from every x; each fit keeps its best point."""
    schedule = optax.exponential_decay(ADAM_RATE, ADAM_DECAY_STEPS, ADAM_DECAY)
    optimiser = optax.adam(schedule)
    memory = optimiser.init(jnp.asarray(x))
    best = now = objective(_inside(objective, x))
    reasons: list[Reason | None] = [None] * len(x)
    steps = np.zeros(len(x), int)
    for number in range(1, STEPS + 1):
        _stop(objective, now, reasons)
        tell(_step_line(number, best.cost, reasons))
        going = np.array([reason is None for reason in reasons])
        if not np.any(going):
            break
        change, memory = optimiser.update(jnp.asarray(now.gradient), memory)
        tried = _inside(objective, now.x + np.asarray(change))
        now = now.put(going, objective(tried[going]))
        steps[going] = number
        lower = now.cost < best.cost
        best = best.put(lower, now.take(lower))
    return Fits(best, [reason or Reason.step_limit for reason in reasons], steps)


def l_bfgs(objective: Objective, x: np.ndarray) -> Fits:
    """Minimise by L-BFGS from every x, with a backtracking line search."""
    optimiser = optax.scale_by_lbfgs()
    memory = jax.vmap(optimiser.init)(jnp.asarray(x))
    update = jax.jit(jax.vmap(optimiser.update))
    now = objective(_inside(objective, x))
    reasons: list[Reason | None] = [None] * len(x)
    steps = np.zeros(len(x), int)
    for number in range(1, STEPS + 1):
        _stop(objective, now, reasons)
        tell(_step_line(number, now.cost, reasons))
        going = np.array([reason is None for reason in reasons])
        if not np.any(going):
            break
        ascent, memory = update(now.gradient, memory, now.x)
        step = -np.asarray(ascent)
        longest = np.max(np.abs(step), axis=1, keepdims=True)
        step = step * np.minimum(1.0, LONGEST / np.maximum(longest, 1e-300))
        open_ = going.copy()
        for _ in range(MOST_SHORTER):
            lanes = np.flatnonzero(open_)
            if not len(lanes):
                break
            tried = objective(_inside(objective, now.x[lanes] + step[lanes]))
            here = now.take(lanes)
            promise = -np.sum(here.gradient * (tried.x - here.x), axis=1)
            good = here.cost - tried.cost > ENOUGH * np.abs(promise)
            now = now.put(lanes[good], tried.take(good))
            open_[lanes[good]] = False
            step[lanes[~good]] *= SHORTER
        for lane in np.flatnonzero(open_):
            reasons[lane] = Reason.stuck
        steps[going] = number
    return Fits(now, [reason or Reason.step_limit for reason in reasons], steps)


def _inside(objective: Objective, x) -> np.ndarray:
    return np.clip(np.asarray(x), objective.bounds.low, objective.bounds.high)


def _stop(objective: Objective, points: Points, reasons: list) -> None:
    """Mark the fits that have converged."""
    bounds, gradient = objective.bounds, points.gradient
    outward = ((points.x <= bounds.low) & (gradient > 0.0)) | (
        (points.x >= bounds.high) & (gradient < 0.0)
    )
    largest = np.max(np.abs(np.where(outward, 0.0, gradient)), axis=1)
    for lane in np.flatnonzero(largest <= GRADIENT * points.cost + 1e-12):
        if reasons[lane] is None:
            failed = np.any(objective.failed(points.predicted[lane]))
            reasons[lane] = Reason.failed if failed else Reason.converged


def _step_line(number: int, cost: np.ndarray, reasons: list[Reason | None]) -> str:
    """Say how far fits are, those without a reason to stop still going."""
    return (
        f"step {number}: {reasons.count(None)} of {len(cost)} fits not yet ended, "
        f"lowest cost {np.min(cost):.6g}"
    )

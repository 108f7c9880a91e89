"""Several fits at once, each until it has a reason to stop."""

import enum
from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
import optax

from .solver import Lane, Stepper, fresh_lanes, put, take
from .transforms import Bounds

METHODS = ("levenberg-marquardt", "adam")
ADAM_STEPS = 300
FLAT_STEPS = 4

ADAM_RATE, ADAM_DECAY, ADAM_DECAY_STEPS = 0.1, 0.5, 60
"""Adam's step in z at first, and what it is multiplied by every so many steps."""
ADAM_GRADIENT = 1e-8
"""Adam stops at a gradient below this part of the cost."""
SPREAD = 0.05
"""Starts keep this part of the range away from the bounds."""

Progress = Callable[[str], None]


class Patience(NamedTuple):
    """How long Levenberg-Marquardt goes on."""

    flat: float
    """Part of the cost; one that falls by less over `FLAT_STEPS` accepted steps has
    come to its end."""
    rejected: int
    """Steps in a row, each shorter, none of which lowered the cost."""
    steps: int


ROUGH = Patience(flat=1e-2, rejected=5, steps=25)
"""For comparing starts, and for profiles."""
FINE = Patience(flat=1e-4, rejected=8, steps=60)
"""For the fit that is reported."""


class Reason(enum.Enum):
    """Why a fit stopped."""

    converged = "step and residuals below the tolerance"
    flat = "the cost no longer falls"
    stuck = "no shorter step lowers the cost"
    step_limit = "limit of steps reached"
    failed = "cost not finite"


class Fits(NamedTuple):
    """Fits at their ends."""

    lanes: Lane
    cost: np.ndarray
    reasons: list[Reason]
    steps: np.ndarray

    @property
    def best(self) -> int:
        """The fit of least cost; the first of equals."""
        return int(np.argmin(np.where(np.isfinite(self.cost), self.cost, np.inf)))


def spread_starts(bounds: Bounds, start, count: int, seed: int) -> np.ndarray:
    """Starts as z, `(count, parameters)`: the one given, then a Latin hypercube.

    The hypercube divides each parameter's range, in the logarithm where the parameter
    is positive, into as many strata as there are points.
    """
    random = np.random.default_rng(seed)
    others, size = count - 1, len(np.asarray(start))
    strata = np.stack([random.permutation(others) for _ in range(size)], axis=-1)
    part = (strata + random.random((others, size))) / max(others, 1)
    part = SPREAD + (1.0 - 2.0 * SPREAD) * part
    spread = bounds.real(bounds.at_part(part)).reshape(others, size)
    return np.concatenate([bounds.real(np.asarray(start))[None], spread])


def fit(
    stepper: Stepper,
    z,
    free=None,
    anchor=None,
    *,
    method: str = METHODS[0],
    patience: Patience = FINE,
    progress: Progress = lambda text: None,
) -> Fits:
    """Fit from every z until each fit has a reason to stop.

    Args:
        stepper: of the case.
        z, free, anchor: as for `fresh_lanes`.
        method: one of `METHODS`.
        patience: of Levenberg-Marquardt.
        progress: called with a line of text after every step.

    The same numbers, on the same machine, for the same arguments.
    """
    lanes = fresh_lanes(stepper.case, z, free, anchor)
    if method == METHODS[0]:
        return _levenberg_marquardt(stepper, lanes, patience, progress)
    return _adam(stepper, lanes, progress)


def _levenberg_marquardt(stepper, lanes, patience, progress) -> Fits:
    count = len(lanes.z)
    reasons: list[Reason | None] = [None] * count
    steps = np.zeros(count, int)
    histories: list[list[float]] = [[] for _ in range(count)]
    for number in range(1, patience.steps + 1):
        active = [i for i in range(count) if reasons[i] is None]
        if not active:
            break
        after = stepper.step(take(lanes, active))
        lanes = put(lanes, active, after)
        cost = lanes.cost
        for place, lane in enumerate(active):
            rejected = int(after.state.num_steps_since_acceptance[place])
            if rejected == 0:
                histories[lane].append(float(cost[lane]))
            steps[lane] = number
            terminate = bool(after.state.terminate[place])
            reasons[lane] = _reason(histories[lane], rejected, terminate, patience)
        progress(_line(number, cost, reasons))
    reasons = [reason or Reason.step_limit for reason in reasons]
    return Fits(lanes, lanes.cost, reasons, steps)


def _reason(
    history: list[float], rejected: int, terminate: bool, patience: Patience
) -> Reason | None:
    """Why to stop a fit, given the costs of its accepted steps; None to go on."""
    if not history or not np.isfinite(history[-1]):
        return Reason.failed
    if terminate:
        return Reason.converged
    if rejected >= patience.rejected:
        return Reason.stuck
    if len(history) > FLAT_STEPS and rejected == 0:
        fall = history[-1 - FLAT_STEPS] - history[-1]
        if fall <= patience.flat * history[-1]:
            return Reason.flat
    return None


def _adam(stepper, lanes, progress) -> Fits:
    """Adam on all lanes. Each keeps the best point it has seen."""
    schedule = optax.exponential_decay(ADAM_RATE, ADAM_DECAY_STEPS, ADAM_DECAY)
    optimiser = optax.adam(schedule)
    z = jnp.asarray(lanes.z)
    memory = optimiser.init(z)
    best = None
    reasons: list[Reason | None] = [None] * len(z)
    steps = np.zeros(len(z), int)
    for number in range(1, ADAM_STEPS + 1):
        now = stepper.step(fresh_lanes(stepper.case, z, lanes.free, lanes.anchor))
        cost = now.cost
        gradient = np.einsum("lrp,lr->lp", now.jacobian, now.residuals)
        lower = np.full(len(z), True) if best is None else cost < best.cost
        best = now if best is None else put(best, lower, take(now, lower))
        for lane in range(len(z)):
            if reasons[lane] is not None:
                continue
            steps[lane] = number
            if not np.isfinite(cost[lane]):
                reasons[lane] = Reason.failed
            elif np.max(np.abs(gradient[lane])) <= ADAM_GRADIENT * cost[lane]:
                reasons[lane] = Reason.converged
        progress(_line(number, best.cost, reasons))
        if all(reasons):
            break
        change, memory = optimiser.update(jnp.nan_to_num(gradient), memory, z)
        z = optax.apply_updates(z, change)
    reasons = [reason or Reason.step_limit for reason in reasons]
    return Fits(best, best.cost, reasons, steps)


def _line(number: int, cost: np.ndarray, reasons) -> str:
    going = sum(reason is None for reason in reasons)
    return f"step {number}: {going} of {len(cost)} fits go on, lowest cost " + (
        f"{np.nanmin(cost):.6g}" if np.any(np.isfinite(cost)) else "not finite"
    )

"""What is gathered step by step: peaks, and the work of the ledger.

It costs the step size control nothing, and no history need be kept.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..laws import Branch
from ..mechanics.dynamics import Work
from ..mechanics.kinks import SWITCHED_OFF, at_start, branch_of
from ..mechanics.outcomes import Margins
from ..mechanics.problem import Observed, Problem, Watched
from .cubic import peak_of_cubic
from .rosenbrock import DenseOutput, per_width

Scalar = Float[Array, ""]

INITIAL_MARGIN = 1e-6
"""Margin that stands for those before the first step, whose true values may be less
than what counts as zero."""
PROGRESS = 0.01
"""Part of the time reached by which a step must take it on, at the onset."""
ONSET = 1e-3
"""The onset of an impact, by the time in which the block moves by its size."""


class Fold(NamedTuple):
    """What is gathered over the accepted steps."""

    peaks: Observed
    peak_times: Observed
    work: Work | None
    watched: Watched
    watched_rate: Watched
    """On the branch that led here."""
    rates: Float[Array, " n"]
    """Of the unknowns, as the last step has them. With dashpots the errors of forces
    are so large beside what relaxes that the equations give no rates for them."""
    turned: Scalar
    """1 where the next step takes another branch, on which the rates are others; else
    0. They are the same at the switch itself; but slip relaxes in a microsecond, so
    that its rate is off by much where the switch has been missed by little."""
    stalled: Scalar | None
    """With dashpots: steps without progress at the onset."""

    @property
    def margin(self) -> Scalar:
        """The least of the margins to an end."""
        return jnp.min(jnp.stack(self.watched.margins), axis=0)

    def rate_at_start(self, start, start_rate, end, end_rate, width):
        """Rate at the start of the next step, on its branch: the one known, or after a
        switch that of the parabola through what is known."""
        rise = per_width(end - start, width)
        return jnp.where(self.turned > 0.0, 2.0 * rise - end_rate, start_rate)


GAUSS_NODES = (0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15))
GAUSS_WEIGHTS = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


def start_fold(problem: Problem, vector) -> Fold:
    """What is gathered before the first step: nothing but the side of the switches."""
    zero = jnp.zeros_like(vector[0])
    nothing = Observed(*[zero] * len(Observed._fields))
    watched = problem.watch(list(vector), zero)
    still = jax.tree.map(jnp.zeros_like, watched)._replace(observed=nothing)
    return Fold(
        peaks=nothing._replace(normal_force=watched.observed.normal_force),
        peak_times=nothing,
        work=Work(*[zero] * len(Work._fields)),
        watched=Watched(
            nothing,
            Margins(*[zero + INITIAL_MARGIN] * len(Margins._fields)),
            at_start(problem.ground, watched.switches),
        ),
        watched_rate=still,
        rates=jnp.zeros_like(vector),
        turned=zero,
        stalled=zero if problem.model.damped else None,
    )


def fold_step(
    problem: Problem, fold: Fold, time, step: DenseOutput, branch: Branch
) -> Fold:
    """What is gathered, one accepted step later."""
    width = step.t1 - step.t0
    rates = step.rate_at_end()
    watched, watched_rate = problem.watch_with_rate(
        step.y1, rates, fold.peaks.normal_force, branch
    )
    peaks, times = [], []
    for name in Observed._fields:
        start, start_rate, end, end_rate = (
            getattr(of.observed, name)
            for of in (fold.watched, fold.watched_rate, watched, watched_rate)
        )
        start_rate = fold.rate_at_start(start, start_rate, end, end_rate, width)
        ends = start, start_rate, end, end_rate
        value, place = peak_of_cubic(*ends, width)
        if name in ("tangential_force", "moment"):
            lowest, lowest_place = peak_of_cubic(*(-x for x in ends), width)
            place = jnp.where(lowest > value, lowest_place, place)
            value = jnp.maximum(value, lowest)
        before = getattr(fold.peaks, name)
        higher = value > before
        peaks.append(jnp.where(higher, value, before))
        times.append(
            jnp.where(higher, time + place * width, getattr(fold.peak_times, name))
        )
    work = fold.work
    if problem.ledger:
        work = add_work(problem, work, step, 1.0, branch)
    sides = _stacked(branch), _stacked(branch_of(watched.switches))
    is_on = jnp.abs(_stacked(watched.switches)) > SWITCHED_OFF
    turned = jnp.any((sides[0] != sides[1]) & is_on, axis=0)
    return Fold(
        peaks=Observed(*peaks),
        peak_times=Observed(*times),
        work=work,
        watched=watched,
        watched_rate=watched_rate,
        rates=rates,
        turned=jnp.where(turned, 1.0, 0.0),
        stalled=_stalled_steps(problem, fold, time, width),
    )


def add_work(
    problem: Problem, work: Work, step: DenseOutput, part: Scalar | float, branch
) -> Work:
    """The work up to a part of a step, by that up to its start."""
    width = part * (step.t1 - step.t0)

    def power_at(node):
        vector = step.evaluate(step.t0 + node * width)
        return problem.power(vector, step.rate(part * node), branch)

    powers = jax.lax.map(power_at, jnp.asarray(GAUSS_NODES))
    return jax.tree.map(
        lambda total, power: total + width * jnp.dot(jnp.asarray(GAUSS_WEIGHTS), power),
        work,
        powers,
    )


def _stacked(values):
    return jnp.stack(jax.tree.leaves(values))


def _stalled_steps(problem: Problem, fold: Fold, time, width) -> Scalar | None:
    """Steps without progress at the onset, one step later."""
    if fold.stalled is None:
        return None
    progresses = (width > PROGRESS * time) | (time > ONSET * problem.passing_time)
    return jax.lax.stop_gradient(jnp.where(progresses, 0.0, fold.stalled + 1.0))

"""What is gathered step by step: peaks, and the work of the ledger.

It costs the step size control nothing, and no history need be kept.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .cubic import peak_of_cubic
from .dynamics import Work
from .kinks import Switches
from .laws import Branch
from .problem import Observed, Problem, Watched
from .rosenbrock import DenseOutput

Scalar = Float[Array, ""]

INITIAL_MARGIN = 1e-6
"""Margin that stands for the one before the first step, whose true value may be less
than what counts as zero."""


class Fold(NamedTuple):
    """What is gathered over the accepted steps."""

    peaks: Observed
    peak_times: Observed
    work: Work | None
    watched: Watched
    watched_rate: Watched


GAUSS_NODES = (0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15))
GAUSS_WEIGHTS = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


def start_fold(problem: Problem, vector) -> Fold:
    """What is gathered before the first step: nothing but the side of the switches."""
    zero = jnp.zeros_like(vector[0])
    nothing = Observed(*[zero] * len(Observed._fields))
    still = Switches(*[zero] * len(Switches._fields))
    sides = problem.watch(list(vector), zero).switches
    return Fold(
        peaks=nothing,
        peak_times=nothing,
        work=Work(*[zero] * len(Work._fields)),
        watched=Watched(nothing, zero + INITIAL_MARGIN, sides),
        watched_rate=Watched(nothing, zero, still),
    )


def fold_step(
    problem: Problem, fold: Fold, time, step: DenseOutput, branch: Branch
) -> Fold:
    """What is gathered, one accepted step later."""
    width = step.t1 - step.t0
    watched, rate = problem.watch_with_rate(step.y1, fold.peaks.normal_force, branch)
    peaks, times = [], []
    for name in Observed._fields:
        ends = (
            getattr(fold.watched.observed, name),
            getattr(fold.watched_rate.observed, name),
            getattr(watched.observed, name),
            getattr(rate.observed, name),
        )
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
        nodes = jnp.asarray(GAUSS_NODES)

        def power_at(node):
            return problem.power(step.evaluate(step.t0 + node * width), branch)

        powers = jax.lax.map(power_at, nodes)
        work = jax.tree.map(
            lambda total, power: (
                total + width * jnp.dot(jnp.asarray(GAUSS_WEIGHTS), power)
            ),
            work,
            powers,
        )
    return Fold(Observed(*peaks), Observed(*times), work, watched, rate)

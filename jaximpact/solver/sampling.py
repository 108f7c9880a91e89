"""The state of an impact between the ends of its steps."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..history import History, history_at
from ..laws import Branch
from ..mechanics.dynamics import Work
from ..mechanics.kinks import branch_of
from ..mechanics.problem import Problem
from .folding import Fold, add_work
from .rosenbrock import DenseOutput, per_width

Scalar = Float[Array, ""]


class LastStep(NamedTuple):
    """The last step that was accepted."""

    start: Scalar
    """Its time [s]."""
    step: DenseOutput
    """By the time since then."""
    branch: Branch
    work: Work
    """Up to its start."""


def no_step(vector: Float[Array, " n"], fold: Fold) -> LastStep:
    """What stands for the last step before the first: one of no width."""
    zero = jnp.zeros_like(vector[0])
    bend = jnp.zeros((3, *vector.shape))
    step = DenseOutput(t0=zero, t1=zero, y0=vector, y1=vector, k=bend)
    return LastStep(zero, step, branch_of(fold.watched.switches), fold.work)


def sample(problem: Problem, last: LastStep, time: Scalar) -> History:
    """The impact at a time in its last step.

    On the branch of the step: the interpolant may be on the other side of a switch, by
    its error, where the step has landed on it.
    """
    since = time - last.start
    vector = last.step.evaluate(since)
    work = None
    if problem.ledger:
        part = per_width(since, last.step.t1)
        work = add_work(problem, last.work, last.step, part, last.branch)
    return history_at(problem, time, vector, work, last.branch)

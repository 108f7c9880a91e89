"""Integration of one impact from touch to end: diffrax, Rodas5P and the end events.

Rodas5P may be replaced by another solver of diffrax (`diffrax_solvers`); all else
stays. Results besides the end state are accumulated over the accepted steps
(`accumulators`). diffrax watches one margin, the least of all, and stops when the step
size control (`event_location`) has landed on its root. Step widths are cut from
differentiation, but for those of steps that end on a switch of the laws or on the end:
corrections, zero in value, carry the derivatives of these times.
"""

import functools
from typing import Any, ClassVar, NamedTuple

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._types import Scalar
from ..impact.dynamics import ARM
from ..impact.events import TIME_LIMIT, Margins, branch_of
from ..impact.problem import Observed, Problem, jacobian_pattern
from ..laws import Branch
from .accumulators import Fold, LastStep, earlier, fold_step, start_fold
from .diffrax_solvers import solver_step
from .error_control import ErrorControl
from .event_location import LandingController, negligible_margin
from .rosenbrock import ORDER, DenseOutput, dense_output, rodas5p_step

LARGEST_CORRECTION = 1e-6
"""Largest correction of the event's time, as a fraction of the duration; where a step
has landed the correction is some 1e-10. Histories take times that are later than the
end by no more for the end (AT_THE_END in driver.c)."""


class SolverState(NamedTuple):
    """State of `FoldingSolver`."""

    vector: Float[Array, " n"]
    fold: Fold
    last: LastStep | None = None
    """Last accepted step, where samples are taken on the way; else None."""


TERMS = diffrax.ODETerm(lambda t, y, args: y)
"""Placeholder vector field required by diffrax; `advance` takes the problem's own."""


@functools.partial(jax.jit, static_argnames="solver")
def advance(
    problem: Problem,
    state: SolverState,
    time: Scalar,
    width: Scalar,
    solver: diffrax.AbstractAdaptiveSolver | None = None,
) -> tuple[SolverState, SolverState]:
    """Take one step of the package's method, or of another solver. Returns the state
    after the step, and its errors in units of what is allowed."""
    # `jit` keeps diffrax from tracing the step four times over.
    branch = branch_of(state.fold.watched.switches)
    if solver is None:
        vector, error, step = _rodas5p(problem, state, width, branch)
    else:
        vector, error, step = solver_step(
            solver,
            problem,
            state.vector,
            width,
            branch,
            state.fold.stalled,
            state.fold.largest_force,
        )
    size = jnp.maximum(jnp.abs(state.vector), jnp.abs(vector))
    allowed = problem.allowed_error(size, state.fold.largest_force)
    fold = fold_step(problem, state.fold, time, step, branch)
    vector = earlier(vector, fold.rates, state.fold.moved - fold.moved)
    vector = problem.on_next_side(vector, branch, fold.watched.switches)
    last = None
    if state.last is not None:
        last = LastStep(time + state.fold.moved, step, branch, state.fold.work)
    after = SolverState(vector, fold)
    # A non-finite error means that the step is far too long: reject it.
    error = jax.lax.stop_gradient(error / allowed)
    errors = jax.tree.map(jnp.zeros_like, after)
    return after._replace(last=last), errors._replace(
        vector=jnp.where(jnp.isfinite(error), error, 1e6)
    )


def _rodas5p(problem: Problem, state: SolverState, width: Scalar, branch: Branch):
    """Return the state after a step of the package's method, its error, and the dense
    output."""
    vector, error, stages = rodas5p_step(
        lambda rows: problem.rates(rows, branch, state.fold.stalled),
        state.vector,
        width,
        jacobian_pattern(problem),
    )
    step = DenseOutput(
        t0=jnp.zeros_like(width),
        t1=width,
        **dense_output(state.vector, vector, stages),
    )
    return vector, error, step


class FoldingSolver(diffrax.AbstractAdaptiveSolver):
    """A solver of the state vector that accumulates results over the steps, and returns
    errors in units of what is allowed."""

    solver: diffrax.AbstractAdaptiveSolver | None = eqx.field(default=None, static=True)
    """Another solver of diffrax; None for the package's method."""

    term_structure: ClassVar = diffrax.ODETerm
    # Saved are steps and the end, and the event is landed on: nothing interpolates.
    interpolation_cls: ClassVar = diffrax.LocalLinearInterpolation

    def order(self, terms):
        return ORDER if self.solver is None else self.solver.order(terms)

    def error_order(self, terms):
        return ORDER if self.solver is None else self.solver.error_order(terms)

    def init(self, terms, t0, t1, y0, args):
        return None

    def func(self, terms, t0, y0, args):
        return terms.vf(t0, y0, args)

    def step(self, terms, t0, t1, y0, args, solver_state, made_jump):
        after, errors = advance(args, y0, t0, terms.contr(t0, t1), self.solver)
        info = dict(y0=y0, y1=after)
        return after, errors, info, solver_state, diffrax.RESULTS.successful


class End(NamedTuple):
    """The end of an impact."""

    vector: Float[Array, " n"]
    time: Scalar
    fold: Fold
    margins: Margins
    event: Scalar
    """True if a margin came to zero."""
    finished: Scalar
    """False if the integration was given up."""
    steps: Scalar
    rejected: Scalar


def step_size_controller() -> LandingController:
    """Step size control by the errors that `advance` returns."""
    return LandingController(ErrorControl())


def diffrax_arguments(
    problem: Problem,
    vector: Float[Array, " n"],
    solver: diffrax.AbstractAdaptiveSolver | None = None,
) -> dict:
    """Return the arguments of `diffrax.diffeqsolve`, but for those of what is saved."""
    return dict(
        terms=TERMS,
        solver=FoldingSolver(solver),
        t0=0.0,
        t1=TIME_LIMIT,
        # Given here, it would be checked in a callback to the host.
        dt0=None,
        y0=SolverState(vector, start_fold(problem, vector)),
        args=problem,
        stepsize_controller=step_size_controller(),
        event=diffrax.Event(
            lambda t, y, args, **kwargs: (
                y.fold.margin <= negligible_margin(args.tolerance)
            )
        ),
        adjoint=diffrax.ForwardMode(),
        max_steps=problem.max_steps,
        throw=False,
    )


def _moved_to_the_end(
    problem: Problem, fold: Fold, time: Scalar, correction: Scalar, vector
) -> Fold:
    """Move the accumulators with the event's time: peaks that are reached as the impact
    ends, and the work up to then."""
    watched = problem.watch(list(vector), fold.largest_force)
    at_end = [reached >= time for reached in fold.peak_times]
    peaks = [
        jnp.where(ends, jnp.abs(value), peak)
        for ends, peak, value in zip(at_end, fold.peaks, watched.observed, strict=True)
    ]
    times = [
        reached - jnp.where(ends, correction, 0.0)
        for ends, reached in zip(at_end, fold.peak_times, strict=True)
    ]
    work = fold.work
    if problem.ledger is True:
        branch = branch_of(fold.watched.switches)
        power = problem.power(vector, fold.rates, branch)
        work = jax.tree.map(lambda done, rate: done - correction * rate, work, power)
    elif problem.ledger == ARM:
        work = work._replace(arm=work.arm - correction * fold.watched.arm_power)
    return fold._replace(peaks=Observed(*peaks), peak_times=Observed(*times), work=work)


def integrate(
    problem: Problem,
    vector: Float[Array, " n"],
    solver: diffrax.AbstractAdaptiveSolver | None = None,
    until: Scalar | float = TIME_LIMIT,
) -> End:
    """Integrate from touch to end. Differentiable in forward mode.

    Args:
        until: time at which it is given up [s]; 0 for what is not to be integrated.
        solver: one that `diffrax_solvers.usable_solver` has completed; None for the
            package's method.
    """
    arguments: dict[str, Any] = diffrax_arguments(problem, vector, solver)
    arguments["t1"] = until
    solution = diffrax.diffeqsolve(**arguments)
    times: Any = solution.ts
    event = solution.result == diffrax.RESULTS.event_occurred
    return end_of(
        problem,
        jax.tree.map(lambda x: x[0], solution.ys),
        times[0],
        event,
        event | (solution.result == diffrax.RESULTS.successful),
        solution.stats["num_accepted_steps"],
        solution.stats["num_rejected_steps"],
    )


def end_of(
    problem: Problem, state: SolverState, time, event, finished, accepted, rejected
) -> End:
    """Make the end of an impact from the last state of its integration.

    The event's time takes one Newton correction, which carries its derivative. Where
    the step that met the event could not land on it, or its margin fades to zero, the
    correction would be a leap, back in time even: there its value is left out. What
    ends at the limit of time ends there, however its steps move.
    """
    margins = jnp.stack(state.fold.watched.margins)
    least = jnp.argmin(margins, axis=0)
    margin, slope = (
        jnp.take_along_axis(values, least[None], axis=0)[0]
        for values in (margins, jnp.stack(state.fold.watched_rate.margins))
    )
    falls = event & (slope * time < -negligible_margin(problem.tolerance))
    correction = jnp.where(falls, margin / jnp.where(falls, slope, 1.0), 0.0)
    is_leap = jnp.abs(correction) > LARGEST_CORRECTION * time
    correction = correction - jnp.where(is_leap, jax.lax.stop_gradient(correction), 0.0)
    correction = jnp.where(event, correction, state.fold.moved)
    vector = state.vector - correction * state.fold.rates
    return End(
        vector=vector,
        time=jax.lax.stop_gradient(time) + state.fold.moved - correction,
        fold=_moved_to_the_end(problem, state.fold, time, correction, vector),
        margins=problem.margins(vector, state.fold.largest_force),
        event=event,
        finished=finished & jnp.all(jnp.isfinite(vector)),
        steps=accepted,
        rejected=rejected,
    )

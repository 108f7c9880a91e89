"""Many impacts integrated side by side.

Every array has the impacts, "lanes", on its last axis, so that each operation of the
laws runs over contiguous memory. Steps, their control and the landing on events are
those of `integration`; lanes that have ended stand still. What this saves against
`jax.vmap` of a single integration is memory traffic: the unknowns are rows here, and
columns there.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from .._types import Scalar
from ..impact.dynamics import initial_motion
from ..impact.events import TIME_LIMIT, closing_velocity
from ..impact.problem import Problem, is_in_range, pose
from ..impact.results import History, history_at
from .accumulators import LastStep, add_work, no_step, start_fold
from .event_location import LandingState, negligible_margin
from .rosenbrock import ORDER, per_width
from .single import (
    LARGEST_CORRECTION,
    TERMS,
    End,
    SolverState,
    advance,
    end_of,
    step_size_controller,
)

LaneScalars = Float[Array, " lanes"]


class Lanes(NamedTuple):
    """State of impacts being integrated side by side."""

    problem: Problem
    state: SolverState
    time: LaneScalars
    until: LaneScalars
    """End of the step that is tried next [s]."""
    control: LandingState
    event: Bool[Array, " lanes"]
    """True where a margin has come to zero, or nothing is to be integrated: the block
    is separating, or a value is out of its range."""
    accepted: Int[Array, " lanes"]
    rejected: Int[Array, " lanes"]

    @property
    def going(self) -> Bool[Array, " lanes"]:
        """Lanes that have not come to an end. A lane whose step has become shorter than
        the rounding of time has been given up."""
        return (
            ~self.event
            & (self.time < TIME_LIMIT)
            & (self.until > self.time)
            & (self.accepted + self.rejected < self.problem.max_steps)
        )


def start_lanes(assembly, scenes, tolerance, floor, sampled: bool = False) -> Lanes:
    """Make lanes at the start of their impacts, which can be `sampled` on the way."""

    def of_scene(scene):
        problem, vector = pose(scene, assembly, tolerance, floor)
        fold = start_fold(problem, vector)
        last = no_step(vector, fold) if sampled else None
        state = SolverState(vector, fold, last)
        start = jnp.zeros_like(problem.force_scale)
        none: Any = None  # the controller chooses the width, and needs no rates
        until, control = step_size_controller().init(
            TERMS, start, TIME_LIMIT, state, none, problem, none, ORDER
        )
        still = jnp.zeros((), int)
        separating = closing_velocity(problem.ground, initial_motion(scene)) <= 0.0
        return Lanes(
            problem,
            state,
            start,
            until,
            control,
            separating | ~is_in_range(scene),
            still,
            still,
        )

    return jax.vmap(of_scene, out_axes=-1)(scenes)


def step_lanes(lanes: Lanes) -> Lanes:
    """Try one step in every lane that is going."""
    going = lanes.going
    controller = step_size_controller()

    def control(time, until, before, after, problem, errors, controller_state):
        keep, time, until, _, controller_state, _ = controller.adapt_step_size(
            time, until, before, after, problem, errors, ORDER, controller_state
        )
        return keep, time, until, controller_state

    after, errors = advance(
        lanes.problem, lanes.state, lanes.time, lanes.until - lanes.time
    )
    keep, time, until, controller_state = jax.lax.stop_gradient(
        jax.vmap(control, in_axes=-1, out_axes=-1)(
            *jax.lax.stop_gradient(
                (
                    lanes.time,
                    lanes.until,
                    lanes.state._replace(last=None),
                    after._replace(last=None),
                    lanes.problem,
                    errors,
                    lanes.control,
                )
            )
        )
    )

    def where(condition, new, old):
        return jax.tree.map(lambda n, o: jnp.where(condition, n, o), new, old)

    state = where(going & keep, after, lanes.state)
    return Lanes(
        problem=lanes.problem,
        state=state,
        time=jnp.where(going, time, lanes.time),
        until=jnp.where(going, jnp.minimum(until, TIME_LIMIT), lanes.until),
        control=where(going, controller_state, lanes.control),
        event=lanes.event
        | (going & (state.fold.margin <= negligible_margin(lanes.problem.tolerance))),
        accepted=lanes.accepted + (going & keep),
        rejected=lanes.rejected + (going & ~keep),
    )


def accepted_step(lanes: Lanes) -> Lanes:
    """Take the step that is tried next, as one that is accepted, in every lane. What
    derivatives do not see stays as it is: the times of steps, and their control."""
    after, _ = advance(lanes.problem, lanes.state, lanes.time, lanes.until - lanes.time)
    return lanes._replace(state=after)


def sample_lanes(lanes: Lanes, times: LaneScalars) -> History:
    """Return the histories of the impacts at times in their last steps."""
    assert lanes.state.last is not None, "lanes that are sampled"
    return jax.vmap(sample, in_axes=(-1, -1, 0))(lanes.problem, lanes.state.last, times)


def march_and_sample(lanes: Lanes, times: Float[Array, " times"]):
    """Step a single lane to its end and sample it at times; NaN after its end."""

    def samples_of(lanes, time):
        return jax.tree.map(lambda x: x[0], sample_lanes(lanes, time[None]))

    def body(carry):
        lanes, samples = carry
        lanes = step_lanes(lanes)
        now = jax.vmap(samples_of, in_axes=(None, 0))(lanes, times)
        # After the end by no more than the time of the end is corrected
        late = jnp.where(lanes.going, 0.0, LARGEST_CORRECTION * lanes.time)
        due = (times <= lanes.time + late) & jnp.isnan(samples.time)
        return lanes, jax.tree.map(lambda x, y: jnp.where(due, x, y), now, samples)

    first = jax.vmap(samples_of, in_axes=(None, 0))(lanes, times)
    nothing = jax.tree.map(lambda x: jnp.full_like(x, jnp.nan), first)
    return jax.lax.while_loop(
        lambda carry: jnp.any(carry[0].going), body, (lanes, nothing)
    )


def end_lanes(lanes: Lanes) -> End:
    """Return the ends of lanes none of which is going."""

    def of_lane(lanes: Lanes) -> End:
        return end_of(
            lanes.problem,
            lanes.state,
            lanes.time,
            lanes.event,
            lanes.event | (lanes.time >= TIME_LIMIT),
            lanes.accepted,
            lanes.rejected,
        )

    return jax.vmap(of_lane, in_axes=-1)(lanes)


def sample(problem: Problem, last: LastStep, time: Scalar) -> History:
    """Return the history of an impact at a time in its last step.

    Taken on the branch of the step: the interpolant may be on the other side of a
    switch, by its error, where the step has landed on it.
    """
    since = time - last.start
    vector = last.step.evaluate(since)
    work = None
    if problem.ledger:
        part = per_width(since, last.step.t1)
        work = add_work(problem, last.work, last.step, part, last.branch)
    return history_at(problem, time, vector, work, last.branch)

"""Accumulators over the steps: peaks, and the work of the energy ledger.

It costs the step size control nothing, and no history need be kept.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .._safe import safe_sqrt
from .._types import Scalar
from ..impact.dynamics import ARM, Work
from ..impact.events import SWITCHED_OFF, Margins, at_start, branch_of
from ..impact.problem import Observed, Problem, Watched
from ..laws import Branch
from .diffrax_solvers import SolverStep
from .rosenbrock import DenseOutput, per_width

Step = DenseOutput | SolverStep
"""Interpolant of a step, by the package's method or another solver of diffrax."""

INITIAL_MARGIN = 1e-6
"""Margin that stands for those before the first step, whose true values may be less
than what counts as zero."""
PROGRESS = 0.01
"""Width over time reached above which a step at the onset is progress."""
ONSET = 1e-3
"""Duration of the onset, over the time in which the block moves by its size."""
TRANSVERSAL = 1e-3
"""Change of a switching function in the time reached, from which a step's end moves
with its switch; where one is only grazed, the instant is uncertain."""


class Fold(NamedTuple):
    """Quantities accumulated over the accepted steps."""

    peaks: Observed
    """Largest values; normal forces count from the step on in which the foundation has
    come to `Problem.settled_sinking`, if it does."""
    peak_times: Observed
    largest_force: Scalar
    """Largest normal force, that of the start included [N]: the scale of margins and of
    errors."""
    work: Work
    watched: Watched
    watched_rate: Watched
    """Rates of the watched quantities, on the branch that led here."""
    rates: Float[Array, " n"]
    """Rates of the unknowns at the end of the last step's interpolant. With dashpots
    the errors of forces are so large beside what relaxes that the equations give no
    rates for them."""
    turned: Scalar
    """1 where the next step takes another branch, on which the rates are others; else
    0. They are the same at the switch itself; but slip relaxes in a microsecond, so
    that its rate is off by much where the switch has been missed by little."""
    moved: Scalar
    """Zero, with the derivative of the times of steps. Widths are constants, but the
    step that ends on a switch ends sooner where the switch comes sooner, and with it
    all that follow [s]."""
    stalled: Scalar | None
    """Steps without progress at the onset, with dashpots; else None."""

    @property
    def margin(self) -> Scalar:
        """The least of the margins to an end."""
        return jnp.min(jnp.stack(self.watched.margins), axis=0)

    def rate_at_start(self, start, start_rate, end, end_rate, width):
        """Compute the rate at the start of the next step, on its branch: the one known,
        or after a switch that of the parabola through what is known."""
        rise = per_width(end - start, width)
        return jnp.where(self.turned > 0.0, 2.0 * rise - end_rate, start_rate)


def cut(fold: Fold, by: Callable = jax.lax.stop_gradient) -> Fold:
    """Cut from differentiation what no derivative of a result needs.

    Widths of steps are constants. Corrections of the times of switches and of the end
    are zero in value: of their quotients the numerators alone have derivatives.

    Args:
        by: what is done to each of these quantities.
    """
    return fold._replace(
        watched=fold.watched._replace(switches=by(fold.watched.switches)),
        watched_rate=fold.watched_rate._replace(
            margins=by(fold.watched_rate.margins),
            switches=by(fold.watched_rate.switches),
        ),
        rates=by(fold.rates),
        turned=by(fold.turned),
        largest_force=by(fold.largest_force),
        stalled=by(fold.stalled),
    )


GAUSS_NODES = (0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15))
GAUSS_WEIGHTS = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


def start_fold(problem: Problem, vector) -> Fold:
    """Make the accumulators before the first step: they hold the side of the switches
    alone."""
    zero = jnp.zeros_like(vector[0])
    nothing = Observed(*[zero] * len(Observed._fields))
    watched = problem.watch(list(vector), zero)
    still = jax.tree.map(jnp.zeros_like, watched)._replace(observed=nothing)
    fold = Fold(
        peaks=nothing._replace(normal_force=watched.observed.normal_force),
        peak_times=nothing,
        largest_force=watched.observed.normal_force,
        work=Work(*[zero] * len(Work._fields)),
        watched=Watched(
            nothing,
            Margins(*[zero + INITIAL_MARGIN] * len(Margins._fields)),
            at_start(problem.ground, watched.switches),
            watched.arm_power,
        ),
        watched_rate=still,
        rates=jnp.zeros_like(vector),
        turned=zero,
        moved=zero,
        stalled=zero if problem.model.damped else None,
    )
    return cut(fold)


ABOVE_ENDS = 1.03
"""Factor by which the normal force with dashpots may be larger within a step than at
its ends: where it jumps, its rate after that is none of the step. A smooth one is
larger by 0.3 % where a contact takes twenty steps, as few as there are."""


def fold_step(problem: Problem, fold: Fold, time, step: Step, branch: Branch) -> Fold:
    """Update the accumulators by an accepted step."""
    width = step.t1 - step.t0
    rates = step.rate_at_end()
    watched, watched_rate = problem.watch_with_rate(
        step.y1, rates, fold.largest_force, branch
    )
    sides = _stacked(branch), _stacked(branch_of(watched.switches))
    is_on = jnp.abs(_stacked(watched.switches)) > SWITCHED_OFF
    turns = (sides[0] != sides[1]) & is_on
    turned = jnp.any(turns, axis=0)
    late = _time_since_switch(watched, watched_rate, turns, time + width)
    peaks, times, largest_force = [], [], fold.largest_force
    settled = problem.settled_sinking
    for name in Observed._fields:
        start, start_rate, end, end_rate = (
            getattr(of.observed, name)
            for of in (fold.watched, fold.watched_rate, watched, watched_rate)
        )
        start_rate = fold.rate_at_start(start, start_rate, end, end_rate, width)
        value, place = peak_of_cubic(start, start_rate, end, end_rate, width)
        if name in ("tangential_force", "moment"):
            lowest, lowest_place = peak_of_cubic(
                -start, -start_rate, -end, -end_rate, width
            )
            place = jnp.where(lowest > value, lowest_place, place)
            value = jnp.maximum(value, lowest)
            end_rate = jnp.sign(end) * end_rate
        if problem.model.damped and name == "normal_force":
            ends = jnp.maximum(start, end)
            beyond = value > ABOVE_ENDS * ends
            place = jnp.where(beyond, jnp.where(end >= start, 1.0, 0.0), place)
            value = jnp.where(beyond, ends, value)
        late_here = jnp.where(place < 1.0, 0.0, late)
        value = earlier(value, end_rate, late_here)
        when = fold.moved + time + place * width - late_here
        before, before_when = getattr(fold.peaks, name), getattr(fold.peak_times, name)
        higher = value > before
        if name == "normal_force":
            largest_force = jnp.where(value > largest_force, value, largest_force)
            sinking = peaks[Observed._fields.index("sinking")]
            settles = (fold.peaks.sinking <= settled) & (sinking > settled)
            higher = higher | settles
        peaks.append(jnp.where(higher, value, before))
        times.append(jnp.where(higher, when, before_when))
    work = fold.work
    if problem.ledger is True:
        work = add_work(problem, work, step, 1.0, branch)
        power = problem.power(step.y1, rates, branch)
        work = jax.tree.map(lambda done, rate: earlier(done, rate, late), work, power)
    elif problem.ledger == ARM:
        arm = _integral_of_arm_power(fold, watched, watched_rate, width)
        arm = earlier(work.arm + arm, watched.arm_power, late)
        work = work._replace(arm=arm)
    watched = jax.tree.map(
        lambda value, rate: earlier(value, rate, late), watched, watched_rate
    )
    fold = Fold(
        peaks=Observed(*peaks),
        peak_times=Observed(*times),
        largest_force=largest_force,
        work=work,
        watched=watched,
        watched_rate=watched_rate,
        rates=rates,
        turned=jnp.where(turned, 1.0, 0.0),
        moved=fold.moved - late,
        stalled=_stalled_steps(problem, fold, time, width),
    )
    return cut(fold)


def earlier(value: Scalar, rate: Scalar, late: Scalar) -> Scalar:
    """Return a value as of a time by `late` earlier, which is zero with a
    derivative."""
    return value - only_derivative(late * jax.lax.stop_gradient(rate))


def _time_since_switch(watched: Watched, watched_rate: Watched, turns, time) -> Scalar:
    """Compute how long a step that ends on a switch has gone on beyond it: no time, but
    with the derivative of that time.

    Args:
        turns: True for each switch that the step has met.
        time: that at the end of the step [s].
    """
    values, rates = _stacked(watched.switches), _stacked(watched_rate.switches)
    first = jnp.argmin(jnp.where(turns, jnp.abs(values), jnp.inf), axis=0)
    value, rate = (
        jnp.take_along_axis(x, first[None], axis=0)[0] for x in (values, rates)
    )
    rate = jax.lax.stop_gradient(rate)
    moves = jnp.any(turns, axis=0) & (jnp.abs(rate) * time > TRANSVERSAL)
    return only_derivative(jnp.where(moves, value / jnp.where(moves, rate, 1.0), 0.0))


def add_work(
    problem: Problem, work: Work, step: Step, part: Scalar | float, branch
) -> Work:
    """Add the work in a part of a step to that up to its start."""
    width = part * (step.t1 - step.t0)

    # Jitted, so that machine code has it as a function: see `rodas5p_step`.
    @jax.jit
    def power_at(node):
        vector = step.evaluate(step.t0 + node * width)
        return problem.power(vector, step.rate(part * node), branch)

    powers = jax.lax.map(power_at, jnp.asarray(GAUSS_NODES))
    return jax.tree.map(
        lambda total, power: total + width * jnp.dot(jnp.asarray(GAUSS_WEIGHTS), power),
        work,
        powers,
    )


def _integral_of_arm_power(
    fold: Fold, watched: Watched, watched_rate: Watched, width: Scalar
) -> Scalar:
    """Integrate the cubic through the powers and their rates at the ends of a step."""
    ends = (fold.watched, fold.watched_rate, watched, watched_rate)
    powers: Any = [of.arm_power for of in ends]
    start, start_rate, end, end_rate = powers
    start_rate = fold.rate_at_start(start, start_rate, end, end_rate, width)
    return width * (0.5 * (start + end) + width / 12.0 * (start_rate - end_rate))


def _stacked(values):
    return jnp.stack(jax.tree.leaves(values))


def _stalled_steps(problem: Problem, fold: Fold, time, width) -> Scalar | None:
    """Return the steps without progress at the onset, one step later."""
    if fold.stalled is None:
        return None
    progresses = (width > PROGRESS * time) | (time > ONSET * problem.passing_time)
    return jnp.where(progresses, 0.0, fold.stalled + 1.0)


@jax.custom_jvp
def only_derivative(x: Scalar) -> Scalar:
    """Return zero with the derivative of x; values cost nothing where no derivative is
    asked for."""
    return jnp.zeros_like(x)


@only_derivative.defjvp
def _only_derivative_jvp(primals, tangents):
    return jnp.zeros_like(primals[0]), tangents[0]


def hermite_cubic(start, start_rate, end, end_rate, width):
    """Compute the coefficients a, b, c of the cubic `start + a s + b s^2 + c s^3`, s
    from 0 to 1, through both ends' values and rates."""
    a = width * start_rate
    rise = end - start
    b = 3.0 * rise - 2.0 * a - width * end_rate
    c = a + width * end_rate - 2.0 * rise
    return a, b, c


def peak_of_cubic(start, start_rate, end, end_rate, width):
    """Compute the largest value on a step of the cubic through both ends' values and
    rates.

    Returns:
        The value and where it is reached, as a part of the step, which moves where it
        lies within the step. Of equal candidates the end counts. Finite, with finite
        gradients, for every input: flat steps and steps of no width give the end's
        value.
    """
    a, b, c = hermite_cubic(start, start_rate, end, end_rate, width)
    # derivative a + 2 b s + 3 c s^2; its maximum root in the form without cancellation
    root = safe_sqrt(b * b - 3.0 * a * c)
    divisor = -b + root
    usable = jnp.abs(divisor) > 1e-300
    s = jnp.where(usable, a / jnp.where(usable, divisor, 1.0), 1.0)
    # The place of a maximum has no first-order effect on its value.
    s = jax.lax.stop_gradient(jnp.clip(s, 0.0, 1.0))
    inside = start + s * (a + s * (b + s * c))
    # It moves as a Newton step on the derivative does, which is zero there.
    derivative = a + s * (2.0 * b + 3.0 * c * s)
    bend = jax.lax.stop_gradient(2.0 * root)
    moves = usable & (s > 0.0) & (s < 1.0) & (bend > 0.0)
    change = jnp.where(moves, derivative / jnp.where(moves, bend, 1.0), 0.0)
    place = s + only_derivative(change)
    return jnp.where(inside > end, inside, end), jnp.where(inside > end, place, 1.0)


class LastStep(NamedTuple):
    """The last step that was accepted."""

    start: Scalar
    """Time at its start [s]."""
    step: Step
    """Interpolant, by the time since then."""
    branch: Branch
    work: Work
    """Work up to its start [J]."""


def no_step(vector: Float[Array, " n"], fold: Fold) -> LastStep:
    """Make what stands for the last step before the first: one of no width."""
    zero = jnp.zeros_like(vector[0])
    bend = jnp.zeros((3, *vector.shape))
    step = DenseOutput(
        zero, zero, vector, vector, jnp.zeros_like(vector), bend, jnp.sum(bend, axis=0)
    )
    return LastStep(zero, step, branch_of(fold.watched.switches), fold.work)

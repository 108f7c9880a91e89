"""One impact integrated from touch to end: diffrax, Rodas5P and the end events.

The solver's state is one vector, the fields of `Motion`. What is wanted
besides the end state (largest force and depth, energy ledger) is folded over the accepted
steps by `FoldingSolver`, so that it costs the step size control nothing and no history
need be kept.

diffrax watches one margin, the least of all, and stops when it has come to zero. The
root is found by the step size control: a step that ends beyond zero is rejected and
taken again, shorter, with the width at which the cubic through margin and slope at both
ends is zero, until a step lands on the event. So state and time at the end are as
accurate as the steps themselves, not as their interpolant, and no second copy of the
step is compiled. Step widths are cut from differentiation; a last Newton correction,
nil in value, carries the derivative of the event's time.
"""

from typing import ClassVar, NamedTuple

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Float

from .accuracy import MAX_STEPS, Accuracy
from .dynamics import (
    Contact,
    Ground,
    Motion,
    Work,
    contact,
    initial_motion,
    kinetic_energy,
    motion_rate,
    prepare,
    work_rate,
)
from .laws import Laws
from .outcomes import TIME_LIMIT, Margins, end_margins
from .rosenbrock import DenseOutput, dense_output, rodas5p_step
from .safe import safe_sqrt
from .scene import Scene

Scalar = Float[Array, ""]

# Which rate (row) may depend on which unknown (column), in the order of Motion.
_STRUCTURE = """
    penetration         . . n . . . . . .
    rotation            . . . . w . . . .
    normal_velocity     x x . . . N . . .
    tangential_velocity x x . . . . T . .
    angular_velocity    x x . . . N T M .
    elastic_normal      x x n . w N T M c
    elastic_tangential  x x . t w N T M c
    elastic_rotation    x x . . w N T M c
    hardening           x x . . . N T M c
"""
STRUCTURE = np.array(
    [
        [mark != "." for mark in line.split()[1:]]
        for line in _STRUCTURE.split("\n")[1:-1]
    ]
)


def jacobian_pattern(damped: bool) -> tuple[tuple[bool, ...], ...]:
    """Where the Jacobian may differ from zero, as `Rodas5P` wants it."""
    pattern = STRUCTURE.copy()
    if damped:  # dashpots make the forces depend on everything
        pattern[2:] = True
    return tuple(map(tuple, pattern.tolist()))


class Observed(NamedTuple):
    """Quantities whose largest value over the impact is wanted."""

    penetration: Scalar  # u_n [m]
    sinking: Scalar  # u_D [m]
    normal_force: Scalar  # N [N]
    tangential_force: Scalar  # |T| [N]
    moment: Scalar  # |M| [N m]


class Watched(NamedTuple):
    """What is worked out at the end of every step, T and M with their signs."""

    observed: Observed
    margin: Scalar
    """The least of the margins to an end."""


class Fold(NamedTuple):
    """What is gathered over the accepted steps."""

    peaks: Observed
    peak_times: Observed
    work: Work | None
    watched: Watched
    watched_rate: Watched


class Course(NamedTuple):
    """State of `FoldingSolver`."""

    vector: Float[Array, " n"]
    fold: Fold


class Problem(eqx.Module):
    """The initial value problem of one impact."""

    ground: Ground
    scale: Float[Array, " n"]
    """Magnitude of each unknown over the impact."""
    force_scale: Scalar
    """Force of an elastic impact on a footing of the block's size [N]."""
    incoming_energy: Scalar
    tolerance: Scalar
    floor: Scalar
    """Of the error control; see `Accuracy`."""
    laws: Laws = eqx.field(static=True)
    damped: bool = eqx.field(static=True)
    ledger: bool = eqx.field(static=True)
    max_steps: int = eqx.field(static=True)

    def contact(self, rows) -> tuple[Motion, Contact]:
        """Named state and contact, from the rows of the state vector."""
        motion = Motion(*(rows[i] for i in range(len(Motion._fields))))
        return motion, contact(self.ground, self.laws, motion, damped=self.damped)

    def rate(self, rows) -> list[Scalar]:
        """Right-hand side, rows to rows."""
        return list(motion_rate(self.ground, *self.contact(rows)))

    def watch(self, rows, largest_force) -> Watched:
        """Quantities whose peaks are wanted, and the least margin, by the largest normal
        force up to now."""
        motion, now = self.contact(rows)
        observed = Observed(
            motion.penetration,
            now.foundation.sinking,
            now.forces.normal,
            now.forces.tangential,
            now.forces.moment,
        )
        margins = self._margins(motion, now, largest_force)
        return Watched(observed, jnp.min(jnp.stack(margins)))

    def watch_with_rate(self, vector, largest_force) -> tuple[Watched, Watched]:
        """Watched quantities and their rates of change along the motion."""
        rows = list(vector)
        return jax.jvp(
            lambda rows: self.watch(rows, largest_force), (rows,), (self.rate(rows),)
        )

    def power(self, vector) -> Work:
        """Power of the ledger's items [W]."""
        motion, now = self.contact(vector)
        return work_rate(self.ground, self.laws, motion, now)

    def margins(self, vector, largest_force) -> Margins:
        """Distances to the ends of the impact."""
        return self._margins(*self.contact(vector), largest_force)

    def _margins(self, motion, now, largest_force) -> Margins:
        reached = jnp.maximum(largest_force, now.forces.normal)
        scale = jnp.maximum(reached, 1e-15 * self.force_scale)
        return end_margins(
            self.ground,
            motion,
            now,
            jax.lax.stop_gradient(scale),
            self.scale[2],
            self.incoming_energy,
        )


def pose(
    scene: Scene,
    laws: Laws,
    *,
    damped: bool,
    ledger: bool,
    accuracy: Accuracy,
    max_steps: int = MAX_STEPS,
) -> tuple[Problem, Float[Array, " n"]]:
    """The initial value problem of a scene, and its initial state."""
    ground = prepare(scene, laws)
    motion = initial_motion(scene)
    radius = ground.axes.minor
    speed = scene.impact.speed
    # Displacement of the springs in an elastic impact on a footing of the block's size
    stiffness = laws.elastic_stiffness(
        2.0 * radius, 2.0 * radius, ground.unit_weight_normal, scene.soil
    )
    elastic = speed * jnp.sqrt(ground.mass / stiffness.normal)
    one = jnp.ones_like(radius)
    spin = speed / radius
    scale = [radius, one, speed, speed, spin, elastic, elastic, elastic / radius, one]
    force_scale = stiffness.normal * elastic
    problem = Problem(
        ground=ground,
        scale=jax.lax.stop_gradient(jnp.stack(scale)),
        force_scale=jax.lax.stop_gradient(force_scale),
        incoming_energy=kinetic_energy(ground, motion),
        laws=laws,
        damped=damped,
        ledger=ledger,
        max_steps=max_steps,
        tolerance=jnp.asarray(accuracy.tolerance),
        floor=jnp.asarray(accuracy.floor),
    )
    return problem, jnp.stack(motion)


def hermite_cubic(start, start_rate, end, end_rate, width):
    """Coefficients a, b, c of the cubic `start + a s + b s^2 + c s^3`, s from 0 to 1,
    through both ends' values and rates."""
    a = width * start_rate
    rise = end - start
    b = 3.0 * rise - 2.0 * a - width * end_rate
    c = a + width * end_rate - 2.0 * rise
    return a, b, c


def peak_of_cubic(start, start_rate, end, end_rate, width):
    """Largest value on a step of the cubic through both ends' values and rates.

    Returns:
        The value and where it is reached, as a part of the step. Of equal candidates
        the end counts. Finite, with finite gradients, for every input: flat steps and
        steps of no width give the end's value.
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
    return jnp.where(inside > end, inside, end), jnp.where(inside > end, s, 1.0)


GAUSS_NODES = (0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15))
GAUSS_WEIGHTS = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


def start_fold(vector) -> Fold:
    """What is gathered before the first step, of which nothing counts."""
    zero = jnp.zeros_like(vector[0])
    observed = Observed(*[zero] * len(Observed._fields))
    return Fold(
        peaks=observed,
        peak_times=observed,
        work=Work(*[zero] * len(Work._fields)),
        watched=Watched(observed, zero + INITIAL_MARGIN),
        watched_rate=Watched(observed, zero),
    )


def fold_step(problem: Problem, fold: Fold, time, step: DenseOutput) -> Fold:
    """What is gathered, one accepted step later."""
    width = step.t1 - step.t0
    watched, rate = problem.watch_with_rate(step.y1, fold.peaks.normal_force)
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
            return problem.power(step.evaluate(step.t0 + node * width))

        powers = jax.lax.map(power_at, nodes)
        work = jax.tree.map(
            lambda total, power: (
                total + width * jnp.dot(jnp.asarray(GAUSS_WEIGHTS), power)
            ),
            work,
            powers,
        )
    return Fold(Observed(*peaks), Observed(*times), work, watched, rate)


@jax.jit
def advance(problem: Problem, course: Course, time: Scalar, width: Scalar):
    """One step: the course after it, and the error in units of what is allowed. (`jit`
    keeps diffrax from tracing it four times over.)"""
    vector, error, stages = rodas5p_step(
        problem.rate, course.vector, width, jacobian_pattern(problem.damped)
    )
    size = jnp.maximum(jnp.abs(course.vector), jnp.abs(vector))
    allowed = problem.tolerance * (size + problem.floor * problem.scale)
    step = DenseOutput(
        t0=jnp.zeros_like(width),
        t1=width,
        **dense_output(course.vector, vector, stages),
    )
    after = Course(vector, fold_step(problem, course.fold, time, step))
    return after, jax.lax.stop_gradient(error / allowed)


class FoldingSolver(diffrax.AbstractAdaptiveSolver):
    """Rodas5P on the state vector, folding what is wanted over the steps.

    The error it returns is in units of what is allowed, so the step size controller
    takes a tolerance of one.
    """

    term_structure: ClassVar = diffrax.ODETerm
    # Saved are steps and the end, and the event is landed on: nothing interpolates.
    interpolation_cls: ClassVar = diffrax.LocalLinearInterpolation

    def order(self, terms):
        return 5

    def init(self, terms, t0, t1, y0, args):
        return None

    def func(self, terms, t0, y0, args):
        return terms.vf(t0, y0, args)

    def step(self, terms, t0, t1, y0, args, solver_state, made_jump):
        after, error = advance(args, y0, t0, terms.contr(t0, t1))
        errors = jax.tree.map(jnp.zeros_like, after)._replace(vector=error)
        info = dict(y0=y0, y1=after)
        return after, errors, info, solver_state, diffrax.RESULTS.successful


INITIAL_MARGIN = 1e-6
"""Margin that stands for the one before the first step, whose true value may be less
than `LANDING`."""
LANDING = 1e-10
"""A margin within this counts as zero."""


def root_of_cubic(start, start_rate, end, end_rate, width):
    """Where the cubic through both ends' values and rates is zero, as a part of width.

    For start > 0 > end. Five Newton steps kept inside the bracket; where they have not
    converged the landing takes one more step.
    """
    a, b, c = hermite_cubic(start, start_rate, end, end_rate, width)
    low, high = jnp.zeros_like(a), jnp.ones_like(a)
    s = start / (start - end)
    for _ in range(5):
        value = start + s * (a + s * (b + s * c))
        slope = a + s * (2.0 * b + s * 3.0 * c)
        low, high = jnp.where(value > 0, s, low), jnp.where(value > 0, high, s)
        newton = s - value / jnp.where(slope < 0.0, slope, -1.0)
        inside = (slope < 0.0) & (newton > low) & (newton < high)
        s = jnp.where(inside, newton, 0.5 * (low + high))
    return s


class LandingController(diffrax.AbstractStepSizeController):
    """Step size control that lands on the event.

    Wraps another controller; a step that ends beyond the event is rejected and taken
    again up to the root of the margin.
    """

    inner: diffrax.PIDController

    def wrap(self, direction):
        return LandingController(self.inner.wrap(direction))

    def init(self, terms, t0, t1, y0, dt0, args, func, error_order):
        return self.inner.init(terms, t0, t1, y0, dt0, args, func, error_order)

    def adapt_step_size(
        self, t0, t1, y0, y1_candidate, args, y_error, error_order, controller_state
    ):
        keep, next_t0, next_t1, made_jump, state, result = self.inner.adapt_step_size(
            t0, t1, y0, y1_candidate, args, y_error, error_order, controller_state
        )
        before, after = jax.lax.stop_gradient((y0.fold, y1_candidate.fold))
        beyond = keep & (after.watched.margin < -LANDING)
        width = t1 - t0
        part = root_of_cubic(
            before.watched.margin,
            before.watched_rate.margin,
            after.watched.margin,
            after.watched_rate.margin,
            width,
        )
        state = jax.tree.map(
            lambda old, new: jnp.where(beyond, old, new), controller_state, state
        )
        return (
            keep & ~beyond,
            jnp.where(beyond, t0, next_t0),
            jnp.where(beyond, t0 + part * width, next_t1),
            made_jump,
            state,
            result,
        )


def error_norm(course: Course) -> Scalar:
    """Root mean square of the state's errors."""
    return optx.rms_norm(course.vector)


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


def diffrax_arguments(problem: Problem, vector: Float[Array, " n"]) -> dict:
    """What `diffrax.diffeqsolve` is called with, but for what it saves."""
    radius, speed = problem.scale[0], problem.scale[2]
    return dict(
        terms=diffrax.ODETerm(lambda t, y, args: y),
        solver=FoldingSolver(),
        t0=0.0,
        t1=TIME_LIMIT,
        dt0=1e-12 * radius / speed,
        y0=Course(vector, start_fold(vector)),
        args=problem,
        stepsize_controller=LandingController(
            diffrax.PIDController(
                rtol=0.0, atol=1.0, norm=error_norm, pcoeff=0.2, icoeff=0.4
            )
        ),
        event=diffrax.Event(
            lambda t, y, args, **kwargs: y.fold.watched.margin <= LANDING
        ),
        adjoint=diffrax.ForwardMode(),
        max_steps=problem.max_steps,
        throw=False,
    )


def _peaks_at_the_end(problem: Problem, fold: Fold, time: Scalar, vector) -> Fold:
    """Peaks reached as the impact ends, taken there: they move with the event's time."""
    watched = problem.watch(list(vector), fold.peaks.normal_force)
    peaks = [
        jnp.where(reached >= time, jnp.abs(value), peak)
        for peak, reached, value in zip(
            fold.peaks, fold.peak_times, watched.observed, strict=True
        )
    ]
    return fold._replace(peaks=Observed(*peaks))


def integrate(problem: Problem, vector: Float[Array, " n"]) -> End:
    """Integrate from touch to end.

    Differentiable in forward mode. Under `vmap` lanes run in lockstep to the slowest.
    """
    solution = diffrax.diffeqsolve(**diffrax_arguments(problem, vector))
    end = jax.tree.map(lambda x: x[0], solution.ys)
    event = solution.result == diffrax.RESULTS.event_occurred
    finished = event | (solution.result == diffrax.RESULTS.successful)

    rate = jnp.stack(problem.rate(list(end.vector)))
    margin, slope = end.fold.watched.margin, end.fold.watched_rate.margin
    falls = event & (slope < 0.0)
    correction = jnp.where(falls, margin / jnp.where(falls, slope, 1.0), 0.0)
    vector = end.vector - correction * rate
    return End(
        vector=vector,
        time=jax.lax.stop_gradient(solution.ts[0]) - correction,
        fold=_peaks_at_the_end(problem, end.fold, solution.ts[0], vector),
        margins=problem.margins(vector, end.fold.peaks.normal_force),
        event=event,
        finished=finished & jnp.all(jnp.isfinite(vector)),
        steps=solution.stats["num_accepted_steps"],
        rejected=solution.stats["num_rejected_steps"],
    )

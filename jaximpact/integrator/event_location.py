"""Step size control that lands on the end of the impact and on the switches of the
laws.

A step that runs past one of them is rejected and taken again, shorter, with the width
at which the cubic through value and slope at both ends is zero, until a step lands
there. So state and time are as accurate as the steps themselves, not as their
interpolant, and no second copy of the step is compiled. Most ends and switches are
foreseen: the next step is made to stop where the parabola of the last one is zero. With
that, and with widths that shrink as the end of the contact comes near, an oblique
impact takes a seventh fewer steps at `fast`, and half as many are rejected.
"""

from typing import Any, NamedTuple

import diffrax
import jax
import jax.numpy as jnp
from jaxtyping import Array

from .._safe import TINY
from .._types import Flag, Scalar
from ..impact.dynamics import INITIAL_SINKING
from ..impact.events import SWITCHED_OFF, in_force
from ..impact.problem import Problem, Watched
from .accumulators import Fold, hermite_cubic, peak_of_cubic
from .error_control import ErrorControl
from .rosenbrock import per_width

LANDING = 1e-12, 1e-5, 1e-8
"""Magnitude below which a margin counts as zero: the least one, that as a fraction of
the tolerance, and the largest one. Derivatives leave out by how much the end has been
missed."""
ON_SWITCH = 1e-9, 1e-2
"""Magnitude below which a switching function counts as zero: absolute, and as a
fraction of the tolerance. Derivatives leave out by how much a switch has been missed:
with 1e-7 in place of 1e-9 the worst of 1 000 on many soils is off by 2e-3, in place of
4e-5, at `reference`. 1e-9 takes 0.6 % more steps there."""
FIRST_WIDTH = 1e-10
"""Width of the first step over the time in which the block moves by its size."""
SMALLEST_WIDTH = 1e-15
"""Smallest width of a step over the time reached; a few roundings."""
PATIENCE = 1000
"""Tries to land after which as many steps are taken as they are, past switches. With 40
in place of 1000 steps stuck where blocks slip: of 60 000 impacts far out 181 at `fast`
had more than ten times the largest shear force, in place of 34, and 17 at `balanced`,
in place of 4."""
SHORT_PATIENCE = 40
"""The same with dashpots, whose forces may oscillate about a switch where they have no
stable state, and after `MOST_TRIES`."""
MOST_TRIES = 5_000
"""Tries to land in all, after which patience is short: blocks of grams that vibrate on
stiff ground would use up their steps."""
SHORTEST_PART = 0.01
"""Smallest fraction to which a step is cut in one try to land."""
ONSET = INITIAL_SINKING, 0.1
"""Begin and end of the onset, over the time in which the block moves by its size: the
initial compression of the springs is forgotten, and all grows as powers of time."""
LARGEST_GROWTH = 1.3
"""Largest growth of a step at the onset on top of what its error allows."""


def negligible_margin(tolerance: Scalar) -> Scalar:
    """Compute the magnitude below which a margin counts as zero."""
    least, part, largest = LANDING
    return jnp.clip(part * tolerance, least, largest)


class Landing(NamedTuple):
    """Place where a step passes the end or a switch, or the next one is to meet it."""

    passed: Flag
    """True where the step passes an end or a switch."""
    part: Scalar
    """Fraction of the step at which it does."""
    ahead: Scalar
    """Width of the next step that would land, where this one passes none, were the
    margin or the switching function to go on as a parabola [s]; infinite if none is
    coming."""
    left: Scalar
    """Time left to the end by that parabola [s]; infinite if no end is coming."""


class _Courses(NamedTuple):
    """The margins, then the switching functions, over a step: a row for each."""

    start: Array
    start_rate: Array
    end: Array
    """Value at the end; of a margin that rises again its lowest one."""
    end_rate: Array
    share: Array
    """Part of the step at whose end `end` is."""
    counts: Array
    """True where passing zero ends the impact, or switches a law."""
    limit: Array
    """Size of the values that count as zero."""
    ends: int
    """Number of margins, which come first."""


def _courses(
    problem: Problem, before: Fold, after: Fold, width, on_switch: Scalar
) -> _Courses:
    side = [jnp.sign(value) for value in jax.tree.leaves(before.watched.switches)]
    ends = len(before.watched.margins)

    def all_of(watched: Watched):
        values = jax.tree.leaves(watched.switches)
        switches = [s * value for s, value in zip(side, values, strict=True)]
        return jnp.stack([*watched.margins, *switches])

    start, start_rate, end, end_rate = (
        all_of(watched)
        for watched in (
            before.watched,
            before.watched_rate,
            after.watched,
            after.watched_rate,
        )
    )
    start_rate = before.rate_at_start(start, start_rate, end, end_rate, width)
    # Margins only up to their lowest points
    depth, place = peak_of_cubic(
        -start[:ends], -start_rate[:ends], -end[:ends], -end_rate[:ends], width
    )
    lowest_rate = jnp.where(place < 1.0, 0.0, end_rate[:ends])
    share = jnp.concatenate([place, jnp.ones_like(end[ends:])])
    end = jnp.concatenate([-depth, end[ends:]])
    end_rate = jnp.concatenate([lowest_rate, end_rate[ends:]])
    active = in_force(before.watched.switches, problem.ground.soil)
    counts = jnp.concatenate(
        [
            jnp.ones_like(place, bool),
            jnp.stack(jax.tree.leaves(active)) & (start[ends:] > SWITCHED_OFF),
        ]
    )
    limit = jnp.stack(
        [negligible_margin(problem.tolerance)] * ends + [on_switch] * (len(end) - ends)
    )
    return _Courses(start, start_rate, end, end_rate, share, counts, limit, ends)


def first_landing(problem: Problem, before: Fold, after: Fold, width) -> Landing:
    """Find the first end or switch that a step passes or comes to.

    A switch is to be passed by half of what counts as zero, so that the next step
    starts on the far side.

    A margin may go down to the end and rise again within one step: where its cubic
    does, the step is taken as one to the cubic's lowest point. A switch that is passed
    there and back within one step is not seen: the error control resolves oscillations,
    so such an excursion is a small part of one. Each margin has a cubic of its
    own: the least of them is one at the start of a step and another at its end.
    """
    on = jnp.maximum(ON_SWITCH[0], ON_SWITCH[1] * problem.tolerance)
    start, start_rate, end, end_rate, share, counts, limit, ends = _courses(
        problem, before, after, width, on
    )
    beyond = counts & (end < -limit)
    falls = counts & (end < start)
    # The one that a straight line would put first is looked at closely; if it was
    # another, the next try will tell.
    guess = start / jnp.where(falls, start - end, 1.0)
    guess = jnp.where(beyond, share * guess, 1.0 + jnp.abs(guess))
    first = jnp.argmin(jnp.where(falls, guess, jnp.inf), axis=0)
    passed = jnp.any(beyond, axis=0)

    def of_first(values):
        return jnp.take_along_axis(values, first[None], axis=0)[0]

    def of_passed(values, harmless):
        return jnp.where(passed, of_first(values), harmless)

    shift = jnp.where(first < ends, 0.0, 0.5 * on)
    share = of_passed(share, 1.0)
    part = share * root_of_cubic(
        of_passed(start, 1.0) + shift,
        of_passed(start_rate, 0.0),
        of_passed(end, -1.0) + shift,
        of_passed(end_rate, 0.0),
        share * width,
    )
    height, rate = of_first(end) + shift, of_first(end_rate)
    comes = ~passed & of_first(falls) & (height > 0.0) & (rate < 0.0)
    bend = per_width(rate - of_first(start_rate), width)
    # Where the parabola turns before zero: twice as far as the straight line goes.
    root = jnp.sqrt(jnp.maximum(rate**2 - 2.0 * height * bend, 0.0))
    ahead = 2.0 * height / jnp.where(comes, root - rate, 1.0)
    ahead = jnp.where(comes, ahead, jnp.inf)
    return Landing(
        passed=passed,
        # A step far too long has a cubic that says little.
        part=jnp.maximum(part, SHORTEST_PART),
        ahead=ahead,
        left=jnp.where(first < ends, ahead, jnp.inf),
    )


def root_of_cubic(start, start_rate, end, end_rate, width):
    """Find the zero of the cubic through both ends' values and rates, as a fraction of
    width.

    For start > 0 > end. Five Newton steps kept inside the bracket, enough for a cubic
    that is almost straight, as courses over a step are; where they have not converged,
    half way.
    """
    a, b, c = hermite_cubic(start, start_rate, end, end_rate, width)
    low, high = jnp.zeros_like(a), jnp.ones_like(a)
    s = start / (start - end)
    for _ in range(5):
        value = start + s * (a + s * (b + s * c))
        slope = a + s * (2.0 * b + s * 3.0 * c)
        low, high = jnp.where(value > 0, s, low), jnp.where(value > 0, high, s)
        newton = s - value / jnp.where(slope < 0.0, slope, -1.0)
        # A root that is found is one of the bounds, and must stay.
        inside = (slope < 0.0) & (newton >= low) & (newton <= high)
        s = jnp.where(inside, newton, 0.5 * (low + high))
    value = start + s * (a + s * (b + s * c))
    return jnp.where(jnp.abs(value) < 0.1 * jnp.minimum(start, -end), s, 0.5)


class LandingState(NamedTuple):
    """State of `LandingController`."""

    inner: Scalar
    """State of the control by the error."""
    rejected: Scalar
    """1 if the last step was too long for the error control, else 0."""
    tries: Scalar
    """Number of steps made to land since one that met no switch; beyond patience also
    of those that met one and were not cut."""
    all_tries: Scalar
    """Number of steps made to land since the start."""
    resumed: Scalar
    """Width that the step would have, were it not made to land [s]; 0 if it was not."""


class LandingController(diffrax.AbstractStepSizeController):
    """Step size control that lands on the end and on the switches of the laws.

    Wraps another controller; a step that passes one of them is rejected and taken again
    up to the root of the margin, or of the switching function, and one that comes to
    them is followed by one that ends there. After a switch the width is what it was
    before.
    """

    inner: ErrorControl

    def wrap(self, direction):
        return LandingController(self.inner.wrap(direction))

    def init(
        self, terms, t0, t1, y0, dt0, args, func, error_order
    ) -> tuple[Any, LandingState]:
        if dt0 is None:
            dt0 = FIRST_WIDTH * jax.lax.stop_gradient(args.passing_time)
        t1, inner = self.inner.init(terms, t0, t1, y0, dt0, args, func, error_order)
        zero = jnp.zeros_like(t1)
        return t1, LandingState(inner, zero, zero, zero, zero)

    def adapt_step_size(
        self, t0, t1, y0, y1_candidate, args, y_error, error_order, controller_state
    ):
        before_state, rejected, tries, all_tries, resumed = controller_state
        keep, next_t0, next_t1, made_jump, state, result = self.inner.adapt_step_size(
            t0, t1, y0, y1_candidate, args, y_error, error_order, before_state
        )
        before, after = jax.lax.stop_gradient((y0.fold, y1_candidate.fold))
        width = t1 - t0
        passed, part, ahead, left = first_landing(args, before, after, width)
        smallest = SMALLEST_WIDTH * t0
        # Forces that jump leave an error at every width: the jump is taken in one step
        # that is too short to move anything else.
        is_jump = args.is_jump_of_forces(y0.vector, y1_candidate.vector)
        jumps = ~keep & (width <= smallest) & is_jump
        keep = keep | jumps
        next_t0 = jnp.where(jumps, t1, next_t0)
        next_t1 = jnp.where(jumps, t1 + 2.0 * width, next_t1)
        is_short = args.model.damped | (all_tries >= MOST_TRIES)
        patience = jnp.where(is_short, SHORT_PATIENCE, PATIENCE)
        passing = tries >= patience
        beyond = keep & passed & (width > smallest) & ~passing
        state = jax.tree.map(
            lambda old, new: jnp.where(beyond, old, new), before_state, state
        )
        landed = keep & ~beyond
        # The error of a power of time stays what it is if the width grows as time does.
        growth = jnp.minimum(next_t0 / jnp.maximum(t0, TINY), LARGEST_GROWTH)
        begin, end = (part * args.passing_time for part in ONSET)
        grows = landed & (begin < t0) & (t0 < end)
        next_t1 = jnp.where(grows, next_t0 + growth * (next_t1 - next_t0), next_t1)
        # So does that of a power of the time left if it shrinks as that does.
        shrunk = (next_t1 - next_t0) / (1.0 + width / left)
        next_t1 = jnp.where(landed, next_t0 + shrunk, next_t1)
        # What has just been found too long is not tried again at once.
        next_t1 = jnp.where(
            keep & (rejected > 0.0), jnp.minimum(next_t1, next_t0 + width), next_t1
        )
        next_t1 = jnp.where(
            landed & (after.turned > 0.0),
            jnp.maximum(next_t1, next_t0 + resumed),
            next_t1,
        )
        # What is coming is met by the next step; its width is kept for after a switch.
        proposed = next_t1 - next_t0
        aims = landed & (after.turned == 0.0) & (proposed > ahead) & ~passing
        next_t1 = jnp.where(aims, next_t0 + ahead, next_t1)
        settled = landed & ~aims & ((after.turned == 0.0) | (tries >= 2 * patience))
        # Time must go on where a step was cut to less than its rounding.
        next_t1 = jnp.where(landed, jnp.maximum(next_t1, next_t0 + smallest), next_t1)
        cut_t1 = t0 + jnp.maximum(part * width, smallest)
        made_to_land = beyond | aims
        unhindered = jnp.maximum(resumed, jnp.where(aims, proposed, width))
        resumed = jnp.where(made_to_land, unhindered, jnp.where(landed, 0.0, resumed))
        return (
            landed,
            jnp.where(beyond, t0, next_t0),
            jnp.where(beyond, cut_t1, next_t1),
            made_jump,
            LandingState(
                state,
                jnp.where(keep, 0.0, 1.0),
                jnp.where(settled, 0.0, tries + (made_to_land | (landed & passing))),
                all_tries + made_to_land,
                resumed,
            ),
            result,
        )

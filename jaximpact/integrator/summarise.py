"""Results of an impact from the end of its integration."""

import dataclasses

import jax
import jax.numpy as jnp

from .._safe import safe_sqrt
from .._types import Scalar
from ..impact.dynamics import (
    ARM,
    Contact,
    Motion,
    elastic_energy,
    initial_motion,
    kinetic_energy,
)
from ..impact.events import OUTCOME_OF_MARGIN, Outcome, closing_velocity
from ..impact.problem import Problem, is_in_range, stiffness_of_block
from ..impact.results import UNDEFINED, EnergyLedger, ImpactSummary, arm_alone, items_of
from ..restitution import defined_ratio, vijayakumar_coefficient
from ..scene import GRAVITY, Scene
from .batched import Lanes, end_lanes
from .single import End

DETACHED_WITHIN = 1e-9
"""Magnitude below which a force margin counts as zero when the outcome is named. At
N = 0 without a moment the resultant reaches the edge at the same instant: that block
has detached."""


UNDER_LOAD = 0.05
"""Fraction of the largest normal force above which an end at the edge of the foundation
is toppling. Below it the remaining moment of the springs crosses the margin as the
force fades: that block has detached."""


def outcome_code(end: End, normal_force: Scalar, separating: Scalar) -> Scalar:
    """Outcome as a float, so that it can pass through differentiation."""
    margins = jnp.stack(end.margins)
    fired = jnp.argmin(margins)
    fired = jnp.where(margins[0] <= DETACHED_WITHIN, 0, fired)
    under_load = normal_force >= UNDER_LOAD * end.fold.peaks.normal_force
    toppling = OUTCOME_OF_MARGIN.index(Outcome.toppled)
    fired = jnp.where((fired == toppling) & ~under_load, 0, fired)
    codes = jnp.asarray([float(outcome) for outcome in OUTCOME_OF_MARGIN])
    code = jnp.where(end.event, codes[fired], float(Outcome.in_contact))
    code = jnp.where(end.finished, code, float(Outcome.failed))
    code = jnp.where(separating, float(Outcome.separating), code)
    return jax.lax.stop_gradient(code)


SUPPLIED = 2.0
"""Factor by which no item of the ledger may exceed all energy supplied."""


def _closes(problem: Problem, energy: EnergyLedger | None) -> Scalar:
    """Tell whether the ledger, if there is one, closes to what the accuracy promises.

    That is the root of the tolerance, by the largest item: 3 % at "fast", 0.5 % at
    "balanced", 0.01 % at "reference". Of 57 000 random impacts, most of them far out,
    the worst closed to a twentieth of that. Steps that leave more have missed
    something: their results are discarded. So are those with items larger than all
    that was supplied, which may cancel: powers of a load between two steps.
    """
    if energy is None or problem.ledger == ARM:
        return jnp.ones((), bool)
    largest = jnp.max(jnp.abs(jnp.stack(energy)), axis=0)
    promised = jnp.sqrt(problem.tolerance)
    supplied = energy.kinetic_in + sum(
        map(jnp.abs, (energy.gravity, energy.arm, energy.stiffness))
    )
    closes = jnp.abs(energy.residual) <= promised * largest
    return jax.lax.stop_gradient(closes & (largest <= SUPPLIED * supplied))


def _falls_through(end: End, now: Contact) -> Scalar:
    """Tell whether the contact ends at the edge of a foundation on which the block
    still sinks, and which carries nothing: there steps have lost the force."""
    toppling = OUTCOME_OF_MARGIN.index(Outcome.toppled)
    at_edge = end.event & (jnp.argmin(jnp.stack(end.margins)) == toppling)
    sinks = (now.approach[0] > 0.0) & (now.normal_force_before_cut <= 0.0)
    return jax.lax.stop_gradient(at_edge & sinks)


IMPULSE, WORK, FORCE = 1.1, 2.0, 20.0
"""Factors by which a result may exceed what bounds it. Of 40 000 random scenes far out
the sound ones come to 1.00, 1.00 and 5; those whose steps have left the range of the
numbers exceed them by powers of ten."""


def _is_possible(problem: Problem, start: Motion, final: Motion, end: End) -> Scalar:
    r"""Tell whether a contact can bring about such forces and velocities.

    By the balance the changes of momentum are at most the impulses of the largest
    forces, $m |\Delta v_n| \le (N + m g) t$ and so on. Kinetic energy grows by no more
    than the work of gravity on the way and that of the largest normal force on the way
    into the ground and about the centre. Forces are of the order of those of an elastic
    impact, with dashpots, at the velocity of the block's surface.
    """
    ground, peaks, time = problem.ground, end.fold.peaks, end.time
    mass, inertia, weight = ground.mass, ground.inertia, ground.mass * GRAVITY
    reach = jnp.sqrt(ground.axes.major**2 + ground.axes.minor**2)
    normal, tangential, moment = (
        peaks.normal_force,
        peaks.tangential_force,
        peaks.moment,
    )
    speed, spin = _speed(start), jnp.abs(start.angular_velocity)

    bodies = (
        ("normal_velocity", mass, normal + weight, speed),
        ("tangential_velocity", mass, tangential + weight, speed),
        (
            "angular_velocity",
            inertia,
            moment + reach * (normal + tangential),
            speed / reach + spin,
        ),
    )
    impulses = jnp.ones((), bool)
    for name, body, force, scale in bodies:
        # What a reduced model leaves out changes without a force.
        if name in problem.model.unknowns:
            change = body * jnp.abs(getattr(final, name) - getattr(start, name))
            most = IMPULSE * force * time + problem.tolerance * body * scale
            impulses = impulses & (change <= most)
    way = jnp.maximum(speed, _speed(final)) * time
    turn = jnp.maximum(spin, jnp.abs(final.angular_velocity)) * time
    work = weight * way + normal * (reach * turn + peaks.sinking)
    energy = kinetic_energy(ground, start)
    gain = kinetic_energy(ground, final) - energy
    stiffness = stiffness_of_block(ground)
    dashpots = ground.soil.damping(stiffness, mass, inertia)
    resistance = jnp.sqrt(stiffness.normal * mass) + dashpots.normal
    surface_speed = speed + reach * spin + jnp.sqrt(GRAVITY * reach)
    largest = jnp.maximum(jnp.maximum(normal, tangential), moment / reach)
    possible = (
        impulses
        & (gain <= WORK * work + problem.tolerance * energy)
        & (largest <= FORCE * (resistance * surface_speed + weight))
    )
    return jax.lax.stop_gradient(possible)


def _speed(motion: Motion) -> Scalar:
    return jnp.sqrt(motion.normal_velocity**2 + motion.tangential_velocity**2)


def summarise(scene: Scene, problem: Problem, end: End) -> ImpactSummary:
    """Work out the results of an impact from its end."""
    ground, impact = problem.ground, scene.impact
    start = initial_motion(scene)
    final, now = problem.contact(end.vector)
    kinetic_in = kinetic_energy(ground, start)
    closing = closing_velocity(ground, start)
    opening = (
        final.normal_velocity + now.foundation.tangential_arm * final.angular_velocity
    )
    separating = closing <= 0.0

    # Where nothing happens the block leaves as it came.
    def unless_separating(value, otherwise):
        return jnp.where(separating, otherwise, value)

    normal = unless_separating(final.normal_velocity, start.normal_velocity)
    tangential = unless_separating(final.tangential_velocity, start.tangential_velocity)
    spin = unless_separating(final.angular_velocity, start.angular_velocity)
    kinetic_out = unless_separating(kinetic_energy(ground, final), kinetic_in)
    e_contact = -unless_separating(opening, closing) / jnp.where(
        closing == 0.0, 1.0, closing
    )
    e_contact = jnp.where(closing == 0.0, -1.0, e_contact)
    energy = None
    if problem.ledger == ARM:
        energy = arm_alone(jnp.where(separating, 0.0, end.fold.work.arm))
    elif problem.ledger:
        elastic = elastic_energy(final, now.stiffness)
        items = items_of(end.fold.work, elastic) | {"elastic": elastic}
        energy = EnergyLedger(
            kinetic_in=kinetic_in,
            kinetic_out=kinetic_out,
            **_nothing_if(separating, items),
        )
    summary = ImpactSummary(
        # A quotient of two equal numbers may be off one by a rounding.
        e_n=unless_separating(-defined_ratio(normal, start.normal_velocity), -1.0),
        tangential_ratio=_tangential_ratio(problem, start, tangential, separating),
        e_contact=e_contact,
        e_bar=unless_separating(safe_sqrt(kinetic_out / kinetic_in), 1.0),
        R_r=0.5 * ground.inertia * spin**2 / kinetic_out,
        e_n_vijayakumar=vijayakumar_coefficient(
            scene.block,
            impact.orientation,
            e_contact,
            start.normal_velocity,
            start.angular_velocity,
        ),
        **_course(end, final, now, separating),
        normal_velocity=normal,
        tangential_velocity=tangential,
        angular_velocity=spin,
        energy=energy,
        outcome_code=jnp.zeros(()),
        steps=jnp.zeros(()),
    )
    sound = _is_possible(problem, start, final, end) & _closes(problem, energy)
    sound = sound & ~_falls_through(end, now)
    known = is_in_range(scene) & (separating | (end.finished & sound))
    return _named(end, now.forces.normal, separating, known, summary)


def _tangential_ratio(
    problem: Problem, start: Motion, velocity: Scalar, separating: Scalar
) -> Scalar:
    """Tangential velocity after over that before: 1 where nothing happens."""
    if "tangential_velocity" not in problem.model.unknowns:
        return jnp.full_like(velocity, UNDEFINED)
    before = start.tangential_velocity
    undefined = before == 0.0
    ratio = velocity / jnp.where(undefined, 1.0, before)
    return jnp.where(undefined, UNDEFINED, jnp.where(separating, 1.0, ratio))


def _course(
    end: End, final: Motion, now: Contact, separating: Scalar
) -> dict[str, Scalar]:
    """Compute the largest values and their times, and where and when the contact ended,
    by the names of the results; zeros where there was none."""
    peaks, times = end.fold.peaks._asdict(), end.fold.peak_times._asdict()
    numbers = {
        **{f"max_{name}": peak for name, peak in peaks.items()},
        **{f"time_of_max_{name}": time for name, time in times.items()},
        "final_penetration": final.penetration,
        "final_sinking": now.foundation.sinking,
        "duration": end.time,
        "rotation": final.rotation,
    }
    return _nothing_if(separating, numbers)


def _nothing_if(separating: Scalar, values: dict[str, Scalar]) -> dict[str, Scalar]:
    return {name: jnp.where(separating, 0.0, value) for name, value in values.items()}


def _named(
    end: End, normal_force, separating, known, summary: ImpactSummary
) -> ImpactSummary:
    """Complete the summary with its outcome and steps; NaN where it is not known: the
    integration failed, what it gives is not sound, or a value is out of its range."""
    summary = jax.tree.map(lambda x: jnp.where(known, x, jnp.nan), summary)
    return dataclasses.replace(
        summary,
        outcome_code=outcome_code(
            end._replace(finished=known), normal_force, separating & known
        ),
        steps=jax.lax.stop_gradient((end.steps + end.rejected).astype(float)),
    )


def summarise_lanes(scenes: Scene, lanes: Lanes) -> ImpactSummary:
    """Return the results of lanes none of which is going."""
    summary = jax.vmap(summarise, in_axes=(0, -1, 0))
    return summary(scenes, lanes.problem, end_lanes(lanes))

"""Every number of an impact, from its end."""

import dataclasses

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .mechanics.dynamics import elastic_energy, initial_motion, kinetic_energy
from .mechanics.outcomes import OUTCOME_OF_MARGIN, Outcome, closing_velocity
from .mechanics.problem import Problem
from .numbers import EnergyLedger, Numbers
from .restitution import defined_ratio, vijayakumar_coefficient
from .safe import safe_sqrt
from .scene import Scene
from .solver.integration import End
from .solver.lanes import Lanes, end_lanes

Scalar = Float[Array, ""]


DETACHED_WITHIN = 1e-9
"""A force margin within this counts as zero when the end is named. At N = 0 without a
moment the resultant reaches the edge at the same instant: that block has detached."""


UNDER_LOAD = 0.05
"""Part of the largest normal force from which an end at the edge of the foundation is
toppling. Below it the margin is crossed by what the springs' moment has left as the
force fades: that block has detached."""


def outcome_code(end: End, normal_force: Scalar, separating: Scalar) -> Scalar:
    """The outcome as a float, so that it can pass through differentiation.

    Args:
        end: of the integration. normal_force: at the end [N].
        separating: whether there was no impact.
    """
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


def _closes(problem: Problem, energy: EnergyLedger | None) -> Scalar:
    """Whether the ledger, if there is one, closes to what the accuracy promises.

    That is half the fourth root of the tolerance, by the largest item: 9 % at "fast",
    3 % at "balanced", 0.5 % at "reference". Usual impacts close to a hundredth of that.
    Steps that leave more have missed something, and their results are not to be
    believed.
    """
    if energy is None:
        return jnp.ones((), bool)
    largest = jnp.max(jnp.abs(jnp.stack(energy)), axis=0)
    promised = 0.5 * jnp.sqrt(jnp.sqrt(problem.tolerance))
    return jax.lax.stop_gradient(jnp.abs(energy.residual) <= promised * largest)


def summarise(scene: Scene, problem: Problem, end: End) -> Numbers:
    """Every result of an impact from its end."""
    ground, impact = problem.ground, scene.impact
    start = initial_motion(scene)
    final, now = problem.contact(end.vector)
    kinetic_in = kinetic_energy(ground, start)
    kinetic_out = kinetic_energy(ground, final)
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
    kinetic_out = unless_separating(kinetic_out, kinetic_in)
    e_contact = -unless_separating(opening, closing) / jnp.where(
        closing == 0.0, 1.0, closing
    )
    e_contact = jnp.where(closing == 0.0, -1.0, e_contact)
    peaks = [unless_separating(peak, 0.0) for peak in end.fold.peaks]
    times = [unless_separating(time, 0.0) for time in end.fold.peak_times]
    energy = None
    if problem.ledger:
        work = {
            name: unless_separating(item, 0.0)
            for name, item in end.fold.work._asdict().items()
        }
        gained = elastic_energy(final, now.stiffness)
        energy = EnergyLedger(
            kinetic_in=kinetic_in,
            kinetic_out=kinetic_out,
            elastic=unless_separating(gained, 0.0),
            **work,
        )
    numbers = Numbers(
        # A quotient of two equal numbers may be off one by a rounding.
        e_n=unless_separating(-defined_ratio(normal, start.normal_velocity), -1.0),
        e_t=(
            unless_separating(
                defined_ratio(tangential, start.tangential_velocity),
                jnp.where(start.tangential_velocity == 0.0, jnp.nan, 1.0),
            )
            if "tangential_velocity" in problem.model.unknowns
            else jnp.full_like(tangential, jnp.nan)
        ),
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
        max_penetration=peaks[0],
        max_sinking=peaks[1],
        max_normal_force=peaks[2],
        max_tangential_force=peaks[3],
        max_moment=peaks[4],
        time_of_max_penetration=times[0],
        time_of_max_sinking=times[1],
        time_of_max_normal_force=times[2],
        time_of_max_tangential_force=times[3],
        time_of_max_moment=times[4],
        final_penetration=unless_separating(final.penetration, 0.0),
        final_sinking=unless_separating(now.foundation.sinking, 0.0),
        duration=unless_separating(end.time, 0.0),
        rotation=unless_separating(final.rotation, 0.0),
        normal_velocity=normal,
        tangential_velocity=tangential,
        angular_velocity=spin,
        energy=energy,
        outcome_code=jnp.zeros(()),
        steps=jnp.zeros(()),
    )
    known = separating | (end.finished & _closes(problem, energy))
    numbers = jax.tree.map(lambda x: jnp.where(known, x, jnp.nan), numbers)
    return dataclasses.replace(
        numbers,
        outcome_code=outcome_code(
            end._replace(finished=known), now.forces.normal, separating
        ),
        steps=jax.lax.stop_gradient((end.steps + end.rejected).astype(float)),
    )


def summarise_lanes(scenes: Scene, lanes: Lanes) -> Numbers:
    """Every result of lanes none of which is going."""
    summary = jax.vmap(summarise, in_axes=(0, -1, 0))
    return summary(scenes, lanes.problem, end_lanes(lanes))

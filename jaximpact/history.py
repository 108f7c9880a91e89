"""The course of one impact, step by step."""

from typing import NamedTuple

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._jax_internals import Tracer, is_inside_jit
from .accuracy import MAX_STEPS, Accuracy
from .engines.compilation import unfused_jit
from .mechanics.dynamics import elastic_energy, kinetic_energy
from .mechanics.problem import Problem, assemble, pose
from .scene import Scene
from .solver.integration import diffrax_arguments

Series = Float[Array, " steps"]


class History(NamedTuple):
    """The impact at the start and at the end of every step taken, in SI units.

    Energies in J: `kinetic + elastic + viscoplastic + slider + dashpot` equals the
    kinetic energy at the start plus `gravity + arm + stiffness`.
    """

    time: Series
    penetration: Series
    sinking: Series
    rotation: Series
    normal_velocity: Series
    tangential_velocity: Series
    angular_velocity: Series
    normal_force: Series
    tangential_force: Series
    moment: Series
    hardening: Series
    foundation_length: Series
    foundation_width: Series
    rotational_ratio: Series
    kinetic: Series
    elastic: Series
    gravity: Series
    viscoplastic: Series
    slider: Series
    dashpot: Series
    arm: Series
    stiffness: Series


def _row(problem: Problem, time, vector, work) -> History:
    motion, now = problem.contact(vector)
    ground = problem.ground
    kinetic = kinetic_energy(ground, motion)
    return History(
        time=time,
        penetration=motion.penetration,
        sinking=now.foundation.sinking,
        rotation=motion.rotation,
        normal_velocity=motion.normal_velocity,
        tangential_velocity=motion.tangential_velocity,
        angular_velocity=motion.angular_velocity,
        normal_force=now.forces.normal,
        tangential_force=now.forces.tangential,
        moment=now.forces.moment,
        hardening=motion.hardening,
        foundation_length=now.foundation.length,
        foundation_width=now.foundation.width,
        rotational_ratio=0.5 * ground.inertia * motion.angular_velocity**2 / kinetic,
        kinetic=kinetic,
        elastic=elastic_energy(motion, now.stiffness),
        **work._asdict(),
    )


USUAL_STEPS = 20_000
"""Steps that memory is set aside for at first; all of `MAX_STEPS` take 200 MB."""


def _record(assembly, room, solver, scene, tolerance, floor):
    problem, vector = pose(scene, assembly, tolerance, floor)
    solution = diffrax.diffeqsolve(
        **diffrax_arguments(problem, vector, solver) | {"max_steps": room},
        saveat=diffrax.SaveAt(t0=True, steps=True),
    )
    rows = jax.vmap(_row, in_axes=(None, 0, 0, 0))(
        problem, solution.ts, solution.ys.vector, solution.ys.fold.work
    )
    full = solution.result == diffrax.RESULTS.max_steps_reached
    return rows, solution.stats["num_accepted_steps"], full


_record_compiled = unfused_jit(_record, static_argnums=(0, 1, 2))


def record_history(
    scene: Scene,
    accuracy: Accuracy,
    solver: diffrax.AbstractAdaptiveSolver | None = None,
) -> History:
    """Course of one impact as NumPy arrays, one entry for the start and each step, by
    the package's method or another solver.

    Raises ValueError under a JAX transformation: the number of steps is not known
    there.
    """
    if is_inside_jit(scene) or any(
        isinstance(leaf, Tracer) for leaf in jax.tree.leaves(scene)
    ):
        raise ValueError(
            "history=True cannot be used inside a JAX transformation; differentiate or "
            "batch simulate without it"
        )
    for room in (USUAL_STEPS, MAX_STEPS):
        rows, steps, full = _record_compiled(
            assemble(scene),
            room,
            solver,
            scene,
            jnp.asarray(accuracy.tolerance),
            jnp.asarray(accuracy.floor),
        )
        if not full:
            break
    count = min(int(steps) + 1, room)
    return History(*(np.asarray(series)[:count] for series in rows))

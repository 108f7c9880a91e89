"""The XLA backend: for devices other than a CPU, for laws without machine code, and as
an independent check.

Impacts are integrated by diffrax; many side by side, until the slowest ends.
"""

import math
from typing import Any

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
from diffrax import AbstractAdaptiveSolver

from .._jax_internals import broadcast_shapes
from ..accuracy import MAX_STEPS, Accuracy
from ..impact.events import TIME_LIMIT
from ..impact.problem import Assembly, assemble, is_in_range, pose
from ..impact.results import History, ImpactSummary, Solution, history_at
from ..integrator.batched import march_and_sample, start_lanes
from ..integrator.diffrax_solvers import require_derivatives
from ..integrator.single import diffrax_arguments, integrate
from ..integrator.summarise import summarise, summarise_lanes
from ..scene import Scene
from .xla_compilation import unfused_jit


def compute(
    assembly: Assembly,
    scene: Scene,
    tolerance,
    floor,
    solver: AbstractAdaptiveSolver | None = None,
) -> ImpactSummary:
    """Compute one impact; pure, differentiable in forward mode."""
    problem, vector = pose(scene, assembly, tolerance, floor)
    # Values out of their range may take every step there is.
    until = jnp.where(is_in_range(scene), TIME_LIMIT, 0.0)
    return summarise(scene, problem, integrate(problem, vector, solver, until))


def compute_at(
    assembly: Assembly, scene: Scene, tolerance, floor, times
) -> tuple[ImpactSummary, History]:
    """Compute one impact, and its samples at times, NaN after its end; as `compute`."""
    scenes = jax.tree.map(lambda leaf: jnp.reshape(leaf, (1,)), scene)
    lanes = start_lanes(assembly, scenes, tolerance, floor, sampled=True)
    lanes, samples = march_and_sample(lanes, times)
    numbers = summarise_lanes(scenes, lanes)
    return jax.tree.map(lambda x: x[0], numbers), samples


def _compute_leaves(assembly, varied, solver, leaves, tolerance, floor, times):
    def of_varied(values):
        with_delay = [*leaves, 0.0]
        for place, value in zip(varied, values, strict=True):
            with_delay[place] = value
        *all_leaves, delay = with_delay
        scene = jax.tree.unflatten(assembly.structure, all_leaves)
        if times is None:
            solution = compute(assembly, scene, tolerance, floor, solver), None
        else:
            solution = compute_at(assembly, scene, tolerance, floor, times + delay)
        parts = [
            jnp.stack(jax.tree.leaves(part)) for part in solution if part is not None
        ]
        return parts, Solution(*solution)

    values = [(*leaves, 0.0)[place] for place in varied]
    if not varied:
        return of_varied(values)[1]
    columns, solution = jax.jacfwd(of_varied, has_aux=True)(values)
    return solution, list(zip(*columns, strict=True))


_compiled = unfused_jit(_compute_leaves, static_argnums=(0, 1, 2))


def in_xla(assembly, varied: tuple[int, ...], solver, leaves, tolerance, floor, times):
    """Compute a solution; with leaves in `varied` also the derivatives of all results
    and samples with respect to each.

    Leaves, and the leading axes of the times, broadcast to the shape of the results.

    Raises InputError for derivatives through a solver that gives none.
    """
    if varied:
        require_derivatives(solver)

    def of_lane(row, times):
        return _compiled(assembly, varied, solver, row, tolerance, floor, times)

    of_times = () if times is None else np.shape(times)[:-1]
    shape = broadcast_shapes(of_times, *map(np.shape, leaves))
    if not shape:
        return of_lane(leaves, times)
    lanes = math.prod(shape)
    rows = [jnp.broadcast_to(leaf, shape).reshape(lanes) for leaf in leaves]
    if times is not None:
        series = np.shape(times)[-1:]
        times = jnp.broadcast_to(times, shape + series).reshape(lanes, *series)
    results = jax.vmap(of_lane)(rows, times)

    def with_lanes(x, axis):
        return x.reshape(*x.shape[:axis], *shape, *x.shape[axis + 1 :])

    if not varied:
        return jax.tree.map(lambda x: with_lanes(x, 0), results)
    solution, columns = results
    columns = jax.tree.map(lambda x: with_lanes(jnp.moveaxis(x, 0, 1), 1), columns)
    return jax.tree.map(lambda x: with_lanes(x, 0), solution), columns


USUAL_STEPS = 20_000
"""Steps for which memory is reserved at first; all of `MAX_STEPS` take 200 MB."""


def _record(assembly, room, solver, scene, tolerance, floor):
    problem, vector = pose(scene, assembly, tolerance, floor)
    solution = diffrax.diffeqsolve(
        **diffrax_arguments(problem, vector, solver) | {"max_steps": room},
        saveat=diffrax.SaveAt(t0=True, steps=True),
    )
    courses: Any = solution.ys
    rows = jax.vmap(history_at, in_axes=(None, 0, 0, 0))(
        problem, solution.ts, courses.vector, courses.fold.work
    )
    full = solution.result == diffrax.RESULTS.max_steps_reached
    return rows, solution.stats["num_accepted_steps"], full


_record_compiled = unfused_jit(_record, static_argnums=(0, 1, 2))


def record_by_xla(scene: Scene, accuracy: Accuracy, solver) -> History:
    """Record the history that `derivative_rules.solve_recorded` gives."""
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
    return jax.tree.map(lambda series: np.asarray(series)[:count], rows)

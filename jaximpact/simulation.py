"""One impact: from a scene to every number that the model gives.

`simulate` is differentiable in both modes. Its derivative is taken forward through the
integration, for those inputs only that are being differentiated (`jax.custom_jvp` with
symbolic zeros), and what remains is linear, so JAX can transpose it: `jax.grad` costs
as much as `jax.jacfwd` does, in proportion to the number of scene parameters that vary.
What is not inside `jit` or `vmap` runs in machine code on a CPU.
"""

import functools

import equinox as eqx
import jax
import jax.numpy as jnp
from jax.custom_derivatives import SymbolicZero

from ._jax_internals import Tracer
from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .block import Block
from .engines.compilation import unfused_jit
from .engines.machine import (
    compile_native,
    compile_native_along,
    computes_on_cpu,
    solve_alone,
    solve_by_leaves,
)
from .formats import provenance
from .formats.checks import check_scene
from .history import History, record_history
from .mechanics.outcomes import Outcome
from .mechanics.problem import Assembly, assemble, pose
from .precision import require_float64
from .scene import Impact, Scene, as_scene
from .soil import Soil
from .solver.integration import integrate
from .solver.lanes import march, start_lanes
from .summary import Numbers, summarise, summarise_lanes


def compute(assembly: Assembly, scene: Scene, tolerance, floor) -> Numbers:
    """Numbers of one impact: pure, differentiable in forward mode."""
    problem, vector = pose(scene, assembly, tolerance, floor)
    return summarise(scene, problem, integrate(problem, vector))


def compute_lanes(assembly: Assembly, scenes: Scene, tolerance, floor) -> Numbers:
    """Numbers of many impacts side by side, to the slowest; scene fields are
    `(lanes,)`.

    Pure, differentiable in forward mode.
    """
    lanes = march(start_lanes(assembly, scenes, tolerance, floor))
    return summarise_lanes(scenes, lanes)


def _compute_leaves(assembly, structure, leaves, tolerance, floor):
    scene = jax.tree.unflatten(structure, leaves)
    return compute(assembly, scene, tolerance, floor)


def _compute_with_columns(assembly, structure, varied, leaves, tolerance, floor):
    """Numbers, and their derivatives by the leaves named in `varied`."""

    def of_varied(values):
        all_leaves = list(leaves)
        for place, value in zip(varied, values, strict=True):
            all_leaves[place] = value
        numbers = _compute_leaves(assembly, structure, all_leaves, tolerance, floor)
        return numbers, numbers

    columns, numbers = jax.jacfwd(of_varied, has_aux=True)(
        [leaves[place] for place in varied]
    )
    return numbers, columns


_compiled = unfused_jit(_compute_leaves, static_argnums=(0, 1))
_compiled_with_columns = unfused_jit(_compute_with_columns, static_argnums=(0, 1, 2))


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def _solve(assembly, structure, leaves, tolerance, floor):
    found = _in_machine_code(assembly, leaves, tolerance, floor)
    if found is not None:
        return found
    return _compiled(assembly, structure, leaves, tolerance, floor)


@functools.partial(_solve.defjvp, symbolic_zeros=True)
def _solve_jvp(assembly, structure, primals, tangents):
    leaves, tolerance, floor = primals
    varied = tuple(
        place
        for place, tangent in enumerate(tangents[0])
        if not isinstance(tangent, SymbolicZero)
    )
    found = _in_machine_code(assembly, leaves, tolerance, floor, varied)
    if found is None:
        numbers, columns = _compiled_with_columns(
            assembly, structure, varied, leaves, tolerance, floor
        )
        found = numbers, _by_leaf(columns, len(varied))
    numbers, by_leaf = found
    return numbers, _along(by_leaf, [tangents[0][place] for place in varied])


@jax.jit
def _along(columns: list[Numbers], steps: list) -> Numbers:
    """Change of the numbers, by steps of the leaves. (`jit`: one operation in place of
    hundreds where it is called outside.)"""

    def of_result(*derivatives):
        return sum(d * step for d, step in zip(derivatives, steps, strict=True))

    return jax.tree.map(of_result, *columns)


def _in_machine_code(assembly, leaves, tolerance, floor, varied=None):
    """Numbers, with `varied` also a list of their derivatives by these leaves. None
    where there is no machine code: for another device, for laws that have none, and
    while something is being traced."""
    inputs = [*leaves, tolerance, floor]
    if any(isinstance(x, Tracer) for x in inputs) or not computes_on_cpu():
        return None
    make = compile_native if varied is None else compile_native_along
    kernel = make(assembly)
    if kernel is None:
        return None
    if varied is None:
        return jax.device_put(solve_alone(kernel, inputs))
    return jax.device_put(solve_by_leaves(kernel, inputs, varied))


def _by_leaf(columns, count):
    """From numbers holding a list over leaves to a list of numbers."""
    is_list = lambda x: isinstance(x, list)  # noqa: E731
    return [
        jax.tree.map(lambda entry, k=k: entry[k], columns, is_leaf=is_list)
        for k in range(count)
    ]


def solve_scene(scene: Scene, accuracy: Accuracy) -> Numbers:
    """Numbers of one scene, compiled, differentiable in both modes."""
    leaves, structure = jax.tree.flatten(scene)
    tolerance = jnp.asarray(accuracy.tolerance)
    floor = jnp.asarray(accuracy.floor)
    return _solve(assemble(scene), structure, leaves, tolerance, floor)


class ImpactResult(Numbers):
    """Everything about one impact: its numbers, and what they were computed from."""

    scene: Scene
    accuracy: Accuracy = eqx.field(static=True)
    history: History | None = None
    model_tolerance: float = eqx.field(default=0.0, static=True)
    """Error for which a model that leaves something out was allowed."""

    @property
    def outcome(self) -> Outcome:
        """How the impact ended. Not to be had from inside a JAX transformation; use
        `outcome_code` there."""
        return Outcome(int(self.outcome_code))

    def plot(self, path=None):
        """Force, penetration, rotation and energy against time; see
        `plotting.plot_impact`. Records the history first if it was not asked for."""
        from .plotting import plot_impact

        return plot_impact(self, path)

    def manifest(self) -> dict:
        """What is needed to compute this again, ready for JSON."""
        return provenance.manifest(self.scene, self.accuracy, self.model_tolerance)


def simulate(
    scene: Scene | Block,
    soil: Soil | None = None,
    impact: Impact | None = None,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    history: bool = False,
) -> ImpactResult:
    """Simulate one impact.

    Args:
        scene: a `Scene`, or its block, with the soil and the impact beside it; scalars
            (for many scenes, `simulate_batch`, or `jax.vmap` around this function).
        accuracy: "fast", "balanced" or "reference"; see `PRESETS`.
        history: also record the course of the impact (`result.history`); not under a
            JAX transformation.

    Returns:
        `ImpactResult`. A scene whose integration fails gives NaN and the outcome
        `failed`; nothing is raised.

    Differentiable in forward and reverse mode with respect to every field of block,
    soil and impact, through the event that ends the impact. The derivative is that of
    the branch taken: outcomes change suddenly with the scene, and coefficients may jump
    there.

    Raises:
        ValueError: a value out of its range, or an array where a scalar is needed.
        RuntimeError: JAX is set to float32.
    """
    require_float64()
    setting = get_accuracy(accuracy)
    scene = as_scene(scene, soil, impact)
    check_scene(scene, warn=True)
    numbers = solve_scene(scene, setting)
    result = ImpactResult(**vars(numbers), scene=scene, accuracy=setting)
    if not history:
        return result
    recorded = record_history(scene, setting)
    return eqx.tree_at(
        lambda r: r.history, result, recorded, is_leaf=lambda x: x is None
    )

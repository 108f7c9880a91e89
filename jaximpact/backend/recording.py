"""Recording of one impact, step by step."""

import jax
import numpy as np

from .._jax_internals import Tracer, is_inside_jit
from ..accuracy import Accuracy
from ..errors import InputError
from ..impact.history import History, empty_history
from ..impact.problem import assemble
from ..impact.summary import ImpactSummary
from ..scene import Scene, shape_of
from .derivative_rules import solve
from .engine_names import MACHINE_CODE, Engine
from .native_backend import compile_native, computes_on_cpu


def solve_recorded(
    scene: Scene,
    accuracy: Accuracy,
    engine: Engine = Engine(MACHINE_CODE),  # noqa: B008
) -> tuple[ImpactSummary, History]:
    """Compute one impact with the energy ledger, and its history as NumPy arrays, with
    an entry for the start and each step.

    Raises ValueError under a JAX transformation, where the number of steps is not
    known, and InputError for many impacts.
    """
    if is_inside_jit(scene) or any(
        isinstance(leaf, Tracer) for leaf in jax.tree.leaves(scene)
    ):
        raise ValueError(
            "history=True cannot be used inside a JAX transformation, where the number "
            "of steps is not known; give the times that are wanted: save_at=times"
        )
    if shape_of(scene):
        raise InputError(
            "history=True records one impact, but the fields of the scene have the "
            f"shape {shape_of(scene)}; give the times that are wanted: save_at=times"
        )
    assembly = assemble(scene)
    kernel = None
    if engine.is_machine_code and computes_on_cpu():
        kernel = compile_native(assembly, sampled=True)
    if kernel is None:
        from .xla_backend import record_by_xla  # loads diffrax, which takes a while

        leaves, structure = jax.tree.flatten(scene)
        numbers = solve(structure, leaves, accuracy, True, engine)
        return numbers, record_by_xla(scene, accuracy, engine.solver)
    inputs = [*jax.tree.leaves(scene), accuracy.tolerance, accuracy.floor]
    results, samples = kernel.workspace().record(np.array(inputs, float)[:, None])
    numbers = jax.tree.unflatten(kernel.structure, [row[0] for row in results])
    series = jax.tree.structure(empty_history(assembly.ledger))
    return jax.device_put(numbers), jax.tree.unflatten(series, list(samples))


def record_history(scene: Scene, accuracy: Accuracy) -> History:
    """Compute the history that `solve_recorded` gives."""
    return solve_recorded(scene, accuracy)[1]

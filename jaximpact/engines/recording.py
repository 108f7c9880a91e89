"""The history of one impact, step by step."""

import jax
import numpy as np

from .._jax_internals import Tracer, is_inside_jit
from ..accuracy import Accuracy
from ..errors import InputError
from ..history import History, history_of_no_value
from ..mechanics.problem import assemble
from ..numbers import Numbers
from ..scene import Scene, shape_of
from .machine import compile_native, computes_on_cpu
from .selection import MACHINE_CODE, Engine
from .solving import solve


def solve_recorded(
    scene: Scene,
    accuracy: Accuracy,
    engine: Engine = Engine(MACHINE_CODE),  # noqa: B008
) -> tuple[Numbers, History]:
    """Numbers of one impact with the energy ledger, and its history as NumPy arrays,
    with an entry for the start and each step.

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
        from .xla import record_by_xla  # loads diffrax, which takes a while

        leaves, structure = jax.tree.flatten(scene)
        numbers = solve(structure, leaves, accuracy, True, engine)
        return numbers, record_by_xla(scene, accuracy, engine.solver)
    inputs = [*jax.tree.leaves(scene), accuracy.tolerance, accuracy.floor]
    results, samples = kernel.workspace().record(np.array(inputs, float)[:, None])
    numbers = jax.tree.unflatten(kernel.structure, [row[0] for row in results])
    series = jax.tree.structure(history_of_no_value(assembly.ledger))
    return jax.device_put(numbers), jax.tree.unflatten(series, list(samples))


def record_history(scene: Scene, accuracy: Accuracy) -> History:
    """The history that `solve_recorded` gives."""
    return solve_recorded(scene, accuracy)[1]

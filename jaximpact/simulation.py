"""Impacts: from a scene to every number that the model gives."""

import equinox as eqx
import jax
import numpy as np
from diffrax import AbstractAdaptiveSolver

from ._jax_internals import Tracer
from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .block import Block
from .engines.selection import MACHINE_CODE, get_engine
from .engines.solving import solve
from .formats.checks import check_scene, sound_values
from .history import record_history
from .precision import require_float64
from .result import ImpactResult
from .scene import Impact, Scene, as_scene, shape_of, with_axes
from .soil import Soil


def simulate(
    scene: Scene | Block,
    soil: Soil | None = None,
    impact: Impact | None = None,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    history: bool = False,
    ledger: bool | None = None,
    engine: str | AbstractAdaptiveSolver = MACHINE_CODE,
) -> ImpactResult:
    """Simulate an impact, or many.

    Args:
        scene: a `Scene`, or its block, with the soil and the impact beside it. Fields
            are scalars, or arrays with any axes that broadcast; results have their
            shape. (For millions, with a journal and progress: `simulate_batch`.)
        accuracy: "fast", "balanced" or "reference"; see `PRESETS`.
        history: also record the course of the impact (`result.history`); of one impact,
            not under a JAX transformation.
        ledger: also keep the energy ledger (`result.energy`), which costs a quarter. By
            default of a single impact, outside of JAX's transformations.
        engine: "machine code"; or "diffrax", the same method as diffrax runs it, in a
            program that XLA compiles: slower, and independent of the machine code; or
            a solver of diffrax, such as `diffrax.Kvaerno5()`, in place of the method,
            which may take many more steps (`MAX_STEPS`, then the outcome is `failed`).

    Returns:
        `ImpactResult`. A scene whose integration fails gives NaN and the outcome
        `failed`; nothing is raised.

    Differentiable in forward and reverse mode with respect to every field of block,
    soil and impact, through the event that ends the impact. The derivative is that of
    the branch taken: outcomes change suddenly with the scene, and coefficients may jump
    there.

    Raises:
        ValueError: a value out of its range, an array where a scalar is needed, an
            unknown accuracy or engine, or a solver that estimates no errors.
        RuntimeError: JAX is set to float32.
    """
    require_float64()
    setting = get_accuracy(accuracy)
    scene = as_scene(scene, soil, impact)
    leaves, structure = jax.tree.flatten(scene)
    values, held = sound_values(structure, leaves), scene
    if values is None:
        check_scene(scene, batched=True, warn=True)
        values, held = leaves, with_axes(scene, len(shape_of(scene)))
    if ledger is None:
        ledger = not any(isinstance(x, Tracer) or np.ndim(x) for x in values)
    chosen = get_engine(engine)
    numbers = solve(structure, values, setting, ledger, chosen)
    result = ImpactResult(
        **vars(numbers), scene=held, accuracy=setting, engine=chosen.name
    )
    if not history:
        return result
    recorded = record_history(scene, setting, chosen.solver)
    return eqx.tree_at(
        lambda r: r.history, result, recorded, is_leaf=lambda x: x is None
    )

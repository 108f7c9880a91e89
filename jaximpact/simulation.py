"""Simulation of impacts: from a scene to every number that the model gives."""

import dataclasses
from typing import TYPE_CHECKING, Union

import jax
import numpy as np
from numpy.typing import ArrayLike

from ._checks import truth
from ._jax_internals import Tracer, namespace_of
from ._precision import require_float64
from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .backend import MACHINE_CODE, get_engine
from .backend.derivative_rules import solve, solve_at, solve_recorded
from .errors import InputError
from .io.checks import check_scene, check_times, usual_values
from .parameters import with_fields
from .result import ImpactResult
from .scene import Block, Impact, Scene, Soil, as_scene, shape_of, with_axes
from .shapes import MixedShapes, shape_by_shape

if TYPE_CHECKING:  # which takes a while to load
    from diffrax import AbstractAdaptiveSolver


def simulate(
    scene: Scene | Block,
    soil: Soil | None = None,
    impact: Impact | None = None,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    save_at: ArrayLike | None = None,
    history: bool = False,
    ledger: bool | None = None,
    engine: Union[str, "AbstractAdaptiveSolver"] = MACHINE_CODE,
) -> ImpactResult:
    """Simulate an impact, or many.

    Args:
        scene: a `Scene`, or its block, followed by soil and impact. Fields are
            scalars, or arrays of any shapes that broadcast; results have the shape
            that they broadcast to. (`simulate_batch` computes millions, with a journal
            and progress.)
        accuracy: "fast", "balanced" or "reference"; see `PRESETS`.
        save_at: times since touch [s] at which forces and motion are wanted
            (`result.history`), in any order, shape `(times,)`, or with axes in front
            that broadcast with the fields. It goes through `jit`, `vmap` and `grad`,
            also with respect to the times, as a comparison with measured curves needs.
            Where there is no machine code XLA computes it.
        history: also record the start and every step of one impact (`result.history`);
            not under a JAX transformation.
        ledger: also keep the energy ledger (`result.energy`), which costs a quarter of
            the time. The default is True for a single impact outside of JAX's
            transformations, else False.
        engine: "machine code"; or "diffrax", the same method run by diffrax in a
            program that XLA compiles: slower, and independent of the machine code; or
            a solver of diffrax, such as `diffrax.Kvaerno5()`, instead of the method.
            Such a solver may take many more steps; after `MAX_STEPS` of them the
            outcome is `failed`.

    Returns:
        `ImpactResult`, every number with its unit in `help(ImpactResult)`. A scene
        whose integration fails gives NaN and the outcome `failed`; nothing is raised.
        So does, inside of `jit`, `vmap` and `grad`, where values are not known, one
        with a value out of its range. The impact angle alone may go to 180 degrees
        there: a block that turns can strike while its centre rises.

    Differentiable in forward and reverse mode with respect to every field of block,
    soil and impact, through the event that ends the impact. The derivative is that of
    the branch taken: outcomes change suddenly with the scene, and coefficients may jump
    there.

    Raises:
        ValueError: a value out of its range, a time that is NaN, an unknown accuracy or
            engine, a `ledger` that is no truth value, a solver that estimates no
            errors, `save_at` together with `history` or with diffrax, or many impacts
            with `history`.
        RuntimeError: JAX is set to float32.
    """
    require_float64()
    setting = get_accuracy(accuracy)
    scene = as_scene(scene, soil, impact)
    leaves, structure = jax.tree.flatten(scene)
    values, of_result = usual_values(structure, leaves), scene
    if values is None:
        check_scene(scene, batched=True, warn=True)
        values, of_result = leaves, with_axes(scene, len(shape_of(scene)))
    chosen = get_engine(engine)
    times = np.zeros(0)
    if save_at is not None:
        if history:
            raise InputError(
                "give save_at=times or history=True, which records every step, not both"
            )
        if not chosen.is_machine_code:
            raise InputError(
                f"save_at is not to be had with the engine {chosen.name}; ask for "
                "every step, with history=True, or leave the engine out"
            )
        times, shape = check_times(save_at, shape_of(scene))
        of_result = with_axes(scene, len(shape)) if shape else of_result
    if ledger is None:
        is_one = isinstance(values, np.ndarray) or not any(
            np.ndim(x) or isinstance(x, Tracer) for x in values
        )
        ledger = is_one and times.ndim <= 1 and not isinstance(times, Tracer)
    ledger = truth("ledger", ledger)

    def solved(structure, values, times):
        """Compute impacts of blocks of one shape, and their histories."""
        if save_at is not None:
            return solve_at(structure, values, setting, ledger, times)
        if history:
            return solve_recorded(
                jax.tree.unflatten(structure, values), setting, chosen
            )
        return solve(structure, values, setting, ledger, chosen), None

    if isinstance(scene.block.shape, MixedShapes):
        of_lanes = (*shape_of(of_result), times.shape[-1])
        numbers, recorded = shape_by_shape(
            lambda one, times: solved(
                jax.tree.structure(one), jax.tree.leaves(one), times
            ),
            of_result,
            namespace_of(times).broadcast_to(times, of_lanes),
        )
    else:
        numbers, recorded = solved(structure, values, times)
    if history and not ledger:
        numbers = dataclasses.replace(numbers, energy=None)
    of_impact = dict(
        scene=of_result, accuracy=setting, history=recorded, engine=chosen.name
    )
    return with_fields(ImpactResult, vars(numbers) | of_impact)

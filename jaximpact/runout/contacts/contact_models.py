"""Contact models: the full model, or a rebound law in closed form, behind one
protocol."""

import concurrent.futures
import dataclasses
from collections.abc import Callable
from typing import Protocol

import jax
import jax.numpy as jnp
import numpy as np

from ...accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ...backend.native_backend import (
    compile_native_along,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ...backend.threads import thread_count
from ...errors import InputError
from ...impact.problem import Assembly
from ...impact.reduced_models import MODELS, model_places
from ...impact.termination import Outcome
from ...impact_response import ImpactResponse, ImpactResponses, respond
from ...rebound import Rebound
from ...scene import Block, Impact, Scene
from ...soil import Soil
from ..dual import Dual, primal, tangent_count, tangent_of
from ..lane_programs import closed_form

NOT_TRACED = (
    *(jax.errors.TracerArrayConversionError, jax.errors.ConcretizationTypeError),
    *(jax.errors.TracerBoolConversionError, jax.errors.TracerIntegerConversionError),
)
"""Errors that NumPy, `float` and `if` raise for traced numbers."""
FIELDS = (
    *("normal_velocity", "tangential_velocity", "angular_velocity"),
    *("duration", "rotation", "final_sinking"),
)
"""Fields of an impact's summary, in the order of `ImpactResponse`."""
PART = 256
"""Number of impacts, times parameters, that a core takes at a time."""


class Contacts(Protocol):
    """Contact model: gives the responses of blocks to impacts."""

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> ImpactResponses:
        """Compute impacts side by side; every field an array `(lanes,)`."""
        ...


@dataclasses.dataclass(frozen=True)
class FullModel:
    """Contact model that integrates every contact by the full model.

    Args:
        accuracy: name of a preset, or settings, as for `simulate`.
    """

    accuracy: str | Accuracy = DEFAULT_ACCURACY

    def __post_init__(self):
        get_accuracy(self.accuracy)

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> ImpactResponses:
        scene, accuracy = Scene(block, soil, impact), get_accuracy(self.accuracy)
        if tangent_count(scene):
            return differentiate_impacts(scene, accuracy)
        return respond(scene, accuracy)


@dataclasses.dataclass(frozen=True)
class ClosedForm:
    """Contact model by a rebound law in closed form, without duration or penetration.

    Args:
        law: rebound law; called with a block and an impact, of scalars, it gives the
            velocities after. An `AbstractRebound`, or another pytree of its parameters.

    Raises InputError for a class in place of an object, and for what cannot be called.
    """

    law: Callable[[Block, Impact], Rebound]

    def __post_init__(self):
        if isinstance(self.law, type):
            name = self.law.__name__
            raise InputError(
                f"law must be an object, but is the class {name}; write {name}(...)"
            )
        if not callable(self.law):
            raise InputError(f"law must be a law of rebound, but is {self.law!r}")

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> ImpactResponses:
        after = _rebound(self.law, block, impact)
        nothing = np.zeros_like(after.normal_velocity)
        response = ImpactResponse(
            *after, duration=nothing, rotation=nothing, sinking=nothing
        )
        finite = np.logical_and.reduce([np.isfinite(values) for values in after])
        outcome = np.where(finite, int(Outcome.detached), int(Outcome.failed))
        return ImpactResponses(response, outcome)


@closed_form
def _rebound(law, block: Block, impact: Impact) -> Rebound:
    name = type(law).__name__
    try:
        after = law(block, impact)
    except NOT_TRACED as error:
        raise InputError(
            f"the law {name} does with a number of a block or an impact what only "
            "jax.numpy can: use jnp in place of np, math and float, and jnp.where in "
            f"place of if ({type(error).__name__})"
        ) from error
    shapes = jax.tree.map(jnp.shape, after)
    if not isinstance(after, tuple) or tuple(shapes) != ((), (), ()):
        told = f"shapes {shapes}" if isinstance(after, tuple) else type(after).__name__
        raise InputError(
            f"the law {name} must return Rebound(normal_velocity, tangential_velocity, "
            f"angular_velocity), three scalars, but returned {told}"
        )
    return Rebound(*(jnp.asarray(value, float) for value in after))


def differentiate_impacts(scene: Scene, accuracy: Accuracy) -> ImpactResponses:
    """Integrate impacts together with the derivatives that their scenes carry.

    Each derivative is one more run of the impact, along its direction.

    Args:
        scene: fields `(lanes,)`, some of which carry derivatives.

    Returns:
        Responses that carry derivatives; NaN where an impact failed.

    Raises NotImplementedError for laws without machine code, and off a CPU.
    """
    count, lanes = tangent_count(scene), len(scene.impact.speed)
    leaves, structure = jax.tree.flatten(scene)
    values = np.stack([np.broadcast_to(primal(leaf), (lanes,)) for leaf in leaves])
    slopes = np.stack(
        [np.broadcast_to(_rows(leaf, count), (count, lanes)) for leaf in leaves], axis=1
    )
    # A derivative breaks the symmetry that a cheaper model rests on.
    known = np.where(np.any(slopes != 0.0, axis=0), np.nan, values)
    places = model_places(jax.tree.unflatten(structure, list(known)))
    jobs = []
    for place in np.unique(places):
        assembly = Assembly(jax.tree.structure(scene), MODELS[place], ledger=False)
        kernel = compile_native_along(assembly) if computes_on_cpu() else None
        if kernel is None:
            raise NotImplementedError(
                "derivatives of a run-out need machine code, which is for laws of "
                "known operations on a CPU"
            )
        pairs = np.argwhere(np.broadcast_to(places == place, (count, lanes)))
        jobs += [(kernel, pairs[i : i + PART].T) for i in range(0, len(pairs), PART)]
    found = np.full((len(FIELDS) + 1, lanes), np.nan)
    tangents = np.full((len(FIELDS), count, lanes), np.nan)

    def solve(job) -> None:
        kernel, (parameter, lane) = job
        inputs = with_setting(values[:, lane], accuracy)
        rows = np.concatenate([inputs, slopes[parameter, :, lane].T])
        numbers, (along,) = solve_rows(kernel, rows)
        found[:, lane] = [getattr(numbers, n) for n in (*FIELDS, "outcome_code")]
        tangents[:, parameter, lane] = [getattr(along, name) for name in FIELDS]

    with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
        list(pool.map(solve, jobs))
    duals = [Dual(v, t) for v, t in zip(found[:-1], tangents, strict=True)]
    return ImpactResponses(ImpactResponse(*duals), found[-1].astype(int))


def _rows(leaf, count: int) -> np.ndarray:
    tangent = tangent_of(leaf, count)
    return tangent if tangent.ndim > 1 else tangent[:, None]

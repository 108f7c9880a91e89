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
from ...backend.derivative_rules import MOST_DIRECTIONS
from ...backend.native_backend import (
    compile_native_along,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ...backend.threads import thread_count
from ...errors import InputError
from ...impact.events import Outcome
from ...impact.problem import Assembly
from ...impact.reduced_models import MODELS, model_places
from ...impact_response import FIELDS, ImpactResponse, ImpactResponses, respond
from ...rebound import Rebound
from ...scene import Block, Impact, Scene, Soil
from ..lane_programs import Carried, call, closed_form

NOT_TRACED = (
    *(jax.errors.TracerArrayConversionError, jax.errors.ConcretizationTypeError),
    *(jax.errors.TracerBoolConversionError, jax.errors.TracerIntegerConversionError),
)
"""Errors that NumPy, `float` and `if` raise for traced numbers."""
PART = 256
"""Number of impacts that a core takes at a time."""


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
        return respond(Scene(block, soil, impact), get_accuracy(self.accuracy))


@dataclasses.dataclass(frozen=True)
class ClosedForm:
    """Contact model by a rebound law in closed form, without duration or penetration.

    Args:
        law: rebound law; called with a block and an impact, of scalars, it gives the
            velocities after. An `AbstractRebound`, or another pytree of its parameters,
            which are scalars, or `(blocks,)` where each block of a run has its own.

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

    def at(self, blocks: np.ndarray) -> "ClosedForm":
        """Select the parameters of some blocks."""
        leaves, structure = jax.tree.flatten(self.law)
        # By NumPy: JAX would compile its indexing anew for each number of blocks.
        own = [np.asarray(leaf)[blocks] if np.ndim(leaf) else leaf for leaf in leaves]
        return ClosedForm(jax.tree.unflatten(structure, own))

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> ImpactResponses:
        after = _rebound(self.law, block, impact)
        return ImpactResponses(_without_duration(after), _outcome_of(after))

    def differentiate(
        self, block: Carried, impact: Carried, law_tangent
    ) -> tuple[Carried, np.ndarray]:
        """Compute impacts with derivatives, also with respect to the law's parameters.

        Args:
            block, impact: as for a call, with derivatives.
            law_tangent: derivatives of the law's parameters, `(parameters,)`.

        Returns:
            Responses with derivatives, and outcomes.
        """
        columns = jax.tree.map(lambda leaf: np.reshape(leaf, (-1, 1)), law_tangent)
        after = call(_rebound, Carried(self.law, columns), block, impact)
        return after.map(_without_duration), _outcome_of(after.value)


def _without_duration(after: Rebound) -> ImpactResponse:
    nothing = np.zeros_like(after.normal_velocity)
    return ImpactResponse(*after, duration=nothing, rotation=nothing, sinking=nothing)


def _outcome_of(after: Rebound) -> np.ndarray:
    finite = np.logical_and.reduce([np.isfinite(values) for values in after])
    return np.where(finite, int(Outcome.detached), int(Outcome.failed))


def ask(
    contacts: Contacts, block: Carried, soil: Carried, impact: Carried, law_tangent
) -> tuple[Carried, np.ndarray]:
    """Ask a contact model for responses and outcomes, with derivatives where the scenes
    carry them, which only `FullModel` and `ClosedForm` can give."""
    if impact.tangent is None:
        found = contacts(block.value, soil.value, impact.value)
        return Carried(found.response), found.outcome
    if isinstance(contacts, ClosedForm):
        return contacts.differentiate(block, impact, law_tangent)
    assert isinstance(contacts, FullModel)
    scenes = Carried(
        Scene(block.value, soil.value, impact.value),
        Scene(block.tangent, soil.tangent, impact.tangent),
    )
    return differentiate_impacts(scenes, get_accuracy(contacts.accuracy))


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


def differentiate_impacts(
    scenes: Carried, accuracy: Accuracy
) -> tuple[Carried, np.ndarray]:
    """Integrate impacts together with the derivatives that their scenes carry.

    Some derivatives at a time share the steps of the impact and all that its values
    need.

    Args:
        scenes: `Scene`, fields `(lanes,)`.

    Returns:
        `ImpactResponse` with derivatives, NaN where an impact failed; and outcomes.

    Raises NotImplementedError for laws without machine code, and off a CPU.
    """
    leaves, structure = jax.tree.flatten(scenes.value)
    values = np.stack(leaves)
    slopes = np.stack(jax.tree.leaves(scenes.tangent), axis=1)
    count, _, lanes = slopes.shape
    # A derivative breaks the symmetry that a cheaper model rests on.
    known = np.where(np.any(slopes != 0.0, axis=0), np.nan, values)
    places = model_places(jax.tree.unflatten(structure, list(known)))
    together = 1 if count == 1 else MOST_DIRECTIONS
    jobs = []
    for place in np.unique(places):
        assembly = Assembly(structure, MODELS[place], ledger=False)
        kernel = compile_native_along(assembly, together) if computes_on_cpu() else None
        if kernel is None:
            raise NotImplementedError(
                "derivatives of a run-out need machine code, which is for laws of "
                "known operations on a CPU"
            )
        alike = np.flatnonzero(np.broadcast_to(places == place, (lanes,)))
        parts = [alike[i : i + PART] for i in range(0, len(alike), PART)]
        firsts = range(0, count, together)
        jobs += [(kernel, first, part) for first in firsts for part in parts]
    found = np.full((len(FIELDS), lanes), np.nan)
    tangents = np.full((len(FIELDS) - 1, count, lanes), np.nan)

    def solve(job) -> None:
        kernel, first, lane = job
        along = slopes[first : first + together, :, lane]
        unused = np.zeros((together - len(along), *along.shape[1:]))
        inputs = with_setting(values[:, lane], accuracy)
        numbers, changes = solve_rows(kernel, np.concatenate([inputs, *along, *unused]))
        found[:, lane] = [getattr(numbers, name) for name in FIELDS]
        for parameter, change in enumerate(changes[: len(along)], first):
            tangents[:, parameter, lane] = [
                getattr(change, name) for name in FIELDS[:-1]
            ]

    with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
        list(pool.map(solve, jobs))
    responses = Carried(ImpactResponse(*found[:-1]), ImpactResponse(*tangents))
    return responses, found[-1].astype(int)

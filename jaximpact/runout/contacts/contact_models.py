"""Contact models: the full model, or a rebound law in closed form, behind one
protocol."""

import dataclasses
from collections.abc import Callable
from typing import Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import Tracer

from ...accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ...errors import InputError
from ...impact.events import Outcome
from ...impact_response import ImpactResponse, ImpactResponses, respond
from ...io.checks import check_field
from ...progress import SILENT, telling
from ...quantities import own_columns
from ...rebound import AbstractRebound, Rebound
from ...scene import Block, Impact, Scene, Soil
from ..lane_programs import closed_form

NOT_TRACED = (
    *(jax.errors.TracerArrayConversionError, jax.errors.ConcretizationTypeError),
    *(jax.errors.TracerBoolConversionError, jax.errors.TracerIntegerConversionError),
)
"""Errors that NumPy, `float` and `if` raise for traced numbers."""


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
        # Who waits for the run counts blocks, not the impacts of a round.
        with telling(SILENT):
            return respond(Scene(block, soil, impact), get_accuracy(self.accuracy))


@dataclasses.dataclass(frozen=True)
class ClosedForm:
    """Contact model by a rebound law in closed form, without duration or penetration.

    Args:
        law: rebound law; called with a block and an impact, of scalars, it gives the
            velocities after. An `AbstractRebound`, or another pytree of its parameters,
            which are scalars, or `(blocks,)` where each block of a run has its own.

    Raises InputError for a class in place of an object, for what cannot be called, and
    for parameters of an `AbstractRebound` out of their range.
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
        if not isinstance(self.law, AbstractRebound):
            return
        for column in own_columns(type(self.law)):
            value = getattr(self.law, column.field)
            if not isinstance(value, Tracer):
                name = f"{type(self.law).__name__}.{column.field}"
                check_field(name, column, value, warn=False, of="block")

    def check_count(self, count: int) -> None:
        """Raise InputError for parameters that are neither scalars nor one for each of
        so many blocks."""
        for leaf in jax.tree.leaves(self.law):
            if np.shape(leaf) not in ((), (count,)):
                raise InputError(
                    f"parameters of the law {type(self.law).__name__} must be scalars "
                    f"or have the shape ({count},), one for each block, but one has "
                    f"the shape {np.shape(leaf)}"
                )

    def at(self, blocks: np.ndarray) -> "ClosedForm":
        """Select the parameters of some blocks."""
        leaves, structure = jax.tree.flatten(self.law)
        # By NumPy: JAX would compile its indexing anew for each number of blocks.
        chosen = [
            np.asarray(leaf)[blocks] if np.ndim(leaf) else leaf for leaf in leaves
        ]
        return ClosedForm(jax.tree.unflatten(structure, chosen))

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> ImpactResponses:
        after = _rebound(self.law, block, impact)
        zero = np.zeros_like(after.normal_velocity)
        response = ImpactResponse(*after, duration=zero, rotation=zero, sinking=zero)
        finite = np.all(np.isfinite(after), axis=0)
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
    except Exception as error:
        raise InputError(
            f"the law {name} cannot be computed: {type(error).__name__}: {error}; it "
            "is called with a block and an impact"
        ) from error
    shapes = jax.tree.map(jnp.shape, after)
    if not isinstance(after, tuple) or tuple(shapes) != ((), (), ()):
        returned = (
            f"shapes {shapes}" if isinstance(after, tuple) else type(after).__name__
        )
        raise InputError(
            f"the law {name} must return Rebound(normal_velocity, tangential_velocity, "
            f"angular_velocity), three scalars, but returned {returned}"
        )
    return Rebound(*(jnp.asarray(value, float) for value in after))

"""What a contact does: the full model, or a law in closed form, behind one face."""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple, Protocol

import jax
import jax.numpy as jnp
import numpy as np

from ..accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ..batch import groups_of, order_by_effort, run_groups
from ..block import Block
from ..errors import InputError
from ..mechanics.outcomes import Outcome
from ..rebound import Rebound
from ..scene import Impact, Scene
from ..soil import Soil
from .contact import Blow
from .dual import carries
from .impact_derivatives import differentiate_impacts
from .programs import closed_form


class Blows(NamedTuple):
    """What impacts do, and how they ended."""

    blow: Blow
    """Arrays `(lanes,)`; NaN where an impact failed."""
    outcome: np.ndarray
    """Codes of `Outcome`, `(lanes,)`."""


class Contacts(Protocol):
    """What knows how blocks rebound."""

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> Blows:
        """Impacts side by side; every field an array `(lanes,)`."""


@dataclasses.dataclass(frozen=True)
class FullModel:
    """Every contact integrated by the model.

    Args:
        accuracy: as for `simulate`.
    """

    accuracy: str | Accuracy = DEFAULT_ACCURACY

    def __post_init__(self):
        get_accuracy(self.accuracy)

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> Blows:
        scene = Scene(block, soil, impact)
        if carries(scene):
            accuracy = get_accuracy(self.accuracy)
            return Blows(*differentiate_impacts(scene, accuracy))
        scene = jax.tree.map(np.asarray, scene)
        order = order_by_effort(scene)
        groups = groups_of(scene, order, model_tolerance=0.0, ledger=False)
        columns = np.full((len(Blow._fields) + 1, len(order)), np.nan)

        def keep(lanes, numbers) -> None:
            columns[:, lanes] = [
                numbers.normal_velocity,
                numbers.tangential_velocity,
                numbers.angular_velocity,
                numbers.duration,
                numbers.rotation,
                numbers.final_sinking,
                numbers.outcome_code,
            ]

        run_groups(scene, groups, get_accuracy(self.accuracy), keep, {})
        return Blows(Blow(*columns[:-1]), columns[-1].astype(int))


@dataclasses.dataclass(frozen=True)
class ClosedForm:
    """Every contact by a law in closed form, in no time and without sinking.

    Args:
        law: called with a block and an impact, of scalars, it gives the velocities
            after; an `AbstractRebound`, or another pytree of its parameters.
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

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> Blows:
        after = _rebound(self.law, block, impact)
        nothing = np.zeros_like(after.normal_velocity)
        blow = Blow(*after, nothing, nothing, nothing)
        finite = np.logical_and.reduce([np.isfinite(values) for values in after])
        outcome = np.where(finite, int(Outcome.detached), int(Outcome.failed))
        return Blows(blow, outcome)


NOT_TRACED = (
    *(jax.errors.TracerArrayConversionError, jax.errors.ConcretizationTypeError),
    *(jax.errors.TracerBoolConversionError, jax.errors.TracerIntegerConversionError),
)
"""What NumPy, `float` and `if` raise of numbers that are being traced."""


def _call(law, block: Block, impact: Impact) -> Rebound:
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


_rebound = closed_form(_call)

"""What a contact does: the full model, or a law in closed form, behind one face."""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple, Protocol

import jax
import numpy as np

from ..accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ..batch import order_by_effort, run_groups
from ..block import Block
from ..errors import InputError
from ..mechanics.model import MODELS, model_places
from ..mechanics.outcomes import Outcome
from ..mechanics.problem import Assembly
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
        places = model_places(scene)
        order = order_by_effort(scene)
        groups = [
            (
                Assembly(jax.tree.structure(scene), MODELS[k], ledger=False),
                order[places[order] == k],
            )
            for k in np.unique(places)
        ]
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
        law: called with a block and an impact it gives the velocities after, as those
            of `jaximpact.rebound`; a pytree of its parameters. It must be made of what
            machine code is known for.
    """

    law: Callable[[Block, Impact], Rebound]

    def __post_init__(self):
        if not callable(self.law):
            raise InputError(f"law must be a law of rebound, but is {self.law!r}")

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> Blows:
        after = _rebound(self.law, block, impact)
        nothing = np.zeros_like(after.normal_velocity)
        blow = Blow(*after, nothing, nothing, nothing)
        finite = np.logical_and.reduce([np.isfinite(values) for values in after])
        outcome = np.where(finite, int(Outcome.detached), int(Outcome.failed))
        return Blows(blow, outcome)


def _call(law, block: Block, impact: Impact) -> Rebound:
    return law(block, impact)


_rebound = closed_form(_call)

"""Impacts: from a scene to every number that the model gives."""

import equinox as eqx
import jax
import numpy as np

from ._jax_internals import Tracer
from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .block import Block
from .engines.solving import solve
from .formats import provenance
from .formats.checks import check_scene, sound_values
from .history import History, record_history
from .mechanics.outcomes import Outcome
from .precision import require_float64
from .scene import Impact, Scene, as_scene, shape_of
from .soil import Soil
from .summary import Numbers


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
    ledger: bool | None = None,
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
    leaves, structure = jax.tree.flatten(scene)
    values = sound_values(structure, leaves)
    if values is None:
        check_scene(scene, batched=True, warn=True)
        shape_of(scene)
        values = leaves
    if ledger is None:
        ledger = not any(isinstance(x, Tracer) or np.ndim(x) for x in values)
    numbers = solve(structure, values, setting, ledger)
    result = ImpactResult(**vars(numbers), scene=scene, accuracy=setting)
    if not history:
        return result
    recorded = record_history(scene, setting)
    return eqx.tree_at(
        lambda r: r.history, result, recorded, is_leaf=lambda x: x is None
    )

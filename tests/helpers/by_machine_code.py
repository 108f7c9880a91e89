"""Impacts of a model by its machine code, whichever model a scene would be given."""

import jax
import numpy as np

from jaximpact import Accuracy, Scene
from jaximpact.accuracy import get_accuracy
from jaximpact.backend.native_backend import MOST_DIRECTIONS, compile_native
from jaximpact.backend.simd import KernelSet
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import Model
from jaximpact.impact.results import ImpactSummary


def computed(scene: Scene, model: Model, accuracy: str | Accuracy) -> ImpactSummary:
    """Numbers of scenes, arrays of one shape `(n,)`."""
    kernel = compile_native(Assembly(jax.tree.structure(scene), model, False))
    return _solved(kernel, _inputs(scene, accuracy))


def computed_along(
    scene: Scene, direction: Scene, model: Model, accuracy: str | Accuracy
) -> tuple[ImpactSummary, ImpactSummary]:
    """Numbers of scenes, and their derivatives along a direction."""
    kernel = compile_native(Assembly(jax.tree.structure(scene), model, False), True)
    first = np.stack(jax.tree.leaves(direction))
    rest = [np.zeros_like(first)] * (MOST_DIRECTIONS - 1)
    inputs = np.concatenate([_inputs(scene, accuracy), first, *rest])
    values, (slopes, *_) = _solved(kernel, inputs)
    return values, slopes


def _solved(kernel, inputs: np.ndarray):
    results, _ = KernelSet([kernel]).compute(inputs, threads=1)
    return jax.tree.unflatten(kernel.structure, list(results))


def _inputs(scene: Scene, accuracy: str | Accuracy) -> np.ndarray:
    setting = get_accuracy(accuracy)
    leaves = np.stack(jax.tree.leaves(scene))
    rows = [[setting.tolerance], [setting.floor]]
    return np.concatenate([leaves, np.broadcast_to(rows, (2, leaves.shape[1]))])

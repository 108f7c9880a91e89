"""Impacts of a model by its machine code, whichever model a scene would be given."""

import jax
import numpy as np

from jaximpact import PRESETS, Accuracy, Scene
from jaximpact.backend.native_backend import (
    compile_native,
    compile_native_along,
    kernel_inputs,
    solve_rows,
)
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import Model
from jaximpact.impact.results import ImpactSummary


def computed(scene: Scene, model: Model, accuracy: str | Accuracy) -> ImpactSummary:
    """Numbers of scenes, arrays of one shape `(n,)`."""
    kernel = compile_native(Assembly(jax.tree.structure(scene), model, False))
    return solve_rows(kernel, _inputs(scene, accuracy))


def computed_along(
    scene: Scene, direction: Scene, model: Model, accuracy: str | Accuracy
) -> tuple[ImpactSummary, ImpactSummary]:
    """Numbers of scenes, and their derivatives along a direction."""
    kernel = compile_native_along(Assembly(jax.tree.structure(scene), model, False))
    rows = [_inputs(scene, accuracy), np.stack(jax.tree.leaves(direction))]
    values, (slopes,) = solve_rows(kernel, np.concatenate(rows))
    return values, slopes


def _inputs(scene: Scene, accuracy: str | Accuracy) -> np.ndarray:
    setting = PRESETS[accuracy] if isinstance(accuracy, str) else accuracy
    return np.stack(kernel_inputs(scene, setting))

"""Derivatives of e_n with respect to logarithms of soil parameters: forward mode, and
differences.

A peer that has derivatives of its own has a function `gradient` of scenes, batch or
not, and tolerance, which gives what `forward_gradient` does.
"""

import time

import jax
import numpy as np

from jaximpact.accuracy import Accuracy
from jaximpact.backend.rows import compute_rows, prepare
from jaximpact.impact.results import ImpactSummary, empty_summary
from jaximpact.quantities import leaf_places
from jaximpact.scene import Scene

from ..impacts import PARAMETERS, shifted
from .methods import EXACT, FLOOR, Method, count_of


def forward_gradient(
    scenes: Scene, batch: bool, tolerance: float
) -> tuple[np.ndarray, float]:
    """Values with derivatives: the derivatives `(n, 3)`, and seconds.

    Each scene with the cheapest model that is exact, as in `simulate`.
    """
    accuracy = Accuracy("measured", tolerance, FLOOR)
    varied = [leaf_places(scenes)[name] for name in PARAMETERS]
    leaves, structure = jax.tree.flatten(jax.tree.map(np.asarray, scenes))
    prepare(structure, leaves, accuracy, varied=varied)
    count = count_of(scenes)
    parts = [slice(None)] if batch else range(count)

    def of_leaf(leaf: np.ndarray, part):
        return leaf[part] if leaf.ndim else leaf

    found = np.empty((count, len(PARAMETERS)))
    begin = time.perf_counter()
    for part in parts:
        own = [of_leaf(leaf, part) for leaf in leaves]
        _, columns = compute_rows(structure, own, accuracy, varied=varied)
        e_n = [summary_of(column).e_n for column in columns]
        found[part] = np.stack(e_n, axis=-1)
    seconds = time.perf_counter() - begin
    # With respect to the parameter's logarithm
    sizes = [getattr(scenes.soil, name) for name in PARAMETERS]
    return found * np.stack([np.broadcast_to(x, count) for x in sizes], axis=1), seconds


def summary_of(rows: np.ndarray) -> ImpactSummary:
    """Name rows of numbers."""
    structure = jax.tree.structure(empty_summary(ledger=False))
    return jax.tree.unflatten(structure, list(rows))


def difference_gradient(
    method: Method, tolerance: float, step: float, scenes: Scene, batch: bool
) -> tuple[np.ndarray, float]:
    """Central differences with a method: the derivatives `(n, 3)`, and seconds, which
    are those of the value too."""
    seconds = method.solve(scenes, tolerance, batch).seconds
    columns = []
    for place in range(len(PARAMETERS)):
        sides = []
        for sign in (1.0, -1.0):
            shift = np.zeros(len(PARAMETERS))
            shift[place] = sign * step
            moved = jax.tree.map(np.asarray, shifted(scenes, shift))
            answer = method.solve(moved, tolerance, batch)
            seconds += answer.seconds
            sides.append(answer.e_n)
        columns.append((sides[0] - sides[1]) / (2.0 * step))
    return np.stack(columns, axis=1), seconds


def exact_gradient(scenes: Scene) -> np.ndarray:
    """Derivatives `(n, 3)` at the setting that errors are measured against."""
    return forward_gradient(scenes, True, EXACT.tolerance)[0]

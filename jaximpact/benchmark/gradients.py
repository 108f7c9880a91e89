"""Derivatives of e_n by the logarithms of soil parameters: forward, and differences."""

import concurrent.futures
import dataclasses
import functools
import time

import jax
import jax.numpy as jnp
import numpy as np

from ..compilation import unfused_jit
from ..laws import Laws
from ..marching import CORES
from ..model import MODELS, Model, model_places
from ..problem import Assembly
from ..scene import Scene
from ..simulation import compute_lanes
from .methods import EXACT, FLOOR, Method, count_of
from .scenes import choose

PARAMETERS = ("k_E", "gamma_v", "c_v")
LANES = 32
"""Impacts differentiated side by side."""


def shifted(scenes: Scene, shift) -> Scene:
    """The scenes with the logarithms of `PARAMETERS` changed by `(3,)`."""
    values = {
        name: getattr(scenes.soil, name) * factor
        for name, factor in zip(PARAMETERS, jnp.exp(shift), strict=True)
    }
    soil = dataclasses.replace(scenes.soil, **values)
    return Scene(scenes.block, soil, scenes.impact)


@functools.cache
def _compiled(model: Model):
    assembly = Assembly(Laws(), model, ledger=False)

    def e_n(shift, scenes, tolerance):
        value = compute_lanes(assembly, shifted(scenes, shift), tolerance, FLOOR).e_n
        return value, value

    # The shift is common to all lanes, so each lane's derivative is its own.
    return unfused_jit(jax.jacfwd(e_n, has_aux=True))


def forward_gradient(
    scenes: Scene, batch: bool, tolerance: float
) -> tuple[np.ndarray, float]:
    """Values with derivatives: the derivatives `(n, 3)`, and seconds.

    Each scene with the cheapest model that is exact, as in `simulate`.
    """
    size = LANES if batch else 1
    places = model_places(scenes)
    parts = []
    for place in np.unique(places):
        own = np.flatnonzero(places == place)
        function = _compiled(MODELS[int(place)])
        for first in range(0, len(own), size):
            parts.append((function, own[first : first + size]))

    def compute(part):
        function, own = part
        here = choose(scenes, np.resize(own, size))
        derivative, _ = function(jnp.zeros(len(PARAMETERS)), here, tolerance)
        return np.asarray(derivative)[: len(own)]

    for function in {part[0] for part in parts}:
        compute((function, parts[0][1]))  # compiles
    found = np.empty((count_of(scenes), len(PARAMETERS)))
    begin = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(CORES if batch else 1) as pool:
        for (_, own), values in zip(parts, pool.map(compute, parts), strict=True):
            found[own] = values
    return found, time.perf_counter() - begin


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

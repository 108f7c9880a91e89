"""Derivatives of e_n with respect to logarithms of soil parameters: forward mode, and
differences.

A peer that has derivatives of its own has a function `gradient` of scenes, batch or
not, and tolerance, which gives what `forward_gradient` does.
"""

import concurrent.futures
import time

import jax
import numpy as np

from jaximpact.accuracy import Accuracy
from jaximpact.backend.native_backend import (
    compile_native_along,
    kernel_inputs,
    solve_rows,
)
from jaximpact.backend.threads import thread_count
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import MODELS, model_places
from jaximpact.quantities import leaf_places
from jaximpact.scene import Scene

from ..impacts import PARAMETERS, choose, shifted
from .methods import EXACT, FLOOR, Method, count_of


def forward_gradient(
    scenes: Scene, batch: bool, tolerance: float
) -> tuple[np.ndarray, float]:
    """Values with derivatives: the derivatives `(n, 3)`, and seconds.

    Each scene with the cheapest model that is exact, as in `simulate`.
    """
    accuracy = Accuracy("measured", tolerance, FLOOR)
    varied = [leaf_places(scenes)[name] for name in PARAMETERS]
    places = model_places(scenes)
    kernels, parts = {}, []
    for place in np.unique(places):
        assembly = Assembly(jax.tree.structure(scenes), MODELS[place], ledger=False)
        kernels[place] = compile_native_along(assembly, len(PARAMETERS))
        own = np.flatnonzero(places == place)
        pieces = thread_count() if batch else len(own)
        parts += [(place, piece) for piece in np.array_split(own, pieces) if len(piece)]

    def compute(part) -> np.ndarray:
        place, own = part
        here = choose(scenes, own)
        inputs = np.stack(kernel_inputs(here, accuracy))
        rows, lanes = inputs.shape
        directions = np.zeros((len(varied), rows - 2, lanes))  # but tolerance and floor
        directions[np.arange(len(varied)), varied] = 1.0
        _, along = solve_rows(kernels[place], np.concatenate([inputs, *directions]))
        # With respect to the parameter's logarithm
        return np.stack(
            [
                column.e_n * getattr(here.soil, name)
                for name, column in zip(PARAMETERS, along, strict=True)
            ],
            axis=1,
        )

    found = np.empty((count_of(scenes), len(PARAMETERS)))
    begin = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(thread_count() if batch else 1) as pool:
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

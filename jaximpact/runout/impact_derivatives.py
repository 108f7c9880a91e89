"""Many impacts by the model, of numbers that carry derivatives."""

import concurrent.futures

import jax
import numpy as np

from ..accuracy import Accuracy
from ..engines.machine import (
    compile_native_along,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ..engines.threads import thread_count
from ..mechanics.model import MODELS, model_places
from ..mechanics.problem import Assembly
from ..scene import Scene
from .contact import Blow
from .dual import Dual, carries, plain, tangent_of

FIELDS = (
    *("normal_velocity", "tangential_velocity", "angular_velocity"),
    *("duration", "rotation", "final_sinking"),
)
"""Of the results of an impact, in the order of `Blow`."""
PART = 256
"""Impacts, times parameters, that a core takes at a time."""


def differentiate_impacts(scene: Scene, accuracy: Accuracy) -> tuple[Blow, np.ndarray]:
    """Impacts, and how what they do changes with what their scenes change with.

    Each derivative is one more run of the impact, along its direction, in code for
    derivatives by all leaves of a scene.

    Args:
        scene: fields `(lanes,)`, some of which carry derivatives.

    Returns:
        A blow that carries derivatives, and the outcomes; NaN where an impact failed.

    Raises NotImplementedError for laws without machine code, and off a CPU.
    """
    count, lanes = carries(scene), len(scene.impact.speed)
    leaves, structure = jax.tree.flatten(scene)
    values = np.stack([np.broadcast_to(plain(leaf), (lanes,)) for leaf in leaves])
    slopes = np.stack(
        [np.broadcast_to(_rows(leaf, count), (count, lanes)) for leaf in leaves], axis=1
    )
    # A derivative leaves the symmetry that a cheaper model rests on.
    known = np.where(np.any(slopes != 0.0, axis=0), np.nan, values)
    places = model_places(jax.tree.unflatten(structure, list(known)))
    jobs = []
    for place in np.unique(places):
        assembly = Assembly(jax.tree.structure(scene), MODELS[place], ledger=False)
        kernel = compile_native_along(assembly) if computes_on_cpu() else None
        if kernel is None:
            raise NotImplementedError(
                "derivatives of a run-out need machine code, which is for laws of "
                "known operations on a CPU"
            )
        pairs = np.argwhere(np.broadcast_to(places == place, (count, lanes)))
        jobs += [(kernel, pairs[i : i + PART].T) for i in range(0, len(pairs), PART)]
    found = np.full((len(FIELDS) + 1, lanes), np.nan)
    tangents = np.full((len(FIELDS), count, lanes), np.nan)

    def solve(job) -> None:
        kernel, (parameter, lane) = job
        inputs = with_setting(values[:, lane], accuracy)
        rows = np.concatenate([inputs, slopes[parameter, :, lane].T])
        numbers, (along,) = solve_rows(kernel, rows)
        found[:, lane] = [getattr(numbers, n) for n in (*FIELDS, "outcome_code")]
        tangents[:, parameter, lane] = [getattr(along, name) for name in FIELDS]

    with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
        list(pool.map(solve, jobs))
    blow = Blow(*(Dual(v, t) for v, t in zip(found[:-1], tangents, strict=True)))
    return blow, found[-1].astype(int)


def _rows(leaf, count: int) -> np.ndarray:
    tangent = tangent_of(leaf, count)
    return tangent if tangent.ndim > 1 else tangent[:, None]

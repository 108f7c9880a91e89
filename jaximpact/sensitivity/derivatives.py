"""Results of many impacts and their derivatives by one parameter, in machine code."""

import concurrent.futures
from collections.abc import Callable

import jax
import numpy as np

from ..accuracy import Accuracy
from ..engines.machine import (
    along_leaves,
    compile_native_along,
    kernel_inputs,
    solve_rows,
)
from ..engines.marching import CORES
from ..formats.columns import InputColumn, leaf_places
from ..mechanics.model import MODELS, model_places
from ..mechanics.problem import Assembly
from ..scene import Scene
from ..summary import Numbers, numbers_of_no_value

PART = 256
"""Impacts that a core takes at a time; the last of a part leave lanes empty."""


def derivatives(
    scene: Scene,
    column: InputColumn,
    accuracy: Accuracy,
    done: Callable[[int], None],
) -> tuple[Numbers, Numbers]:
    """Results, and their derivatives by one parameter in SI units.

    One parameter at a time, by the same program for all: it takes some 4 s to make.

    Args:
        scene: fields `(n,)`.
        column: the parameter.
        done: told how many impacts more are computed.

    Returns:
        Numbers with fields `(n,)` and the derivatives of each; NaN where the
        integration failed.
    """
    leaf = leaf_places(scene)[column.name]
    leaves, structure = jax.tree.flatten(scene)
    leaves = [np.asarray(x) for x in leaves]
    # A derivative leaves the symmetry that a cheaper model rests on.
    unknown = [
        np.full_like(x, np.nan) if i == leaf else x for i, x in enumerate(leaves)
    ]
    models = model_places(jax.tree.unflatten(structure, unknown), 0.0)
    count = len(leaves[0])
    rows = len(jax.tree.leaves(numbers_of_no_value(ledger=False)))
    values, slopes = np.empty((rows, count)), np.empty((rows, count))
    jobs = []
    for model in np.unique(models):
        kernel = compile_native_along(Assembly(structure, MODELS[model], False))
        chosen = np.flatnonzero(models == model)
        jobs += [
            (kernel, chosen[start : start + PART])
            for start in range(0, len(chosen), PART)
        ]

    def solve(job) -> None:
        kernel, places = job
        part = jax.tree.unflatten(structure, [x[places] for x in leaves])
        inputs = along_leaves(np.stack(kernel_inputs(part, accuracy)), leaf)
        numbers, along = solve_rows(kernel, inputs)
        values[:, places] = jax.tree.leaves(numbers)
        slopes[:, places] = jax.tree.leaves(along)
        done(len(places))

    pool = concurrent.futures.ThreadPoolExecutor(CORES)
    try:
        for _ in pool.map(solve, jobs):
            pass
    finally:
        pool.shutdown(cancel_futures=True)
    of_numbers = jax.tree.structure(numbers_of_no_value(ledger=False))
    return (
        jax.tree.unflatten(of_numbers, list(values)),
        jax.tree.unflatten(of_numbers, list(slopes)),
    )

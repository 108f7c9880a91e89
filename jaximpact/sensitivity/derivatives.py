"""Results of many impacts and their derivatives by one parameter: in machine code, and
in XLA where there is none."""

import concurrent.futures
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from ..accuracy import Accuracy
from ..batch import by_shape
from ..engines.compilation import unfused_jit
from ..engines.machine import (
    along_leaves,
    compile_native_along,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ..engines.threads import thread_count
from ..engines.xla import compute_lanes
from ..formats.columns import InputColumn, leaf_places
from ..mechanics.model import MODELS, model_places
from ..mechanics.problem import Assembly
from ..numbers import Numbers, numbers_of_no_value
from ..scene import Scene

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
    count = len(np.asarray(scene.impact.speed))
    rows = len(jax.tree.leaves(numbers_of_no_value(ledger=False)))
    values, slopes = np.empty((rows, count)), np.zeros((rows, count))
    jobs = []
    for alone, of_shape in by_shape(scene):
        # A parameter that the shape does not have changes nothing.
        leaf = leaf_places(alone).get(column.name)
        structure = jax.tree.structure(alone)
        leaves = np.stack([np.asarray(x) for x in jax.tree.leaves(alone)])
        # A derivative leaves the symmetry that a cheaper model rests on.
        unknown = list(leaves)
        if leaf is not None:
            unknown[leaf] = np.full(count, np.nan)
        models = model_places(jax.tree.unflatten(structure, unknown), 0.0)
        models = np.where(of_shape, models, -1)
        for model in np.unique(models[models >= 0]):
            assembly = Assembly(structure, MODELS[model], False)
            kernel = compile_native_along(assembly) if computes_on_cpu() else None
            chosen = np.flatnonzero(models == model)
            jobs += [
                (assembly, kernel, leaves, leaf, chosen[start : start + PART])
                for start in range(0, len(chosen), PART)
            ]

    def solve(job) -> None:
        assembly, kernel, leaves, leaf, places = job
        part, by = leaves[:, places], leaf or 0
        if kernel is None:
            numbers, along = _in_xla(
                assembly, by, list(part), accuracy.tolerance, accuracy.floor
            )
        else:
            inputs = along_leaves(with_setting(part, accuracy), by)
            numbers, (along,) = solve_rows(kernel, inputs)
        values[:, places] = jax.tree.leaves(numbers)
        if leaf is not None:
            slopes[:, places] = jax.tree.leaves(along)
        done(len(places))

    pool = concurrent.futures.ThreadPoolExecutor(thread_count())
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


def _along_leaf(assembly: Assembly, leaf: int, rows: list, tolerance, floor):
    """Numbers of lanes, and their derivatives by one leaf of the scene."""

    def of_leaf(values):
        all_rows = [*rows[:leaf], values, *rows[leaf + 1 :]]
        scene = jax.tree.unflatten(assembly.structure, all_rows)
        return compute_lanes(assembly, scene, tolerance, floor)

    return jax.jvp(of_leaf, (rows[leaf],), (jnp.ones_like(rows[leaf]),))


_in_xla = unfused_jit(_along_leaf, static_argnums=(0, 1))

"""Derivatives of many impacts with respect to one parameter.

`derivatives` differentiates the model itself; `differences` checks that by finite
differences of neighbouring impacts.
"""

import concurrent.futures
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from ..accuracy import Accuracy
from ..backend.native_backend import (
    along_leaves,
    compile_native_along,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ..backend.threads import thread_count
from ..backend.xla_backend import compute_lanes
from ..backend.xla_compilation import unfused_jit
from ..batch import by_shape, simulate_batch
from ..impact.problem import Assembly
from ..impact.reduced_models import MODELS, model_places
from ..impact.results import ImpactSummary, empty_summary
from ..quantities import InputColumn, ResultColumn, leaf_places
from ..scene import Scene
from ..scene_quantities import scene_with, value_of

PART = 256
"""Impacts that a core computes at a time."""


POINTS = 5
STENCILS = {
    -2: np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0,
    0: np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0,
    -4: np.array([3.0, -16.0, 36.0, -48.0, 25.0]) / 12.0,
}
"""Offset of the first of five equidistant points from the parameter, in steps, and
weights of a slope of fourth order: central, and one-sided at the edge of a range."""
DIFFERENCE_ACCURACY = "reference"
"""Accuracy of the impacts whose differences are taken: errors of 1e-9 leave a slope
over steps of 1e-3 some six digits."""


class Differences(NamedTuple):
    """Slopes by finite differences [unit of the output per unit of the parameter]."""

    slope: Float[np.ndarray, "scenes outputs"]
    """Slope; NaN where a neighbour has no value or would be out of range."""
    roughness: Float[np.ndarray, "scenes outputs"]
    """Largest third or fourth difference over the step. With the step it tends to zero
    where the output is smooth, and to a jump's height or a kink's change of slope where
    one lies among the points."""


def derivatives(
    scene: Scene,
    column: InputColumn,
    accuracy: Accuracy,
    done: Callable[[int], None],
) -> tuple[ImpactSummary, ImpactSummary]:
    """Compute results, and their derivatives with respect to one parameter in SI units.

    One program serves all parameters, one at a time; it compiles for some 4 s. It runs
    in machine code, and in XLA where the laws have none.

    Args:
        scene: fields `(n,)`.
        column: the parameter.
        accuracy: of the integration.
        done: called with the number of impacts that were computed since the last call.

    Returns:
        Numbers with fields `(n,)`, and the derivatives of each; NaN where the
        integration failed.
    """
    count = len(np.asarray(scene.impact.speed))
    rows = len(jax.tree.leaves(empty_summary(ledger=False)))
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
    of_numbers = jax.tree.structure(empty_summary(ledger=False))
    return (
        jax.tree.unflatten(of_numbers, list(values)),
        jax.tree.unflatten(of_numbers, list(slopes)),
    )


def _along_leaf(assembly: Assembly, leaf: int, rows: list, tolerance, floor):
    """Compute numbers of lanes, and their derivatives with respect to one leaf of the
    scene."""

    def of_leaf(values):
        all_rows = [*rows[:leaf], values, *rows[leaf + 1 :]]
        scene = jax.tree.unflatten(assembly.structure, all_rows)
        return compute_lanes(assembly, scene, tolerance, floor)

    return jax.jvp(of_leaf, (rows[leaf],), (jnp.ones_like(rows[leaf]),))


_in_xla = unfused_jit(_along_leaf, static_argnums=(0, 1))


def differences(
    scene: Scene,
    column: InputColumn,
    outputs: tuple[ResultColumn, ...],
    step: float,
    done: Callable[[int], None],
) -> Differences:
    """Compute slopes with respect to a parameter by differences over five points.

    Args:
        scene: fields `(n,)`.
        column: the parameter.
        outputs: columns of the results whose slopes are wanted.
        step: distance of the points, as a fraction of the parameter's size.
        done: called with the number of impacts that were computed.
    """
    center = value_of(scene, column)
    width = step * size_of(column, center)
    first = _first_points(column, center, width)
    known = ~np.isnan(first)
    slope = np.full((len(center), len(outputs)), np.nan)
    roughness = np.full_like(slope, np.nan)
    if not known.any():
        return Differences(slope, roughness)
    offsets = first[known, None] + np.arange(POINTS)
    points = center[known, None] + offsets * width[known, None]
    base = jax.tree.map(lambda x: np.repeat(np.asarray(x)[known], POINTS), scene)
    result = simulate_batch(
        scene_with(base, {column.name: points.ravel()}), accuracy=DIFFERENCE_ACCURACY
    )
    weights = np.stack([STENCILS[int(offset)] for offset in first[known]])
    for number, output in enumerate(outputs):
        values = np.asarray(getattr(result, output.field)).reshape(-1, POINTS)
        slope[known, number] = np.sum(weights * values, axis=1) / width[known]
        higher = [np.abs(np.diff(values, n=order)).max(axis=1) for order in (3, 4)]
        roughness[known, number] = np.maximum(*higher) / width[known]
    done(points.size)
    return Differences(slope, roughness)


def size_of(column: InputColumn, values: np.ndarray) -> np.ndarray:
    """Return the size by which changes of a parameter are measured: its absolute value;
    where that is zero its default, or one SI unit if that is zero too."""
    typical = abs(column.default) or 1.0 / column.factor
    return np.where(values == 0.0, typical, np.abs(values))


def _first_points(column: InputColumn, center, width) -> np.ndarray:
    """Return the offset of the first point, in steps; NaN where no five points are in
    the parameter's range."""
    first = np.full(len(center), np.nan)
    for offset in reversed(STENCILS):
        ends = [
            column.is_allowed(center + (offset + end) * width)
            for end in (0, POINTS - 1)
        ]
        first[np.logical_and(*ends)] = offset
    return first

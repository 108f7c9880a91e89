"""Derivatives of many impacts with respect to parameters.

`derivatives` differentiates the model itself; `differences` checks that by finite
differences of neighbouring impacts.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import numpy as np
from jaxtyping import Float

from ..accuracy import Accuracy
from ..backend.rows import compute_rows, in_parts
from ..batch import simulate_batch
from ..impact.results import ImpactSummary, empty_summary
from ..quantities import InputColumn, ResultColumn, leaf_places
from ..scene import Scene
from ..scene_quantities import scene_with, value_of
from ..shapes import each_shape

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
    columns: Sequence[InputColumn],
    accuracy: Accuracy,
    done: Callable[[int], None],
) -> tuple[ImpactSummary, list[ImpactSummary]]:
    """Compute results, and their derivatives with respect to parameters in SI units.

    Args:
        scene: fields `(n,)`.
        columns: the parameters; three are computed together.
        accuracy: of the integration.
        done: called with the number of impacts that were computed since the last call,
            one for each parameter.

    Returns:
        Numbers with fields `(n,)`, and for each parameter the derivatives of each; NaN
        where the integration failed.
    """
    count = len(np.asarray(scene.impact.speed))
    of_numbers = jax.tree.structure(empty_summary(ledger=False))
    values = np.empty((of_numbers.num_leaves, count))
    slopes = np.zeros((len(columns), *values.shape))
    for alone, lanes in each_shape(scene):
        leaves, structure = jax.tree.flatten(alone)
        places = leaf_places(alone)
        # A parameter that the shape does not have changes nothing.
        known = [k for k, column in enumerate(columns) if column.name in places]
        varied = [places[columns[k].name] for k in known]
        places_of = np.arange(count)[lanes]
        for part in in_parts(np.arange(len(places_of))):
            of_part = [np.asarray(leaf)[part] for leaf in leaves]
            rows, along = compute_rows(structure, of_part, accuracy, varied=varied)
            values[:, places_of[part]] = rows
            for k, column in zip(known, along, strict=True):
                slopes[k][:, places_of[part]] = column
            done(len(part) * len(columns))
    numbers, *of_columns = (
        jax.tree.unflatten(of_numbers, list(rows)) for rows in (values, *slopes)
    )
    return numbers, of_columns


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

"""Derivatives by differences of neighbouring impacts: the check on those of JAX."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import numpy as np
from jaxtyping import Float

from ..batch import simulate_batch
from ..formats.columns import InputColumn, ResultColumn
from ..formats.scenes import scene_with, value_of
from ..scene import Scene

POINTS = 5
STENCILS = {
    -2: np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0,
    0: np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0,
    -4: np.array([3.0, -16.0, 36.0, -48.0, 25.0]) / 12.0,
}
"""Place of the first of five equidistant points, in steps, and weights of a slope of
fourth order: central, and one-sided for a parameter at the edge of its range."""
ACCURACY = "reference"
"""Errors of 1e-9 leave a slope over steps of 1e-3 some six digits."""


class Differences(NamedTuple):
    """Slopes by differences, in the unit of the output by a unit of the parameter."""

    slope: Float[np.ndarray, "scenes outputs"]
    """NaN where a neighbour has no value, or would be out of range."""
    roughness: Float[np.ndarray, "scenes outputs"]
    """Largest third or fourth difference over the step. It tends to zero with the step
    where the output is smooth, and to a jump's height or a kink's change of slope where
    one lies among the points."""


def differences(
    scene: Scene,
    column: InputColumn,
    outputs: tuple[ResultColumn, ...],
    step: float,
    done: Callable[[int], None],
) -> Differences:
    """Slopes by a parameter over five points.

    Args:
        scene: fields `(n,)`.
        column: the parameter.
        outputs: whose slopes.
        step: between points, as a part of the parameter's size.
        done: told how many impacts more are computed.
    """
    center = value_of(scene, column)
    width = step * size_of(column, center)
    first = _first_places(column, center, width)
    known = ~np.isnan(first)
    slope = np.full((len(center), len(outputs)), np.nan)
    roughness = np.full_like(slope, np.nan)
    if not known.any():
        return Differences(slope, roughness)
    places = first[known, None] + np.arange(POINTS)
    points = center[known, None] + places * width[known, None]
    base = jax.tree.map(lambda x: np.repeat(np.asarray(x)[known], POINTS), scene)
    result = simulate_batch(
        scene_with(base, {column.name: points.ravel()}), accuracy=ACCURACY
    )
    weights = np.stack([STENCILS[int(place)] for place in first[known]])
    for number, output in enumerate(outputs):
        values = np.asarray(getattr(result, output.field)).reshape(-1, POINTS)
        slope[known, number] = np.sum(weights * values, axis=1) / width[known]
        higher = [np.abs(np.diff(values, n=order)).max(axis=1) for order in (3, 4)]
        roughness[known, number] = np.maximum(*higher) / width[known]
    done(points.size)
    return Differences(slope, roughness)


def size_of(column: InputColumn, values: np.ndarray) -> np.ndarray:
    """What a parameter's changes are measured by: itself; where it is zero its default,
    or one SI unit if that is zero too."""
    typical = abs(column.default) or 1.0 / column.factor
    return np.where(values == 0.0, typical, np.abs(values))


def _first_places(column: InputColumn, center, width) -> np.ndarray:
    """Where to begin, in steps; NaN where no five points are in range."""
    first = np.full(len(center), np.nan)
    for place in reversed(STENCILS):
        ends = [
            column.is_allowed(center + (place + end) * width) for end in (0, POINTS - 1)
        ]
        first[np.logical_and(*ends)] = place
    return first

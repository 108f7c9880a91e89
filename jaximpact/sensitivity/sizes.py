"""What counts as zero: natural sizes of the results of an impact."""

import numpy as np

from ..accuracy import Accuracy
from ..formats.columns import ResultColumn
from ..scene import GRAVITY, Scene

ZERO_WITHIN = 0.1
"""Part of the accuracy's tolerance below which an output over its natural size is not
told from zero; 95 of 100 errors of e_n are below 0.2 of it at any accuracy."""


def natural_size(scene: Scene, column: ResultColumn) -> np.ndarray:
    """Size by which a result is judged to be zero or not, in its unit.

    Made of the block's radius, speed and weight; 1 for what has no dimension. For zero
    alone: results may be many times larger.
    """
    radius = np.asarray(scene.block.semi_axes.minor)
    speed = np.asarray(scene.impact.speed)
    weight = GRAVITY * np.asarray(scene.block.mass)
    sizes = {
        "-": np.ones_like(speed),
        "rad": np.ones_like(speed),
        "m": radius,
        "m/s": speed,
        "rad/s": speed / radius,
        "s": radius / speed,
        "N": weight,
        "N m": weight * radius,
    }
    return sizes[column.unit]


def is_zero(values, scene: Scene, column: ResultColumn, accuracy: Accuracy):
    """Where a result is zero to the integration's error."""
    least = ZERO_WITHIN * accuracy.tolerance * natural_size(scene, column)
    return np.abs(values) <= least

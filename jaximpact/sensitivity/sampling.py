"""Impacts at sampled values of the parameters."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float

from ..accuracy import Accuracy
from ..batch import simulate_batch
from ..fields import whole_number
from ..formats.columns import ResultColumn
from ..formats.results import count_outcomes
from ..formats.scenes import scene_with
from ..scene import Scene
from .ranges import Range

LARGEST_SEED = 2**32 - 2
"""SALib's own limit, less the one that is added."""


def sampled_outputs(
    base: Scene,
    ranges: Mapping[str, Range],
    shares: Float[np.ndarray, "rows parameters"],
    outputs: tuple[ResultColumn, ...],
    accuracy: Accuracy,
    journal: Path | None,
    progress: Callable[[int, int], None] | None,
) -> tuple[Float[np.ndarray, "rows outputs"], dict[str, int]]:
    """Outputs at shares of the ranges, NaN where there is none, and how many impacts
    ended in which way."""
    values = {
        name: given.values(shares[:, place])
        for place, (name, given) in enumerate(ranges.items())
    }
    result = simulate_batch(
        scene_with(base, values),
        accuracy=accuracy,
        journal=journal,
        progress=progress,
    )
    columns = [np.asarray(getattr(result, column.field)) for column in outputs]
    return np.stack(columns, axis=1), count_outcomes(result)


def check_seed(seed: int) -> None:
    """Raise InputError for what is no seed."""
    whole_number("seed", seed, 0, LARGEST_SEED)

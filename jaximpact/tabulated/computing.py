"""Impacts of one block on one ground, by the full model."""

from collections.abc import Callable

import jax
import numpy as np

from ..accuracy import Accuracy
from ..block import Block
from ..runout.rebounds import Blows, FullModel
from ..scene import Impact
from ..soil import Soil

PART = 20_000
"""Impacts computed between two calls of `progress`."""


def compute(
    block: Block,
    soil: Soil,
    impact: Impact,
    accuracy: str | Accuracy,
    progress: Callable[[int, int], None] | None = None,
) -> Blows:
    """Impacts of one block on one ground, by the full model."""
    model = FullModel(accuracy)
    impact = jax.tree.map(np.asarray, impact)
    count = len(impact.speed)
    parts = []
    # Every part takes its share of the long contacts.
    stride = -(-count // PART)
    for start in range(stride):
        chosen = slice(start, None, stride)
        some = jax.tree.map(lambda leaf: leaf[chosen], impact)  # noqa: B023
        many = len(some.speed)

        def spread(leaf, many=many):
            return np.broadcast_to(np.asarray(leaf), (many,))

        parts.append(
            model(jax.tree.map(spread, block), jax.tree.map(spread, soil), some)
        )
        if progress is not None:
            progress(sum(len(part.outcome) for part in parts), count)

    def whole(*columns):
        result = np.empty(count, columns[0].dtype)
        for start, column in enumerate(columns):
            result[start::stride] = column
        return result

    return jax.tree.map(whole, *parts)

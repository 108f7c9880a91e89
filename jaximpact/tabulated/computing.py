"""Impacts of one block on one ground, by the full model."""

from collections.abc import Callable

import jax
import numpy as np

from ..accuracy import Accuracy
from ..block import Block
from ..formats.journal import Journal
from ..runout.contact import Blow
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
    journal: Journal | None = None,
) -> Blows:
    """Impacts of one block on one ground, by the full model.

    Args:
        journal: keeps the columns of `Blow` and the outcome, by the impact's place;
            what stands there is not computed again.
    """
    model = FullModel(accuracy)
    impact = jax.tree.map(np.asarray, impact)
    count = len(impact.speed)
    columns = np.full((count, len(Blow._fields) + 1), np.nan)
    done = np.zeros(count, bool)
    if journal is not None:
        places, numbers = journal.rows()
        columns[places], done[places] = numbers, True
    # Every part takes its share of the long contacts.
    stride = -(-count // PART)
    for start in range(stride):
        chosen = np.arange(start, count, stride)
        chosen = chosen[~done[chosen]]
        if len(chosen):
            columns[chosen] = _part(model, block, soil, impact, chosen)
            done[chosen] = True
            if journal is not None:
                journal.append(chosen, columns[chosen])
        if progress is not None:
            progress(int(np.sum(done)), count)
    return Blows(Blow(*columns.T[:-1]), columns[:, -1].astype(int))


def _part(model: FullModel, block, soil, impact: Impact, chosen) -> np.ndarray:
    """Columns of some impacts."""
    some = jax.tree.map(lambda leaf: leaf[chosen], impact)

    def spread(leaf):
        return np.broadcast_to(np.asarray(leaf), (len(chosen),))

    blows = model(jax.tree.map(spread, block), jax.tree.map(spread, soil), some)
    return np.stack([*blows.blow, blows.outcome], axis=1)

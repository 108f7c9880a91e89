"""Contacts of a run-out by tables."""

from collections.abc import Sequence

import jax
import numpy as np

from ..block import Block
from ..errors import InputError
from ..outcomes import Outcome
from ..runout.contact import Blow
from ..runout.rebounds import Blows
from ..scene import Impact
from ..soil import Soil
from .table import Entry, ReboundTable, look_up_many

PART = 512
"""Impacts looked up at once. Always so many, so that nothing is compiled again and the
result of a lane does not depend, to the last bit, on how many run beside it."""
ROUNDING = 1e-12
"""Relative."""


class Tabulated:
    """Every contact looked up in a table, for `simulate_runout`.

    Args:
        tables: one for each pair of block and ground that will meet.

    Impacts beyond a table fail, and end their trajectories so. Raises InputError for a
    block on a ground that no table was made for.
    """

    def __init__(self, tables: ReboundTable | Sequence[ReboundTable]):
        self.tables = [tables] if isinstance(tables, ReboundTable) else list(tables)

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> Blows:
        impact = jax.tree.map(np.asarray, impact)
        count = len(impact.speed)
        columns = np.full((len(Entry._fields), count), np.nan)
        open_yet = np.ones(count, bool)
        for table in self.tables:
            chosen = open_yet & _same((block, soil), (table.block, table.soil), count)
            if np.any(chosen):
                columns[:, chosen] = _in_parts(
                    table,
                    jax.tree.map(lambda leaf: leaf[chosen], impact),  # noqa: B023
                )
                open_yet &= ~chosen
        if np.any(open_yet):
            lane = int(np.argmax(open_yet))
            ratio = np.broadcast_to(np.asarray(block.aspect_ratio), (count,))[lane]
            mass = np.broadcast_to(np.asarray(block.mass), (count,))[lane]
            raise InputError(
                f"no table was made for a block of {mass:g} kg with aspect ratio "
                f"{ratio:g} on the ground that it struck; tabulate that pair too"
            )
        outcome = columns[-1].astype(int)
        columns[:-1, outcome == Outcome.failed] = np.nan
        return Blows(Blow(*columns[:-1]), outcome)


def _same(ours, theirs, count: int) -> np.ndarray:
    """Where all numbers are the same, but for the rounding of a file's units."""
    same = np.ones(count, bool)
    for a, b in zip(jax.tree.leaves(ours), jax.tree.leaves(theirs), strict=True):
        b = float(b)
        same &= np.abs(np.asarray(a) - b) <= ROUNDING * abs(b)
    return same


def _in_parts(table: ReboundTable, impact: Impact) -> np.ndarray:
    """Entries as columns."""
    count = len(impact.speed)
    columns = np.empty((len(Entry._fields), count))
    for start in range(0, count, PART):
        part = slice(start, min(start + PART, count))
        size = part.stop - part.start
        padded = jax.tree.map(
            lambda leaf: np.pad(leaf[part], (0, PART - size), "edge"),  # noqa: B023
            impact,
        )
        entry = look_up_many(table, padded)
        columns[:, part] = [np.asarray(column)[:size] for column in entry]
    return columns

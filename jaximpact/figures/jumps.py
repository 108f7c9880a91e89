"""Curves that jump: where they do, and the pieces in which they are to be drawn.

A block whose resultant just reaches the edge of its foundation leaves earlier than one
whose resultant just does not, and every result jumps with the end of the contact. Both
may have the same outcome, which does not tell then. The duration does: over a jump it
changes by as much however close the two sides are.
"""

import numpy as np
import pandas as pd

from ..accuracy import Accuracy
from ..formats.columns import OUTCOME_COLUMN
from ..scene import Scene
from ..sweeping import Axes
from .impact_table import impact_table, impacts_at

DURATION = "duration_s"
BRANCH = "branch"
"""Column that counts the pieces of a curve: from 0, one more after each jump."""
JUMP = 0.05
"""Change of the duration, by the longer one, that is a jump if it remains."""
HALVINGS = 10
"""How often the interval about a jump is halved."""


def curves_with_jumps(
    base: Scene,
    axes: Axes,
    along: str,
    results: tuple[str, ...],
    accuracy: str | Accuracy,
) -> pd.DataFrame:
    """Impacts along curves, with both sides of every jump.

    Args:
        base, axes, accuracy: as for `sweep`.
        along: the axis that runs along a curve; the others number the curves.
        results: columns wanted beside the axes, duration and outcome.

    Returns:
        The rows of each curve in turn, with the further column `branch`. The two sides
        of a jump, which are rows of their own, lie 1/1024 of the distance between
        neighbours apart. Of several jumps between the same neighbours one is found.
    """
    results = (*results, DURATION)
    across = [axis for axis in axes if axis != along]
    grid = impact_table(base, axes, results, accuracy)
    grid = grid.sort_values([*across, along], ignore_index=True)
    same_curve = (grid[across].shift(-1) == grid[across]).all(axis=1)
    before = np.flatnonzero(same_curve)
    left, right = (grid.loc[before + i].reset_index(drop=True) for i in (0, 1))
    for _ in range(HALVINGS):
        left, right = _jumping(left, right)
        points = left[[*across, along]].assign(
            **{along: 0.5 * (left[along] + right[along])}
        )
        if points.empty:
            break
        middle = impacts_at(base, points, results, accuracy)
        in_left_half = _change(left, middle) > _change(middle, right)
        left, right = (
            pd.concat([left[in_left_half], middle[~in_left_half]]).sort_index(),
            pd.concat([middle[in_left_half], right[~in_left_half]]).sort_index(),
        )
    left, right = _jumping(left, right)
    rows = [side.assign(starts=i) for i, side in enumerate((grid, left, right))]
    table = pd.concat(rows).drop_duplicates([*across, along], keep="last")
    table = table.sort_values([*across, along], ignore_index=True)
    starts = table["starts"] == 2
    table[BRANCH] = starts.groupby([table[axis] for axis in across]).cumsum()
    return table[[*across, along, BRANCH, *results, OUTCOME_COLUMN]]


def _jumping(left: pd.DataFrame, right: pd.DataFrame):
    """Those pairs of rows between which there may be a jump."""
    jumping = _change(left, right) > JUMP
    return (side[jumping].reset_index(drop=True) for side in (left, right))


def _change(left: pd.DataFrame, right: pd.DataFrame) -> pd.Series:
    """Change of the duration, by the longer one; NaN beside impacts that failed."""
    one, other = left[DURATION], right[DURATION]
    return (one - other).abs() / np.maximum(one, other)

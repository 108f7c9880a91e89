"""Tables that figures are drawn from: impacts, their time series, curves with jumps.

Curves jump where a block whose resultant just reaches the edge of its foundation leaves
earlier than one whose resultant just does not: every result jumps with the end of the
contact. Both may have the same outcome, which does not tell then. The duration does:
over a jump it changes by as much however close the two sides are.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from jaximpact.accuracy import Accuracy
from jaximpact.quantities import OUTCOME_COLUMN
from jaximpact.scene import Scene
from jaximpact.sweeping import Axes, sweep

from ..study import Study

Table = Any
"""A pandas.DataFrame, whose own annotations give a Series for every choice of rows."""
HALF_TURN = np.linspace(0.0, 180.0, 181)
"""Orientations for curves [deg]: what comes after repeats. (The sets have every fifth,
which is too few where curves jump.)"""
SERIES = {
    "time_s": "time",
    "penetration_m": "penetration",
    "normal_force_N": "normal_force",
    "rotation_rad": "rotation",
    "R_r": "rotational_ratio",
}
"""Column -> field of the history."""
ORIENTATION, DURATION = "orientation_deg", "duration_s"
BRANCH = "branch"
"""Column that counts the pieces of a curve: from 0, one more after each jump."""
JUMP = 0.05
"""Change of the duration, by the longer one, that is a jump if it remains."""
HALVINGS = 10
"""Number of halvings of the interval about a jump."""


class PaperFigure(NamedTuple):
    """A figure that can be asked for by its number in the paper."""

    number: str
    title: str
    """Title in a line."""
    sets: tuple[str, ...]
    """The parametric sets that it is computed from; none: the slope run-out."""
    compute: Callable[[Study], Table]
    """The table: a row for each point, columns named with units as in `columns`."""
    draw: Callable[[Table], Figure]
    """The figure, from the table alone."""

    @property
    def name(self) -> str:
        """Name of its files, without suffix."""
        return f"figure-{self.number}"


def impact_table(
    base: Scene, axes: Axes, results: tuple[str, ...], accuracy: str | Accuracy
) -> Table:
    """Impacts at every combination of the values along the axes, the last axis fastest.

    Args:
        base, axes, accuracy: as for `sweep`.
        results: columns wanted beside the axes and the outcome.
    """
    dataset = sweep(base, axes, accuracy=accuracy)[[*results, OUTCOME_COLUMN]]
    return dataset.to_dataframe().reset_index()


def series_table(
    study: Study, name: str, points: Sequence[Mapping], series: Sequence[str]
) -> Table:
    """Time series one below another, a row for the start and for each step of the
    integration, with the point and the outcome in every row.

    Steps are as the integration took them: dense where forces change fast, and the last
    one on the end of the contact, which a common grid of times would cut off.
    """
    parts = []
    recorded = study.record(name, points)
    for point, (outcome, history) in zip(points, recorded, strict=True):
        columns = {column: getattr(history, SERIES[column]) for column in series}
        parts.append(pd.DataFrame({**point, **columns, OUTCOME_COLUMN: outcome}))
    return pd.concat(parts, ignore_index=True)


def peak(time: np.ndarray, values: np.ndarray) -> float:
    """Largest value of a time series, between its rows too: by the parabola through the
    largest one and its neighbours. At either end it is the value there; NaN if a value
    is not finite."""
    if not np.all(np.isfinite(values)):
        return float("nan")
    place = int(np.argmax(values))
    if place in (0, len(values) - 1):
        return float(values[place])
    around = slice(place - 1, place + 2)
    scaled = (time[around] - time[place]) / (time[place + 1] - time[place - 1])
    second, first, height = np.polyfit(scaled, values[around], 2)
    return float(height - 0.25 * first**2 / second) if second < 0.0 else float(height)


def curves_with_jumps(study: Study, name: str, results: tuple[str, ...]) -> Table:
    """Impacts along curves over half a turn, with both sides of every jump.

    Args:
        name: of the parametric set; what else varies in it numbers the curves.
        results: columns wanted beside the axes, duration and outcome.

    Returns:
        The rows of each curve in turn, with the further column `branch`. The two sides
        of a jump, which are rows of their own, lie 1/1024 of the distance between
        neighbours apart. Of several jumps between the same neighbours one is found.
    """
    base, axes = study.parametric_set(name)
    results, along = (*results, DURATION), ORIENTATION
    across = [axis for axis in axes if axis != along]
    grid = impact_table(base, {**axes, along: HALF_TURN}, results, study.accuracy)
    grid = grid.sort_values([*across, along], ignore_index=True)
    same_curve = (grid[across].shift(-1) == grid[across]).all(axis=1)
    before = np.flatnonzero(same_curve)
    left, right = (grid.loc[before + i].reset_index(drop=True) for i in (0, 1))
    for _ in range(HALVINGS):
        left, right = _jumping(left, right)
        if left.empty:
            break
        points = {axis: left[axis].to_numpy() for axis in across}
        points[along] = (0.5 * (left[along] + right[along])).to_numpy()
        middle = impact_table(base, {"point": points}, results, study.accuracy)
        middle = middle.drop(columns="point")
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


def _jumping(left: Table, right: Table):
    """Those pairs of rows between which there may be a jump."""
    jumping = _change(left, right) > JUMP
    return (side[jumping].reset_index(drop=True) for side in (left, right))


def _change(left: Table, right: Table) -> Table:
    """Change of the duration, by the longer one; NaN beside impacts that failed."""
    one, other = left[DURATION], right[DURATION]
    return (one - other).abs() / np.maximum(one, other)

"""Tables of impacts: a row for each, its quantities and its results in columns."""

import pandas as pd

from ..accuracy import Accuracy
from ..formats.columns import OUTCOME_COLUMN
from ..scene import Scene
from ..sweeping import Axes, sweep


def impact_table(
    base: Scene, axes: Axes, results: tuple[str, ...], accuracy: str | Accuracy
) -> pd.DataFrame:
    """Impacts at every combination of the values along the axes, the last axis fastest.

    Args:
        base, axes, accuracy: as for `sweep`.
        results: columns wanted beside the axes and the outcome.
    """
    dataset = sweep(base, axes, accuracy=accuracy)[[*results, OUTCOME_COLUMN]]
    return dataset.to_dataframe().reset_index()


def impacts_at(
    base: Scene,
    points: pd.DataFrame,
    results: tuple[str, ...],
    accuracy: str | Accuracy,
) -> pd.DataFrame:
    """The points, a row each, with results and outcome of their impacts appended."""
    quantities = {name: points[name].to_numpy() for name in points}
    table = impact_table(base, {"point": quantities}, results, accuracy)
    return table[[*quantities, *results, OUTCOME_COLUMN]]

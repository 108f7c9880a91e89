"""What the drawings of a sensitivity study share."""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..formats.files import replacing
from ..plotting import plain

MOST_COLUMNS = 4
DIMENSIONS = {"parameter", "output"}


def check_dimensions(dataset: xr.Dataset, variable: str, more: int = 0) -> None:
    """Raise ValueError unless a dataset holds the variable, over parameters, outputs
    and so many dimensions more."""
    if variable not in dataset:
        raise ValueError(f"the dataset must hold {variable}, but holds {list(dataset)}")
    found = set(dataset[variable].dims) - DIMENSIONS
    if len(found) != more:
        raise ValueError(
            f"the drawing takes {more} dimensions beside parameter and output, but the "
            f"dataset has {sorted(map(str, found))}; choose with .sel or .isel"
        )


def panels(count: int, width: float, height: float, title: str):
    """A figure with so many panels in rows."""
    columns = min(count, MOST_COLUMNS)
    rows = -(-count // columns)
    figure = Figure(
        figsize=(max(5.0, width * columns), height * rows + 0.7), layout="constrained"
    )
    figure.suptitle(plain(title))
    axes = [figure.add_subplot(rows, columns, i + 1) for i in range(count)]
    return figure, axes


def say_nothing(axes: Axes, words: str) -> None:
    """An empty panel that says why it is empty."""
    axes.set(xticks=[], yticks=[])
    axes.text(0.5, 0.5, words, ha="center", wrap=True, transform=axes.transAxes)


def add_legend(figure: Figure, axes: list[Axes]) -> None:
    """One legend for all panels, from the first that has something to name."""
    for place in axes:
        handles, labels = place.get_legend_handles_labels()
        if handles:
            columns = min(len(labels), 6)
            figure.legend(handles, labels, loc="outside lower center", ncols=columns)
            return


def limits_around_zero(values: np.ndarray) -> tuple[float, float]:
    """Limits that hold the values and zero, with room for their labels."""
    low, high = min(0.0, np.min(values)), max(0.0, np.max(values))
    room = 0.36 * (high - low or 1.0)
    return low - room * (low < 0.0 or high == 0.0), high + room * (high > 0.0)


def save(figure: Figure, path: str | Path | None) -> Figure:
    """The figure, saved too if there is a path; a file of that name is replaced once
    the new one is whole."""
    if path is not None:
        with replacing(Path(path)) as temporary:
            figure.savefig(temporary, dpi=130)
    return figure

"""Sobol indices as bars with their intervals."""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..plotting import BLUE, SKY
from .figures import add_legend, check_dimensions, panels, save, say_nothing

HALF = 0.2
"""Of the distance between the two bars of a parameter."""


def plot_sobol(dataset: xr.Dataset, path: str | Path | None = None) -> Figure:
    """Draw first-order and total indices, a panel for each output, with their intervals
    of 95 %.

    Args:
        dataset: from `sobol`; a choice of outputs by `dataset.sel(output=[...])`.
        path: where to save the figure too, in the format that the suffix names.

    Raises ValueError for a dataset of something else.
    """
    check_dimensions(dataset, "total_order")
    names = [str(name) for name in dataset.output.values]
    figure, axes = panels(
        len(names),
        3.7,
        1.2 + 0.42 * dataset.sizes["parameter"],
        "part of the output's variance: by the parameter alone, and with all others",
    )
    for place, name in zip(axes, names, strict=True):
        _draw(place, dataset.sel(output=name))
    add_legend(figure, axes)
    return save(figure, path)


def _draw(axes: Axes, of_output: xr.Dataset) -> None:
    dropped = int(of_output.groups_dropped)
    title = str(of_output.output.values)
    if dropped:
        total = dropped + int(of_output.groups_kept)
        title += f"\n{dropped} of {total} blocks left out"
    axes.set_title(title, fontsize="medium")
    if reason := str(of_output.reason.values):
        say_nothing(axes, reason)
        return
    parameters = [str(name) for name in of_output.parameter.values]
    places = np.arange(len(parameters))
    for name, words, colour, shift in (
        ("first_order", "first-order", SKY, -HALF),
        ("total_order", "total", BLUE, HALF),
    ):
        axes.barh(
            places + shift,
            of_output[name],
            2.0 * HALF,
            xerr=of_output[f"{name}_interval"],
            color=colour,
            label=words,
            error_kw={"linewidth": 1.0, "capsize": 2.0},
        )
    axes.set_yticks(places, parameters)
    axes.invert_yaxis()
    # An estimate may pass the ends by its error.
    left = min(
        0.0, float((of_output.first_order - of_output.first_order_interval).min())
    )
    right = max(
        1.0, float((of_output.total_order + of_output.total_order_interval).max())
    )
    axes.set_xlim(left, right)
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set_xlabel("index [-]")

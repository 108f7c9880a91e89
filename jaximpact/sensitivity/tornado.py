"""Elasticities as tornadoes: for each output the parameters, the strongest on top."""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..plotting import BLUE, VERMILION
from .figures import check_dimensions, limits_around_zero, panels, save, say_nothing
from .verdicts import Check, State


def plot_tornado(dataset: xr.Dataset, path: str | Path | None = None) -> Figure:
    """Draw the elasticities of one impact, a panel for each output.

    Args:
        dataset: from `elasticities`, of one impact; a choice of outputs by
            `dataset.sel(output=[...])`.
        path: where to save the figure too, in the format that the suffix names.

    Bars have the panel's own scale. A bar that differences do not confirm is hatched,
    and its number bears a question mark. What has no elasticity has no bar, and the
    panel says why.

    Raises ValueError for a dataset of many impacts, or of something else.
    """
    check_dimensions(dataset, "elasticity")
    names = [str(name) for name in dataset.output.values]
    count = dataset.sizes["parameter"]
    height = 1.1 + 0.32 * count
    figure, axes = panels(
        len(names),
        3.6,
        height,
        "elasticity: per cent of the output for one per cent of the parameter",
    )
    for place, name in zip(axes, names, strict=True):
        _draw(place, dataset.sel(output=name))
    return save(figure, path)


def _draw(axes: Axes, of_output: xr.Dataset) -> None:
    value, unit = float(of_output.output_value), str(of_output.output_unit.values)
    unit = "" if unit == "-" else f" {unit}"
    axes.set_title(f"{of_output.output.values} = {value:.3g}{unit}", fontsize="small")
    elasticity = of_output.elasticity.values
    parameters = [str(name) for name in of_output.parameter.values]
    states = {State(code) for code in of_output.state.values}
    if not np.isfinite(elasticity).any():
        say_nothing(axes, "; ".join(sorted(str(state) for state in states)))
        return
    order = np.argsort(np.nan_to_num(np.abs(elasticity), nan=-1.0))
    axes.set_xlim(*limits_around_zero(elasticity[np.isfinite(elasticity)]))
    labels = []
    for rank, place in enumerate(order):
        number = elasticity[place]
        labels.append(parameters[place])
        if not np.isfinite(number):
            words = State(of_output.state.values[place]).short
            axes.text(0.0, rank, f" {words}", va="center", fontsize="small")
            continue
        doubtful = of_output.check.values[place] in (Check.differs, Check.undecided)
        axes.barh(
            rank,
            number,
            color=BLUE if number >= 0.0 else VERMILION,
            hatch="///" if doubtful else None,
            edgecolor="white",
        )
        axes.annotate(
            f"{number:.2g}{'?' if doubtful else ''}",
            (number, rank),
            xytext=(3 if number >= 0.0 else -3, 0),
            textcoords="offset points",
            ha="left" if number >= 0.0 else "right",
            va="center",
            fontsize="small",
        )
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(-0.6, len(labels) - 0.4)
    axes.set_xlabel("elasticity [-]")
    axes.axvline(0.0, color="black", linewidth=0.8)

"""A table of parameters and outputs in colours."""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from .figures import check_dimensions, save
from .verdicts import Check, State

FULL_COLOUR = 1.0
"""Value of the strongest colour, the same in all drawings: they can be compared."""


def plot_heat_map(dataset: xr.Dataset, path: str | Path | None = None) -> Figure:
    """Draw the elasticities of one impact, or total Sobol indices, as a table in
    colours: outputs down, parameters across, each with its number.

    Args:
        dataset: from `elasticities`, of one impact, or from `sobol`.
        path: where to save the figure too, in the format that the suffix names.

    A cell without a number is grey and says why; a question mark stands where
    differences do not confirm a derivative.

    Raises ValueError for a dataset of many impacts, or of something else.
    """
    signed = "elasticity" in dataset
    variable = "elasticity" if signed else "total_order"
    check_dimensions(dataset, variable)
    values = dataset[variable].transpose("output", "parameter").values
    outputs, parameters = (
        [str(name) for name in dataset[dimension].values]
        for dimension in ("output", "parameter")
    )
    figure = Figure(
        figsize=(3.6 + 0.95 * len(parameters), 1.6 + 0.36 * len(outputs)),
        layout="constrained",
    )
    axes = figure.add_subplot()
    image = axes.imshow(
        np.ma.masked_invalid(values),
        aspect="auto",
        cmap="RdBu_r" if signed else "Blues",
        vmin=-FULL_COLOUR if signed else 0.0,
        vmax=FULL_COLOUR,
    )
    axes.set_facecolor("0.85")
    for (row, column), value in np.ndenumerate(values):
        axes.text(
            column,
            row,
            _cell(dataset, signed, row, column, value),
            ha="center",
            va="center",
            fontsize="small",
            color="white" if abs(value) > 0.6 * FULL_COLOUR else "black",
        )
    axes.set_xticks(range(len(parameters)), parameters, rotation=30, ha="right")
    axes.set_yticks(range(len(outputs)), outputs)
    axes.set(xlabel="parameter", ylabel="output")
    words = "elasticity [-]" if signed else "total index [-]"
    figure.colorbar(image, ax=axes, label=words, extend="both" if signed else "neither")
    axes.set_title(
        "elasticities: % of the output for 1 % of the parameter"
        if signed
        else "total Sobol indices: part of the variance that a parameter is needed for",
        fontsize="medium",
    )
    return save(figure, path)


def _cell(
    dataset: xr.Dataset, signed: bool, row: int, column: int, value: float
) -> str:
    place = {"output": row, "parameter": column}
    if not signed:
        return f"{value:.2f}" if np.isfinite(value) else "none"
    of_cell = dataset[["state", "check"]].isel(place)
    state = State(int(of_cell.state))
    if state is not State.defined:
        return state.short
    doubtful = int(of_cell.check) in (Check.differs, Check.undecided)
    return f"{value:.2g}" + ("?" if doubtful else "")

"""Drawings of elasticities and Sobol indices; apart, since Matplotlib loads slowly."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..plotting.style import (
    BLUE,
    SKY,
    VERMILION,
    WIDTH,
    On,
    empty_panel,
    in_style,
    legend_outside,
    panels,
)
from .elasticities import Check, State

ELASTICITIES_TITLE = "Elasticities: % of the output for 1 % of the parameter"
TOTALS_TITLE = "Total Sobol indices: part of the variance that needs the parameter"
SOBOL_TITLE = "Sobol indices: part of the variance, alone and with interactions"
SOBOL_BARS = (
    ("first_order", "first order", BLUE, 0.2),
    ("total_order", "total", SKY, -0.2),
)
"""Variable, label, colour and place of the bars of a parameter."""
PAGE = 10.5
"""Height of the panels of a drawing that fits on a page of A4 [inch]."""
LEAST_ROW = 0.17
"""Height of a row whose name of 9 points, an eighth of an inch, can be read [inch];
drawings that need less are longer than a page."""
DOUBTFUL = (Check.differs, Check.undecided)
"""Verdicts by which differences do not confirm a derivative."""


@in_style
def draw_tornado(dataset: xr.Dataset, on: On = None) -> Figure:
    """Draw the elasticities of one impact, a panel for each output.

    Args:
        dataset: from `elasticities`, of one impact; a choice of outputs by
            `dataset.sel(output=[...])`.
        on: as for `panels`.

    Bars have the panel's own scale. A bar that differences do not confirm is hatched,
    and its number bears a question mark. What has no elasticity has no bar, and the
    panel says why.

    Raises ValueError for a dataset of many impacts, or of something else.
    """
    dataset = _with_dimensions(dataset, "elasticity")
    figure, axes = _panels_of_outputs(dataset, 1.3, 0.28, ELASTICITIES_TITLE, on)
    for panel, name in zip(axes, dataset.output.values, strict=True):
        _draw_tornado(panel, dataset.sel(output=name))
    return figure


def _panels_of_outputs(
    dataset: xr.Dataset, around: float, row: float, title: str, on: On
) -> tuple[Figure, list[Axes]]:
    """Begin a figure with a panel for each output, in whose rows parameters stand: of
    the height `row`, or less, so that the figure fits on a page, with `around` for what
    stands about them [inch]."""
    count = dataset.sizes["output"]
    # Long names leave panels side by side no room for their bars and numbers.
    longest = max(map(len, map(str, dataset.parameter.values)))
    columns = min(count, 3 if longest < 13 else 2 if longest < 20 else 1)
    rows = -(-count // columns)
    parameters = dataset.sizes["parameter"]
    fitting = (PAGE / rows - around) / parameters
    height = around + parameters * float(np.clip(fitting, LEAST_ROW, row))
    return panels(rows, columns, height=height, count=count, title=title, on=on)


def _draw_tornado(axes: Axes, of_output: xr.Dataset) -> None:
    # Where one parameter was chosen it lies along that too.
    value = float(np.ravel(of_output.output_value)[0])
    unit = str(np.ravel(of_output.output_unit)[0])
    unit = "" if unit == "-" else f" {unit}"
    axes.set_title(f"{of_output.output.values}\n{value:.3g}{unit}")
    elasticity = of_output.elasticity.values
    finite = elasticity[np.isfinite(elasticity)]
    if not finite.size:
        states = {str(State(code)) for code in of_output.state.values}
        empty_panel(axes, "; ".join(sorted(states)))
        return
    # Room for the numbers beyond the ends of the bars: a third of the panel each.
    low, high = min(0.0, finite.min()), max(0.0, finite.max())
    room = (1.0 if low < 0.0 < high else 0.5) * (high - low or 1.0)
    on_the_right = high > 0.0 or low == 0.0 or finite.size < elasticity.size
    axes.set_xlim(low - room * (low < 0.0), high + room * on_the_right)
    order = np.argsort(np.nan_to_num(np.abs(elasticity), nan=-1.0))
    for rank, place in enumerate(order):
        number, entry = elasticity[place], of_output.isel(parameter=place)
        sign = 1 if not number < 0.0 else -1
        if np.isfinite(number):
            axes.barh(
                rank,
                number,
                color=BLUE if sign > 0 else VERMILION,
                hatch="///" if int(entry.check) in DOUBTFUL else None,
                edgecolor="white",
            )
        axes.annotate(
            _cell_text(entry),
            (np.nan_to_num(number), rank),
            xytext=(3 * sign, 0),
            textcoords="offset points",
            ha="left" if sign > 0 else "right",
            va="center",
            fontsize=9,
        )
    axes.set_yticks(range(len(order)), of_output.parameter.values[order])
    axes.set_ylim(-0.6, len(order) - 0.4)
    axes.grid(visible=False, axis="y")
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set_xlabel("elasticity [-]")


@in_style
def draw_heat_map(dataset: xr.Dataset, on: On = None) -> Figure:
    """Draw the elasticities of one impact, or total Sobol indices, as a table in
    colours: outputs down, parameters across, each with its number.

    Args:
        dataset: from `elasticities`, of one impact, or from `sobol`.
        on: as for `panels`.

    A cell without a number is grey and says why; a question mark stands where
    differences do not confirm a derivative.

    Raises ValueError for a dataset of many impacts, or of something else.
    """
    signed = "elasticity" in dataset
    variable = "elasticity" if signed else "total_order"
    dataset = _with_dimensions(dataset, variable)
    values = dataset[variable].transpose("output", "parameter").values
    rows, columns = values.shape
    title = ELASTICITIES_TITLE if signed else TOTALS_TITLE
    # A number takes half an inch; a wider figure is shrunk, but can be enlarged.
    width = min(4.5 + 0.8 * columns, max(WIDTH, 2.5 + 0.55 * columns))
    figure, (axes,) = panels(height=1.5 + 0.3 * rows, width=width, title=title, on=on)
    image = axes.imshow(
        np.ma.masked_invalid(values),
        aspect="auto",
        cmap="RdBu_r" if signed else "Blues",
        # The same colours in all heat maps: they can be compared.
        vmin=-1.0 if signed else 0.0,
        vmax=1.0,
    )
    axes.set_facecolor("0.85")
    axes.grid(visible=False)
    for (row, column), value in np.ndenumerate(values):
        text = f"{value:.2f}" if np.isfinite(value) else "none"
        if signed:
            text = _cell_text(dataset.isel(output=row, parameter=column))
        colour = "white" if abs(value) > 0.6 else "black"
        centred = {"ha": "center", "va": "center", "fontsize": 9, "color": colour}
        axes.text(column, row, text, **centred)
    slanted = {"rotation": 30, "ha": "right"} if columns > 4 else {}
    axes.set_xticks(range(columns), dataset.parameter.values, **slanted)
    axes.set_yticks(range(rows), dataset.output.values)
    axes.set(xlabel="parameter", ylabel="output")
    words = "elasticity [-]" if signed else "total index [-]"
    figure.colorbar(image, ax=axes, label=words, extend="both" if signed else "neither")
    return figure


@in_style
def draw_sobol(dataset: xr.Dataset, on: On = None) -> Figure:
    """Draw first-order and total Sobol indices with their 95 % intervals, a panel for
    each output, the parameter of the largest total index on top.

    Args:
        dataset: from `sobol`; a choice of outputs by `dataset.sel(output=[...])`.
        on: as for `panels`.

    Raises ValueError for a dataset of something else.
    """
    dataset = _with_dimensions(dataset, "total_order")
    figure, axes = _panels_of_outputs(dataset, 0.9, 0.4, SOBOL_TITLE, on)
    for panel, name in zip(axes, dataset.output.values, strict=True):
        of_output = dataset.sel(output=name)
        panel.set_title(name)
        if not np.any(np.isfinite(of_output.total_order)):
            empty_panel(panel, str(np.ravel(of_output.reason)[0]))
            continue
        of_output = of_output.sortby("total_order")
        places = np.arange(dataset.sizes["parameter"])
        for order, label, colour, side in SOBOL_BARS:
            panel.barh(
                places + side,
                of_output[order],
                0.38,
                xerr=of_output[f"{order}_interval"],
                color=colour,
                label=label,
                error_kw={"lw": 1.0},
            )
        panel.set_yticks(places, of_output.parameter.values)
        panel.set_ylim(-0.6, len(places) - 0.4)
        panel.grid(visible=False, axis="y")
        panel.axvline(0.0, color="black", lw=0.8)
        panel.set_xlabel("Sobol index [-]")
    legend_outside(figure, of=axes, ncols=2)
    return figure


def _with_dimensions(dataset: xr.Dataset, variable: str) -> xr.Dataset:
    """Return a dataset whose variable lies along outputs and parameters, also where one
    of either was chosen. Raises ValueError for one without it, or along more."""
    if variable not in dataset:
        raise ValueError(f"the dataset must hold {variable}, but holds {list(dataset)}")
    more = set(dataset[variable].dims) - {"parameter", "output"}
    if more:
        raise ValueError(
            "the drawing is of one impact, but the dataset has the dimensions "
            f"{sorted(map(str, more))} too; choose with .sel or .isel"
        )
    chosen = {"parameter", "output"} - set(dataset[variable].dims)
    return dataset.expand_dims(sorted(chosen))


def _cell_text(entry: xr.Dataset) -> str:
    """Write an elasticity, with a mark if it is doubtful, or why there is none."""
    state = State(int(entry.state))
    if state is not State.defined:
        return state.short
    mark = "?" if int(entry.check) in DOUBTFUL else ""
    return f"{float(entry.elasticity):.2g}{mark}"

"""Drawings of sensitivity studies; apart, since Matplotlib is slow to load."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..plotting.style import (
    BLUE,
    COLOURS,
    GREY,
    SKY,
    VERMILION,
    empty_panel,
    in_style,
    legend_outside,
    panels,
    plain,
    points,
    save_figure,
)
from .elasticities import Check, State
from .text import cell_text

ELASTICITIES_TITLE = "Elasticities: % of the output for 1 % of the parameter"
TOTALS_TITLE = "Total Sobol indices: part of the variance that needs the parameter"
COLUMNS = 3
"""Most panels side by side."""
FULL_COLOUR = 1.0
"""Value of the strongest colour, the same in all heat maps: they can be compared."""
MARKS = {Check.differs: "?", Check.undecided: "?"}
"""Marks of what differences do not confirm."""
HALF_BAR = 0.2
"""Half the width of a bar of an index, where parameters are 1 apart."""


@in_style
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
    _check_dimensions(dataset, "elasticity")
    return _panel_per_output(
        dataset,
        _draw_tornado,
        1.3 + 0.28 * dataset.sizes["parameter"],
        ELASTICITIES_TITLE,
        path,
    )


def _draw_tornado(axes: Axes, of_output: xr.Dataset) -> None:
    value, unit = float(of_output.output_value), str(of_output.output_unit.values)
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
    axes.set_xlim(low - room * (low < 0.0), high + room * (high > 0.0 or low == 0.0))
    order = np.argsort(np.nan_to_num(np.abs(elasticity), nan=-1.0))
    for rank, place in enumerate(order):
        number, entry = elasticity[place], of_output.isel(parameter=place)
        sign = 1 if not number < 0.0 else -1
        if np.isfinite(number):
            axes.barh(
                rank,
                number,
                color=BLUE if sign > 0 else VERMILION,
                hatch="///" if int(entry.check) in MARKS else None,
                edgecolor="white",
            )
        axes.annotate(
            cell_text(entry, ".2g", MARKS),
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
    _check_dimensions(dataset, variable)
    values = dataset[variable].transpose("output", "parameter").values
    rows, columns = values.shape
    title = ELASTICITIES_TITLE if signed else TOTALS_TITLE
    width = min(8.0, 4.5 + 0.8 * columns)
    figure, (axes,) = panels(height=1.5 + 0.3 * rows, width=width, title=title)
    image = axes.imshow(
        np.ma.masked_invalid(values),
        aspect="auto",
        cmap="RdBu_r" if signed else "Blues",
        vmin=-FULL_COLOUR if signed else 0.0,
        vmax=FULL_COLOUR,
    )
    axes.set_facecolor("0.85")
    axes.grid(visible=False)
    for (row, column), value in np.ndenumerate(values):
        entry = dataset.isel(output=row, parameter=column)
        if signed:
            text = cell_text(entry, ".2g", MARKS)
        else:
            text = f"{value:.2f}" if np.isfinite(value) else "none"
        light = abs(value) > 0.6 * FULL_COLOUR
        axes.text(
            column,
            row,
            text,
            ha="center",
            va="center",
            fontsize=9,
            color="white" if light else "black",
        )
    slanted = {"rotation": 30, "ha": "right"} if columns > 4 else {}
    axes.set_xticks(range(columns), dataset.parameter.values, **slanted)
    axes.set_yticks(range(rows), dataset.output.values)
    axes.set(xlabel="parameter", ylabel="output")
    words = "elasticity [-]" if signed else "total index [-]"
    figure.colorbar(image, ax=axes, label=words, extend="both" if signed else "neither")
    return save_figure(figure, path)


@in_style
def plot_elasticity_map(
    dataset: xr.Dataset, output: str, path: str | Path | None = None
) -> Figure:
    """Draw the elasticities of one output over two axes: a panel for each parameter,
    and one for which of them is strongest.

    Args:
        dataset: from `elasticities` with two `axes`; at most six parameters.
        output: name of the output.
        path: where to save the figure too, in the format that the suffix names.

    The first axis is drawn upwards, the second to the right. Points without an
    elasticity are grey.

    Raises ValueError for a dataset without two axes or with more parameters; KeyError
    for an output that it does not hold.
    """
    _check_dimensions(dataset, "elasticity", more=2)
    of_output = dataset.elasticity.sel(output=output)
    names = [str(name) for name in of_output.parameter.values]
    if len(names) > len(COLOURS):
        raise ValueError(
            f"the map takes at most {len(COLOURS)} parameters, but the dataset has "
            f"{len(names)}; choose with .sel"
        )
    count = len(names) + 1
    columns = 2 if count in (2, 4) else 3
    figure, axes = panels(
        -(-count // columns),
        columns,
        height=2.7,
        count=count,
        title=plain(f"Elasticity of {output}, and which parameter is strongest"),
    )
    values = of_output.values
    finite = np.abs(values[np.isfinite(values)])
    largest = float(np.percentile(finite, 98)) if finite.size else 1.0
    for place, name in zip(axes, names, strict=False):
        image = _draw_cells(
            place,
            of_output.sel(parameter=name),
            name,
            cmap="RdBu_r",
            vmin=-largest,
            vmax=largest,
        )
    figure.colorbar(image, ax=axes, label="elasticity [-]", extend="both", pad=0.01)
    known = np.isfinite(of_output).any("parameter")
    strongest = np.abs(of_output).fillna(-1.0).argmax("parameter").where(known)
    _draw_cells(
        axes[-1],
        strongest,
        "the strongest",
        cmap=ListedColormap(COLOURS[: len(names)]),
        vmin=-0.5,
        vmax=len(names) - 0.5,
    )
    patches = [
        Patch(color=colour, label=name)
        for colour, name in zip(COLOURS, names, strict=False)
    ]
    legend_outside(figure, patches, title="the strongest")
    return save_figure(figure, path)


def _draw_cells(axes: Axes, values: xr.DataArray, title: str, **colours):
    """Draw one panel of coloured cells; axes of labels have one place a label."""
    places = []
    for axis, dimension in zip((axes.yaxis, axes.xaxis), values.dims, strict=True):
        along = values[dimension].values
        axis.set_label_text(plain(str(dimension)))
        if along.dtype.kind not in "fiu":
            axis.set_ticks(range(len(along)), [plain(str(label)) for label in along])
            along = np.arange(len(along))
        places.append(along)
    axes.set_facecolor("0.8")
    axes.grid(visible=False)
    axes.set_title(title)
    down, across = places
    cells = np.ma.masked_invalid(values.values)
    return axes.pcolormesh(across, down, cells, shading="nearest", **colours)


@in_style
def plot_morris(dataset: xr.Dataset, path: str | Path | None = None) -> Figure:
    """Draw mu* against sigma, a panel for each output, with the 95 % confidence
    interval of mu*.

    Args:
        dataset: from `morris`; a choice of outputs by `dataset.sel(output=[...])`.
        path: where to save the figure too, in the format that the suffix names.

    To the right stand parameters that matter; above the line sigma = mu* those that act
    nonlinearly or together with others.

    Raises ValueError for a dataset of something else.
    """
    _check_dimensions(dataset, "mean_absolute_effect")
    return _panel_per_output(
        dataset,
        _draw_effects,
        2.6,
        "Elementary effects: right, strong; above the line, nonlinear or interacting",
        path,
    )


def _draw_effects(axes: Axes, of_output: xr.Dataset) -> None:
    if not _has_estimate(axes, of_output, "trajectories"):
        return
    strength = of_output.mean_absolute_effect.values
    deviation = of_output.effect_deviation.values
    interval = of_output.mean_absolute_effect_interval.values
    for place, name in enumerate(of_output.parameter.values):
        axes.errorbar(
            strength[place],
            deviation[place],
            xerr=interval[place],
            linestyle="none",
            capsize=2.0,
            label=str(name),
            **points(place),
        )
    right = 1.1 * float(np.max(strength + interval)) or 1.0
    top = 1.15 * max(float(np.max(deviation)), 0.5 * right)
    axes.set(xlim=(0.0, right), ylim=(0.0, top))
    axes.axline((0.0, 0.0), slope=1.0, color=GREY, linewidth=1.0)
    unit = str(of_output.output_unit.values)
    axes.set(xlabel=f"mu* [{unit}]", ylabel=f"sigma [{unit}]")
    axes.ticklabel_format(style="sci", scilimits=(-3, 4))


@in_style
def plot_sobol(dataset: xr.Dataset, path: str | Path | None = None) -> Figure:
    """Draw first-order and total indices, a panel for each output, with their 95 %
    confidence intervals.

    Args:
        dataset: from `sobol`; a choice of outputs by `dataset.sel(output=[...])`.
        path: where to save the figure too, in the format that the suffix names.

    Raises ValueError for a dataset of something else.
    """
    _check_dimensions(dataset, "total_order")
    return _panel_per_output(
        dataset,
        _draw_indices,
        1.1 + 0.4 * dataset.sizes["parameter"],
        "Sobol indices: parts of the variance of the output",
        path,
    )


def _draw_indices(axes: Axes, of_output: xr.Dataset) -> None:
    if not _has_estimate(axes, of_output, "blocks"):
        return
    places = np.arange(of_output.sizes["parameter"])
    for name, words, colour, shift in (
        ("first_order", "first-order: of the parameter alone", SKY, -HALF_BAR),
        ("total_order", "total: with all others", BLUE, HALF_BAR),
    ):
        axes.barh(
            places + shift,
            of_output[name],
            2.0 * HALF_BAR,
            xerr=of_output[f"{name}_interval"],
            color=colour,
            label=words,
            error_kw={"linewidth": 1.0, "capsize": 2.0},
        )
    axes.set_yticks(places, of_output.parameter.values)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    # An estimate may pass the ends by its error.
    left = (of_output.first_order - of_output.first_order_interval).min()
    right = (of_output.total_order + of_output.total_order_interval).max()
    axes.set_xlim(min(0.0, float(left)), max(1.0, float(right)))
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set_xlabel("index [-]")


def _check_dimensions(dataset: xr.Dataset, variable: str, more: int = 0) -> None:
    """Raise ValueError unless a dataset holds the variable, over parameters, outputs
    and so many dimensions more."""
    if variable not in dataset:
        raise ValueError(f"the dataset must hold {variable}, but holds {list(dataset)}")
    found = set(dataset[variable].dims) - {"parameter", "output"}
    if len(found) != more:
        raise ValueError(
            f"the drawing takes {more} dimensions beside parameter and output, but the "
            f"dataset has {sorted(map(str, found))}; choose with .sel or .isel"
        )


def _panel_per_output(
    dataset: xr.Dataset,
    draw: Callable[[Axes, xr.Dataset], None],
    height: float,
    title: str,
    path: str | Path | None,
) -> Figure:
    """Draw a panel for each output, with one legend for all."""
    count = dataset.sizes["output"]
    columns = min(count, COLUMNS)
    figure, axes = panels(
        -(-count // columns), columns, height=height, count=count, title=title
    )
    for place, name in zip(axes, dataset.output.values, strict=True):
        draw(place, dataset.sel(output=name))
    legend_outside(figure)
    return save_figure(figure, path)


def _has_estimate(axes: Axes, of_output: xr.Dataset, groups: str) -> bool:
    """Title the panel of an output, and say why it is empty if there is no estimate."""
    dropped = int(of_output.groups_dropped)
    title = str(of_output.output.values)
    if dropped:
        total = dropped + int(of_output.groups_kept)
        title += f"\n{dropped} of {total} {groups} left out"
    axes.set_title(title)
    if reason := str(of_output.reason.values):
        empty_panel(axes, reason)
    return not reason

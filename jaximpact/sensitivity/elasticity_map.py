"""Where which parameter matters: elasticities over two quantities."""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..plotting import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, plain
from .figures import check_dimensions, panels, save

COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY)
"""Of the strongest parameter; six, so that they can be told apart."""


def plot_elasticity_map(
    dataset: xr.Dataset, output: str, path: str | Path | None = None
) -> Figure:
    """Draw the elasticities of one output over two axes: a panel for each parameter,
    and one for which of them is strongest.

    Args:
        dataset: from `elasticities` with two `axes`; at most six parameters.
        output: which.
        path: where to save the figure too, in the format that the suffix names.

    The first axis is drawn upwards, the second to the right. Points without an
    elasticity are grey.

    Raises ValueError for a dataset without two axes or with more parameters; KeyError
    for an output that it does not hold.
    """
    check_dimensions(dataset, "elasticity", more=2)
    of_output = dataset.elasticity.sel(output=output)
    names = [str(name) for name in of_output.parameter.values]
    if len(names) > len(COLOURS):
        raise ValueError(
            f"the map takes at most {len(COLOURS)} parameters, but the dataset has "
            f"{len(names)}; choose with .sel"
        )
    figure, axes = panels(
        len(names) + 1, 3.7, 3.4, f"elasticity of {output}: where which matters"
    )
    values = of_output.values
    finite = np.abs(values[np.isfinite(values)])
    largest = float(np.percentile(finite, 98)) if finite.size else 1.0
    image = None
    for place, name in zip(axes, names, strict=False):
        image = _mesh(
            place,
            of_output.sel(parameter=name),
            name,
            cmap="RdBu_r",
            vmin=-largest,
            vmax=largest,
        )
    figure.colorbar(image, ax=axes, label="elasticity [-]", extend="both", pad=0.01)
    _draw_strongest(axes[-1], of_output, names)
    return save(figure, path)


def _draw_strongest(axes: Axes, of_output: xr.DataArray, names: list[str]) -> None:
    known = np.isfinite(of_output).any("parameter")
    size = np.abs(of_output).fillna(-1.0)
    strongest = size.argmax("parameter").where(known)
    _mesh(
        axes,
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
    axes.legend(
        handles=patches,
        fontsize="small",
        loc="upper center",
        bbox_to_anchor=(0.5, -0.18),
        ncols=min(3, len(names)),
    )


def _mesh(axes: Axes, values: xr.DataArray, title: str, **colours):
    """One panel of coloured cells."""
    down, across = values.dims
    image = axes.pcolormesh(
        _positions(values, across),
        _positions(values, down),
        np.ma.masked_invalid(values.values),
        shading="nearest",
        **colours,
    )
    axes.set_facecolor("0.8")
    axes.set(xlabel=plain(str(across)), ylabel=plain(str(down)))
    axes.set_title(title, fontsize="medium")
    for axis, dimension in ((axes.xaxis, across), (axes.yaxis, down)):
        if values[dimension].dtype.kind not in "fiu":
            labels = [plain(str(label)) for label in values[dimension].values]
            axis.set_ticks(range(len(labels)), labels)
    return image


def _positions(values: xr.DataArray, dimension) -> np.ndarray:
    """Where the points of an axis lie: at its numbers, or one after another."""
    along = values[dimension].values
    return along if along.dtype.kind in "fiu" else np.arange(len(along))

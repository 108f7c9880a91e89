"""Morris's effects in their plane: how strong against how uneven."""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from .figures import add_legend, check_dimensions, panels, save, say_nothing

COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY)
MARKERS = "osD^v"


def plot_morris(dataset: xr.Dataset, path: str | Path | None = None) -> Figure:
    """Draw mu* against sigma, a panel for each output, with the interval of mu*.

    Args:
        dataset: from `morris`; a choice of outputs by `dataset.sel(output=[...])`.
        path: where to save the figure too, in the format that the suffix names.

    To the right is what matters; above the line sigma = mu* what acts through curvature
    or together with others.

    Raises ValueError for a dataset of something else.
    """
    check_dimensions(dataset, "mean_absolute_effect")
    names = [str(name) for name in dataset.output.values]
    figure, axes = panels(
        len(names),
        3.7,
        3.2,
        "elementary effects of the whole range: to the right strong, "
        "above the line uneven",
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
        title += f"\n{dropped} of {total} trajectories left out"
    axes.set_title(title, fontsize="medium")
    if reason := str(of_output.reason.values):
        say_nothing(axes, reason)
        return
    strength = of_output.mean_absolute_effect.values
    deviation = of_output.effect_deviation.values
    interval = of_output.mean_absolute_effect_interval.values
    names = [str(name) for name in of_output.parameter.values]
    for place, name in enumerate(names):
        axes.errorbar(
            strength[place],
            deviation[place],
            xerr=interval[place],
            linestyle="none",
            capsize=2.0,
            label=name,
            color=COLOURS[place % len(COLOURS)],
            marker=MARKERS[place // len(COLOURS) % len(MARKERS)],
        )
    right = 1.1 * float(np.max(strength + interval)) or 1.0
    top = 1.15 * max(float(np.max(deviation)), 0.5 * right)
    axes.set(xlim=(0.0, right), ylim=(0.0, top))
    axes.axline((0.0, 0.0), slope=1.0, color=GREY, linewidth=1.0)
    unit = str(of_output.output_unit.values)
    axes.set(xlabel=f"mu* [{unit}]", ylabel=f"sigma [{unit}]")
    axes.ticklabel_format(style="sci", scilimits=(-3, 4))
    axes.grid(alpha=0.25)

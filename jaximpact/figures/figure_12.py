"""Fig. 12: how high blocks jump."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..distributions import fit_exponential
from ..plotting import VERMILION
from ..runout.biplanar import HOP
from ..runout.jumps import jumps
from .drawing import (
    ASPECT_RATIO,
    LABEL_SIZE,
    colours_of,
    label_axes,
    legend_over,
    panels,
)
from .paper_figure import PaperFigure
from .slope_runs import (
    blocks_table,
    distance_in_words,
    draw_histogram,
    exponential,
    scale_counts,
)
from .study import Study

BINS = 50
ALL = {"color": "black"}
HIGHER = {"color": VERMILION, "ls": "--"}


def compute(study: Study) -> pd.DataFrame:
    """A row for each flight that begins at a contact: the highest point of the centre
    above the ground, and by how much that is above its start."""
    runs = study.slope_runs()
    flights = jumps(runs)
    chosen = np.flatnonzero(flights.after_contact)
    table = blocks_table(runs, flights.trajectory[chosen])
    return table.assign(
        start_x_m=runs.pieces.x[flights.piece[chosen]],
        height_m=flights.height[chosen],
        rise_m=flights.rise[chosen],
    )


def draw(table: pd.DataFrame) -> Figure:
    """a to e: histograms for each aspect ratio, all spins, with exponential fits to all
    jumps and to those that rise by more than a hop, their distances, and in
    brackets what these exceed by chance in 5 of 100 cases; f: shares that are
    higher."""
    figure, axes = panels(3, 2, sharex=True)
    edges = np.linspace(0.0, 1.02 * table["height_m"].max(), BINS + 1)
    share = axes[-1]
    shapes = table.groupby(ASPECT_RATIO)
    colours = colours_of(table[ASPECT_RATIO])
    for each, (shape, rows) in zip(axes[:-1], shapes, strict=True):
        heights, higher = rows["height_m"], rows.loc[rows["rise_m"] > HOP, "height_m"]
        fits = fit_exponential(heights), fit_exponential(higher)
        draw_histogram(each, heights, edges, fits[0], exponential, **ALL)
        draw_histogram(each, higher, edges, fits[1], exponential, **HIGHER)
        label_axes(each, "height_m", "height_m")
        each.set_ylabel("jumps [-]", fontsize=LABEL_SIZE)
        distances = ", ".join(distance_in_words(fit) for fit in fits)
        each.set_title(f"$A_r$ = {shape:g}: {distances}", fontsize="medium")
        scale_counts(each, heights, edges)
        ordered = np.sort(heights)
        share.step(
            ordered,
            1.0 - np.arange(len(ordered)) / len(ordered),
            color=colours[shape],
            lw=1.2,
            label=f"{shape:g}",
        )
    label_axes(share, "height_m", "height_m")
    share.set_ylabel("share that is higher [-]", fontsize=LABEL_SIZE)
    share.set_yscale("log")
    share.legend(title="$A_r$", frameon=False, fontsize=LABEL_SIZE)
    axes[0].set_xlim(edges[0], edges[-1])
    names = (
        "all jumps: distance (by chance)",
        f"those that rise by more than {HOP:g} m",
    )
    legend_over(
        figure,
        [
            Line2D([], [], label=name, **style)
            for name, style in zip(names, (ALL, HIGHER), strict=True)
        ],
    )
    return figure


FIGURE_12 = PaperFigure("12", "heights of jumps", (), compute, draw, on_the_slope=True)

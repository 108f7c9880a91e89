"""Fig. 11: runs down the slope without initial spin."""

import dataclasses

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from ..runout import Pieces, Way
from ..runout.biplanar import FLAT_LENGTH, HEIGHT, SLOPE_LENGTH, SPINS_DEGPS
from ..units import DEGREE
from .drawing import aspect_ratio_legend, draw_curves, panels
from .paper_figure import PaperFigure
from .slope_runs import blocks_table
from .study import Study

SPACING = 0.05
"""Between rows [s], at most; the ends of all pieces of the way are rows."""
SERIES = ("y_m", "height_m", "velocity_mps", "spin_degps")


def compute(study: Study) -> pd.DataFrame:
    """The way of each shape, a row a moment: height is that of the centre above the
    ground below it. Contacts are left out, which last too short to be seen."""
    runs = study.slope_runs()
    free = runs.pieces.way != Way.contact
    pieces = Pieces(*(column[free] for column in runs.pieces))
    runs = dataclasses.replace(runs, pieces=pieces)
    parts = []
    for block in range(0, runs.release.count, len(SPINS_DEGPS)):
        way = runs.path(block, SPACING)
        part = blocks_table(runs, np.full(len(way["x"]), block))
        parts.append(
            part.assign(
                time_s=way["time"],
                x_m=way["x"],
                y_m=way["y"],
                height_m=way["y"] - runs.profile.height(way["x"]),
                velocity_mps=np.hypot(way["v_x"], way["v_y"]),
                spin_degps=way["angular_velocity"] / DEGREE,
            )
        )
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Against x: a: trajectory, with the profile; b: height of the centre above the
    ground; c: translational velocity; d: rotational velocity."""
    figure, axes = panels(2, 2)
    axes[0].plot(
        [0.0, SLOPE_LENGTH, SLOPE_LENGTH + FLAT_LENGTH],
        [HEIGHT, 0.0, 0.0],
        color="black",
        lw=3.0,
        zorder=1,
    )
    for each, series in zip(axes, SERIES, strict=True):
        draw_curves(each, table, "x_m", series, lw=0.8)
        each.set_xlim(0.0, 1.02 * table["x_m"].max())
    aspect_ratio_legend(figure, table)
    return figure


FIGURE_11 = PaperFigure(
    "11", "runs without initial spin", (), compute, draw, on_the_slope=True
)

"""Fig. 8: vertical impacts of blocks in all orientations."""

import pandas as pd
from matplotlib.figure import Figure

from .drawing import (
    ORIENTATION,
    aspect_ratio_legend,
    draw_curves,
    draw_squares,
    panels,
    square_handles,
)
from .jumps import curves_with_jumps
from .paper_figure import PaperFigure
from .study import HALF_TURN, Study

RESULTS = (
    "e_n",
    "max_penetration_m",
    "rotation_rad",
    "max_normal_force_N",
    "max_moment_Nm",
)


def compute(study: Study) -> pd.DataFrame:
    """Set IV, half a turn in steps of a degree."""
    base, axes = study.parametric_set("IV")
    axes = {**axes, ORIENTATION: HALF_TURN}
    return curves_with_jumps(base, axes, ORIENTATION, RESULTS, study.accuracy)


def draw(table: pd.DataFrame) -> Figure:
    """a: e_n along either axis, against A_r; b to f against orientation: e_n, max u_n,
    rotation, max N, max moment."""
    figure, axes = panels(3, 2)
    draw_squares(axes[0], table, "e_n")
    axes[0].legend(handles=square_handles(), frameon=False)
    for each, result in zip(axes[1:], RESULTS, strict=True):
        draw_curves(each, table, ORIENTATION, result)
        each.set_xlim(0.0, 180.0)
    axes[-1].set_ylim(bottom=0.0)
    aspect_ratio_legend(figure, table)
    return figure


FIGURE_8 = PaperFigure(
    "8", "vertical impacts against orientation", ("IV",), compute, draw
)

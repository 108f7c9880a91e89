"""Fig. 13: coefficients of restitution of a block that spins."""

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..plotting import BLUE, GREEN, VERMILION
from .drawing import (
    LABEL_SIZE,
    ORIENTATION,
    draw_curve,
    label_axes,
    legend_over,
    panels,
)
from .jumps import curves_with_jumps
from .paper_figure import PaperFigure
from .study import HALF_TURN, Study

SPIN = "angular_velocity_degps"
COEFFICIENTS = {
    "e_n": ("apparent", {"color": BLUE}),
    "e_contact": ("contact", {"color": VERMILION, "ls": "--"}),
    "e_bar": ("energetic", {"color": GREEN, "ls": "-."}),
    "e_n_vijayakumar": (
        "Vijayakumar et al. (2012)",
        {"color": "black", "ls": ":"},
    ),
}
"""Column -> name in the legend, and line."""


def compute(study: Study) -> pd.DataFrame:
    """Half a turn in steps of a degree."""
    base, axes = study.parametric_set("fig13")
    axes = {**axes, ORIENTATION: HALF_TURN}
    coefficients = tuple(COEFFICIENTS)
    return curves_with_jumps(base, axes, ORIENTATION, coefficients, study.accuracy)


def draw(table: pd.DataFrame) -> Figure:
    """a to d: no spin, 500, 1500 and 2000 °/s."""
    figure, axes = panels(2, 2, sharex=True, sharey=True)
    for each, (spin, curves) in zip(axes, table.groupby(SPIN), strict=True):
        for column, (_, style) in COEFFICIENTS.items():
            draw_curve(each, curves, ORIENTATION, column, **style)
        label_axes(each, ORIENTATION, "e_n")
        each.set_ylabel("coefficient of restitution [-]", fontsize=LABEL_SIZE)
        each.set_title(f"initial spin {spin:g} °/s", fontsize="medium")
    axes[0].set_xlim(0.0, 180.0)
    handles = [Line2D([], [], label=name, **s) for name, s in COEFFICIENTS.values()]
    legend_over(figure, handles)
    return figure


FIGURE_13 = PaperFigure(
    "13", "coefficients of a spinning block", ("fig13",), compute, draw
)

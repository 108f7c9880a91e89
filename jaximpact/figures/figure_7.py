"""Fig. 7: inclined impacts along the major axis against the impact angle."""

import pandas as pd
from matplotlib.figure import Figure

from ..formats.columns import OUTCOME_COLUMN
from .courses import peak, record_courses
from .drawing import (
    ANGLE,
    ASPECT_RATIO,
    ORIENTATION,
    aspect_ratio_legend,
    draw_curves,
    panels,
)
from .impact_table import impact_table
from .paper_figure import PaperFigure
from .study import Study

RESULTS = ("max_penetration_m", "max_normal_force_N", "rotation_rad")
MAX_RATIO = "max_R_r"
"""Largest rotational over total kinetic energy during contact."""


def compute(study: Study) -> pd.DataFrame:
    """Set III along the major axis, with the largest R_r of each course."""
    base, axes = study.parametric_set("III")
    axes = {name: axes[name] for name in axes if name != ORIENTATION}
    table = impact_table(base, axes, RESULTS, study.accuracy)
    points = table[[*axes]].to_dict("records")
    ratios = [
        peak(result.history.time, result.history.rotational_ratio)
        for result in record_courses(study, base, points)
    ]
    table.insert(table.columns.get_loc(OUTCOME_COLUMN), MAX_RATIO, ratios)
    return table.sort_values([ASPECT_RATIO, ANGLE], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """a: max u_n; b: max N; c: rotation; d: max R_r."""
    figure, axes = panels(2, 2)
    for each, result in zip(axes, (*RESULTS, MAX_RATIO), strict=True):
        draw_curves(each, table, ANGLE, result, marker="o", markersize=3)
        each.set_ylim(bottom=0.0)
    aspect_ratio_legend(figure, table, marker="o", markersize=3)
    return figure


FIGURE_7 = PaperFigure(
    "7", "impacts along the major axis against impact angle", ("III",), compute, draw
)

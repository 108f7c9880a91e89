"""Fig. 6: an inclined impact along the major axis over time."""

import pandas as pd
from matplotlib.figure import Figure

from .courses import course_table, record_courses
from .drawing import ANGLE, ASPECT_RATIO, aspect_ratio_legend, draw_courses, panels
from .paper_figure import PaperFigure
from .study import Study

IMPACT_ANGLE = 20.0
"""[deg]"""
SERIES = ("time_s", "penetration_m", "normal_force_N", "rotation_rad", "R_r")


def compute(study: Study) -> pd.DataFrame:
    """The courses of set III at one impact angle."""
    base, axes = study.parametric_set("III")
    points = [
        {ANGLE: IMPACT_ANGLE, ASPECT_RATIO: value} for value in axes[ASPECT_RATIO]
    ]
    return course_table(points, record_courses(study, base, points), SERIES)


def draw(table: pd.DataFrame) -> Figure:
    """a: vertical displacement; b: vertical force; c: rotation; d: R_r."""
    figure, axes = panels(2, 2)
    for each, series in zip(axes, SERIES[1:], strict=True):
        draw_courses(each, table, series)
        each.set_ylim(bottom=0.0)
    aspect_ratio_legend(figure, table, outcomes=True)
    return figure


FIGURE_6 = PaperFigure(
    "6", "impacts along the major axis at 20°, over time", ("III",), compute, draw
)

"""Fig. 4: displacement and force over time, vertical impacts along the major axis."""

import pandas as pd
from matplotlib.figure import Figure

from .courses import course_table, record_courses
from .drawing import ASPECT_RATIO, aspect_ratio_legend, draw_courses, panels
from .paper_figure import PaperFigure
from .study import Study

SERIES = ("time_s", "penetration_m", "normal_force_N")


def compute(study: Study) -> pd.DataFrame:
    """The courses of set I."""
    base, axes = study.parametric_set("I")
    points = [{ASPECT_RATIO: value} for value in axes[ASPECT_RATIO]]
    return course_table(points, record_courses(study, base, points), SERIES)


def draw(table: pd.DataFrame) -> Figure:
    """a: vertical displacement; b: vertical force."""
    figure, axes = panels(1, 2)
    for each, series in zip(axes, SERIES[1:], strict=True):
        draw_courses(each, table, series)
        each.set_ylim(bottom=0.0)
    aspect_ratio_legend(figure, table, outcomes=True)
    return figure


FIGURE_4 = PaperFigure(
    "4", "vertical impacts along the major axis, over time", ("I",), compute, draw
)

"""Fig. 5: largest displacement and force of vertical impacts along either axis."""

import pandas as pd
from matplotlib.figure import Figure

from .drawing import (
    ORIENTATION,
    draw_squares,
    legend_over,
    panels,
    square_handles,
)
from .impact_table import impact_table
from .paper_figure import PaperFigure
from .study import Study

RESULTS = ("max_penetration_m", "max_normal_force_N")


def compute(study: Study) -> pd.DataFrame:
    """Sets I and II."""
    parts = []
    for name, orientation in (("I", 0.0), ("II", 90.0)):
        base, axes = study.parametric_set(name)
        part = impact_table(base, axes, RESULTS, study.accuracy)
        part.insert(0, ORIENTATION, orientation)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """a: max u_n, b: max N, against A_r."""
    figure, axes = panels(1, 2)
    for each, result in zip(axes, RESULTS, strict=True):
        draw_squares(each, table, result)
    legend_over(figure, square_handles())
    return figure


FIGURE_5 = PaperFigure(
    "5",
    "vertical impacts along either axis, largest values",
    ("I", "II"),
    compute,
    draw,
)

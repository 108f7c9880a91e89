"""Fig. 9: restitution in inclined impacts along either axis."""

import pandas as pd
from matplotlib.figure import Figure

from .drawing import (
    ANGLE,
    ASPECT_RATIO,
    MAJOR,
    MINOR,
    ORIENTATION,
    aspect_ratio_legend,
    draw_curves,
    panels,
)
from .impact_table import impact_table
from .paper_figure import PaperFigure
from .study import Study

RESULTS = ("e_n", "e_t")


def compute(study: Study) -> pd.DataFrame:
    """Set III."""
    base, axes = study.parametric_set("III")
    table = impact_table(base, axes, RESULTS, study.accuracy)
    return table.sort_values([ORIENTATION, ASPECT_RATIO, ANGLE], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """a, b: e_n and e_t along the major axis; c, d: along the minor axis."""
    figure, axes = panels(2, 2, sharey="col")
    for row, (orientation, name) in enumerate(((0.0, MAJOR), (90.0, MINOR))):
        chosen = table[table[ORIENTATION] == orientation]
        for each, result in zip(axes[2 * row :], RESULTS, strict=False):
            draw_curves(each, chosen, ANGLE, result, marker="o", markersize=3)
            each.set_title(f"along the {name}", fontsize="medium")
    aspect_ratio_legend(figure, table, marker="o", markersize=3)
    return figure


FIGURE_9 = PaperFigure("9", "restitution against impact angle", ("III",), compute, draw)

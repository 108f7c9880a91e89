"""Fig. 14: coefficients of restitution of all impacts of the runs."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..distributions import fit_normal
from ..formats.columns import OUTCOME_COLUMN
from ..mechanics.outcomes import Outcome
from ..plotting import VERMILION
from ..runout.biplanar import COEFFICIENTS, HOP
from ..runout.jumps import jumps, rise_before
from ..runout.restitutions import restitutions
from .drawing import LABEL_SIZE, label_axes, legend_over, panels
from .paper_figure import PaperFigure
from .slope_runs import (
    ENDING_COLUMN,
    blocks_table,
    distance_in_words,
    draw_histogram,
    normal,
    scale_counts,
)
from .study import Study

RESULTS = ("e_n", "e_t")
RISE = "rise_before_m"
"""Of the flight that an impact ends; NaN where the block came along the ground."""
BINS = 80
ALL = {"color": "black"}
HIGHER = {"color": VERMILION, "ls": "--"}


def compute(study: Study) -> pd.DataFrame:
    """A row for each impact; coefficients are NaN where the centre does not come
    down."""
    runs = study.slope_runs()
    found = restitutions(runs)
    chosen = np.flatnonzero(runs.contacts.outcome >= 0)
    table = blocks_table(runs, runs.contacts.trajectory[chosen])
    outcomes = [str(Outcome(code)) for code in runs.contacts.outcome[chosen]]
    return table.drop(columns=ENDING_COLUMN).assign(
        x_m=runs.contacts.x[chosen],
        e_n=found.e_n[chosen],
        e_t=found.e_t[chosen],
        **{
            RISE: rise_before(runs, jumps(runs))[chosen],
            OUTCOME_COLUMN: outcomes,
        },
    )


def draw(table: pd.DataFrame) -> Figure:
    """a: e_n; b: e_t; with normal fits to all impacts and to those after a flight that
    rises by more than a hop: mean and standard deviation, distance, and in brackets
    what it exceeds by chance in 5 of 100 cases."""
    figure, axes = panels(1, 2)
    edges = np.linspace(*COEFFICIENTS, BINS + 1)
    for each, name in zip(axes, RESULTS, strict=True):
        inside = table[table[name].between(*COEFFICIENTS)]
        words = []
        for rows, style in ((inside, ALL), (inside[inside[RISE] > HOP], HIGHER)):
            fit = fit_normal(rows[name])
            draw_histogram(each, rows[name], edges, fit, normal, **style)
            words.append(
                f"{fit.start:.2f} ± {fit.scale:.2f}, distance {distance_in_words(fit)}"
            )
        label_axes(each, name, name)
        each.set_ylabel("impacts [-]", fontsize=LABEL_SIZE)
        scale_counts(each, inside[name], edges)
        each.set_title("\n".join(words), fontsize="medium")
    names = ("all impacts", f"those after a rise of more than {HOP:g} m")
    legend_over(
        figure,
        [
            Line2D([], [], label=f"{name}, normal fit", **style)
            for name, style in zip(names, (ALL, HIGHER), strict=True)
        ],
    )
    return figure


FIGURE_14 = PaperFigure(
    "14", "restitution in all impacts of the runs", (), compute, draw, on_the_slope=True
)

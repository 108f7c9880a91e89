"""Figures 4 to 9 and 13: single impacts of the parametric sets."""

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jaximpact.plotting.style import BLUE, GREEN, VERMILION, in_style, legend_outside
from jaximpact.quantities import OUTCOME_COLUMN

from ..study import Study
from .drawing import (
    ANGLE,
    ASPECT_RATIO,
    MAJOR,
    MINOR,
    ORIENTATION,
    aspect_ratio_legend,
    draw_curve,
    draw_curves,
    draw_series,
    draw_squares,
    label_axes,
    lettered_panels,
    square_handles,
)
from .tables import (
    PaperFigure,
    Table,
    curves_with_jumps,
    impact_table,
    peak,
    series_table,
)

POINTS = {"marker": "o", "markersize": 3}
LARGEST = ("max_penetration_m", "max_normal_force_N")
IMPACT_ANGLE = 20.0
"""Impact angle of figure 6 [deg]."""
MAX_RATIO = "max_R_r"
"""Column of the largest rotational over total kinetic energy during contact."""
SPIN = "angular_velocity_degps"
COEFFICIENTS: dict[str, tuple[str, dict[str, Any]]] = {
    "e_n": ("apparent", {"color": BLUE}),
    "e_contact": ("contact", {"color": VERMILION, "ls": "--"}),
    "e_bar": ("energetic", {"color": GREEN, "ls": "-."}),
    "e_n_vijayakumar": ("Vijayakumar et al. (2012)", {"color": "black", "ls": ":"}),
}
"""Column -> name in the legend, and line."""


def over_time(
    number: str, title: str, name: str, fixed: dict[str, float], series: Sequence[str]
) -> PaperFigure:
    """Draw a figure of time series for each aspect ratio of a set, one panel each.

    Args:
        name: of the parametric set.
        fixed: quantities that are the same for all.
    """

    def compute(study: Study) -> Table:
        ratios = np.asarray(study.parametric_set(name)[1][ASPECT_RATIO])
        points = [{**fixed, ASPECT_RATIO: value} for value in ratios]
        return series_table(study, name, points, ("time_s", *series))

    @in_style
    def draw(table: Table) -> Figure:
        figure, axes = lettered_panels(len(series) // 2, 2)
        for each, column in zip(axes, series, strict=True):
            draw_series(each, table, column)
            each.set_ylim(bottom=0.0)
        aspect_ratio_legend(figure, table, outcomes=True)
        return figure

    return PaperFigure(number, title, (name,), compute, draw)


def compute_5(study: Study) -> Table:
    """Compute sets I and II."""
    parts = []
    for name, orientation in (("I", 0.0), ("II", 90.0)):
        part = impact_table(*study.parametric_set(name), LARGEST, study.accuracy)
        part.insert(0, ORIENTATION, orientation)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


@in_style
def draw_5(table: Table) -> Figure:
    """Draw a: max u_n, b: max N, against A_r."""
    figure, axes = lettered_panels(1, 2)
    for each, result in zip(axes, LARGEST, strict=True):
        draw_squares(each, table, result)
    legend_outside(figure, square_handles(), "upper center")
    return figure


def compute_7(study: Study) -> Table:
    """Set III along the major axis, with the largest R_r of each impact."""
    base, axes = study.parametric_set("III")
    axes = {name: axes[name] for name in axes if name != ORIENTATION}
    table = impact_table(base, axes, (*LARGEST, "rotation_rad"), study.accuracy)
    points = table[[*axes]].to_dict("records")
    ratios = [
        peak(np.asarray(history.time), np.asarray(history.rotational_ratio))
        for _, history in study.record("III", points)
    ]
    table.insert(table.columns.get_loc(OUTCOME_COLUMN), MAX_RATIO, ratios)
    return table.sort_values([ASPECT_RATIO, ANGLE], ignore_index=True)


@in_style
def draw_7(table: Table) -> Figure:
    """Draw a: max u_n; b: max N; c: rotation; d: max R_r."""
    figure, axes = lettered_panels(2, 2)
    results = (*LARGEST, "rotation_rad", MAX_RATIO)
    for each, result in zip(axes, results, strict=True):
        draw_curves(each, table, ANGLE, result, **POINTS)
        each.set_ylim(bottom=0.0)
    aspect_ratio_legend(figure, table, **POINTS)
    return figure


RESULTS_8 = (
    "e_n",
    "max_penetration_m",
    "rotation_rad",
    "max_normal_force_N",
    "max_moment_Nm",
)


@in_style
def draw_8(table: Table) -> Figure:
    """a: e_n along either axis, against A_r; b to f against orientation: e_n, max u_n,
    rotation, max N, max moment."""
    figure, axes = lettered_panels(3, 2)
    draw_squares(axes[0], table, "e_n")
    axes[0].legend(handles=square_handles())
    for each, result in zip(axes[1:], RESULTS_8, strict=True):
        draw_curves(each, table, ORIENTATION, result)
        each.set_xlim(0.0, 180.0)
    axes[-1].set_ylim(bottom=0.0)
    aspect_ratio_legend(figure, table)
    return figure


def compute_9(study: Study) -> Table:
    """Set III."""
    restitution = ("e_n", "e_t")
    table = impact_table(*study.parametric_set("III"), restitution, study.accuracy)
    return table.sort_values([ORIENTATION, ASPECT_RATIO, ANGLE], ignore_index=True)


@in_style
def draw_9(table: Table) -> Figure:
    """Draw e_n and e_t, a, b: along the major axis; c, d: along the minor axis."""
    figure, axes = lettered_panels(2, 2, sharey="col")
    for row, (orientation, name) in enumerate(((0.0, MAJOR), (90.0, MINOR))):
        chosen = table[table[ORIENTATION] == orientation]
        for each, result in zip(axes[2 * row :], ("e_n", "e_t"), strict=False):
            draw_curves(each, chosen, ANGLE, result, **POINTS)
            each.set_title(f"along the {name}")
    aspect_ratio_legend(figure, table, **POINTS)
    return figure


@in_style
def draw_13(table: Table) -> Figure:
    """Draw a to d: no spin, 500, 1500 and 2000 °/s."""
    figure, axes = lettered_panels(2, 2, sharex=True, sharey=True)
    for each, (spin, curves) in zip(axes, table.groupby(SPIN), strict=True):
        for column, (_, style) in COEFFICIENTS.items():
            draw_curve(each, curves, ORIENTATION, column, **style)
        label_axes(each, ORIENTATION, "e_n", "coefficient of restitution [-]")
        each.set_title(f"initial spin {spin:g} °/s")
    axes[0].set_xlim(0.0, 180.0)
    handles = [Line2D([], [], label=name, **s) for name, s in COEFFICIENTS.values()]
    legend_outside(figure, handles, "upper center")
    return figure


IMPACT_FIGURES = (
    over_time(
        "4",
        "vertical impacts along the major axis, over time",
        "I",
        {},
        ("penetration_m", "normal_force_N"),
    ),
    PaperFigure(
        "5",
        "vertical impacts along either axis, largest values",
        ("I", "II"),
        compute_5,
        draw_5,
    ),
    over_time(
        "6",
        "impacts along the major axis at 20°, over time",
        "III",
        {ANGLE: IMPACT_ANGLE},
        ("penetration_m", "normal_force_N", "rotation_rad", "R_r"),
    ),
    PaperFigure(
        "7",
        "impacts along the major axis against impact angle",
        ("III",),
        compute_7,
        draw_7,
    ),
    PaperFigure(
        "8",
        "vertical impacts against orientation",
        ("IV",),
        functools.partial(curves_with_jumps, name="IV", results=RESULTS_8),
        draw_8,
    ),
    PaperFigure("9", "restitution against impact angle", ("III",), compute_9, draw_9),
    PaperFigure(
        "13",
        "coefficients of a spinning block",
        ("fig13",),
        functools.partial(curves_with_jumps, name="fig13", results=tuple(COEFFICIENTS)),
        draw_13,
    ),
)

"""One look for the paper's figures: a colour for each aspect ratio, a marker for each
outcome, curves that are not drawn through their jumps."""

import itertools
from collections.abc import Iterable
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from jaximpact.impact.events import Outcome
from jaximpact.plotting.style import legend_outside, letter, panels
from jaximpact.quantities import OUTCOME_COLUMN
from jaximpact.units import DEGREE

from .tables import BRANCH, Table

ASPECT_RATIO = "aspect_ratio"
ANGLE, ORIENTATION = "angle_deg", "orientation_deg"
MAJOR, MINOR = "major axis", "minor axis"
"""Names of the axis along which a block strikes, in legends."""

LABELS = {
    ASPECT_RATIO: "aspect ratio $A_r$ [-]",
    ANGLE: r"impact angle $\theta^{in}$ [°]",
    ORIENTATION: r"initial orientation $\theta_0$ [°]",
    "time_s": "time [ms]",
    "penetration_m": "displacement $u_n$ [m]",
    "normal_force_N": "normal force $N$ [kN]",
    "rotation_rad": r"rotation $\theta - \theta_0$ [°]",
    "R_r": "energy ratio $R_r$ [-]",
    "max_penetration_m": "max $u_n$ [m]",
    "max_normal_force_N": "max $N$ [kN]",
    "max_moment_Nm": "max $|M|$ [kN m]",
    "max_R_r": "max $R_r$ [-]",
    "e_n": "normal restitution $e_n$ [-]",
    "e_t": "tangential restitution $e_t$ [-]",
    "x_m": "x [m]",
    "y_m": "y [m]",
    "height_m": "height above the ground [m]",
    "velocity_mps": "velocity [m/s]",
    "spin_degps": "rotational velocity [10³ °/s]",
}
"""Column -> label of its axis."""
UNITS = {
    "time_s": 1e-3,
    "normal_force_N": 1e3,
    "rotation_rad": DEGREE,
    "max_normal_force_N": 1e3,
    "max_moment_Nm": 1e3,
    "spin_degps": 1e3,
}
"""Column -> what counts as 1 on its axis, where it is not the column's own unit."""

DARK_TO_LIGHT = matplotlib.colormaps["viridis"]
"""Lightness alone tells its colours apart, in print without colour too."""
LIGHTEST = 0.92
"""Fraction of the sequence that can be seen on white."""
MARKERS = {
    str(Outcome.detached): "o",
    str(Outcome.toppled): "^",
    str(Outcome.arrested): "s",
    str(Outcome.in_contact): "D",
    str(Outcome.separating): "P",
    str(Outcome.failed): "X",
}
SQUARES: dict[str, Any] = {"color": "black", "marker": "s", "markersize": 5, "lw": 0.9}


def lettered_panels(rows: int, columns: int, **how) -> tuple[Figure, list[Axes]]:
    """Begin a figure with lettered panels, row by row, each with the numbers of its
    axes."""
    # The legends above and below take room of their own.
    how = {"height": 2.6 + 0.6 / rows, **how}
    figure, axes = panels(rows, columns, **how)
    letter(axes)
    for each in axes:
        each.tick_params(labelleft=True, labelbottom=True)
    return figure, axes


def label_axes(axes: Axes, x: str, y: str, y_label: str = "") -> None:
    """Labels with units, round ticks for angles, and a line at zero where values lie on
    both sides of it.

    Args:
        x, y: columns.
        y_label: in place of the label of y.
    """
    axes.set(xlabel=LABELS[x], ylabel=y_label or LABELS[y])
    if x in (ANGLE, ORIENTATION):
        axes.xaxis.set_major_locator(MultipleLocator(30 if x == ORIENTATION else 10))
    if x == "time_s":
        axes.set_xlim(left=0.0)
    if axes.dataLim.y0 < 0.0 < axes.dataLim.y1:
        axes.axhline(0.0, color="0.4", lw=0.7, zorder=1)


def colours_of(values: Iterable[float]) -> dict[float, tuple]:
    """Choose colours from dark to light for numbers in ascending order."""
    known = np.unique(list(values))
    shades = np.linspace(0.0, LIGHTEST, len(known)) if len(known) > 1 else [0.0]
    return {
        value: DARK_TO_LIGHT(shade) for value, shade in zip(known, shades, strict=True)
    }


def draw_curves(axes: Axes, table: Table, x: str, y: str, **style) -> None:
    """Draw a curve for each aspect ratio; a jump is dotted."""
    for value, colour in colours_of(table[ASPECT_RATIO]).items():
        curve = table[table[ASPECT_RATIO] == value]
        draw_curve(axes, curve, x, y, **{"color": colour, **style})
    label_axes(axes, x, y)


def draw_curve(axes: Axes, curve: Table, x: str, y: str, **style) -> None:
    """Draw one curve in its pieces, if it has any."""
    pieces = [curve]
    if BRANCH in curve:
        pieces = [piece for _, piece in curve.groupby(BRANCH)]
    for piece in pieces:
        axes.plot(*_scaled(piece, x, y), **{"lw": 1.4, **style})
    for left, right in itertools.pairwise(pieces):
        over = pd.concat([left.tail(1), right.head(1)])
        style = {**style, "ls": ":", "marker": "", "lw": 0.9}
        axes.plot(*_scaled(over, x, y), **style)


def draw_series(axes: Axes, table: Table, y: str) -> None:
    """Draw a time series for each aspect ratio up to its end, which the outcome
    marks."""
    for value, colour in colours_of(table[ASPECT_RATIO]).items():
        series = table[table[ASPECT_RATIO] == value]
        draw_curve(axes, series, "time_s", y, color=colour)
        last = series.tail(1)
        (outcome,) = last[OUTCOME_COLUMN]
        end: dict[str, Any] = {"marker": MARKERS[outcome], "markersize": 5}
        end |= {"color": colour, "zorder": 4, "clip_on": False}
        axes.plot(*_scaled(last, "time_s", y), **end)
    label_axes(axes, "time_s", y)


def draw_squares(axes: Axes, table: Table, y: str) -> None:
    """Against the aspect ratio: filled squares for blocks that strike along the major
    axis, empty ones for the minor."""
    for orientation, fill in ((0.0, "black"), (90.0, "white")):
        chosen = table.loc[table[ORIENTATION] == orientation, [ASPECT_RATIO, y]]
        draw_curve(axes, chosen, ASPECT_RATIO, y, mfc=fill, **SQUARES)
    label_axes(axes, ASPECT_RATIO, y)


def square_handles() -> list[Line2D]:
    """Make the entries of a legend for `draw_squares`."""
    return [
        Line2D([], [], mfc=fill, label=label, **SQUARES)
        for fill, label in (("black", MAJOR), ("white", MINOR))
    ]


def aspect_ratio_legend(
    figure: Figure, table: Table, *, outcomes: bool = False, **style
) -> None:
    """Legends over all panels: the aspect ratios and, if wanted, the outcomes."""
    handles = [Line2D([], [], ls="", label="$A_r$ =")]
    for value, colour in colours_of(table[ASPECT_RATIO]).items():
        line = {"color": colour, "lw": 1.8, **style}
        handles.append(Line2D([], [], label=f"{value:g}", **line))
    legend_outside(
        figure, handles, "upper center", ncols=len(handles), handlelength=1.4
    )
    if outcomes:
        order = [str(outcome) for outcome in Outcome]
        ends = sorted(table[OUTCOME_COLUMN].unique(), key=order.index)
        handles = [Line2D([], [], ls="", label="end of the contact:")]
        for end in ends:
            marker: dict[str, Any] = {"color": "0.3", "ls": "", "marker": MARKERS[end]}
            handles.append(Line2D([], [], label=end, **marker))
        legend_outside(
            figure, handles, "lower center", ncols=len(handles), handlelength=1.0
        )


def _scaled(table: Table, *columns: str) -> list[np.ndarray]:
    """Return columns in the units of their axes."""
    return [table[name].to_numpy() / UNITS.get(name, 1.0) for name in columns]

"""Fig. 10: the slope of two planes."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from ..plotting import BLUE, SOIL
from ..runout.biplanar import (
    FLAT_LENGTH,
    HEIGHT,
    SLOPE,
    SLOPE_LENGTH,
    SPEED,
    BiplanarCase,
)
from ..scene import GRAVITY
from ..units import DEGREE
from .drawing import LABEL_SIZE, label_axes, panels
from .paper_figure import PaperFigure
from .study import Study

LINE = "line"
PROFILE, FLIGHT = "profile", "parabola of the release"
DRAWN = 241
"""Points of the parabola."""


def compute(study: Study) -> pd.DataFrame:
    """Points of the profile, and of the parabola up to where it comes down to it."""
    case = BiplanarCase()
    profile = case.profile(study.parametric_set("I")[0].soil)
    v_x, v_y = SPEED * np.cos(case.direction), SPEED * np.sin(case.direction)
    rising = v_y + v_x * np.tan(SLOPE)
    end = (rising + np.sqrt(rising**2 + 2.0 * GRAVITY * case.height)) / GRAVITY
    time = np.linspace(0.0, end, DRAWN)
    return pd.concat(
        [
            pd.DataFrame({LINE: PROFILE, "x_m": profile.x, "y_m": profile.y}),
            pd.DataFrame(
                {
                    LINE: FLIGHT,
                    "x_m": v_x * time,
                    "y_m": HEIGHT + case.height + (v_y - 0.5 * GRAVITY * time) * time,
                }
            ),
        ],
        ignore_index=True,
    )


def draw(table: pd.DataFrame) -> Figure:
    """The profile with its lengths, and the parabola."""
    figure, (axes,) = panels(1, 1, squeeze=False)
    profile, flight = (table[table[LINE] == name] for name in (PROFILE, FLIGHT))
    x, y = profile["x_m"].to_numpy(), profile["y_m"].to_numpy()
    axes.fill_between(x, y, -60.0, color=SOIL)
    axes.plot(x, y, color="black", lw=2.5, label=PROFILE)
    axes.plot(flight["x_m"], flight["y_m"], color=BLUE, lw=1.4, label=FLIGHT)
    for ends, text in (
        ((x[0], x[1]), f"$L_{{s1}}$ = {SLOPE_LENGTH:g} m"),
        ((x[1], x[2]), f"$L_{{s2}}$ = {FLAT_LENGTH:g} m"),
    ):
        _measure(axes, (ends[0], -25.0), (ends[1], -25.0))
        axes.text(0.5 * sum(ends), -30.0, text, ha="center", va="top")
    _measure(axes, (x[1] + 80.0, 0.0), (x[1] + 80.0, y[0]))
    axes.text(x[1] + 90.0, 0.5 * y[0], f"$H_s$ = {HEIGHT:g} m", va="center")
    axes.text(x[1] - 210.0, 12.0, rf"$\omega$ = {SLOPE / DEGREE:.1f}°")
    angle = BiplanarCase().direction
    start = flight.iloc[0]
    tip = (start["x_m"] + 90.0 * np.cos(angle), start["y_m"] + 90.0 * np.sin(angle))
    axes.annotate(
        "",
        tip,
        (start["x_m"], start["y_m"]),
        arrowprops={"arrowstyle": "-|>", "color": BLUE, "lw": 1.4},
    )
    axes.text(
        tip[0] + 6.0,
        tip[1],
        f"{SPEED:g} m/s, {angle / DEGREE:g}° up",
        va="center",
        fontsize=LABEL_SIZE,
    )
    label_axes(axes, "x_m", "y_m")
    axes.set(xlim=(x[0] - 20.0, x[-1]), ylim=(-60.0, 290.0))
    figure.set_figheight(3.4)
    axes.set_aspect("equal")
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper center", ncols=len(labels), frameon=False
    )
    return figure


def _measure(axes, start, stop) -> None:
    """A line with an arrow at both ends."""
    style = {"arrowstyle": "<->", "color": "0.3", "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", stop, start, arrowprops=style)


FIGURE_10 = PaperFigure(
    "10", "the slope of two planes", (), compute, draw, on_the_slope=True
)

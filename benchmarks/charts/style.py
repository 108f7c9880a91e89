"""One look for all charts: a colour for each family, a marker for each method."""

import itertools

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from jaximpact.plotting.style import (
    BLUE,
    GREEN,
    GREY,
    MARKERS,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    log_scale,
)

from .section import Table

COLOURS = {
    "jaximpact": BLUE,
    "numbalsoda": VERMILION,
    "CVODE": GREEN,
    "SciPy": ORANGE,
    "diffrax": PURPLE,
    "explicit": GREY,
    "diffsol": SKY,
}


def styles_of(rows: Table) -> dict[str, dict]:
    """Colour of the family of each method, and a marker by its place in it."""
    return {
        name: {"color": COLOURS.get(family, SKY), "marker": marker}
        for family, own in rows.groupby("family", sort=False)
        for name, marker in zip(
            own["method"].unique(), itertools.cycle(MARKERS), strict=False
        )
    }


def method_handles(rows: Table) -> list[Line2D]:
    """An entry of the legend for each method."""
    return [Line2D([], [], label=n, **style) for n, style in styles_of(rows).items()]


def log_axes(axes: Axes, x: str, y: str) -> None:
    """Make both axes logarithmic, with labels."""
    log_scale(axes)
    axes.set(xlabel=x, ylabel=y)


def grouped(number: float) -> str:
    """Write a large number with its digits in groups of three: 70 932."""
    return f"{number:,.0f}".replace(",", "\N{NO-BREAK SPACE}")

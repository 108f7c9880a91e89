"""One look for all charts: a colour for each family, a marker for each method."""

import itertools
from collections.abc import Iterable

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION

COLOURS = {
    "jaximpact": BLUE,
    "numbalsoda": VERMILION,
    "CVODE": GREEN,
    "SciPy": ORANGE,
    "diffrax": PURPLE,
    "explicit": GREY,
}
MARKERS = "osD^vPX*<>"


def colour_of(family: str) -> str:
    """The colour of a family."""
    return COLOURS.get(family, SKY)


def markers_of(rows: Iterable[dict]) -> dict[str, str]:
    """A marker for each method, by its place in its family."""
    families: dict[str, list[str]] = {}
    for row in rows:
        names = families.setdefault(row["family"], [])
        if row["method"] not in names:
            names.append(row["method"])
    return {
        name: marker
        for names in families.values()
        for name, marker in zip(names, itertools.cycle(MARKERS), strict=False)
    }


def legend_of(figure: Figure, handles: list[Line2D]) -> None:
    """A legend to the right of all panels, where it covers nothing."""
    figure.legend(handles=handles, loc="outside right upper", frameon=False)


def method_handles(rows: Iterable[dict]) -> list[Line2D]:
    """An entry of the legend for each method."""
    rows = list(rows)
    markers = markers_of(rows)
    families = {row["method"]: row["family"] for row in rows}
    return [
        Line2D([], [], color=colour_of(families[name]), marker=marker, label=name)
        for name, marker in markers.items()
    ]


def log_axes(axes: Axes, x: str, y: str) -> None:
    """Two logarithmic axes with labels and a quiet grid."""
    axes.set(xscale="log", yscale="log", xlabel=x, ylabel=y)
    axes.grid(alpha=0.25, which="major")

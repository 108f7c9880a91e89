"""One look for all charts: a colour for each family, a marker for each method."""

import itertools
from collections.abc import Iterable

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

COLOURS = {
    "jaximpact": BLUE,
    "numbalsoda": VERMILION,
    "CVODE": GREEN,
    "SciPy": ORANGE,
    "diffrax": PURPLE,
    "explicit": GREY,
}


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


def method_handles(rows: Iterable[dict]) -> list[Line2D]:
    """An entry of the legend for each method."""
    rows = list(rows)
    families = {row["method"]: row["family"] for row in rows}
    return [
        Line2D([], [], color=colour_of(families[name]), marker=marker, label=name)
        for name, marker in markers_of(rows).items()
    ]


def log_axes(axes: Axes, x: str, y: str) -> None:
    """Make both axes logarithmic, with labels."""
    log_scale(axes)
    axes.set(xlabel=x, ylabel=y)

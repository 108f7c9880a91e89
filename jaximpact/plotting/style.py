"""One style for all drawings: sizes, colours, ticks, legends, files.

A drawing shown in a page of 800 px is 8 inches wide: its letters of 9 points stay 9
points. Functions that draw or save wear `@in_style`; figures come from `panels`.
"""

import contextlib
import io
import math
import os
import textwrap
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import matplotlib.style
import numpy as np
from cycler import cycler
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from PIL import Image

from .._settings import numpy_settings
from ..errors import InputError
from ..io.files import replacing

# Okabe and Ito's colours, which colour-blind readers tell apart.
BLUE, SKY, ORANGE, VERMILION = "#0072b2", "#56b4e9", "#e69f00", "#d55e00"
GREEN, PURPLE, GREY, SOIL = "#009e73", "#cc79a7", "#9a9a9a", "#eadcc4"
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY)
"""Colours of series, in the order in which they are given out."""
MARKERS = "os^Dv<P*X>"
LINES = ("-", "--", ":", "-.")
MOST_CURVES = len(COLOURS) * len(LINES)
"""Number of series that differ in colour or line, see `curve`."""

WIDTH = 8.0
"""Width of a drawing [inch]; wider ones are shrunk where they are shown."""
LINE = 100
"""Letters of a line of the title of such a drawing: of 10 points they take 7 of its 8
inches."""
MOST_LETTERS = 24
"""Letters of a name at a tick: slanted they take an inch of a panel's height."""
DPI = 150
"""Resolution of saved drawings [pixels per inch]."""

STYLE = {
    "figure.constrained_layout.use": True,
    "figure.titlesize": 10,
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.labelsize": 10,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "legend.fontsize": 9,
    "legend.title_fontsize": 9,
    "legend.frameon": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.alpha": 0.25,
    "axes.prop_cycle": cycler(color=COLOURS),
    "savefig.dpi": DPI,
}
"""What differs from Matplotlib's own style."""


@contextlib.contextmanager
def _our_settings() -> Iterator[None]:
    with matplotlib.style.context(["default", STYLE]), numpy_settings():
        yield


in_style = _our_settings()
"""Decorator of a function that draws, or saves a drawing: within it Matplotlib has this
style, whatever the user's own is. Some letters are laid out only when the drawing is
saved."""


On = Figure | Axes | Sequence[Axes] | np.ndarray | None
"""An empty figure, or axes, to draw on; None for a new figure."""


def given_axes(on: Any, count: int) -> tuple[Any, list[Axes]]:
    """Return the figure of axes that a user gave, the whole one of a subfigure's, and
    these. Raises InputError unless there is one for each panel."""
    axes = list(np.ravel(on))
    if len(axes) != count or not all(isinstance(one, Axes) for one in axes):
        raise InputError(
            f"ax must be Matplotlib's axes, one for each of {count} panels, but is "
            f"{on!r}"
        )
    return axes[0].figure.figure, axes


@in_style
def plotted(
    draw: Callable[..., Figure],
    path: str | os.PathLike | None = None,
    ax: Axes | Sequence[Axes] | np.ndarray | None = None,
) -> Any:
    """Draw what a `plot` method shows, and return its axes, an array of several.

    Args:
        draw: function of `on`, as for `panels`.
        path: file to save the figure in too; replaced once the new one is whole.
        ax: axes to draw on, one for each panel. Without axes and path the figure is one
            of `matplotlib.pyplot`, which notebooks and `pyplot.show()` show.
    """
    if ax is not None or path is not None:
        return _axes_of(save_figure(draw(on=Figure() if ax is None else ax), path), ax)
    from matplotlib import pyplot

    figure = pyplot.figure()
    try:
        return _axes_of(draw(on=figure), None)
    except BaseException:
        pyplot.close(figure)
        raise


def _axes_of(figure: Figure, given: Any) -> Any:
    if given is not None:
        return given
    # A second scale has the place of its panel, and a bar of colours none.
    by_place = {}
    for axes in figure.axes:
        by_place.setdefault(axes.get_subplotspec(), axes)
    by_place.pop(None, None)
    axes = [*by_place.values()]
    return axes[0] if len(axes) == 1 else np.array(axes)


@in_style
def panels(
    rows: int = 1,
    columns: int = 1,
    *,
    height: float = 2.6,
    width: float = WIDTH,
    title: str | None = None,
    count: int | None = None,
    on: On = None,
    **subplots,
) -> tuple[Figure, list[Axes]]:
    """Begin a figure of panels, and return it with the panels, row by row.

    Args:
        height: of a row [inch].
        width: of the figure [inch].
        count: of the panels, where the last row is not full.
        on: an empty figure; or axes, one for each panel, whose figure stays as it is.
        subplots: further arguments of `Figure.subplots`, such as sharex.
    """
    if on is not None and not isinstance(on, Figure):
        return given_axes(on, count or rows * columns)
    figure = on or Figure()
    figure.set_size_inches(width, rows * height + (0.4 if title else 0.0))
    if title:
        _set_title(figure, title)
    axes = list(figure.subplots(rows, columns, squeeze=False, **subplots).flat)
    for unused in axes[count:] if count is not None else ():
        unused.remove()
    axes = axes[:count]
    for panel in axes:
        few_ticks(panel, width / columns - 0.8, height - 0.6)
    return figure, axes


def _set_title(figure: Figure, title: str) -> None:
    """Set the title, in as many lines as have room beside each other; the figure grows
    by those that are added."""
    letters = int(LINE / WIDTH * figure.get_figwidth())
    lines = [textwrap.fill(line, letters) for line in title.split("\n")]
    more = sum(line.count("\n") for line in lines)
    figure.set_figheight(figure.get_figheight() + 0.17 * more)
    figure.suptitle("\n".join(lines))


def few_ticks(axes: Axes, width: float, height: float) -> None:
    """Give linear axes so few ticks that their numbers do not collide; width and height
    are those of the panel without its labels [inch]."""
    for axis, length in ((axes.xaxis, width), (axes.yaxis, 1.5 * height)):
        # A tick with its number takes 0.6 inch.
        most = int(np.clip(length / 0.6, 3, 8))
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]))
        # So that bars with names still bring their own ticks
        axis.isDefault_majloc = True


def log_scale(axes: Axes, which: str = "xy") -> None:
    """Make axes logarithmic ("x", "y" or "xy"), with few ticks: decades, or 1, 2 and 5
    where there are not two decades."""
    for name in which:
        getattr(axes, f"set_{name}scale")("log")
        axis = getattr(axes, f"{name}axis")
        axis.set_major_locator(_FewDecades())
        axis.set_major_formatter(FuncFormatter(lambda value, _: log_label(value)))
        axis.set_minor_formatter(NullFormatter())


class _FewDecades(LogLocator):
    def __init__(self):
        super().__init__(numticks=5)

    def tick_values(self, vmin, vmax):
        decades = np.log10(vmax / vmin) if 0.0 < vmin < vmax else 0.0
        self.set_params(subs=(1.0,) if decades > 2.0 else (1.0, 2.0, 5.0))
        return super().tick_values(vmin, vmax)


def log_label(value: float) -> str:
    """Write the number of a tick of a logarithmic axis: 0.01, 200 or a power of ten."""
    if value <= 0.0 or 1e-3 <= value < 1e4:
        return f"{value:g}"
    exponent = int(np.floor(np.log10(value) + 1e-9))
    factor = f"{value / 10.0**exponent:.3g}"
    power = f"10^{{{exponent}}}"
    return f"${power}$" if factor == "1" else rf"${factor} \cdot {power}$"


@in_style
def letter(axes: Sequence[Axes]) -> None:
    """Letter panels a, b, c and so on."""
    for name, panel in zip("abcdefghijklmnop", axes, strict=False):
        panel.set_title(name, loc="left", fontweight="bold")


def curve(place: int) -> dict:
    """Colour and line of the series in a place; other lines follow the colours."""
    return {
        "color": COLOURS[place % len(COLOURS)],
        "ls": LINES[place // len(COLOURS) % len(LINES)],
    }


def points(place: int) -> dict:
    """Colour and marker of the series in a place."""
    return {
        "color": COLOURS[place % len(COLOURS)],
        "marker": MARKERS[place % len(MARKERS)],
    }


@in_style
def legend_outside(
    figure: Figure,
    handles: Sequence[Artist] | None = None,
    place: Literal["lower center", "upper center", "right upper"] = "lower center",
    *,
    of: Sequence[Axes] | None = None,
    **how,
) -> None:
    """Put one legend for all panels outside them, where it covers nothing; in the first
    of them where a user's figure has other panels, or keeps no room.

    Args:
        handles: of the series; without them those of all panels, each name once.
        of: the panels, where they may be a user's; else those of the figure.
        how: further arguments of `Figure.legend`, such as title or ncols: fewer columns
            where long names leave no room for so many.
    """
    drawn = figure.axes if of is None else of
    if handles is None:
        by_label = {}
        for panel in drawn:
            for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
                by_label.setdefault(label, handle)
        handles = list(by_label.values())
    if handles:
        columns = 1 if place.startswith("right") else min(len(handles), 6)
        how = {"ncols": columns, "columnspacing": 1.2, **how}
        if not figure.get_constrained_layout() or len(drawn) < len(figure.axes):
            drawn[0].legend(handles=handles, **how)
            return
        how["loc"] = f"outside {place}"
        legend = figure.legend(handles=handles, **how)
        while how["ncols"] > 1 and _is_wider(legend, figure):
            legend.remove()
            how["ncols"] -= 1
            legend = figure.legend(handles=handles, **how)
        rows = math.ceil(len(handles) / how["ncols"])
        if not place.startswith("right") and rows > 8:
            # Rows of 0.2 inch beyond these would leave no height for the panels.
            figure.set_figheight(figure.get_figheight() + 0.2 * (rows - 8))


def _is_wider(legend: Legend, figure: Figure) -> bool:
    return legend.get_window_extent().width > figure.bbox.width


def empty_panel(axes: Axes, words: str) -> None:
    """Say why a panel is empty, in lines that stay within it."""
    axes.set(xticks=[], yticks=[])
    # A letter takes 0.08 inch; labels leave the panel less width than it has now.
    letters = int(10.0 * axes.get_window_extent().width / axes.figure.dpi)
    lines = textwrap.fill(words, max(letters, 1))
    axes.text(0.5, 0.5, lines, ha="center", va="center", transform=axes.transAxes)


def plain(text: str) -> str:
    """Prepare text of the user's for a drawing, in which dollars begin no formula."""
    return text.replace("$", r"\$")


def tick_name(name: str) -> str:
    """Prepare a name of the user's for a tick; the middle of a long one is left out."""
    half = (MOST_LETTERS - 3) // 2
    return plain(
        name if len(name) <= MOST_LETTERS else f"{name[:half]}...{name[-half:]}"
    )


@in_style
def png_bytes(figure: Figure) -> bytes:
    """Return the bytes of a PNG file, the same for the same figure."""
    drawn, file = io.BytesIO(), io.BytesIO()
    # It is read again at once: to compress it would take a fifth of the time.
    in_memory = dict(compress_level=0)
    figure.savefig(drawn, format="png", dpi=DPI, pil_kwargs=in_memory)
    image = Image.open(drawn).convert("RGB")
    # Of 256 colours a file has a third of its size with all of them. The usual method
    # replaces rare ones, in a legend those of a line that others hide.
    way, dither = Image.Quantize.MAXCOVERAGE, Image.Dither.NONE
    few = image.quantize(256, way, dither=dither)
    few.save(file, format="png", dpi=(DPI, DPI), optimize=True)
    return file.getvalue()


@in_style
def save_figure(figure: Figure, path: str | os.PathLike | None) -> Figure:
    """Save a figure, if there is a path, in the format that its suffix names; a file
    of that name is replaced once the new one is whole.

    Returns the figure. Raises InputError for a suffix that names no format, and for a
    directory that is not there.
    """
    if path is not None:
        path = Path(path)
        known = figure.canvas.get_supported_filetypes()
        if path.suffix[1:].lower() not in known:
            raise InputError(
                f"a drawing must end in a format such as .png or .pdf, but is {path}"
            )
        if not path.parent.is_dir():
            raise InputError(
                f"a drawing needs the directory {path.parent}, which is not there"
            )
        with replacing(path) as temporary:
            if path.suffix.lower() == ".png":
                temporary.write_bytes(png_bytes(figure))
            else:
                figure.savefig(temporary, dpi=DPI)
    return figure

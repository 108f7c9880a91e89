"""A figure of the paper: what it shows, its table, and how that is drawn."""

from collections.abc import Callable
from typing import NamedTuple

import pandas as pd
from matplotlib.figure import Figure

from .study import Study


class PaperFigure(NamedTuple):
    """A figure that can be asked for by its number in the paper."""

    number: str
    title: str
    """What it shows, in a line."""
    sets: tuple[str, ...]
    """The parametric sets that it is computed from."""
    compute: Callable[[Study], pd.DataFrame]
    """The table: a row for each point, columns named with units as in `columns`."""
    draw: Callable[[pd.DataFrame], Figure]
    """The figure, from the table alone."""
    on_the_slope: bool = False
    """Whether it is of the runs down the slope of two planes."""

    @property
    def name(self) -> str:
        """Name of its files, without suffix."""
        return f"figure-{self.number}"

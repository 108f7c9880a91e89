"""A chart: what is measured for it, how it is drawn, and its table."""

from collections.abc import Callable
from typing import NamedTuple

from matplotlib.figure import Figure

from .methods import Method
from .settings import Settings

Row = dict[str, float | str]


class Bench(NamedTuple):
    """What a measurement is given."""

    settings: Settings
    methods: list[Method]
    """This solver first."""
    peers: str
    """Directory of the peers, or an empty text."""
    say: Callable[[str], None]
    """Takes lines of progress."""


class Section(NamedTuple):
    """A chart that can be asked for by name."""

    name: str
    measure: Callable[[Bench], list[Row]]
    """Rows of the CSV; all with the same keys."""
    draw: Callable[[list[Row]], Figure]
    """From the rows as they are read back."""
    table: Callable[[list[Row]], list[tuple[str, ...]]]
    """The figures that are worth quoting: a header, then rows."""

"""Tables as they are shown, and as files of comma-separated values."""

import csv
import io
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._tables import align

if TYPE_CHECKING:
    import pandas as pd

ROUNDING = 1e-9
"""Size below which a number is shown as 0: what rounding leaves of it, as of the height
of a block that rolls."""


class Table(NamedTuple):
    """Rows of cells under columns.

    Numbers are shown with four digits, and None and NaN as a dash; files of
    comma-separated values have all digits, and nothing for None.
    """

    columns: Sequence[str]
    """Names, a unit in brackets behind it where there is one."""
    rows: Sequence[Sequence[object]]

    def __bool__(self) -> bool:
        return bool(self.rows)

    def shown(self) -> Iterator[tuple[str, ...]]:
        """Yield the cells of each row as text."""
        for row in self.rows:
            yield tuple(map(cell_text, row))

    def text(self) -> str:
        """Align the columns."""
        return align([tuple(self.columns), *self.shown()])

    def csv(self) -> str:
        """Write comma-separated values."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerows([self.columns, *self.rows])
        return text.getvalue()

    def frame(self) -> "pd.DataFrame":
        """Make a data frame, with NaN for None."""
        import pandas as pd

        rows = [[np.nan if c is None else c for c in row] for row in self.rows]
        return pd.DataFrame(rows, columns=list(self.columns))


def cell_text(value: object) -> str:
    """Write the cell of a table, in one line."""
    if value is None:
        return "-"
    if isinstance(value, float):
        return number_text(value)
    return " ".join(str(value).splitlines())


def number_text(value: float) -> str:
    """Write a number with four digits, a dash where there is none."""
    if not np.isfinite(value):
        return "-"
    return f"{0.0 if abs(value) < ROUNDING else value:.4g}"


def place_text(value: float, digits: int = 4) -> str:
    """Write a coordinate [m] with so many digits, at least 4, and one of a national
    grid, of 5 digits or more before the point, to the decimetre."""
    if not np.isfinite(value):
        return "-"
    text = f"{0.0 if abs(value) < ROUNDING else value:.{digits}g}"
    if abs(float(text)) < 1e4:
        return text
    return f"{value:.1f}".removesuffix(".0")


def at_x(x: float) -> str:
    """Name a place on the slope."""
    return f"x = {place_text(x, 6)} m"


def interval_text(
    low: float, high: float, write: Callable[[float], str] = number_text
) -> str:
    """Write an interval; an end that is not known is a dash."""
    if np.isnan(low) and np.isnan(high):
        return "-"
    return f"{write(low)} to {write(high)}"


def listed(names: Sequence[str]) -> str:
    """Write names in a row: a, b and c."""
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))

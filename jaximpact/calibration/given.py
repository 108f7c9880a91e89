"""Tests as they are given in Python: the path of a table, or its columns."""

import csv
import io
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..formats.columns import LABEL_COLUMNS, RESULT_COLUMNS, SLOTS, columns_of
from ..formats.tables import SIGMA_COLUMNS, Table, read_table, table_of
from ..scene import Scene

COLUMNS = Path("columns given")
"""Stands in errors, and in the manifest, for the name of a file."""
NAMES = (*LABEL_COLUMNS, *RESULT_COLUMNS, *SIGMA_COLUMNS, *SLOTS)
"""Of columns, beside those of the scene."""
MISSING = ("nan", "NaN", "<NA>", "NaT", "None")
"""How numpy and pandas write a cell without a value."""


def table_given(tests: str | os.PathLike | Mapping, base: Scene | None = None) -> Table:
    """The table of tests.

    Args:
        tests: path of a CSV; or columns by name, as a dictionary or a data frame. A
            column is a sequence, or one value for all tests. Cells are those of the
            CSV: numbers, limits such as ">0.3", text; None and NaN are empty.
        base: as for `read_table`.

    Columns are written as a CSV and read like one, so that its checks are theirs too.
    The first test stands in row 2.

    Raises InputError for columns of different lengths, and as `read_table` does.
    """
    if isinstance(tests, str | os.PathLike):
        return read_table(Path(tests), measured=True, base=base)
    columns = _columns(tests, (*columns_of(base or Scene()), *NAMES))
    lengths = {name: len(c) for name, c in columns.items() if c.ndim == 1}
    for name, column in columns.items():
        if column.ndim > 1:
            raise InputError(
                f"must be one value a test, but has shape {column.shape}",
                file=COLUMNS,
                column=name,
            )
    count = max(lengths.values(), default=1)
    for name, length in lengths.items():
        if length != count:
            raise InputError(
                f"holds {length} values, but another column {count}",
                file=COLUMNS,
                column=name,
            )
    if not columns:
        raise InputError("hold no column; tests are needed", file=COLUMNS)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    cells = [np.broadcast_to(column, count).tolist() for column in columns.values()]
    writer.writerows(
        [_cell(value) for value in row] for row in zip(*cells, strict=True)
    )
    # Halves of characters are written as such, and told as no UTF-8.
    data = text.getvalue().encode("utf-8", "surrogatepass")
    return table_of(data, COLUMNS, measured=True, base=base)


def _columns(tests: Mapping, known: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Columns by name, with cells as they are; masked ones are None.

    Of a data frame the index too, where it has the name of a known column.
    """
    names = tests.keys() if hasattr(tests, "keys") else getattr(tests, "columns", None)
    if names is None:
        raise InputError(
            "tests must be the path of a table, or columns by name, but are of type "
            f"{type(tests).__name__}"
        )
    if hasattr(tests, "reset_index"):
        index = [name for name in tests.index.names if name in known]
        twice = [name for name in index if name in names]
        tests = tests if twice else tests.reset_index(index)
        names = [*twice, *tests.keys()]
    names = list(names)
    for place, name in enumerate(names):
        if not isinstance(name, str):
            raise InputError(
                f"columns must be named by a text each, but one is {name!r}",
                file=COLUMNS,
            )
        if name in names[:place]:
            raise InputError(
                "stands twice among the columns and the index",
                file=COLUMNS,
                column=name,
            )
    return {name: _cells(tests[name]) for name in names}


def _cells(values) -> np.ndarray:
    if isinstance(values, np.ma.MaskedArray):
        return np.where(np.ma.getmaskarray(values), None, values.data)
    return np.asarray(values, object)


def _cell(value) -> str:
    """A value as a CSV has it, with all digits of a number."""
    text = str(value)
    return "" if text in MISSING else text

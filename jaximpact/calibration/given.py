"""Tests as they are given in Python: the path of a table, or its columns."""

import csv
import io
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..formats.tables import Table, read_table, table_of

COLUMNS = Path("columns given")
"""Stands in errors, and in the manifest, for the name of a file."""
MISSING = ("nan", "NaN", "<NA>", "NaT", "None")
"""How numpy and pandas write a cell without a value."""


def table_given(tests: str | os.PathLike | Mapping) -> Table:
    """The table of tests.

    Args:
        tests: path of a CSV; or columns by name, as a dictionary or a data frame. A
            column is a sequence, or one value for all tests. Cells are those of the
            CSV: numbers, limits such as ">0.3", text; None and NaN are empty.

    Columns are written as a CSV and read like one, so that its checks are theirs too.
    The first test stands in row 2.

    Raises InputError for columns of different lengths, and as `read_table` does.
    """
    if isinstance(tests, str | os.PathLike):
        return read_table(Path(tests), measured=True)
    names = tests.keys() if hasattr(tests, "keys") else getattr(tests, "columns", None)
    if names is None:
        raise InputError(
            "tests must be the path of a table, or columns by name, but are of type "
            f"{type(tests).__name__}"
        )
    columns = {str(name): np.asarray(tests[name], object) for name in names}
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
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    cells = [np.broadcast_to(column, count).tolist() for column in columns.values()]
    writer.writerows(
        [_cell(value) for value in row] for row in zip(*cells, strict=True)
    )
    return table_of(text.getvalue().encode(), COLUMNS, measured=True)


def _cell(value) -> str:
    """A value as a CSV has it, with all digits of a number."""
    text = str(value)
    return "" if text in MISSING else text

"""The full model's impacts in tables, for when millions are needed.

How far tables are from the model: `ReboundTable.error`, and docs/limits.md.
"""

from .contacts import Tabulated
from .error import measure_error, random_impacts
from .files import read_table, write_csv, write_table
from .making import Nodes, tabulate
from .table import Entry, ReboundTable, TableError

__all__ = [
    "Entry",
    "Nodes",
    "ReboundTable",
    "TableError",
    "Tabulated",
    "measure_error",
    "random_impacts",
    "read_table",
    "tabulate",
    "write_csv",
    "write_table",
]

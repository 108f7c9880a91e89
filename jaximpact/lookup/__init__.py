"""Tables of the full model's impacts, for when millions are needed.

`ReboundTable.error` and docs/limits.md say how far tables are from the model.
"""

from .contacts import Tabulated
from .table import Entry, ReboundTable, TableError
from .table_files import read_table, write_csv, write_table
from .tabulation import Nodes, measure_error, random_impacts, tabulate

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

"""The full model's impacts in tables, for when millions are needed.

How far tables are from the model: `ReboundTable.error`, and docs/limits.md.
"""

from .contacts import Tabulated
from .error import measure_error, random_impacts
from .files import read_table, write_csv, write_table
from .making import Nodes, tabulate
from .orientation_map import MapAxes, orientation_map, write_map
from .table import Entry, ReboundTable, TableError

__all__ = [
    "Entry",
    "MapAxes",
    "Nodes",
    "ReboundTable",
    "TableError",
    "Tabulated",
    "measure_error",
    "orientation_map",
    "random_impacts",
    "read_table",
    "tabulate",
    "write_csv",
    "write_map",
    "write_table",
]

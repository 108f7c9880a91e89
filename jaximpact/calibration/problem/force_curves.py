"""Forces against time as targets: curves of tests.

Each time of a curve is a row of the tests, with the impact of its test, the time in
`time_s`, and the forces there. Points of one curve share one simulated impact.
"""

import dataclasses

import numpy as np

from ...errors import InputError
from ...io.scene_table import SIGMA_COLUMNS, SceneTable, read_table
from ...quantities import (
    CURVE_COLUMNS,
    CURVE_FILE,
    SIGMA_PREFIX,
    TARGET_COLUMNS,
    TIME_COLUMN,
)
from ...scene_quantities import with_shapes
from ...shapes import MixedShapes

OF_CURVES = (*CURVE_COLUMNS, *(SIGMA_PREFIX + name for name in CURVE_COLUMNS))
"""Columns of a curve's file, beside the time."""


def with_curves(table: SceneTable) -> SceneTable:
    """Append the points of the curves that rows of a table of tests name.

    Raises InputError for a file that is no curve.
    """
    curves = {
        row: _read_curve(table, row, name)
        for row, name in enumerate(table.labels.get(CURVE_FILE, ()))
        if name
    }
    if not curves:
        return table
    count = len(table.rows)
    sizes = [len(curve.rows) for curve in curves.values()]
    row_of = np.concatenate([np.arange(count), np.repeat([*curves], sizes)])
    results = TIME_COLUMN, *TARGET_COLUMNS, *SIGMA_COLUMNS

    def column(name: str) -> np.ndarray:
        of_rows = table.numbers.get(name, np.full(count, np.nan))
        if name not in results:
            return of_rows[row_of]
        points = [
            curve.numbers.get(name, np.full(len(curve.rows), np.nan))
            for curve in curves.values()
        ]
        return np.concatenate([of_rows, *points])

    names = dict.fromkeys((*table.numbers, TIME_COLUMN))
    names |= dict.fromkeys(n for c in curves.values() for n in c.numbers)
    base, shape = table.base, table.base.block.shape
    if isinstance(shape, MixedShapes):
        base = with_shapes(base, [shape.kinds[int(shape.index[r])] for r in row_of])
    measured = dict.fromkeys(n for n in names if n in TARGET_COLUMNS)
    points = np.zeros(sum(sizes), int)
    signs = {n: table.censored.get(n, np.zeros(count, int)) for n in measured}
    return dataclasses.replace(
        table,
        rows=[table.rows[row] for row in row_of],
        lines=table.lines[row_of],
        numbers={name: column(name) for name in names},
        censored={n: np.concatenate([of_n, points]) for n, of_n in signs.items()},
        labels={n: [texts[row] for row in row_of] for n, texts in table.labels.items()},
        base=base,
        beside=tuple({curve.path: curve for curve in curves.values()}.values()),
    )


def _read_curve(table: SceneTable, row: int, name: str) -> SceneTable:
    """Read the file of a curve: times and forces, and their sigmas."""
    place = {"file": table.path, "row": int(table.lines[row]), "column": CURVE_FILE}
    path = table.path.parent / name
    if not path.is_file():
        raise InputError(f"names {name}, which is no file in {path.parent}", **place)
    curve = read_table(path, measured=True)
    columns = [*curve.numbers, *curve.labels]
    for column in columns:
        if column not in (TIME_COLUMN, *OF_CURVES):
            raise InputError(
                f"belongs into {table.path.name}: a curve holds {TIME_COLUMN} and "
                f"{' or '.join(CURVE_COLUMNS)}",
                file=path,
                column=column,
            )
    if TIME_COLUMN not in columns or not {*columns} & {*CURVE_COLUMNS}:
        raise InputError(
            f"must have {TIME_COLUMN} and {' or '.join(CURVE_COLUMNS)}", file=path
        )
    return curve

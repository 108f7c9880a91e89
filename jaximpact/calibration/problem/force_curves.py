"""Forces against time as targets: curves of tests, and the model's forces.

Each time of a curve is a row of the tests, with the impact of its test, the time in
`time_s`, and the forces there. Points of one curve share one simulated impact.
"""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np

from ...accuracy import Accuracy
from ...backend.derivative_rules import solve_at
from ...errors import InputError
from ...io.scene_table import SIGMA_COLUMNS, Table, read_table
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


def with_curves(table: Table) -> Table:
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
        own = table.numbers.get(name, np.full(count, np.nan))
        if name not in results:
            return own[row_of]
        points = [
            curve.numbers.get(name, np.full(len(curve.rows), np.nan))
            for curve in curves.values()
        ]
        return np.concatenate([own, *points])

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
        censored={name: np.concatenate([own, points]) for name, own in signs.items()},
        labels={n: [texts[row] for row in row_of] for n, texts in table.labels.items()},
        base=base,
        beside=tuple({curve.path: curve for curve in curves.values()}.values()),
    )


def _read_curve(table: Table, row: int, name: str) -> Table:
    """Read the file of a curve: times and forces, and their sigmas."""
    place = {"file": table.path, "row": int(table.lines[row]), "column": CURVE_FILE}
    path = table.path.parent / name
    if not path.is_file():
        raise InputError(f"names {name}, which is no file in {path.parent}", **place)
    curve = read_table(path, measured=True)
    given = [*curve.numbers, *curve.labels]
    for column in given:
        if column not in (TIME_COLUMN, *OF_CURVES):
            raise InputError(
                f"belongs into {table.path.name}: a curve holds {TIME_COLUMN} and "
                f"{' or '.join(CURVE_COLUMNS)}",
                file=path,
                column=column,
            )
    if TIME_COLUMN not in given or not {*given} & {*CURVE_COLUMNS}:
        raise InputError(
            f"must have {TIME_COLUMN} and {' or '.join(CURVE_COLUMNS)}", file=path
        )
    return curve


def forces_at(
    structure,
    leaves: np.ndarray,
    directions: np.ndarray,
    times: np.ndarray,
    names: list[str],
    accuracy: Accuracy,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute forces of impacts at times, and their derivatives along directions.

    Args:
        structure: tree of a scene.
        leaves, directions: leaves of the scenes and their derivatives, shape (leaves,
            impacts); equal impacts are computed once.
        times: one for each impact [s], shape (impacts,).
        names: columns of `CURVE_COLUMNS`.

    Returns:
        Forces and their derivatives, shape (impacts, names), and codes of the outcomes,
        shape (impacts,). NaN after the end of a contact in which the block stays.
    """
    both = np.concatenate([leaves, directions])
    each, of = np.unique(both, axis=1, return_inverse=True)
    order = np.argsort(of, kind="stable")
    place = np.empty(len(of), int)
    first = np.searchsorted(of[order], np.arange(each.shape[1]))
    place[order] = np.arange(len(of)) - first[of[order]]
    at = np.full((each.shape[1], int(np.max(place)) + 1), np.inf)
    at[of, place] = times
    shape = len(names) + 1, *at.shape
    values, rates = np.empty(shape), np.empty(shape)
    leaves, directions = np.split(each, 2)
    patterns, kind = np.unique(directions != 0.0, axis=1, return_inverse=True)
    for number, varied in enumerate(patterns.T):
        own = np.flatnonzero(kind == number)
        # A power of two of impacts: JAX compiles for each number of them.
        filled = np.resize(own, 1 << (len(own) - 1).bit_length())
        rows = leaves[:, filled], directions[:, filled], at[filled]
        found = _solve(structure, *rows, np.flatnonzero(varied), names, accuracy)
        values[:, own], rates[:, own] = (part[:, : len(own)] for part in found)
    values, rates = values[:, of, place], rates[:, of, place]
    return values[:-1].T, rates[:-1].T, values[-1]


def _solve(structure, leaves, directions, times, places, names, accuracy):
    """Compute forces and outcomes of impacts, shape (names and outcome, impacts,
    times), and their derivatives with respect to the leaves at some places."""
    rows = [*leaves]

    def forces(changed):
        for place, row in zip(places, changed, strict=True):
            rows[place] = row
        numbers, history = solve_at(structure, rows, accuracy, False, times)
        found = [getattr(history, CURVE_COLUMNS[name].field) for name in names]
        outcome = jnp.broadcast_to(numbers.outcome_code[:, None], found[0].shape)
        return jnp.stack([*found, outcome])

    own = [jnp.asarray(leaves[place]) for place in places]
    if not own:
        values = np.asarray(forces(own))
        return values, np.zeros_like(values)
    along = [jnp.asarray(directions[place]) for place in places]
    return map(np.asarray, jax.jvp(forces, (own,), (along,)))

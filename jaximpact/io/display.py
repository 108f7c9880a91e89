"""Results as they show themselves in Python and in notebooks."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._tables import Row, align, html_table
from ..impact.events import Outcome
from ..impact.results import ImpactSummary
from ..quantities import RESULT_COLUMNS
from ..scene import Scene
from ..scene_quantities import SHAPE
from .result_table import count_outcomes

SHOWN_OF_MANY = ("e_n", "e_t", "e_bar", "max_penetration_m", "max_normal_force_N")
"""Results of which many impacts show statistics."""
WITHOUT_NUMBERS = (Outcome.separating, Outcome.failed)
"""Outcomes without an impact, or without its numbers; left out of statistics."""


def heads_and_rows(
    summary: ImpactSummary, scene: Scene, accuracy: str, history: Any
) -> tuple[list[str], list[Row]]:
    """Write a result as lines and a table: of one impact its numbers with units, of
    many their outcomes and statistics.

    Args:
        accuracy: name of the setting.
        history: of the impacts, or None; its times are counted.
    """
    shape = np.shape(summary.outcome_code)
    # Means over impacts and times have a history without times.
    times = () if history is None else np.shape(history.time)
    setting = f"accuracy {accuracy}"
    setting += f", history of {times[-1]} times" if times else ""
    if shape:
        return _many(summary, scene, shape, setting)
    head = f"ImpactResult: {Outcome(int(summary.outcome_code))}, {setting}"
    rows: list[Row] = [
        (name, _text(getattr(summary, column.field)), column.unit, column.meaning)
        for name, column in RESULT_COLUMNS.items()
    ]
    return [head], rows


def _many(
    summary: ImpactSummary, scene: Scene, shape: tuple[int, ...], setting: str
) -> tuple[list[str], list[Row]]:
    counts = count_outcomes(summary)
    outcomes = [f"{count} {outcome}" for outcome, count in counts.items()]
    heads = [
        f"ImpactResult: shape {shape}, {setting}",
        f"  outcomes: {', '.join(outcomes) or 'none'}",
        f"  varying: {', '.join(_varying(scene, shape)) or 'nothing'}",
    ]
    counted = ~np.isin(np.asarray(summary.outcome_code), WITHOUT_NUMBERS)
    if not counted.any():
        return heads, []
    without = [str(outcome) for outcome in WITHOUT_NUMBERS if str(outcome) in counts]
    if without:
        left_out = ", ".join(f"{counts[name]} {name}" for name in without)
        heads.append(f"  left out of the statistics: {left_out}")
    rows: list[Row] = [("", "unit", "impacts", "least", "median", "largest")]
    for name in SHOWN_OF_MANY:
        column = RESULT_COLUMNS[name]
        values = np.asarray(getattr(summary, column.field))[counted]
        values = values[~np.isnan(values)]  # e_t, where it has no meaning
        statistics = ("", "", "")
        if values.size:
            statistics = map(_text, (values.min(), np.median(values), values.max()))
        rows.append((name, column.unit, str(values.size), *statistics))
    return heads, rows


def _varying(scene: Scene, shape: tuple[int, ...]) -> list[str]:
    # xarray takes half a second to load, and most results are never shown.
    from .datasets import inputs_of, kind_of_each, varying_axes

    names = [
        name for name, quantity in inputs_of(scene, shape).items() if quantity.axes
    ]
    kinds = kind_of_each(scene, shape)
    return names if kinds is None or not varying_axes(kinds) else [SHAPE, *names]


def _text(value) -> str:
    return f"{float(value):.6g}"


Rows = list[Row]


class ShownAsTable:
    """Base of classes that show themselves as a heading and a table of values."""

    def display_rows(self) -> tuple[str, list[Row]]:
        """Give the heading, and rows of name, value and unit."""
        raise NotImplementedError

    def __repr__(self) -> str:
        head, rows = self.display_rows()
        return f"{head}\n{align(rows)}"

    def _repr_html_(self) -> str:
        head, rows = self.display_rows()
        return html_table([head], rows)


def range_of(values: ArrayLike, write: Callable[[float], str] = "{:.4g}".format) -> str:
    """Tell the least and largest of finite values, or the one that all are."""
    finite = np.asarray(values, float)
    finite = finite[np.isfinite(finite)]
    if not finite.size:
        return "-"
    low, high = np.min(finite), np.max(finite)
    return write(low) if low == high else f"{write(low)} to {write(high)}"

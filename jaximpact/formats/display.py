"""Results as they show themselves in Python and in notebooks."""

import html
from typing import TYPE_CHECKING

import numpy as np

from ..mechanics.outcomes import Outcome
from .align import align
from .columns import RESULT_COLUMNS
from .inputs import inputs_of, kind_of_each, varying_axes
from .results import count_outcomes
from .scenes import SHAPE

if TYPE_CHECKING:
    from ..result import ImpactResult

OF_MANY = ("e_n", "e_t", "e_bar", "max_penetration_m", "max_normal_force_N")
"""Results of which many impacts show statistics."""
NO_NUMBERS = (Outcome.separating, Outcome.failed)
"""Outcomes without an impact, or without its numbers."""
LEFT_OUT = [str(outcome) for outcome in NO_NUMBERS]
"""What statistics do not count, in words."""

Rows = list[tuple[str, ...]]


def as_text(result: "ImpactResult") -> str:
    """A result as text: one impact its results, many their outcomes and statistics."""
    heads, rows = _heads_and_rows(result)
    return "\n".join([*heads, *([align(rows)] if rows else [])])


def as_html(result: "ImpactResult") -> str:
    """The same as HTML."""
    heads, rows = _heads_and_rows(result)
    lines = [f"<div>{html.escape(head.strip())}</div>" for head in heads]
    table = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    return "".join([*lines, f"<table>{table}</table>" if rows else ""])


def _heads_and_rows(result: "ImpactResult") -> tuple[list[str], Rows]:
    return _of_one(result) if result.shape == () else _of_many(result)


def _of_one(result: "ImpactResult") -> tuple[list[str], Rows]:
    head = f"ImpactResult: {result.outcome}, accuracy {result.accuracy.name}"
    if result.history is not None:
        head += f", history of {len(result.history.time)} times"
    rows = [
        (name, _text(getattr(result, column.field)), column.unit, column.meaning)
        for name, column in RESULT_COLUMNS.items()
    ]
    return [head], rows


def _of_many(result: "ImpactResult") -> tuple[list[str], Rows]:
    counts = count_outcomes(result)
    outcomes = [f"{count} {outcome}" for outcome, count in counts.items()]
    heads = [
        f"ImpactResult: shape {result.shape}, accuracy {result.accuracy.name}",
        f"  outcomes: {', '.join(outcomes) or 'none'}",
        f"  varying: {', '.join(_varying(result)) or 'nothing'}",
    ]
    counted = ~np.isin(np.asarray(result.outcome_code), NO_NUMBERS)
    if not counted.any():
        return heads, []
    left_out = [f"{n} {name}" for name, n in counts.items() if name in LEFT_OUT]
    if left_out:
        heads.append(f"  left out of the statistics: {', '.join(left_out)}")
    rows = [("", "unit", "impacts", "least", "median", "largest")]
    for name in OF_MANY:
        column = RESULT_COLUMNS[name]
        values = np.asarray(getattr(result, column.field))[counted]
        values = values[~np.isnan(values)]  # e_t, where it has no meaning
        rows.append((name, column.unit, str(values.size), *_ends_and_median(values)))
    return heads, rows


def _ends_and_median(values: np.ndarray) -> tuple[str, ...]:
    if not values.size:
        return ("", "", "")
    return _text(values.min()), _text(np.median(values)), _text(values.max())


def _varying(result: "ImpactResult") -> list[str]:
    """Names of the quantities in which the scenes differ."""
    inputs = inputs_of(result.scene, result.shape)
    names = [name for name, quantity in inputs.items() if quantity.axes]
    kinds = kind_of_each(result.scene, result.shape)
    return names if kinds is None or not varying_axes(kinds) else [SHAPE, *names]


def _text(value) -> str:
    return f"{float(value):.6g}"

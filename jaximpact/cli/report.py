"""One impact as text and as JSON."""

import math

from ..formats.align import align
from ..formats.columns import (
    ENERGY_COLUMNS,
    FURTHER_COLUMNS,
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    RESULT_COLUMNS,
)
from ..simulation import ImpactResult


def as_text(result: ImpactResult) -> str:
    """Every result and the energy ledger, as a table with units and meanings."""
    columns = (*RESULT_COLUMNS.values(), *FURTHER_COLUMNS.values())
    rows = [(OUTCOME_COLUMN, str(result.outcome), "", OUTCOME_MEANING)]
    rows += [
        (c.name, f"{_number(result, c.field):.6g}", c.unit, c.meaning) for c in columns
    ]
    rows += [
        (
            f"energy {c.field}",
            f"{_number(result.energy, c.field):.6g}",
            c.unit,
            c.meaning,
        )
        for c in ENERGY_COLUMNS.values()
    ]
    return align(rows)


def as_json(result: ImpactResult) -> dict:
    """The same as a tree of plain values, None for NaN, with the manifest."""
    columns = (*RESULT_COLUMNS.values(), *FURTHER_COLUMNS.values())
    results = {c.name: _number_or_none(result, c.field) for c in columns}
    energy = {
        c.field: _number_or_none(result.energy, c.field)
        for c in ENERGY_COLUMNS.values()
    }
    return {
        OUTCOME_COLUMN: str(result.outcome),
        **results,
        "energy_J": energy,
        "manifest": result.manifest(),
    }


def _number(owner, field: str) -> float:
    return float(getattr(owner, field))


def _number_or_none(owner, field: str) -> float | None:
    value = _number(owner, field)
    return value if math.isfinite(value) else None

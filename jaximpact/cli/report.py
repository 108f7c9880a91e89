"""One impact as text and as JSON."""

import math

from ..formats.align import align
from ..formats.columns import (
    FURTHER_COLUMNS,
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    RESULT_COLUMNS,
)
from ..simulation import ImpactResult

ENERGY_ITEMS = {
    "kinetic_in": "kinetic energy at impact",
    "gravity": "work of gravity",
    "arm": "work of the arm between centre and deepest point",
    "stiffness": "work of the change of stiffness",
    "kinetic_out": "kinetic energy at the end",
    "elastic": "elastic energy left",
    "viscoplastic": "dissipated by yielding",
    "slider": "dissipated by sliding",
    "dashpot": "dissipated by damping",
    "residual": "first four less the next five: error of the integration",
}


def as_text(result: ImpactResult) -> str:
    """Every result and the energy ledger, as a table with units and meanings."""
    columns = (*RESULT_COLUMNS.values(), *FURTHER_COLUMNS.values())
    rows = [(OUTCOME_COLUMN, str(result.outcome), "", OUTCOME_MEANING)]
    rows += [
        (c.name, f"{_number(result, c.field):.6g}", c.unit, c.meaning) for c in columns
    ]
    rows += [
        (f"energy {name}", f"{_number(result.energy, name):.6g}", "J", meaning)
        for name, meaning in ENERGY_ITEMS.items()
    ]
    return align(rows)


def as_json(result: ImpactResult) -> dict:
    """The same as a tree of plain values, None for NaN, with the manifest."""
    columns = (*RESULT_COLUMNS.values(), *FURTHER_COLUMNS.values())
    results = {c.name: _number_or_none(result, c.field) for c in columns}
    energy = {name: _number_or_none(result.energy, name) for name in ENERGY_ITEMS}
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

"""One impact as text and as JSON."""

import math

from ..align import align
from ..columns import OUTCOME_COLUMN, OUTCOME_MEANING, RESULT_COLUMNS, ResultColumn
from ..simulation import ImpactResult

FURTHER_RESULTS = (
    ResultColumn("e_n_vijayakumar", "e_n_vijayakumar", "-", "e_n of a rigid body"),
    ResultColumn("max_tangential_force_N", "max_tangential_force", "N", "largest |T|"),
    ResultColumn(
        "time_of_max_penetration_s",
        "time_of_max_penetration",
        "s",
        "when u_n is largest",
    ),
    ResultColumn("time_of_max_sinking_s", "time_of_max_sinking", "s", "when u_D is"),
    ResultColumn(
        "time_of_max_normal_force_s", "time_of_max_normal_force", "s", "when N is"
    ),
    ResultColumn(
        "time_of_max_tangential_force_s",
        "time_of_max_tangential_force",
        "s",
        "when |T| is",
    ),
    ResultColumn("time_of_max_moment_s", "time_of_max_moment", "s", "when |M| is"),
    ResultColumn("steps", "steps", "-", "steps of the integration"),
)
"""Results that a table of results does not hold."""
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
    columns = (*RESULT_COLUMNS.values(), *FURTHER_RESULTS)
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
    columns = (*RESULT_COLUMNS.values(), *FURTHER_RESULTS)
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

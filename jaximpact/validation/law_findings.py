"""Comparisons with laws as findings, to stand beside the claims."""

from .comparison import HOLDS_WITHIN, PARTLY_WITHIN, Change, Comparison
from .verdict import Finding, Judgement

CRITERION = (
    f"the model is within {100 * HOLDS_WITHIN:g} % of the law (root mean square over "
    f"the places); partly within {100 * PARTLY_WITHIN:g} %"
)


def as_findings(comparisons: list[Comparison]) -> list[Finding]:
    """The comparisons in their order, L01 and so on."""
    return [
        Finding(
            f"L{number:02d}",
            row.source,
            f"{row.name}: {row.quantity}, {row.over}",
            CRITERION,
            _judgement(row),
        )
        for number, row in enumerate(comparisons, start=1)
    ]


def _judgement(row: Comparison) -> Judgement:
    places = zip(row.places, row.law, row.model, strict=True)
    numbers = {}
    for place, law, model in places:
        at = f"_at_{place.replace(' ', '_')}" if place else ""
        numbers |= {f"law{at}": law, f"model{at}": model}
    where = f" at {', '.join(row.places)}" if any(row.places) else ""
    evidence = (
        f"model {_listed(row.model)} against {_listed(row.law)}{where}, "
        f"{100 * row.deviation:.0f} % off"
    )
    if row.changes:
        evidence += f"; {_in_words(row.changes[0])}"
    return Judgement(row.verdict, evidence, numbers)


def _listed(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.2f}" for value in values)


def _in_words(change: Change) -> str:
    return (
        f"{100 * change.deviation:.0f} % off with {change.parameter} "
        f"{change.nearest:.3g} for {change.present:.3g}"
    )

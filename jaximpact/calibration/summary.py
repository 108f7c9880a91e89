"""A calibration at a glance, to be printed."""

import itertools

import numpy as np

from ..formats.align import align
from ..formats.columns import INPUT_COLUMNS
from .examination import Examination
from .laws import in_words, unusual
from .report import (
    about_cells,
    about_sigma,
    nuisance_rows,
    parameter_rows,
    starts_in_words,
    target_rows,
)
from .reservations import reservations
from .study import StudyResult, VariantResult
from .study_file import Study
from .wrapping import listed, wrapped

LEAST_CORRELATION = 0.1
"""Smaller ones are left out."""


def in_brief(result: StudyResult, examined: list[Examination]) -> str:
    """Values, errors or why there are none, correlations, misfit, reservations."""
    study = result.study
    files = ", ".join(table.path.name for table in study.tests.files)
    lines = [
        *wrapped(
            f"{len(study.tests)} tests of {files}, fitted to "
            f"{', '.join(study.targets)}. {' '.join(about_cells(study))}"
        ),
        *wrapped(about_sigma(study)),
        *wrapped(_held(study)),
    ]
    for variant, looked in zip(result.variants, examined, strict=True):
        if len(result.variants) > 1:
            lines += ["", variant.variant.name, "-" * len(variant.variant.name)]
        lines += ["", *_of_variant(result, variant, looked)]
    return "\n".join(lines) + "\n"


def _of_variant(
    result: StudyResult, variant: VariantResult, looked: Examination
) -> list[str]:
    # It draws, and Matplotlib takes half a second to import.
    from .page import verdict

    lines = ["Parameters", align(_parameters(variant))]
    if len(variant.names) > len(variant.verdicts):
        lines += [
            "Nuisances, under their priors",
            align(nuisance_rows(result, variant)),
        ]
    pairs = _correlations(variant)
    if pairs:
        lines += [f"Correlations (above {LEAST_CORRELATION:g})", align(pairs)]
    lines += ["Fit (predicted less measured)", align(target_rows(result, variant))]
    lines += ["Verdict", *listed(verdict(variant)), *listed([_starts(variant)])]
    doubts = reservations(result, variant, looked)
    if doubts:
        lines += ["Against trusting it", *listed(doubts)]
    return lines


def _parameters(variant: VariantResult) -> list[tuple[str, ...]]:
    """The parameters, with the bounds as one column, that is reached marked."""
    x = variant.bounds.coordinate(variant.parameters)
    reached = variant.bounds.bound_reached(x)
    rows = []
    for number, (*row, lower, upper) in enumerate(parameter_rows(variant)):
        if not number:
            rows.append((*row, "bounds"))
            continue
        at = reached[number - 1]
        hit = f" (at the {at})" if at else ""
        rows.append((*row, f"{lower} to {upper}{hit}"))
    return rows


def _correlations(variant: VariantResult) -> list[tuple[str, ...]]:
    """Pairs of parameters, the most correlated first."""
    names = [of_one.name for of_one in variant.verdicts]
    found = [
        (float(variant.uncertainty.correlation[a, b]), names[a], names[b])
        for a, b in itertools.combinations(range(len(names)), 2)
    ]
    found.sort(key=lambda pair: -abs(pair[0]))
    return [
        (f"{a}, {b}", f"{value:+.3f}")
        for value, a, b in found
        if abs(value) >= LEAST_CORRELATION
    ]


def _starts(variant: VariantResult) -> str:
    return f"{starts_in_words(variant)}; {variant.reason.words}."


def _held(study: Study) -> str:
    """What no table says, and what it was taken for."""
    columns = study.tests.known_columns
    fitted = {parameter.name for parameter in study.parameters}
    fitted |= {nuisance.name for nuisance in study.nuisances}
    missing = {
        name: column.default
        for name, column in columns.items()
        if column.part != "soil"
        and name not in study.tests.inputs
        and name not in fitted
    }
    of_laws = {
        name: column.default
        for name, column in columns.items()
        if column.part == "soil"
        and name not in study.tests.inputs
        and name not in fitted
    }
    values = study.soil | {n: v for n, v in of_laws.items() if n not in study.soil}
    laws = unusual(study.parts)
    shape = laws.pop("shape", None)
    other = [in_words(laws)] if laws else []
    other += [
        f"{name} {value:g}"
        for name, value in values.items()
        if name not in INPUT_COLUMNS
        or not np.isclose(value, INPUT_COLUMNS[name].default, rtol=1e-12)
    ]
    words = "Ground: Table 1."
    if other:
        words = f"Ground: Table 1 but for {', '.join(other)}."
    if shape is not None:
        words = f"Shape: {type(shape).__name__}. {words}"
    if missing:
        taken = ", ".join(f"{name} {value:g}" for name, value in missing.items())
        words = f"Not in the table, and taken as: {taken}. {words}"
    return words

"""The comparison of laws in words, as tables and as numbers."""

import csv
import io
import itertools
from typing import Any

import numpy as np

from ...io.display import Rows
from ..comparison.comparison import Compared, GroupScores
from ..comparison.ranking import (
    ERRORS,
    FEWEST_UNITS,
    SMALL_DIFFERENCE,
    Ranking,
)
from ..problem.config import Variant

CSV_COLUMNS = (
    *("law", "row", "test", "log_density", "target", "measured", "left_out"),
    "left_out_deviation",
)
RULE = (
    f"Two laws tie where their scores differ by less than {ERRORS:g} standard errors, "
    f"or by less than {SMALL_DIFFERENCE:g}."
)


def verdict(compared: Compared) -> list[str]:
    """Say which law to use, first by single tests, then by groups."""
    found = compared.ranking()
    worse = (worse_than_others(compared, one) for one in compared.study.variants)
    lines = [" ".join([_in_words(compared, found), *itertools.chain(*worse)])]
    lines += [_by_group(compared, scores, found) for scores in compared.by_group]
    weights = [
        f"{law.name} {weight:.2f}"
        for law, weight in zip(compared.laws, compared.weights, strict=True)
        if weight >= 0.05
    ]
    lines.append(f"Stacking weights: {', '.join(weights)}.")
    return lines


def _in_words(compared: Compared, found: Ranking) -> str:
    names = [law.name for law in compared.laws]
    counts = [law.count for law in compared.laws]
    best, preferred = names[found.best], found.preferred
    if len(names) == 1:
        return f"{best} was compared with no other law."
    units = len(compared.by_test.groups)
    if units < FEWEST_UNITS:
        return (
            f"{units} of the {FEWEST_UNITS} tests that are needed to tell which law "
            "predicts best: none is preferred."
        )
    others = [names[i] for i in found.ties if i != found.best]
    if not others:
        return f"{best} predicts a test that it has not seen better than all others."
    text = f"A tie: {_listed([best, *others])} predict equally well."
    if preferred == found.best:
        return (
            f"{text} Prefer {best}: no law of the tie has fewer fitted parameters "
            f"({counts[preferred]})."
        )
    return (
        f"{text} Prefer {names[preferred]}, the simplest of them: "
        f"{counts[preferred]} fitted parameter{'s' * (counts[preferred] > 1)} against "
        f"{counts[found.best]} of {best}."
    )


def worse_than_others(compared: Compared, variant: Variant) -> list[str]:
    """Warn that another law predicts better than a variant of the study."""
    found, names = compared.ranking(), [law.name for law in compared.laws]
    return [
        f"The {law.name} predicts worse: its score is {_difference(found, place)} less "
        f"than that of {names[found.best]}. Predict with {names[found.preferred]}."
        for place, law in enumerate(compared.laws)
        if law.contender.law is variant and place not in found.ties
    ]


def _by_group(compared: Compared, scores: GroupScores, whole: Ranking) -> str:
    found = compared.ranking(scores)
    names = [law.name for law in compared.laws]
    text = f"By {scores.by} ({len(scores.groups)} groups left out one by one): "
    text += f"{names[found.best]} predicts best"
    if len(scores.groups) < FEWEST_UNITS:
        text += (
            f"; with fewer than {FEWEST_UNITS} groups the differences have no standard "
            "error"
        )
    elif len(found.ties) > 1:
        others = [names[i] for i in found.ties if i != found.best]
        text += f", in a tie with {_listed(others)}"
    else:
        text += ", better than all others"
    if whole.preferred not in found.ties:
        text += (
            f". {names[whole.preferred]}, preferred by single tests, predicts a new "
            f"{scores.by} worse"
        )
    return text + "."


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def comparison_contents(compared: Compared) -> dict[str, Any]:
    """Collect the sentences and tables of a comparison."""
    study = compared.study
    about = (
        f"{len(compared.laws)} laws fitted to {', '.join(study.targets)} of "
        f"{len(compared.by_test.groups)} tests, with the same errors of measurement."
    )
    notes = [about]
    if compared.targets_left_out:
        notes.append(
            f"Left out: {', '.join(compared.targets_left_out)}, which laws of rebound "
            "do not predict."
        )
    notes += [f"Not compared: {n}: {why}." for n, why in compared.refused.items()]
    notes.append(
        "Score: the log predictive density of each test by the fit to the others, "
        f"summed; larger is better. {RULE}"
    )
    return {
        "notes": notes,
        "verdict": verdict(compared),
        "rows": score_rows(compared),
        "group_tables": [
            (f"Scores by {scores.by}", group_rows(compared, scores))
            for scores in compared.by_group
        ],
        "parameters": parameter_rows(compared),
    }


def score_rows(compared: Compared) -> Rows:
    """Write the laws with their scores, the best first."""
    found, targets = compared.ranking(), compared.study.targets
    head = ("law", "parameters", "score", "less than the best", "weight")
    return [(*head, *(f"rms left out {name}" for name in targets))] + [
        (
            _marked(law.name, found, place),
            str(law.count),
            f"{compared.by_test.totals[place]:.1f}",
            _difference(found, place),
            f"{compared.weights[place]:.2f}",
            *(f"{value:.3g}" for value in law.rms_left_out),
        )
        for place, law in enumerate(compared.laws)
    ]


def group_rows(compared: Compared, scores: GroupScores) -> Rows:
    """Write the scores of one way of leaving groups out."""
    found = compared.ranking(scores)
    return [("law", "score", "less than the best", "worst predicted")] + [
        (
            _marked(compared.laws[place].name, found, place),
            f"{scores.totals[place]:.1f}",
            _difference(found, place),
            scores.groups[int(np.argmin(scores.scores[:, place]))],
        )
        for place in np.argsort(-scores.totals, kind="stable")
    ]


def _marked(name: str, found: Ranking, place) -> str:
    return f"{name} (tie)" if len(found.ties) > 1 and place in found.ties else name


def _difference(found: Ranking, place) -> str:
    if place == found.best:
        return "0"
    error = found.error[place]
    more = f" ± {error:.1f}" if np.isfinite(error) else ""
    return f"{-found.apart[place]:.1f}{more}"


def parameter_rows(compared: Compared) -> Rows:
    """Write the fitted parameters of every law."""
    rows: Rows = [("law", "fitted")]
    for law in compared.laws:
        cells = [
            f"{name} = {value:.4g}" + (f" (at its {bound} bound)" if bound else "")
            for (name, value), bound in zip(
                law.parameters.items(), law.bounds_reached, strict=True
            )
        ]
        acting = [cell for cell, acts in zip(cells, law.acts, strict=True) if acts]
        idle = [n for n, acts in zip(law.parameters, law.acts, strict=True) if not acts]
        acting += [f"{', '.join(idle)} without influence"] if idle else []
        rows.append((law.name, ", ".join(acting)))
    return rows


def comparison_json(compared: Compared) -> dict:
    """Collect the numbers of a comparison."""
    found = compared.ranking()
    return {
        "targets": compared.study.targets,
        "targets_left_out": compared.targets_left_out,
        "verdict": verdict(compared),
        "preferred": compared.laws[found.preferred].name,
        "ties": [compared.laws[place].name for place in found.ties],
        "laws": [
            law.fitted.as_json()
            | {
                "score": compared.by_test.totals[place],
                "difference": found.apart[place],
                "standard_error": found.error[place],
                "weight": compared.weights[place],
                "rms": law.rms,
                "rms_left_out": law.rms_left_out,
            }
            for place, law in enumerate(compared.laws)
        ],
        "groups": {
            scores.by: {"names": scores.groups, "scores": scores.scores.T}
            for scores in compared.by_group
        },
        "refused": compared.refused,
    }


def comparison_csv(compared: Compared) -> str:
    """Write a line for each law and each measurement.

    `log_density` is that of the whole test, and stands in every line of it.
    """
    study, text = compared.study, io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for law in compared.laws:
        left = law.left_out
        for test, target in zip(*np.nonzero(study.known), strict=True):
            numbers = study.measured, left.predicted, left.deviation
            writer.writerow(
                (
                    law.name,
                    test + 1,
                    study.tests.name(int(test)),
                    f"{left.density[test]:.9g}",
                    study.targets[target],
                    *(f"{column[test, target]:.9g}" for column in numbers),
                )
            )
    return text.getvalue()

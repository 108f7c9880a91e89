"""The comparison of laws in words, as tables and as numbers."""

import itertools
from functools import partial

import numpy as np

from ...reports.document import Box, Part, Picture, ReportSection
from ...reports.tables import Table, listed
from ..comparison.comparison import Compared, GroupScores
from ..comparison.ranking import ERRORS, FEWEST_UNITS, SMALL_DIFFERENCE, Ranking
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
    ranking = compared.ranking()
    worse = (worse_than_others(compared, one) for one in compared.study.variants)
    lines = [" ".join([_in_words(compared, ranking), *itertools.chain(*worse)])]
    lines += [_by_group(compared, scores, ranking) for scores in compared.by_group]
    weights = [
        f"{law.name} {weight:.2f}"
        for law, weight in zip(compared.laws, compared.weights, strict=True)
        if weight >= 0.05
    ]
    lines.append(f"Stacking weights: {', '.join(weights)}.")
    return lines


def _in_words(compared: Compared, ranking: Ranking) -> str:
    names = [law.name for law in compared.laws]
    counts = [law.count for law in compared.laws]
    best, preferred = names[ranking.best], ranking.preferred
    if len(names) == 1:
        return f"{best} was compared with no other law."
    units = len(compared.by_test.groups)
    if units < FEWEST_UNITS:
        return (
            f"{units} of the {FEWEST_UNITS} tests that are needed to tell which law "
            "predicts best: none is preferred."
        )
    others = [names[i] for i in ranking.ties if i != ranking.best]
    if not others:
        return f"{best} predicts a test that it has not seen better than all others."
    text = f"A tie: {listed([best, *others])} predict equally well."
    if preferred == ranking.best:
        return (
            f"{text} Prefer {best}: no law of the tie has fewer fitted parameters "
            f"({counts[preferred]})."
        )
    return (
        f"{text} Prefer {names[preferred]}, the simplest of them: "
        f"{counts[preferred]} fitted parameter{'s' * (counts[preferred] > 1)} against "
        f"{counts[ranking.best]} of {best}."
    )


def worse_than_others(compared: Compared, variant: Variant) -> list[str]:
    """Warn that another law predicts better than a variant of the study."""
    ranking, names = compared.ranking(), [law.name for law in compared.laws]
    return [
        f"The {law.name} predicts worse: its score is {_difference(ranking, place)} "
        f"less than that of {names[ranking.best]}. Predict with "
        f"{names[ranking.preferred]}."
        for place, law in enumerate(compared.laws)
        if law.contender.law is variant
        and not law.contender.more
        and place not in ranking.ties
    ]


def _by_group(compared: Compared, scores: GroupScores, whole: Ranking) -> str:
    ranking = compared.ranking(scores)
    names = [law.name for law in compared.laws]
    text = f"By {scores.by} ({len(scores.groups)} groups left out one by one): "
    text += f"{names[ranking.best]} predicts best"
    if len(scores.groups) < FEWEST_UNITS:
        text += (
            f"; with fewer than {FEWEST_UNITS} groups the differences have no standard "
            "error"
        )
    elif len(ranking.ties) > 1:
        others = [names[i] for i in ranking.ties if i != ranking.best]
        text += f", in a tie with {listed(others)}"
    else:
        text += ", better than all others"
    if whole.preferred not in ranking.ties:
        text += (
            f". {names[whole.preferred]}, preferred by single tests, predicts a new "
            f"{scores.by} worse"
        )
    return text + "."


def comparison_parts(compared: Compared) -> list[Part]:
    """Write the sentences and tables of a comparison."""
    study = compared.study
    notes = [
        f"{len(compared.laws)} laws fitted to {', '.join(study.targets)} of "
        f"{len(compared.by_test.groups)} tests, with the same errors of measurement."
    ]
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
    groups = [
        ReportSection(f"Scores by {scores.by}", [_group_table(compared, scores)])
        for scores in compared.by_group
    ]
    box = Box("verdict", ["Which law the tests prefer", *verdict(compared)])
    fitted = ReportSection("Fitted parameters", [_fitted_table(compared)])
    return [box, *notes, _score_table(compared), *groups, fitted]


def comparison_picture(compared: Compared) -> Picture:
    """Show the scores of the laws."""
    # Matplotlib takes half a second to import, which text does not need.
    from .drawings import draw_comparison

    return Picture(
        partial(draw_comparison, compared),
        "Scores of the laws, less that of the best",
        "Score of each law less that of the best, with two standard errors; red: "
        "preferred, blue: ties, grey: worse.",
    )


def _score_table(compared: Compared) -> Table:
    """Write the laws with their scores, the best first."""
    ranking, targets = compared.ranking(), compared.study.targets
    head = ("law", "parameters", "score", "less than the best", "weight")
    rows = [
        (
            _marked(law.name, ranking, place),
            law.count,
            f"{compared.by_test.totals[place]:.1f}",
            _difference(ranking, place),
            f"{compared.weights[place]:.2f}",
            *law.rms_left_out,
        )
        for place, law in enumerate(compared.laws)
    ]
    return Table((*head, *(f"rms left out {name}" for name in targets)), rows)


def _group_table(compared: Compared, scores: GroupScores) -> Table:
    ranking = compared.ranking(scores)
    rows = [
        (
            _marked(compared.laws[place].name, ranking, place),
            f"{scores.totals[place]:.1f}",
            _difference(ranking, place),
            scores.groups[int(np.argmin(scores.scores[:, place]))],
        )
        for place in np.argsort(-scores.totals, kind="stable")
    ]
    return Table(("law", "score", "less than the best", "worst predicted"), rows)


def _marked(name: str, ranking: Ranking, place) -> str:
    return f"{name} (tie)" if len(ranking.ties) > 1 and place in ranking.ties else name


def _difference(ranking: Ranking, place) -> str:
    if place == ranking.best:
        return "0"
    error = ranking.error[place]
    more = f" ± {error:.1f}" if np.isfinite(error) else ""
    return f"{-ranking.apart[place]:.1f}{more}"


def _fitted_table(compared: Compared) -> Table:
    rows = []
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
    return Table(("law", "fitted"), rows)


def comparison_json(compared: Compared) -> dict:
    """Collect the numbers of a comparison."""
    ranking = compared.ranking()
    return {
        "targets": compared.study.targets,
        "targets_left_out": compared.targets_left_out,
        "verdict": verdict(compared),
        "preferred": compared.laws[ranking.preferred].name,
        "ties": [compared.laws[place].name for place in ranking.ties],
        "laws": [
            law.fitted.as_json()
            | {
                "score": compared.by_test.totals[place],
                "difference": ranking.apart[place],
                "standard_error": ranking.error[place],
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
    study = compared.study
    rows = [
        (
            *(law.name, test + 1, study.tests.name(int(test))),
            *(law.left_out.density[test], study.targets[target]),
            study.measured[test, target],
            law.left_out.predicted[test, target],
            law.left_out.deviation[test, target],
        )
        for law in compared.laws
        for test, target in zip(*np.nonzero(study.known), strict=True)
    ]
    return Table(CSV_COLUMNS, rows).csv()

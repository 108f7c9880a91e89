"""The comparison of laws in words, as tables and as numbers."""

from functools import partial

import numpy as np

from ...reports.document import Box, Part, Picture, ReportSection
from ...reports.tables import Table, listed
from ..comparison.comparison import Compared, GroupScores
from ..comparison.ranking import ERRORS, FEWEST_UNITS, SMALL_DIFFERENCE, Ranking
from ..problem.config import Variant
from ..problem.dataset import LIMITS

CSV_COLUMNS = (
    *("compared_on", "law", "row", "file", "test", "log_density", "target", "limit"),
    *("measured", "left_out", "left_out_deviation"),
)
RULE = (
    f"Two laws tie where their scores differ by less than {ERRORS:g} standard errors, "
    f"or by less than {SMALL_DIFFERENCE:g}, or where units are too few to tell."
)


def verdict(compared: Compared) -> list[str]:
    """Say in one sentence which law to use for which targets; then what groups left out
    say, and the stacking weights."""
    sentences = [_in_words(one) for one in compared.parts]
    lines = ["; ".join(sentences).replace("; For", "; for") + "."]
    for one in compared.parts:
        ranking = one.ranking()
        lines += [_by_group(one, scores, ranking) for scores in one.by_group]
        weights = [
            f"{law.name} {weight:.2f}"
            for law, weight in zip(one.laws, one.weights, strict=True)
            if weight >= 0.05
        ]
        lines.append(f"Stacking weights{_targets(one)}: {', '.join(weights)}.")
    return lines


def _targets(compared: Compared) -> str:
    alone = f" of {listed(compared.study.targets)} alone"
    return alone if compared.targets_left_out else ""


def _in_words(compared: Compared) -> str:
    ranking, names = compared.ranking(), [law.name for law in compared.laws]
    text = f"For {listed(compared.study.targets)}"
    text += " alone, laws of rebound included" if compared.targets_left_out else ""
    if len(names) == 1:
        return f"{text}, {names[0]} was compared with no other law"
    units = len(compared.by_test.groups)
    if units < FEWEST_UNITS:
        return (
            f"{text}, no law is preferred, since {units} of the {FEWEST_UNITS} tests "
            "that are needed to tell which law predicts best were measured"
        )
    text += f", use {names[ranking.preferred]}"
    if len(ranking.ties) == 1:
        return f"{text}: it predicts tests left out better than all other laws"
    count = compared.laws[ranking.preferred].count
    return (
        f"{text}: {len(ranking.ties)} of {len(names)} laws predict tests left out "
        f"equally well, and none of these has fewer fitted parameters ({count})"
    )


def worse_than_others(compared: Compared, variant: Variant) -> list[str]:
    """Warn that another law predicts better than a variant of the study."""
    lines = []
    for one in compared.parts:
        ranking, names = one.ranking(), [law.name for law in one.laws]
        lines += [
            f"The {law.name} predicts {listed(one.study.targets)} worse: its score is "
            f"{_difference(ranking, place)} less than that of {names[ranking.best]}. "
            f"Predict with {names[ranking.preferred]}."
            for place, law in enumerate(one.laws)
            if law.contender.law is variant
            and not law.contender.more
            and place not in ranking.ties
        ]
    return lines


def _by_group(compared: Compared, scores: GroupScores, whole: Ranking) -> str:
    ranking = compared.ranking(scores)
    names = [law.name for law in compared.laws]
    text = f"By {scores.by}{_targets(compared)} ({len(scores.groups)} groups left out "
    text += f"one by one): {names[ranking.best]} predicts best"
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
    box = Box("verdict", ["Which law the tests prefer", *verdict(compared)])
    score = (
        "Score: the log predictive density of each test by the fit to the others, "
        f"summed; larger is better. {RULE}"
    )
    parts = [box, score, *_tables(compared)]
    if compared.with_rebound is not None:
        title = f"Laws of rebound included:{_targets(compared.with_rebound)[3:]}"
        parts.append(ReportSection(title, _tables(compared.with_rebound)))
    return parts


def _tables(compared: Compared) -> list[Part]:
    """Write the tables of laws compared on the same targets."""
    notes = [
        f"Laws compared on {listed(compared.study.targets)} of "
        f"{len(compared.by_test.groups)} tests, with the same errors of measurement."
    ]
    if compared.targets_left_out:
        notes.append(
            f"Left out: {', '.join(compared.targets_left_out)}, which laws of rebound "
            "do not predict; laws of the ground are fitted to them too."
        )
    notes += [f"Not compared: {n}: {why}." for n, why in compared.refused.items()]
    groups = [
        ReportSection(f"Scores by {scores.by}", [_group_table(compared, scores)])
        for scores in compared.by_group
    ]
    fitted = ReportSection("Fitted parameters", [_fitted_table(compared)])
    return [*notes, _score_table(compared), *groups, fitted]


def comparison_pictures(compared: Compared) -> list[Picture]:
    """Show the scores of the laws."""
    # Matplotlib takes half a second to import, which text does not need.
    from .drawings import draw_comparison

    return [
        Picture(
            partial(draw_comparison, one),
            f"Scores of the laws{_targets(one)}, less that of the best",
            f"Score of each law for {listed(one.study.targets)} less that of the best, "
            "with two standard errors; red: preferred, blue: ties, grey: worse.",
        )
        for one in compared.parts
    ]


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
            *(None if np.isnan(rms) else rms for rms in law.rms_left_out),
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
    ranking, beside = compared.ranking(), compared.with_rebound
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
        "with_rebound": beside and comparison_json(beside),
    }


def comparison_csv(compared: Compared) -> str:
    """Write a line for each law and each measurement.

    `log_density` is that of all targets of a test that are compared, and stands in
    every line of it; `compared_on` names them. `row`, `file`, `test` and `limit` are
    those of fitted.csv.
    """
    rows = []
    for one in compared.parts:
        study, files = one.study, one.study.tests.file_names
        rows += [
            (
                *(" ".join(study.targets), law.name, line, files[path]),
                *(study.tests.name(test), law.left_out.density[test]),
                *(study.targets[target], LIMITS[int(study.censored[test, target])]),
                study.measured[test, target],
                law.left_out.predicted[test, target],
                law.left_out.deviation[test, target],
            )
            for law in one.laws
            for test, target in zip(*np.nonzero(study.known), strict=True)
            for path, line in [study.tests.place(test)]
        ]
    return Table(CSV_COLUMNS, rows).csv()

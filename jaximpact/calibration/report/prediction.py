"""Predictions of the model and of simple laws, in words, tables and numbers."""

from pathlib import Path

import numpy as np

from ..._packages import versions
from ...identity import part_names
from ...io.files import put_text, refuse_inputs, replacing
from ...io.output_files import manifest_path
from ...reports.document import Document, Part, ReportSection
from ...reports.json_tree import json_text, plain
from ...reports.tables import Table, listed
from ..comparison.fitted_law import LawPrediction
from ..diagnostics.cross_validation import too_few
from ..diagnostics.discrepancy import in_words
from ..diagnostics.predictive import predictive
from ..diagnostics.residuals import rms
from ..diagnostics.uncertainty import CONFIDENCE
from ..fitted_ground import FittedVariant
from ..prediction import Outside, PredictedTests, Scores, VariantPrediction, score
from ..problem.dataset import LIMITS
from .contents import range_text

MOST_NAMES = 6
"""Number of tests that are named in a sentence."""
CSV_COLUMNS = (
    *("variant", "row", "test", "outcome", "outcome_share", "target", "limit"),
    *("measured", "best_fit", "predicted", "low_50", "high_50", "low_95", "high_95"),
    *("model_low", "model_high", "sigma", "discrepancy", "without_result", "crps"),
    *("mean_crps", "limit_chance", "outside"),
)


def prediction_report(prediction: PredictedTests) -> Document:
    """Report scores, remarks, and the tests one by one where they are few."""
    few, several = len(prediction.tests) <= 30, len(prediction.variants) > 1
    parts: list[Part] = [
        f"{prediction.tests.described}, predicted by the fit of "
        f"{prediction.ground.title!r}.",
        *filter(None, [prediction.tests.missing_in_words(prediction.ground.nuisances)]),
        *(_about_outside(prediction, outside) for outside in prediction.outside),
        *(
            f"No fitted test has a block of the shape {shape}."
            for shape in prediction.new_shapes
        ),
        *_about_groups(prediction),
    ]
    scored = {}
    for variant in prediction.variants:
        name, scores = variant.fitted.variant.name, score(prediction, variant)
        scored[name if several else ""] = scores
        tests = _test_table(prediction, variant) if few else None
        inner: list[Part] = [
            ReportSection("Scores (predicted less measured)", [_score_table(scores)]),
            ReportSection("Remarks", [remarks_on(prediction, variant, scores)]),
            ReportSection("Tests: median (95 %); measured", [tests]),
        ]
        parts += [ReportSection(name, inner)] if several else inner
    tests = simple_table(prediction) if few else None
    laws = [
        *_simple_laws(prediction, scored),
        ReportSection("Tests by simple laws: best (95 %)", [tests]),
    ]
    parts.append(ReportSection("Simple laws fitted to the same tests", laws))
    return Document("", parts, [])


def _score_table(scores: dict[str, Scores]) -> Table:
    head = ("target", "tests", "rms", "bias", "in 50 %", "in 95 %", "CRPS")
    rows = [
        (
            *(name, one.count, one.rms, one.bias),
            *(_of_known(one, inside) for inside in (one.inside_50, one.inside_95)),
            *(one.crps, one.mean_rms, one.mean_crps),
            None if one.skill is None else f"{one.skill:+.2f}",
        )
        for name, one in scores.items()
    ]
    return Table((*head, "rms of mean", "CRPS of mean", "skill"), rows)


def _of_known(scores: Scores, inside: int) -> str | None:
    """Write a number of measurements, with of how many where the scatter of others is
    unknown."""
    if scores.with_scatter == scores.count:
        return str(inside)
    return f"{inside} of {scores.with_scatter}" if scores.with_scatter else None


def remarks_on(
    prediction: PredictedTests, variant: VariantPrediction, scores: dict[str, Scores]
) -> list[str]:
    """List what must be known before the predictions of a variant are used."""
    fitted, lines = variant.fitted, []
    if scores:
        lines.append(
            '"of mean": forecast by mean and scatter of the fitted tests, without a '
            "model. Skill is 1 for a perfect forecast, 0 for that one."
        )
    count = sum(one.with_scatter for one in scores.values())
    inside = sum(one.inside_95 for one in scores.values())
    if count:
        words = f"{inside} of {count} measurements lie within their 95 % intervals"
        few = too_few(inside, count, CONFIDENCE)
        lines.append(words + (", fewer than chance allows." if few else "."))
    for name, one in scores.items():
        if one.limits:
            lines.append(
                f"Of {one.limits} limits of {name} {one.limits_expected:.3g} are "
                "expected to be satisfied."
            )
        if one.unpredicted:
            lines.append(
                f"{one.unpredicted} measurements of {name} have no prediction, and "
                "count in no score."
            )
    for name in fitted.undetermined:
        lines += _about_undetermined(prediction, fitted, name)
    if not fitted.trusted:
        count = 1.0 / np.sum(fitted.weights**2)
        lines.append(
            f"The effective sample size is {count:.0f} of {len(fitted.weights)} draws: "
            "the intervals may be much too narrow or too wide. Do not rely on them."
        )
    for name in prediction.targets:
        if name in fitted.proportional:
            part = 100 * fitted.proportional[name].fraction
            lines.append(
                f"The scatter of {name} is {part:.3g} % of the value predicted."
            )
    lines += _about_discrepancy(variant)
    unknown = [
        name
        for target, name in enumerate(prediction.targets)
        if not np.any(variant.sigma[:, target] > 0.0)
    ]
    if unknown:
        lines.append(
            f"The scatter of {', '.join(unknown)} is unknown: the intervals are those "
            "of the model alone."
        )
    changing = np.flatnonzero(variant.outcome_share < 0.95)
    if len(changing):
        lines.append(
            f"The outcome is uncertain for {_named(prediction, changing)}: more than "
            "5 % of the draws have another one."
        )
    return lines


def _about_discrepancy(variant: VariantPrediction) -> list[str]:
    """Say how much of the intervals is discrepancy, and what it was estimated from."""
    words = in_words(variant.fitted.discrepancy)
    there = np.isfinite(variant.middle) & (variant.sigma > 0.0)
    there &= variant.discrepancy > 0.0  # known
    if not np.any(there):
        return [words]
    square = variant.discrepancy[there] ** 2
    part = 100.0 * square / (square + variant.sigma[there] ** 2)
    return [
        f"Discrepancy is {np.min(part):.0f} to {np.max(part):.0f} % of the variance of "
        "a measurement about the model.",
        words,
    ]


def _about_undetermined(
    prediction: PredictedTests, fitted: FittedVariant, name: str
) -> list[str]:
    """Describe the range of the draws of a parameter, and whether it is too small."""
    parameter = next(p for p in prediction.ground.parameters if p.name == name)
    values = fitted.draws[:, fitted.unknowns.index(name)]
    spread = predictive(values, fitted.weights, 0.0)
    assert spread is not None  # draws have values
    low, high = spread.quantile(0.025), spread.quantile(0.975)
    lines = [
        f"{name} was not identifiable: 95 % of its draws lie between {low:.3g} and "
        f"{high:.3g}, with bounds of {parameter.lower:g} and {parameter.upper:g}, and "
        "the intervals are as wide as that makes them."
    ]
    ends = fitted.allowed[name]
    least = parameter.lower if ends[0] is None else ends[0]
    most = parameter.upper if ends[1] is None else ends[1]
    scale = np.log if parameter.logarithmic else np.asarray
    if scale(high) - scale(low) < 0.5 * (scale(most) - scale(least)):
        lines.append(
            f"Its 95 % profile-likelihood interval is {least:.3g} to {most:.3g}: the "
            "draws do not cover it, and the intervals are too narrow."
        )
    return lines


def _about_outside(prediction: PredictedTests, outside: Outside) -> str:
    fitted = f"{outside.low:g} to {outside.high:g}"
    if outside.low == outside.high:
        fitted = f"{outside.low:g} alone"
    return (
        f"Outside the fitted tests: {outside.column} {range_text(outside.values)} "
        f"(fitted: {fitted}) in {_named(prediction, outside.tests)}."
    )


def _about_groups(prediction: PredictedTests) -> list[str]:
    """Name the groups of nuisance parameters that the fit does not know: a typing error
    makes a new group."""
    ground, lines = prediction.ground, []
    for name, entry in ground.nuisances.items():
        groups = dict.fromkeys(prediction.tests.files[0].labels.get(entry["by"], ()))
        fitted = ground.variants[0].unknowns
        if new := [group for group in groups if f"{name}[{group}]" not in fitted]:
            more = " and more" if len(new) > MOST_NAMES else ""
            lines.append(
                f"The fit knows no {entry['by']} {', '.join(new[:MOST_NAMES])}{more}: "
                f"there {name} is sampled from its prior."
            )
    return lines


def _named(prediction: PredictedTests, tests: np.ndarray) -> str:
    names = prediction.tests.names_apart(tests[:MOST_NAMES])
    if len(tests) == len(prediction.tests) and len(tests) > 1:
        return f"all {len(tests)} tests"
    more = f" and {len(tests) - MOST_NAMES} more" if len(tests) > MOST_NAMES else ""
    return ", ".join(names) + more


def _test_table(prediction: PredictedTests, variant: VariantPrediction) -> Table:
    rows = []
    for test, name in enumerate(prediction.tests.names_apart()):
        cells = []
        for target in range(len(prediction.targets)):
            cell = test, target
            ends = variant.low_95[cell], variant.high_95[cell]
            text = _with_interval(variant.middle[cell], *ends)
            if np.isfinite(prediction.measured[cell]):
                sign = LIMITS[int(prediction.censored[cell])]
                text += f"; {sign}{prediction.measured[cell]:.3g}"
            cells.append(text)
        rows.append((name, variant.outcomes[test], *cells))
    return Table(("test", "outcome", *prediction.targets), rows)


def _with_interval(value: float, low: float, high: float) -> str:
    return f"{value:.3g} ({low:.3g} to {high:.3g})" if np.isfinite(value) else "none"


def simple_scores(
    prediction: PredictedTests, law: LawPrediction
) -> dict[str, tuple[float, float]]:
    """Compute the root mean square error and the mean CRPS of each target that a
    simple law predicts and of which anything was measured."""
    of_targets = {}
    for place, name in enumerate(law.targets):
        target = prediction.targets.index(name)
        exact = prediction.censored[:, target] == 0
        exact &= np.isfinite(prediction.measured[:, target])
        tests = np.flatnonzero(exact & np.isfinite(law.best[:, place]))
        measured = prediction.measured[tests, target]
        distributions = (law.distribution(int(test), place) for test in tests)
        scores = [
            distribution.crps(float(value))
            for distribution, value in zip(distributions, measured, strict=True)
            if distribution is not None
        ]
        error = rms(law.best[tests, place] - measured)
        if error is not None:
            of_targets[name] = error, float(np.mean(scores))
    return of_targets


def _simple_laws(
    prediction: PredictedTests, models: dict[str, dict[str, Scores]]
) -> list[Part]:
    """Compare the simple laws with the model: what they predict, where one predicts
    better, and rms and CRPS target by target.

    Args:
        models: scores of each variant by its name, "" for the only one.
    """
    compared = [f"Laws compared: {words}" for words in prediction.ground.compared[:1]]
    if not prediction.simple:
        return [
            ["None: laws of rebound predict none of the fitted targets.", *compared]
        ]
    laws = [(law.name, simple_scores(prediction, law)) for law in prediction.simple]
    targets = ", ".join(prediction.simple[0].targets)
    lines = [
        f"{listed([law for law, _ in laws])}, fitted to {targets} of the tests of the "
        "fit.",
        *compared,
    ]
    rows = []
    for name in dict.fromkeys(name for _, of_targets in laws for name in of_targets):
        for model, scores in models.items():
            one = scores.get(name)
            if one is not None and one.rms is not None and one.crps is not None:
                rows.append((name, model or "model", one.rms, one.crps))
        for law, of_targets in laws:
            if name in of_targets:
                rows.append((name, law, *of_targets[name]))
    for model, scores in models.items():
        for law, of_targets in laws:
            for name, (_, crps) in of_targets.items():
                by_model = scores[name].crps if name in scores else None
                if by_model is not None and crps < by_model:
                    lines.append(
                        f"{name}: {law} better than the {f'model {model}'.strip()}, "
                        f"CRPS {crps:.3g} against {by_model:.3g}."
                    )
    return [lines, Table(("target", "law", "rms", "CRPS"), rows)]


def simple_table(prediction: PredictedTests) -> Table:
    """Write the predictions of the simple laws, test by test."""
    rows = [
        (
            name,
            law.name,
            *(
                _with_interval(law.best[test, place], *law.interval(test, place))
                for place in range(len(law.targets))
            ),
        )
        for test, name in enumerate(prediction.tests.names_apart())
        for law in prediction.simple
    ]
    targets = prediction.simple[0].targets if prediction.simple else ()
    return Table(("test", "law", *targets), rows)


def prediction_table(prediction: PredictedTests) -> Table:
    """Write a line for each variant, test and target.

    `row` is that of the file, whose header is row 1, and `test` the name of the test.
    `predicted` is the median of a measurement, `low_` and `high_` are the ends of its
    50 % and 95 % intervals, `model_low` and `model_high` those of 95 % of the model's
    values without scatter. `limit` is `>` or `<` where only a limit is known, and
    `limit_chance` the predicted probability that it is satisfied. `outside` names the
    columns in which the test leaves the range of the fitted ones.
    """
    beyond = [
        " ".join(o.column for o in prediction.outside if test in o.tests)
        for test in range(len(prediction.tests))
    ]
    rows = []
    for variant in prediction.variants:
        columns = (
            *(prediction.measured, variant.best, variant.middle, variant.low_50),
            *(variant.high_50, variant.low_95, variant.high_95, variant.model_low),
            *(variant.model_high, variant.sigma, variant.discrepancy),
            *(variant.missing_part, variant.crps, variant.mean_crps),
            variant.limit_chance,
        )
        rows += [
            (
                *(variant.fitted.variant.name, prediction.tests.place(test)[1]),
                prediction.tests.name(test),
                *(variant.outcomes[test], float(variant.outcome_share[test])),
                prediction.targets[target],
                LIMITS[int(prediction.censored[test, target])],
                *(plain(column[test, target]) for column in columns),
                beyond[test],
            )
            for test, target in np.ndindex(*prediction.measured.shape)
        ]
    return Table(CSV_COLUMNS, rows)


def as_json(prediction: PredictedTests) -> dict:
    """Collect scores and origin as a tree of plain values."""
    return {
        "fit": prediction.ground.title,
        "variants": [
            {
                "name": variant.fitted.variant.name,
                "scores": score(prediction, variant),
                "undetermined": list(variant.fitted.undetermined),
                "accuracy_of_draws": variant.fitted.accuracy.name,
            }
            for variant in prediction.variants
        ],
        "simple_laws": {
            law.name: {
                name: {"rms": rms, "crps": crps}
                for name, (rms, crps) in simple_scores(prediction, law).items()
            }
            for law in prediction.simple
        },
        "outside": {
            one.column: {
                "fitted": [one.low, one.high],
                "rows": [prediction.tests.place(test)[1] for test in one.tests],
            }
            for one in prediction.outside
        },
        "shapes_not_fitted": prediction.new_shapes,
        "manifest": {
            "tests": prediction.tests.checksums,
            "draws": len(prediction.ground.variants[0].draws),
            "seed": prediction.ground.seed,
            "accuracy": prediction.ground.accuracy,
            "laws": part_names(prediction.tests.base.soil, prediction.tests.base.block),
            "versions": versions(),
            "versions_of_fit": prediction.ground.versions,
        },
    }


def write_prediction(prediction: PredictedTests, path: Path) -> None:
    """Write the table, and scores and origin beside it; each whole or not at all.

    Raises InputError for a path that would retarget a file the predictions were made
    from, OSError where the file system refuses.
    """
    outputs = [("the predictions", path), ("their manifest", manifest_path(path))]
    refuse_inputs(outputs, prediction.inputs)
    with replacing(manifest_path(path)) as beside, replacing(path) as temporary:
        put_text(beside, json_text(as_json(prediction)))
        put_text(temporary, prediction_table(prediction).csv())

"""Predictions as text, as a table, and as numbers."""

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..formats.align import align
from ..formats.files import refuse_inputs, replacing
from ..formats.outputs import manifest_path
from ..formats.provenance import versions
from ..identity import part_names
from .chance import too_few
from .fitted_ground import FittedVariant
from .predictive import CONFIDENCES, predictive
from .scores import Scores, score
from .wrapping import listed, wrapped

if TYPE_CHECKING:
    from .prediction import Outside, Prediction, VariantPrediction

MOST_TESTS = 30
"""Tests that are listed one by one; of more the table holds all."""
MOST_NAMES = 6
FAR_ENOUGH = 0.5
"""Part of what a profile leaves of a parameter at 95 % that draws must cover."""
CSV_COLUMNS = (
    *("variant", "row", "test", "outcome", "outcome_share", "target", "limit"),
    *("measured", "best_fit", "predicted", "low_50", "high_50", "low_95", "high_95"),
    *("model_low", "model_high", "sigma", "without_result", "crps", "mean_crps"),
    *("limit_chance", "outside"),
)


def as_text(prediction: "Prediction") -> str:
    """Scores, remarks, and the tests one by one where they are few."""
    files = ", ".join(table.path.name for table in prediction.tests.files)
    head = f"{len(prediction.tests)} tests of {files}, predicted by the fit of "
    lines = wrapped(f"{head}{prediction.ground.title!r}.", 0, 2)
    for outside in prediction.outside:
        lines += wrapped(_about_outside(prediction, outside), 0, 2)
    for shape in prediction.new_shapes:
        lines += wrapped(f"No fitted test has a block of the shape {shape}.", 0, 2)
    several = len(prediction.variants) > 1
    for variant in prediction.variants:
        name = variant.fitted.variant.name
        lines += ["", name, "-" * len(name)] if several else [""]
        lines += _of_variant(prediction, variant)
    return "\n".join(lines) + "\n"


def _of_variant(prediction: "Prediction", variant: "VariantPrediction") -> list[str]:
    lines, scores = [], score(prediction, variant)
    if scores:
        lines += ["Scores (predicted less measured)", align(_score_rows(scores))]
    remarks = remarks_on(prediction, variant, scores)
    if remarks:
        lines += ["Remarks", *listed(remarks)]
    if len(prediction.tests) <= MOST_TESTS:
        lines += ["Tests: median (95 %); measured", align(_rows(prediction, variant))]
    return lines


def _score_rows(scores: dict[str, Scores]) -> list[tuple[str, ...]]:
    head = ("target", "tests", "rms", "bias", "in 50 %", "in 95 %", "CRPS")
    rows = [(*head, "rms of mean", "CRPS of mean", "skill")]
    for name, one in scores.items():
        rows.append(
            (
                name,
                str(one.count),
                *(_number(value) for value in (one.rms, one.bias)),
                *(str(count) for count in (one.inside_50, one.inside_95)),
                *(_number(v) for v in (one.crps, one.mean_rms, one.mean_crps)),
                "none" if one.skill is None else f"{one.skill:+.2f}",
            )
        )
    return rows


def remarks_on(
    prediction: "Prediction", variant: "VariantPrediction", scores: dict[str, Scores]
) -> list[str]:
    """What is to be known of a variant's predictions before they are used."""
    fitted, lines = variant.fitted, []
    if scores:
        lines.append(
            '"of mean": by the mean of the fitted tests and their scatter, without a '
            "model. Skill is 1 for a perfect forecast, 0 for that one."
        )
    count = sum(one.count for one in scores.values())
    inside = sum(one.inside_95 for one in scores.values())
    if count:
        words = f"{inside} of {count} measurements lie in their intervals of 95 %"
        few = too_few(inside, count, CONFIDENCES[1])
        lines.append(words + (", fewer than chance allows." if few else "."))
    for name, one in scores.items():
        if one.limits:
            lines.append(
                f"Of {one.limits} limits of {name} the prediction expects "
                f"{one.limits_expected:.3g} to be kept."
            )
        if one.unpredicted:
            lines.append(
                f"{one.unpredicted} measurements of {name} have no prediction, and are "
                "in no score."
            )
    for name in fitted.undetermined:
        lines += _about_undetermined(prediction, fitted, name)
    if not fitted.trusted:
        count = 1.0 / np.sum(fitted.weights**2)
        lines.append(
            f"Of the fit's {len(fitted.weights)} draws only about {count:.0f} count: "
            "the intervals may be far off, to either side. Do not rely on them."
        )
    for name in prediction.targets:
        if name in fitted.proportional:
            part = 100 * fitted.proportional[name].part
            lines.append(
                f"The scatter of {name} is {part:.3g} % of the value predicted."
            )
    unknown = [
        name
        for place, name in enumerate(prediction.targets)
        if not np.any(variant.sigma[:, place] > 0.0)
    ]
    if unknown:
        lines.append(
            f"Nobody stated the scatter of {', '.join(unknown)}: the intervals are "
            "those of the model alone."
        )
    changing = np.flatnonzero(variant.outcome_share < 0.95)
    if len(changing):
        lines.append(
            f"The outcome is open for {_named(prediction, changing)}: more than 5 % of "
            "the draws end otherwise."
        )
    return lines


def _about_undetermined(
    prediction: "Prediction", fitted: FittedVariant, name: str
) -> list[str]:
    """How far the draws of a parameter go, and whether that is far enough."""
    parameter = next(p for p in prediction.ground.parameters if p.name == name)
    values = fitted.draws[:, fitted.unknowns.index(name)]
    spread = predictive(values, fitted.weights, 0.0)
    low, high = spread.quantile(0.025), spread.quantile(0.975)
    lines = [
        f"The fit did not determine {name}: 95 % of its draws lie between {low:.3g} "
        f"and {high:.3g}, in bounds of {parameter.lower:g} and {parameter.upper:g}, "
        "and the intervals are as wide as that makes them."
    ]
    ends = fitted.allowed[name]
    least = parameter.lower if ends[0] is None else ends[0]
    most = parameter.upper if ends[1] is None else ends[1]
    scale = np.log if parameter.logarithmic else np.asarray
    if scale(high) - scale(low) < FAR_ENOUGH * (scale(most) - scale(least)):
        lines.append(
            f"Its profile allows {least:.3g} to {most:.3g}: the draws do not go far "
            "enough, and the intervals are too narrow."
        )
    return lines


def _about_outside(prediction: "Prediction", outside: "Outside") -> str:
    values = prediction.tests.columns(prediction.ground.soil)[outside.column]
    beyond = values[outside.tests]
    fitted = f"{outside.low:g} to {outside.high:g}"
    if outside.low == outside.high:
        fitted = f"{outside.low:g} alone"
    where = f"{np.min(beyond):g}"
    if np.ptp(beyond) > 0.0:
        where += f" to {np.max(beyond):g}"
    return (
        f"Outside the fitted tests: {outside.column} {where} (fitted: {fitted}) in "
        f"{_named(prediction, outside.tests)}."
    )


def _named(prediction: "Prediction", tests: np.ndarray) -> str:
    names = [prediction.tests.name(int(test)) for test in tests[:MOST_NAMES]]
    if len(tests) == len(prediction.tests) and len(tests) > 1:
        return f"all {len(tests)} tests"
    more = f" and {len(tests) - MOST_NAMES} more" if len(tests) > MOST_NAMES else ""
    return ", ".join(names) + more


def _rows(
    prediction: "Prediction", variant: "VariantPrediction"
) -> list[tuple[str, ...]]:
    rows = [("test", "outcome", *prediction.targets)]
    for test in range(len(prediction.tests)):
        cells = []
        for place in range(len(prediction.targets)):
            cell = test, place
            text = "none"
            if np.isfinite(variant.middle[cell]):
                text = (
                    f"{variant.middle[cell]:.3g} ({variant.low_95[cell]:.3g} to "
                    f"{variant.high_95[cell]:.3g})"
                )
            if np.isfinite(prediction.measured[cell]):
                sign = _limit(prediction, cell)
                text += f"; {sign}{prediction.measured[cell]:.3g}"
            cells.append(text)
        rows.append((prediction.tests.name(test), variant.outcomes[test], *cells))
    return rows


def _limit(prediction: "Prediction", cell) -> str:
    return {1: ">", -1: "<", 0: ""}[int(prediction.censored[cell])]


def as_csv(prediction: "Prediction") -> str:
    """A line for each variant, test and target.

    `predicted` is the median of a measurement, `low_` and `high_` hold as many per cent
    of such measurements, `model_low` to `model_high` 95 % of what the model gives
    without their scatter. `limit` is `>` or `<` where only a limit is known, and
    `limit_chance` the predicted chance that it is kept. `outside` names the columns in
    which the test leaves the range of the fitted ones.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    beyond = [
        " ".join(o.column for o in prediction.outside if test in o.tests)
        for test in range(len(prediction.tests))
    ]
    for variant in prediction.variants:
        columns = (
            *(prediction.measured, variant.best, variant.middle, variant.low_50),
            *(variant.high_50, variant.low_95, variant.high_95, variant.model_low),
            *(variant.model_high, variant.sigma, variant.missing_part, variant.crps),
            *(variant.mean_crps, variant.limit_chance),
        )
        for cell in np.ndindex(*prediction.measured.shape):
            test, place = cell
            numbers = [_digits(column[cell]) for column in columns]
            writer.writerow(
                (
                    variant.fitted.variant.name,
                    test + 1,
                    prediction.tests.name(test),
                    variant.outcomes[test],
                    _digits(variant.outcome_share[test]),
                    prediction.targets[place],
                    _limit(prediction, cell),
                    *numbers,
                    beyond[test],
                )
            )
    return text.getvalue()


def as_json(prediction: "Prediction") -> dict:
    """Scores and origin, as a tree of plain values."""
    return {
        "fit": prediction.ground.title,
        "variants": [
            {
                "name": variant.fitted.variant.name,
                "scores": {
                    name: one._asdict()
                    for name, one in score(prediction, variant).items()
                },
                "undetermined": list(variant.fitted.undetermined),
                "accuracy_of_draws": variant.fitted.accuracy.name,
            }
            for variant in prediction.variants
        ],
        "outside": {
            one.column: {
                "fitted": [one.low, one.high],
                "rows": [int(test) + 1 for test in one.tests],
            }
            for one in prediction.outside
        },
        "shapes_not_fitted": prediction.new_shapes,
        "manifest": {
            "tests": [
                {"file": table.path.name, "sha256": table.sha256}
                for table in prediction.tests.files
            ],
            "draws": len(prediction.ground.variants[0].draws),
            "seed": prediction.ground.seed,
            "accuracy": prediction.ground.accuracy,
            "laws": part_names(prediction.tests.base.soil, prediction.tests.base.block),
            "versions": versions(),
            "versions_of_fit": prediction.ground.versions,
        },
    }


def write(prediction: "Prediction", path: Path) -> None:
    """Write the table, and scores and origin beside it; each whole or not at all.

    Raises InputError for a path that would replace what the predictions were made from,
    OSError where the file system refuses.
    """
    outputs = [("the predictions", path), ("their manifest", manifest_path(path))]
    refuse_inputs(outputs, prediction.inputs)
    with (
        replacing(manifest_path(path)) as beside,
        replacing(path) as temporary,
    ):
        tree = json.dumps(as_json(prediction), indent=1, allow_nan=False)
        beside.write_text(tree + "\n", encoding="utf-8")
        temporary.write_text(as_csv(prediction), encoding="utf-8")


def _digits(value: float) -> str:
    return f"{value:.9g}" if np.isfinite(value) else ""


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.3g}"

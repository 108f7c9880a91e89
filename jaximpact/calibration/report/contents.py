"""Contents of the report: sentences and tables of a calibration as plain values, which
the layouts in templates/ arrange. A table is a list of rows, its head first."""

import collections
import dataclasses
import itertools

import numpy as np

from ..._packages import versions
from ...accuracy import PRESETS
from ...identity import name_of
from ...io.display import Rows
from ...quantities import INPUT_COLUMNS
from ..comparison.comparison import Compared
from ..diagnostics import cross_validation, further_tests, residuals
from ..diagnostics.cross_validation import LeftOut
from ..diagnostics.examination import (
    TOO_FEW_FOR_SIGMA,
    Examination,
    fit_of_target,
    freedom_text,
    warnings_of,
)
from ..diagnostics.results import StudyResult, VariantResult
from ..estimation.least_squares import Reason
from ..estimation.sigma import LEAST_FREEDOM, relative_sigma
from ..problem.config import Study
from ..problem.laws import in_words, unusual
from .comparison import comparison_contents, worse_than_others
from .parameters import (
    NOT_IDENTIFIABLE,
    about_draws,
    about_posterior,
    correlation_rows,
    correlations_short,
    nuisance_rows,
    parameter_rows,
    parameters_short,
    profile_rows,
    verdict,
)

MOST_ROWS = 12
"""Number of tests listed of those left out: the worst predicted."""
ONE_ROW = 1e-3
"""Relative difference of costs within which starts share a row."""


def contents_of(
    result: StudyResult, examined: list[Examination], compared: Compared | None = None
) -> dict:
    """Collect everything that the report says, without its pictures."""
    study = result.study
    return {
        "title": study.title,
        "several": len(result.variants) > 1,
        "about": _about(study),
        "about_short": [*_about_tests(study), _held(study)],
        "variant_rows": _variant_rows(result),
        "variants": [
            _variant(result, variant, diagnostics, compared)
            for variant, diagnostics in zip(result.variants, examined, strict=True)
        ],
        "comparison": None if compared is None else comparison_contents(compared),
        "comparison_pictures": [],
        "origin": _origin(result),
    }


def _variant(
    result: StudyResult,
    variant: VariantResult,
    diagnostics: Examination,
    compared: Compared | None,
) -> dict:
    values = diagnostics.residuals.values
    warnings = warnings_of(result, variant, diagnostics)
    if compared is not None:
        warnings += worse_than_others(compared, variant.variant)
    return {
        "name": variant.variant.name,
        "pictures": collections.defaultdict(list),
        "verdict": verdict(result, variant),
        "warnings": warnings,
        "parameters": parameter_rows(variant),
        "parameters_short": parameters_short(variant),
        "profiles": {n: profile_rows(found) for n, found in variant.profiles.items()},
        "directions": variant.directions,
        "correlation": correlation_rows(variant),
        "correlations_short": correlations_short(variant),
        "nuisances": nuisance_rows(variant),
        "draws": about_draws(result, variant, diagnostics.draws),
        "posterior": diagnostics.samples and about_posterior(variant, diagnostics),
        "fit": target_rows(result, variant, diagnostics.each),
        "statistics": _statistics(result, variant),
        "has_residuals": np.any(np.isfinite(values)),
        "residuals": residuals.in_words(diagnostics.residuals, variant.objective),
        "cross_validation": [
            _cross_validation(result, variant, left, what)
            for left, what in (
                (diagnostics.each, "test"),
                (diagnostics.campaigns, "campaign"),
            )
            if left is not None
        ],
        "further": _further(diagnostics),
        "starts": _starts_in_words(variant),
        "start_rows": _start_rows(variant),
        "stopped": variant.reason.words,
    }


# --- What was fitted to what. ---


def _about(study: Study) -> list[str]:
    loss = "" if study.loss == "gaussian" else f", {study.loss} loss"
    lines = [f"Source: {study.source}"] if study.source else []
    lines += [study.notes] if study.notes else []
    lines += _about_tests(study)
    if other := unusual(study.parts):
        lines.append(f"Laws other than the default: {in_words(other)}.")
    lines += [
        f"Laws of {variant.name}: {in_words(variant.laws)}."
        for variant in study.variants
        if variant.laws
    ]
    lines.append(
        f"Method: {study.method}{loss}, accuracy {study.accuracy}, {study.starts} "
        f"starts, seed {study.seed}."
    )
    return lines


def _about_tests(study: Study) -> list[str]:
    """Describe tests, missing and censored measurements, and sigmas."""
    line = f"{study.tests.described}, fitted to {', '.join(study.targets)}."
    missing = int(np.sum(study.comparable & ~study.known))
    censored = int(np.sum(study.known & (study.censored != 0)))
    parts = [f"{missing} {'is' if missing == 1 else 'are'} missing"] if missing else []
    if censored:
        parts += ["1 is a limit" if censored == 1 else f"{censored} are limits"]
    if parts:
        line += f" Of {np.sum(study.comparable)} measurements {' and '.join(parts)}."
    empty = [n for n, m in study.tests.measured.items() if not np.any(np.isfinite(m))]
    if empty:
        line += f" Without any measurement: {', '.join(empty)}."
    return [line, _about_sigma(study)]


def _about_sigma(study: Study) -> str:
    if np.all(study.sigma_given):
        return "Standard errors follow from the given sigmas."
    names = list(itertools.compress(study.targets, ~study.sigma_given))
    which = "" if len(names) == len(study.targets) else f" for {', '.join(names)}"
    words = (
        f"No sigma is given{which}: it is estimated from the residuals, which are "
        "taken as random."
    )
    in_parts = list(itertools.compress(study.targets, study.proportional))
    if in_parts:
        words += (
            f" The sigma of {', '.join(in_parts)} is the same fraction of the value in "
            "all tests."
        )
    return words


def _held(study: Study) -> str:
    """Describe the fixed quantities that no table states."""
    columns = study.tests.known_columns
    fitted = {p.name for p in study.parameters} | {n.name for n in study.nuisances}
    defaults = {
        name: column
        for name, column in columns.items()
        if name not in study.tests.inputs and name not in fitted
    }
    missing = {n: c.default for n, c in defaults.items() if c.part != "soil"}
    of_laws = {n: c.default for n, c in defaults.items() if c.part == "soil"}
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
    words = f"Ground: Table 1{' but for ' + ', '.join(other) if other else ''}."
    if shape is not None:
        words = f"Shape: {type(shape).__name__}. {words}"
    if missing:
        taken = ", ".join(f"{name} {value:g}" for name, value in missing.items())
        words = f"Not in the table, default values: {taken}. {words}"
    return words


def _variant_rows(result: StudyResult) -> Rows:
    """Write the variants side by side."""
    study = result.study
    names = [parameter.name for parameter in study.parameters]
    rows: Rows = [("variant", *names, *(f"rms {t}" for t in study.targets), "cost")]
    for variant in result.variants:
        cells = [
            f"{variant.parameters[index]:.4g}"
            + ("" if verdict.determined else f" ({NOT_IDENTIFIABLE})")
            for index, verdict in enumerate(variant.verdicts)
        ]
        errors = [
            number_text(fit_of_target(result, variant, target)["rms"])
            for target in range(len(study.targets))
        ]
        rows.append((variant.variant.name, *cells, *errors, f"{variant.cost:.4g}"))
    return rows


# --- Fit, cross-validation, starts. ---


def target_rows(
    result: StudyResult, variant: VariantResult, left: LeftOut | None = None
) -> Rows:
    """Write the errors of each target, with those of tests left out if given."""
    study = result.study
    limits = bool(np.any(study.known & (study.censored != 0)))
    rows: list[dict[str, str]] = []
    relative = relative_sigma(study, variant.sigma, variant.predicted)
    few = variant.uncertainty.degrees_of_freedom < LEAST_FREEDOM
    for target, name in enumerate(study.targets):
        values = fit_of_target(result, variant, target)
        origin = "guessed" if few else "estimated"
        origin = "given" if study.sigma_given[target] else origin
        sigma = variant.sigma[study.known[:, target], target]
        size = f"{np.median(sigma):.3g}"
        if study.proportional[target]:
            size = f"{100 * relative[target]:.3g} % of the value"
        row = {"target": name, "rms": number_text(values["rms"])}
        if left is not None:
            row["rms left out"] = _rms_left_out(study, left, target)
        row |= {key: number_text(values[key]) for key in ("max", "bias")}
        row["sigma"] = f"{size} ({origin})"
        if limits:
            row["limits violated"] = str(values["limits_broken"])
        rows.append(row)
    return [tuple(rows[0]), *(tuple(row.values()) for row in rows)]


def _rms_left_out(study: Study, left: LeftOut, target: int) -> str:
    apart = (left.predicted - study.measured)[:, target]
    apart = apart[(study.censored[:, target] == 0) & np.isfinite(apart)]
    return f"{np.sqrt(np.mean(apart**2)):.4g}" if len(apart) else "none"


def _statistics(result: StudyResult, variant: VariantResult) -> list[str]:
    uncertainty = variant.uncertainty
    freedom, words = uncertainty.degrees_of_freedom, variant.reason.words
    left = freedom_text(freedom)
    given = np.all(result.study.sigma_given)
    lines = [
        f"Cost {variant.cost:.6g}, {left} degree{'s' * (left != '1')} of freedom. "
        f"{words[0].upper()}{words[1:]}."
    ]
    if given and np.isfinite(uncertainty.reduced_chi_square):
        lines.append(f"Reduced chi-square {uncertainty.reduced_chi_square:.3g}.")
    if uncertainty.inflation > 1.0:
        lines.append(
            "The misfit is larger than the given sigmas allow: standard errors are "
            f"multiplied by {np.sqrt(uncertainty.inflation):.3g}."
        )
    if not given and freedom < LEAST_FREEDOM:
        lines.append(TOO_FEW_FOR_SIGMA)
    if variant.failed:
        lines.append(f"{variant.failed} predictions could not be computed.")
    return lines


def _cross_validation(
    result: StudyResult, variant: VariantResult, left: LeftOut, what: str
) -> dict:
    study = result.study
    exact = study.censored == 0
    values = np.where(exact, left.standardised(study.measured), np.nan)
    rows = []
    if np.any(np.isfinite(left.predicted[exact])):
        of = _worst if what == "test" else _campaigns
        rows = of(study, left, values)
    words = cross_validation.in_words(left, variant.objective, what)
    return {"what": what, "words": words, "rows": rows}


def _worst(study: Study, left: LeftOut, values: np.ndarray) -> Rows:
    """Write the measurements that are predicted worst."""
    rows: Rows = [
        ("test", "target", "measured", "predicted", "+-", "standard deviations")
    ]
    order = np.argsort(-np.abs(np.nan_to_num(values)), axis=None)[:MOST_ROWS]
    for test, target in zip(*np.unravel_index(order, values.shape), strict=True):
        if np.isfinite(values[test, target]):
            numbers = (study.measured, left.predicted, left.deviation)
            cells = (f"{part[test, target]:.4g}" for part in numbers)
            name = study.tests.name(int(test))
            rows.append(
                (name, study.targets[target], *cells, f"{values[test, target]:+.2f}")
            )
    return rows


def _campaigns(study: Study, left: LeftOut, values: np.ndarray) -> Rows:
    rows: Rows = [("campaign", "measurements", "in the band", "mean", "rms")]
    for number, name in enumerate(left.groups):
        of_one = values[left.group == number]
        of_one = of_one[np.isfinite(of_one)]
        inside = np.sum(np.abs(of_one) <= left.quantile)
        numbers = ("none", "none")
        if len(of_one):
            numbers = f"{np.mean(of_one):+.2f}", f"{np.sqrt(np.mean(of_one**2)):.2f}"
        rows.append((name, str(len(of_one)), str(inside), *numbers))
    return rows


def _further(diagnostics: Examination) -> dict:
    single, together = diagnostics.single, diagnostics.together
    criterion = {
        "D": "the mean error over all combinations (D-optimal)",
        "A": "the sum of the parameters' variances (A-optimal)",
    }[single.criterion]
    several = together.ways != single.ways
    return {
        "words": (
            f"Of {len(single.volumes)} candidate impacts, those chosen one after the "
            f"other that minimise {criterion}. Errors are relative to the value, or to "
            "half the range."
        ),
        "single": further_tests.in_words(single),
        "single_rows": further_tests.as_rows(single),
        "together": further_tests.in_words(together)[:1] if several else [],
        "together_rows": further_tests.as_rows(together),
        "fixed": ", ".join(f"{n} {v:.4g}" for n, v in single.fixed.items()),
    }


def _starts_in_words(variant: VariantResult) -> str:
    found, total = int(np.sum(variant.reached)), len(variant.start_costs)
    together = int(np.sum((variant.start_restarts > 0) & variant.reached))
    also = f"; {together} of them by a common search, since their own fits ended above"
    return f"{found} of {total} starts found the best fit{also if together else ''}"


def _start_rows(variant: VariantResult) -> Rows:
    """Write the starts, those of one cost and one reason in a row."""
    costs, reasons = variant.start_costs, variant.start_reasons
    names = [of_one.name for of_one in variant.verdicts]
    joined = np.array([reason is Reason.joined for reason in reasons])
    groups: list[list[int]] = []
    for start in np.lexsort((joined, costs)):
        last = groups[-1][0] if groups else start
        alike = reasons[start] in (Reason.joined, reasons[last])
        if groups and alike and costs[start] <= costs[last] * (1.0 + ONE_ROW) + 1e-9:
            groups[-1].append(start)
        else:
            groups.append([start])
    rows: Rows = [("starts", "cost", *names, "steps", "stopped")]
    for group in groups:
        first = group[0]
        values = variant.end_parameters[first, : len(names)]
        rows.append(
            (
                str(len(group)) + (" (with the given)" if 0 in group else ""),
                f"{costs[first]:.6g}",
                *(f"{value:.4g}" for value in values),
                f"{np.mean(variant.start_steps[group]):.3g}",
                reasons[first].words,
            )
        )
    return rows


def _origin(result: StudyResult) -> Rows:
    """Write what the results were computed from and with."""
    study = result.study
    accuracy = dataclasses.asdict(PRESETS[study.accuracy])
    rows: Rows = [("what", "value"), ("study", study.path.name)]
    rows += [(t.path.name, f"sha256 {t.sha256}") for t in study.tests.sources]
    rows += [(slot, name_of(type(law))) for slot, law in unusual(study.parts).items()]
    rows += [
        (f"{slot} of {variant.name}", name_of(type(law)))
        for variant in study.variants
        for slot, law in variant.laws.items()
    ]
    return [
        *rows,
        ("method", study.method),
        ("loss", study.loss),
        ("starts", f"{study.starts}, seed {study.seed}"),
        ("accuracy", ", ".join(f"{k} {v}" for k, v in accuracy.items())),
        ("impacts computed by", result.engine),
        ("time of the fits, in this run", f"{result.seconds:.0f} s"),
        *versions().items(),
    ]


def number_text(value: float | None) -> str:
    """Write a number, or that there is none."""
    return "none" if value is None else f"{value:.4g}"

"""What a calibration says in words and tables: its summary, and the sentences of the
whole report, which `study_report` puts together."""

import dataclasses
import itertools
import math

import numpy as np

from ..._packages import versions
from ...accuracy import PRESETS
from ...identity import name_of
from ...quantities import INPUT_COLUMNS
from ...reports.document import Box, Document, Part, ReportSection
from ...reports.tables import Table
from ..diagnostics.cross_validation import LeftOut
from ..diagnostics.examination import (
    Examination,
    fit_of_target,
    freedom_text,
    limits_alone,
    warnings_of,
)
from ..diagnostics.residuals import Bias, Residuals, rms
from ..diagnostics.results import StudyResult, VariantResult
from ..diagnostics.scatter import chosen_in_words
from ..estimation.sigma import LEAST_FREEDOM, relative_sigma, sigma_factors
from ..problem.config import Study
from ..problem.laws import in_words, unusual
from .parameters import correlated_pairs, nuisance_table, parameter_table, verdict


def summary(result: StudyResult, examined: list[Examination]) -> Document:
    """Say what was found, in a few tables and sentences."""
    parts: list[Part] = [*about_tests(result.study), _fixed_quantities(result.study)]
    for variant, diagnostics in zip(result.variants, examined, strict=True):
        several = len(result.variants) > 1
        inner: list[Part] = [
            ReportSection("Parameters", [parameter_table(variant)]),
            nuisances(variant),
            ReportSection("Correlations", [correlated_pairs(variant)]),
            ReportSection(
                "Fit (predicted less measured)",
                [
                    target_table(result, variant, diagnostics),
                    chosen_in_words(variant.objective, variant.points),
                ],
            ),
            Box(
                "verdict",
                [
                    "Verdict",
                    *verdict(result, variant, diagnostics.residuals),
                    f"{search_in_words(variant)}; {variant.reason}.",
                ],
            ),
            warning_box(warnings_of(result, variant, diagnostics)),
        ]
        parts += [ReportSection(variant.variant.name, inner)] if several else inner
    return Document("", parts, [])


def warning_box(lines: list[str], of: str = "") -> Box | None:
    """Frame warnings, if there are any."""
    return Box("warning", [f"Warnings{of}", *lines]) if lines else None


def nuisances(variant: VariantResult) -> ReportSection:
    """Make the section on nuisance parameters; empty without any."""
    title = "Nuisance parameters, under their priors"
    return ReportSection(title, [nuisance_table(variant)])


# --- What was fitted to what. ---


def about(study: Study) -> list[str]:
    """Describe source, tests, laws and method."""
    loss = "" if study.loss == "gaussian" else f", {study.loss} loss"
    lines = [f"Source: {study.source}"] if study.source else []
    lines += [study.notes] if study.notes else []
    lines += about_tests(study)
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


def about_tests(study: Study) -> list[str]:
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
    names = ", ".join(itertools.compress(study.targets, ~study.sigma_given))
    which = f" for {names}" if np.any(study.sigma_given) else ""
    words = (
        f"No sigma is given{which}: it is estimated from the residuals, which are "
        "taken as random, or guessed where there are too few measurements."
    )
    if proportional := ", ".join(itertools.compress(study.targets, study.proportional)):
        words += (
            f" The sigma of {proportional} is the same fraction of the value in all "
            "tests."
        )
    return words


def _fixed_quantities(study: Study) -> str:
    fitted = {p.name for p in study.parameters} | {n.name for n in study.nuisances}
    defaults = {
        name: column
        for name, column in study.tests.known_columns.items()
        if name not in study.tests.inputs and name not in fitted
    }
    of_laws = {n: c.default for n, c in defaults.items() if c.part == "soil"}
    soil = study.soil | {n: v for n, v in of_laws.items() if n not in study.soil}
    laws = unusual(study.parts)
    shape = laws.pop("shape", None)
    other = [in_words(laws)] if laws else []
    other += [
        f"{name} {value:g}"
        for name, value in soil.items()
        if name not in INPUT_COLUMNS
        or not math.isclose(value, INPUT_COLUMNS[name].default, rel_tol=1e-12)
    ]
    other += [
        f"{name} {range_text(study.tests.inputs[name])}"
        for name, column in study.tests.known_columns.items()
        if column.part == "soil" and name in study.tests.inputs
    ]
    words = f"Ground: Table 1{' but for ' + ', '.join(other) if other else ''}."
    if shape is not None:
        words = f"Shape: {type(shape).__name__}. {words}"
    return f"{study.tests.missing_in_words(fitted)} {words}".lstrip()


def range_text(values: np.ndarray) -> str:
    """Write the range of values, or the only one."""
    low, high = np.min(values), np.max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def variant_table(result: StudyResult) -> Table:
    """Set the variants side by side."""
    study, rows = result.study, []
    names = [parameter.name for parameter in study.parameters]
    for variant in result.variants:
        cells = [
            f"{value:.4g}{'' if one.determined else ' (not identifiable)'}"
            for value, one in zip(variant.parameters, variant.verdicts, strict=False)
        ]
        errors = [
            fit_of_target(result, variant, target)["rms"]
            for target in range(len(study.targets))
        ]
        rows.append((variant.variant.name, *cells, *errors, variant.cost))
    return Table(
        ("variant", *names, *(f"rms {t}" for t in study.targets), "cost"), rows
    )


# --- Fit, cross-validation, starts. ---


def target_table(
    result: StudyResult, variant: VariantResult, diagnostics: Examination
) -> Table:
    """Write the errors of each target, with those of tests left out if there are."""
    study, left = variant.objective.study, diagnostics.each
    biases = {bias.target: bias for bias in diagnostics.residuals.biases}
    limits = bool(np.any(study.known & (study.censored != 0)))
    relative = relative_sigma(study, variant.sigma, variant.predicted)
    few = variant.uncertainty.degrees_of_freedom < LEAST_FREEDOM
    guessed, factors = limits_alone(study), sigma_factors(variant.objective)
    rows: list[dict[str, object]] = []
    for target, name in enumerate(study.targets):
        values = fit_of_target(result, variant, target)
        origin = "guessed" if few or guessed[target] else "estimated"
        if result.study.sigma_given[target]:
            origin = f"given, times {factors[name]:.3g}" if name in factors else "given"
        sigma = variant.sigma[study.known[:, target], target]
        size = f"{np.median(sigma):.3g}"
        if study.proportional[target]:
            size = f"{100 * relative[target]:.3g} % of the value"
        row: dict[str, object] = {"target": name, "rms": values["rms"]}
        if left is not None:
            apart = left.predicted[:, target] - study.measured[:, target]
            exact = (study.censored[:, target] == 0) & np.isfinite(apart)
            row["rms left out"] = rms(apart[exact])
        row["max"], bias = values["max"], biases.get(name)
        row["bias"], row["too high"] = _bias_cells(bias) if bias else (None, None)
        row["sigma"] = f"{size} ({origin})"
        if limits:
            row["limits violated"] = values["limits_broken"]
        rows.append(row)
    return Table(tuple(rows[0]), [tuple(row.values()) for row in rows])


def _bias_cells(bias: Bias) -> tuple[str, str]:
    # No digit beyond the third of the rms: it would depend on how the fit ended.
    mean = bias.mean
    if bias.rms > 0.0:
        mean = round(mean, 2 - math.floor(math.log10(bias.rms))) + 0.0
    percent = "" if math.isnan(bias.percent) else f" ({bias.percent:+.1f} %)"
    return f"{mean:.3g}{percent}", f"{bias.above} of {bias.count}"


def bias_table(residuals: Residuals) -> Table:
    """Write the mean residual of each target with the tests of its bias."""
    rows = [
        (
            bias.target,
            *_bias_cells(bias),
            f"{bias.chance_of_signs:.1g}",
            f"{bias.chance_of_mean:.1g}" if np.isfinite(bias.chance_of_mean) else None,
            "yes" if bias.significant else "no",
        )
        for bias in residuals.biases
    ]
    head = ("target", "bias", "too high", "p of signs", "p of mean", "biased")
    return Table(head, rows)


def statistics(result: StudyResult, variant: VariantResult) -> str:
    """Say how good the fit is."""
    uncertainty, words = variant.uncertainty, str(variant.reason)
    left = freedom_text(uncertainty.degrees_of_freedom)
    line = (
        f"Cost {variant.cost:.6g}, {left} degree{'s' * (left != '1')} of freedom. "
        f"{words[0].upper()}{words[1:]}."
    )
    reduced = uncertainty.reduced_chi_square
    if np.all(result.study.sigma_given) and np.isfinite(reduced):
        line += f" Reduced chi-square {reduced:.3g}."
    return line


def left_out_table(study: Study, left: LeftOut, what: str) -> Table | None:
    """Write the tests that are predicted worst by the others, or the campaigns; None
    without any prediction."""
    exact = study.censored == 0
    if not np.any(np.isfinite(left.predicted[exact])):
        return None
    values = np.where(exact, left.standardised(study.measured), np.nan)
    return _worst(study, left, values) if what == "test" else _campaigns(left, values)


def _worst(study: Study, left: LeftOut, values: np.ndarray) -> Table:
    order = np.argsort(-np.abs(np.nan_to_num(values)), axis=None)[:12]
    names = study.tests.names_apart()
    rows = [
        (
            names[test],
            study.targets[target],
            study.measured[test, target],
            left.predicted[test, target],
            left.deviation[test, target],
            f"{values[test, target]:+.2f}",
        )
        for test, target in zip(*np.unravel_index(order, values.shape), strict=True)
        if np.isfinite(values[test, target])
    ]
    columns = ("test", "target", "measured", "predicted", "+-", "standard deviations")
    return Table(columns, rows)


def _campaigns(left: LeftOut, values: np.ndarray) -> Table:
    rows = []
    for number, name in enumerate(left.groups):
        of_one = values[left.group == number]
        of_one = of_one[np.isfinite(of_one)]
        inside = int(np.sum(np.abs(of_one) <= left.quantile))
        numbers = (None, None)
        if len(of_one):
            numbers = f"{np.mean(of_one):+.2f}", f"{np.sqrt(np.mean(of_one**2)):.2f}"
        rows.append((name, len(of_one), inside, *numbers))
    return Table(("campaign", "measurements", "in the band", "mean", "rms"), rows)


def search_in_words(variant: VariantResult) -> str:
    """Say how far the members of the search agreed."""
    if not variant.members:
        return "fitted from the start alone"
    return f"{variant.agreed} of {variant.members} members of the search agree"


def end_table(variant: VariantResult) -> Table:
    """Write the fits from the best places of the search, the lowest first."""
    names = [verdict.name for verdict in variant.verdicts]
    rows = [
        (
            f"{variant.end_costs[end]:.6g}",
            *variant.end_parameters[end, : len(names)],
            int(variant.end_steps[end]),
            str(variant.end_reasons[end]),
        )
        for end in np.argsort(variant.end_costs, kind="stable")
    ]
    return Table(("cost", *names, "steps", "stopped"), rows)


def origin_table(result: StudyResult) -> Table:
    """Write what the results were computed from and with."""
    study = result.study
    accuracy = dataclasses.asdict(PRESETS[study.accuracy])
    laws = unusual(study.parts)
    for variant in study.variants:
        laws |= {f"{slot} of {variant.name}": v for slot, v in variant.laws.items()}
    rows = [
        ("study", study.path.name),
        *((one["file"], f"sha256 {one['sha256']}") for one in study.tests.checksums),
        *((slot, name_of(type(law))) for slot, law in laws.items()),
        ("method", study.method),
        ("loss", study.loss),
        ("starts", f"{study.starts}, seed {study.seed}"),
        ("accuracy", ", ".join(f"{k} {v}" for k, v in accuracy.items())),
        ("impacts computed by", result.engine),
        ("time of the fits, in this run", f"{result.seconds:.0f} s"),
        *versions().items(),
    ]
    return Table(("what", "value"), rows)

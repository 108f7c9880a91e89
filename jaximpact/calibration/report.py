"""The report of a study as text."""

import numpy as np

from ..formats.align import align
from .laws import in_words, unusual
from .scatter import LEAST_FREEDOM, part_of_size
from .stopping import Reason
from .study import StudyResult, VariantResult
from .study_file import Study

TOO_FEW_FOR_SIGMA = (
    "Too few measurements to estimate their errors: standard errors follow from the "
    "nominal sigmas, a guess."
)
ONE_ROW = 1e-3
"""Relative difference of costs within which starts share a row."""


def as_text(result: StudyResult, doubts: list[list[str]]) -> str:
    """The report: for each variant values, errors, verdicts, directions and fit.

    Args:
        doubts: of each variant, what stands against trusting it.
    """
    study = result.study
    accuracy = f"accuracy {study.accuracy}, {study.starts} starts, seed {study.seed}"
    files = ", ".join(table.path.name for table in study.tests.files)
    loss = "" if study.loss == "gaussian" else f", {study.loss} loss"
    lines = [study.title, "=" * len(study.title), ""]
    lines += [f"Source: {study.source}"] if study.source else []
    lines += [study.notes] if study.notes else []
    lines += [
        f"{len(study.tests)} tests from {files}; fitted to "
        f"{', '.join(study.targets)}; {study.method}{loss}, {accuracy}.",
        *about_cells(study),
        about_sigma(study),
        *about_laws(study),
    ]
    if len(result.variants) > 1:
        lines += ["", "Variants", align(variant_rows(result))]
    for variant, of_one in zip(result.variants, doubts, strict=True):
        lines += ["", *_variant(result, variant, of_one)]
    return "\n".join(lines) + "\n"


def about_laws(study: Study) -> list[str]:
    """Which laws and which shape, where they are not the usual ones."""
    lines = []
    if other := unusual(study.parts):
        lines.append(f"Not the usual: {in_words(other)}.")
    lines += [
        f"Of {variant.name}: {in_words(variant.laws)}."
        for variant in study.variants
        if variant.laws
    ]
    return lines


def about_cells(study: Study) -> list[str]:
    """What is missing, and what is censored."""
    missing = int(np.sum(~study.known))
    censored = int(np.sum(study.known & (study.censored != 0)))
    parts = [f"{missing} cells are empty"] if missing else []
    parts += [f"of {censored} only a limit is known"] if censored else []
    return [f"Of {study.known.size} measurements {', '.join(parts)}."] if parts else []


def about_sigma(study: Study) -> str:
    if np.all(study.sigma_given):
        return "Standard errors follow from the sigmas given."
    names = [
        name
        for name, given in zip(study.targets, study.sigma_given, strict=True)
        if not given
    ]
    which = (
        "No sigma is given"
        if len(names) == len(study.targets)
        else (f"No sigma is given for {', '.join(names)}")
    )
    words = f"{which}: it is estimated from the scatter about the fit, as if random."
    pairs = zip(study.targets, study.proportional, strict=True)
    in_parts = [name for name, proportional in pairs if proportional]
    if in_parts:
        words += (
            f" That of {', '.join(in_parts)} is taken to be the same part of the value "
            "in all tests."
        )
    return words


def fit_of_target(result: StudyResult, variant: VariantResult, place: int) -> dict:
    """Root mean square, largest and mean of predicted less measured, of what is
    measured and not a limit; and how many limits the prediction breaks."""
    study = result.study
    difference = variant.predicted[:, place] - study.measured[:, place]
    censored = study.censored[:, place]
    broken = int(np.sum((censored != 0) & (difference * censored < 0.0)))
    known = difference[np.isfinite(difference) & (censored == 0)]
    if not len(known):
        return {"rms": None, "max": None, "bias": None, "limits_broken": broken}
    return {
        "rms": float(np.sqrt(np.mean(known**2))),
        "max": float(np.max(np.abs(known))),
        "bias": float(np.mean(known)),
        "limits_broken": broken,
    }


def variant_rows(result: StudyResult) -> list[tuple[str, ...]]:
    """Variants side by side."""
    study = result.study
    names = [parameter.name for parameter in study.parameters]
    rows = [("variant", *names, *(f"rms {t}" for t in study.targets), "cost")]
    for variant in result.variants:
        cells = [
            f"{variant.parameters[place]:.4g}"
            + ("" if verdict.determined else " (not determined)")
            for place, verdict in enumerate(variant.verdicts)
        ]
        errors = [
            _number(fit_of_target(result, variant, place)["rms"])
            for place in range(len(study.targets))
        ]
        rows.append((variant.variant.name, *cells, *errors, f"{variant.cost:.4g}"))
    return rows


def _variant(
    result: StudyResult, variant: VariantResult, doubts: list[str]
) -> list[str]:
    title = variant.variant.name if len(result.variants) > 1 else "Fit"
    lines = [title, "-" * len(title), align(parameter_rows(variant))]
    undetermined = [v for v in variant.verdicts if not v.determined]
    lines.append("")
    if not undetermined:
        lines.append("The data determine every fitted parameter.")
    for verdict in undetermined:
        lines.append(f"The data do not determine {verdict.name}: {verdict.reason}.")
    if undetermined and len(undetermined) < len(variant.verdicts):
        rest = ", ".join(v.name for v in variant.verdicts if v.determined)
        held = ", ".join(v.name for v in undetermined)
        lines.append(
            f"The errors of {rest} hold near this fit only: they move with {held}."
        )
    if doubts:
        lines += ["", "Against trusting it", *(f"  {doubt}" for doubt in doubts)]
    if len(variant.names) > len(variant.verdicts):
        lines += [
            "",
            "Nuisances, under their priors",
            align(nuisance_rows(result, variant)),
        ]
    lines += [
        "",
        "Directions, best known first",
        *(f"  {d}" for d in variant.directions),
    ]
    lines += ["", "Correlation", align(correlation_rows(variant))]
    for found in variant.profiles.values():
        lines += [
            "",
            f"Profile of {found.name} (the others fitted again)",
            _profile(found),
        ]
    lines += ["", "Fit (predicted less measured)", align(target_rows(result, variant))]
    lines += ["", *statistics(result, variant), ""]
    lines += [starts_in_words(variant), align(start_rows(variant))]
    return lines


def parameter_rows(variant: VariantResult) -> list[tuple[str, ...]]:
    rows = [("parameter", "value", "standard error", "95 %", "lower", "upper")]
    for place, verdict in enumerate(variant.verdicts):
        error, within = "not determined", allowed_at_95(variant, verdict.name)
        if verdict.determined:
            error = standard_error_text(variant, place)
            within = "{:.4g} to {:.4g}".format(*interval(variant, place))
        rows.append(
            (
                verdict.name,
                f"{variant.parameters[place]:.5g}",
                error,
                within,
                f"{variant.bounds.lower[place]:g}",
                f"{variant.bounds.upper[place]:g}",
            )
        )
    return rows


def standard_error(variant: VariantResult, place: int) -> float:
    """In the unit of the unknown."""
    x = variant.bounds.coordinate(variant.parameters)
    slope = variant.bounds.slope(x)[place]
    return float(variant.uncertainty.standard_errors[place] * slope)


def interval(variant: VariantResult, place: int) -> tuple[float, float]:
    """The interval of 95 %: symmetric in x, and cut at the bounds."""
    bounds, uncertainty = variant.bounds, variant.uncertainty
    x = bounds.coordinate(variant.parameters)
    reach = uncertainty.quantile * uncertainty.standard_errors
    low = bounds.parameter(np.maximum(x - reach, bounds.low))
    high = bounds.parameter(np.minimum(x + reach, bounds.high))
    return float(low[place]), float(high[place])


def standard_error_text(variant: VariantResult, place: int) -> str:
    """With its share of the value where the parameter is positive."""
    text = f"{standard_error(variant, place):.3g}"
    if variant.bounds.logarithmic[place]:
        text += f" ({100 * variant.uncertainty.standard_errors[place]:.2g} %)"
    return text


def allowed_at_95(variant: VariantResult, name: str) -> str:
    """What a profile leaves of an undetermined parameter's range."""
    found = variant.profiles[name]
    if found.low_95 is None and found.high_95 is None:
        return "anything"
    if found.low_95 is None:
        return f"below {found.high_95:.3g}"
    if found.high_95 is None:
        return f"above {found.low_95:.3g}"
    return f"{found.low_95:.3g} to {found.high_95:.3g}"


def nuisance_rows(result: StudyResult, variant: VariantResult) -> list[tuple[str, ...]]:
    rows = [("nuisance", "value", "standard error", "prior")]
    first = len(variant.verdicts)
    priors = [n.prior for n in result.study.nuisances for _ in n.groups]
    for place, prior in enumerate(priors, first):
        rows.append(
            (
                variant.names[place],
                f"{variant.parameters[place]:.4g}",
                f"{standard_error(variant, place):.3g}",
                f"{prior.mean:g} +- {prior.sd:g}",
            )
        )
    return rows


def correlation_rows(variant: VariantResult) -> list[tuple[str, ...]]:
    names = [verdict.name for verdict in variant.verdicts]
    count = len(names)
    rows = [("", *names)]
    correlation = variant.uncertainty.correlation[:count, :count]
    for name, line in zip(names, correlation, strict=True):
        rows.append((name, *(f"{value:+.3f}" for value in line)))
    return rows


def _profile(found) -> str:
    rows = [("held at", "rise in standard deviations")]
    for value, rise in zip(found.values, found.rise, strict=True):
        rows.append((f"{value:.4g}", f"{np.sqrt(max(rise, 0.0)):.3g}"))
    return align(rows)


def target_rows(result: StudyResult, variant: VariantResult) -> list[tuple[str, ...]]:
    study = result.study
    limits = bool(np.any(study.known & (study.censored != 0)))
    rows = [("target", "rms", "max", "bias", "sigma")]
    rows[0] += ("limits broken",) if limits else ()
    parts = part_of_size(study, variant.sigma, variant.predicted)
    for place, name in enumerate(study.targets):
        values = fit_of_target(result, variant, place)
        sigma = variant.sigma[study.known[:, place], place]
        few = variant.uncertainty.degrees_of_freedom < LEAST_FREEDOM
        origin = "guessed" if few else "estimated"
        origin = "given" if study.sigma_given[place] else origin
        size = f"{np.median(sigma):.3g}"
        if study.proportional[place]:
            size = f"{100 * parts[place]:.3g} % of the value"
        text = f"{size} ({origin})"
        row = (name, *(_number(values[key]) for key in ("rms", "max", "bias")), text)
        rows.append((*row, str(values["limits_broken"])) if limits else row)
    return rows


def statistics(result: StudyResult, variant: VariantResult) -> list[str]:
    uncertainty = variant.uncertainty
    freedom, words = uncertainty.degrees_of_freedom, variant.reason.words
    lines = [
        f"Cost {variant.cost:.6g}, {freedom_text(freedom)} degrees of freedom. "
        f"{words[0].upper()}{words[1:]}."
    ]
    if np.all(result.study.sigma_given) and np.isfinite(uncertainty.reduced_chi_square):
        lines.append(f"Reduced chi-square {uncertainty.reduced_chi_square:.3g}.")
    if uncertainty.inflation > 1.0:
        lines.append(
            "The misfit is larger than the sigmas given allow: standard errors are "
            f"multiplied by {np.sqrt(uncertainty.inflation):.3g}."
        )
    if (
        not np.all(result.study.sigma_given)
        and uncertainty.degrees_of_freedom < LEAST_FREEDOM
    ):
        lines.append(TOO_FEW_FOR_SIGMA)
    if variant.failed:
        lines.append(f"{variant.failed} predictions could not be computed.")
    return lines


def freedom_text(freedom: float) -> str:
    """Degrees of freedom; what rounding leaves of none is none."""
    return f"{max(0.0, round(freedom, 2)):.3g}"


def starts_in_words(variant: VariantResult) -> str:
    """How many found the best fit."""
    found, total = int(np.sum(variant.reached)), len(variant.start_costs)
    anew = int(np.sum(variant.start_anew > 0))
    also = f"; {anew} were stuck and begun anew elsewhere" if anew else ""
    return f"{found} of {total} starts found the best fit{also}"


def start_rows(variant: VariantResult) -> list[tuple[str, ...]]:
    """The waterfall: starts of one cost and one reason in a row."""
    costs, reasons = variant.start_costs, variant.start_reasons
    names = [verdict.name for verdict in variant.verdicts]
    groups: list[list[int]] = []
    for place in np.lexsort(([r is Reason.joined for r in reasons], costs)):
        last = groups[-1][0] if groups else place
        alike = reasons[place] in (Reason.joined, reasons[last])
        if groups and alike and costs[place] <= costs[last] * (1.0 + ONE_ROW) + 1e-9:
            groups[-1].append(place)
        else:
            groups.append([place])
    rows = [("starts", "cost", *names, "steps", "stopped")]
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


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.4g}"

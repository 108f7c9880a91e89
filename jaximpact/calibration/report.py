"""The report of a study as text."""

import numpy as np

from ..align import align
from .study import StudyResult, VariantResult


def as_text(result: StudyResult) -> str:
    """The report: for each variant values, errors, verdicts, directions and fit."""
    study = result.study
    accuracy = f"accuracy {study.accuracy}, {study.starts} starts, seed {study.seed}"
    lines = [study.title, "=" * len(study.title), ""]
    lines += [f"Source: {study.source}"] if study.source else []
    lines += [study.notes] if study.notes else []
    lines += [
        f"{len(study.table.rows)} tests from {study.table.path.name}; fitted to "
        f"{', '.join(study.targets)}; {study.method}, {accuracy}.",
        _about_sigma(result),
    ]
    if len(result.variants) > 1:
        lines += ["", "Variants", *_side_by_side(result)]
    for variant in result.variants:
        lines += ["", *_variant(result, variant)]
    return "\n".join(lines) + "\n"


def _about_sigma(result: StudyResult) -> str:
    if result.study.sigma_given:
        return "Standard errors follow from the sigmas given."
    return (
        "No sigma is given: standard errors follow from the scatter about the fit, as "
        "if it were random."
    )


def fit_of_target(result: StudyResult, variant: VariantResult, place: int) -> dict:
    """Root mean square, largest and mean of predicted less measured."""
    difference = variant.predicted[:, place] - result.study.measured[:, place]
    known = difference[np.isfinite(difference)]
    if not len(known):
        return {"rms": None, "max": None, "bias": None}
    return {
        "rms": float(np.sqrt(np.mean(known**2))),
        "max": float(np.max(np.abs(known))),
        "bias": float(np.mean(known)),
    }


def _side_by_side(result: StudyResult) -> list[str]:
    study = result.study
    names = [parameter.name for parameter in study.parameters]
    rows = [("variant", *names, *(f"rms {t}" for t in study.targets), "cost")]
    for variant in result.variants:
        cells = [
            f"{value:.4g}" + ("" if verdict.determined else " (not determined)")
            for value, verdict in zip(variant.parameters, variant.verdicts, strict=True)
        ]
        errors = [
            _number(fit_of_target(result, variant, place)["rms"])
            for place in range(len(study.targets))
        ]
        rows.append((variant.variant.name, *cells, *errors, f"{variant.cost:.4g}"))
    return [align(rows)]


def _variant(result: StudyResult, variant: VariantResult) -> list[str]:
    title = variant.variant.name if len(result.variants) > 1 else "Fit"
    lines = [title, "-" * len(title), _parameters(variant)]
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
    lines += [
        "",
        "Directions, best known first",
        *(f"  {d}" for d in variant.directions),
    ]
    lines += ["", "Correlation", _correlation(variant)]
    for found in variant.profiles.values():
        lines += [
            "",
            f"Profile of {found.name} (the others fitted again)",
            _profile(found),
        ]
    lines += ["", "Fit (predicted less measured)", _targets(result, variant)]
    lines += ["", *_statistics(variant), "", "Starts, best first", _waterfall(variant)]
    return lines


def _parameters(variant: VariantResult) -> str:
    rows = [("parameter", "value", "standard error", "lower", "upper")]
    for place, verdict in enumerate(variant.verdicts):
        error = "not determined"
        if verdict.determined:
            error = standard_error_text(variant, place)
        rows.append(
            (
                verdict.name,
                f"{variant.parameters[place]:.5g}",
                error,
                f"{variant.bounds.lower[place]:g}",
                f"{variant.bounds.upper[place]:g}",
            )
        )
    return align(rows)


def standard_error(variant: VariantResult, place: int) -> float:
    """In the unit of the parameter."""
    error = variant.uncertainty.standard_errors[place]
    bounds = variant.bounds
    if bounds.logarithmic[place]:
        return float(error * variant.parameters[place])
    return float(error * (bounds.upper[place] - bounds.lower[place]) / 2.0)


def standard_error_text(variant: VariantResult, place: int) -> str:
    """With its share of the value where the parameter is positive."""
    text = f"{standard_error(variant, place):.3g}"
    if variant.bounds.logarithmic[place]:
        text += f" ({100 * variant.uncertainty.standard_errors[place]:.2g} %)"
    return text


def _correlation(variant: VariantResult) -> str:
    names = [verdict.name for verdict in variant.verdicts]
    rows = [("", *names)]
    for name, line in zip(names, variant.uncertainty.correlation, strict=True):
        rows.append((name, *(f"{value:+.3f}" for value in line)))
    return align(rows)


def _profile(found) -> str:
    rows = [("held at", "rise in standard deviations")]
    for value, rise in zip(found.values, found.rise, strict=True):
        rows.append((f"{value:.4g}", f"{np.sqrt(max(rise, 0.0)):.3g}"))
    return align(rows)


def _targets(result: StudyResult, variant: VariantResult) -> str:
    rows = [("target", "rms", "max", "bias")]
    for place, name in enumerate(result.study.targets):
        values = fit_of_target(result, variant, place)
        rows.append((name, *(_number(values[key]) for key in ("rms", "max", "bias"))))
    return align(rows)


def _statistics(variant: VariantResult) -> list[str]:
    uncertainty = variant.uncertainty
    lines = [
        f"Cost {variant.cost:.6g}, {uncertainty.degrees_of_freedom} degrees of "
        f"freedom, stopped: {variant.reason}."
    ]
    if uncertainty.variance_estimated:
        scale = np.sqrt(uncertainty.variance)
        lines.append(f"Scatter about the fit: {scale:.3g} nominal sigmas.")
    elif uncertainty.degrees_of_freedom > 0:
        lines.append(f"Reduced chi-square {uncertainty.reduced_chi_square:.3g}.")
    if variant.failed:
        lines.append(f"{variant.failed} predictions could not be computed.")
    return lines


def _waterfall(variant: VariantResult) -> str:
    rows = [("start", "cost", "steps", "stopped")]
    for place in np.argsort(variant.start_costs, kind="stable"):
        label = "1 (given)" if place == 0 else str(place + 1)
        rows.append(
            (
                label,
                f"{variant.start_costs[place]:.6g}",
                str(variant.start_steps[place]),
                variant.start_reasons[place],
            )
        )
    return align(rows)


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.4g}"

"""Words of the report on parameters: identifiable ones, intervals, posterior."""

import itertools

import numpy as np

from ...io.display import Rows
from ...quantities import columns_of
from ..diagnostics.examination import Examination, not_described
from ..diagnostics.identifiability import LikelihoodProfile, interval_text
from ..diagnostics.nuts import compare_errors
from ..diagnostics.posterior import Draws
from ..diagnostics.results import StudyResult, VariantResult
from ..diagnostics.uncertainty import USELESS_ERROR

AGREE = 1.01
"""R-hat up to which chains agree."""
NEARLY_NORMAL = 0.7
"""Effective sample size, as a fraction, above which the posterior is nearly normal."""
LEAST_CORRELATION = 0.1
"""Correlations below are left out of the summary."""
NOT_IDENTIFIABLE = "not identifiable"


def verdict(result: StudyResult, variant: VariantResult) -> list[str]:
    """List which parameters are identifiable, with their intervals, and which not;
    first of all what the model does not describe."""
    known, unknown = [], []
    for index, of_one in enumerate(variant.verdicts):
        if of_one.determined:
            low, high = variant.interval(index)
            known.append(
                f"{of_one.name} = {variant.parameters[index]:.3g} "
                f"(95 %: {low:.3g} to {high:.3g})"
            )
        else:
            unknown.append(
                f"{of_one.name} is not identifiable from these tests: {of_one.reason}."
            )
    name = f"{variant.variant.name}: " if len(result.variants) > 1 else ""
    first = "No parameter is identifiable by itself."
    if known:
        first = f"The tests identify {', '.join(known)}."
    if missed := not_described(result, variant):
        first = (
            f"The model does not describe {' and '.join(missed)}; its parameters mean "
            f"little. {first}"
        )
    lines = [name + first]
    lines += unknown
    if unknown and variant.uncertainty.eigenvalues[-1] * USELESS_ERROR**2 > 1.0:
        lines.append(f"Best identifiable combination: {variant.directions[0]}.")
    elif unknown:
        lines.append("No combination of them is identifiable either.")
    if unknown and known:
        fixed = ", ".join(v.name for v in variant.verdicts if not v.determined)
        lines.append(
            "The standard errors of the others hold near this fit only: they depend on "
            f"{fixed}."
        )
    return lines


def parameter_rows(variant: VariantResult) -> Rows:
    """Write the parameters with standard errors and intervals."""
    columns = columns_of(variant.objective.scene)
    rows: Rows = [
        (
            *("parameter", "unit", "value", "standard error", "95 %"),
            *("profile, 68 %", "profile, 95 %", "lower", "upper"),
        )
    ]
    for index, of_one in enumerate(variant.verdicts):
        profile = variant.profiles[of_one.name]
        ends_95 = interval_text(profile.low_95, profile.high_95)
        error, within = NOT_IDENTIFIABLE, ends_95
        if of_one.determined:
            error = f"{variant.standard_error(index):.3g}"
            if variant.bounds.logarithmic[index]:
                relative = 100 * variant.uncertainty.standard_errors[index]
                error += f" ({relative:.2g} %)"
            within = "{:.4g} to {:.4g}".format(*variant.interval(index))
        rows.append(
            (
                of_one.name,
                columns[of_one.name].unit,
                f"{variant.parameters[index]:.5g}",
                error,
                within,
                interval_text(profile.low, profile.high),
                ends_95,
                f"{variant.bounds.lower[index]:g}",
                f"{variant.bounds.upper[index]:g}",
            )
        )
    return rows


def parameters_short(variant: VariantResult) -> Rows:
    """Write the parameters with their bounds in one column, a reached one marked."""
    x = variant.bounds.coordinate(variant.parameters)
    head, *rows = parameter_rows(variant)
    short: Rows = [(*head[:5], "bounds")]
    for row, at in zip(rows, variant.bounds.bound_reached(x), strict=False):
        hit = f" (at the {at})" if at else ""
        short.append((*row[:5], f"{row[-2]} to {row[-1]}{hit}"))
    return short


def nuisance_rows(variant: VariantResult) -> Rows:
    """Write the nuisance parameters; no rows where there are none."""
    first = len(variant.verdicts)
    nuisances = [n for n in variant.objective.study.nuisances for _ in n.groups]
    if not nuisances:
        return []
    return [("nuisance", "value", "standard error", "prior")] + [
        (
            variant.names[index],
            f"{variant.parameters[index]:.4g}",
            f"{variant.standard_error(index):.3g}",
            f"{n.prior.mean:g} +- {n.prior.sd:.4g}",
        )
        for index, n in enumerate(nuisances, first)
    ]


def profile_rows(found: LikelihoodProfile) -> Rows:
    """Write a profile of the likelihood."""
    roots = np.sqrt(np.maximum(found.rise, 0.0))
    return [("fixed at", "root of twice the rise of the cost")] + [
        (f"{value:.4g}", f"{root:.3g}")
        for value, root in zip(found.values, roots, strict=True)
    ]


def correlation_rows(variant: VariantResult) -> Rows:
    """Write the correlation matrix of the parameters."""
    names = [of_one.name for of_one in variant.verdicts]
    count = len(names)
    lines = variant.uncertainty.correlation[:count, :count]
    return [("", *names)] + [
        (name, *(f"{value:+.3f}" for value in line))
        for name, line in zip(names, lines, strict=True)
    ]


def correlations_short(variant: VariantResult) -> Rows:
    """Write the correlated pairs, the most correlated first."""
    names = [of_one.name for of_one in variant.verdicts]
    found = [
        (float(variant.uncertainty.correlation[a, b]), names[a], names[b])
        for a, b in itertools.combinations(range(len(names)), 2)
    ]
    found.sort(key=lambda pair: -abs(pair[0]))
    rows = [
        (f"{a}, {b}", f"{value:+.3f}")
        for value, a, b in found
        if abs(value) >= LEAST_CORRELATION
    ]
    return [("parameters", "correlation"), *rows] if rows else []


def about_draws(result: StudyResult, variant: VariantResult, draws: Draws) -> str:
    """Say how normal the posterior is, by the effective sample size of the draws."""
    first, last = draws.effective_fraction[0], draws.effective_fraction[-1]
    unknown = [v.name for v in variant.verdicts if not v.determined]
    rounds, count = len(draws.effective_fraction), len(draws.x)
    words = (
        f"Importance sampling: effective sample size {100 * first:.0f} % of "
        f"{count // rounds} draws. "
    )
    if variant.errors_of_draws:
        words += "Standard errors are those of these draws, not of derivatives."
    elif first >= NEARLY_NORMAL and unknown:
        # Draws lie between the bounds, so that one cut off there may keep its weights.
        words += (
            "Importance weights cannot detect bounds that also truncate the posterior: "
            f"rely on the verdict for {', '.join(unknown)}, and on the draws rather "
            "than on standard errors for the other parameters."
        )
    elif first >= NEARLY_NORMAL:
        words += "The posterior is nearly normal: standard errors describe it."
    else:
        words += (
            "The posterior is not normal: rely on the draws rather than on standard "
            "errors."
        )
    if rounds > 1:
        words += f" After adapting the proposal: {100 * last:.0f} % of {count}."
    if not np.all(result.study.sigma_given):
        words += (
            " The draws take the estimated scatter of a target as constant, or as a "
            "constant fraction of the value; standard errors from many measurements do "
            "not."
        )
    return f"{words} {_accuracy(draws)}"


def _accuracy(of: Draws) -> str:
    return (
        f"Impacts at {of.accuracy.name}; computed again more accurately, costs "
        f"differed by at most {of.error:.1g}."
    )


def about_posterior(variant: VariantResult, diagnostics: Examination) -> dict:
    """Collect what the samples by NUTS say."""
    samples = diagnostics.samples
    assert samples is not None
    assert samples.chains is not None
    told, parameters = samples.chains, variant.bounds.parameter(samples.x)
    rows: Rows = [
        ("parameter", "mean", "median", "95 %", "R-hat", "effective sample size")
    ]
    for index, verdict in enumerate(variant.verdicts):
        values = parameters[:, index]
        low, middle, high = np.quantile(values, (0.025, 0.5, 0.975))
        rows.append(
            (
                verdict.name,
                f"{np.mean(values):.4g}",
                f"{middle:.4g}",
                f"{low:.4g} to {high:.4g}",
                f"{told.scale_reduction[index]:.3f}",
                f"{told.effective[index]:.0f}",
            )
        )
    chains, count = told.statistics["lp"].shape
    words = (
        f"{chains} chains of {count} draws by NUTS. Without a prior of the study the "
        "prior is uniform in the logarithm between the bounds; intervals of parameters "
        "that are not identifiable are those of the bounds."
    )
    divergent = int(np.sum(told.statistics["diverging"]))
    if divergent:
        words += (
            f" {divergent} draws diverged, as at a change of outcome: the posterior "
            "beyond may be missed."
        )
    if np.max(told.scale_reduction) > AGREE:
        words += f" The chains do not agree (R-hat above {AGREE}): sample more."
    comparison = compare_errors(variant, diagnostics.draws, samples)
    words = f"{words} {_accuracy(samples)}"
    return {"rows": rows, "words": words, "comparison": comparison}

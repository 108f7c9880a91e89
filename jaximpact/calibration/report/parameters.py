"""What the report says of parameters: identifiable ones, intervals, posterior."""

import itertools

import numpy as np

from ...quantities import columns_of
from ...reports.document import Part
from ...reports.tables import Table
from ..diagnostics.examination import Examination, not_described
from ..diagnostics.identifiability import interval_text
from ..diagnostics.nuts import compare_errors
from ..diagnostics.posterior import Draws
from ..diagnostics.residuals import Residuals
from ..diagnostics.results import StudyResult, VariantResult
from ..diagnostics.uncertainty import USELESS_ERROR

NEARLY_NORMAL = 0.7
"""Effective sample size, as a fraction, above which the posterior is nearly normal."""


MUCH_LARGER = 4.0
"""Reduced chi-square of given sigmas from which a verdict begins with the misfit:
sigmas that are off by a factor of two are common."""


def verdict(
    result: StudyResult, variant: VariantResult, residuals: Residuals
) -> list[str]:
    """List which parameters are identifiable, with their intervals, and which not;
    first of all what the model misses."""
    known, unknown, contradicted = [], [], []
    for index, of_one in enumerate(variant.verdicts):
        if of_one.determined:
            low, high = variant.interval(index)
            known.append(
                f"{of_one.name} = {variant.parameters[index]:.3g} "
                f"(95 %: {low:.3g} to {high:.3g})"
            )
        elif of_one.contradicted:
            contradicted.append(f"{of_one.name} is not determined: {of_one.reason}.")
        else:
            unknown.append(
                f"{of_one.name} is not identifiable from these tests: {of_one.reason}."
            )
    name = f"{variant.variant.name}: " if len(result.variants) > 1 else ""
    missed, little = _missed(result, variant, residuals)
    first = "No parameter is identifiable by itself."
    if contradicted and not unknown:
        first = "Tests and priors contradict each other."
    if known:
        first = f"The tests identify {', '.join(known)}."
        if missed:
            first = (
                "So the model, the shape of the blocks or the data are wrong "
                "somewhere, and the intervals do not include that error. Best fit all "
                f"the same: {', '.join(known)}."
            )
        elif little:
            first = (
                f"If that is scatter of the tests, they identify {', '.join(known)}."
            )
    lines = [name + " ".join((*missed, *little, first)), *contradicted, *unknown]
    if unknown and variant.uncertainty.eigenvalues[-1] * USELESS_ERROR**2 > 1.0:
        lines.append(f"Best identifiable combination: {variant.directions[0]}.")
    elif unknown:
        lines.append("No combination of them is identifiable either.")
    if (unknown or contradicted) and known:
        fixed = ", ".join(v.name for v in variant.verdicts if not v.determined)
        lines.append(
            "The standard errors of the others hold near this fit only: they depend on "
            f"{fixed}."
        )
    return lines


def _missed(
    result: StudyResult, variant: VariantResult, residuals: Residuals
) -> tuple[list[str], list[str]]:
    """Say what the fit misses (biases, targets that it does not describe, trends, and a
    misfit far above the given sigmas) and of which targets it explains little, in a
    sentence each."""
    sentences = []
    missed, little = not_described(result, variant)
    if biased := residuals.biased:
        words = "; ".join(bias.words for bias in biased)
        sentences.append(f"{words[0].upper()}{words[1:]}.")
    if missed:
        sentences.append(f"The model does not describe {' and '.join(missed)}.")
    missed += [bias.target for bias in biased]
    little = [name for name in little if name not in missed]
    trends = dict.fromkeys(trend.target for trend in residuals.trends)
    if trends := [target for target in trends if target not in missed]:
        sentences.append(
            f"The residuals of {' and '.join(trends)} are not random: they follow "
            "inputs or the prediction."
        )
    uncertainty = variant.uncertainty
    if uncertainty.inflation > MUCH_LARGER:
        sentences.append(
            f"The misfit is {np.sqrt(uncertainty.inflation):.2g} times as large as the "
            "given sigmas allow (reduced chi-square "
            f"{uncertainty.reduced_chi_square:.3g})."
        )
    of_little = [
        f"The fit explains less than half of the variance of {' and '.join(little)}."
    ]
    return sentences, of_little if little else []


def parameter_table(variant: VariantResult) -> Table:
    """Write the parameters with standard errors and intervals."""
    columns, rows = columns_of(variant.objective.scene), []
    reached = variant.bounds.bound_reached(
        variant.bounds.coordinate(variant.parameters)
    )
    for index, of_one in enumerate(variant.verdicts):
        profile = variant.profiles[of_one.name]
        ends_95 = interval_text(profile.low_95, profile.high_95)
        error, within = "not identifiable", ends_95
        if of_one.determined:
            error = f"{variant.standard_error(index):.3g}"
            if variant.bounds.logarithmic[index]:
                relative = 100 * variant.uncertainty.standard_errors[index]
                error += f" ({relative:.2g} %)"
            within = "{:.4g} to {:.4g}".format(*variant.interval(index))
        hit = f" (at the {reached[index]})" if reached[index] else ""
        bounds = f"{variant.bounds.lower[index]:g} to {variant.bounds.upper[index]:g}"
        first = of_one.name, columns[of_one.name].unit, variant.parameters[index]
        rows.append((*first, error, within, bounds + hit))
    study = variant.objective.study
    fitted = dict(zip(variant.names, variant.parameters, strict=True))
    for tied in study.tied:
        value = float(tied.evaluate(fitted))
        unit = columns[tied.name].unit
        rows.append((tied.name, unit, value, f"tied: {tied.text}", "-", "-"))
    head = ("parameter", "unit", "value", "standard error", "95 %", "bounds")
    return Table(head, rows)


def interval_table(variant: VariantResult) -> Table:
    """Write the intervals of the profiles beside those of the standard errors."""
    rows = []
    for index, of_one in enumerate(variant.verdicts):
        profile = variant.profiles[of_one.name]
        of_error = "not identifiable"
        if of_one.determined:
            of_error = "{:.4g} to {:.4g}".format(*variant.interval_of_error(index))
        of_profile = (
            interval_text(profile.low, profile.high),
            interval_text(profile.low_95, profile.high_95),
        )
        rows.append((of_one.name, *of_profile, of_error))
    head = ("parameter", "profile, 68 %", "profile, 95 %", "standard error, 95 %")
    return Table(head, rows)


def nuisance_table(variant: VariantResult) -> Table:
    """Write the nuisance parameters; no rows where there are none."""
    nuisances = [n for n in variant.objective.study.nuisances for _ in n.groups]
    rows = [
        (
            variant.names[index],
            variant.parameters[index],
            variant.standard_error(index),
            f"{n.prior.mean:g} +- {n.prior.sd:.4g}",
        )
        for index, n in enumerate(nuisances, len(variant.verdicts))
    ]
    return Table(("nuisance", "value", "standard error", "prior"), rows)


def correlation_table(variant: VariantResult) -> Table:
    """Write the correlation matrix of the parameters."""
    names = [of_one.name for of_one in variant.verdicts]
    lines = variant.uncertainty.correlation[: len(names), : len(names)]
    rows = [
        (name, *(f"{value:+.3f}" for value in line))
        for name, line in zip(names, lines, strict=True)
    ]
    return Table(("", *names), rows)


def correlated_pairs(variant: VariantResult) -> Table:
    """Write the correlated pairs, the most correlated first."""
    names = [of_one.name for of_one in variant.verdicts]
    pairs = [
        (f"{names[a]}, {names[b]}", float(variant.uncertainty.correlation[a, b]))
        for a, b in itertools.combinations(range(len(names)), 2)
    ]
    pairs.sort(key=lambda pair: -abs(pair[1]))
    rows = [(pair, f"{value:+.3f}") for pair, value in pairs if abs(value) >= 0.1]
    return Table(("parameters", "correlation"), rows)


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
    if not result.study.is_likelihood:
        words += (
            " Weights of targets, or the loss, make draws scatter otherwise than the "
            "fit: they are moved to the covariance of the standard errors."
        )
    return f"{words} {_accuracy(draws)}"


def _accuracy(draws: Draws) -> str:
    return (
        f"Impacts at {draws.accuracy.name}; computed again more accurately, costs "
        f"differed by at most {draws.error:.1g}."
    )


def about_posterior(variant: VariantResult, diagnostics: Examination) -> list[Part]:
    """Say what the samples by NUTS tell, if there are any."""
    samples = diagnostics.samples
    if samples is None or samples.chains is None:
        return []
    chains, values = samples.chains, variant.bounds.parameter(samples.x)
    rows = []
    for index, verdict in enumerate(variant.verdicts):
        low, middle, high = np.quantile(values[:, index], (0.025, 0.5, 0.975))
        rows.append(
            (
                verdict.name,
                float(np.mean(values[:, index])),
                middle,
                f"{low:.4g} to {high:.4g}",
                f"{chains.scale_reduction[index]:.3f}",
                f"{chains.effective[index]:.0f}",
            )
        )
    number, count = chains.statistics["lp"].shape
    words = (
        f"{number} chains of {count} draws by NUTS. Without a prior of the study the "
        "prior is uniform in the logarithm between the bounds; intervals of parameters "
        "that are not identifiable are those of the bounds."
    )
    divergent = int(np.sum(chains.statistics["diverging"]))
    if divergent:
        words += (
            f" {divergent} draws diverged, as at a change of outcome: the posterior "
            "beyond may be missed."
        )
    if np.max(chains.scale_reduction) > 1.01:  # Vehtari et al. 2021
        words += " The chains do not agree (R-hat above 1.01): sample more."
    columns = ("parameter", "mean", "median", "95 %", "R-hat", "effective sample size")
    return [
        Table(columns, rows),
        f"{words} {_accuracy(samples)}",
        compare_errors(variant, diagnostics.draws, samples),
    ]

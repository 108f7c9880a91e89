"""Diagnostics of a fit, and the warnings that follow from them."""

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.special import chdtr

from ...impact.events import TIME_LIMIT
from ...progress import Progress, ProgressFunction, reporting_to, tell, within
from ...quantities import CURVE_COLUMNS, TIME_COLUMN
from ...scene import GRAVITY
from ..estimation.evolution import AGREED
from ..estimation.sigma import (
    IMPROBABLE,
    LEAST_FREEDOM,
    LEAST_PART,
    freedom_of_targets,
    median_sigma,
    sigma_factors,
)
from ..problem.config import Study
from ..problem.forward_model import for_each_variant
from .cross_validation import LeftOut, leave_out_campaigns, leave_out_each
from .cross_validation import in_words as cross_validation_in_words
from .discrepancy import Discrepancy, estimate_discrepancy
from .further_tests import Suggestions, suggest_tests
from .importance_sampling import COUNT, check, stretched, weights_of
from .jumps import MOST_NAMED, without_jumps
from .jumps import in_words as jumps_in_words
from .nuts import sample_posterior
from .posterior import FEWEST as FEWEST_DRAWS
from .posterior import Draws
from .predictive import Bands, bands_of
from .residuals import Residuals, residuals_of, rms, varying_inputs
from .results import StudyResult, VariantResult
from .scatter import doubtful_scatter
from .uncertainty import stretch

WORSE = 1.1
"""Ratio of the rms error and the scatter about the mean above which a fit is worse than
the mean: for repeated impacts it is that scatter itself."""
FEWEST = 3
"""Least number of measurements whose scatter about their mean is a standard."""
ANGLES = {"angle_deg": np.pi / 2, "orientation_deg": np.pi}
"""Columns in degrees, and the largest value that they would have in radians."""
RATIOS = ("e_n", "e_t", "e_contact", "e_bar")
"""Results half of whose measurements do not exceed 2."""
DEPTHS = (
    "max_penetration_m",
    "max_sinking_m",
    "final_penetration_m",
    "final_sinking_m",
)

NORMAL_FORCES = ("max_normal_force_N", "normal_force_N")
LEAST_FORCE = 0.5
"""Part of the weight of a block that the largest normal force of an impact exceeds."""


class Examination(NamedTuple):
    """Diagnostics of the fit of one variant."""

    residuals: Residuals
    draws: Draws
    """Draws by importance sampling."""
    bands: Bands
    each: LeftOut | None
    """Cross-validation test by test; None for a study of one test."""
    campaigns: LeftOut | None
    """Cross-validation campaign by campaign; None where there is only one."""
    discrepancy: Discrepancy | None
    """Error of the model outside the fitted tests; None where it is unknown."""
    single: Suggestions
    """Further tests that measure one result each."""
    together: Suggestions
    """Further tests that measure all results."""
    posterior: Draws
    """Draws of bands and predictions: those by NUTS where enough are independent."""
    weights: np.ndarray
    """Weights of these draws with every estimated sigma left uncertain."""
    samples: Draws | None = None
    """Draws by NUTS, where asked for."""


def examine(
    result: StudyResult,
    *,
    posterior: bool = False,
    progress: Progress | ProgressFunction | None = None,
) -> list[Examination]:
    """Compute the diagnostics of every variant.

    Args:
        posterior: whether to sample the posterior by NUTS too.
    """

    def examined(variant: VariantResult) -> Examination:
        name = variant.variant.name
        with within(f"{name}: " if len(result.variants) > 1 else ""):
            return _examine(result, variant, posterior)

    models = [variant.objective.model for variant in result.variants]
    with reporting_to(progress):
        return for_each_variant(models, examined, result.variants)


def _examine(
    result: StudyResult, variant: VariantResult, posterior: bool
) -> Examination:
    study, objective, points = result.study, variant.objective, variant.points
    inflation = variant.uncertainty.inflation
    draws = check(variant.draws, objective, inflation)
    fit, each = (objective, points, variant.uncertainty), None
    if np.sum(np.any(study.known, axis=1)) > 1:
        each = leave_out_each(*fit)
    order = np.argsort(variant.end_costs, kind="stable")
    ends = variant.bounds.coordinate(variant.end_parameters[order])
    campaigns = leave_out_campaigns(*fit, ends)
    tell("further tests")
    wanted = study.candidates
    suggested = partial(
        suggest_tests,
        *(variant, wanted.axes, wanted.measure),
        count=wanted.count,
        criterion=wanted.criterion,
    )
    single, together = suggested(), suggested(together=True)
    samples = None
    if posterior:
        samples = sample_posterior(variant, seed=study.seed, draws=draws)
    weights = weights_of(objective, points, _best(draws, samples))
    smooth = without_jumps(objective, variant.jumps)
    matrix = stretch(smooth, smooth.reevaluate(points), inflation)
    draws = stretched(draws, objective, points, matrix)
    if samples is not None:
        samples = stretched(samples, objective, points, matrix)
    best = _best(draws, samples)
    # As predictions take it
    estimated = np.maximum(freedom_of_targets(objective, points), 1.0)
    freedom = np.where(study.sigma_given, np.inf, estimated)
    return Examination(
        residuals=residuals_of(objective, points, inflation),
        draws=draws,
        posterior=best,
        weights=weights,
        bands=bands_of(objective, best, inflation, weights, freedom),
        each=each,
        campaigns=campaigns,
        discrepancy=estimate_discrepancy(*fit),
        single=single,
        together=together,
        samples=samples,
    )


def _best(draws: Draws, samples: Draws | None) -> Draws:
    """Choose the draws by NUTS where enough of them are independent."""
    return samples.thinned(COUNT) if samples and samples.trusted else draws


def fit_of_target(result: StudyResult, variant: VariantResult, target: int) -> dict:
    """Compute rms, largest and mean of predicted less measured, of exact measurements,
    and the number of limits that the prediction violates."""
    study = result.study
    difference = variant.predicted[:, target] - study.measured[:, target]
    censored = study.censored[:, target]
    known = difference[np.isfinite(difference) & (censored == 0)]
    errors: dict = {"rms": rms(known), "max": None, "bias": None}
    if len(known):
        most = np.max(np.abs(known))
        errors |= {"max": float(most), "bias": float(np.mean(known))}
    broken = (censored != 0) & (difference * censored < 0.0)
    return errors | {"limits_broken": int(np.sum(broken))}


def freedom_text(freedom: float) -> str:
    """Write degrees of freedom; a remainder of rounding is 0."""
    return f"{max(0.0, round(freedom, 2)):.3g}"


def warnings_of(
    result: StudyResult, variant: VariantResult, diagnostics: Examination
) -> list[str]:
    """List the reasons, if any, not to trust a fit and its errors."""
    lines = doubtful_units(result.study)
    if not variant.reason.at_minimum:
        lines.append(f"The best fit is no minimum: {variant.reason}.")
    for target, name in enumerate(result.study.targets):
        lines += _large_misfit(result, variant, target, name) or worse_than_mean(
            result.study, diagnostics.each, target
        )
    trends = diagnostics.residuals.trends
    biased = dict.fromkeys(trend.target for trend in trends)
    lines += doubtful_scatter(variant.objective, variant.points, biased)
    lines += [
        f"{bias.target} is biased (p-value {bias.chance:.1g}): find a law without that "
        "bias (--compare), or check the shape of the blocks, the sensor and the unit."
        for bias in diagnostics.residuals.biased
    ]
    lines += _doubtful_errors(result.study, variant)
    for target in biased:
        against = [trend.against for trend in trends if trend.target == target]
        lines.append(
            f"The residuals of {target} depend on {' and '.join(against)}: the model "
            "is biased, and errors that take the misfit as random are too small."
        )
    for what, left in (("test", diagnostics.each), ("campaign", diagnostics.campaigns)):
        words = cross_validation_in_words(left, variant.objective, what) if left else []
        lines += [line for line in words if "fewer than chance" in line]
    lines += jumps_in_words(variant, diagnostics.each)
    lines += _doubtful_draws(diagnostics)
    if variant.found_later:
        lines.append(
            "The search did not find the best fit, which was found later: there may be "
            "a better one."
        )
    if variant.agreed < AGREED * variant.members:
        lines.append(
            f"Only {variant.agreed} of {variant.members} members of the search came to "
            "one place: there may be a better fit."
        )
    if variant.failed:
        lines.append(f"{variant.failed} predictions could not be computed.")
    return lines


def limits_alone(study: Study) -> np.ndarray:
    """Find the targets whose sigma is not given and of which only limits are known,
    shape (targets,)."""
    return ~study.sigma_given & ~np.any(study.exact, axis=0)


def _doubtful_errors(study: Study, variant: VariantResult) -> list[str]:
    """Warn of a misfit above or far below the given sigmas, of few tests, and of tests
    that count twice."""
    uncertainty, lines = variant.uncertainty, study.tests.repeated_in_words()
    if uncertainty.inflation > 1.0:
        lines.append(
            "The misfit is larger than the given sigmas allow. Standard errors are "
            f"multiplied by {np.sqrt(uncertainty.inflation):.3g}, which is right only "
            "if the misfit is random."
        )
    for name, factor in sigma_factors(variant.objective).items():
        lines.append(
            f"The misfit of {name} is larger than its given sigmas allow. They are "
            f"multiplied by {factor:.3g}, which is right only if the misfit is random."
        )
    freedom, reduced = uncertainty.degrees_of_freedom, uncertainty.reduced_chi_square
    if np.all(study.sigma_given) and chdtr(freedom, reduced * freedom) < IMPROBABLE:
        lines.append(
            "The misfit is far smaller than the given sigmas (reduced chi-square "
            f"{reduced:.2g}). If tests scatter independently, the sigmas are too "
            "large, and so are the standard errors."
        )
    if freedom < 3.0:
        lines.append(
            f"{freedom_text(freedom)} degrees of freedom are left: too few to judge "
            "how good the fit is."
        )
    limits = limits_alone(study)
    for target in np.flatnonzero(limits):
        name = study.targets[target]
        guess = median_sigma(study, variant.sigma)[target]
        lines.append(
            f"Of {name} only limits are known, and limits show no scatter: its sigma, "
            f"{guess:.3g}, is a guess, from which standard errors and intervals "
            f"follow. State it, as sigma_{name} in the table or as default_sigma."
        )
    if freedom < LEAST_FREEDOM and not np.all(study.sigma_given | limits):
        lines.append(
            "There are too few measurements to estimate their errors: standard errors "
            "follow from the nominal sigmas, a guess."
        )
    return lines


def _doubtful_draws(diagnostics: Examination) -> list[str]:
    """Warn of a small effective sample size and of costs that are too inaccurate."""
    lines = []
    if not diagnostics.posterior.trusted:
        lines.append(
            f"The effective sample size of the draws is below {FEWEST_DRAWS}: the "
            "bands are inaccurate. Sample the posterior instead (--posterior)."
        )
    for what, subject in (
        (diagnostics.posterior, "bands are"),
        (diagnostics.samples, "posterior is"),
    ):
        if what is not None and what.rough:
            lines.append(
                f"At the accuracy {what.accuracy.name} costs have errors of up to "
                f"{what.error:.2g}, too large for these sigmas. The {subject} "
                "inaccurate."
            )
    return lines


def doubtful_units(study: Study) -> list[str]:
    """Warn of columns whose values look like another unit than their name says."""
    lines = []
    for name, most in ANGLES.items():
        values = study.tests.inputs.get(name, np.zeros(1))
        whole = np.all(values == np.round(values))
        if np.max(np.abs(values)) <= most and not whole:
            lines.append(
                f"{name} is between {np.min(values):.3g} and {np.max(values):.3g} in "
                "all tests, and is read as degrees: are these radians?"
            )
    # A limit below which the value lies is no sign of a large one.
    large = np.where(study.censored < 0, np.nan, study.measured)
    by_name = dict(zip(study.targets, large.T, strict=True))
    for name, values in by_name.items():
        middle = _median(values)
        if name in RATIOS and middle > 2.0:
            lines.append(
                f"Half of the measurements of {name} are above {middle:.3g}, and are "
                "read as ratios: are these per cent?"
            )
    e_n = by_name.get("e_n", np.zeros(1))
    above = np.flatnonzero(e_n > 1.0)
    if len(above) and not _median(e_n) > 2.0:
        names = ", ".join(study.tests.names_apart(above[:MOST_NAMED]))
        more = f" and {len(above) - MOST_NAMED} more" * (len(above) > MOST_NAMED)
        lines.append(
            f"e_n is above 1 in {names}{more}: only an elongated or a spinning block "
            "can leave the ground faster than it came. Is the speed before right?"
        )
    times = study.tests.times[np.isfinite(study.tests.times)]
    if len(times) and np.median(times) > TIME_LIMIT:
        lines.append(
            f"Half of the times in {TIME_COLUMN} are above {np.median(times):.3g}, and "
            "are read as seconds, but no contact of the model is longer than "
            f"{TIME_LIMIT:g} s: are these milliseconds?"
        )
    block = study.scene_of(study.variants[0]).block
    weight = GRAVITY * np.asarray(block.mass)
    for name in (name for name in study.targets if name in NORMAL_FORCES):
        exact = study.exact[:, study.targets.index(name)]
        forces = study.tests.measured[name] / weight
        largest = np.max(forces, where=exact, initial=-np.inf)
        least = np.min(forces, where=exact, initial=np.inf)
        if not np.any(exact) or largest >= LEAST_FORCE:
            continue
        if least < -LEAST_FORCE:
            lines.append(
                f"No measurement of {name} is above {LEAST_FORCE:g} times the weight "
                f"of the block, which would not stop it, but one is {least:.3g} times: "
                "a force that pushes the block out of the ground is positive; is the "
                "sign another?"
            )
        else:
            lines.append(
                f"No measurement of {name} is above {largest:.3g} times the weight of "
                "the block, which would not stop it, and they are read as newtons: are "
                "these kilonewtons?"
            )
    diameter = 2.0 * np.cbrt(np.prod(np.asarray(block.semi_axes), axis=0))
    for name in (name for name in study.targets if name in DEPTHS):
        middle = _median(by_name[name] / diameter)
        if middle > 10.0:
            lines.append(
                f"Half of the measurements of {name} are above {middle:.3g} diameters "
                "of the block, and are read as metres: are these millimetres or "
                "centimetres, or is mass_kg in tonnes?"
            )
    return lines


def _median(values: np.ndarray) -> float:
    """Compute the median of what is not NaN; 0 of nothing."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else 0.0


class _Misfit(NamedTuple):
    """Errors of the fit of one target, beside the scatter of its measurements."""

    rms: float
    of_mean: float
    """Standard deviation of the measurements."""
    sigma: float
    """Standard deviation of their errors, given or estimated."""
    least: float
    """Estimate below which there are no errors."""
    stated: bool

    @property
    def is_no_fit(self) -> bool:
        """Whether the mean of the measurements would fit them better."""
        least = self.sigma if self.stated else self.least
        return self.rms > max(WORSE * self.of_mean, least)

    @property
    def explains_little(self) -> bool:
        """Whether the scatter that is estimated is more than half of the variance of
        the measurements."""
        half = np.sqrt(0.5) * self.of_mean
        return not self.stated and self.sigma > max(half, self.least)


def _misfit(result: StudyResult, variant: VariantResult, place: int) -> _Misfit | None:
    """Compute the misfit of a target; None where it has too few measurements."""
    study = result.study
    exact = study.exact[:, place]
    rms = fit_of_target(result, variant, place)["rms"]
    if np.sum(exact) < FEWEST or rms is None:
        return None
    measured = study.measured[exact, place]
    sigma = float(np.median(variant.sigma[exact, place]))
    if variant.objective.study.proportional[place]:
        sigma = float(np.sqrt(np.mean(variant.sigma[exact, place] ** 2)))
    least = _least_error(measured)
    stated = bool(study.sigma_given[place])
    return _Misfit(rms, float(np.std(measured)), sigma, least, stated)


def _least_error(measured: np.ndarray) -> float:
    """Compute the error of measurements below which there is none."""
    return LEAST_PART * float(np.sqrt(np.mean(measured**2)))


def not_described(
    result: StudyResult, variant: VariantResult
) -> tuple[list[str], list[str]]:
    """List the targets that their mean would fit better than the model does, and those
    of which the fit explains less than half of the variance: none of repeated tests, of
    which all variance is scatter."""
    misfits = [_misfit(result, variant, t) for t in range(len(result.study.targets))]
    named = [*zip(result.study.targets, misfits, strict=True)]
    missed = [name for name, misfit in named if misfit and misfit.is_no_fit]
    if not varying_inputs(variant.objective):
        return missed, []
    little = [name for name, misfit in named if misfit and misfit.explains_little]
    return missed, [name for name in little if name not in missed]


def _large_misfit(
    result: StudyResult, variant: VariantResult, place: int, name: str
) -> list[str]:
    misfit = _misfit(result, variant, place)
    if misfit is None:
        return []
    if misfit.is_no_fit:
        return [
            f"R2 of {name} is below 0: the rms error of the fit is {misfit.rms:.3g}, "
            f"the standard deviation of the measurements {misfit.of_mean:.3g}. The "
            "model does not describe them, or inputs or units are wrong."
        ]
    if not misfit.stated and misfit.sigma > max(0.5 * misfit.of_mean, misfit.least):
        proportional = variant.objective.study.proportional
        mean = " on average" if proportional[place] else ""
        return [
            f"The scatter estimated for {name}, {misfit.sigma:.3g}{mean}, is more than "
            "half of the standard deviation of its measurements, "
            f"{misfit.of_mean:.3g}. If they are more accurate than that, the "
            "model is biased: state their sigma."
        ]
    return []


def worse_than_mean(study: Study, left: LeftOut | None, place: int) -> list[str]:
    """Warn of a target, by its index, that the mean of the other tests predicts better
    than the fit to them, which predicts it as `left` says."""
    name = study.targets[place]
    if left is None or name in CURVE_COLUMNS:
        return []
    predicted = left.predicted[:, place]
    exact = study.exact[:, place] & np.isfinite(predicted)
    count = int(np.sum(exact))
    if count < FEWEST:
        return []
    measured = study.measured[exact, place]
    of_mean = float(np.std(measured)) * count / (count - 1.0)
    rms = float(np.sqrt(np.mean((predicted[exact] - measured) ** 2)))
    if rms <= max(WORSE * of_mean, _least_error(measured)):
        return []
    return [
        f"The mean of the other tests predicts {name} of a test left out better than "
        f"the fit to them: its rms error is {of_mean:.3g}, that of the fit {rms:.3g}. "
        "Find a law that predicts better (--compare), or take the mean."
    ]

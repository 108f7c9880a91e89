"""What stands against trusting a fit and its errors, in words."""

import numpy as np

from . import left_out
from .draws import FEWEST
from .examination import Examination
from .report import TOO_FEW_FOR_SIGMA, fit_of_target, freedom_text
from .scatter import LEAST_FREEDOM, LEAST_PART
from .study import StudyResult, VariantResult
from .study_file import Study
from .which_scatter import doubtful_scatter

WORSE = 1.1
"""Times the scatter about their mean by which a fit may miss measurements: of repeated
impacts it has that scatter itself."""
HALF = 0.5
"""Part of that scatter above which what is taken for noise may be misfit."""
FEWEST_FOR_MEAN = 3
ANGLES = {"angle_deg": np.pi / 2, "orientation_deg": np.pi}
"""Columns in degrees, and what none of their values would exceed in radians."""
FRACTIONS = {"e_n": 2.0, "e_t": 2.0, "e_contact": 2.0, "e_bar": 2.0}
"""Results that are parts of one, and what half of their measurements do not exceed."""


def of_all(result: StudyResult, examined: list[Examination]) -> list[list[str]]:
    """Those of every variant."""
    return [
        reservations(result, variant, looked)
        for variant, looked in zip(result.variants, examined, strict=True)
    ]


def reservations(
    result: StudyResult, variant: VariantResult, looked: Examination
) -> list[str]:
    """Why not to trust the errors, if there is a reason."""
    uncertainty, lines = variant.uncertainty, doubtful_units(result.study)
    if not variant.reason.at_minimum:
        lines.append(f"The best fit is no minimum: {variant.reason.words}.")
    for place, name in enumerate(result.study.targets):
        lines += _large_misfit(result, variant, place, name)
    astray = dict.fromkeys(trend.target for trend in looked.residuals.trends)
    lines += doubtful_scatter(variant.objective, variant.points, astray)
    if uncertainty.inflation > 1.0:
        lines.append(
            "The misfit is larger than the sigmas given allow. Standard errors are "
            f"multiplied by {np.sqrt(uncertainty.inflation):.3g}, which is right only "
            "if the misfit is random."
        )
    freedom = uncertainty.degrees_of_freedom
    if freedom < 3.0:
        lines.append(
            f"{freedom_text(freedom)} degrees of freedom are left: there is next to "
            "nothing to tell how good the fit is."
        )
    if freedom < LEAST_FREEDOM and not np.all(result.study.sigma_given):
        lines.append(TOO_FEW_FOR_SIGMA)
    for target in astray:
        against = [t.against for t in looked.residuals.trends if t.target == target]
        lines.append(
            f"The residuals of {target} follow {' and '.join(against)}: the model "
            "misses something, and errors that take the misfit for random are too "
            "small."
        )
    for left, what in ((looked.each, "test"), (looked.campaigns, "campaign")):
        if left is not None:
            words = left_out.in_words(left, variant.objective, what)
            lines += [line for line in words if "fewer than chance" in line]
    if not looked.draws.trusted:
        lines.append(
            f"Of the draws fewer than {100 * FEWEST:g} % count: the bands are rough. "
            "Sample the posterior instead (--posterior)."
        )
    for what in (looked.draws, looked.samples):
        if what is not None and what.rough:
            lines.append(
                f"At the accuracy {what.accuracy.name} costs are off by up to "
                f"{what.error:.2g}: the sigmas are too small for it. The "
                + (
                    "bands are rough."
                    if what is looked.draws
                    else "posterior is rough."
                )
            )
    found, starts = np.sum(variant.reached), len(variant.start_costs)
    if found == 0:
        lines.append(
            "No start ended at the best fit, which was found later: there may be a "
            "better one."
        )
    if found == 1 and starts > 1:
        lines.append("One start alone found the best fit: there may be a better one.")
    if variant.failed:
        lines.append(f"{variant.failed} predictions could not be computed.")
    return lines


def doubtful_units(study: Study) -> list[str]:
    """Columns that look as if they had another unit than their name says."""
    lines = []
    for name, most in ANGLES.items():
        values = study.tests.inputs.get(name, np.zeros(1))
        whole = np.all(values == np.round(values))
        if np.max(np.abs(values)) <= most and not whole:
            lines.append(
                f"{name} is between {np.min(values):.3g} and {np.max(values):.3g} in "
                "all tests, and is taken for degrees: are these radians?"
            )
    for place, name in enumerate(study.targets):
        middle = np.nanmedian(study.measured[:, place])
        if middle > FRACTIONS.get(name, np.inf):
            lines.append(
                f"Half of the measurements of {name} are above {middle:.3g}, and are "
                "taken for parts of one: are these per cent?"
            )
    return lines


def _large_misfit(
    result: StudyResult, variant: VariantResult, place: int, name: str
) -> list[str]:
    """Whether a target is missed by as much as its measurements differ."""
    study = result.study
    exact = study.known[:, place] & (study.censored[:, place] == 0)
    rms = fit_of_target(result, variant, place)["rms"]
    if np.sum(exact) < FEWEST_FOR_MEAN or rms is None:
        return []
    measured = study.measured[exact, place]
    of_mean = float(np.std(measured))
    sigma = float(np.median(variant.sigma[exact, place]))
    if study.proportional[place]:
        sigma = float(np.sqrt(np.mean(variant.sigma[exact, place] ** 2)))
    given = study.sigma_given[place]
    least = LEAST_PART * float(np.sqrt(np.mean(measured**2)))
    if rms > max(WORSE * of_mean, sigma if given else least):
        return [
            f"The fit misses {name} by more than the mean of its measurements would, "
            f"an rms of {rms:.3g} against {of_mean:.3g}: the model's ground does not "
            "do what was measured, or inputs or units are not what they are taken for."
        ]
    if not given and sigma > max(HALF * of_mean, least):
        mean = " in the mean" if study.proportional[place] else ""
        return [
            f"The scatter estimated for {name}, {sigma:.3g}{mean}, is more than half "
            f"of what its measurements differ by, {of_mean:.3g} about their mean. If "
            "they were measured better than that, the model misses something: state "
            "their sigma."
        ]
    return []

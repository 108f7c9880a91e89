"""Report of a calibration: first what was found and what is wrong with it, then all
behind it."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from ...quantities import TARGET_COLUMNS
from ...reports.document import Box, Document, Part, Picture, ReportSection
from ..comparison.comparison import Compared
from ..diagnostics import cross_validation, discrepancy, further_tests, residuals
from ..diagnostics.examination import Examination, warnings_of
from ..diagnostics.residuals import varying_inputs
from ..diagnostics.results import StudyResult, VariantResult
from ..diagnostics.scatter import chosen_in_words
from . import contents, drawings, parameters
from .comparison import comparison_parts, comparison_pictures, worse_than_others

PROFILES = (
    "The profile likelihood fixes a parameter and fits the others again; the 95 % "
    "interval of an identifiable parameter is that of its profile, or of its standard "
    "error where a prediction is beside a jump. Standard errors "
    "follow from the curvature of the objective function at the best fit (Laplace), "
    "which is the profile's parabola there."
)
ALIKE = 0.01
"""Relative range of gains below which their picture shows nothing."""
CRITERIA = {
    "D": "the mean error over all combinations (D-optimal)",
    "A": "the sum of the parameters' variances (A-optimal)",
}


def study_report(
    result: StudyResult, examined: list[Examination], compared: Compared | None
) -> Document:
    """Report the fits of all variants, and the laws compared if there are any."""
    several = len(result.variants) > 1
    sections: dict[str, list[Part]] = {"Tests": [*contents.about(result.study)]}
    if several:
        sections["Variants"] = [contents.variant_table(result)]
    for variant, diagnostics in zip(result.variants, examined, strict=True):
        for title, parts in _sections(result, variant, diagnostics):
            inner = [ReportSection(variant.variant.name, parts)] if several else parts
            sections.setdefault(title, []).extend(inner)
    if compared is not None:
        parts = [*comparison_parts(compared), *comparison_pictures(compared)]
        sections["Laws compared"] = parts
    ending = (
        "These numbers are in fit.json and fitted.csv. What they mean, and when not to "
        "trust them: docs/calibration.md."
    )
    sections["Computed from"] = [contents.origin_table(result), ending]
    return Document(
        result.study.title,
        _answer(result, examined, compared),
        [ReportSection(title, parts) for title, parts in sections.items()],
    )


def _answer(
    result: StudyResult, examined: list[Examination], compared: Compared | None
) -> list[Part]:
    """Say what was found and what is wrong with it, and show it."""
    warnings = []
    for variant, diagnostics in zip(result.variants, examined, strict=True):
        warnings.append(warnings_of(result, variant, diagnostics))
        if compared is not None:
            warnings[-1] += worse_than_others(compared, variant.variant)
    common = [line for line in warnings[0] if all(line in one for one in warnings)]
    picture = Picture(
        partial(drawings.draw_study, result),
        "The fit of every target",
        "Measured and fitted.",
    )
    return [
        *(
            Box("verdict", parameters.verdict(result, variant, one.residuals))
            for variant, one in zip(result.variants, examined, strict=True)
        ),
        contents.warning_box(common),
        *(
            contents.warning_box(
                [line for line in lines if line not in common],
                f" for {variant.variant.name}",
            )
            for variant, lines in zip(result.variants, warnings, strict=True)
        ),
        picture,
    ]


def _sections(
    result: StudyResult, variant: VariantResult, diagnostics: Examination
) -> Iterator[tuple[str, list[Part]]]:
    """Yield the titles and parts of the sections on one variant."""
    study = result.study
    yield "Parameters", _parameters(variant, diagnostics, result)
    bands = diagnostics.bands
    along = drawings.only_varying(result) or "measured"
    fits = [
        Picture(
            partial(drawings.draw_target, result, variant, bands, target),
            f"{name}, fitted over {along}",
            f"{name}: {TARGET_COLUMNS[name].meaning}. Bands hold 95 % of the model's "
            "values at the draws of the posterior, and of measurements.",
        )
        for target, name in enumerate(study.targets)
    ]
    yield (
        "Fit",
        [
            "Errors are predicted less measured.",
            contents.target_table(result, variant, diagnostics),
            chosen_in_words(variant.objective, variant.points),
            contents.statistics(result, variant),
            fits,
        ],
    )
    yield "Residuals", _residuals(result, variant, diagnostics)
    for what, left in (("test", diagnostics.each), ("campaign", diagnostics.campaigns)):
        if left is None:
            continue
        table = contents.left_out_table(study, left, what)
        picture = Picture(
            partial(drawings.draw_left_out, result, left),
            f"Each {what} predicted from the others",
            f"Measured less predicted by the fit without its {what}; grey: 95 % band.",
        )
        yield (
            f"Cross-validation by {what}",
            [
                f"Each {what} is predicted by a fit to all others. The grey band holds "
                "95 % if the errors are right.",
                cross_validation.in_words(left, variant.objective, what),
                table and picture,
                table,
            ],
        )
    yield "Discrepancy", [discrepancy.in_words(diagnostics.discrepancy)]
    yield "Further tests", _further(diagnostics)
    words = (
        f"{contents.search_in_words(variant)}. Each row is a fit from one of the best "
        "places of the search, or from the start where there was no search."
    )
    yield "Search", [words[0].upper() + words[1:], contents.end_table(variant)]


def _parameters(
    variant: VariantResult, diagnostics: Examination, result: StudyResult
) -> list[Part]:
    names = variant.names
    profiles = [
        Picture(
            partial(drawings.draw_profile, variant, profile),
            f"Profile likelihood of {name}",
            f"Profile likelihood of {name}: twice the rise of the cost with {name} "
            "fixed and the others fitted again. Grey: 95 % interval.",
        )
        for name, profile in variant.profiles.items()
    ]
    pairs = [
        Picture(
            partial(drawings.draw_pair, variant, diagnostics, a, b),
            f"{names[b]} over {names[a]}",
            "Dots: draws of the posterior. Cross: best fit. Line, where both are "
            "identifiable: 95 % by the covariance.",
        )
        for a, b in drawings.most_correlated(variant)
    ]
    combinations = "Identifiable parameter combinations, the best known first"
    return [
        parameters.parameter_table(variant),
        PROFILES,
        profiles,
        parameters.interval_table(variant),
        ReportSection(combinations, [variant.directions]),
        ReportSection(
            "Correlation",
            [
                parameters.correlation_table(variant),
                pairs,
                parameters.about_draws(result, variant, diagnostics.draws),
            ],
        ),
        ReportSection("Posterior", parameters.about_posterior(variant, diagnostics)),
        contents.nuisances(variant),
    ]


def _residuals(
    result: StudyResult, variant: VariantResult, diagnostics: Examination
) -> list[Part]:
    studentised = diagnostics.residuals
    if not np.any(result.study.exact):
        return ["None: only limits are known, which have no residuals."]
    if not np.any(np.isfinite(studentised.values)):
        return [
            "None: the fit passes through every measurement, whatever it is (leverage "
            "1)."
        ]
    pictures = [
        Picture(
            partial(drawings.draw_residuals, result, variant, studentised, against),
            f"Residuals over {against}",
            f"Residuals over {against}; grey: two standard deviations.",
        )
        for against in ("prediction", *varying_inputs(variant.objective))
    ]
    pictures.append(
        Picture(
            partial(drawings.draw_quantiles, studentised),
            "Q-Q plot of the residuals",
            "Q-Q plot: residuals on the line are normal with the sigmas used.",
        )
    )
    return [
        "Measured less fitted over the standard deviation, studentised: each over the "
        "root of 1 - leverage. A bias is the mean of fitted less measured.",
        contents.bias_table(studentised),
        residuals.in_words(studentised, variant.objective),
        pictures,
    ]


def _further(diagnostics: Examination) -> list[Part]:
    single, together = diagnostics.single, diagnostics.together
    parts: list[Part] = [
        f"Of {len(single.volumes)} candidate impacts, those chosen one after the other "
        f"that minimise {CRITERIA[single.criterion]}. Errors are relative to the "
        "value, or to half the range.",
        ReportSection(
            "One result measured in each test",
            [further_tests.in_words(single), further_tests.as_table(single)],
        ),
    ]
    if together.ways != single.ways:
        first = further_tests.in_words(together)[:1]
        table = further_tests.as_table(together)
        parts.append(ReportSection("All of them measured in each test", [first, table]))
    if single.fixed:
        fixed = ", ".join(f"{name} {value:.4g}" for name, value in single.fixed.items())
        parts.append(f"In common: {fixed}.")
    best = np.max(together.volumes, axis=1)
    if np.ptp(best) > ALIKE * np.max(best):
        picture = Picture(
            partial(drawings.draw_candidates, together),
            "Gain of the next test",
            "Gain of the next test, with all results measured.",
        )
        return [*parts, picture]
    return [*parts, "All candidates gain the same."]

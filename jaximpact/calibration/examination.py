"""What is to be known of a fit before it is trusted: one look at everything."""

from typing import NamedTuple

import numpy as np

from .bands import Bands, bands_of
from .draws import Draws, draw
from .further_tests import Suggestions, suggest_tests
from .least_squares import Progress
from .left_out import LeftOut, leave_out_campaigns, leave_out_each
from .residuals import Residuals, residuals_of
from .sampling import Samples, sample_posterior
from .side_by_side import each_variant
from .study import StudyResult, VariantResult


class Examination(NamedTuple):
    """Of one variant."""

    residuals: Residuals
    draws: Draws
    bands: Bands
    each: LeftOut | None
    """Each test left out; None of a study of one test."""
    campaigns: LeftOut | None
    """Each campaign left out; None where there is one alone."""
    single: Suggestions
    """Further tests that measure one result each."""
    together: Suggestions
    """Further tests that measure all."""
    samples: Samples | None = None
    """Of the posterior, where they were asked for."""


def examine(
    result: StudyResult,
    *,
    posterior: bool = False,
    progress: Progress = lambda text: None,
) -> list[Examination]:
    """Examine every variant.

    Args:
        posterior: whether to sample it too (`sampling`).
        progress: called with lines of text.
    """
    several = len(result.variants) > 1

    def examined(variant: VariantResult, tell: Progress) -> Examination:
        start = f"{variant.variant.name}: " if several else ""
        return _examine(result, variant, posterior, lambda text: tell(start + text))

    if posterior:
        # NUTS calls back from within JAX, which several threads could wait for.
        return [examined(variant, progress) for variant in result.variants]
    engines = [variant.objective.engine for variant in result.variants]
    return each_variant(engines, examined, result.variants, progress)


def _examine(
    result: StudyResult, variant: VariantResult, posterior: bool, progress: Progress
) -> Examination:
    study, objective, points = result.study, variant.objective, variant.points
    uncertainty = variant.uncertainty
    inflation = uncertainty.inflation
    draws = draw(objective, points, inflation, seed=study.seed, progress=progress)
    each = None
    if np.sum(np.any(study.known, axis=1)) > 1:
        each = leave_out_each(objective, points, uncertainty, progress=progress)
    order = np.argsort(variant.start_costs, kind="stable")
    ends = variant.bounds.coordinate(variant.end_parameters[order])
    campaigns = leave_out_campaigns(
        objective, points, uncertainty, ends, progress=progress
    )
    progress("further tests")
    wanted = study.candidates

    def suggested(together: bool) -> Suggestions:
        return suggest_tests(
            variant,
            wanted.axes,
            wanted.measure,
            together=together,
            count=wanted.count,
            criterion=wanted.criterion,
        )

    samples = None
    if posterior:
        samples = sample_posterior(
            variant, seed=study.seed, draws=draws, progress=progress
        )
    return Examination(
        residuals=residuals_of(objective, points, inflation),
        draws=draws,
        bands=bands_of(objective, draws, inflation),
        each=each,
        campaigns=campaigns,
        single=suggested(False),
        together=suggested(True),
        samples=samples,
    )

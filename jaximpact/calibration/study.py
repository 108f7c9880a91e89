"""A whole study: fit every variant, and judge."""

import time
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from .engine import Engine
from .fit import fit, fit_starts, go_on, spread_starts, told_apart
from .least_squares import Fits, Progress
from .likelihood_profile import LikelihoodProfile, profile_all
from .memory import Memory
from .objective import Objective, Points, engines_of, names_of, start_of
from .scatter import settle
from .side_by_side import each_variant
from .stopping import Reason
from .study_file import Study, Variant
from .transforms import Bounds
from .uncertainty import Uncertainty, estimate
from .verdict import Verdict, directions, judge_all

LOWER_BY = 1e-3
"""A profile that finds a cost lower by more than this part of it and of s^2 starts the
fit again."""


class VariantResult(NamedTuple):
    """What the fit of one variant gave; parameters in the units of their columns."""

    variant: Variant
    bounds: Bounds
    names: list[str]
    """Of the unknowns: the soil's parameters, then the nuisances."""
    parameters: np.ndarray
    """At the best fit, `(unknowns,)`."""
    cost: float
    predicted: np.ndarray
    """`(tests, targets)`; NaN where there is no prediction."""
    sigma: np.ndarray
    """Likewise: as given, or estimated."""
    outcomes: np.ndarray
    """Codes, `(tests,)`."""
    failed: int
    """How many measurements have no prediction."""
    uncertainty: Uncertainty
    verdicts: list[Verdict]
    """On the soil's parameters."""
    directions: list[str]
    profiles: dict[str, LikelihoodProfile]
    start_parameters: np.ndarray
    """Of every start, the given one first, `(starts, unknowns)`."""
    end_parameters: np.ndarray
    """Where every start ended."""
    start_costs: np.ndarray
    """There."""
    start_reasons: list[Reason]
    start_steps: np.ndarray
    start_anew: np.ndarray
    """How often each was stuck and begun anew, elsewhere."""
    reason: Reason
    """Why the fit that is reported stopped."""
    objective: Objective
    """With the sigmas that were estimated."""
    points: Points
    """The best fit, of one lane."""

    @property
    def reached(self) -> np.ndarray:
        """Which starts found the best fit."""
        return np.array([reason.at_minimum for reason in self.start_reasons])


class StudyResult(NamedTuple):
    """A study and what it gave."""

    study: Study
    variants: list[VariantResult]
    seconds: float
    """Wall time of all fits, compilation included."""
    engine: str
    """What computed the impacts."""


def fit_study(
    study: Study,
    *,
    memory: Memory | None = None,
    progress: Progress = lambda text: None,
) -> StudyResult:
    """Fit every variant of a study.

    Args:
        study: from `read_study`.
        memory: where finished fits are kept and found.
        progress: called with lines of text.
    """
    begin = time.perf_counter()
    progress("compiling once")
    engines = engines_of(study)
    several = len(study.variants) > 1

    def fitted(item: tuple[Variant, Engine], tell: Progress) -> VariantResult:
        variant, engine = item
        start = f"{variant.name}: " if several else ""
        objective = Objective(study, variant, engine)
        objective.memory = memory
        return _fit_variant(objective, variant, lambda text: tell(start + text))

    items = list(zip(study.variants, engines, strict=True))
    results = each_variant(engines, fitted, items, progress)
    names = " and ".join(sorted({engine.name for engine in engines}))
    return StudyResult(study, results, time.perf_counter() - begin, names)


def best_fit(
    objective: Objective, progress: Progress = lambda text: None
) -> tuple[Objective, Fits, Fits]:
    """Fit from all starts of a study.

    Returns:
        The objective with the sigmas that were estimated, the ends of all starts, and
        the best fit alone.
    """
    study = objective.study
    starts = starts_of(objective)
    ends = fit_starts(objective, starts, study.method, progress)
    if not np.any(np.isfinite(ends.points.predicted[:, study.known])):
        raise InputError("no start gives a prediction", file=study.path)
    objective, best = settle(objective, _one(ends, ends.best), fit, progress)
    if not np.all(study.sigma_given):
        # What was the best depends on the sigmas.
        ends = ends._replace(points=objective.reweigh(ends.points))
        ends = go_on(objective, ends, progress)
        if ends.points.cost[ends.best] < best.points.cost[0]:
            objective, best = settle(objective, _one(ends, ends.best), fit, progress)
    return objective, ends, best


def starts_of(objective: Objective) -> np.ndarray:
    """Where a study's fits start, `(starts, unknowns)` in x."""
    study = objective.study
    return spread_starts(
        objective.bounds,
        start_of(study),
        objective.prior_mean,
        objective.prior_sd,
        study.starts,
        study.seed,
    )


def _fit_variant(
    objective: Objective, variant: Variant, progress: Progress
) -> VariantResult:
    study, starts = objective.study, starts_of(objective)
    objective, ends, best = best_fit(objective, progress)
    uncertainty = estimate(objective, best.points)

    def profiled(best: Fits) -> list[LikelihoodProfile]:
        return profile_all(objective, best.points, uncertainty, progress)

    profiles = profiled(best)
    lowest = min(profiles, key=lambda found: found.lowest_cost)
    margin = LOWER_BY * (lowest.best_cost + objective.unit(lowest.best_cost))
    if lowest.lowest_cost < lowest.best_cost - margin:
        again = fit(
            objective,
            lowest.lowest_x[None],
            progress=lambda text: progress(f"refining, {text}"),
        )
        if again.points.cost[0] < best.points.cost[0]:
            objective, best = settle(objective, again, fit, progress)
            uncertainty = estimate(objective, best.points)
            profiles = profiled(best)
    # Sigmas may have changed since the starts ended.
    ends = ends._replace(points=objective.reweigh(ends.points))
    reasons = told_apart(objective, ends, float(best.points.cost[0]))
    ends = ends._replace(reasons=reasons)
    by_name = {profile.name: profile for profile in profiles}
    soil = [parameter.name for parameter in study.parameters]
    point = best.points
    return VariantResult(
        variant=variant,
        bounds=objective.bounds,
        names=names_of(study),
        parameters=objective.bounds.parameter(point.x[0]),
        cost=float(point.cost[0]),
        predicted=point.predicted[0],
        sigma=objective.sigma,
        outcomes=point.outcomes[0],
        failed=int(np.sum(objective.failed(point.predicted[0]))),
        uncertainty=uncertainty,
        verdicts=judge_all(objective, best, uncertainty, by_name, ends),
        directions=directions(soil, objective.bounds, uncertainty),
        profiles=by_name,
        start_parameters=objective.bounds.parameter(starts),
        end_parameters=objective.bounds.parameter(ends.points.x),
        start_costs=ends.points.cost,
        start_reasons=reasons,
        start_steps=ends.steps,
        start_anew=np.broadcast_to(ends.anew, len(starts)),
        reason=best.reasons[0],
        objective=objective,
        points=point,
    )


def _one(fits: Fits, lane: int) -> Fits:
    """One of the fits."""
    return Fits(fits.points.take([lane]), [fits.reasons[lane]], fits.steps[[lane]])

"""Fit of a whole study: starts, best fit, uncertainty and verdicts of its variants."""

import time
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..progress import Progress, ProgressFunction, reporting_to, tell, within
from .diagnostics.identifiability import (
    LikelihoodProfile,
    directions,
    judge_all,
    profile_all,
)
from .diagnostics.jumps import Judged, judge
from .diagnostics.priors import disagreements
from .diagnostics.results import StudyResult, VariantResult
from .diagnostics.scatter import CLEAR, evidence_of_proportional
from .estimation.evolution import Population
from .estimation.least_squares import Fits
from .estimation.search import (
    fit_along,
    fit_places,
    label_minima,
    refine,
    with_end,
)
from .estimation.sigma import settle, understated
from .problem.config import Study, Variant
from .problem.forward_model import ForwardModel, for_each_variant, models_of
from .problem.objective import Objective, names_of

LOWER_BY = 1e-3
"""Fraction of the cost, and of s^2, by which a profile or a draw must find a lower cost
for the fit to start again from there."""
REFITS = 3
"""Largest number of fits from a draw."""
LOWEST = 4
"""Number of draws whose cost is computed at the accuracy of the fit."""


def fit_study(
    study: Study,
    *,
    progress: Progress | ProgressFunction | None = None,
) -> StudyResult:
    """Fit every variant of a study.

    Args:
        study: study to be fitted, from `read_study`.
        progress: called with lines of text.

    Raises InputError where no start gives a prediction.
    """
    begin = time.perf_counter()

    def fitted(item: tuple[Variant, ForwardModel]) -> VariantResult:
        variant, model = item
        objective = Objective(study, variant, model)
        with within(f"{variant.name}: " if len(study.variants) > 1 else ""):
            return _fit_variant(objective, variant)

    with reporting_to(progress):
        tell("compiling once")
        models = models_of(study)
        items = list(zip(study.variants, models, strict=True))
        results = for_each_variant(models, fitted, items)
    names = " and ".join(sorted({model.engine for model in models}))
    return StudyResult(study, results, time.perf_counter() - begin, names)


class BestFit(NamedTuple):
    """Fit of a study before it is judged."""

    objective: Objective
    """Objective function with the estimated sigmas."""
    best: Fits
    """Best fit alone."""
    ends: Fits
    """Ends of the fits from the best places, the best fit among them."""
    lane: int
    """Place of the best fit among these ends."""
    population: Population | None
    """Population that found these places; None without a search."""


def best_fit(objective: Objective) -> BestFit:
    """Fit a study, with the sigmas that are not given."""
    study = objective.study
    ends, population = fit_places(objective)
    if not np.any(np.isfinite(ends.points.predicted[:, study.known])):
        raise InputError("no start gives a prediction", file=study.path)
    lane = ends.best
    objective, best = settle(objective, ends.take([lane]))
    too_small = understated(objective, best.points)
    if np.any(too_small):
        objective = objective.with_sigma_factors(too_small)
        objective, best = settle(objective, best)
    objective, best = _with_better_scatter(objective, best)
    # Which end is the best depends on the sigmas that are estimated.
    other = int(np.argmin(objective.reevaluate(ends.points).cost))
    if not np.all(study.sigma_given) and other != lane:
        end = refine(objective, ends.points.x[other])
        if end.points.cost[0] < best.points.cost[0]:
            objective, best = settle(objective, end)
            lane = other
    return BestFit(objective, best, with_end(ends, lane, best), lane, population)


def _with_better_scatter(objective: Objective, best: Fits) -> tuple[Objective, Fits]:
    """Take scatter in proportion to the value for targets whose kind of scatter is
    open, where the residuals clearly show it, and fit again.

    Residuals of a fit with constant scatter favour that kind, so that what they show
    against it can be believed.
    """
    study = objective.study
    is_open = np.isin(study.targets, study.scatter_open)
    evidence = evidence_of_proportional(objective, best.points)
    better = is_open & ~objective.study.proportional & (evidence > CLEAR)
    if not np.any(better):
        return objective, best
    objective = objective.with_proportional_scatter(better)
    return _with_better_scatter(*settle(objective, best))


def _fit_variant(objective: Objective, variant: Variant) -> VariantResult:
    study = objective.study
    objective, best, ends, lane, population = best_fit(objective)
    objective, best, judged, profiles = _profiled(objective, best)
    uncertainty = judged.uncertainty
    # It may have gone on from a draw or a profile, and sigmas may have changed.
    ends = ends._replace(points=objective.reevaluate(ends.points))
    found_later = best.points.cost[0] < _below(objective, ends.points.cost[lane])
    ends = with_end(ends, lane, best)
    reasons = label_minima(objective, ends, float(best.points.cost[0]))
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
        verdicts=judge_all(
            *(objective, best, uncertainty, by_name, ends),
            disagreements(objective, best),
            of_draws=judged.of_draws,
        ),
        directions=directions(soil, objective.bounds, uncertainty),
        profiles=by_name,
        end_parameters=objective.bounds.parameter(ends.points.x),
        end_costs=ends.points.cost,
        end_reasons=reasons,
        end_steps=ends.steps,
        members=len(population.x) if population else 0,
        agreed=population.agreed if population else 0,
        found_later=bool(found_later),
        reason=best.reasons[0],
        objective=objective,
        points=point,
        jumps=judged.shares,
        draws=judged.draws,
        errors_of_draws=judged.of_draws,
    )


def _profiled(
    objective: Objective, best: Fits
) -> tuple[Objective, Fits, Judged, list[LikelihoodProfile]]:
    """Judge and profile the best fit; where a profile of all tests finds a lower cost,
    fit from there, and do it again."""
    objective, best, judged = judge_lowest(objective, best)
    profiles = _profiles(judged, best)
    lowest = min(profiles, key=lambda profile: profile.lowest_cost)
    below = _below(objective, lowest.best_cost)
    if judged.smooth is not objective or lowest.lowest_cost >= below:
        return objective, best, judged, profiles
    again = _fit_again(objective, best, lowest.lowest_x)
    if again is None:
        return objective, best, judged, profiles
    objective, best, judged = judge_lowest(*again)
    return objective, best, judged, _profiles(judged, best)


def judge_lowest(objective: Objective, best: Fits) -> tuple[Objective, Fits, Judged]:
    """Judge the best fit; where a draw has a lower cost, fit from there, and judge
    that."""
    for _ in range(REFITS):
        below = _below(objective, float(best.points.cost[0]))
        judged = judge(objective, best, enough_below=below)
        lowest = np.argsort(judged.draws.cost, kind="stable")[:LOWEST]
        if judged.draws.cost[lowest[0]] >= below:
            return objective, best, judged
        # Beside a jump draws, which are less accurate, may be on the other side of it.
        points = objective.values(judged.draws.x[lowest])
        point = int(np.argmin(points.cost))
        if points.cost[point] >= below:
            break
        again = _fit_again(objective, best, points.x[point])
        if again is None:
            break
        objective, best = again
    return objective, best, judge(objective, best)


def _below(objective: Objective, cost: float) -> float:
    """Compute the cost below which a fit starts again."""
    return cost - LOWER_BY * (cost + float(objective.unit(cost)))


def _fit_again(
    objective: Objective, best: Fits, x: np.ndarray
) -> tuple[Objective, Fits] | None:
    """Fit from x; None where that ends no lower than the best fit, or at no minimum
    though that one did."""
    again = refine(objective, x)
    if again.points.cost[0] >= objective.values(x[None]).cost[0]:
        # Lost at a lower accuracy, at which steps are cheaper.
        with within("refining, "):
            again = fit_along(objective, x)
    lost = best.reasons[0].at_minimum and not again.reasons[0].at_minimum
    if lost or again.points.cost[0] >= best.points.cost[0]:
        return None
    return settle(objective, again)


def _profiles(judged: Judged, best: Fits) -> list[LikelihoodProfile]:
    smooth = judged.smooth
    points = smooth.reevaluate(best.points)
    return profile_all(smooth, points, judged.uncertainty)

"""The fit of a study: a search, fits from its best places, searches beside jumps."""

import numpy as np

from ...progress import within
from ..problem.config import Study
from ..problem.objective import Objective, start_of
from .branches import draws_about, error_root
from .evolution import PER_UNKNOWN, Population, search, search_about
from .least_squares import ROUGH, Fits, Reason, fit

PLACES = 4
"""Largest number of places of a population from which fits start."""
MANY_TESTS, SOME_TESTS = 200, 100
"""Above the first number of tests, a population searches with about the second number
of them, sampled with the study's seed: enough to locate minima to some standard
errors."""
LEAST_MEMBERS = 48
"""Least size of a population about a fit."""
SAME = 1e-3
"""Fraction of s^2, and of the cost, by which a fit may end above the best one and still
be at the same cost."""


def fit_by(method: str, objective: Objective, x: np.ndarray) -> Fits:
    """Fit from every x, shape (lanes, unknowns), roughly, by one of `METHODS`."""
    if method == "trust-region":
        return fit(objective, x, tolerance=ROUGH)
    # optax takes its time to import, and few want it.
    from . import first_order

    by_gradient = {"adam": first_order.adam, "l-bfgs": first_order.l_bfgs}
    return by_gradient[method](objective, x)


def fit_places(objective: Objective) -> tuple[Fits, Population | None]:
    """Fit from the best places that a search finds, and the best of them to the end;
    from the start alone where the study has one."""
    study, rough = objective.study, objective.rough()
    population, places = None, start_of(study)[None]
    if study.starts > 1:
        part, step = rough, ""
        if len(study.measured) > MANY_TESTS:
            chosen = some_tests(study)
            part, step = rough.of_tests(chosen), f"{len(chosen)} tests, "
        with within(step):
            population = search(part, study.starts)
        places = population.places(PLACES)
    with within("best places, "):
        ends = fit_by(study.method, rough, places)
    ends = ends._replace(points=objective.values(ends.points.x))
    refined: set[int] = set()
    # At the end of one another may be lower: the best one has derivatives in any case.
    while (best := ends.best) not in refined:
        others = np.delete(ends.points.x, best, axis=0)
        end = refine(objective, ends.points.x[best], others)
        end = end._replace(steps=end.steps + ends.steps[best])
        ends = with_end(ends, best, end)
        refined.add(best)
    return ends, population


def some_tests(study: Study) -> np.ndarray:
    """Sample indices of tests that represent all: the same number of every target, or
    all its tests, so that no target is lost that is seldom measured."""
    random = np.random.default_rng(study.seed)
    of_each = -(-SOME_TESTS // len(study.targets))
    chosen = [
        random.permutation(np.flatnonzero(measured))[:of_each]
        for measured in study.known.T
    ]
    return np.unique(np.concatenate(chosen))


@within("refining, ")
def refine(
    objective: Objective, x: np.ndarray, others: np.ndarray | None = None
) -> Fits:
    """Fit from x, shape (unknowns,), to the end, beside a jump too.

    Nearly all steps are done at an accuracy at which they cost a fraction.

    Args:
        others: points that a search beside a jump begins from too, shape (points,
            unknowns).
    """
    coarse = objective.no_finer_than_sigmas()
    fits = fit(coarse, x[None])
    if fits.reasons[0].at_minimum:
        end = fits if coarse is objective else fit(objective, fits.points.x)
        if end.reasons[0].at_minimum:
            return end._replace(steps=end.steps + fits.steps)
    others = x[None] if others is None else np.concatenate([x[None], others])
    return fit_beside_jump(objective, fits, others)


def fit_beside_jump(
    objective: Objective, fits: Fits, others: np.ndarray | None = None
) -> Fits:
    """Go on from a fit (one lane) that a jump has stopped: by a population about it and
    of other points, and from its best members."""
    coarse = objective.no_finer_than_sigmas()
    points = fits.points if coarse is objective else coarse(fits.points.x)
    if np.any(objective.failed(points.predicted)):
        return fits
    members = max(LEAST_MEMBERS, PER_UNKNOWN * points.x.shape[1])
    root = error_root(coarse, points)
    draws = draws_about(coarse, points, root, members - 1)
    others = points.x if others is None else np.concatenate([points.x, others])
    about = np.concatenate([others, draws])
    population = search_about(coarse, about)
    x = np.concatenate([others, population.x[:PLACES]])
    lowest = objective.values(x)
    lowest = lowest.take([np.argmin(lowest.cost)])
    if lowest.cost[0] > population.cost[0] + objective.unit(population.cost[0]):
        # At the finer accuracy a test is on the other side of the jump.
        population = search_about(objective, np.concatenate([lowest.x, about]))
        lowest = lowest._replace(x=population.x[:1])
    end = fit(objective, lowest.x)
    reasons = end.reasons if end.reasons[0].at_minimum else [Reason.edge]
    return Fits(end.points, reasons, end.steps + fits.steps)


def fit_along(objective: Objective, x: np.ndarray) -> Fits:
    """Fit from x, shape (unknowns,), and beside a jump where one stops the fit."""
    fits = fit(objective, x[None])
    return fits if fits.reasons[0].at_minimum else fit_beside_jump(objective, fits)


def with_end(fits: Fits, lane: int, end: Fits) -> Fits:
    """Replace the end of one of the fits."""
    reasons, steps = list(fits.reasons), fits.steps.copy()
    reasons[lane], steps[lane] = end.reasons[0], end.steps[0]
    return Fits(fits.points.put([lane], end.points), reasons, steps)


def label_minima(objective: Objective, fits: Fits, best_cost: float) -> list[Reason]:
    """Label fits that ended in a local minimum above the best; others keep their
    reasons."""
    allowed = best_cost + SAME * (objective.unit(best_cost) + best_cost)
    return [
        Reason.above if reason.at_minimum and cost > allowed else reason
        for cost, reason in zip(fits.points.cost, fits.reasons, strict=True)
    ]

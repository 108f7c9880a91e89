"""Multistart: fits from all starts, and a search by those that are left behind."""

import numpy as np
from scipy.special import ndtri

from ...progress import within
from ..problem.bounds import Bounds
from ..problem.config import Study
from ..problem.objective import Objective, Points
from .branches import best_about, descend_on_branches, jumped
from .evolution import AGREED, Population, evolve, members_for, robust_of
from .least_squares import (
    FINE,
    ROUGH,
    Fits,
    Reason,
    StoppingRule,
    is_near,
    levenberg_marquardt,
)

SPREAD = 0.02
"""Distance of starts from the bounds, as a fraction of the range."""
RUNNING = 1.02, 0.5
"""Starts whose rough cost is below a times the lowest plus b s^2 are fitted to the
end."""
MANY_TESTS, SOME_TESTS = 200, 100
"""Above the first number of tests, starts are ranked on about the second number of
them, sampled with the study's seed: enough to locate minima to some standard errors."""
ENOUGH = 0.9
"""Fraction of the starts near the lowest cost from which the others do not search
together."""
SCREENED = 8
"""Candidates for each member of the population of a search."""
MEMBERS_FITTED = 4
"""Members of the last population from which a fit starts."""
LAST = FINE._replace(steps=20)
"""Stopping rule of fits that go on at a finer accuracy: few steps are left."""
POLISHED = 3
"""Places from which fits go on to the end that a jump has stopped."""
STUCK = Reason.stuck, Reason.jump, Reason.failed
ONE_PLACE = 0.3
"""Distance in x within which ends of equal cost are at one minimum."""
SAME = 1e-3
"""Fraction of s^2, and of the cost, by which a fit may end above the best one and still
count as having found it."""


def spread_starts(
    bounds: Bounds, start: np.ndarray, mean, sd, count: int, seed: int | tuple[int, ...]
) -> np.ndarray:
    """Sample starts (count, unknowns) in x: the given one, then a Latin hypercube.

    The hypercube divides the range of each unknown into as many strata as there are
    points; of an unknown with a prior (`sd` finite), its prior distribution.
    """
    random = np.random.default_rng(seed)
    others, size = count - 1, len(start)
    strata = np.stack([random.permutation(others) for _ in range(size)], axis=-1)
    part = (strata + random.random((others, size))) / max(others, 1)
    spread = bounds.at_fraction(SPREAD + (1.0 - 2.0 * SPREAD) * part)
    has_prior = np.isfinite(sd)
    drawn = mean + np.where(has_prior, sd, 0.0) * ndtri(np.clip(part, 1e-3, 1 - 1e-3))
    drawn = np.clip(drawn, bounds.lower, bounds.upper)
    drawn = bounds.coordinate(np.where(has_prior, drawn, bounds.lower))
    spread = np.where(has_prior, drawn, spread)
    return np.concatenate([np.asarray(start, float)[None], spread])


def fit(
    objective: Objective,
    x: np.ndarray,
    free: np.ndarray | None = None,
    *,
    method: str = "levenberg-marquardt",
    rule: StoppingRule = FINE,
) -> Fits:
    """Fit from every x until the stopping rule ends each fit.

    Args:
        x: starting points, shape (lanes, unknowns).
        free: mask of the unknowns that are fitted, the same shape; None for all. Only
            for Levenberg-Marquardt.
        method: one of `METHODS`.
        rule: stopping rule of Levenberg-Marquardt.

    Equal arguments give equal numbers on one machine.
    """
    if method == "levenberg-marquardt":
        return levenberg_marquardt(objective, x, free, rule)
    # optax takes its time to import, and few want it.
    from . import first_order

    by_gradient = {"adam": first_order.adam, "l-bfgs": first_order.l_bfgs}
    return by_gradient[method](objective, x)


def fit_starts(objective: Objective, x: np.ndarray, method: str) -> Fits:
    """Fit from every start roughly, to some of the tests where they are many; then fit
    to the end those that may be the best."""
    rough, many = objective.rough(), len(objective.study.measured) > MANY_TESTS
    part, step = rough, ""
    if many:
        chosen = some_tests(objective.study)
        part, step = rough.of_tests(chosen), f"{len(chosen)} tests, "
    with within(step):
        own = fit(part, x, method=method, rule=ROUGH)
        fits = _search_together(part, own, method)
    if many:
        ends = _fit_to_all(rough, part, fits)
        if fits is not own:
            # What is best for some of the tests need not be for all.
            other = _fit_to_all(rough, part, own)
            lower = np.flatnonzero(other.points.cost < ends.points.cost)
            reasons = [other.reasons[lane] for lane in lower]
            ends = ends.ending(lower, other.points.take(lower), reasons)
        fits = ends
    return polish(objective, fits)


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


def _search_together(objective: Objective, fits: Fits, method: str) -> Fits:
    """Let the fits that ended above the best one search together, where they are many.

    They are part of a population (`evolution`), whose best members are fitted. All join
    the lowest of these where most of the population has come to its place; else only
    those whose members have, and the others stay as they are.
    """
    cost = fits.points.cost
    running = _is_running(objective, cost)
    alone = np.sum(running) == 1 and fits.reasons[fits.best] in STUCK
    left = np.arange(len(cost)) if alone else np.flatnonzero(~running)
    if len(left) <= (1.0 - ENOUGH) * len(cost):
        return fits
    population = _evolved(objective, fits.points.x)
    members = population.x[population.found][:MEMBERS_FITTED]
    with within("best members, "):
        again = fit(objective, members, method=method, rule=ROUGH)
    best = again.points.take([again.best])
    found = np.resize(population.found, len(left))
    if np.mean(population.found) >= AGREED:
        found[:] = True
    found[0] = True
    left = left[found & (best.cost[0] < cost[left])]
    steps, restarts = fits.steps.copy(), np.zeros(len(cost), int)
    steps[left] += again.steps[again.best]
    restarts[left] += 1
    first = again.reasons[again.best]
    reasons = [Reason.searched if place else first for place in range(len(left))]
    return fits.ending(left, best, reasons)._replace(steps=steps, restarts=restarts)


def _evolved(objective: Objective, x: np.ndarray) -> Population:
    """Search from points x and from candidates spread as starts are."""
    study = objective.study
    candidates = spread_starts(
        *(objective.bounds, x[0], objective.prior_mean, objective.prior_sd),
        SCREENED * members_for(x.shape[1]),
        (study.seed, 1),
    )
    with within("search, "):
        found = evolve(objective, x, candidates)
    points = robust_of(objective).values(found)
    return Population(points.x, points.cost)


def _fit_to_all(objective: Objective, part: Objective, fits: Fits) -> Fits:
    """Continue fits to some of the tests with all of them, where they ended at a
    minimum; leave the others as they are."""
    leader = _leaders(part, fits, np.arange(len(fits.reasons)))
    leaders, place = np.unique(leader, return_inverse=True)
    ends = objective.values(fits.points.x[leaders])
    ended = np.array([fits.reasons[lane].at_minimum for lane in leaders])
    if not np.any(ended):
        ended[np.argmin(ends.cost)] = True
    lanes = np.flatnonzero(ended[place])
    fits = fits._replace(points=ends.take(place))
    with within("all tests, "):
        return _continue(objective, fits, lanes, leader[lanes], ROUGH)


@within("refining, ")
def polish(objective: Objective, fits: Fits) -> Fits:
    """Fit those to the end that may be the best; those at one minimum continue as one.

    Of fits that a jump has stopped the lowest go on. The best one goes on along the
    jump, on the branches of its impacts; others on these branches continue as it.
    """
    lanes = np.flatnonzero(_is_running(objective, fits.points.cost))
    leader = _leaders(objective, fits, lanes)
    leaders = np.unique(leader)
    cost = fits.points.cost[leaders]
    first = leaders[np.argsort(cost, kind="stable")[:POLISHED]]
    ended = np.array([reason.at_minimum for reason in fits.reasons])
    chosen = np.isin(leader, first) | ended[leader]
    lanes, leader = lanes[chosen], leader[chosen]
    coarse = objective.no_finer_than_sigmas()
    if coarse is objective:
        fits = _continue(objective, fits, lanes, leader, FINE)
    else:
        # Nearly all steps are taken where they cost a fraction.
        fits = _continue(coarse, fits, lanes, leader, FINE)
        fits = _descended(coarse, fits)
        lanes = np.flatnonzero(_at_place(fits, fits.best))
        leader = np.full(len(lanes), fits.best)
        fits = _at_accuracy(objective, fits, lanes)
        if fits.reasons[fits.best] is not Reason.edge:
            fits = _continue(objective, fits, lanes, leader, LAST)
    if not fits.reasons[fits.best].at_minimum:
        fits = _descended(objective, fits)
    return _join_on_branches(objective, fits)


def _at_accuracy(objective: Objective, fits: Fits, lanes: np.ndarray) -> Fits:
    """Evaluate the best fit, at which some lanes are, at the accuracy of the objective.

    Beside a jump a test may be on the other side of it at that accuracy: the fit then
    goes on from the best of the points about it.
    """
    best, coarse = fits.best, fits.points.take([fits.best])
    point, reason = objective(coarse.x), fits.reasons[fits.best]
    if np.any(jumped(objective, point, coarse)):
        point, reason = best_about(objective, coarse), Reason.jump
    fits = fits._replace(points=fits.points.put(lanes, point))
    return fits.ending([best], point, [reason])


def fit_on(objective: Objective, x: np.ndarray) -> Fits:
    """Fit one lane from x, and along a jump where one stops it."""
    fits = fit(objective, x)
    if fits.reasons[0].at_minimum:
        return fits
    return descend_on_branches(objective, fits)


def with_origin(fits: Fits, origin: int, best: Fits) -> Fits:
    """Let the fits at the place of one of them, `origin`, end where that one went on
    to."""
    points = fits.points.put(_at_place(fits, origin), best.points)
    return fits._replace(points=points).ending([origin], best.points, best.reasons)


def _at_place(fits: Fits, lane: int) -> np.ndarray:
    """Find the fits that are at the very place of one of them."""
    return np.all(fits.points.x == fits.points.x[lane], axis=1)


def _descended(objective: Objective, fits: Fits) -> Fits:
    """Continue the best fit along a jump that has stopped it."""
    best, steps = fits.best, fits.steps.copy()
    one = descend_on_branches(objective, one_of(fits, best))
    steps[best] = one.steps[0]
    fits = _joined(fits, _at_place(fits, best), one.points)._replace(steps=steps)
    return fits.ending([best], one.points, one.reasons)


def _join_on_branches(objective: Objective, fits: Fits) -> Fits:
    """Let fits on the branches of the best one, stopped by its jumps, be that one."""
    best = fits.best
    if fits.reasons[best] is not Reason.edge:
        return fits
    end = fits.points.take([best])
    near = _is_running(objective, fits.points.cost)
    near &= ~np.any(jumped(objective, end, fits.points), axis=1)
    near &= [reason is not Reason.searched for reason in fits.reasons]
    return _joined(fits, near, end).ending([best], end, [Reason.edge])


def _joined(fits: Fits, same: np.ndarray, end: Points) -> Fits:
    """Let fits, given by a mask, end at one point; a search may have found it too."""
    lanes, searched = np.flatnonzero(same), Reason.searched
    reasons = [fits.reasons[lane] for lane in lanes]
    reasons = [one if one is searched else Reason.joined for one in reasons]
    return fits.ending(lanes, end, reasons)


def one_of(fits: Fits, lane: int) -> Fits:
    """Select one of the fits."""
    return Fits(fits.points.take([lane]), [fits.reasons[lane]], fits.steps[[lane]])


def _is_running(objective: Objective, cost: np.ndarray) -> np.ndarray:
    """Find the ends that may be the best."""
    times, more = RUNNING
    least = np.min(cost)
    return cost <= times * least + more * objective.unit(least)


def _continue(
    objective: Objective,
    fits: Fits,
    lanes: np.ndarray,
    leader: np.ndarray,
    rule: StoppingRule,
) -> Fits:
    """Continue some lanes as their leaders, one fit for each leader."""
    leaders = np.unique(leader)
    again = fit(objective, fits.points.x[leaders], rule=rule)
    steps = fits.steps.copy()
    steps[leaders] += again.steps
    fits = fits._replace(steps=steps).ending(leaders, again.points, again.reasons)
    lanes, leader = lanes[lanes != leader], leader[lanes != leader]
    reasons = [fits.reasons[lane] for lane in lanes]
    for place, end in enumerate(fits.reasons[lane] for lane in leader):
        if reasons[place] is not Reason.searched:
            reasons[place] = Reason.joined if end.at_minimum else end
    return fits.ending(lanes, fits.points.take(leader), reasons)


def _leaders(objective: Objective, fits: Fits, lanes: np.ndarray) -> np.ndarray:
    """Find for each lane the one of lowest cost at the same minimum."""
    leaders: list[int] = []
    found = {}
    at_minimum = np.array([reason.at_minimum for reason in fits.reasons])
    searched = np.array([reason is Reason.searched for reason in fits.reasons])
    # A fit that has joined another in a search stands behind it at the same place.
    for lane in lanes[np.lexsort((searched[lanes], fits.points.cost[lanes]))]:
        places = [
            place
            for place in leaders
            if searched[lane] or (at_minimum[place] and at_minimum[lane])
        ]
        near = is_near(objective, fits.points, lane, np.array(places, int), ONE_PLACE)
        found[lane] = places[np.argmax(near)] if np.any(near) else lane
        if found[lane] == lane:
            leaders.append(lane)
    return np.array([found[lane] for lane in lanes])


def label_minima(objective: Objective, fits: Fits, best_cost: float) -> list[Reason]:
    """Label fits that ended in a local minimum above the best; others keep their
    reasons."""
    allowed = best_cost + SAME * (objective.unit(best_cost) + best_cost)
    return [
        Reason.above if reason.at_minimum and cost > allowed else reason
        for cost, reason in zip(fits.points.cost, fits.reasons, strict=True)
    ]

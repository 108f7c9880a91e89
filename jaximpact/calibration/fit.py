"""All starts of a study: spread out, fitted, told apart."""

import numpy as np
from scipy.special import ndtri

from ..accuracy import PRESETS
from .least_squares import Fits, Progress, is_near, levenberg_marquardt
from .objective import Objective
from .stopping import FINE, ROUGH, Patience, Reason
from .study_file import Study
from .transforms import Bounds

SPREAD = 0.02
"""Starts keep this part of the range away from the bounds."""
RUNNING = 1.02, 0.5
"""Starts whose rough cost is below this times the best, and so many s^2 more, are
fitted on."""
SMALL_BESIDE = 1e-3
"""Part of a measurement; of a sigma above it, errors of impacts at "balanced", 1e-6 and
their derivatives' 5e-4, move a fit by less than a hundredth of a standard error."""
MANY_TESTS, SOME_TESTS = 200, 100
"""Of more tests than the first, starts are told apart by about the second number, drawn
with the study's seed: where minima lie, to some standard errors, needs no more."""
ANEW = 3
"""How often a start that is stuck begins anew."""
STUCK = Reason.stuck, Reason.jump, Reason.failed
ONE_PLACE = 0.3
"""Ends of fits that are as near in x, and as good, are at one minimum."""
SAME = 1e-3
"""Part of s^2, and of the cost, by which a fit may end above the best one and still
have found it."""


def spread_starts(
    bounds: Bounds, start: np.ndarray, mean, sd, count: int, seed: int | tuple[int, ...]
) -> np.ndarray:
    """Starts `(count, unknowns)` in x: the one given, then a Latin hypercube.

    The hypercube divides each unknown's range into as many strata as there are points;
    of one that has a prior (`sd` finite), what the prior says, with its mean and sd.
    """
    random = np.random.default_rng(seed)
    others, size = count - 1, len(start)
    strata = np.stack([random.permutation(others) for _ in range(size)], axis=-1)
    part = (strata + random.random((others, size))) / max(others, 1)
    spread = bounds.at_part(SPREAD + (1.0 - 2.0 * SPREAD) * part)
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
    patience: Patience = FINE,
    progress: Progress = lambda text: None,
) -> Fits:
    """Fit from every x until each fit has a reason to stop.

    Args:
        objective: what is made small.
        x: `(lanes, unknowns)`.
        free: which unknowns are fitted, likewise; None for all. Of
            Levenberg-Marquardt alone.
        method: one of `METHODS`.
        patience: of Levenberg-Marquardt.
        progress: called with a line of text after every step.

    The same numbers, on the same machine, for the same arguments.
    """

    def make() -> Fits:
        if method == "levenberg-marquardt":
            return levenberg_marquardt(objective, x, free, patience, progress)
        # Few want optax, which takes its time to import.
        from . import first_order

        by_gradient = {"adam": first_order.adam, "l-bfgs": first_order.l_bfgs}
        return by_gradient[method](objective, x, progress)

    # Of laws whose source is not known nobody can say whether they are the same.
    if objective.memory is None or objective.laws is None:
        return make()
    return objective.memory.recall(objective, (x, free, method, patience), make)


def rough_of(objective: Objective) -> Objective:
    """The same with impacts no more accurate than tells costs apart."""
    tolerance = max(objective.accuracy.tolerance, PRESETS["fast"].tolerance)
    if tolerance == objective.accuracy.tolerance:
        return objective
    return objective.at(PRESETS["fast"])


def no_finer_than_sigmas(objective: Objective) -> Objective:
    """The same with impacts of accuracy "balanced", if that is the coarser and their
    errors are small beside every sigma."""
    study, balanced = objective.study, PRESETS["balanced"]
    known = study.known
    size = np.abs(study.measured[known])
    close = np.any(objective.sigma[known] < SMALL_BESIDE * size)
    if close or objective.accuracy.tolerance >= balanced.tolerance:
        return objective
    return objective.at(balanced)


def fit_starts(
    objective: Objective, x: np.ndarray, method: str, progress: Progress
) -> Fits:
    """Fit from every start: roughly, and where there are many tests to some of them;
    then to the end those that may be the best."""
    rough = rough_of(objective)

    def fitted(objective: Objective, progress: Progress) -> Fits:
        fits = fit(objective, x, method=method, patience=ROUGH, progress=progress)
        return _begun_anew(objective, fits, method, progress)

    if len(objective.study.measured) <= MANY_TESTS:
        return go_on(objective, fitted(rough, progress), progress)
    some = some_tests(objective.study)
    part = rough.of_tests(some)
    fits = fitted(part, lambda text: progress(f"{len(some)} tests, {text}"))
    return go_on(objective, _to_all(rough, part, fits, progress), progress)


def some_tests(study: Study) -> np.ndarray:
    """Places of tests that stand for all: of every target as many, or all that there
    are, so that none is lost that is seldom measured."""
    random = np.random.default_rng(study.seed)
    of_each = -(-SOME_TESTS // len(study.targets))
    chosen = [
        random.permutation(np.flatnonzero(measured))[:of_each]
        for measured in study.known.T
    ]
    return np.unique(np.concatenate(chosen))


def _begun_anew(
    objective: Objective, fits: Fits, method: str, progress: Progress
) -> Fits:
    """The fits, of which those that are stuck, and will not be fitted on, begin anew
    elsewhere in the range, and end there if that is lower."""
    reasons, steps = list(fits.reasons), fits.steps.copy()
    points, anew = fits.points, np.zeros(len(reasons), int)
    for number in range(1, ANEW + 1):
        stuck = np.array([reason in STUCK for reason in reasons])
        lanes = np.flatnonzero(stuck & ~_is_running(objective, points.cost))
        if not len(lanes):
            break
        x = spread_starts(
            objective.bounds,
            points.x[0],
            objective.prior_mean,
            objective.prior_sd,
            len(lanes) + 1,
            (objective.study.seed, number),
        )[1:]
        again = fit(
            objective,
            x,
            method=method,
            patience=ROUGH,
            progress=lambda text, number=number: progress(f"anew {number}, {text}"),
        )
        anew[lanes] += 1
        steps[lanes] += again.steps
        lower = again.points.cost < points.cost[lanes]
        points = points.put(lanes[lower], again.points.take(lower))
        for lane, place in zip(lanes[lower], np.flatnonzero(lower), strict=True):
            reasons[lane] = again.reasons[place]
    return Fits(points, reasons, steps, anew)


def _to_all(
    objective: Objective, part: Objective, fits: Fits, progress: Progress
) -> Fits:
    """Fits to a part of the tests, taken on to all of them where they ended at a
    minimum; elsewhere they stay."""
    leader = _leaders(part, fits, np.arange(len(fits.reasons)))
    leaders, place = np.unique(leader, return_inverse=True)
    ends = objective.values(fits.points.x[leaders])
    ended = np.array([fits.reasons[lane].at_minimum for lane in leaders])
    if not np.any(ended):
        ended[np.argmin(ends.cost)] = True
    lanes = np.flatnonzero(ended[place])
    fits = fits._replace(points=ends.take(place))
    return _fitted_on(
        *(objective, fits, lanes, leader[lanes], ROUGH),
        lambda text: progress(f"all tests, {text}"),
    )


def go_on(objective: Objective, fits: Fits, progress: Progress) -> Fits:
    """Fit those to the end that may be the best."""
    running = np.flatnonzero(_is_running(objective, fits.points.cost))
    return refit(objective, fits, running, lambda text: progress(f"refining, {text}"))


def _is_running(objective: Objective, cost: np.ndarray) -> np.ndarray:
    """Which ends may be the best."""
    times, more = RUNNING
    least = np.min(cost)
    return cost <= times * least + more * objective.unit(least)


def refit(objective: Objective, fits: Fits, lanes, progress: Progress) -> Fits:
    """Fit some of the lanes on, from where they are. Those that are at one minimum go
    on as one."""
    leader = _leaders(objective, fits, lanes)
    return _fitted_on(objective, fits, lanes, leader, FINE, progress)


def _fitted_on(
    objective: Objective,
    fits: Fits,
    lanes: np.ndarray,
    leader: np.ndarray,
    patience: Patience,
    progress: Progress,
) -> Fits:
    """The fits, of which some lanes go on as their leaders, one for each of them."""
    leaders = np.unique(leader)
    again = fit(objective, fits.points.x[leaders], patience=patience, progress=progress)
    reasons, steps = list(fits.reasons), fits.steps.copy()
    for place, reason in zip(leaders, again.reasons, strict=True):
        reasons[place] = reason
    steps[leaders] += again.steps
    points = fits.points.put(leaders, again.points)
    for lane, place in zip(lanes, leader, strict=True):
        if lane != place:
            points = points.put([lane], points.take([place]))
            alike = reasons[place].at_minimum
            reasons[lane] = Reason.joined if alike else reasons[place]
    return Fits(points, reasons, steps, fits.anew)


def _leaders(objective: Objective, fits: Fits, lanes: np.ndarray) -> np.ndarray:
    """For each of the lanes the one, of least cost, at whose minimum it is."""
    leaders: list[int] = []
    found = {}
    at_minimum = np.array([reason.at_minimum for reason in fits.reasons])
    for lane in lanes[np.argsort(fits.points.cost[lanes], kind="stable")]:
        places = [place for place in leaders if at_minimum[place] and at_minimum[lane]]
        near = is_near(objective, fits.points, lane, np.array(places, int), ONE_PLACE)
        found[lane] = places[np.argmax(near)] if np.any(near) else lane
        if found[lane] == lane:
            leaders.append(lane)
    return np.array([found[lane] for lane in lanes])


def told_apart(objective: Objective, fits: Fits, best_cost: float) -> list[Reason]:
    """Reasons of all fits, of which those that ended above the best say so."""
    allowed = best_cost + SAME * (objective.unit(best_cost) + best_cost)
    return [
        Reason.above if reason.at_minimum and cost > allowed else reason
        for cost, reason in zip(fits.points.cost, fits.reasons, strict=True)
    ]

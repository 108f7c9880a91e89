"""Profiles: the best cost with one parameter held, the others fitted again."""

import itertools
from typing import NamedTuple

import numpy as np

from .fit import fit, rough_of
from .least_squares import Progress
from .objective import Objective, Points
from .stopping import ROUGH
from .uncertainty import Uncertainty

PARTS = (0.0, 0.15, 0.3, 0.5, 0.7, 0.85, 1.0)
"""Where in its range a parameter is held."""
NEAR = (-3.0, -2.0, -1.0, 1.0, 2.0, 3.0)
"""And where about the best fit, in standard errors."""
FOLLOWED = 0.3
"""Standard errors, in x, up to which the curvature at the best fit says where the
others go: beyond, costs are no parabolas."""
ONE_SIGMA = 1.0
"""Rise of twice the cost, over the inflation, at one standard deviation."""


AGAIN = 2
"""How often points are fitted again from their neighbours."""
LOWER = 1e-2
"""Fall of the cost, in s^2, that counts as one."""
MATTERS = 50.0
"""Rise of the cost, in s^2, beyond which no point is started from: ten standard
deviations."""
ALL_HELD = -1


class LikelihoodProfile(NamedTuple):
    """A parameter's profile, its values ascending."""

    name: str
    values: np.ndarray
    """Where it was held, and its value at the best fit."""
    rise: np.ndarray
    """Of twice the cost over the inflation, from its least; 1 is one standard
    deviation."""
    low: float | None
    high: float | None
    """Beyond these the rise stays above one standard deviation, interpolated; None
    where it does not, down, or up, to the end of the range."""
    low_95: float | None
    high_95: float | None
    """Likewise for the interval of 95 %."""
    best_cost: float
    """At the best fit, to the accuracy of the profile."""
    lowest_cost: float
    """Least cost found with the parameter held."""
    lowest_x: np.ndarray
    """Where it was found."""


def profile_all(
    objective: Objective, points: Points, uncertainty: Uncertainty, progress: Progress
) -> list[LikelihoodProfile]:
    """Profiles of the soil's parameters about a fit (points of one lane), all of their
    points side by side.

    Near the best fit, of a parameter that is well known, a point starts with the other
    unknowns where the curvature there has them, else at the best fit; the last one,
    with all of them held there, gives its cost to the accuracy of the others.
    """
    rough = rough_of(objective)
    bounds, names = objective.bounds, objective.study.parameters
    best = points.x[0]
    starts, held = [], []
    for place in range(len(names)):
        error = uncertainty.standard_errors[place]
        near = best[place] + np.array(NEAR) * error
        wide = bounds.at_part(np.array(PARTS)[:, None])[:, place]
        low, high = bounds.low[place], bounds.high[place]
        near = near[(near > low) & (near < high)]
        follow = _following(points.hessian[0], place)
        for value in np.unique(np.concatenate([near, wide])):
            apart = value - best[place]
            if error <= FOLLOWED and abs(apart) <= NEAR[-1] * error:
                start = np.clip(best + follow * apart, bounds.low, bounds.high)
            else:
                start = best.copy()
            start[place] = value
            starts.append(start)
            held.append(place)
    x, held = np.array([*starts, best]), np.array([*held, ALL_HELD])
    free = np.arange(len(best)) != held[:, None]
    free[-1] = False
    fits = fit(
        rough,
        x,
        free,
        patience=ROUGH,
        progress=lambda text: progress(f"profiles, {text}"),
    )
    x, cost = fits.points.x, fits.points.cost
    doubtful = np.array([not reason.at_minimum for reason in fits.reasons])
    for number in range(1, AGAIN + 1):
        within = cost - np.min(cost) <= MATTERS * rough.unit(np.min(cost))
        lanes, begin = _from_neighbours(
            x, np.where(within, cost, np.inf), held, doubtful
        )
        if not len(lanes):
            break
        again = fit(
            rough,
            begin,
            free[lanes],
            patience=ROUGH,
            progress=lambda text, number=number: progress(
                f"profiles, again {number}, {text}"
            ),
        )
        doubtful[:] = False
        for lane, at, found in zip(
            lanes, again.points.x, again.points.cost, strict=True
        ):
            if found < cost[lane] - LOWER * rough.unit(found):
                x[lane], cost[lane], doubtful[lane] = at, found, True
    return [
        _profile(objective, place, x, cost, held, uncertainty)
        for place in range(len(names))
    ]


def _following(hessian: np.ndarray, place: int) -> np.ndarray:
    """How the unknowns follow one that is held, by a quadratic cost: their derivatives
    by it."""
    others = np.arange(len(hessian)) != place
    follow = (~others).astype(float)
    curvature = hessian[np.ix_(others, others)]
    follow[others] = -np.linalg.pinv(curvature, hermitian=True) @ hessian[others, place]
    return follow


def _from_neighbours(x, cost, held, doubtful) -> tuple[np.ndarray, np.ndarray]:
    """Points to be fitted again, and from where: from a neighbour on the profile that
    costs less, where it lies farther out, as it should not, or where one of the two is
    doubtful."""
    lanes, begin = [], []
    for place in np.unique(held[held != ALL_HELD]):
        rows = np.flatnonzero(held == place)
        rows = rows[np.argsort(x[rows, place])]
        for one, other in (*itertools.pairwise(rows), *itertools.pairwise(rows[::-1])):
            apart = np.abs(x[[one, other], place] - x[-1, place])
            farther = apart[1] > apart[0]
            if cost[other] < cost[one] and (farther or np.any(doubtful[[one, other]])):
                lanes.append(one)
                begin.append(np.where(np.arange(x.shape[1]) == place, x[one], x[other]))
    return np.array(lanes, int), np.array(begin)


def _profile(
    objective: Objective, place: int, x, cost, held, uncertainty: Uncertainty
) -> LikelihoodProfile:
    """Of one parameter, from the points at which it was held and the best fit, the
    last."""
    bounds = objective.bounds
    rows = np.flatnonzero(held == place)
    lowest = rows[np.argmin(cost[rows])]
    # At a bound the best fit is one of the points.
    along, first = np.unique(np.append(x[rows, place], x[-1, place]), return_index=True)
    costs = np.append(cost[rows], cost[-1])[first]
    rise = 2.0 * (costs - np.min(costs)) / uncertainty.inflation
    one, most = ONE_SIGMA, uncertainty.quantile**2
    ends = *_within(along, rise, one), *_within(along, rise, most)

    def value(at: float | None) -> float | None:
        if at is None:
            return None
        return float(bounds.parameter(np.full(x.shape[1], at))[place])

    return LikelihoodProfile(
        objective.study.parameters[place].name,
        np.array([value(at) for at in along]),
        rise,
        *(value(end) for end in ends),
        best_cost=float(cost[-1]),
        lowest_cost=float(cost[lowest]),
        lowest_x=x[lowest],
    )


def _within(x: np.ndarray, rise: np.ndarray, limit: float):
    """Ends of the stretch outside of which the rise stays above a limit.

    Between points the root of the rise is taken to be straight, as that of a parabola
    is.
    """
    inside = np.flatnonzero(rise <= limit)
    first, last = int(inside[0]), int(inside[-1])

    def crossing(place: int, beyond: int) -> float:
        low, high = np.sqrt(rise[place]), np.sqrt(rise[beyond])
        share = (np.sqrt(limit) - low) / (high - low)
        return float(x[place] + share * (x[beyond] - x[place]))

    low = crossing(first, first - 1) if first > 0 else None
    high = crossing(last, last + 1) if last < len(x) - 1 else None
    return low, high

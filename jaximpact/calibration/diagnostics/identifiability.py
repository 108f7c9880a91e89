r"""Identifiability: profile likelihoods, verdicts, and parameter combinations.

The profile likelihood of a parameter is the lowest cost with the parameter fixed and
all others fitted again. An interval of it holds the values at which the likelihood
ratio to the best fit is small enough,

$$ 2 \, (C(x) - C(\hat x)) / v \le q^2, $$

with q = 1 for 68 % and its quantile (`uncertainty`) for 95 %, and v the variance of the
parameter over that of the curvature alone: the likelihood, which does not know how
sigmas were estimated, is scaled as its curvature is (Pace, Salvan and Sartori 2011,
Statistica Sinica 21, 129). A parameter is identifiable where the interval has both ends
within its bounds, and where standard error, starts, prior and bounds agree with it.
"""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...progress import within
from ..estimation.least_squares import ROUGH, Fits, fit
from ..problem.bounds import Bounds
from ..problem.objective import Objective, Points
from .uncertainty import USELESS_ERROR, Uncertainty

NEAR = (1.0, 2.0, 3.0)
"""Distances from the best fit at which a parameter is fixed, in standard errors."""
FARTHER = 1.5
"""Ratio of further such distances, up to beyond the 95 % interval, which is wide where
a sigma is estimated from few measurements."""
GRID = (0.0, 0.15, 0.3, 0.5, 0.7, 0.85, 1.0)
"""Fractions of its range at which a parameter is fixed too where its 95 % interval
extends beyond these points."""
LOWER = 1e-2
"""Fall of the cost, in s^2, that counts as an improvement."""
TOGETHER = 1e-3
"""Component of a combination without information above which a parameter acts in it."""
ENDLESS_ERROR = 1e6
"""Standard error from which a parameter is said to have no influence."""


class LikelihoodProfile(NamedTuple):
    """Likelihood profile of a parameter, its values ascending."""

    name: str
    values: np.ndarray
    """Values at which it was fixed, and that of the best fit [unit of the column]."""
    rise: np.ndarray
    """Likelihood-ratio statistic: twice the rise of the cost from its minimum, over
    `profile_scale`; 1 is one standard deviation."""
    low: float | None
    high: float | None
    """Ends of the 68 % interval, interpolated; None where it reaches the bound."""
    low_95: float | None
    high_95: float | None
    """Ends of the 95 % interval, or None."""
    best_cost: float
    """Cost of the best fit at the accuracy of the profile."""
    lowest_cost: float
    """Lowest cost found with the parameter fixed."""
    lowest_x: np.ndarray
    """Unknowns x of that cost."""


@within("profiles, ")
def profile_all(
    objective: Objective, points: Points, uncertainty: Uncertainty
) -> list[LikelihoodProfile]:
    """Profile the soil's parameters about a fit (points of one lane), the points of all
    side by side: near the fit, and over the whole range where an interval extends
    farther.

    Points that ended away from a minimum, or above a neighbour farther out, are fitted
    again from their neighbours.
    """
    rough, best = objective.rough().of_measured(), points.x[0]
    errors, count = uncertainty.standard_errors, len(objective.study.parameters)
    follow = np.array(
        [_following(points.hessian[0], i, errors[i]) for i in range(count)]
    )
    best_cost, unfixed = rough.values(best[None]).cost, np.array([-1])
    fits = _Fixed(best[None], best_cost, unfixed, np.zeros(1, bool))
    low, high = rough.bounds.low, rough.bounds.high
    values = []
    for i in range(count):
        x = best[i] + errors[i] * _distances(uncertainty.quantile[i])
        values.append(x[(x > low[i]) & (x < high[i])])
    widened = np.zeros(count, bool)
    while True:
        fits = _fit_at(rough, fits, values, follow)
        _fit_again(rough, fits, follow)
        wide = ~widened
        for index in range(count):
            along, rise = _rise(fits, index, uncertainty)
            inside = rise <= uncertainty.quantile[index] ** 2
            within_range = along[0] < best[index] < along[-1]
            wide[index] &= not within_range or inside[0] or inside[-1]
        if not np.any(wide):
            break
        grid = rough.bounds.at_fraction(np.array(GRID)[:, None])
        values = [grid[:, i] if wide[i] else grid[:0, i] for i in range(count)]
        widened |= wide
    return [_profile(objective, index, fits, uncertainty) for index in range(count)]


def _distances(quantile: float) -> np.ndarray:
    """List the distances from the best fit, to either side, for a 95 % interval of so
    many standard errors."""
    distances = [*NEAR]
    while distances[-1] < quantile:
        distances.append(FARTHER * distances[-1])
    return np.array([*(-d for d in reversed(distances)), *distances])


class _Fixed(NamedTuple):
    """Fits with one unknown fixed, a lane each; the first is the best fit."""

    x: np.ndarray
    cost: np.ndarray
    fixed: np.ndarray
    """Index of the unknown that is fixed; -1 for the best fit."""
    doubtful: np.ndarray
    """Mask of those that ended away from a minimum."""


def _fit_at(
    rough: Objective, fits: _Fixed, values: list[np.ndarray], follow: np.ndarray
) -> _Fixed:
    """Add fits with each parameter fixed at its values; the others start where the
    curvature predicts them."""
    fixed = np.repeat(np.arange(len(values)), [len(x) for x in values])
    if not len(fixed):
        return fits
    best = np.repeat(fits.x[:1], len(fixed), axis=0)
    starts = _moved(rough.bounds, best, fixed, np.concatenate(values), follow)
    free = np.arange(len(fits.x[0])) != fixed[:, None]
    again = fit(rough, starts, free, tolerance=ROUGH)
    doubtful = np.array([not reason.at_minimum for reason in again.reasons])
    more = again.points.x, again.points.cost, fixed, doubtful
    return _Fixed(*map(np.concatenate, zip(fits, more, strict=True)))


def _fit_again(rough: Objective, fits: _Fixed, follow: np.ndarray) -> None:
    """Fit points from their neighbours where these are lower, in place."""
    x, cost, fixed, doubtful = fits
    for number in (1, 2):
        # No fit starts from a point beyond ten standard deviations.
        matters = cost - np.min(cost) <= 50.0 * rough.unit(np.min(cost))
        known = np.where(matters, cost, np.inf)
        lanes, others = _with_lower_neighbours(fits._replace(cost=known))
        if not len(lanes):
            break
        value = x[lanes, fixed[lanes]]
        begin = _moved(rough.bounds, x[others], fixed[lanes], value, follow)
        # Few starts are lower: one run is cheaper than a fit.
        lower = rough.values(begin).cost < cost[lanes] + LOWER * rough.unit(cost[lanes])
        lanes, begin = lanes[lower], begin[lower]
        if not len(lanes):
            break
        free = np.arange(x.shape[1]) != fixed[lanes][:, None]
        with within(f"again {number}, "):
            again = fit(rough, begin, free, tolerance=ROUGH).points
        doubtful[:] = False
        for lane, at, new in zip(lanes, again.x, again.cost, strict=True):
            if new < cost[lane] - LOWER * rough.unit(new):
                x[lane], cost[lane], doubtful[lane] = at, new, True


def _moved(bounds: Bounds, x, fixed, value, follow: np.ndarray) -> np.ndarray:
    """Move points so that one unknown of each has a value, and the others are where the
    curvature at the best fit predicts them."""
    each = np.arange(len(x))
    apart = (value - x[each, fixed])[:, None]
    moved = np.clip(x + follow[fixed] * apart, bounds.low, bounds.high)
    moved[each, fixed] = value
    return moved


def _following(hessian: np.ndarray, fixed: int, error: float) -> np.ndarray:
    """Compute the derivatives of the unknowns with respect to a fixed one, along the
    minimum of a quadratic cost. Beyond a standard error of 0.3 the cost is no parabola,
    and those of the others are 0."""
    others = np.arange(len(hessian)) != fixed
    follow = (~others).astype(float)
    if error <= 0.3:
        rest = np.linalg.pinv(hessian[np.ix_(others, others)], hermitian=True)
        follow[others] = -rest @ hessian[others, fixed]
    return follow


def _with_lower_neighbours(fits: _Fixed) -> tuple[np.ndarray, np.ndarray]:
    """Choose points to be fitted again, and the neighbours from which they start.

    A neighbour has a lower cost and lies farther out, as it should not, or one of the
    two is doubtful.
    """
    x, cost, fixed, doubtful = fits
    pairs = []
    for index in np.unique(fixed[1:]):
        rows = np.flatnonzero(fixed == index)
        rows = rows[np.argsort(x[rows, index])]
        for one, other in (*itertools.pairwise(rows), *itertools.pairwise(rows[::-1])):
            apart = np.abs(x[[one, other], index] - x[0, index])
            farther = apart[1] > apart[0]
            if cost[other] < cost[one] and (farther or np.any(doubtful[[one, other]])):
                pairs.append((one, other))
    lanes, others = np.array(pairs, int).reshape(-1, 2).T
    return lanes, others


def _profile(
    objective: Objective, index: int, fits: _Fixed, uncertainty: Uncertainty
) -> LikelihoodProfile:
    """Make the profile of one parameter from the points at which it was fixed and the
    best fit."""
    bounds, x, cost = objective.bounds, fits.x, fits.cost
    rows = np.flatnonzero(fits.fixed == index)
    lowest = rows[np.argmin(cost[rows])]
    along, rise = _rise(fits, index, uncertainty)
    limits = 1.0, uncertainty.quantile[index] ** 2
    ends = (end for limit in limits for end in _within(along, rise, limit))

    def value(at: float | None) -> float | None:
        if at is None:
            return None
        return float(bounds.parameter(np.full(x.shape[1], at))[index])

    return LikelihoodProfile(
        objective.study.parameters[index].name,
        np.array([value(at) for at in along]),
        rise,
        *(value(end) for end in ends),
        best_cost=float(cost[0]),
        lowest_cost=float(cost[lowest]),
        lowest_x=x[lowest],
    )


def _rise(
    fits: _Fixed, index: int, uncertainty: Uncertainty
) -> tuple[np.ndarray, np.ndarray]:
    """Collect the values at which a parameter was fixed and that of the best fit,
    ascending, and the likelihood-ratio statistic at each."""
    rows = np.append(np.flatnonzero(fits.fixed == index), 0)
    # At a bound the best fit is one of the points.
    along, first = np.unique(fits.x[rows, index], return_index=True)
    costs = fits.cost[rows][first]
    risen = 2.0 * (costs - np.min(costs))
    return along, risen / uncertainty.profile_scale[index]


def _within(x: np.ndarray, rise: np.ndarray, limit: float):
    """Find the interval outside which the rise stays above a limit.

    The root of the rise is interpolated linearly, as is exact for a parabola.
    """
    inside = np.flatnonzero(rise <= limit)
    first, last = int(inside[0]), int(inside[-1])

    def crossing(index: int, beyond: int) -> float:
        low, high = np.sqrt(rise[index]), np.sqrt(rise[beyond])
        fraction = (np.sqrt(limit) - low) / (high - low)
        return float(x[index] + fraction * (x[beyond] - x[index]))

    low = crossing(first, first - 1) if first > 0 else None
    high = crossing(last, last + 1) if last < len(x) - 1 else None
    return low, high


class Verdict(NamedTuple):
    """Verdict on one parameter."""

    name: str
    determined: bool
    """Whether the parameter is identifiable from the tests."""
    reason: str
    """Reason why not; empty for an identifiable parameter."""
    contradicted: bool = False
    """Whether its prior and the tests disagree, the first reason then."""


def interval_text(low: float | None, high: float | None) -> str:
    """Write a profile-likelihood interval in words; None stands for a bound. Values
    between may be excluded."""
    if low is None and high is None:
        return "no end within the bounds"
    if low is None:
        return f"below {high:.3g}"
    return f"above {low:.3g}" if high is None else f"{low:.3g} to {high:.3g}"


def judge_all(
    objective: Objective,
    best: Fits,
    uncertainty: Uncertainty,
    profiles: dict[str, LikelihoodProfile],
    ends: Fits,
    contradicted: dict[str, str],
    *,
    of_draws: bool = False,
) -> list[Verdict]:
    """Judge whether the soil's parameters are identifiable.

    Args:
        best: the reported fit, of one lane.
        ends: ends of the fits from all starts.
        contradicted: how priors contradict the tests, in words by parameter.
        of_draws: whether the uncertainty is that of draws of the posterior, which has a
            meaning where the fit is no minimum too.
    """
    bounds, x = objective.bounds, best.points.x[0]
    reached, prior = bounds.bound_reached(x), objective.prior_information(x)
    costs, of_best = (
        objective.inflated(fits.points.x, fits.points.cost, uncertainty.inflation)
        for fits in (ends, best)
    )
    risen = 2.0 * (costs - of_best)
    verdicts = []
    for place, parameter in enumerate(objective.study.parameters):
        error, reasons = float(uncertainty.standard_errors[place]), []
        if against := contradicted.get(parameter.name):
            reasons.append(against)
        if bound := reached[place]:
            value = getattr(bounds, bound)[place]
            reasons.append(f"the fit is at its {bound} bound, {value:g}")
        if not (best.reasons[0].at_minimum or of_draws):
            reasons.append(
                "the best fit is no minimum: the outcome of an impact changes there, "
                "or the fit could not be finished, so that a standard error has no "
                "meaning"
            )
        if error > USELESS_ERROR:
            others_too = partners(objective, uncertainty, place)
            reasons.append(_large_error(error, others_too))
        no_news = prior[place] > 0.0 and error > 0.9 / np.sqrt(prior[place])
        if no_news and not against:
            reasons.append("the tests add no information to its prior")
        if profile := profiles.get(parameter.name):
            reasons += _of_profile(profile, bool(reasons))
        others = ends.points.x[risen <= uncertainty.quantile[place] ** 2]
        apart = np.abs(others[:, place] - x[place])
        far = others[apart > max(3.0 * error, 0.05)]
        if len(far):
            values = bounds.parameter(np.concatenate([far, x[None]]))[:, place]
            reasons.append(
                f"fits of equal cost ended between {np.min(values):.3g} and "
                f"{np.max(values):.3g}"
            )
        words = "; ".join(reasons)
        verdicts.append(Verdict(parameter.name, not reasons, words, bool(against)))
    return verdicts


def _large_error(error: float, partners: Sequence[str]) -> str:
    if error <= ENDLESS_ERROR:
        return f"its standard error is {error:.3g} times its value or half range"
    if partners:
        names = " and ".join(partners)
        return f"it acts only together with {names}, as one combination"
    return (
        "it has no influence on the measured results, or none that the other "
        "parameters could not compensate"
    )


def _of_profile(profile: LikelihoodProfile, doubtful: bool) -> list[str]:
    """State the interval of the profile that reaches a bound, or of a parameter that is
    doubtful for other reasons."""
    level, ends = "68 %", (profile.low, profile.high)
    if None not in ends and None in (profile.low_95, profile.high_95):
        level, ends = "95 %", (profile.low_95, profile.high_95)
    if None not in ends and not doubtful:
        return []
    return [f"{level} profile-likelihood interval: {interval_text(*ends)}"]


def partners(objective: Objective, uncertainty: Uncertainty, place: int) -> list[str]:
    """Name the parameters that compensate one in combinations without information."""
    endless = uncertainty.eigenvalues < 1.0 / ENDLESS_ERROR**2
    vectors = np.abs(uncertainty.eigenvectors[:, endless])
    shared = vectors[:, vectors[place] > TOGETHER]
    names = [parameter.name for parameter in objective.study.parameters]
    return [
        name
        for other, name in enumerate(names)
        if other != place and np.any(shared[other] > TOGETHER)
    ]


def directions(names, bounds: Bounds, uncertainty: Uncertainty) -> list[str]:
    """Describe the eigenvectors of the Fisher matrix and their errors, best known
    first."""
    lines = []
    values, vectors = uncertainty.eigenvalues, uncertainty.eigenvectors.T
    for value, vector in zip(values[::-1], vectors[::-1], strict=True):
        error = 1.0 / np.sqrt(max(value, 1e-300))
        known = f"known to {100 * error:.3g} % (eigenvalue {value:.4g})"
        if error > USELESS_ERROR:
            known = f"not identifiable (eigenvalue {value:.3g})"
        lines.append(f"{combination(names, bounds, vector)}: {known}")
    return lines


def combination(names, bounds: Bounds, vector) -> str:
    """Write an eigenvector as a product of powers, the largest exponent 1.

    A parameter in linear space is written as exp(p / half its range).
    """
    vector = np.asarray(vector) / vector[np.argmax(np.abs(vector))]
    factors = []
    for place, exponent in enumerate(vector):
        if abs(exponent) < 0.1:
            continue
        name = names[place]
        if not bounds.logarithmic[place]:
            half = float(bounds.upper[place] - bounds.lower[place]) / 2
            name = f"exp({name}/{half:g})"
        power = f"^{exponent:.2f}" if abs(exponent - 1.0) > 5e-3 else ""
        factors.append(name + power)
    return " ".join(factors)

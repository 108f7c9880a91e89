r"""Identifiability: profile likelihoods, verdicts, and parameter combinations.

The profile likelihood of a parameter is the lowest cost with the parameter fixed and
all others fitted again. An interval of it holds the values at which the likelihood
ratio to the best fit is small enough,

$$ 2 \, (C(x) - C(\hat x)) / s^2 \le q^2, $$

with q = 1 for 68 % and about 2 for 95 %. A parameter is identifiable where the interval
has both ends within its bounds, and where standard error, starts, prior and bounds
agree with it.
"""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...progress import Progress
from ..estimation.least_squares import ROUGH, Fits
from ..estimation.starts import fit
from ..problem.bounds import Bounds
from ..problem.objective import Objective, Points
from .uncertainty import USELESS_ERROR, Uncertainty

GRID = (0.0, 0.15, 0.3, 0.5, 0.7, 0.85, 1.0)
"""Fractions of its range at which a parameter is fixed."""
NEAR = (-3.0, -2.0, -1.0, 1.0, 2.0, 3.0)
"""Points about the best fit at which it is fixed too, in standard errors."""
FOLLOWED = 0.3
"""Standard error, in x, up to which the curvature at the best fit predicts the others:
beyond, the cost is no parabola."""
ONE_SIGMA = 1.0
"""Likelihood-ratio statistic at the ends of the 68 % interval."""
AGAIN = 2
"""Rounds in which points are fitted again from their neighbours."""
LOWER = 1e-2
"""Fall of the cost, in s^2, that counts as an improvement."""
MATTERS = 50.0
"""Rise of the cost, in s^2, beyond which no fit starts from a point: ten standard
deviations."""
ALL_FIXED = -1
FAR_OFF, FAR_OFF_AT_LEAST = 3.0, 0.05
"""Standard errors, and difference in x, beyond which a fit of equal cost is another
one."""
SILENT = 0.9
"""Fraction of a prior's standard error above which the tests add no information."""
SMALL_EXPONENT = 0.1
"""Exponents below this are left out of a parameter combination."""
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
    """Likelihood-ratio statistic: twice the rise of the cost from its minimum, over the
    inflation; 1 is one standard deviation."""
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


def profile_all(
    objective: Objective, points: Points, uncertainty: Uncertainty, progress: Progress
) -> list[LikelihoodProfile]:
    """Profile the soil's parameters about a fit (points of one lane), all points side
    by side.

    The last lane, with all unknowns fixed at the best fit, gives its cost at the
    accuracy of the others. Points that ended away from a minimum, or above a neighbour
    farther out, are fitted again from their neighbours.
    """
    rough, best = objective.rough().of_measured(), points.x[0]
    starts, fixed = _profile_starts(objective, points, uncertainty)
    x, fixed = np.array([*starts, best]), np.array([*fixed, ALL_FIXED])
    free = np.arange(len(best)) != fixed[:, None]
    free[-1] = False
    progress = progress.within("profiles, ")
    fits = fit(rough, x, free, rule=ROUGH, progress=progress)
    x, cost = fits.points.x, fits.points.cost
    doubtful = np.array([not reason.at_minimum for reason in fits.reasons])
    for number in range(1, AGAIN + 1):
        within = cost - np.min(cost) <= MATTERS * rough.unit(np.min(cost))
        known = np.where(within, cost, np.inf)
        lanes, begin = _from_neighbours(x, known, fixed, doubtful)
        if not len(lanes):
            break
        tell = progress.within(f"again {number}, ")
        again = fit(rough, begin, free[lanes], rule=ROUGH, progress=tell).points
        doubtful[:] = False
        for lane, at, found in zip(lanes, again.x, again.cost, strict=True):
            if found < cost[lane] - LOWER * rough.unit(found):
                x[lane], cost[lane], doubtful[lane] = at, found, True
    return [
        _profile(objective, index, x, cost, fixed, uncertainty)
        for index in range(len(objective.study.parameters))
    ]


def _profile_starts(
    objective: Objective, points: Points, uncertainty: Uncertainty
) -> tuple[list[np.ndarray], list[int]]:
    """Choose where each parameter is fixed and where the fit of the others starts.

    Near the best fit, and where a parameter is well known, the others start where the
    curvature predicts them, elsewhere at the best fit.
    """
    bounds, best = objective.bounds, points.x[0]
    starts, fixed = [], []
    for index in range(len(objective.study.parameters)):
        error = uncertainty.standard_errors[index]
        near = best[index] + np.array(NEAR) * error
        wide = bounds.at_fraction(np.array(GRID)[:, None])[:, index]
        near = near[(near > bounds.low[index]) & (near < bounds.high[index])]
        follow = _following(points.hessian[0], index)
        for value in np.unique(np.concatenate([near, wide])):
            apart = value - best[index]
            start = best.copy()
            if error <= FOLLOWED and abs(apart) <= NEAR[-1] * error:
                start = np.clip(best + follow * apart, bounds.low, bounds.high)
            start[index] = value
            starts.append(start)
            fixed.append(index)
    return starts, fixed


def _following(hessian: np.ndarray, fixed: int) -> np.ndarray:
    """Compute the derivatives of the unknowns with respect to a fixed one, along the
    minimum of a quadratic cost."""
    others = np.arange(len(hessian)) != fixed
    follow = (~others).astype(float)
    curvature = hessian[np.ix_(others, others)]
    follow[others] = -np.linalg.pinv(curvature, hermitian=True) @ hessian[others, fixed]
    return follow


def _from_neighbours(x, cost, fixed, doubtful) -> tuple[np.ndarray, np.ndarray]:
    """Choose points to be fitted again, and their starts.

    They start from a neighbour of lower cost that lies farther out, as it should not,
    or where one of the two is doubtful.
    """
    lanes, begin = [], []
    for index in np.unique(fixed[fixed != ALL_FIXED]):
        rows = np.flatnonzero(fixed == index)
        rows = rows[np.argsort(x[rows, index])]
        for one, other in (*itertools.pairwise(rows), *itertools.pairwise(rows[::-1])):
            apart = np.abs(x[[one, other], index] - x[-1, index])
            farther = apart[1] > apart[0]
            if cost[other] < cost[one] and (farther or np.any(doubtful[[one, other]])):
                lanes.append(one)
                begin.append(np.where(np.arange(x.shape[1]) == index, x[one], x[other]))
    return np.array(lanes, int), np.array(begin)


def _profile(
    objective: Objective, index: int, x, cost, fixed, uncertainty: Uncertainty
) -> LikelihoodProfile:
    """Make the profile of one parameter from the points at which it was fixed and the
    best fit, the last point."""
    bounds = objective.bounds
    rows = np.flatnonzero(fixed == index)
    lowest = rows[np.argmin(cost[rows])]
    # At a bound the best fit is one of the points.
    along, first = np.unique(np.append(x[rows, index], x[-1, index]), return_index=True)
    costs = np.append(cost[rows], cost[-1])[first]
    rise = 2.0 * (costs - np.min(costs)) / uncertainty.inflation
    limits = ONE_SIGMA, uncertainty.quantile**2
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
        best_cost=float(cost[-1]),
        lowest_cost=float(cost[lowest]),
        lowest_x=x[lowest],
    )


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


def interval_text(low: float | None, high: float | None) -> str:
    """Write a profile-likelihood interval in words; None stands for a bound."""
    if low is None and high is None:
        return "all values between the bounds"
    if low is None:
        return f"below {high:.3g}"
    return f"above {low:.3g}" if high is None else f"{low:.3g} to {high:.3g}"


def judge_all(
    objective: Objective,
    best: Fits,
    uncertainty: Uncertainty,
    profiles: dict[str, LikelihoodProfile],
    ends: Fits,
) -> list[Verdict]:
    """Judge whether the soil's parameters are identifiable.

    Args:
        best: the reported fit, of one lane.
        ends: ends of the fits from all starts.
    """
    bounds, x = objective.bounds, best.points.x[0]
    reached, prior = bounds.bound_reached(x), objective.prior_information(x)
    allowed = 0.5 * uncertainty.inflation * uncertainty.quantile**2
    others = ends.points.x[ends.points.cost <= best.points.cost[0] + allowed]
    verdicts = []
    for place, parameter in enumerate(objective.study.parameters):
        error, reasons = float(uncertainty.standard_errors[place]), []
        if bound := reached[place]:
            value = getattr(bounds, bound)[place]
            reasons.append(f"the fit is at its {bound} bound, {value:g}")
        if not best.reasons[0].at_minimum:
            reasons.append(
                "the best fit is no minimum: the outcome of an impact changes there, "
                "or the fit could not be finished, so that a standard error has no "
                "meaning"
            )
        if error > USELESS_ERROR:
            reasons.append(_large_error(error, partners(objective, uncertainty, place)))
        if prior[place] > 0.0 and error > SILENT * (1.0 / np.sqrt(prior[place])):
            reasons.append("the tests add no information to its prior")
        if profile := profiles.get(parameter.name):
            reasons += _of_profile(profile, bool(reasons))
        apart = np.abs(others[:, place] - x[place])
        far = others[apart > max(FAR_OFF * error, FAR_OFF_AT_LEAST)]
        if len(far):
            values = bounds.parameter(np.concatenate([far, x[None]]))[:, place]
            reasons.append(
                f"starts of equal cost ended between {np.min(values):.3g} and "
                f"{np.max(values):.3g}"
            )
        verdicts.append(Verdict(parameter.name, not reasons, "; ".join(reasons)))
    return verdicts


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
        if abs(exponent) < SMALL_EXPONENT:
            continue
        name = names[place]
        if not bounds.logarithmic[place]:
            half = float(bounds.upper[place] - bounds.lower[place]) / 2
            name = f"exp({name}/{half:g})"
        power = f"^{exponent:.2f}" if abs(exponent - 1.0) > 5e-3 else ""
        factors.append(name + power)
    return " ".join(factors)

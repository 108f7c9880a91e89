"""What the data determine, in words."""

from typing import NamedTuple

import numpy as np

from .least_squares import Fits
from .likelihood_profile import LikelihoodProfile
from .objective import Objective
from .transforms import Bounds
from .uncertainty import USELESS_ERROR, Uncertainty

SMALL_EXPONENT = 0.1
"""Exponents below this are left out where a combination is named."""

ENDLESS_ERROR = 1e6
"""A standard error above this is named as none."""

FAR_OFF, FAR_OFF_AT_LEAST = 3.0, 0.05
"""Standard errors, and a difference in x, beyond which a fit that is as good is another
one."""
SILENT = 0.9
"""Part of a prior's standard error above which the data have said nothing."""


class Verdict(NamedTuple):
    """On one parameter."""

    name: str
    determined: bool
    reason: str
    """Why not; empty for a parameter that is determined."""


def judge(
    name: str,
    error: float,
    bound: str | None,
    bound_value: float,
    profile: LikelihoodProfile | None,
    others: tuple[float, float] | None = None,
    prior_error: float = np.inf,
    at_minimum: bool = True,
) -> Verdict:
    """Verdict on a parameter.

    Args:
        error: standard error, relative to the value or to half the range.
        bound: "lower" or "upper" where the fit has run there, else None.
        bound_value: of that bound.
        profile: if there is one.
        others: least and largest value at the ends of other starts that fit as well,
            if any lies far off.
        prior_error: standard error that the prior alone would give.
        at_minimum: whether the best fit is one.
    """
    reasons = []
    if bound is not None:
        reasons.append(f"the fit runs to its {bound} bound, {bound_value:g}")
    if not at_minimum:
        reasons.append(
            "the best fit stands where the outcome of an impact changes, or could not "
            "be finished, and a standard error means nothing there"
        )
    if error > USELESS_ERROR:
        reasons.append(_large_error(error))
    if error > SILENT * prior_error:
        reasons.append("the data add nothing to its prior")
    if profile is not None and (profile.low is None or profile.high is None):
        reasons.append(
            _open_stretch(profile.low, profile.high, "one standard deviation")
        )
    elif profile is not None and (profile.low_95 is None or profile.high_95 is None):
        reasons.append(
            _open_stretch(
                profile.low_95, profile.high_95, "the interval of 95 % allows"
            )
        )
    elif profile is not None and reasons:
        reasons.append(
            f"the fits with it held between {profile.low:.3g} and {profile.high:.3g} "
            "are within one standard deviation of the best"
        )
    if others is not None:
        reasons.append(
            f"other starts fit as well with it between {others[0]:.3g} and "
            f"{others[1]:.3g}"
        )
    return Verdict(name, not reasons, "; ".join(reasons))


def _large_error(error: float) -> str:
    if error > ENDLESS_ERROR:
        return (
            "it has no influence on what was measured, or none that the others could "
            "not make up for"
        )
    return f"its standard error is {error:.3g} times its value, or half its range"


def _open_stretch(low: float | None, high: float | None, less_than: str) -> str:
    if low is None and high is None:
        where = "anywhere between its bounds"
    elif low is None:
        where = f"anywhere from its lower bound to {high:.3g}"
    else:
        where = f"anywhere from {low:.3g} to its upper bound"
    return f"held {where} it costs less than {less_than}"


def judge_all(
    objective: Objective,
    best: Fits,
    uncertainty: Uncertainty,
    profiles: dict[str, LikelihoodProfile],
    ends: Fits | None = None,
) -> list[Verdict]:
    """Verdicts on the soil's parameters.

    Args:
        best: the fit that is reported, of one lane.
        ends: of all starts.
    """
    bounds, x = objective.bounds, best.points.x[0]
    reached = bounds.bound_reached(x)
    prior = objective.prior_information(x)
    others = np.empty((0, len(x)))
    if ends is not None:
        allowed = 0.5 * uncertainty.inflation * uncertainty.quantile**2
        alike = ends.points.cost <= best.points.cost[0] + allowed
        others = ends.points.x[alike]
    verdicts = []
    for place, parameter in enumerate(objective.study.parameters):
        error = float(uncertainty.standard_errors[place])
        apart = np.abs(others[:, place] - x[place])
        far = others[apart > max(FAR_OFF * error, FAR_OFF_AT_LEAST)]
        span = None
        if len(far):
            values = bounds.parameter(np.concatenate([far, x[None]]))[:, place]
            span = float(np.min(values)), float(np.max(values))
        known = prior[place]
        verdicts.append(
            judge(
                parameter.name,
                error,
                reached[place],
                float(getattr(bounds, reached[place] or "lower")[place]),
                profiles.get(parameter.name),
                span,
                float(1.0 / np.sqrt(known)) if known > 0.0 else np.inf,
                best.reasons[0].at_minimum,
            )
        )
    return verdicts


def directions(names, bounds: Bounds, uncertainty: Uncertainty) -> list[str]:
    """What is known along each eigenvector of the Fisher matrix, best known first."""
    lines = []
    for value, vector in zip(
        uncertainty.eigenvalues[::-1], uncertainty.eigenvectors.T[::-1], strict=True
    ):
        error = 1.0 / np.sqrt(max(value, 1e-300))
        what = combination(names, bounds, vector)
        if error > USELESS_ERROR:
            lines.append(f"{what}: not determined (eigenvalue {value:.3g})")
        else:
            lines.append(
                f"{what}: known to {100 * error:.3g} % (eigenvalue {value:.4g})"
            )
    return lines


def combination(names, bounds: Bounds, vector) -> str:
    """An eigenvector as a product of powers, the largest exponent 1.

    A parameter in linear space stands as exp(p / half its range).
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

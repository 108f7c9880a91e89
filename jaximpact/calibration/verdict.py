"""What the data determine, in words."""

from typing import NamedTuple

import numpy as np

from .likelihood_profile import LikelihoodProfile
from .transforms import Bounds
from .uncertainty import USELESS_ERROR, Uncertainty

SMALL_EXPONENT = 0.1
"""Exponents below this are left out where a combination is named."""

ENDLESS_ERROR = 1e6
"""A standard error above this is named as none."""


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
) -> Verdict:
    """Verdict on a parameter.

    Args:
        error: standard error, relative to the value or to half the range.
        bound: "lower" or "upper" where the fit has run there, else None.
        bound_value: of that bound.
        profile: if there is one.
    """
    reasons = []
    if bound is not None:
        reasons.append(f"the fit runs to its {bound} bound, {bound_value:g}")
    if error > USELESS_ERROR:
        reasons.append(_large_error(error))
    if profile is not None and (profile.low is None or profile.high is None):
        reasons.append(_flat_stretch(profile))
    elif profile is not None and reasons:
        reasons.append(
            f"the fits with it held between {profile.low:.3g} and {profile.high:.3g} "
            "are within one standard deviation of the best"
        )
    return Verdict(name, not reasons, "; ".join(reasons))


def _large_error(error: float) -> str:
    if error > ENDLESS_ERROR:
        return "it has no influence on what was measured"
    return f"its standard error is {error:.3g} times its value, or half its range"


def _flat_stretch(profile: LikelihoodProfile) -> str:
    if profile.low is None and profile.high is None:
        where = "anywhere between its bounds"
    elif profile.low is None:
        where = f"anywhere from its lower bound to {profile.high:.3g}"
    else:
        where = f"anywhere from {profile.low:.3g} to its upper bound"
    return f"held {where} it costs less than one standard deviation"


def judge_all(
    names,
    parameters,
    bounds: Bounds,
    uncertainty: Uncertainty,
    profiles: dict[str, LikelihoodProfile],
) -> list[Verdict]:
    """Verdicts on all parameters."""
    reached = bounds.bound_reached(parameters)
    verdicts = []
    for place, name in enumerate(names):
        ends = {"lower": bounds.lower, "upper": bounds.upper}
        value = float(ends[reached[place]][place]) if reached[place] else float("nan")
        error = float(uncertainty.standard_errors[place])
        verdicts.append(judge(name, error, reached[place], value, profiles.get(name)))
    return verdicts


def weakest_first(bounds: Bounds, parameters, uncertainty: Uncertainty) -> list[int]:
    """Places of the parameters, those at a bound first, then by standard error."""
    at_bound = [bound is not None for bound in bounds.bound_reached(parameters)]
    return sorted(
        range(len(at_bound)),
        key=lambda i: (not at_bound[i], -uncertainty.standard_errors[i]),
    )


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

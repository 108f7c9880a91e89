"""How good predictions of tests were that the fit had not seen."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .prediction import Prediction, VariantPrediction


class Scores(NamedTuple):
    """Of one target; None where there is nothing to tell it from."""

    count: int
    """Measurements that are no limits and have a prediction."""
    unpredicted: int
    """Measurements and limits without one."""
    rms: float | None
    """Of predicted (median) less measured."""
    bias: float | None
    """Mean of that."""
    inside_50: int
    """How many lie in their intervals of 50 %."""
    inside_95: int
    crps: float | None
    """Mean, in the unit of the target; see `predictive`."""
    mean_rms: float | None
    """Of the fitted tests' mean as the forecast."""
    mean_crps: float | None
    skill: float | None
    """1 - crps / mean_crps: 1 is perfect, 0 as good as that mean, below 0 worse."""
    limits: int
    limits_expected: float
    """How many of them the prediction expects to be kept, as a sum of chances."""


def score(prediction: "Prediction", variant: "VariantPrediction") -> dict[str, Scores]:
    """Scores of every target of which anything was measured."""
    found = {}
    for place, name in enumerate(prediction.targets):
        known = np.isfinite(prediction.measured[:, place])
        if np.any(known):
            found[name] = _score(prediction, variant, name, place, known)
    return found


def _score(prediction, variant, name: str, place: int, known) -> Scores:
    limit = known & (prediction.censored[:, place] != 0)
    there = np.isfinite(variant.middle[:, place])
    exact = known & ~limit & there
    measured = prediction.measured[exact, place]
    apart = variant.middle[exact, place] - measured
    inside = [
        (measured >= getattr(variant, f"low_{percent}")[exact, place])
        & (measured <= getattr(variant, f"high_{percent}")[exact, place])
        for percent in (50, 95)
    ]
    results = prediction.ground.results.get(name, {"count": 0})
    crps, mean_crps = (
        _mean(part[exact, place]) for part in (variant.crps, variant.mean_crps)
    )
    mean_rms = _rms(results["mean"] - measured) if results["count"] else None
    return Scores(
        count=int(np.sum(exact)),
        unpredicted=int(np.sum(known & ~there)),
        rms=_rms(apart),
        bias=_mean(apart),
        inside_50=int(np.sum(inside[0])),
        inside_95=int(np.sum(inside[1])),
        crps=crps,
        mean_rms=mean_rms,
        mean_crps=mean_crps,
        skill=1.0 - crps / mean_crps if mean_crps else None,
        limits=int(np.sum(limit & there)),
        limits_expected=float(np.sum(variant.limit_chance[limit & there, place])),
    )


def _mean(values) -> float | None:
    return (
        float(np.mean(values)) if len(values) and np.all(np.isfinite(values)) else None
    )


def _rms(values) -> float | None:
    return float(np.sqrt(np.mean(values**2))) if len(values) else None

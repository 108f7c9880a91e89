"""Profiles: the best cost with one parameter held, the others fitted again."""

from typing import NamedTuple

import numpy as np

from .fit import ROUGH, Progress, fit
from .solver import Stepper
from .transforms import logit

PARTS = (0.02, 0.2, 0.4, 0.6, 0.8, 0.98)
"""Where in its range a parameter is held."""
ONE_SIGMA = 1.0
"""Rise of the sum of squares, over its variance, at one standard deviation."""


class LikelihoodProfile(NamedTuple):
    """A parameter's profile, its values ascending."""

    name: str
    values: np.ndarray
    """Where it was held, and its value at the best fit."""
    rise: np.ndarray
    """Of the sum of squared residuals over s^2, from its least; 1 is one standard
    deviation."""
    low: float | None
    high: float | None
    """Between these the rise stays below one standard deviation, interpolated; None
    where it does so down, or up, to the end of the range."""
    best_cost: float
    """At the best fit, to the accuracy of the profile."""
    lowest_cost: float
    """Least cost found with the parameter held."""
    lowest_z: np.ndarray
    """Where it was found."""


def profile_all(
    stepper: Stepper,
    chosen: list[int],
    best_z,
    variance: float,
    progress: Progress,
) -> list[LikelihoodProfile]:
    """Profiles of the parameters at the places chosen, all points side by side.

    Every point starts with the other parameters at the best fit; the last one, with all
    of them held there, gives its cost to the accuracy of the others.
    """
    best_z = np.asarray(best_z)
    anchor = np.repeat(best_z[None], len(chosen) * len(PARTS) + 1, axis=0)
    free = np.ones_like(anchor)
    free[-1] = 0.0
    for k, place in enumerate(chosen):
        rows = slice(k * len(PARTS), (k + 1) * len(PARTS))
        anchor[rows, place] = logit(np.asarray(PARTS))
        free[rows, place] = 0.0
    fits = fit(
        stepper,
        anchor,
        free,
        anchor,
        patience=ROUGH,
        progress=lambda text: progress(f"profiles, {text}"),
    )
    reached = np.where(free > 0, fits.lanes.z, anchor)
    profiles = []
    for k, place in enumerate(chosen):
        rows = slice(k * len(PARTS), (k + 1) * len(PARTS))
        profiles.append(
            _of_parameter(
                stepper,
                place,
                best_z,
                np.append(fits.cost[rows], fits.cost[-1]),
                reached[rows],
                variance,
            )
        )
    return profiles


def _of_parameter(
    stepper: Stepper, place: int, best_z, costs, reached, variance: float
) -> LikelihoodProfile:
    """Profile from the costs of its points, that of the best fit last."""
    bounds = stepper.case.bounds
    best = np.asarray(bounds.parameter(best_z))
    best_part = np.asarray(bounds.part(best))

    def value_at(part: float | None) -> float | None:
        if part is None:
            return None
        parts = best_part.copy()
        parts[place] = part
        return float(bounds.at_part(parts)[place])

    parts = np.append(PARTS, best_part[place])
    order = np.argsort(parts, kind="stable")
    rise = 2.0 * (costs - np.min(costs))[order] / variance
    low, high = _within(parts[order], rise)
    lowest = int(np.argmin(costs[:-1]))
    return LikelihoodProfile(
        name=stepper.program.fitted[place],
        values=np.array([value_at(part) for part in parts[order]]),
        rise=rise,
        low=value_at(low),
        high=value_at(high),
        best_cost=float(costs[-1]),
        lowest_cost=float(costs[lowest]),
        lowest_z=reached[lowest],
    )


def _within(part: np.ndarray, rise: np.ndarray) -> tuple[float | None, float | None]:
    """Ends of the stretch about the least rise in which it stays below one sigma."""
    least = int(np.argmin(rise))

    def crossing(places) -> float | None:
        inside = least
        for place in places:
            if not rise[place] < ONE_SIGMA:
                share = (ONE_SIGMA - rise[inside]) / (rise[place] - rise[inside])
                if not np.isfinite(share):
                    share = 0.0
                return float(part[inside] + share * (part[place] - part[inside]))
            inside = place
        return None

    return crossing(range(least - 1, -1, -1)), crossing(range(least + 1, len(part)))

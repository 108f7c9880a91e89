"""Profiles: the best cost with one parameter held, the others fitted again."""

from typing import NamedTuple

import numpy as np

from .fit import ROUGH, Progress, fit
from .solver import Stepper

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
    lowest_cost: float
    """Least cost found with the parameter held."""
    lowest_z: np.ndarray
    """Where it was found."""


def profile(
    stepper: Stepper,
    place: int,
    best_z,
    best_cost: float,
    variance: float,
    progress: Progress,
) -> LikelihoodProfile:
    """Profile of the parameter at `place`.

    Every point starts with the other parameters at the best fit.
    """
    bounds = stepper.case.bounds
    name = stepper.program.fitted[place]
    best_z = np.asarray(best_z)
    best = np.asarray(bounds.parameter(best_z))
    held = np.repeat(best[None], len(PARTS), axis=0)
    parts = np.repeat(bounds.part(best)[None], len(PARTS), axis=0)
    parts[:, place] = PARTS
    held[:, place] = bounds.at_part(parts)[:, place]
    anchor = np.repeat(best_z[None], len(PARTS), axis=0)
    anchor[:, place] = np.log(PARTS) - np.log1p(-np.asarray(PARTS))
    free = np.ones_like(anchor)
    free[:, place] = 0.0
    fits = fit(
        stepper,
        anchor,
        free,
        anchor,
        patience=ROUGH,
        progress=lambda text: progress(f"profile of {name}, {text}"),
    )
    values = np.append(held[:, place], best[place])
    costs = np.append(fits.cost, best_cost)
    order = np.argsort(values, kind="stable")
    values, costs = values[order], costs[order]
    rise = 2.0 * (costs - np.min(costs)) / variance
    part = np.sort(np.append(PARTS, bounds.part(best)[place]))
    low, high = _within(part, rise)

    def value_at(where):
        if where is None:
            return None
        all_parts = bounds.part(best).copy()
        all_parts[place] = where
        return float(bounds.at_part(all_parts)[place])

    return LikelihoodProfile(
        name=name,
        values=values,
        rise=rise,
        low=value_at(low),
        high=value_at(high),
        lowest_cost=float(fits.cost[fits.best]),
        lowest_z=np.where(
            free[fits.best] > 0, fits.lanes.z[fits.best], anchor[fits.best]
        ),
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

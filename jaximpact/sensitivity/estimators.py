"""Indices from samples some of which failed.

The estimators compare impacts that belong together: a block of Saltelli's, a trajectory
of Morris's. Where one of them has no value, none of its group is used, and the group is
counted. A mean in its place would draw the indices towards nothing; the other impacts
of the group alone would compare what does not belong together.

What is left is a sample of where the model has values. If failures gather in a corner
of the ranges, the indices are those of the rest.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

RESAMPLES = 200
"""Of the bootstrap."""
CONFIDENCE = 0.95
LEAST_KEPT = 0.5
"""Part of the groups that must be left."""
LEVELS = 4
"""Of the grid on which Morris's trajectories run; the usual number."""
CONSTANT_WITHIN = 1e-12
"""Spread over size of an output below which it counts as constant."""


class Kept(NamedTuple):
    """What an estimate rests on."""

    kept: int
    dropped: int
    reason: str
    """Why there is no estimate; empty where there is one."""


class Sobol(NamedTuple):
    """Indices of one output; intervals are half widths of 95 %."""

    first_order: Float[np.ndarray, " parameters"]
    first_order_interval: Float[np.ndarray, " parameters"]
    total_order: Float[np.ndarray, " parameters"]
    total_order_interval: Float[np.ndarray, " parameters"]
    mean: float
    standard_deviation: float
    groups: Kept


class Morris(NamedTuple):
    """Effects on one output, in its unit over the whole range of a parameter."""

    mean_effect: Float[np.ndarray, " parameters"]
    mean_absolute_effect: Float[np.ndarray, " parameters"]
    mean_absolute_effect_interval: Float[np.ndarray, " parameters"]
    effect_deviation: Float[np.ndarray, " parameters"]
    groups: Kept


def problem_of(names) -> dict:
    """What SALib needs to know: parameters between 0 and 1. SALib writes into it, so it
    is made anew each time."""
    names = list(names)
    bounds = [[0.0, 1.0]] * len(names)
    return {"num_vars": len(names), "names": names, "bounds": bounds}


def sobol_of(values: Float[np.ndarray, "blocks rows"], seed: int) -> Sobol:
    """First-order and total indices from blocks of Saltelli's sample.

    Args:
        values: a row for each block, in SALib's order: A, then A with each parameter
            from B, then B; NaN where there is none.
        seed: of the bootstrap.

    Source: Saltelli et al. (2010), doi 10.1016/j.cpc.2009.09.018, as SALib computes it.
    """
    from SALib.analyze import sobol as salib  # a second, for pandas and SciPy

    parameters = values.shape[1] - 2
    whole, groups = _whole(values)
    ends = whole[:, [0, -1]]
    if groups.reason:
        nothing = np.full(parameters, np.nan)
        return Sobol(*[nothing] * 4, np.nan, np.nan, groups)
    found = salib.analyze(
        problem_of(map(str, range(parameters))),
        whole.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=seed + 1,  # SALib takes 0 for none
    )
    of_indices = (found[name] for name in ("S1", "S1_conf", "ST", "ST_conf"))
    return Sobol(*of_indices, float(ends.mean()), float(ends.std()), groups)


def morris_of(
    shares: Float[np.ndarray, "trajectories rows parameters"],
    values: Float[np.ndarray, "trajectories rows"],
    seed: int,
) -> Morris:
    """Elementary effects from trajectories.

    Args:
        shares: of the ranges, 0 to 1, from SALib's sample.
        values: NaN where there is none.
        seed: of the bootstrap.

    Source: Morris (1991), doi 10.1080/00401706.1991.10484804, and Campolongo et al.
    (2007), doi 10.1016/j.envsoft.2006.10.004, as SALib computes it.
    """
    from SALib.analyze import morris as salib

    parameters = shares.shape[2]
    whole, groups = _whole(values)
    if groups.reason:
        return Morris(*[np.full(parameters, np.nan)] * 4, groups)
    taken = np.isfinite(values).all(axis=1)
    found = salib.analyze(
        problem_of(map(str, range(parameters))),
        shares[taken].reshape(-1, parameters),
        whole.ravel(),
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        num_levels=LEVELS,
        seed=seed,
    )
    names = ("mu", "mu_star", "mu_star_conf", "sigma")
    return Morris(*(np.asarray(found[name], float) for name in names), groups)


def _whole(values: np.ndarray) -> tuple[np.ndarray, Kept]:
    """The groups that have all their values, and what is to be said of them."""
    taken = np.isfinite(values).all(axis=1)
    whole = values[taken]
    kept, dropped = int(taken.sum()), int((~taken).sum())
    if kept < max(2, LEAST_KEPT * len(values)):
        words = "no group" if kept == 0 else "less than half of the groups"
        return whole, Kept(kept, dropped, f"{words} has all its values")
    if np.ptp(whole) <= CONSTANT_WITHIN * np.abs(whole).max():
        return whole, Kept(kept, dropped, "the output does not change")
    return whole, Kept(kept, dropped, "")

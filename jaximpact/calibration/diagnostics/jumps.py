"""Measurements near a jump: what they leave out of the uncertainty, and how to say so.

A prediction that jumps within the confidence region of the fit (see
`estimation.branches`) has no derivative that holds there. The fit uses its measurement,
as any other. Standard errors and profiles leave it out: they are conditional on the
branches of the impacts, and of the predictions that are smooth. Other results of the
same test stay: where a contact ends in another way, e_t and duration jump, but not the
largest force and depth, which came before.
"""

import numpy as np

from ..estimation.branches import NEAR, jump_shares, unit_without_jumps
from ..estimation.least_squares import Fits
from ..problem.objective import Objective
from .cross_validation import LeftOut
from .uncertainty import estimate

FEWEST_LEFT = 2
"""Measurements away from jumps that there must be for each unknown; with fewer none is
left out."""
MOST_NAMED = 8
"""Largest number of tests that are named."""


def shares_of(objective: Objective, best: Fits) -> np.ndarray:
    """Compute the share of the confidence region beyond a jump of each prediction,
    shape (tests, targets).

    Where the misfit is larger than the given sigmas allow, jumps are judged by the
    scatter of the residuals: relative to sigmas that are far too small every
    prediction would seem to jump.

    Args:
        best: the reported fit, of one lane.
    """
    if estimate(objective, best.points).inflation > 1.0:
        scale = np.sqrt(unit_without_jumps(objective, best.points))
        objective = objective.with_sigma(scale * objective.sigma)
    return jump_shares(objective.no_finer_than_sigmas(), best.points)


def without_jumps(objective: Objective, share: np.ndarray) -> Objective:
    """Return the objective without the measurements near a jump, if enough are left."""
    near = share > NEAR
    left = np.sum(objective.study.known & ~near)
    if not np.any(near) or left < FEWEST_LEFT * objective.bounds.lower.size:
        return objective
    return objective.without(near)


def in_words(objective: Objective, share: np.ndarray, each: LeftOut | None) -> list:
    """Name the tests near a jump, their influence, and what can be done.

    Args:
        share: result of `shares_of`.
        each: cross-validation test by test, if there is one.
    """
    study, largest = objective.study, np.max(share, axis=1)
    near = np.flatnonzero(largest > NEAR)
    if not len(near):
        return []
    names = []
    for test in near[np.argsort(-largest[near], kind="stable")][:MOST_NAMED]:
        jumping = [study.targets[place] for place in np.flatnonzero(share[test] > NEAR)]
        text = (
            f"{study.tests.name(test)} ({', '.join(jumping)}: "
            f"{100 * largest[test]:.0f} % beyond it"
        )
        moved = _moved(each, int(test))
        if np.isfinite(moved):
            text += f"; without the test the fit moves by {moved:.2g} standard errors"
        names.append(text + ")")
    more = len(near) - len(names)
    rest = f" and {more} more" if more else ""
    used = without_jumps(objective, share) is not objective
    words = (
        "Standard errors leave these measurements out, the fit does not: empty their "
        'cells in the table to drop them, or set loss = "student" to soften them.'
        if used
        else "Too few measurements are away from jumps: standard errors are inaccurate."
    )
    return [
        "Predictions jump within the confidence region of the fit, since the contact "
        f"ends in another way: {', '.join(names)}{rest}. {words}"
    ]


def _moved(each: LeftOut | None, test: int) -> float:
    """Return the largest move of an unknown without a test, in standard errors."""
    if each is None or each.group[test] < 0:
        return float("nan")
    moved = np.abs(each.moved[each.group[test]])
    return float(np.nanmax(moved)) if np.any(np.isfinite(moved)) else float("nan")

"""Tests near a jump: what they leave out of the uncertainty, and how to say so.

A test whose prediction jumps within the confidence region of the fit (see
`estimation.branches`) has no derivative that holds there. The fit uses it, as any
other. Standard errors and profiles leave it out: they are conditional on the branches
of the impacts, and of the tests that are smooth.
"""

import numpy as np

from ..estimation.branches import NEAR, jump_shares
from ..estimation.least_squares import Fits
from ..problem.objective import Objective
from .cross_validation import LeftOut

FEWEST_LEFT = 2
"""Measurements for each unknown that tests away from jumps must have; with fewer no
test is left out."""
MOST_NAMED = 8
"""Largest number of tests that are named."""


def shares_of(objective: Objective, best: Fits) -> np.ndarray:
    """Compute the share of the confidence region beyond a jump of each test, shape
    (tests,).

    Args:
        best: the reported fit, of one lane.
    """
    return jump_shares(objective.no_finer_than_sigmas(), best.points)


def without_jumps(objective: Objective, share: np.ndarray) -> Objective:
    """Return the objective without the tests near a jump, if enough are left."""
    near = share > NEAR
    left = np.sum(objective.study.known[~near])
    if not np.any(near) or left < FEWEST_LEFT * objective.bounds.lower.size:
        return objective
    return objective.without(near)


def in_words(objective: Objective, share: np.ndarray, each: LeftOut | None) -> list:
    """Name the tests near a jump, their influence, and what can be done.

    Args:
        share: result of `shares_of`.
        each: cross-validation test by test, if there is one.
    """
    near = np.flatnonzero(share > NEAR)
    if not len(near):
        return []
    tests, names = objective.study.tests, []
    for test in near[np.argsort(-share[near], kind="stable")][:MOST_NAMED]:
        text = f"{tests.name(test)} ({100 * share[test]:.0f} % beyond it"
        moved = _moved(each, int(test))
        if np.isfinite(moved):
            text += f"; without it the fit moves by {moved:.2g} standard errors"
        names.append(text + ")")
    more = len(near) - len(names)
    rest = f" and {more} more" if more else ""
    used = without_jumps(objective, share) is not objective
    words = (
        "Standard errors leave these tests out, the fit does not: remove them from the "
        'table to drop them, or set loss = "student" to soften them.'
        if used
        else "Too few tests are away from jumps: standard errors are inaccurate."
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

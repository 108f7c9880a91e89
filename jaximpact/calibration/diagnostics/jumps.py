"""Measurements near a jump: what they do to the uncertainty, and how to say so.

A prediction that jumps within the confidence region of the fit (see
`estimation.branches`) has no derivative that holds there. The fit uses its measurement,
as any other. Profiles leave it out: they are conditional on the branches of the
impacts, and of the predictions that are smooth. Other results of the same test stay:
where a contact ends in another way, e_t and duration jump, but not the largest force
and depth, which came before.

Standard errors are those of draws of the posterior, on both sides of the jump
(`judge`). Where their effective sample size is too small, or where the smooth
predictions alone do not determine all unknowns, they leave out these measurements too.
"""

from typing import NamedTuple

import numpy as np

from ..estimation.branches import NEAR, jump_shares, unit_without_jumps
from ..estimation.least_squares import Fits
from ..problem.objective import Objective
from .cross_validation import LeftOut
from .importance_sampling import sample
from .posterior import Draws
from .results import VariantResult
from .uncertainty import USELESS_ERROR, Uncertainty, estimate, from_draws, stretch

MOST_NAMED = 8
"""Largest number of tests that are named."""


class Judged(NamedTuple):
    """Uncertainty of a fit."""

    uncertainty: Uncertainty
    shares: np.ndarray
    """Shares of the confidence region beyond a jump, shape (tests, targets)."""
    smooth: Objective
    """Objective without the measurements near a jump."""
    draws: Draws
    of_draws: bool
    """Whether covariance and standard errors are those of the draws."""


def judge(objective: Objective, best: Fits, *, enough_below: float = -np.inf) -> Judged:
    """Estimate the uncertainty of a fit of one lane: from its derivatives, or, beside a
    jump, from draws of the posterior.

    Args:
        enough_below: a cost; no more is drawn where a draw has a lower one.
    """
    shares = shares_of(objective, best)
    smooth = without_jumps(objective, shares)
    points = smooth.reevaluate(best.points)
    uncertainty, study = estimate(smooth, points), objective.study
    inflation = uncertainty.inflation
    draws = sample(
        objective,
        best.points,
        inflation,
        about=(smooth, points),
        enough_below=enough_below,
        # Beside a jump the effective sample size of the first draws is small.
        parts=4 if np.any(shares > NEAR) else 1,
        seed=study.seed,
    )
    # Of so few effective draws derivatives do not describe the posterior, jumps or not.
    jumps = np.any(shares > NEAR) or draws.effective_fraction[0] < 0.1
    # Else the bounds would cut off the draws, and hide what is not determined.
    determined = np.all(uncertainty.standard_errors < USELESS_ERROR)
    of_draws = bool(jumps and determined and draws.trusted)
    if of_draws:
        soil, matrix = len(study.parameters), stretch(smooth, points, inflation)
        uncertainty = from_draws(uncertainty, draws, best.points, soil, matrix)
    return Judged(uncertainty, shares, smooth, draws, of_draws)


def shares_of(objective: Objective, best: Fits) -> np.ndarray:
    """Compute the share of the confidence region beyond a jump of each prediction,
    shape (tests, targets).

    Where the misfit is larger than the given sigmas allow, jumps are judged by the
    scatter of the residuals: relative to sigmas that are far too small every
    prediction would seem to jump.
    """
    if estimate(objective, best.points).inflation > 1.0:
        scale = np.sqrt(unit_without_jumps(objective, best.points))
        objective = objective.with_sigma(scale * objective.sigma)
    return jump_shares(objective.no_finer_than_sigmas(), best.points)


def without_jumps(objective: Objective, share: np.ndarray) -> Objective:
    """Return the objective without the measurements near a jump, if two are left for
    each unknown."""
    near = share > NEAR
    left = np.sum(objective.study.known & ~near)
    if not np.any(near) or left < 2 * objective.bounds.lower.size:
        return objective
    return objective.without(near)


def in_words(variant: VariantResult, each: LeftOut | None) -> list[str]:
    """Name the tests near a jump, what the fit does without them, and what can be
    done."""
    objective, share = variant.objective, variant.jumps
    study, largest = objective.study, np.max(share, axis=1)
    near = np.flatnonzero(largest > NEAR)
    if not len(near):
        return []
    names = []
    named = near[np.argsort(-largest[near], kind="stable")][:MOST_NAMED]
    for test, name in zip(named, study.tests.names_apart(named), strict=True):
        jumping = [study.targets[place] for place in np.flatnonzero(share[test] > NEAR)]
        text = f"{name} ({', '.join(jumping)}: {100 * largest[test]:.0f} % beyond it"
        moved = _moved(each, int(test))
        if np.isfinite(moved):
            text += f"; without the test the fit moves by {moved:.2g} standard errors"
        names.append(text + ")")
    more = len(near) - len(names)
    rest = f" and {more} more" if more else ""
    return [
        "Predictions jump within the confidence region of the fit, since the contact "
        f"ends in another way: {', '.join(names)}{rest}. {_used(variant)}"
    ]


def _used(variant: VariantResult) -> str:
    """Say how standard errors use the measurements near a jump."""
    if without_jumps(variant.objective, variant.jumps) is variant.objective:
        words = "Too few measurements are away from jumps. "
        if variant.errors_of_draws:
            return words + "Standard errors are those of draws of the posterior."
        return words + "Standard errors are inaccurate."
    if variant.errors_of_draws:
        words = "Standard errors are those of draws of the posterior; profiles "
    else:
        words = "Standard errors and profiles "
    return (
        f"{words}leave these measurements out, the fit does not: empty their cells in "
        'the table to drop them, or set loss = "student" to soften them.'
    )


def _moved(each: LeftOut | None, test: int) -> float:
    """Return the largest move of an unknown without a test, in standard errors."""
    if each is None or each.group[test] < 0:
        return float("nan")
    moved = np.abs(each.moved[each.group[test]])
    return float(np.nanmax(moved)) if np.any(np.isfinite(moved)) else float("nan")

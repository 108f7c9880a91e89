r"""Search by differential evolution, for starts that fits by derivatives leave behind.

Where slow contacts end differently (a block leaves the ground, or falls back and slides
to rest) predictions jump, and a fit by derivatives stops at the jump. A population of
candidates passes it: it needs costs alone. Its cost is the robust one of Student with
sigmas three times as large, so that a test on the wrong side of a jump counts as an
outlier and the others still tell the way.

Storn and Price (1997), doi 10.1023/A:1008202821328, as SciPy has it.
"""

from typing import NamedTuple

import numpy as np

from ...progress import tell
from ..problem.objective import Objective

POPULATION, PER_UNKNOWN = 48, 6
"""Least size of the population, and its size for each unknown."""
GENERATIONS, MOST_GENERATIONS = 50, 80
"""Number of generations after which a search ends that has agreed, and the largest
number."""
WIDER = 3.0
"""Factor on the sigmas."""
PLACE = 0.3
"""Distance in x from the best member within which a member is at its place."""
TOGETHER = 0.9
"""Fraction of the members at the place of the best one at which a search ends."""
AGREED = 0.5
"""Fraction of the members at the place of the best one from which the others are on
their way there."""
FAILED = 1e12
"""Cost that replaces one that is not finite."""


class Population(NamedTuple):
    """Last population, the best member first."""

    x: np.ndarray
    """Members in x, shape (members, unknowns)."""
    cost: np.ndarray
    """Robust costs, shape (members,)."""

    @property
    def found(self) -> np.ndarray:
        """Mask of the members at the place of the best one."""
        return np.all(np.abs(self.x - self.x[0]) <= PLACE, axis=1)


def robust_of(objective: Objective) -> Objective:
    """Return the objective with Student's loss and wider sigmas."""
    return objective.with_loss("student").with_sigma(WIDER * objective.sigma)


def members_for(unknowns: int) -> int:
    """Return the size of the population."""
    return max(POPULATION, PER_UNKNOWN * unknowns)


def evolve(objective: Objective, x: np.ndarray, candidates: np.ndarray) -> np.ndarray:
    """Search between the bounds for the last population, (members, unknowns) in x, the
    best member first.

    Args:
        x: points, shape (points, unknowns), the best of which are half of the first
            population, or less where they are fewer.
        candidates: points the best of which are the rest of it.

    Equal arguments give equal numbers on one machine.
    """
    # SciPy's optimisers take their time to import, and few studies want them.
    from scipy.optimize import differential_evolution

    robust, bounds = robust_of(objective), objective.bounds
    members = members_for(x.shape[1])

    def cost(x: np.ndarray) -> np.ndarray:
        found = robust.values(x).cost
        return np.where(np.isfinite(found), found, FAILED)

    tell(f"screening {len(candidates)} candidates")
    first = _best(x, cost(x), members // 2)
    spread = _best(candidates, cost(candidates), members - len(first))
    generation = 0

    def is_together(intermediate_result) -> bool:
        nonlocal generation
        generation += 1
        tell(
            f"generation {generation} of {members} candidates, lowest robust cost "
            f"{intermediate_result.fun:.6g}"
        )
        now = _population(intermediate_result)
        enough = TOGETHER if generation < GENERATIONS else AGREED
        return bool(np.mean(now.found) >= enough)

    ended = differential_evolution(
        lambda x: cost(x.T),
        np.stack([bounds.low, bounds.high], axis=1),
        init=np.clip(np.concatenate([first, spread]), bounds.low, bounds.high),
        maxiter=MOST_GENERATIONS,
        tol=0.0,
        polish=False,
        updating="deferred",
        vectorized=True,
        callback=is_together,
        # Named rng from SciPy 1.15 on.
        seed=objective.study.seed,  # pyright: ignore[reportCallIssue]
    )
    return _population(ended).x


def _population(state) -> Population:
    """Sort a population of SciPy's."""
    costs = np.asarray(state.population_energies)
    order = np.argsort(costs, kind="stable")
    return Population(np.asarray(state.population)[order], costs[order])


def _best(x: np.ndarray, cost: np.ndarray, count: int) -> np.ndarray:
    """Select the points of lowest cost."""
    return x[np.argsort(cost, kind="stable")[:count]]

r"""Search by differential evolution, which passes jumps and local minima.

Where slow contacts end differently (a block leaves the ground, or falls back and slides
to rest) predictions jump, and a fit by derivatives stops at the jump. A population of
candidates passes it: it needs costs alone. Its cost is the robust one of Student with
sigmas three times as large, so that a test on the wrong side of a jump counts as an
outlier and the others still tell the way. Few measurements have none to spare, and many
minima: there it is the cost itself, and mutations start from members at random, not
from the best one, which keeps the population apart for longer.

Storn and Price (1997), doi 10.1023/A:1008202821328, as SciPy has it.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from ...progress import tell, within
from ..problem.objective import Objective, start_of

PER_UNKNOWN = 8
"""Least size of the population for each unknown."""
SCREENED = 8
"""Candidates for each member of the first population."""
MARGIN = 0.02
"""Distance of candidates from the bounds, as a fraction of the range."""
GENERATIONS, MOST_GENERATIONS = 50, 80
"""Number of generations after which a search ends that has agreed, and the largest
number."""
APART = 200
"""Largest number of generations where mutations start from members at random."""
WIDER = 3.0
"""Factor on the sigmas."""
SPARE = 5
"""Measurements for each unknown from which the cost is the robust one."""
PLACE, ALIKE = 0.3, 0.1
"""Distance in x from the best member, or cost above it in s^2, within which a member
agrees with it."""
TOGETHER = 0.9
"""Fraction of the members that agree at which a search ends."""
AGREED = 0.5
"""Fraction of the members that agree from which the others are on their way there."""
PATIENCE, WORTH = 12, 0.01
"""Number of generations in which the lowest cost must fall by this fraction of s^2 for
a search about a fit to go on."""
FAILED = 1e12
"""Cost that replaces one that is not finite."""


class Population(NamedTuple):
    """Last population, the best member first."""

    x: np.ndarray
    """Members in x, shape (members, unknowns)."""
    cost: np.ndarray
    """Costs of the search, shape (members,)."""
    unit: float
    """Unit for differences of these costs, max(1, s^2)."""

    @property
    def agreed(self) -> int:
        """Number of members that came to the place, or the cost, of the best one."""
        alike = self.cost <= self.cost[0] + ALIKE * self.unit
        return int(np.sum(alike | _near(self.x, self.x[0])))

    def places(self, count: int) -> np.ndarray:
        """Select the best member of each of at most `count` places, the best first,
        shape (places, unknowns)."""
        places: list[np.ndarray] = []
        for member in self.x:
            if len(places) < count and not any(_near(member, one) for one in places):
                places.append(member)
        return np.array(places)


def _near(x: np.ndarray, place: np.ndarray) -> np.ndarray:
    return np.all(np.abs(x - place) <= PLACE, axis=-1)


def spread(objective: Objective, count: int) -> np.ndarray:
    """Sample candidates, shape (count, unknowns) in x: the start of the study, then a
    Latin hypercube.

    The hypercube divides the range of each unknown into as many strata as there are
    points; of an unknown with a prior, its prior distribution.
    """
    bounds, random = objective.bounds, np.random.default_rng(objective.study.seed)
    start = start_of(objective.study)
    mean, sd = objective.prior_mean, objective.prior_sd
    others, size = count - 1, len(start)
    strata = np.stack([random.permutation(others) for _ in range(size)], axis=-1)
    part = (strata + random.random((others, size))) / max(others, 1)
    candidates = bounds.at_fraction(MARGIN + (1.0 - 2.0 * MARGIN) * part)
    has_prior = np.isfinite(sd)
    drawn = mean + np.where(has_prior, sd, 0.0) * ndtri(np.clip(part, 1e-3, 1 - 1e-3))
    drawn = np.clip(drawn, bounds.lower, bounds.upper)
    drawn = bounds.coordinate(np.where(has_prior, drawn, bounds.lower))
    candidates = np.where(has_prior, drawn, candidates)
    return np.concatenate([start[None], candidates])


@within("search, ")
def search(objective: Objective, members: int) -> Population:
    """Search between the bounds, from candidates all over them, with so many members or
    more where there are many unknowns."""
    unknowns = len(objective.bounds.lower)
    members = max(members, PER_UNKNOWN * unknowns)
    spare = np.sum(objective.study.known) >= SPARE * unknowns
    if spare:
        objective = objective.with_loss("student").with_sigma(WIDER * objective.sigma)
    candidates = spread(objective, SCREENED * members)
    tell(f"screening {len(candidates)} candidates")
    order = np.argsort(_costs(objective, candidates), kind="stable")

    def is_together(population: Population, generation: int) -> bool:
        enough = AGREED if spare and generation >= GENERATIONS else TOGETHER
        return population.agreed >= enough * members

    first = candidates[order[:members]]
    if spare:
        return _evolve(objective, first, is_together)
    return _evolve(objective, first, is_together, "rand1bin", APART)


@within("at a jump, ")
def search_about(objective: Objective, x: np.ndarray) -> Population:
    """Search about points, shape (members, unknowns), for a lower cost."""
    falls: list[float] = []

    def no_longer_falls(population: Population, generation: int) -> bool:
        falls.append(population.cost[0])
        least = WORTH * float(objective.unit(falls[-1]))
        return generation > PATIENCE and falls[-1 - PATIENCE] - falls[-1] < least

    return _evolve(objective, x, no_longer_falls)


def _costs(objective: Objective, x: np.ndarray) -> np.ndarray:
    cost = objective.values(x).cost
    return np.where(np.isfinite(cost), cost, FAILED)


def _evolve(
    objective: Objective,
    first: np.ndarray,
    is_enough: Callable[[Population, int], bool],
    strategy: str = "best1bin",
    generations: int = MOST_GENERATIONS,
) -> Population:
    """Let a population evolve until it is enough.

    Args:
        is_enough: called with the population and the number of its generation.
        strategy: of SciPy's differential evolution.
        generations: their largest number.
    """
    # SciPy's optimisers take their time to import.
    from scipy.optimize import differential_evolution

    bounds, generation = objective.bounds, 0

    def ends(intermediate_result) -> bool:
        nonlocal generation
        generation += 1
        lowest = f"lowest cost {intermediate_result.fun:.6g}"
        tell(f"generation {generation} of {len(first)} candidates, {lowest}")
        now = _population(objective, intermediate_result)
        return bool(is_enough(now, generation))

    ended = differential_evolution(
        lambda x: _costs(objective, x.T),
        np.stack([bounds.low, bounds.high], axis=1),
        init=np.clip(first, bounds.low, bounds.high),
        strategy=strategy,
        maxiter=generations,
        tol=0.0,
        polish=False,
        updating="deferred",
        vectorized=True,
        callback=ends,
        # Named rng from SciPy 1.15 on.
        seed=objective.study.seed,  # pyright: ignore[reportCallIssue]
    )
    return _population(objective, ended)


def _population(objective: Objective, state) -> Population:
    """Sort a population of SciPy's."""
    costs = np.asarray(state.population_energies)
    order = np.argsort(costs, kind="stable")
    unit = float(objective.unit(costs[order[0]]))
    return Population(np.asarray(state.population)[order], costs[order], unit)

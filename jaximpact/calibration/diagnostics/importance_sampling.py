r"""Importance sampling of the posterior: weighted draws of the unknowns.

The proposal is Student's distribution of 5 degrees of freedom about the best fit with
the covariance of the curvature (Laplace), restricted to the bounds; the weights are

$$ w \propto e^{-C_t / s^2 - C_p} \, p'(x) / q(x) , $$

with C_t and C_p the parts of tests and priors in the cost, s^2 the inflation, and q the
density of the proposal. A prior is a density of p, hence the derivative p' of the
unknowns with one; without a prior of the study it is uniform in x between the bounds.
Where the effective sample size is small, more are sampled, of a proposal that is fitted
to the weighted draws; q is then the mixture of all proposals (adaptive multiple
importance sampling, Cornuet et al. 2012).

Impacts have the accuracy `balanced`, whatever that of the fit. With small sigmas their
errors count in the cost: some of the draws are computed again more accurately, and
where that changes the differences of their costs, all of them (`LADDER`).

These weights take an estimated sigma as true. With a uniform prior on its logarithm, n
measurements of a target have the density (`weights_of`)

$$ p(x) \propto \left(1 + \frac{S(x) - S_0}{\nu}\right)^{-n/2} $$

in place of exp(-(S - S_0) / 2), with S the sum of squares in units of that sigma, S_0
at the best fit, and nu the degrees of freedom left: Student's distribution instead of
the normal one for a linear model. The draws keep their values and get other weights.
(Otherwise predictions with few degrees of freedom are too certain: of 8 tests with two
parameters, 95 % intervals of the model held 87 %.)
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...accuracy import PRESETS, Accuracy
from ...progress import within
from ..estimation.sigma import LEAST_FREEDOM, freedom_of_targets, sharing_scale
from ..problem.noise import LOSSES
from ..problem.objective import Objective, Points
from .posterior import Draws, moments, normalised, root_of
from .uncertainty import laplace

COUNT = 512
"""Draws a round."""
TAILS = 5.0
"""Degrees of freedom of the proposal: heavier tails than the posterior's."""
ENOUGH = 0.3
"""Effective sample size, as a fraction of the draws of a round, at which the rounds
end; a normal posterior gives 0.9."""
LADDER = (
    PRESETS["balanced"],
    PRESETS["reference"],
    Accuracy("10 times closer than reference", 1e-9, 1e-2),
)
"""Accuracies of which each checks the one before it. Largest errors of the cost on the
studies shipped: 0.2 at `fast`, 0.001 at `balanced`; on a twin without noise 5 and
0.02."""
CHECKED = 64
"""Number of draws computed again: with probability 0.96 it finds an error that one in
twenty draws has."""


def draw(
    objective: Objective,
    points: Points,
    inflation: float,
    *,
    count: int = COUNT,
    seed: int = 0,
) -> Draws:
    """Sample the posterior about the best fit (points of one lane), with the inflation
    of its covariance and `count` draws a round, and check the accuracy of the costs."""
    draws = sample(objective, points, inflation, count=count, seed=seed)
    return check(draws, objective, inflation)


@within("draws of the posterior: ")
def sample(
    objective: Objective,
    points: Points,
    inflation: float,
    *,
    about: tuple[Objective, Points] | None = None,
    enough_below: float = -np.inf,
    parts: int = 1,
    count: int = COUNT,
    seed: int = 0,
) -> Draws:
    """Sample as `draw`, at the lowest accuracy and without a check.

    Args:
        about: objective and points of the first proposal, if not those of the fit: its
            curvature may leave out measurements, since derivatives beside a jump say
            little about the other side.
        enough_below: a cost; the rounds end where a draw has a lower one.
        parts: number of parts of a round, each of which has its own proposal.
    """
    random, at_first = np.random.default_rng(seed), objective.at(LADDER[0])
    about = about or (objective, points)
    best, root = points.x[0], root_of(laplace(*about, inflation))
    low, high = objective.bounds.low, objective.bounds.high
    size = len(best)

    def between(standard: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Convert to x, and find the draws between the bounds."""
        x = best + np.einsum("pq,dq->dp", root, standard)
        return x, np.all((x >= low) & (x <= high), axis=1)

    proposals = [_Proposal(np.zeros(size), np.eye(size))]
    rounds, fractions = [], []
    for number in range(1, 5 * parts + 1):
        standard, x, inside = _propose(random, proposals[-1], count // parts, between)
        proposals[-1] = proposals[-1]._replace(inside=inside)
        with within(f"round {number}, "):
            drawn = at_first.values(x)
        rounds.append((standard, x, drawn.cost, drawn.predicted))
        standard, x, cost, predicted = map(np.concatenate, zip(*rounds, strict=True))
        mixture = [proposal.log_density(standard) for proposal in proposals]
        log_weight = objective.log_density(x, cost, inflation)
        log_weight -= np.logaddexp.reduce(mixture, axis=0)
        effective = 1.0 / np.sum(normalised(log_weight) ** 2)
        fractions.append(effective / len(x))
        if effective >= ENOUGH * count or np.min(cost) < enough_below:
            break
        # A proposal is fitted to ten effective draws for each unknown at least, is
        # wider than these few, and keeps a hundredth of the first one.
        centre, spread = moments(standard, _tempered(log_weight, 10.0 * size))
        proposals.append(_Proposal(centre, 1.5 * spread + 0.01 * np.eye(size)))
    part = np.array(fractions)
    return Draws(x, log_weight, cost, predicted, part, at_first.accuracy, np.nan)


@within("draws of the posterior: ")
def check(draws: Draws, objective: Objective, inflation: float) -> Draws:
    """Compute some of the draws of `sample` again more accurately; where that changes
    their costs, all of them, which changes their weights."""
    draws = draws._replace(error=_error_of(draws, objective, inflation))
    if not draws.rough:
        return draws
    closer = objective.at(LADDER[1])
    with within("all again, more accurately, "):
        points = closer.values(draws.x)
    log_weights = draws.log_weights + (draws.cost - points.cost) / inflation
    part = 1.0 / (len(points.x) * np.sum(normalised(log_weights) ** 2))
    draws = draws._replace(
        log_weights=log_weights,
        cost=points.cost,
        predicted=points.predicted,
        effective_fraction=np.append(draws.effective_fraction[:-1], part),
        accuracy=closer.accuracy,
    )
    return draws._replace(error=_error_of(draws, objective, inflation))


class _Proposal(NamedTuple):
    """Student's distribution of the unknowns in standard deviations about their
    mean."""

    centre: np.ndarray
    covariance: np.ndarray
    inside: float = 1.0
    """Share of its draws between the bounds."""

    def log_density(self, standard: np.ndarray) -> np.ndarray:
        """Compute the logarithm of its density between the bounds, up to a constant,
        shape (draws,)."""
        values, vectors = np.linalg.eigh(self.covariance)
        apart = (standard - self.centre) @ (vectors / np.sqrt(values))
        size, squares = len(values), np.sum(apart**2, axis=1)
        tail = 0.5 * (TAILS + size) * np.log1p(squares / TAILS)
        return -tail - 0.5 * np.sum(np.log(values)) - np.log(self.inside)


def _tempered(log_weight: np.ndarray, least: float) -> np.ndarray:
    """Compute weights w^t of at least some effective sample size, with the largest t up
    to 1: a covariance of fewer draws would be degenerate."""
    low, high = 0.0, 1.0
    weights = normalised(log_weight)
    if 1.0 / np.sum(weights**2) >= least:
        return weights
    for _ in range(20):
        middle = 0.5 * (low + high)
        weights = normalised(middle * log_weight)
        enough = 1.0 / np.sum(weights**2) >= least
        low, high = (middle, high) if enough else (low, middle)
    return normalised(low * log_weight)


@within("some again, more accurately, ")
def _error_of(draws: Draws, objective: Objective, inflation: float) -> float:
    """Compute the error of the costs, on draws chosen by their weights."""
    sums = np.cumsum(draws.weights)
    places = (np.arange(CHECKED) + 0.5) / CHECKED * sums[-1]
    chosen = np.unique(np.searchsorted(sums, places))
    x, cost = draws.x[chosen], draws.cost[chosen]
    return error_of_costs(objective.at(draws.accuracy), x, cost, inflation)


def error_of_costs(
    objective: Objective, x: np.ndarray, cost: np.ndarray, inflation: float
) -> float:
    """Compute the largest error of costs (lanes,) at x (lanes, unknowns) over s^2, the
    inflation, against the next accuracy of the ladder. An error common to all changes
    no weight, and is subtracted."""
    closer = objective.at(LADDER[LADDER.index(objective.accuracy) + 1])
    apart = cost - closer.values(x).cost
    return float(np.max(np.abs(apart - np.median(apart)))) / inflation


def _propose(
    random,
    proposal: _Proposal,
    count: int,
    between: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
) -> tuple[np.ndarray, np.ndarray, float]:
    """Sample a proposal between the bounds: draws in standard deviations, the same in
    x, and the share of all that lie between the bounds."""
    standard, x, kept, batches = [], [], 0, 0
    # 2000 batches fill the bounds, or nearly no draw lies between them.
    while kept < count and batches < 2000:
        normal = random.normal(size=(count, len(proposal.centre)))
        scale = np.sqrt(random.chisquare(TAILS, size=(count, 1)) / TAILS)
        drawn = proposal.centre + (normal / scale) @ root_of(proposal.covariance).T
        of_drawn, inside = between(drawn)
        standard.append(drawn[inside])
        x.append(of_drawn[inside])
        kept, batches = kept + int(np.sum(inside)), batches + 1
    rows = np.concatenate(standard)[:count], np.concatenate(x)[:count]
    return *rows, kept / (batches * count)


def stretched(
    draws: Draws, objective: Objective, points: Points, matrix: np.ndarray | None
) -> Draws:
    """Give draws the scatter of the estimate by the matrix of `stretch`: they keep
    their weights, and are predicted anew."""
    if matrix is None:
        return draws
    best, bounds = points.x[0], objective.bounds
    x = np.clip(best + (draws.x - best) @ matrix.T, bounds.low, bounds.high)
    predicted = objective.at(draws.accuracy).values(x).predicted
    return draws._replace(x=x, predicted=predicted)


def weights_of(objective: Objective, points: Points, draws: Draws) -> np.ndarray:
    """Compute weights of draws with every estimated sigma left uncertain; the sum is 1.

    Targets with less than a degree of freedom share one scale, as in the estimate of
    sigmas. Squares count by the weight of their target, and their number does not: so a
    weight makes the density narrower or wider, and no other. For robust losses the
    weights are those of the draws.
    """
    study = objective.study
    if study.loss != LOSSES[0]:
        return draws.weights
    count = np.sum(study.exact, axis=0)
    squares = _squares(objective, draws.predicted)
    least = _squares(objective, points.predicted)[0]
    freedom = freedom_of_targets(objective, points)
    # Not of the weights, which underflow where this density falls off more slowly.
    log_weights = draws.log_weights.copy()
    for group in sharing_scale(study, freedom):
        nu = float(np.sum(freedom[group]))
        if nu < LEAST_FREEDOM:
            continue  # no scale was estimated
        weight = float(np.mean(study.weights[group]))
        risen = weight * (np.sum(squares[:, group], axis=1) - np.sum(least[group]))
        part = np.maximum(risen / nu, -1.0 + 1e-9)
        student = 0.5 * np.sum(count[group]) * np.log1p(part)
        log_weights += 0.5 * risen - student
    return normalised(log_weights)


def _squares(objective: Objective, predicted) -> np.ndarray:
    u = (predicted - objective.study.measured) / objective.sigma
    return np.sum(np.where(objective.study.exact & np.isfinite(u), u, 0.0) ** 2, axis=1)

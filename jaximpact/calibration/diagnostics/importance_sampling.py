r"""Importance sampling of the posterior: weighted draws of the unknowns.

The proposal is Student's distribution of 5 degrees of freedom about the best fit with
the covariance of the curvature (Laplace), restricted to the bounds; the weights are

$$ w \propto e^{-\text{cost} / s^2} / q(x) , $$

with s^2 the inflation of the covariance and q the density of the proposal. Without a
prior of the study the prior is uniform in x between the bounds. Estimated standard
deviations of groups are sampled first, and x about its mean for them (`group_sds`).
Where few draws carry all the weight, the proposal is fitted to the weighted draws and
sampled again (population Monte Carlo, Cappe et al. 2004).

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

from typing import NamedTuple

import numpy as np

from ...accuracy import PRESETS, Accuracy
from ...progress import Progress
from ..estimation.sigma import LEAST_FREEDOM, freedom_of_targets
from ..estimation.starts import SILENT
from ..problem.noise import LOSSES
from ..problem.objective import Objective, Points
from .group_sds import GroupSds
from .posterior import Draws, moments, normalised
from .uncertainty import laplace

COUNT = 512
TAILS = 5.0
"""Degrees of freedom of the proposal: heavier tails than the posterior's."""
ROUNDS = 5
ENOUGH = 0.3
"""Effective sample size, as a fraction of the draws, at which the rounds end; a normal
posterior gives 0.9."""
WIDER = 1.5
"""Factor on the covariance of the weighted draws, which are few."""
TRIES = 2000
"""Largest number of batches of draws sampled to fill the bounds."""
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
    progress: Progress = SILENT,
) -> Draws:
    """Sample the posterior about the best fit.

    Args:
        objective: objective with the sigmas of the fit.
        points: the best fit, of one lane.
        inflation: inflation of its covariance.
        count: number of draws.
        seed: seed of the random numbers.
        progress: told a line of text each round.
    """
    random = np.random.default_rng(seed)
    at_first = objective.at(LADDER[0])
    groups = laplace(objective, points, inflation)
    # Of x in standard deviations about its mean.
    centre, covariance = np.zeros(len(groups.x)), np.eye(len(groups.x))
    best: Draws | None = None
    parts = []
    progress = progress.within("predictive bands: ")
    for number in range(1, ROUNDS + 1):
        proposed = _propose(random, groups, centre, covariance, count)
        tell = progress.within(f"draws, round {number}, ")
        found = _weighted(at_first, groups, proposed, inflation, tell)
        parts.append(found.effective_fraction[-1])
        if best is None or parts[-1] > best.effective_fraction[-1]:
            best = found._replace(effective_fraction=np.array(parts))
            of_best = proposed
        if parts[-1] >= ENOUGH:
            break
        centre, spread = moments(of_best.standard, best.weights)
        # The covariance of few draws is noisy: some of the proposal's is kept.
        share = best.effective_fraction[-1]
        covariance = WIDER * spread + max(0.1, 0.5 - share) * covariance
    assert best is not None
    tell = progress.within("some of the draws again, more accurately, ")
    best = best._replace(error=_error_of(best, objective, inflation, tell))
    if best.rough:
        tell = progress.within("all draws again, more accurately, ")
        found = _weighted(objective.at(LADDER[1]), groups, of_best, inflation, tell)
        parts = np.append(best.effective_fraction[:-1], found.effective_fraction)
        best = found._replace(effective_fraction=parts)
        best = best._replace(error=_error_of(best, objective, inflation, tell))
    return best


class _Proposed(NamedTuple):
    """Draws of the proposal."""

    standard: np.ndarray
    """Unknowns in standard deviations about their mean, shape (draws, unknowns)."""
    x: np.ndarray
    sds: np.ndarray
    """Standard deviations of groups, shape (draws, nuisances)."""
    log_density: np.ndarray
    """Logarithm of the density of x and these, up to a constant, shape (draws,)."""


def _weighted(
    objective: Objective,
    groups: GroupSds,
    proposed: _Proposed,
    inflation: float,
    progress: Progress,
) -> Draws:
    x, sds = proposed.x, proposed.sds
    cost, predicted, _ = objective.values_by_parts(x, progress)
    log_weight = -cost / inflation - proposed.log_density
    log_weight = log_weight + groups.log_ratio(x, sds)
    part = np.array([1.0 / (len(x) * np.sum(normalised(log_weight) ** 2))])
    of_groups = dict(zip(groups.names, sds.T, strict=True))
    accuracy = objective.accuracy
    return Draws(x, of_groups, log_weight, cost, predicted, part, accuracy, np.nan)


def _error_of(
    draws: Draws, objective: Objective, inflation: float, progress: Progress
) -> float:
    """Compute the error of the costs, on draws chosen by their weights."""
    sums = np.cumsum(draws.weights)
    places = (np.arange(CHECKED) + 0.5) / CHECKED * sums[-1]
    chosen = np.unique(np.searchsorted(sums, places))
    x, cost = draws.x[chosen], draws.cost[chosen]
    return error_of_costs(objective.at(draws.accuracy), x, cost, inflation, progress)


def error_of_costs(
    objective: Objective,
    x: np.ndarray,
    cost: np.ndarray,
    inflation: float,
    progress: Progress = SILENT,
) -> float:
    """Compute the largest error of the cost over s^2, against the next accuracy of the
    ladder. An error common to all changes no weight, and is subtracted.

    Args:
        x: points at which it is checked, shape (lanes, unknowns).
        cost: cost there by this objective, shape (lanes,).
        inflation: s^2.
        progress: told a line of text now and then.
    """
    closer = objective.at(LADDER[LADDER.index(objective.accuracy) + 1])
    apart = cost - closer.values_by_parts(x, progress)[0]
    return float(np.max(np.abs(apart - np.median(apart)))) / inflation


def _propose(random, groups: GroupSds, centre, covariance, count: int) -> _Proposed:
    """Sample the proposal between the bounds.

    Args:
        centre, covariance: of the unknowns in standard deviations about their mean.
    """
    low, high = groups.bounds.low, groups.bounds.high
    inside, found = [], 0
    for _ in range(TRIES):
        normal = random.normal(size=(count, len(centre)))
        scale = np.sqrt(random.chisquare(TAILS, size=(count, 1)) / TAILS)
        apart = normal / scale
        standard = centre + apart @ _root(covariance).T
        sds, log_density = groups.sample(random, count)
        # Without groups there is one mean and one covariance for all.
        mean, spread = groups.of_unknowns(sds if groups.names else sds[:1])
        root = _root(spread)
        x = mean + np.einsum("...pq,...q->...p", root, standard)
        squares = np.sum(apart**2, axis=1)
        log_density = log_density - 0.5 * np.linalg.slogdet(spread)[1]
        log_density -= 0.5 * (TAILS + len(centre)) * np.log1p(squares / TAILS)
        kept = np.all((x >= low) & (x <= high), axis=1)
        part = _Proposed(standard, x, sds, log_density)
        inside.append(_Proposed(*(values[kept] for values in part)))
        found += int(np.sum(kept))
        if found >= count:
            break
    return _Proposed(*(np.concatenate(v)[:count] for v in zip(*inside, strict=True)))


def _root(covariance: np.ndarray) -> np.ndarray:
    """Compute a root R of covariances R R^T, shape (..., n, n)."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]


def weights_of(objective: Objective, points: Points, draws: Draws) -> np.ndarray:
    """Compute weights of draws with every estimated sigma left uncertain; the sum is 1.

    Targets with less than a degree of freedom share one scale, as in the estimate of
    sigmas. For robust losses the weights are those of the draws.
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
    estimated = ~study.sigma_given
    alone = estimated & (freedom >= LEAST_FREEDOM)
    groups = [[target] for target in np.flatnonzero(alone)]
    groups += [np.flatnonzero(estimated & ~alone)]
    for group in groups:
        nu = float(np.sum(freedom[group]))
        if nu < LEAST_FREEDOM:
            continue  # no scale was estimated
        weight = float(np.mean(study.weights[group]))
        risen = np.sum(squares[:, group], axis=1) - np.sum(least[group])
        part = np.maximum(risen / nu, -1.0 + 1e-9)
        student = 0.5 * np.sum(count[group]) * np.log1p(part)
        log_weights += weight * (0.5 * risen - student)
    return normalised(log_weights)


def _squares(objective: Objective, predicted) -> np.ndarray:
    """Compute sums of squared residuals, shape (draws, targets)."""
    u = (predicted - objective.study.measured) / objective.sigma
    return np.sum(np.where(objective.study.exact & np.isfinite(u), u, 0.0) ** 2, axis=1)

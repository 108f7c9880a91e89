r"""Draws of the unknowns as the data leave them, each with its weight.

They come from a proposal, Student's distribution of 5 degrees of freedom about the best
fit with the covariance that the curvature gives (Laplace), kept between the bounds, and
are weighted with what they cost:

$$ w \propto e^{-\text{cost} / s^2} / q(x) , $$

s^2 the inflation of the covariance and q the proposal's density. The prior is uniform
in x between the bounds, where a study gives none. Where few draws carry all the weight,
the proposal is fitted to the weighted draws and they are drawn again (population Monte
Carlo, Cappe et al. 2004).

Impacts have the accuracy `balanced`, whatever that of the fit. Where sigmas are tight
their errors count in the cost: so some of the draws are computed again, closer, and
where that moves their costs apart, all of them (`LADDER`).
"""

from typing import NamedTuple

import numpy as np

from ..accuracy import PRESETS, Accuracy
from .least_squares import Progress
from .objective import Objective, Points
from .uncertainty import laplace_covariance

COUNT = 512
TAILS = 5.0
"""Degrees of freedom of the proposal: heavier tails than the posterior's."""
ROUNDS = 5
ENOUGH = 0.3
"""Part of the draws that shall count; of the normal distribution itself 0.9 do."""
FEWEST = 0.1
"""Part below which what the draws say is not to be trusted."""
WIDER = 1.5
"""By which the covariance of weighted draws, which are few, is multiplied."""
TRIES = 2000
"""Times the draws wanted that are made at most, to find those between the bounds."""
LADDER = (
    PRESETS["balanced"],
    PRESETS["reference"],
    Accuracy("10 times closer than reference", 1e-9, 1e-2),
)
"""Each checks the one before it. Errors of the cost on the studies shipped, at worst:
0.2 at `fast`, 0.001 at `balanced`; on a twin without noise 5 and 0.02."""
CHECKED = 64
"""Draws computed again: an error that one in twenty has is among them, 96 of 100
times."""
ROUGH = 0.05
"""Error of a cost, over s^2, above which it is not let pass: that of a weight."""


class Draws(NamedTuple):
    """Draws `(draws,)` and what the model gives for them."""

    x: np.ndarray
    """`(draws, unknowns)`"""
    weights: np.ndarray
    """They sum to 1."""
    cost: np.ndarray
    """What each costs, `(draws,)`."""
    predicted: np.ndarray
    """`(draws, tests, targets)`, NaN where there is no prediction."""
    effective_part: np.ndarray
    """1 / sum of the weights' squares, over the draws: as many independent draws of the
    posterior say as much. One a round; the last is of these draws, the first tells how
    near to normal the posterior is."""
    accuracy: Accuracy
    """Of the impacts."""
    error: float
    """Largest error found of a cost, over s^2: of those computed again, closer."""

    @property
    def trusted(self) -> bool:
        """Whether enough of them count."""
        return bool(self.effective_part[-1] >= FEWEST)

    @property
    def rough(self) -> bool:
        """Whether their costs are off by too much even so."""
        return self.error > ROUGH

    def mean(self) -> np.ndarray:
        """Of x."""
        return self.weights @ self.x

    def covariance(self) -> np.ndarray:
        """Of x."""
        apart = self.x - self.mean()
        return (apart.T * self.weights) @ apart


def draw(
    objective: Objective,
    points: Points,
    inflation: float,
    *,
    count: int = COUNT,
    seed: int = 0,
    progress: Progress = lambda text: None,
) -> Draws:
    """Draw about the best fit.

    Args:
        objective: with the sigmas of the fit.
        points: the best fit, of one lane.
        inflation: of its covariance.
        count: how many.
        seed: of the draws.
        progress: called with a line of text each round.
    """
    random = np.random.default_rng(seed)
    at_first = objective.at(LADDER[0])
    centre = points.x[0]
    covariance = laplace_covariance(objective, points, inflation)
    best, parts = None, []

    def telling(what: str) -> Progress:
        return lambda text: progress(f"predictive bands: {what}, {text}")

    for number in range(1, ROUNDS + 1):
        x, log_density = _proposed(random, objective, centre, covariance, count)
        tell = telling(f"draws, round {number}")
        found = _weighted(at_first, x, log_density, inflation, tell)
        parts.append(found.effective_part[-1])
        if best is None or parts[-1] > best.effective_part[-1]:
            best = found._replace(effective_part=np.array(parts))
            density_of_best = log_density
        if parts[-1] >= ENOUGH:
            break
        centre = best.mean()
        # Of few draws the covariance is that of noise: some of the proposal's is kept.
        share = best.effective_part[-1]
        covariance = WIDER * best.covariance() + max(0.1, 0.5 - share) * covariance
    tell = telling("some of the draws again, closer")
    best = best._replace(error=_error_of(best, objective, inflation, tell))
    if best.error <= ROUGH:
        return best
    closer, tell = objective.at(LADDER[1]), telling("all draws again, closer")
    found = _weighted(closer, best.x, density_of_best, inflation, tell)
    parts = np.append(best.effective_part[:-1], found.effective_part)
    found = found._replace(effective_part=parts)
    return found._replace(error=_error_of(found, objective, inflation, tell))


def _weighted(
    objective: Objective, x, log_density, inflation: float, progress: Progress
) -> Draws:
    cost, predicted, _ = objective.values_by_parts(x, progress)
    log_weight = -cost / inflation - log_density
    weights = np.exp(log_weight - np.max(log_weight))
    weights = weights / np.sum(weights)
    part = np.array([1.0 / (len(x) * np.sum(weights**2))])
    return Draws(x, weights, cost, predicted, part, objective.accuracy, np.nan)


def _error_of(
    draws: Draws, objective: Objective, inflation: float, progress: Progress
) -> float:
    """Error of the costs, of draws chosen by their weights."""
    sums = np.cumsum(draws.weights)
    places = (np.arange(CHECKED) + 0.5) / CHECKED * sums[-1]
    chosen = np.unique(np.searchsorted(sums, places))
    return error_of_costs(
        objective.at(draws.accuracy),
        draws.x[chosen],
        draws.cost[chosen],
        inflation,
        progress,
    )


def error_of_costs(
    objective: Objective,
    x: np.ndarray,
    cost: np.ndarray,
    inflation: float,
    progress: Progress = lambda text: None,
) -> float:
    """Largest error of the cost, over s^2, against the next closer accuracy of the
    ladder. What the errors have in common moves no weight, and counts for none.

    Args:
        x: where it is looked for, `(lanes, unknowns)`.
        cost: there, by this objective.
        inflation: s^2.
        progress: called with a line of text now and then.
    """
    closer = objective.at(LADDER[LADDER.index(objective.accuracy) + 1])
    apart = cost - closer.values_by_parts(x, progress)[0]
    return float(np.max(np.abs(apart - np.median(apart)))) / inflation


def _proposed(random, objective: Objective, centre, covariance, count: int):
    """Draws between the bounds, and the logarithm of their density up to a constant."""
    low, high = objective.bounds.low, objective.bounds.high
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    inside, found = [], 0
    for _ in range(TRIES):
        normal = random.normal(size=(count, len(centre)))
        scale = np.sqrt(random.chisquare(TAILS, size=(count, 1)) / TAILS)
        apart = normal / scale
        x = centre + apart @ root.T
        kept = np.all((x >= low) & (x <= high), axis=1)
        inside.append((x[kept], apart[kept]))
        found += int(np.sum(kept))
        if found >= count:
            break
    x, apart = (np.concatenate(rows)[:count] for rows in zip(*inside, strict=True))
    squares = np.sum(apart**2, axis=1)
    return x, -0.5 * (TAILS + len(centre)) * np.log1p(squares / TAILS)

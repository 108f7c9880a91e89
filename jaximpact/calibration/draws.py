r"""Draws of the unknowns as the data leave them, each with its weight.

They come from a proposal, Student's distribution of 5 degrees of freedom about the best
fit with the covariance that the curvature gives (Laplace), kept between the bounds, and
are weighted with what they cost:

$$ w \propto e^{-\text{cost} / s^2} / q(x) , $$

s^2 the inflation of the covariance and q the proposal's density. The prior is uniform
in x between the bounds, where a study gives none. Where few draws carry all the weight,
the proposal is fitted to the weighted draws and they are drawn again (population Monte
Carlo, Cappe et al. 2004).
"""

from typing import NamedTuple

import numpy as np

from .fit import rough_of
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


class Draws(NamedTuple):
    """Draws `(draws,)` and what the model gives for them."""

    x: np.ndarray
    """`(draws, unknowns)`"""
    weights: np.ndarray
    """They sum to 1."""
    predicted: np.ndarray
    """`(draws, tests, targets)`, NaN where there is no prediction."""
    effective_part: np.ndarray
    """1 / sum of the weights' squares, over the draws: as many independent draws of the
    posterior say as much. One a round; the last is of these draws, the first tells how
    near to normal the posterior is."""

    @property
    def trusted(self) -> bool:
        """Whether enough of them count."""
        return bool(self.effective_part[-1] >= FEWEST)

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
    rough = rough_of(objective)
    centre = points.x[0]
    covariance = laplace_covariance(objective, points, inflation)
    best, parts = None, []
    for number in range(1, ROUNDS + 1):
        progress(f"predictive bands: draws, round {number}")
        x, log_density = _proposed(random, objective, centre, covariance, count)
        there = rough.glance(x, np.zeros(x.shape, bool))
        log_weight = -there.cost / inflation - log_density
        weights = np.exp(log_weight - np.max(log_weight))
        weights = weights / np.sum(weights)
        parts.append(1.0 / (count * np.sum(weights**2)))
        if best is None or parts[-1] > best.effective_part[-1]:
            best = Draws(x, weights, there.predicted, np.array(parts))
        if parts[-1] >= ENOUGH:
            break
        centre = best.mean()
        # Of few draws the covariance is that of noise: some of the proposal's is kept.
        share = best.effective_part[-1]
        covariance = WIDER * best.covariance() + max(0.1, 0.5 - share) * covariance
    return best


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

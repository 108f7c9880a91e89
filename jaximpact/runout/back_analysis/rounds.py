"""Rounds of simulation, each in the part of the prior that is plausible still."""

import concurrent.futures
from typing import NamedTuple

import numpy as np
from scipy.special import expit, logit

from ...errors import InputError
from ...progress import Progress
from ...store import Store
from .data_sets import simulate_data_sets
from .problem import SlopeFit
from .regression import Pool, make_pool, posterior_at, weighted_quantiles
from .summaries import observed_summary, simulated_summaries

MOST_ROUNDS = 8
OUTSIDE = 0.0005
"""Probability beyond each end of a box."""
MARGIN = 1.25
"""Factor by which a box is wider than that, about the median, in z."""
LEAST_WIDTH = 0.02
"""Least width of a box as a fraction of that of the one before."""
ENOUGH = 0.75
"""A box of at least this fraction of the one before ends the rounds."""
LEAST_POOL = 100
"""Number of data sets below which no posterior is found."""
ROUNDING = 1e-9


class Region(NamedTuple):
    """Box of candidates, as probabilities under the priors."""

    low: np.ndarray
    high: np.ndarray

    def z(self, u: np.ndarray) -> np.ndarray:
        """Map candidates in the box to all numbers."""
        inside = (u - self.low) / (self.high - self.low)
        return logit(np.clip(inside, ROUNDING, 1.0 - ROUNDING))

    def u(self, z: np.ndarray) -> np.ndarray:
        """Map numbers to candidates in the box."""
        return self.low + (self.high - self.low) * expit(z)

    def holds(self, u: np.ndarray) -> np.ndarray:
        """Tell which candidates are in the box."""
        return np.all((u >= self.low) & (u <= self.high), axis=1)

    @property
    def volume(self) -> float:
        """Prior probability of the box."""
        return float(np.prod(self.high - self.low))


class Searched(NamedTuple):
    """Result of all rounds."""

    pool: Pool
    """Data sets in the last box."""
    region: Region
    """The last box."""
    volumes: list[float]
    """Prior probability of the box of each round."""
    simulated: int
    """Number of data sets simulated in all."""
    without: int
    """Number of them that lack a channel of what was observed."""


def search(
    fit: SlopeFit,
    store: Store | None,
    progress: Progress,
    executor: concurrent.futures.Executor | None = None,
) -> Searched:
    """Simulate data sets in boxes that shrink to where the posterior is.

    A box holds all but 0.1 % of each parameter's posterior as the round before found
    it, with a margin. Data sets of earlier rounds that lie in a box count in it: they
    are samples of the prior there too.

    Raises InputError where too few candidates give data sets like the observed one.
    """
    count, dimension = fit.data_sets, len(fit.parameters)
    region = Region(np.zeros(dimension), np.ones(dimension))
    target = observed_summary(fit.observed)
    u, summaries = np.empty((0, dimension)), np.empty((0, len(target)))
    volumes: list[float] = []
    while True:
        number = len(volumes)
        volumes.append(region.volume)
        valid = np.all(np.isfinite(summaries), axis=1)
        missing = count - int(np.sum(region.holds(u) & valid))
        if missing > 0:
            rng = np.random.default_rng((fit.slope.seed, number))
            new = rng.uniform(region.low, region.high, (missing, dimension))
            outcomes = simulate_data_sets(
                *(fit, new, fit.observed.released, number, store, progress),
                what=f"data sets of round {number + 1}",
                executor=executor,
            )
            found = simulated_summaries(fit.observed, outcomes, fit.places, number)
            u, summaries = np.vstack([u, new]), np.vstack([summaries, found])
        valid = np.all(np.isfinite(summaries), axis=1)
        inside = region.holds(u) & valid
        _check_enough(fit, inside)
        pool = make_pool(region.z(u[inside]), summaries[inside], target)
        smaller = _shrunk(pool, region)
        if smaller.volume > ENOUGH * region.volume or len(volumes) == MOST_ROUNDS:
            without = int(np.sum(~valid))
            return Searched(pool, region, volumes, len(u), without)
        region = smaller


def _check_enough(fit: SlopeFit, inside: np.ndarray) -> None:
    enough = int(np.sum(inside))
    if enough < LEAST_POOL:
        raise InputError(
            f"only {enough} of {len(inside)} simulated data sets have what was "
            "observed, a block that stops or one at each collector; check the "
            "observations and the releases, or widen the priors",
            file=fit.path,
            key="fit",
        )


def _shrunk(pool: Pool, region: Region) -> Region:
    """Find the box of the next round."""
    samples, weights = posterior_at(pool, pool.t_observed)
    low, middle, high = weighted_quantiles(
        samples, weights, (OUTSIDE, 0.5, 1.0 - OUTSIDE)
    )
    # No farther than there are candidates: data that the model does not explain can
    # lead anywhere.
    ends = np.min(pool.z, axis=0), np.max(pool.z, axis=0)
    low, high = (
        region.u(np.clip(middle + MARGIN * (end - middle), *ends))
        for end in (low, high)
    )
    centre, width = 0.5 * (low + high), region.high - region.low
    half = np.maximum(0.5 * (high - low), 0.5 * LEAST_WIDTH * width)
    return Region(
        np.maximum(centre - half, region.low), np.minimum(centre + half, region.high)
    )

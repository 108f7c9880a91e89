"""Posterior of the fitted parameters: rounds of simulation, each in the part of the
prior that is plausible still, and what their data sets say of each parameter."""

import dataclasses
from typing import NamedTuple

import numpy as np
from scipy.special import bdtr, expit, logit

from ...errors import InputError
from ...store import Store
from .data_sets import (
    mostly_failed,
    observed_summary,
    simulate_data_sets,
    simulated_summaries,
)
from .problem import SlopeFit, SlopeParameter
from .regression import (
    Pool,
    make_pool,
    posterior_at,
    ranks_of_left_out,
    weighted_quantiles,
)


class Region(NamedTuple):
    """Box of candidates, as probabilities under the priors."""

    low: np.ndarray
    high: np.ndarray

    def z(self, u: np.ndarray) -> np.ndarray:
        """Map candidates in the box to all numbers."""
        inside = (u - self.low) / (self.high - self.low)
        return logit(np.clip(inside, 1e-9, 1.0 - 1e-9))  # finite at the ends too

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

    pool: Pool  # data sets in the last box
    region: Region  # the last box
    volumes: list[float]  # prior probability of the box of each round
    simulated: int  # number of data sets simulated in all
    failed: int  # number of them in which most blocks failed, left out
    without: int  # number of others that lack a channel of what was observed


def search(fit: SlopeFit, store: Store | None) -> Searched:
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
    failed = 0
    while True:
        number = len(volumes)
        volumes.append(region.volume)
        valid = np.all(np.isfinite(summaries), axis=1)
        missing = count - int(np.sum(region.holds(u) & valid))
        if missing > 0:
            rng = np.random.default_rng((fit.slope.seed, number))
            new = rng.uniform(region.low, region.high, (missing, dimension))
            outcomes = simulate_data_sets(
                fit=fit,
                u=new,
                blocks=fit.observed.released,
                stream=number,
                store=store,
                what=f"data sets of round {number + 1}",
            )
            simulated = simulated_summaries(fit.observed, outcomes, fit.places, number)
            u, summaries = np.vstack([u, new]), np.vstack([summaries, simulated])
            failed += int(np.sum(mostly_failed(outcomes)))
        valid = np.all(np.isfinite(summaries), axis=1)
        inside = region.holds(u) & valid
        if (enough := int(np.sum(inside))) < 100:
            of_failed = f"; in {failed} most blocks failed" if failed else ""
            raise InputError(
                f"only {enough} of {len(inside)} simulated data sets have what was "
                f"observed, a block that stops or one at each collector{of_failed}; "
                "check the observations and the releases, or widen the priors",
                file=fit.path,
                key="fit",
            )
        pool = make_pool(region.z(u[inside]), summaries[inside], target)
        smaller = _shrunk(pool, region)
        # Boxes that shrink hardly, or again and again, tell no more.
        if smaller.volume > 0.75 * region.volume or len(volumes) == 8:
            without = int(np.sum(~valid)) - failed
            return Searched(pool, region, volumes, len(u), failed, without)
        region = smaller


def _shrunk(pool: Pool, region: Region) -> Region:
    """Find the box of the next round: all but 0.1 % of each parameter's posterior, and
    a quarter more on both sides of the median."""
    samples, weights = posterior_at(pool, pool.t_observed)
    low, middle, high = weighted_quantiles(samples, weights, (0.0005, 0.5, 0.9995))
    # No farther than there are candidates: data that the model does not explain can
    # lead anywhere.
    ends = np.min(pool.z, axis=0), np.max(pool.z, axis=0)
    low, high = (
        region.u(np.clip(middle + 1.25 * (end - middle), *ends)) for end in (low, high)
    )
    # No round shrinks a box to less than 2 %: its posterior is a rough one.
    least = 0.01 * (region.high - region.low)
    centre, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), least)
    return Region(
        np.maximum(centre - half, region.low), np.minimum(centre + half, region.high)
    )


LEVEL = 0.95
TAILS = (0.5 * (1.0 - LEVEL), 0.5, 0.5 * (1.0 + LEVEL))
WIDE = 0.8
"""Width of an interval, as a fraction of the prior's, from which on a parameter is not
determined."""
TOGETHER = 0.9
"""Correlation of ranks above which two parameters act together."""
RARE = 0.01
"""Chance of as few of these within right intervals, below which the report warns."""


@dataclasses.dataclass(frozen=True)
class FittedParameter:
    """Posterior of one parameter, in the unit of its name."""

    parameter: SlopeParameter
    median: float
    low: float  # lower end of the 95 % interval
    high: float  # upper end of it
    prior_low: float  # lower end of the prior's 95 % interval
    prior_high: float  # upper end of it
    ends: tuple[float, float]
    """Ends of the 95 % interval as probabilities under the prior."""
    coverage_68: float
    """Fraction of left-out data sets whose parameter lies in its 68 % interval."""
    coverage_95: float
    """Fraction of left-out data sets whose parameter lies in its 95 % interval."""

    @property
    def ratio(self) -> float:
        """Compute the width of the interval as a fraction of the prior's, both as
        probabilities under the prior."""
        return (self.ends[1] - self.ends[0]) / LEVEL

    @property
    def at_bound(self) -> bool:
        """Tell whether the interval ends where the prior does."""
        return self.ends[0] < 0.005 or self.ends[1] > 0.995

    @property
    def determined(self) -> bool:
        """Tell whether the observations say more than the prior."""
        return self.ratio < WIDE


@dataclasses.dataclass(frozen=True)
class Posterior:
    """Posterior of all fitted parameters."""

    fitted: tuple[FittedParameter, ...]
    u: np.ndarray  # samples as probabilities under the priors, `(samples, parameters)`
    values: np.ndarray  # samples in the units of the names, `(samples, parameters)`
    correlation: np.ndarray  # correlations of ranks, `(parameters, parameters)`
    left_out: int  # number of data sets left out, in turn

    def is_too_narrow(self, fitted: FittedParameter) -> bool:
        """Tell whether left-out data sets lie outside the 95 % interval of a parameter
        more often than by chance."""
        inside = round(fitted.coverage_95 * self.left_out)
        return float(bdtr(inside, self.left_out, LEVEL)) < RARE

    @property
    def pairs_together(self) -> list[tuple[int, int]]:
        """List the pairs of parameters that act together, by index."""
        i, j = np.triu_indices(len(self.fitted), 1)
        strong = np.abs(self.correlation[i, j]) > TOGETHER
        return list(zip(i[strong].tolist(), j[strong].tolist(), strict=True))


def posterior_of(fit: SlopeFit, searched: Searched) -> Posterior:
    """Find the posterior from the data sets of the last box, and test its intervals."""
    # A late import, of half a second.
    from scipy.stats import rankdata

    pool, region = searched.pool, searched.region
    z, weights = posterior_at(pool, pool.t_observed)
    quantiles = region.u(weighted_quantiles(z, weights, TAILS))
    values = fit.values(quantiles)
    prior = fit.values(np.tile(np.array(TAILS)[:, None], len(fit.parameters)))
    count = min(200, len(pool.z) // 4)
    apart = np.abs(ranks_of_left_out(pool, count) - 0.5)
    rng = np.random.default_rng(fit.slope.seed)
    u = region.u(z[rng.choice(len(z), 2000, p=weights)])
    fitted = tuple(
        FittedParameter(
            parameter=parameter,
            median=float(values[1, i]),
            low=float(values[0, i]),
            high=float(values[2, i]),
            prior_low=float(prior[0, i]),
            prior_high=float(prior[2, i]),
            ends=(float(quantiles[0, i]), float(quantiles[2, i])),
            coverage_68=float(np.mean(apart[:, i] <= 0.34)),
            coverage_95=float(np.mean(apart[:, i] <= 0.5 * LEVEL)),
        )
        for i, parameter in enumerate(fit.parameters)
    )
    ranks = rankdata(u, axis=0)
    correlation = np.atleast_2d(np.corrcoef(ranks, rowvar=False))
    return Posterior(fitted, u, fit.values(u), correlation, count)

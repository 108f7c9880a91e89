"""Posterior of the fitted parameters, and what it says of each of them."""

import dataclasses

import numpy as np
from scipy.special import bdtr

from .problem import Parameter, SlopeFit
from .regression import posterior_at, ranks_of_left_out, weighted_quantiles
from .rounds import Searched

LEVEL = 0.95
TAILS = (0.5 * (1.0 - LEVEL), 0.5, 0.5 * (1.0 + LEVEL))
SAMPLES = 2000
"""Number of samples of the posterior that are kept."""
WIDE = 0.8
"""Width of an interval, as a fraction of the prior's, from which on a parameter is not
determined."""
AT_BOUND = 0.005
"""Probability under the prior between an end of an interval and the prior's bound below
which the two are one."""
TOGETHER = 0.9
"""Correlation of ranks above which two parameters act together."""
LEFT_OUT = 200
"""Number of data sets left out, in turn, to test the intervals."""
RARE = 0.01
"""Chance of as few of these within right intervals, below which the report warns."""


@dataclasses.dataclass(frozen=True)
class FittedParameter:
    """Posterior of one parameter, in the unit of its name."""

    parameter: Parameter
    median: float
    low: float
    """Lower end of the 95 % interval."""
    high: float
    """Upper end of it."""
    prior_low: float
    """Lower end of the prior's 95 % interval."""
    prior_high: float
    """Upper end of it."""
    ends: tuple[float, float]
    """Ends of the 95 % interval as probabilities under the prior."""
    coverage_68: float
    """Fraction of left-out data sets whose parameter lies in its 68 % interval."""
    coverage_95: float
    """The same for its 95 % interval."""

    @property
    def ratio(self) -> float:
        """Compute the width of the interval as a fraction of the prior's, both as
        probabilities under the prior."""
        return (self.ends[1] - self.ends[0]) / LEVEL

    @property
    def at_bound(self) -> bool:
        """Tell whether the interval ends where the prior does."""
        return self.ends[0] < AT_BOUND or self.ends[1] > 1.0 - AT_BOUND

    @property
    def determined(self) -> bool:
        """Tell whether the observations say more than the prior."""
        return self.ratio < WIDE


@dataclasses.dataclass(frozen=True)
class Posterior:
    """Posterior of all fitted parameters."""

    fitted: tuple[FittedParameter, ...]
    u: np.ndarray
    """Samples as probabilities under the priors, `(samples, parameters)`."""
    values: np.ndarray
    """The same in the units of the names."""
    correlation: np.ndarray
    """Correlations of ranks, `(parameters, parameters)`."""
    left_out: int
    """Number of data sets left out, in turn."""

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
    values, prior = (
        fit.values(quantiles),
        fit.values(np.tile(np.array(TAILS)[:, None], len(fit.parameters))),
    )
    count = min(LEFT_OUT, len(pool.z) // 4)
    apart = np.abs(ranks_of_left_out(pool, count) - 0.5)
    rng = np.random.default_rng(fit.slope.seed)
    u = region.u(z[rng.choice(len(z), SAMPLES, p=weights)])
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

r"""Uncertainty of the standard deviations of groups' factors that are estimated.

With b the logarithms of the factors of G groups, s their standard deviation, and C_0
the objective function without the prior of b, the posterior of the unknowns x and s is

$$ p(x, s) \propto s^{-G} \, e^{-C_0(x) - \sum_g b_g^2 / 2 s^2}, $$

with a uniform prior on s between its limits (Gelman 2006, doi 10.1214/06-BA117A). With
C_0 a parabola about the fit, x is normal for each s, with mean x_s and covariance V_s,
and

$$ p(s) \propto s^{-G} \, |V_s|^{1/2} \, e^{-C_0(x_s) - \sum_g b_{s,g}^2 / 2 s^2} $$

is the restricted likelihood, largest at the estimate of s (`estimation.sigma`).
"""

import numpy as np

from ..estimation.linear_algebra import inverse_positive
from ..estimation.sigma import places_of_estimated
from ..problem.nuisance import LEAST_GROUP_SD, MOST_GROUP_SD, group_sds
from ..problem.objective import Objective, Points
from .posterior import normalised

VALUES = 100
"""Values of each s between its limits, in steps of 5 %."""
AVERAGED = 64
"""Values of s over which a covariance is averaged."""
LATTICE = 19
"""Generator of the lattice of these values where there are several s (Korobov)."""


class GroupSds:
    """Distribution of the standard deviations s of groups' factors, in the parabola at
    a fit; without any, of the unknowns x alone.

    Args:
        objective, points: the fit, of one lane.
        curvature: that of the objective function over s^2, positive definite.
        inflation: this s^2. Priors of groups are not multiplied by it.
    """

    def __init__(
        self,
        objective: Objective,
        points: Points,
        curvature: np.ndarray,
        inflation: float,
    ):
        self.x, self.bounds = points.x[0], objective.bounds
        self.slope, self.inflation = objective.bounds.slope(self.x), inflation
        self.names = list(group_sds(objective.study.nuisances))
        self.best = np.array(list(group_sds(objective.study.nuisances).values()))
        self.places = places_of_estimated(objective.study)
        self.curvature = curvature - np.diag(self.information(self.best) / inflation)
        """Curvature of C_0 over s^2."""
        self.values = np.geomspace(LEAST_GROUP_SD, MOST_GROUP_SD, VALUES)
        self.shares = [self._shares(place) for place in range(len(self.best))]
        """Probability of each value, of each s."""

    def information(self, sds: np.ndarray) -> np.ndarray:
        """Compute the information of the priors on x, shape (..., unknowns)."""
        found = np.zeros((*sds.shape[:-1], len(self.x)))
        for number, place in enumerate(self.places):
            found[..., place] = (self.slope[place] / sds[..., number, None]) ** 2
        return found

    def _shares(self, place: int) -> np.ndarray:
        """Compute the probabilities of the values of one s, the others at their
        estimates."""
        sds = np.tile(self.best, (VALUES, 1))
        sds[:, place] = self.values
        x, covariance = self.of_unknowns(sds)
        apart = x - self.x
        # At the fit the gradient of C_0 is minus that of the prior.
        pull = self.information(self.best) / self.inflation * self.x
        cost = 0.5 * np.einsum("sp,pq,sq->s", apart, self.curvature, apart)
        log = 0.5 * np.linalg.slogdet(covariance)[1] - cost + apart @ pull
        return normalised(log + self.log_prior(x, sds))

    def of_unknowns(self, sds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute mean and covariance of the unknowns for given s, shape (rows,
        nuisances)."""
        information = self.information(sds)
        diagonal = np.eye(len(self.x)) * information[:, None]
        covariance = inverse_positive(self.curvature + diagonal)
        change = information - self.information(self.best) / self.inflation
        return self.x - (covariance @ (change * self.x)[..., None])[..., 0], covariance

    def log_prior(self, x: np.ndarray, sds: np.ndarray) -> np.ndarray:
        """Compute the logarithm of the density of factors and s, up to a constant, per
        step of ln s, shape (rows,)."""
        found = np.zeros(len(x))
        for number, place in enumerate(self.places):
            factors = self.bounds.parameter(x)[:, place]
            s = sds[:, number]
            square = np.sum(factors**2, axis=1)
            # A uniform prior of s has the density s in ln s.
            found += (1.0 - factors.shape[1]) * np.log(s) - 0.5 * square / s**2
        return found

    def log_ratio(self, x: np.ndarray, sds: np.ndarray) -> np.ndarray:
        """Compute what is added to -cost / s^2, whose cost has the estimates of s."""
        best = np.broadcast_to(self.best, sds.shape)
        stated = 0.5 * np.sum(self.information(best) * x**2, axis=1)
        return self.log_prior(x, sds) + stated / self.inflation

    def slopes(self, x: np.ndarray, sds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute the derivatives of `log_ratio` with respect to x, shape (rows,
        unknowns), and to ln s, shape (rows, nuisances)."""
        best = self.information(self.best) / self.inflation
        by_s = np.empty_like(sds)
        for number, place in enumerate(self.places):
            factors = self.bounds.parameter(x)[:, place] / sds[:, number, None]
            by_s[:, number] = 1.0 - factors.shape[1] + np.sum(factors**2, axis=1)
        return (best - self.information(sds)) * x, by_s

    def sample(self, random, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Sample s, shape (count, nuisances), and compute the logarithms of their
        probabilities."""
        sds, log = np.empty((count, len(self.shares))), np.zeros(count)
        for number, shares in enumerate(self.shares):
            chosen = random.choice(VALUES, count, p=shares)
            sds[:, number] = self.values[chosen]
            log += np.log(shares[chosen])
        return sds, log

    def lattice(self) -> np.ndarray:
        """Spread values of s over their distribution, shape (rows, nuisances)."""
        steps = np.mod(LATTICE ** np.arange(len(self.shares)), AVERAGED)
        parts = (np.arange(AVERAGED)[:, None] * steps % AVERAGED + 0.5) / AVERAGED
        columns = [
            self.values[np.searchsorted(np.cumsum(shares), part)]
            for shares, part in zip(self.shares, parts.T, strict=True)
        ]
        return np.stack(columns, axis=1)

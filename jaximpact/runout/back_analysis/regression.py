r"""Posterior of parameters from simulated data sets, by regression on their summaries.

Parameters are mapped from a box of candidates to all numbers, $z = \mathrm{logit}((u -
l)/(h - l))$, with the probabilities u under the priors. In two steps the summaries s of
data sets become samples of the posterior:

1. A quadratic ridge regression predicts z from s; its prediction t(s), of as many
   numbers as there are parameters, is the summary that the second step compares. Each
   data set is predicted by a regression that has not seen it.
2. Near the t of what was observed, mean and variance of z are regressed on t, and each
   data set is moved along them:

$$ z_k^* = m(t_0) + \frac{\sigma(t_0)}{\sigma(t_k)} (z_k - m(t_k)), $$

   weighted by an Epanechnikov kernel of the distance of t.

Sources: Fearnhead and Prangle (2012), Constructing summary statistics for approximate
Bayesian computation; Beaumont, Zhang and Balding (2002), Approximate Bayesian
computation in population genetics; Blum and François (2010), Non-linear regression
models for approximate Bayesian computation.
"""

from typing import NamedTuple

import numpy as np

FOLDS = 5  # regressions, each of all data sets but a fifth
TINY = 1e-12
"""Weight or variance that is rounding."""


class Pool(NamedTuple):
    """Data sets in coordinates in which the posterior is found."""

    z: np.ndarray  # parameters, mapped to all numbers, `(data sets, parameters)`
    t: np.ndarray  # predicted parameters, `(data sets, parameters)`
    t_observed: np.ndarray  # parameters predicted from the observation, `(parameters,)`
    scale: np.ndarray  # standard deviations of z - t, `(parameters,)`

    def distance(self, t: np.ndarray) -> np.ndarray:
        """Compute the distance of each data set from t, `(data sets,)`."""
        return np.sqrt(np.sum(((self.t - t) / self.scale) ** 2, axis=1))


def make_pool(z: np.ndarray, summaries: np.ndarray, observed: np.ndarray) -> Pool:
    """Predict the parameters of each data set, `(data sets, parameters)`, from its
    summaries, `(data sets, statistics)`, all finite."""
    features, of_observed = _features(summaries, observed)
    fold = np.arange(len(z)) % FOLDS  # candidates are random already
    t, t_observed = np.empty_like(z), np.zeros(z.shape[1])
    # The ridge adds 1 % to the variance of each feature.
    penalty = 1e-2 * np.eye(features.shape[1])
    penalty[0, 0] = 0.0
    for i in range(FOLDS):
        x, y = features[fold != i], z[fold != i]
        gram = x.T @ x / len(x) + penalty
        coefficients = np.linalg.solve(gram, x.T @ y / len(x))
        t[fold == i] = features[fold == i] @ coefficients
        t_observed += of_observed @ coefficients / FOLDS
    return Pool(z, t, t_observed, np.std(z - t, axis=0) + TINY)


def _features(
    summaries: np.ndarray, observed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the first 15 principal components, but for those of no variance, and
    products of the first five."""
    mean, spread = np.mean(summaries, axis=0), np.std(summaries, axis=0)
    varies = spread > TINY * (1.0 + np.abs(mean))
    both = np.vstack([summaries, observed])[:, varies]
    both = (both - mean[varies]) / spread[varies]
    values, vectors = np.linalg.eigh(both[:-1].T @ both[:-1] / len(summaries))
    chosen = np.argsort(-values)[:15]
    chosen = chosen[values[chosen] > 1e-8 * np.max(values, initial=0.0)]
    both = both @ vectors[:, chosen] / np.sqrt(values[chosen])
    # Beyond all data sets a quadratic means nothing: take the outermost.
    both[-1] = np.clip(both[-1], np.min(both[:-1], axis=0), np.max(both[:-1], axis=0))
    first = both[:, :5]
    i, j = np.triu_indices(first.shape[1])
    products = first[:, i] * first[:, j]
    features = np.column_stack([np.ones(len(both)), both, products])
    return features[:-1], features[-1]


def posterior_at(
    pool: Pool, t: np.ndarray, left_out: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Sample the posterior for summaries that predict t, without the data set of the
    index `left_out`.

    Returns:
        Samples `(samples, parameters)` of z, and their weights `(samples,)`.
    """
    distance = pool.distance(t)
    if left_out is not None:
        distance[left_out] = np.max(distance)
    # The nearest 20 %, but 25 at least for each coefficient of the mean.
    least = 25 * (1 + 2 * pool.z.shape[1])
    count = min(max(int(0.2 * len(distance)), least), len(distance) - 1)
    near = np.argpartition(distance, count)[: count + 1]
    weight = 1.0 - (distance[near] / np.max(distance[near])) ** 2
    # The farthest, and the one left out, have no weight.
    near, weight = near[weight > TINY], weight[weight > TINY]
    apart = (pool.t[near] - t) / pool.scale
    linear = np.column_stack([np.ones(len(near)), apart])
    root = np.sqrt(weight)[:, None]

    def fitted(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Give the regression at the data sets, and at t."""
        solution, *_ = np.linalg.lstsq(root * x, root * y, rcond=1e-10)
        return x @ solution, solution[0]

    mean, at = fitted(np.column_stack([linear, apart**2]), pool.z[near])
    rest = pool.z[near] - mean
    logarithm, log_at = fitted(linear, np.log(rest**2 + TINY))
    ratio = np.exp(0.5 * np.clip(log_at - logarithm, -4.0, 4.0))
    return at + ratio * rest, weight / np.sum(weight)


def weighted_quantiles(
    values: np.ndarray, weights: np.ndarray, probabilities
) -> np.ndarray:
    """Compute quantiles of weighted samples, `(probabilities, parameters)`."""
    quantiles = []
    for column in values.T:
        order = np.argsort(column)
        middle = np.cumsum(weights[order]) - 0.5 * weights[order]
        quantiles.append(np.interp(probabilities, middle, column[order]))
    return np.stack(quantiles, axis=1)


def ranks_of_left_out(pool: Pool, count: int) -> np.ndarray:
    """Compute, for the data sets nearest to the observed one, which probability their
    posterior, found without them, gives to what lies below their true parameters,
    `(data sets, parameters)`.

    They are uniform where the posterior is right: simulation-based calibration (Talts
    et al. 2018, Validating Bayesian inference algorithms with simulation-based
    calibration).
    """
    nearest = np.argsort(pool.distance(pool.t_observed))[:count]
    ranks = []
    for i in nearest:
        samples, weights = posterior_at(pool, pool.t[i], left_out=int(i))
        ranks.append(weights @ (samples < pool.z[i]))
    return np.array(ranks)

r"""What draws say where sigmas were estimated: the scale of the scatter is not known.

The draws' density takes a sigma that was estimated for true. With it left open, its
prior uniform in the logarithm, n measurements of a target have the density

$$ p(x) \propto \left(1 + \frac{S(x) - S_0}{\nu}\right)^{-n/2} $$

in place of exp(-(S - S_0) / 2), S the sum of squares in units of that sigma, S_0 at the
best fit, and nu the degrees of freedom that the fit left: of a linear model Student's
distribution instead of the normal one. The draws keep their places and get other
weights. (With few degrees of freedom predictions would otherwise be too sure: of 8
tests with two parameters, intervals of 95 % of the model held 87 %.)
"""

import numpy as np

from .draws import Draws
from .losses import LOSSES
from .objective import Objective, Points
from .scatter import LEAST_FREEDOM
from .uncertainty import leverages


def freedom_of_targets(objective: Objective, points: Points) -> np.ndarray:
    """Exact measurements of each target less what the fit takes up of them,
    `(targets,)`.

    Args:
        points: the best fit, of one lane.
    """
    exact = _exact(objective) & np.isfinite(points.predicted[0])
    taken = np.where(exact, leverages(objective, points), 0.0)
    return np.sum(exact, axis=0) - np.sum(taken, axis=0)


def weights_of(objective: Objective, points: Points, draws: Draws) -> np.ndarray:
    """Weights of draws with the scale of every estimated sigma left open; they sum to
    1.

    Targets with less than a degree of freedom share one scale, as they do when sigmas
    are estimated. The losses must be Gaussian: else the weights are those of the draws.
    """
    study = objective.study
    if study.loss != LOSSES[0]:
        return draws.weights
    exact = _exact(objective)
    count = np.sum(exact, axis=0)
    squares = _squares(objective, draws.predicted, exact)
    least = _squares(objective, points.predicted, exact)[0]
    freedom = freedom_of_targets(objective, points)
    log_weights = np.log(np.maximum(draws.weights, 1e-300))
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
    weights = np.exp(log_weights - np.max(log_weights))
    return weights / np.sum(weights)


def _exact(objective: Objective) -> np.ndarray:
    study = objective.study
    return study.known & (study.censored == 0)


def _squares(objective: Objective, predicted, exact) -> np.ndarray:
    """Of what is measured and predicted, `(draws, targets)`."""
    u = (predicted - objective.study.measured) / objective.sigma
    return np.sum(np.where(exact & np.isfinite(u), u, 0.0) ** 2, axis=1)

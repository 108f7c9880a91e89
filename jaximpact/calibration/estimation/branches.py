r"""Branches of the impacts: where predictions jump.

A contact ends where the normal force comes down to zero. Where it only nearly does, the
block falls back, and ends later with other velocities: the prediction of that test
jumps between neighbouring parameters, and between two jumps (on one branch) it is
smooth. A prediction has left the branch of a fit where it differs by more than three
sigmas from what the derivatives at the fit predict,

$$ | y(x) - \hat y - J (x - \hat x) | > 3 \sigma . $$

The lowest cost may lie at such a jump. Fits by derivatives stop somewhere along it; a
search about them goes on (`search.fit_beside_jump`).
"""

import numpy as np

from ..problem.objective import Objective, Points

JUMP = 3.0
"""Sigmas by which a prediction differs from the linear one beyond a jump."""
DRAWS = 64
"""Points about a fit at which jumps are looked for."""
NEAR = 0.02
"""Fraction of these points beyond a jump from which a measurement is near it."""
HALVINGS = 10
"""Number of halvings of the way to a point, which tell a jump from curvature."""
SHARES_AGAIN = 3
"""Number of searches for tests near a jump."""
MEDIAN = 0.455
"""Median of the square of a standard normal number."""


def has_left(objective: Objective, fit: Points, points: Points) -> np.ndarray:
    """Find the predictions that have left their branch at a fit (one lane, with
    derivatives), measured or not, shape (lanes, tests, targets); one that is missing in
    one of both has left it.

    Args:
        points: of which `x` and `predicted` are used.
    """
    apart = points.x - fit.x[0]
    linear = fit.predicted[0] + np.einsum("rtp,lp->lrt", fit.jacobian[0], apart)
    there = np.isfinite(points.predicted), np.isfinite(linear)
    missing = there[0] != there[1]
    with np.errstate(invalid="ignore"):
        far = np.abs(points.predicted - linear) > JUMP * objective.sigma
    return far | missing


def unit_without_jumps(objective: Objective, fit: Points) -> float:
    """Compute max(1, s^2) at a fit (one lane), the unit for differences of costs, from
    the median residual: tests beyond a jump do not count."""
    known = objective.study.known & np.isfinite(fit.predicted[0])
    apart = (fit.predicted[0] - objective.study.measured) / objective.sigma
    squares = apart[known] ** 2
    return max(1.0, float(np.median(squares)) / MEDIAN) if len(squares) else 1.0


def error_root(objective: Objective, fit: Points) -> np.ndarray:
    """Compute a root R of the covariance R R^T at a fit (one lane), with the bounds as
    a weak prior: always finite."""
    curvature = fit.hessian[0] / unit_without_jumps(objective, fit)
    curvature += np.diag(objective.bounds_information)
    values, vectors = np.linalg.eigh(curvature)
    least = 1e-12 * max(values[-1], 1e-300)
    return vectors / np.sqrt(np.maximum(values, least))


def draws_about(
    objective: Objective, fit: Points, root: np.ndarray, count: int
) -> np.ndarray:
    """Sample unknowns between the bounds, shape (draws, unknowns), normally distributed
    about a fit (one lane) with the covariance R R^T of a root R."""
    random = np.random.default_rng(objective.study.seed)
    x = fit.x + random.standard_normal((count, len(root))) @ root.T
    return np.clip(x, objective.bounds.low, objective.bounds.high)


def jump_shares(objective: Objective, fit: Points) -> np.ndarray:
    """Compute the fraction of points about a fit (one lane, with derivatives), normally
    distributed with its covariance, at which each prediction has left its branch, shape
    (tests, targets).

    Beside a jump a derivative may be very steep, and the covariance too small: it is
    that of the measurements that are not near a jump. Where parameters are hardly known
    the region is wide, and predictions leave the linear ones without a jump: these do
    not count.
    """
    near = np.zeros(objective.study.known.shape, bool)
    for _ in range(SHARES_AGAIN):
        rest = objective.without(near)
        root = error_root(rest, rest.reevaluate(fit))
        draws = rest.values(draws_about(objective, fit, root, DRAWS))
        beyond = has_left(objective, fit, draws) & objective.study.known
        share = np.mean(is_abrupt(objective, fit, draws, beyond), axis=0)
        if not np.any((share > NEAR) & ~near):
            break
        near |= share > NEAR
    return share


def is_abrupt(
    objective: Objective, fit: Points, points: Points, beyond: np.ndarray
) -> np.ndarray:
    """Tell predictions that jump on the way from a fit (one lane) from those that bend.

    The way is halved again and again, each time to the half on which the prediction
    changes more. What is left of the change by then is a jump.

    Args:
        points: ends of the ways, of which `x` and `predicted` are used.
        beyond: mask of the predictions that are looked at, shape (lanes, tests,
            targets).
    """
    jumps = np.zeros_like(beyond)
    for test, target in np.argwhere(np.any(beyond, axis=0)):
        part = objective.of_tests(np.array([test]))
        lanes = np.flatnonzero(beyond[:, test, target])
        least = 0.5 * JUMP * objective.sigma[test, target]
        near, far = np.repeat(fit.x, len(lanes), axis=0), points.x[lanes]
        of_near = np.repeat(fit.predicted[:, test, target], len(lanes))
        of_far = points.predicted[lanes, test, target]
        for _ in range(HALVINGS):
            # A change smaller than a jump is a bend, and not halved again.
            left = _apart(of_near, of_far) > least
            lanes, near, far = lanes[left], near[left], far[left]
            of_near, of_far = of_near[left], of_far[left]
            if not len(lanes):
                break
            middle = 0.5 * (near + far)
            of_middle = part.values(middle).predicted[:, 0, target]
            first = _apart(of_near, of_middle) >= _apart(of_middle, of_far)
            near = np.where(first[:, None], near, middle)
            far = np.where(first[:, None], middle, far)
            of_near = np.where(first, of_near, of_middle)
            of_far = np.where(first, of_middle, of_far)
        jumps[lanes, test, target] = _apart(of_near, of_far) > least
    return jumps


def _apart(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Compute the distance of predictions; 0 where both are missing, infinite where
    one is."""
    change = np.where(np.isnan(one) & np.isnan(other), 0.0, np.abs(one - other))
    return np.where(np.isnan(change), np.inf, change)

r"""Branches of the impacts: where predictions jump, and the best fit beside a jump.

A contact ends where the normal force comes down to zero. Where it only nearly does, the
block falls back, and ends later with other velocities: the prediction of that test
jumps between neighbouring parameters, and between two jumps (on one branch) it is
smooth. A prediction has left the branch of a fit where it differs by more than three
sigmas from what the derivatives at the fit predict,

$$ | y(x) - \hat y - J (x - \hat x) | > 3 \sigma . $$

The lowest cost may lie at such a jump. Fits by derivatives stop somewhere along it;
`descend_on_branches` goes on along it.
"""

import numpy as np

from ...progress import tell, within
from ..problem.objective import Objective, Points
from .least_squares import ROUGH, Fits, Reason, levenberg_marquardt

JUMP = 3.0
"""Sigmas by which a prediction differs from the linear one beyond a jump."""
DRAWS = 64
"""Points about a fit at which jumps are looked for."""
NEAR = 0.02
"""Fraction of these points beyond a jump from which a measurement is near it."""
STEPS, ROUNDS = 256, 12
"""Steps that are tried side by side along a jump, and how often."""
LEAST, MOST = 0.005, 1.5
"""Distances, in standard errors, of steps from the way to the linear minimum."""
AT_A_TIME = 4
"""Number of points whose costs are computed at full accuracy at a time."""
HALVINGS = 10
"""Number of halvings of the way to a point, which tell a jump from curvature."""
SHARES_AGAIN = 3
"""Number of searches for tests near a jump."""
LEAPS = 6
"""Number of restarts of a fit from a point of lower cost beyond a jump."""
BEYOND = ROUGH._replace(promise=1e-3, part=1e-3, steps=12, joins=False)
"""Stopping rule of these fits."""
MEDIAN = 0.455
"""Median of the square of a standard normal number."""
PROMISE = 5e-3
"""Predicted fall of the cost, in s^2, that is not worth a step."""


def jumped(objective: Objective, fit: Points, points: Points) -> np.ndarray:
    """Find the tests whose predictions at points have left their branch at a fit (one
    lane, with derivatives), shape (lanes, tests); one that is missing in one of both
    has left it."""
    return np.any(_jumped_cells(objective, fit, points), axis=2)


def _jumped_cells(objective: Objective, fit: Points, points: Points) -> np.ndarray:
    """Find the measured predictions that have left their branch at a fit, shape (lanes,
    tests, targets)."""
    return has_left(objective, fit, points) & objective.study.known


def has_left(objective: Objective, fit: Points, points: Points) -> np.ndarray:
    """Find the predictions that have left their branch at a fit, measured or not, shape
    (lanes, tests, targets).

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
    width = objective.bounds.high - objective.bounds.low
    weak = np.where(np.isinf(objective.prior_sd), 12.0 / width**2, 0.0)
    curvature = fit.hessian[0] / unit_without_jumps(objective, fit) + np.diag(weak)
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
    """Compute the fraction of points about a fit, normally distributed with its
    covariance, at which each prediction has left its branch, shape (tests, targets).

    Beside a jump a derivative may be very steep, and the covariance too small: it is
    that of the measurements that are not near a jump. Where parameters are hardly known
    the region is wide, and predictions leave the linear ones without a jump: these do
    not count.

    Args:
        fit: one lane, with derivatives.
    """
    near = np.zeros(objective.study.known.shape, bool)
    for _ in range(SHARES_AGAIN):
        rest = objective.without(near)
        root = error_root(rest, rest.reevaluate(fit))
        draws = rest.values(draws_about(objective, fit, root, DRAWS))
        beyond = _jumped_cells(objective, fit, draws)
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
    found = np.zeros_like(beyond)
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
        found[lanes, test, target] = _apart(of_near, of_far) > least
    return found


def _apart(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Compute the distance of predictions; 0 where both are missing, infinite where
    one is."""
    change = np.where(np.isnan(one) & np.isnan(other), 0.0, np.abs(one - other))
    return np.where(np.isnan(change), np.inf, change)


def descend_on_branches(objective: Objective, fits: Fits) -> Fits:
    """Descend from where a jump has stopped a fit: beyond it, or along it.

    Where one of many points about the fit, near and far, has a lower cost, a fit starts
    there. Else, unless the fit is at a minimum, steps about the minimum of the
    linearised cost are tried for the tests near a jump alone, many side by side; the
    best one on which none jumps is taken.

    Args:
        fits: one lane.

    Equal arguments give equal numbers on one machine.
    """
    random = np.random.default_rng(objective.study.seed)
    for number in range(1, LEAPS + 1):
        fit, steps = fits.points, fits.steps
        if np.any(objective.failed(fit.predicted)):
            break
        steps_about = _sampled_steps(objective, fit, DRAWS, random)
        draws, begin = _screened(objective, fit.x + steps_about)
        near = np.any(jumped(objective, fit, draws), axis=0)
        least = PROMISE * unit_without_jumps(objective, fit)
        if begin.cost[0] >= fit.cost[0] - least:
            if fits.reasons[0].at_minimum or not np.any(near):
                break
            along = _descend_along(objective, fits, near)
            if along.points.cost[0] >= fit.cost[0] - least:
                return along
            fits = along
            begin, steps = along.points, along.steps
        with within(f"beyond a jump, {number}, "):
            again = levenberg_marquardt(objective, begin.x, None, BEYOND)
        if again.points.cost[0] < fits.points.cost[0]:
            fits = again._replace(steps=again.steps + steps)
        elif fits.reasons[0].at_minimum:
            break
    return fits


def _descend_along(objective: Objective, fits: Fits, near: np.ndarray) -> Fits:
    """Descend along a jump, which a mask of tests are near."""
    fit, taken = fits.points, 0
    random = np.random.default_rng(objective.study.seed)
    for number in range(1, ROUNDS + 1):
        tell(f"along a jump, step {number}: cost {fit.cost[0]:.6g}")
        steps = _steps(objective, fit, random)
        if not len(steps):
            break
        part = objective.of_tests(np.flatnonzero(near))
        fit_of_part = fit._replace(
            predicted=fit.predicted[:, near], jacobian=fit.jacobian[:, near]
        )
        beyond = jumped(part, fit_of_part, part.values(fit.x + steps))
        allowed = steps[~np.any(beyond, axis=1)]
        if not len(allowed):
            break
        tried = objective(fit.x + allowed[:1])
        if tried.cost[0] < fit.cost[0]:
            fit, taken = tried, taken + 1
            continue
        more = jumped(objective, fit, tried)[0] & ~near
        if not np.any(more):
            break
        near = near | more
    return Fits(fit, [Reason.edge], fits.steps + taken)


def _steps(objective: Objective, fit: Points, random) -> np.ndarray:
    """Sample steps that are predicted to lower the cost, that of the largest fall
    first, shape (steps, unknowns)."""
    steps = _sampled_steps(objective, fit, STEPS, random)
    square = np.einsum("lp,pq,lq->l", steps, fit.hessian[0], steps)
    fall = -(steps @ fit.gradient[0] + 0.5 * square)
    order = np.argsort(-fall, kind="stable")
    good = fall[order] > PROMISE * unit_without_jumps(objective, fit)
    return steps[order][good]


def best_about(objective: Objective, fit: Points) -> Points:
    """Find the point of lowest cost among a fit (one lane, of an objective of another
    accuracy) and many points about it."""
    random = np.random.default_rng(objective.study.seed)
    steps = _sampled_steps(objective, fit, STEPS, random)
    x = np.concatenate([fit.x, fit.x + steps])
    return objective(_screened(objective, x)[1].x)


def _screened(objective: Objective, x: np.ndarray) -> tuple[Points, Points]:
    """Compute points at the accuracy that the sigmas need, and the best of them at that
    of the objective: in order of cost, until none that is left is lower."""
    coarse = objective.no_finer_than_sigmas()
    points = coarse.values(x)
    order = np.argsort(points.cost, kind="stable")
    if coarse is objective:
        return points, points.take(order[:1])

    def lowest(first: int) -> Points:
        fine = objective.values(x[order[first : first + AT_A_TIME]])
        return fine.take([np.argmin(fine.cost)])

    best = lowest(0)
    for first in range(AT_A_TIME, len(x), AT_A_TIME):
        if best.cost[0] <= points.cost[order[first]]:
            break
        best = min(best, lowest(first), key=lambda one: float(one.cost[0]))
    return points, best


def _sampled_steps(objective: Objective, fit: Points, count: int, random) -> np.ndarray:
    """Sample steps within the bounds about the way to the linear minimum, some close to
    it and some far, shape (count, unknowns)."""
    bounds = objective.bounds
    root, unit = error_root(objective, fit), unit_without_jumps(objective, fit)
    way = -root @ (root.T @ fit.gradient[0]) / unit
    # Beside a jump the way may lead across it at once: half of the steps keep off it.
    part = random.random((count, 1)) * (random.random((count, 1)) < 0.5)
    size = np.exp(random.uniform(np.log(LEAST), np.log(MOST), (count, 1)))
    aside = random.standard_normal((count, len(way))) @ root.T
    x = np.clip(fit.x[0] + part * way + size * aside, bounds.low, bounds.high)
    return x - fit.x[0]

r"""Sigmas that are not given, from the scatter about the fit, target by target.

For the n measurements of a target, of which the fit takes up p degrees of freedom (the
sum of their leverages), sigma is such that

$$ \sum_i u_i \rho'(u_i) + \sum_{\text{limits}} u_i \rho'(u_i) = \kappa \, (n - p), $$

with u the residuals in units of sigma and kappa the mean of u rho' under Gaussian
scatter: the restricted maximum likelihood where all is Gaussian and measured. For a
robust loss it is Huber's second proposal.

Where scatter is proportional (`proportional`) the sigmas of a target are a factor r on
the sizes of what the fit predicts, and r is found likewise. A fit takes its sigmas for
given, so that it gains nothing by predicting more in order to have larger ones; they
follow it in turns.
"""

import numpy as np

from .least_squares import Fits, Progress
from .losses import losses, scale_of_normal
from .objective import Objective, Points
from .proportional import least_size, root_mean_square
from .stopping import FINE
from .study_file import Study
from .uncertainty import leverages

LEAST_PART = 1e-3
"""Part of a target's root mean square, or of its size where scatter is proportional,
below which no sigma is taken: nothing is measured better, and targets without noise
would give 0."""
LEAST_FREEDOM = 0.99
"""Degrees of freedom that a target needs for a sigma of its own: one, to rounding."""
ROUNDS = 20
SETTLED = 3e-3
"""Relative change of every sigma at which they have settled."""


def sizes(study: Study, values: np.ndarray) -> np.ndarray:
    """What sigmas are in proportion to, `(tests, targets)`; 1 where they are constant.

    Args:
        values: of the targets, likewise. Where one is NaN the measured value stands for
            it, and y_0 where there is none either.
    """
    values = np.where(np.isfinite(values), values, study.measured)
    values = np.where(np.isfinite(values), np.abs(values), 0.0)
    floored = np.maximum(values, least_size(study.measured))
    return np.where(study.proportional, floored, 1.0)


def part_of_size(study: Study, sigma: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    """r of each target that sigmas have at a fit, `(targets,)`; NaN where they are
    constant.

    Args:
        sigma, predicted: `(tests, targets)`. Sigmas that are not of this fit, nominal
            ones or those of a step before, have no one r: it is the median's.
    """
    ratio = np.where(study.known, sigma / sizes(study, predicted), np.nan)
    return np.where(study.proportional, np.nanmedian(ratio, axis=0), np.nan)


def resized(study: Study, sigma: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    """Sigmas with the same r, in proportion to other values, `(tests, targets)`."""
    r = part_of_size(study, sigma, predicted)
    return np.where(study.proportional, r * sizes(study, predicted), sigma)


def estimate_sigma(objective: Objective, points: Points) -> np.ndarray:
    """The sigmas, `(tests, targets)`, after one round at a fit (points of one lane).

    A target with too few measurements for a sigma of its own shares, with those like
    it, one factor on the nominal sigmas; without degrees of freedom it keeps them.
    """
    study, predicted = objective.study, points.predicted[0]
    sigma = resized(study, objective.sigma, predicted)
    objective = objective.with_sigma(sigma.copy())
    used = study.known & np.isfinite(predicted)
    u = np.where(used, (predicted - study.measured) / sigma, 0.0)
    work = np.where(used, u * losses(u, study.censored, study.loss).slope, 0.0)
    exact = used & (study.censored == 0)
    of_exact = np.sum(np.where(exact, work, 0.0), axis=0)
    of_limits = np.sum(np.where(exact, 0.0, work), axis=0)
    count = np.sum(exact, axis=0)
    freedom = count - np.sum(np.where(exact, leverages(objective, points), 0.0), axis=0)
    kappa = scale_of_normal(study.loss)

    def factor(targets) -> float:
        left = np.sum(freedom[targets])
        if left < LEAST_FREEDOM:
            return 1.0
        # Limits that the fit misses could make this negative.
        below = max(kappa * left - np.sum(of_limits[targets]), 0.2 * kappa * left)
        return float(np.sqrt(np.sum(of_exact[targets]) / below))

    wanted = ~study.sigma_given
    alone = wanted & (freedom >= LEAST_FREEDOM)
    for target in np.flatnonzero(alone):
        sigma[:, target] *= factor([target])
    together = np.flatnonzero(wanted & ~alone)
    if len(together):
        sigma[:, together] *= factor(together)
    scale = np.where(study.proportional, 1.0, root_mean_square(study.measured))
    least = LEAST_PART * scale * sizes(study, predicted)
    return np.where(wanted, np.maximum(sigma, least), sigma)


def settle(
    objective: Objective, fits: Fits, fit, progress: Progress
) -> tuple[Objective, Fits]:
    """Sigmas and fit in turns until they agree.

    Args:
        fits: of one lane, the best.
        fit: called as `fit(objective, x, patience, progress)`.
    """
    if np.all(objective.study.sigma_given):
        return objective, fits
    for number in range(1, ROUNDS + 1):
        sigma = estimate_sigma(objective, fits.points)
        # Of a cell without measurement the sigma moves no fit.
        known = objective.study.known
        change = np.max(np.abs(np.log(sigma / objective.sigma)[known]))
        objective = objective.with_sigma(sigma)
        points = objective.reweigh(fits.points)
        fits = Fits(points, fits.reasons, fits.steps)
        if change <= SETTLED:
            break
        fits = fit(
            objective,
            points.x,
            patience=FINE,
            progress=lambda text, number=number: progress(
                f"errors of measurement, round {number}: {text}"
            ),
        )
    return objective, fits

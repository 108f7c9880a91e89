r"""Priors that the tests contradict.

Without the prior of a parameter the fit has a cost C_0; with it, C_1, both with the
sigmas, inflated, of a fit without it. Of a linear model with Gaussian scatter

$$ z = \sqrt{2 \, (C_1 - C_0)}
   = |\hat p_0 - m| / \sqrt{\sigma_0^2 + \sigma_m^2} $$

is the distance of the estimate p_0 from the tests alone and the mean m of the prior in
standard deviations of both. The sigmas must not be those of the fit with the prior:
estimated from residuals that the prior causes, they are so wide that nothing
contradicts it.
"""

import numpy as np

from ...progress import within
from ..estimation.least_squares import Fits, fit
from ..estimation.search import fit_along
from ..estimation.sigma import settle
from ..problem.objective import Objective
from .uncertainty import USELESS_ERROR, estimate

LEAST = 3.0
"""Number of standard deviations from which prior and tests disagree; where sigmas are
estimated, from the 95 % quantile of Student's distribution if that is more."""


def disagreements(objective: Objective, best: Fits) -> dict[str, str]:
    """Find the priors of the soil's parameters that the tests contradict, by name: the
    distance of both at the reported fit (one lane) in words, with what the tests give
    without the prior."""
    found = {}
    for place, parameter in enumerate(objective.study.parameters):
        if parameter.prior is None:
            continue
        with within(f"without the prior of {parameter.name}, "):
            words = _disagreement(objective, best, place)
        if words:
            found[parameter.name] = words
    return found


def _disagreement(objective: Objective, best: Fits, place: int) -> str:
    """Say how a prior and the tests disagree; empty where they do not."""
    x = best.points.x[0]
    free = objective.without_prior(place)
    free, alone = settle(free, fit_along(free, x))
    of_tests = estimate(free, alone.points)
    sigma = free.sigma * np.sqrt(of_tests.inflation)
    inflated = fit_along(free.with_sigma(sigma), alone.points.x[0])
    ends = fit(objective.with_sigma(sigma), np.stack([x, inflated.points.x[0]]))
    rise = np.min(ends.points.cost) - inflated.points.cost[0]
    deviations = float(np.sqrt(max(2.0 * rise, 0.0)))
    if deviations < max(LEAST, of_tests.quantile[place]):
        return ""
    there, bounds = alone.points.x[0], objective.bounds
    given = f"{bounds.parameter(there)[place]:.3g}"
    error = of_tests.standard_errors[place]
    if error <= USELESS_ERROR:
        given += f" +- {error * bounds.slope(there)[place]:.2g}"
    mean, sd = objective.prior_mean[place], objective.prior_sd[place]
    return (
        f"its prior, {mean:g} +- {sd:g}, and the tests disagree by {deviations:.2g} "
        f"standard deviations: without the prior they give {given}"
    )

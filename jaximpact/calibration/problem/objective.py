r"""The objective function: the negative logarithm of likelihood and priors.

$$ C(x) = \sum_i w_i \rho(u_i) + \tfrac12 \sum_k \left( \frac{p_k - m_k}{s_k}
   \right)^2, \qquad u_i = \frac{y_i(x) - \hat y_i}{\sigma_i}, $$

with rho the loss (`noise`), w the weight of the target, m and s mean and standard
deviation of a prior. The unknowns x are the coordinates (`bounds`) of the soil's
parameters, then of the nuisances, group by group. Many x are evaluated at once; each is
a lane.
"""

import copy
import dataclasses
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from ..._jax_internals import namespace_of
from ...accuracy import PRESETS, Accuracy
from ...progress import tell
from .config import Study, Variant
from .forward_model import XLA, ForwardModel, bounds_of
from .noise import Losses, losses

FAILED_COST = 5e5
"""Loss, with derivative zero, of a result that could not be computed: large, so that a
fit keeps away, and finite, so that it does not spoil the sum."""
TINY = 1e-100
"""Residuals below, of limits that are kept by far, have no ratio to their slope."""
STEEP = 1e8
"""Derivatives of residuals above, as just before a jump, are set to 0 for fits: a step
that follows them is rounding."""
AT_ONCE = 50_000
"""Impacts between two lines of progress: bounds time and memory."""


class Points(NamedTuple):
    """Objective function at points x, shape (lanes, unknowns)."""

    x: np.ndarray
    cost: np.ndarray
    """Objective function, shape (lanes,)."""
    gradient: np.ndarray
    """Gradient with respect to x, shape (lanes, unknowns)."""
    hessian: np.ndarray
    """Gauss-Newton Hessian, never negative, shape (lanes, unknowns, unknowns)."""
    predicted: np.ndarray
    """Predictions, shape (lanes, tests, targets); NaN where there is none."""
    outcomes: np.ndarray
    """Codes of the outcomes, shape (lanes, tests)."""
    jacobian: np.ndarray
    """Derivatives of the predictions with respect to x, shape (lanes, tests, targets,
    unknowns); 0 where there is no prediction or none was wanted."""

    def take(self, chosen) -> "Points":
        """Select some of the lanes."""
        return Points(*(part[chosen] for part in self))

    def put(self, chosen, points: "Points") -> "Points":
        """Replace some of the lanes."""
        replaced = []
        for old, new in zip(self, points, strict=True):
            old = old.copy()
            old[chosen] = new
            replaced.append(old)
        return Points(*replaced)


class Objective:
    """Objective function of one variant of a study.

    Args:
        study, variant: the study and one of its variants.
        model: predicts the tests, see `models_of`.
        accuracy: accuracy of the impacts, in place of the study's.
    """

    def __init__(
        self,
        study: Study,
        variant: Variant,
        model: ForwardModel,
        accuracy: Accuracy | None = None,
    ):
        self.study, self.model = study, model
        self.accuracy = accuracy or PRESETS[study.accuracy]
        self.bounds, self.scene = bounds_of(study), study.scene_of(variant)
        self.sigma, self.loss = study.sigma, study.loss
        self.prior_mean, self.prior_sd = _priors(study)

    def at(self, accuracy: Accuracy) -> "Objective":
        """Return the objective with impacts of another accuracy."""
        return self._changed(accuracy=accuracy)

    def rough(self) -> "Objective":
        """Return the objective with impacts just accurate enough to rank costs."""
        fast = PRESETS["fast"]
        # XLA takes longer to compile for another accuracy than it would save.
        if self.model.engine == XLA or self.accuracy.tolerance >= fast.tolerance:
            return self
        return self.at(fast)

    def no_finer_than_sigmas(self) -> "Objective":
        """Return the objective with impacts at "balanced", if that is coarser and its
        errors are small beside every sigma."""
        study, balanced = self.study, PRESETS["balanced"]
        known = study.known
        # Of wider sigmas the errors at "balanced", 1e-6 of most values and 5e-4 of
        # their derivatives, change a fit by less than 0.01 standard errors. Single
        # values are off by more: e_t within 0.1 degrees of the normal by a hundredth.
        close = np.any(self.sigma[known] < 1e-3 * np.abs(study.measured[known]))
        if close or self.accuracy.tolerance >= balanced.tolerance:
            return self
        return self.at(balanced)

    def with_sigma(self, sigma: np.ndarray) -> "Objective":
        """Return the objective with other sigmas, shape (tests, targets)."""
        return self._changed(sigma=sigma)

    def with_proportional_scatter(self, targets: np.ndarray) -> "Objective":
        """Return the objective with scatter of more targets, a mask, in proportion to
        their values."""
        proportional = self.study.proportional | targets
        study = dataclasses.replace(self.study, proportional=proportional)
        return self._changed(study=study)

    def with_sigma_factors(self, targets: np.ndarray) -> "Objective":
        """Return the objective with a factor, to be estimated, on the given sigmas of
        targets, a mask."""
        study = self.study
        names = tuple(n for n, one in zip(study.targets, targets, strict=True) if one)
        given = study.sigma_given & ~targets
        study = dataclasses.replace(study, sigma_given=given, understated=names)
        return self._changed(study=study)

    def with_loss(self, loss: str) -> "Objective":
        """Return the objective with another loss, one of `LOSSES`."""
        return self._changed(loss=loss)

    def without_prior(self, place: int) -> "Objective":
        """Return the objective without the prior of an unknown, by its index."""
        others = np.arange(len(self.prior_sd)) != place
        return self._changed(prior_sd=np.where(others, self.prior_sd, np.inf))

    def without(self, tests: np.ndarray) -> "Objective":
        """Return the objective without the measurements of some tests, which are still
        predicted.

        Args:
            tests: mask of the tests left out, shape (tests,), or of single
                measurements, shape (tests, targets).
        """
        cells = tests if tests.ndim == 2 else tests[:, None]
        left = np.where(cells, np.nan, self.study.measured)
        return self._changed(study=dataclasses.replace(self.study, measured=left))

    def of_tests(self, tests: np.ndarray) -> "Objective":
        """Return the objective of some tests alone, to be fitted.

        Its study holds the numbers of these tests, but still names all.
        """
        study = self.study
        nuisances = (
            dataclasses.replace(n, group=n.group[tests], base=n.base[tests])
            for n in study.nuisances
        )
        part = dataclasses.replace(
            study,
            measured=study.measured[tests],
            censored=study.censored[tests],
            sigma=study.sigma[tests],
            nuisances=tuple(nuisances),
        )
        model = self.model.of_tests(tests)
        return self._changed(study=part, sigma=self.sigma[tests], model=model)

    def of_measured(self) -> "Objective":
        """Return the objective of the tests with a measurement alone: of equal values,
        and without impacts that change none."""
        measured = np.any(self.study.known, axis=1)
        return self if np.all(measured) else self.of_tests(np.flatnonzero(measured))

    def _changed(self, **changed) -> "Objective":
        other = copy.copy(self)
        vars(other).update(changed)
        return other

    def __call__(self, x: np.ndarray) -> Points:
        """Evaluate the objective with its derivatives at points within the bounds,
        shape (lanes, unknowns)."""
        x = np.asarray(x, float)
        return self.evaluate(x, *self._predict(x, True))

    def values(self, x: np.ndarray) -> Points:
        """Evaluate the objective in a quarter of the time, without the derivatives of
        predictions, which are 0; those of the priors stay."""
        x, at_once = np.asarray(x, float), max(1, AT_ONCE // len(self.study.measured))
        parts = []
        for first in range(0, max(len(x), 1), at_once):
            if len(x) > at_once:
                tell(f"{first} of {len(x)} draws")
            part = x[first : first + at_once]
            parts.append(self.evaluate(part, *self._predict(part, False)))
        if len(parts) == 1:
            return parts[0]
        whole: dict[str, np.ndarray] = {
            name: np.concatenate([getattr(part, name) for part in parts])
            for name in Points._fields[:-1]
        }
        # The zeros of many draws would fill the memory.
        shape = *whole["predicted"].shape, x.shape[1]
        return Points(**whole, jacobian=np.broadcast_to(0.0, shape))

    def _predict(self, x: np.ndarray, derivatives: bool) -> tuple:
        """Compute predictions, outcomes and the Jacobian of `Points`, if wanted."""
        p, model = self.bounds.parameter(x), self.model
        predicted, outcomes, slopes = model.evaluate(
            p, self.accuracy, derivatives=derivatives
        )
        if slopes is None:
            return predicted, outcomes, None
        # Squares of steeper ones, as where an outcome changes, could overflow.
        finite = np.isfinite(predicted)[..., None] & (np.abs(slopes) < 1e100)
        slopes, by_x = np.where(finite, slopes, 0.0), self.bounds.slope(x)
        jacobian = np.zeros((*predicted.shape, x.shape[1]))
        lanes, tests = np.ogrid[: len(x), : predicted.shape[1]]
        # Each test depends on one unknown of each column.
        for column, unknown in enumerate(model.unknown[model.impact].T):
            of_column = slopes[..., column] * by_x[:, unknown, None]
            jacobian[lanes, tests, :, unknown] = of_column
        return predicted, outcomes, jacobian

    def cost(self, x: Array) -> Array:
        """Compute the objective function at one x, shape (unknowns,), as a function of
        JAX."""
        p = self.bounds.parameter(x)
        predicted = self.model.predict(jnp.asarray(p), self.accuracy)
        return self._cost(p, predicted, self._losses(predicted).value)

    def _losses(self, predicted) -> Losses:
        """Compute the losses of predictions, of NumPy or JAX, shape (..., tests,
        targets); of 0 where one is missing or nothing is measured."""
        xp, study = namespace_of(predicted), self.study
        used = xp.isfinite(predicted) & study.known
        # Derivatives by JAX must not meet NaN.
        measured = np.where(study.known, study.measured, 0.0)
        apart = xp.where(used, predicted, measured) - measured
        censored = np.broadcast_to(study.censored, predicted.shape)
        return losses(apart / self.sigma, censored, self.loss)

    def _cost(self, p, predicted, loss):
        """Sum losses and priors at parameters p, shape (..., unknowns)."""
        xp = namespace_of(predicted)
        loss = xp.where(xp.isfinite(predicted), loss, FAILED_COST)
        weights = np.where(self.study.known, self.study.weights, 0.0)
        return xp.sum(loss * weights, axis=(-2, -1)) + self._prior_cost(p)

    def _prior_cost(self, p):
        """Compute the part of the priors at parameters p, shape (..., unknowns)."""
        apart = (p - self.prior_mean) / self.prior_sd
        return 0.5 * namespace_of(p).sum(apart**2, axis=-1)

    def inflated(self, x, cost, inflation: float) -> Any:
        """Divide costs at x, shape (..., unknowns), by the inflation s^2, of NumPy or
        JAX: all but the part of the priors, which residuals say nothing about."""
        of_priors = self._prior_cost(self.bounds.parameter(x))
        return (cost - of_priors) / inflation + of_priors

    def log_density(self, x, cost, inflation: float) -> Any:
        """Compute the logarithm of the posterior density of x, shape (..., unknowns),
        from costs, of NumPy or JAX, up to a constant: uniform in x without a prior,
        while a prior is a density of p, which dp/dx turns into one of x."""
        with_prior = self.bounds.logarithmic & np.isfinite(self.prior_sd)
        slope = namespace_of(x).sum(x * with_prior, axis=-1)
        return slope - self.inflated(x, cost, inflation)

    def evaluate(self, x, predicted, outcomes, jacobian=None) -> Points:
        """Evaluate the objective of given predictions and of their Jacobian, if there
        is one. Predictions that are missing cost `FAILED_COST` each."""
        of, p = self._losses(predicted), self.bounds.parameter(x)
        cost = self._cost(p, predicted, of.value)
        by_x = self.bounds.slope(x) / self.prior_sd
        gradient = (p - self.prior_mean) / self.prior_sd * by_x
        hessian = by_x[..., None] ** 2 * np.eye(x.shape[1])
        if jacobian is None:
            zeros = np.broadcast_to(0.0, (*predicted.shape, x.shape[1]))
            return Points(x, cost, gradient, hessian, predicted, outcomes, zeros)
        used = np.isfinite(predicted) & self.study.known
        weights = np.where(used, self.study.weights, 0.0)
        rows = jacobian / self.sigma[..., None]
        slope, curvature = weights * of.slope, weights * of.curvature
        gradient += np.einsum("lrt,lrtp->lp", slope, rows)
        hessian += np.einsum("lrtp,lrtq->lpq", rows * curvature[..., None], rows)
        return Points(x, cost, gradient, hessian, predicted, outcomes, jacobian)

    def residuals(self, points: Points) -> tuple[np.ndarray, np.ndarray]:
        r"""Compute residuals r of points of one lane, and their derivatives.

        Half the sum of their squares is the cost: of a measurement
        r = sign(u) sqrt(2 w rho), so that losses and limits are least squares too.
        """
        predicted, x = points.predicted[0], points.x[0]
        computed, known = np.isfinite(predicted), self.study.known
        of = self._losses(predicted)
        weights = np.where(known, self.study.weights, 0.0)
        size = np.sqrt(2.0 * weights * np.where(computed, of.value, FAILED_COST))
        sign = np.where(of.slope < 0.0, -1.0, 1.0)
        # At u = 0 both vanish; their ratio is the root of the curvature.
        there = size > TINY
        ratio = np.where(
            there,
            weights * np.abs(of.slope) / np.where(there, size, 1.0),
            np.sqrt(weights * of.curvature),
        )
        ratio = np.where(computed & known, ratio, 0.0)
        jacobian = points.jacobian[0] * (ratio / self.sigma)[..., None]
        jacobian = np.where(np.abs(jacobian) > STEEP, 0.0, jacobian)
        bounds = self.bounds
        priors = (bounds.parameter(x) - self.prior_mean) / self.prior_sd
        return (
            np.concatenate([(sign * size).ravel(), priors]),
            np.concatenate(
                [
                    jacobian.reshape(-1, len(x)),
                    np.diag(bounds.slope(x) / self.prior_sd),
                ]
            ),
        )

    def reevaluate(self, points: Points) -> Points:
        """Evaluate points again whose predictions were weighted with other sigmas."""
        return self.evaluate(
            points.x, points.predicted, points.outcomes, points.jacobian
        )

    def failed(self, predicted: np.ndarray) -> np.ndarray:
        """Find the measurements without a prediction."""
        return self.study.known & ~np.isfinite(predicted)

    def variance(self, cost) -> np.ndarray:
        """Compute s^2, twice the cost over the degrees of freedom."""
        freedom = np.sum(self.study.exact) - len(self.study.parameters)
        return 2.0 * np.asarray(cost) / max(int(freedom), 1)

    def unit(self, cost) -> np.ndarray:
        """Compute max(1, s^2), the unit for differences of costs."""
        return np.maximum(1.0, self.variance(cost))

    def prior_information(self, x: np.ndarray) -> np.ndarray:
        """Compute the information of the priors on each unknown at one x."""
        return (self.bounds.slope(x) / self.prior_sd) ** 2

    @property
    def bounds_information(self) -> np.ndarray:
        """Information of uniform distributions between the bounds, 12 / range^2; 0 for
        an unknown with a prior."""
        width = self.bounds.high - self.bounds.low
        return np.where(np.isinf(self.prior_sd), 12.0 / width**2, 0.0)


def _priors(study: Study) -> tuple[np.ndarray, np.ndarray]:
    """Collect means and standard deviations of the priors; infinite where none."""
    mean = [p.prior.mean if p.prior else 0.0 for p in study.parameters]
    sd = [p.prior.sd if p.prior else np.inf for p in study.parameters]
    for nuisance in study.nuisances:
        mean += [nuisance.prior.mean] * len(nuisance.groups)
        sd += [nuisance.prior.sd] * len(nuisance.groups)
    return np.array(mean), np.array(sd)


def start_of(study: Study) -> np.ndarray:
    """Return the starting point x of a study."""
    means = [[n.prior.mean] * len(n.groups) for n in study.nuisances]
    start = np.concatenate([[p.start for p in study.parameters], *means])
    return bounds_of(study).coordinate(start)


def names_of(study: Study) -> list[str]:
    """List the names of the unknowns."""
    names = [parameter.name for parameter in study.parameters]
    for nuisance in study.nuisances:
        names += [nuisance.label(place) for place in range(len(nuisance.groups))]
    return names

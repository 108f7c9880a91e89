r"""The noise model: how measurements scatter, and what a residual costs.

With u = (predicted - measured) / sigma, a measurement of Gaussian scatter costs
s / 2 = u^2 / 2. A censored one, of which only a limit is known, costs what a Tobit
model says, with Phi the normal distribution:

$$ s / 2 = -\ln \Phi(u) \ \text{for ">"}, \quad
   s / 2 = -\ln \Phi(-u) \ \text{for "<"}. $$

A robust loss costs less than s / 2 where s is large, so that an outlier does not rule
the fit:

$$ \sqrt{1 + s} - 1 \ \text{(soft-L1)}, \qquad
   \tfrac{\nu + 1}{2} \ln(1 + s / \nu) \ \text{(Student)}. $$

A sigma that nobody stated is one number for all tests of a target, or in proportion to
the size of the value,

$$ \sigma_i = r \max(|y_i|, y_0), $$

with y the value of the model and r estimated (`estimation.sigma`). y_0 is a fraction of
the root mean square of the measurements: a value that passes through zero would
otherwise have next to no sigma, and its test would rule the fit, however little the
model is off there.
"""

from typing import Any, NamedTuple

import jax
import numpy as np
import scipy.special

from ..._jax_internals import namespace_of

CONSTANT, PROPORTIONAL = SCATTERS = ("constant", "proportional")
LEAST_SIZE = 0.02
"""y_0 over the root mean square of a target: values that differ by a factor of fifty
still count by their relative errors."""
LOSSES = ("gaussian", "soft-l1", "student")
FREEDOM = 4.0
"""nu of the Student loss: heavy tails, and still a variance."""
LOG_ROOT_TWO_PI = 0.5 * np.log(2.0 * np.pi)
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(80)
WEIGHTS = WEIGHTS / np.sum(WEIGHTS)


class Losses(NamedTuple):
    """Losses of residuals and their derivatives with respect to u, arrays of one
    shape."""

    value: Any
    slope: Any
    curvature: Any
    """Positive; of a robust loss, the curvature of the parabola that touches it from
    above."""


def losses(u: Any, censored: np.ndarray, kind: str = LOSSES[0]) -> Losses:
    """Compute losses of residuals.

    Args:
        u: standardised residuals, of NumPy or JAX.
        censored: 1 where the true value is above the one stated, -1 where it is below,
            0 where it is measured.
        kind: one of `LOSSES`.
    """
    xp = namespace_of(u)
    special = scipy.special if xp is np else jax.scipy.special
    sign = np.where(censored == 0, 1.0, censored)
    towards = sign * u
    log_phi = special.log_ndtr(towards)
    ratio = xp.exp(-0.5 * towards**2 - LOG_ROOT_TWO_PI - log_phi)
    value = xp.where(censored == 0, 0.5 * u**2, -log_phi)
    slope = xp.where(censored == 0, u, -sign * ratio)
    # Rounding can make it negative far inside the limit, where it vanishes.
    bent = xp.maximum(ratio * (ratio + towards), 0.0)
    curvature = xp.where(censored == 0, 1.0, bent)
    outer, outer_slope = _robust(2.0 * value, kind)
    return Losses(outer, 2.0 * outer_slope * slope, 2.0 * outer_slope * curvature)


def _robust(s, kind: str) -> tuple:
    """Compute a loss as a function of s, and its derivative."""
    xp = namespace_of(s)
    if kind == "soft-l1":
        root = xp.sqrt(1.0 + s)
        return root - 1.0, 0.5 / root
    if kind == "student":
        return (
            0.5 * (FREEDOM + 1.0) * xp.log1p(s / FREEDOM),
            0.5 * (FREEDOM + 1.0) / (FREEDOM + s),
        )
    return 0.5 * s, xp.full_like(s, 0.5)


def scale_of_normal(kind: str) -> float:
    """Compute the mean of u times the slope under Gaussian scatter of sigma 1.

    An estimate of sigma is normalised by it, so that it is that of Gaussian scatter for
    every loss.
    """
    of_nodes = losses(NODES, np.zeros(len(NODES), int), kind)
    return float(np.sum(WEIGHTS * NODES * of_nodes.slope))


def true_curvature(u: np.ndarray, kind: str) -> np.ndarray:
    """Compute the second derivative of the loss of measured values; may be negative."""
    s = u**2
    if kind == "soft-l1":
        return (1.0 + s) ** -1.5
    if kind == "student":
        return (FREEDOM + 1.0) * (FREEDOM - s) / (FREEDOM + s) ** 2
    return np.ones_like(u)


def root_mean_square(measured: np.ndarray, censored: np.ndarray) -> np.ndarray:
    """Compute the root mean square of each column, of its limits where it has no exact
    measurement; 1 where all is 0, since a scale must be positive."""
    known = np.isfinite(measured)
    exact = known & (censored == 0)
    used = np.where(np.any(exact, axis=0), exact, known)
    squares = np.sum(np.where(used, measured, 0.0) ** 2, axis=0)
    scale = np.sqrt(squares / np.maximum(np.sum(used, axis=0), 1))
    return np.where(scale > 0.0, scale, 1.0)


def least_size(measured: np.ndarray, censored: np.ndarray) -> np.ndarray:
    """Compute y_0 of each column."""
    return LEAST_SIZE * root_mean_square(measured, censored)


class ProportionalScatter(NamedTuple):
    """Scatter of one target in proportion to its value."""

    fraction: float
    """r [-]."""
    least_size: float
    """y_0 [unit of the target]."""

    def sigma(self, values: np.ndarray) -> np.ndarray:
        """Compute the standard deviation of measurements about these values."""
        return self.fraction * np.maximum(np.abs(values), self.least_size)

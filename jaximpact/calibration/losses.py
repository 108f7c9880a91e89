r"""What a difference between prediction and measurement costs.

With u = (predicted - measured) / sigma, a measurement of Gaussian scatter costs
s / 2 = u^2 / 2. One of which only a limit is known costs what a Tobit model says, with
Phi the normal distribution:

$$ s / 2 = -\ln \Phi(u) \ \text{for ">"}, \quad
   s / 2 = -\ln \Phi(-u) \ \text{for "<"}. $$

A robust loss takes less than s / 2 where s is large, so that an outlier does not rule
the fit:

$$ \sqrt{1 + s} - 1 \ \text{(soft-L1)}, \qquad
   \tfrac{\nu + 1}{2} \ln(1 + s / \nu) \ \text{(Student)}. $$
"""

from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr

LOSSES = ("gaussian", "soft-l1", "student")
FREEDOM = 4.0
"""nu of the Student loss: heavy tails, and still a variance."""
LOG_ROOT_TWO_PI = 0.5 * np.log(2.0 * np.pi)
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(80)
WEIGHTS = WEIGHTS / np.sum(WEIGHTS)


class Losses(NamedTuple):
    """Of residuals, all of one shape; the derivatives are by u."""

    value: np.ndarray
    slope: np.ndarray
    curvature: np.ndarray
    """Positive; for a robust loss that of the parabola which touches it from above."""


def losses(u: np.ndarray, censored: np.ndarray, kind: str = LOSSES[0]) -> Losses:
    """Losses of residuals.

    Args:
        u: standardised residuals.
        censored: 1 where the true value is above the one stated, -1 where it is below,
            0 where it is measured.
        kind: one of `LOSSES`.
    """
    sign = np.where(censored == 0, 1.0, censored)
    towards = sign * u
    log_phi = log_ndtr(towards)
    ratio = np.exp(-0.5 * towards**2 - LOG_ROOT_TWO_PI - log_phi)
    value = np.where(censored == 0, 0.5 * u**2, -log_phi)
    slope = np.where(censored == 0, u, -sign * ratio)
    # Rounding: far inside the limit the curvature is nothing.
    bent = np.maximum(ratio * (ratio + towards), 0.0)
    curvature = np.where(censored == 0, 1.0, bent)
    outer, outer_slope = _robust(2.0 * value, kind)
    return Losses(outer, 2.0 * outer_slope * slope, 2.0 * outer_slope * curvature)


def _robust(s: np.ndarray, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """The loss as a function of s, and its derivative."""
    if kind == "soft-l1":
        root = np.sqrt(1.0 + s)
        return root - 1.0, 0.5 / root
    if kind == "student":
        return (
            0.5 * (FREEDOM + 1.0) * np.log1p(s / FREEDOM),
            0.5 * (FREEDOM + 1.0) / (FREEDOM + s),
        )
    return 0.5 * s, np.full_like(s, 0.5)


def scale_of_normal(kind: str) -> float:
    """Mean of u times the slope under Gaussian scatter of sigma 1: what an estimate of
    sigma is set against, so that it is that of Gaussian scatter for every loss."""
    found = losses(NODES, np.zeros(len(NODES), int), kind)
    return float(np.sum(WEIGHTS * NODES * found.slope))


def true_curvature(u: np.ndarray, kind: str) -> np.ndarray:
    """Second derivative of the loss of measured values, which may be negative."""
    s = u**2
    if kind == "soft-l1":
        return (1.0 + s) ** -1.5
    if kind == "student":
        return (FREEDOM + 1.0) * (FREEDOM - s) / (FREEDOM + s) ** 2
    return np.ones_like(u)

r"""Scatter that is the same part of a target's value in all tests.

A sigma that nobody gave is one number for a target, or in proportion to its size,

$$ \sigma_i = r \max(|y_i|, y_0), $$

y what the model gives and r estimated. y_0 is a part of the root mean square of what
was measured: a value that passes zero would otherwise have next to no sigma, and its
test would rule the fit, however little the model is off there.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .study_file import Study

CONSTANT, PROPORTIONAL = SCATTERS = ("constant", "proportional")
LEAST_SIZE = 0.02
"""Part of a target's root mean square below which its sigma shrinks no more: values
that differ by a factor of fifty still count by their per cents."""


def root_mean_square(measured: np.ndarray) -> np.ndarray:
    """Of each column, NaN left out; 1 where all is 0, for a scale must be some."""
    scale = np.sqrt(np.nanmean(measured**2, axis=0))
    return np.where(scale > 0.0, scale, 1.0)


def least_size(measured: np.ndarray) -> np.ndarray:
    """y_0 of each column."""
    return LEAST_SIZE * root_mean_square(measured)


def sizes(study: "Study", values: np.ndarray) -> np.ndarray:
    """What sigmas are in proportion to, `(tests, targets)`; 1 where they are constant.

    Args:
        values: of the targets, likewise. Where one is NaN the measured value stands for
            it, and y_0 where there is none either.
    """
    values = np.where(np.isfinite(values), values, study.measured)
    values = np.where(np.isfinite(values), np.abs(values), 0.0)
    floored = np.maximum(values, least_size(study.measured))
    return np.where(study.proportional, floored, 1.0)


def part_of_size(
    study: "Study", sigma: np.ndarray, predicted: np.ndarray
) -> np.ndarray:
    """r of each target that sigmas have at a fit, `(targets,)`; NaN where they are
    constant.

    Args:
        sigma, predicted: `(tests, targets)`. Sigmas that are not of this fit, nominal
            ones or those of a step before, have no one r: it is the median's.
    """
    ratio = np.where(study.known, sigma / sizes(study, predicted), np.nan)
    return np.where(study.proportional, np.nanmedian(ratio, axis=0), np.nan)


def resized(study: "Study", sigma: np.ndarray, predicted: np.ndarray) -> np.ndarray:
    """Sigmas with the same r, in proportion to other values, `(tests, targets)`."""
    r = part_of_size(study, sigma, predicted)
    return np.where(study.proportional, r * sizes(study, predicted), sigma)


class PartOfSize(NamedTuple):
    """Scatter of one target."""

    part: float
    """r"""
    least_size: float
    """y_0"""

    def sigma(self, values: np.ndarray) -> np.ndarray:
        """Of measurements about these values."""
        return self.part * np.maximum(np.abs(values), self.least_size)

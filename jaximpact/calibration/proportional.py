r"""Scatter that is the same part of a target's value in all tests.

A sigma that nobody gave is one number for a target, or in proportion to its size,

$$ \sigma_i = r \max(|y_i|, y_0), $$

y what the model gives and r estimated. y_0 is a part of the root mean square of what
was measured: a value that passes zero would otherwise have next to no sigma, and its
test would rule the fit, however little the model is off there.
"""

from typing import NamedTuple

import numpy as np

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


class PartOfSize(NamedTuple):
    """Scatter of one target."""

    part: float
    """r"""
    least_size: float
    """y_0"""

    def sigma(self, values: np.ndarray) -> np.ndarray:
        """Of measurements about these values."""
        return self.part * np.maximum(np.abs(values), self.least_size)

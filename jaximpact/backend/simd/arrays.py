"""Arrays of values of a graph, and with them their derivatives."""

from typing import NamedTuple

import numpy as np

Values = np.ndarray
"""Array of values (`graph.Value`)."""


def values_of(array) -> Values:
    """List values of a known array."""
    array = np.asarray(array)
    values = np.empty(array.shape, object)
    for place in np.ndindex(array.shape):
        values[place] = array[place].item()
    return values


class Dual(NamedTuple):
    """An array, and its tangent: the derivative along a direction; None where that is
    zero by structure."""

    values: Values
    tangent: Values | None = None

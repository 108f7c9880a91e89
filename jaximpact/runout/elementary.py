"""Elementary functions of arrays, with the same digits on every processor.

NumPy takes these functions from another library where a processor has AVX-512, and
their last digits differ. Blocks that tumble make another place to stop of one last
digit. So where numbers decide how a block moves, each is computed by the C library,
which has one way for all processors: a run-out can be repeated on another machine with
the same system. It takes 0.1 to 0.2 microseconds a number.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike


def _of_arrays(function: Callable[..., float], numpys: np.ufunc) -> Callable:
    def of_arrays(*values: ArrayLike) -> np.ndarray:
        arrays = np.broadcast_arrays(*(np.asarray(value, float) for value in values))
        columns = [array.ravel().tolist() for array in arrays]
        shape, size = arrays[0].shape, arrays[0].size
        try:
            return np.fromiter(map(function, *columns), float, size).reshape(shape)
        except (ValueError, OverflowError):
            # Infinite or NaN somewhere, as NumPy has it.
            return numpys(*arrays)

    of_arrays.__doc__ = f"Compute `math.{function.__name__}` of each number."
    return of_arrays


exp = _of_arrays(math.exp, np.exp)
expm1 = _of_arrays(math.expm1, np.expm1)
log1p = _of_arrays(math.log1p, np.log1p)
sin = _of_arrays(math.sin, np.sin)
cos = _of_arrays(math.cos, np.cos)
arctan2 = _of_arrays(math.atan2, np.arctan2)

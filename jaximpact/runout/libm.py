"""Functions of the C library, libm, of arrays: the same digits on every processor.

NumPy takes these functions from another library where a processor has AVX-512, and the
last digits differ. One last digit is enough for a block that tumbles to stop elsewhere.
So all that decides where a block starts and how it moves is computed by libm, which
does not depend on AVX-512. Another libm, such as that of another system, may give other
digits. A number takes 0.1 to 0.2 microseconds.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike


def _of_arrays(function: Callable[..., float], of_numpy: np.ufunc) -> Callable:
    def of_arrays(*values: ArrayLike) -> np.ndarray:
        arrays = np.broadcast_arrays(*(np.asarray(value, float) for value in values))
        columns = [array.ravel().tolist() for array in arrays]
        shape, size = arrays[0].shape, arrays[0].size
        try:
            return np.fromiter(map(function, *columns), float, size).reshape(shape)
        except (ValueError, OverflowError):
            # `math` raises where NumPy gives inf or NaN. Such numbers are refused
            # later, so that the digits of the others do not count.
            return of_numpy(*arrays)

    of_arrays.__doc__ = f"Compute `math.{function.__name__}` of each number."
    return of_arrays


exp = _of_arrays(math.exp, np.exp)
log1p = _of_arrays(math.log1p, np.log1p)
sin = _of_arrays(math.sin, np.sin)
cos = _of_arrays(math.cos, np.cos)
arctan2 = _of_arrays(math.atan2, np.arctan2)

r"""Dual numbers: arrays with their derivatives with respect to some parameters.

Whatever is computed from them carries derivatives too, by the chain rule,

$$ \dot f = \sum_i \frac{\partial f}{\partial a_i} \dot a_i , $$

so that code written for NumPy arrays gives derivatives along the branches that it
takes. A NumPy function without a rule here raises an error: no derivative gets lost.
"""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import jax
import numpy as np
from numpy.typing import ArrayLike


class Dual(np.lib.mixins.NDArrayOperatorsMixin):
    """Array with its derivatives.

    Args:
        value: the array, of any shape.
        tangent: derivatives, shape `(parameters, *value.shape)`.

    Comparisons, signs and roundings use the value and give plain arrays.
    """

    def __init__(self, value: ArrayLike, tangent: ArrayLike):
        self.value = np.asarray(value, float)
        self.tangent = np.asarray(tangent, float)

    @property
    def shape(self) -> tuple[int, ...]:
        return self.value.shape

    @property
    def ndim(self) -> int:
        return self.value.ndim

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self):
        return (self[i] for i in range(len(self)))

    def __getitem__(self, index) -> "Dual":
        return Dual(self.value[index], self.tangent[_tangent_index(index)])

    def __setitem__(self, index, new) -> None:
        new = np.stack(new) if isinstance(new, tuple) else new
        tangent = tangent_of(new, len(self.tangent))
        extra = self.value[index].ndim + 1 - tangent.ndim
        self.value[index] = primal(new)
        self.tangent[_tangent_index(index)] = _insert_axes(tangent, extra)

    def copy(self) -> "Dual":
        return Dual(self.value.copy(), self.tangent.copy())

    def __array__(self, *_, **__) -> np.ndarray:
        raise TypeError("the derivatives of these numbers would be lost")

    def __array_ufunc__(self, function, method, *inputs, **options):
        places = options.pop("out", ())
        if method != "__call__" or options:
            return NotImplemented
        values = [primal(x) for x in inputs]
        if function in _OF_VALUES:
            return function(*values)
        if function not in _SLOPES:
            return NotImplemented
        value = function(*values)
        # Some lanes may have infinite slopes that a later `where` leaves out.
        with np.errstate(divide="ignore", invalid="ignore"):
            slopes = _SLOPES[function](value, *values)
            parts = [
                _times(slope, _insert_axes(x.tangent, value.ndim - x.ndim))
                for slope, x in zip(slopes, inputs, strict=True)
                if isinstance(x, Dual)
            ]
        total = sum(parts[1:], parts[0])
        result = Dual(value, np.broadcast_to(total, (len(total), *value.shape)))
        for place in places:
            place[...] = result
        return places[0] if places else result

    def __array_function__(self, function, types, arguments, options):
        if function not in _FUNCTIONS:
            return NotImplemented
        return _FUNCTIONS[function](*arguments, **options)


if TYPE_CHECKING:
    # The same formulas run on all three; no union of them says so.
    Values = Any
else:
    Values = jax.Array | np.ndarray | Dual
"""Numbers of many blocks, `(lanes,)`: NumPy arrays between programs, JAX scalars inside
them, `Dual` where derivatives are carried."""


def primal(tree: Any) -> Any:
    """Drop the derivatives of all arrays in a tree."""
    return jax.tree.map(
        lambda leaf: leaf.value if isinstance(leaf, Dual) else leaf, tree
    )


def tangent_count(tree: Any) -> int:
    """Count the parameters whose derivatives a tree carries; 0 for plain arrays."""
    duals = (leaf for leaf in jax.tree.leaves(tree) if isinstance(leaf, Dual))
    return max((len(leaf.tangent) for leaf in duals), default=0)


def tangent_of(value, parameters: int) -> np.ndarray:
    """Get derivatives, `(parameters, *shape)`; zeros for a plain array."""
    if isinstance(value, Dual):
        return value.tangent
    return np.zeros((parameters, *np.shape(value)))


def as_dual(value, parameters: int) -> Dual:
    """Copy an array as one with derivatives, zeros for a plain one."""
    if isinstance(value, Dual):
        return value.copy()
    return Dual(np.array(value, float), tangent_of(value, parameters))


def _tangent_index(index) -> tuple:
    return (slice(None), *index) if isinstance(index, tuple) else (slice(None), index)


def _insert_axes(tangent: np.ndarray, axes: int) -> np.ndarray:
    """Insert axes behind that of the parameters."""
    shape = (tangent.shape[0], *(1,) * max(axes, 0), *tangent.shape[1:])
    return tangent.reshape(shape)


def _times(slope, tangent: np.ndarray) -> np.ndarray:
    # 0 x inf is 0: an unchanged input changes nothing, however steep the function.
    return np.where(tangent == 0.0, 0.0, slope * tangent)


def _is_larger(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.where(first == second, 0.5, first > second)


_OF_VALUES = {
    *(np.greater, np.greater_equal, np.less, np.less_equal),
    *(np.equal, np.not_equal, np.isfinite, np.sign),
}
_SLOPES: dict[Callable, Callable] = {
    np.add: lambda f, a, b: (1.0, 1.0),
    np.subtract: lambda f, a, b: (1.0, -1.0),
    np.multiply: lambda f, a, b: (b, a),
    np.true_divide: lambda f, a, b: (1.0 / np.asarray(b), -f / b),
    np.negative: lambda f, a: (-1.0,),
    np.power: lambda f, a, n: (n * a ** (n - 1), np.nan),
    np.sqrt: lambda f, a: (0.5 / f,),
    np.sin: lambda f, a: (np.cos(a),),
    np.cos: lambda f, a: (-np.sin(a),),
    np.tan: lambda f, a: (1.0 + f**2,),
    np.arctan2: lambda f, a, b: (b / (a**2 + b**2), -a / (a**2 + b**2)),
    np.hypot: lambda f, a, b: (a / f, b / f),
    np.absolute: lambda f, a: (np.sign(a),),
    np.maximum: lambda f, a, b: (_is_larger(a, b), _is_larger(b, a)),
    np.minimum: lambda f, a, b: (_is_larger(b, a), _is_larger(a, b)),
}
"""Derivatives with respect to the arguments, from the value f and the arguments; none
with respect to an exponent."""


def _join(function: Callable, arrays: Iterable) -> Dual:
    """Apply `np.concatenate` or `np.stack`."""
    count = tangent_count(list(arrays))
    return Dual(
        function([primal(x) for x in arrays], 0),
        function([tangent_of(x, count) for x in arrays], 1),
    )


def _where(condition, first, second) -> Dual:
    value = np.where(condition, primal(first), primal(second))
    count = tangent_count([first, second])
    first, second = (
        _insert_axes(tangent_of(x, count), value.ndim - np.ndim(primal(x)))
        for x in (first, second)
    )
    return Dual(value, np.where(condition, first, second))


def _broadcast_to(x: Dual, shape: tuple[int, ...]) -> Dual:
    tangent = _insert_axes(x.tangent, len(shape) - x.ndim)
    return Dual(
        np.broadcast_to(x.value, shape),
        np.broadcast_to(tangent, (len(tangent), *shape)),
    )


def _broadcast_arrays(*arrays) -> list:
    shape = np.broadcast_shapes(*(np.shape(primal(x)) for x in arrays))
    return [np.broadcast_to(x, shape) for x in arrays]


def _interpolate(x: Dual, points: np.ndarray, heights: np.ndarray) -> Dual:
    """Apply `np.interp`; at a point the slope is that to its right."""
    slopes = np.concatenate([[0.0], np.diff(heights) / np.diff(points), [0.0]])
    slope = slopes[np.searchsorted(points, x.value, "right")]
    return Dual(np.interp(x.value, points, heights), slope * x.tangent)


_FUNCTIONS = {
    np.where: _where,
    np.clip: lambda x, least, most: np.minimum(np.maximum(x, least), most),
    np.concatenate: lambda arrays: _join(np.concatenate, arrays),
    np.append: lambda x, more: np.concatenate([x, np.atleast_1d(more)]),
    np.stack: lambda arrays: _join(np.stack, arrays),
    np.broadcast_arrays: _broadcast_arrays,
    np.broadcast_to: _broadcast_to,
    np.zeros_like: lambda x: as_dual(np.zeros(x.shape), len(x.tangent)),
    np.round: lambda x: np.round(x.value),
    np.interp: _interpolate,
    np.shape: lambda x: x.shape,
    np.size: lambda x: x.value.size,
}

"""Results whose numbers and derivatives are known, where JAX differentiates.

Outside of `jit` JAX differentiates operation by operation. Each result of an operation
takes it time, used or not: those of an impact together longer than the impact. So
impacts are computed without JAX there, and a result becomes an operation of JAX when it
is used.
"""

from collections.abc import Sequence
from typing import Any

import jax
import numpy as np
from jax.core import ShapedArray
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir
from jaxtyping import Array

from .._jax_internals import Tracer, change_of, late_tracers, namespace_of, of_changes
from .._precision import handed_over
from .._settings import own_settings


def results_of(
    varied: Sequence[Tracer], rows: np.ndarray, columns: Sequence[np.ndarray]
) -> list[Array]:
    """Return rows of numbers as results of the values that vary.

    Args:
        varied: values of one derivative outside of `jit`.
        columns: for each of them the derivatives of all rows with respect to it.
    """
    results = _Results(varied, rows, columns)
    return late_tracers(varied[0], results, len(rows), rows.shape[1:])


class _Results:
    """Results, each of which JAX is given as it is used."""

    def __init__(self, varied, rows, columns):
        self.varied, self.rows, self.columns = varied, rows, columns
        self.numbers: dict[int, Array] = {}
        self.changes: dict = {}

    def number(self, place: int) -> Array:
        if place not in self.numbers:
            with own_settings():
                self.numbers[place] = handed_over(self.rows[place])
        return self.numbers[place]

    def change(self, place: int):
        if place not in self.changes:
            column = _Column([column[place] for column in self.columns])
            steps = [change_of(value) for value in self.varied]
            with of_changes(self.varied[0]):
                self.changes[place] = _change.bind(*steps, column=column)
        return self.changes[place]


class _Column:
    """Derivatives of a result with respect to each value, as JAX has to take them: to
    be compared as an object."""

    def __init__(self, derivatives: list[np.ndarray]):
        self.derivatives = derivatives
        self.shape = derivatives[0].shape

    def change(self, *steps) -> Any:
        """Compute the change of the result with steps of the values."""
        products = zip(self.derivatives, steps, strict=True)
        return sum(derivative * step for derivative, step in products)


_change = Primitive("change_of_impact")
"""The change of a result with steps of the values, which is linear in them."""


@_change.def_impl
def _compute(*steps, column: _Column) -> Array:
    with own_settings():
        return handed_over(column.change(*map(np.asarray, steps)))


@_change.def_abstract_eval
def _type(*steps, column: _Column) -> ShapedArray:
    return ShapedArray(column.shape, np.dtype(float))


def _transposed(cotangent, *steps, column: _Column) -> list:
    """Return the cotangents of the steps from that of the result."""
    known = namespace_of(cotangent) is np
    with own_settings():
        cotangent = np.asarray(cotangent) if known else cotangent
        parts = [
            _onto(step.aval.shape, derivative * cotangent)
            for derivative, step in zip(column.derivatives, steps, strict=True)
        ]
        return [handed_over(part) for part in parts] if known else parts


def _onto(shape: tuple, array):
    """Add up an array over the axes along which a value of this shape was broadcast."""
    further = array.ndim - len(shape)
    axes = [*range(further)]
    axes += [further + k for k, size in enumerate(shape) if size == 1]
    return array.sum(axis=tuple(axes)).reshape(shape) if axes else array


def _batched(steps, axes, *, column: _Column):
    return jax.vmap(column.change, axes)(*steps), 0


ad.deflinear2(_change, _transposed)
batching.primitive_batchers[_change] = _batched
mlir.register_lowering(
    _change,
    mlir.lower_fun(
        lambda *steps, column: column.change(*steps), multiple_results=False
    ),
)

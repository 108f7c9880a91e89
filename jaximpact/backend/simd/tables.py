"""Tables in memory, from which lanes read what they need.

Inputs of a lane are its own copies. What all lanes look up, such as a tree over the
segments of a profile, stays where it is: a lane is given the table's address, as a
number, and reads single entries.
"""

import ctypes

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import ShapedArray
from jax.extend.core import Primitive
from jax.interpreters import batching, mlir

_table_entry = Primitive("table_entry")


def address_of(table: np.ndarray) -> float:
    """Return the address of a table, for lanes; the table, a contiguous array of floats
    `(rows, columns)`, must live as long as they run."""
    assert table.flags.c_contiguous
    assert table.dtype == float
    return float(table.ctypes.data)


def entries(table, row, width: int) -> list:
    """Read a row of a table of `width` columns, entry by entry: those that are not used
    cost nothing."""
    return [_table_entry.bind(table, row, width=width, column=i) for i in range(width)]


def _read(table, row, *, width: int, column: int) -> np.ndarray:
    table, row = np.asarray(table), np.asarray(row)
    places, values = width * row.astype(int) + column, np.zeros(row.shape)
    # Where there is no lane the address is 0, and zeros are read.
    for address in np.unique(table[table > 0.0]):
        here = table == address
        size = int(np.max(places[here])) + 1
        memory = (ctypes.c_double * size).from_address(int(address))
        values[here] = np.ctypeslib.as_array(memory)[places[here]]
    return values


def _read_from_xla(table, row, *, width: int, column: int):
    """Read entries as XLA computes, where there is no machine code."""
    result = jax.ShapeDtypeStruct(row.shape, row.dtype)
    return jax.pure_callback(
        lambda t, r: _read(t, r, width=width, column=column), result, table, row
    )


def _read_of_all(operands, axes, **which):
    lanes = next(
        x.shape[axis]
        for x, axis in zip(operands, axes, strict=True)
        if axis is not None
    )
    table, row = (
        jnp.broadcast_to(x, (lanes, *x.shape))
        if axis is None
        else jnp.moveaxis(x, axis, 0)
        for x, axis in zip(operands, axes, strict=True)
    )
    return _table_entry.bind(table, row, **which), 0


_table_entry.def_impl(lambda *operands, **which: jnp.asarray(_read(*operands, **which)))
_table_entry.def_abstract_eval(
    lambda table, row, **_: ShapedArray(row.shape, row.dtype)
)
batching.primitive_batchers[_table_entry] = _read_of_all
mlir.register_lowering(
    _table_entry, mlir.lower_fun(_read_from_xla, multiple_results=False)
)

"""Machine code that takes lanes from their inputs to their results.

What a lane does is given by three functions in JAX, which are traced for one lane and
compiled for vectors of eight. Eight columns of memory hold lanes under way; one that
has come to its end gives its place to the next. Lanes know nothing of each other: a
lane's results do not depend, to the last bit, on what runs beside it.
"""

import ctypes
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import numpy as np

from . import code
from .code import PACK, Machine, Output, compile_text, write_driver, write_function
from .graph import FLOAT, INTEGER, TRUTH, Graph, kind_of
from .translation import Translator, Values

KINDS = {"f": FLOAT, "i": INTEGER, "b": TRUTH}
ALIGNMENT = 64
SIGNATURE = ctypes.CFUNCTYPE(
    ctypes.c_int64,
    *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p),
    *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p),
    *(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_bool),
)


def is_available() -> bool:
    """Whether machine code can be made, and JAX computes on the CPU."""
    return code.is_available() and jax.default_backend() == "cpu"


class Kernel(NamedTuple):
    """Compiled code for lanes."""

    machine: Machine
    input_rows: int
    result_rows: int
    rows: int
    """Of inputs, state and results together."""
    structure: Any
    """Of the results, a tree with a row for each leaf."""

    def workspace(self) -> "Workspace":
        return Workspace(self)


class Workspace:
    """Eight columns in which one thread works with a kernel."""

    def __init__(self, kernel: Kernel):
        self._kernel = kernel
        self._run = SIGNATURE(kernel.machine.address)
        space = np.zeros(kernel.rows * PACK * 8 + ALIGNMENT, np.uint8)
        start = -space.ctypes.data % ALIGNMENT
        self._work = space[start:]
        self._lanes = np.full(PACK, -1, np.int64)

    def run(
        self, names: np.ndarray, inputs: np.ndarray, wait: bool
    ) -> tuple[np.ndarray, np.ndarray]:
        """Begin lanes, and go on until all have ended.

        Args:
            names: of the lanes, integers that are not negative.
            inputs: `(input_rows, lanes)`.
            wait: go on only until a column is empty, to be called again.

        Returns:
            Names of the lanes that have ended, and their results
            `(result_rows, ended)`.
        """
        kernel = self._kernel
        names = np.ascontiguousarray(names, np.int64)
        inputs = np.ascontiguousarray(inputs, float)
        if inputs.shape != (kernel.input_rows, len(names)):
            raise ValueError(
                f"got inputs of shape {inputs.shape}, need "
                f"{(kernel.input_rows, len(names))}, a row for each and a column a lane"
            )
        room = len(names) + PACK
        results = np.empty((kernel.result_rows, room))
        ended = np.empty(room, np.int64)
        count = self._run(
            *(inputs.ctypes.data, len(names), names.ctypes.data),
            *(results.ctypes.data, room, ended.ctypes.data),
            *(self._lanes.ctypes.data, self._work.ctypes.data, wait),
        )
        return ended[:count], results[:, :count]


def compile_kernel(begin: Callable, step: Callable, finish: Callable, inputs) -> Kernel:
    """Compile what lanes do.

    Args:
        begin: from inputs to the state at the start.
        step: from a state to the next, and whether the lane goes on.
        finish: from inputs and the last state to results.
        inputs: a tree of arrays, or of what stands for them, with one lane: every
            array of the functions has one axis of length 1, the lane's.

    Raises NotImplementedError if a function does what has no native code.
    """
    state = jax.eval_shape(begin, inputs)
    results = jax.eval_shape(finish, inputs, state)
    input_rows, state_rows, result_rows = map(_count, (inputs, state, results))
    row_of_results = input_rows + state_rows
    functions = [
        _translate("begin", begin, [(inputs, 0)], input_rows, masked=True),
        _translate("step", step, [(state, input_rows)], input_rows),
        _translate(
            "finish", finish, [(inputs, 0), (state, input_rows)], row_of_results
        ),
        write_driver(input_rows, row_of_results, result_rows),
    ]
    return Kernel(
        compile_text("\n".join(functions)),
        input_rows,
        result_rows,
        row_of_results + result_rows,
        jax.tree.structure(results),
    )


def _count(tree) -> int:
    return sum(int(np.prod(leaf.shape)) for leaf in jax.tree.leaves(tree))


def _translate(
    name: str, function: Callable, arguments: list, to: int, masked: bool = False
) -> str:
    """A function of trees whose rows begin where it is said, written for LLVM; what it
    gives goes to the rows from `to` on."""
    graph = Graph()
    inputs: list[Values] = []
    for tree, row in arguments:
        for leaf in jax.tree.leaves(tree):
            kind = KINDS[np.dtype(leaf.dtype).kind]
            values = np.empty(leaf.shape, object)
            for place in np.ndindex(leaf.shape):
                values[place] = graph.input(row, kind)
                row += 1
            inputs.append(values)
    traced = jax.make_jaxpr(function)(*(tree for tree, _ in arguments))
    arrays = Translator(graph).run(traced.jaxpr, traced.consts, inputs)
    truth = arrays.pop().item() if name == "step" else False
    values = [value for array in arrays for value in array.ravel()]
    rows = [Output(to + i, x, kind_of(x)) for i, x in enumerate(values)]
    return write_function(
        name, [row for row in rows if not _is_there(row)], truth, masked
    )


def _is_there(output: Output) -> bool:
    """Whether a value is what is already in its row."""
    node = output.value
    return (
        getattr(node, "operation", None) == "input" and node.arguments[0] == output.row
    )

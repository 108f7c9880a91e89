"""Machine code that takes lanes from their inputs to their results.

What a lane does is given by three functions in JAX, which are traced for one lane and
compiled for vectors of eight. Eight columns of memory hold lanes under way; one that
has come to its end gives its place to the next. Lanes know nothing of each other: a
lane's results do not depend, to the last bit, on what runs beside it.
"""

import ctypes
import math
from collections.abc import Callable
from typing import NamedTuple

import jax
import numpy as np

from ...collector import collector_paused
from .code import PACK, Output, compile_text, load, write_driver, write_function
from .graph import FLOAT, INPUT, INTEGER, TRUTH, Graph, Node, kind_of
from .translation import Translator

KINDS = {"f": FLOAT, "i": INTEGER, "b": TRUTH}
ALIGNMENT = 64
SIGNATURE = ctypes.CFUNCTYPE(
    ctypes.c_int64,
    *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p),
    *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p),
    *(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_bool),
)


class Code(NamedTuple):
    """What lanes do, compiled."""

    object_file: bytes
    input_rows: int
    result_rows: int
    rows: int
    """Of inputs, state and results together."""


class Kernel:
    """Compiled code that is ready to run.

    Args:
        code: what lanes do.
        structure: of the results, a tree with a row for each leaf.
        tolerance_row: of its inputs, the one with the tolerance of the error control,
            if there is one.
    """

    def __init__(self, code: Code, structure, tolerance_row: int | None = None):
        self.code, self.structure = code, structure
        self.tolerance_row = tolerance_row
        self.machine = load(code.object_file)

    def workspace(self) -> "Workspace":
        return Workspace(self)


class Workspace:
    """Eight columns in which one thread works with a kernel."""

    def __init__(self, kernel: Kernel):
        # The code must live as long as this.
        self._kernel, self._code = kernel, kernel.code
        self._run = SIGNATURE(kernel.machine.address)
        space = np.zeros(kernel.code.rows * PACK * 8 + ALIGNMENT, np.uint8)
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
        code = self._code
        names = np.ascontiguousarray(names, np.int64)
        inputs = np.ascontiguousarray(inputs, float)
        if inputs.shape != (code.input_rows, len(names)):
            raise ValueError(
                f"got inputs of shape {inputs.shape}, need "
                f"{(code.input_rows, len(names))}, a row for each and a column a lane"
            )
        room = len(names) + PACK
        results = np.empty((code.result_rows, room))
        ended = np.empty(room, np.int64)
        count = self._run(
            *(inputs.ctypes.data, len(names), names.ctypes.data),
            *(results.ctypes.data, room, ended.ctypes.data),
            *(self._lanes.ctypes.data, self._work.ctypes.data, wait),
        )
        return ended[:count], results[:, :count]


def compile_kernel(begin: Callable, step: Callable, finish: Callable, inputs) -> Kernel:
    """Compile what lanes do, ready to run; see `compile_code`."""
    code = compile_code(begin, step, finish, inputs)
    state = jax.eval_shape(begin, inputs)
    results = jax.eval_shape(finish, inputs, state)
    return Kernel(code, jax.tree.structure(results))


def compile_code(begin: Callable, step: Callable, finish: Callable, inputs) -> Code:
    """Compile what lanes do.

    Args:
        begin: from inputs to the state at the start.
        step: from a state to the next, and whether the lane goes on.
        finish: from inputs and the last state to results.
        inputs: a tree of arrays, or of what stands for them, with one lane: every
            array of the functions has one axis of length 1, the lane's.

    Raises NoMachineCode if a function does what has no native code.
    """
    with collector_paused():
        trace_begin, state = jax.make_jaxpr(begin, return_shape=True)(inputs)
        trace_step = jax.make_jaxpr(step)(state)
        trace_finish, results = jax.make_jaxpr(finish, return_shape=True)(inputs, state)
        input_rows, state_rows, result_rows = map(_count, (inputs, state, results))
        at_results = input_rows + state_rows
        text = [
            _written("begin", trace_begin, 0, input_rows, masked=True),
            _written("step", trace_step, input_rows, input_rows, says=True),
            _written("finish", trace_finish, 0, at_results),
            write_driver(input_rows, at_results, result_rows),
        ]
    return Code(
        compile_text("\n".join(text)), input_rows, result_rows, at_results + result_rows
    )


def _count(tree) -> int:
    """Rows of a tree."""
    return sum(math.prod(leaf.shape) for leaf in jax.tree.leaves(tree))


def _written(
    name: str, traced, start: int, to: int, masked: bool = False, says: bool = False
) -> str:
    """A traced function, written for LLVM. What it takes is in the rows from `start`
    on, what it gives goes to those from `to` on, but for what it `says` at last."""
    graph = Graph()
    row, inputs = start, []
    for place in traced.in_avals:
        values = np.empty(place.shape, object)
        for index in np.ndindex(place.shape):
            values[index] = graph.input(row, KINDS[place.dtype.kind])
            row += 1
        inputs.append(values)
    arrays = Translator(graph).run(traced.jaxpr, traced.consts, inputs)
    said = arrays.pop().item() if says else False
    values = [value for array in arrays for value in array.ravel()]
    outputs = [Output(to + i, x, kind_of(x)) for i, x in enumerate(values)]
    changed = [output for output in outputs if not _stays(output)]
    return write_function(name, changed, said, masked)


def _stays(output: Output) -> bool:
    """Whether a value is what is in its row already."""
    value = output.value
    is_input = isinstance(value, Node) and value.operation == INPUT
    return is_input and value.arguments == (output.row,)

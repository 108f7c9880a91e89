"""Functions of one lane in JAX, run over many lanes in machine code.

What a run-out asks of a block is worked out lane by lane: no lane waits for the
slowest, nothing is compiled again for another number of lanes, and a lane's result does
not depend, to the last bit, on what runs beside it. The functions themselves are plain
`jnp` and can be differentiated.
"""

import concurrent.futures
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from ..engines.marching import CORES
from ..engines.native import Kernel, compile_kernel
from .dual import Dual, carries, carrying

LANES_OF_A_THREAD = 512
"""Lanes of many steps that are worth a thread of their own."""
LANES_OF_ONE_STEP = 16_384
"""The same of functions that have their result at once."""


class Program:
    """What lanes do: begin, take steps until one says that it was the last, finish.

    Args:
        begin: from inputs to the state at the start.
        step: from a state to the next, and whether the lane goes on.
        finish: from the last state to results, a tree.
        lanes_of_a_thread: so many lanes are worth a thread.

    Called with trees of arrays that broadcast to `(lanes,)`, a program gives the
    results as arrays of floats `(lanes,)`. It is compiled, in some tenths of a second,
    when it is first called with trees of a structure.
    """

    def __init__(
        self,
        begin: Callable,
        step: Callable,
        finish: Callable,
        lanes_of_a_thread: int = LANES_OF_A_THREAD,
    ):
        self.functions = begin, step, finish
        self.lanes_of_a_thread = lanes_of_a_thread
        self._kernels = {}

    def __call__(self, *inputs):
        leaves, structure = jax.tree.flatten(inputs)
        if structure not in self._kernels:
            self._kernels[structure] = self._compile(inputs)
        kernel = self._kernels[structure]
        lanes = max(np.size(leaf) for leaf in leaves)
        rows = np.empty((len(leaves), lanes))
        for row, leaf in zip(rows, leaves, strict=True):
            row[:] = leaf
        results = np.empty((kernel.code.result_rows, lanes))

        def work(places: np.ndarray) -> None:
            ended, of_ended = kernel.workspace().run(
                places, rows[:, places], wait=False
            )
            results[:, ended] = of_ended

        threads = max(1, min(CORES, lanes // self.lanes_of_a_thread))
        if threads == 1:
            work(np.arange(lanes))
        else:
            parts = [np.arange(i, lanes, threads) for i in range(threads)]
            with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                list(pool.map(work, parts))
        return jax.tree.unflatten(kernel.structure, list(results))

    def _compile(self, inputs) -> Kernel:
        begin, step, finish = self.functions
        one = jax.ShapeDtypeStruct((1,), float)
        return compile_kernel(
            lambda inputs: begin(*inputs),
            step,
            lambda _, state: finish(state),
            jax.tree.map(lambda _: one, inputs),
        )


class ClosedProgram(Program):
    """The program of a function that has its result at once.

    Of inputs that carry derivatives (`Dual`), it carries them on to all results.
    """

    def __init__(self, function: Callable):
        super().__init__(function, _no_more, _as_it_is, LANES_OF_ONE_STEP)
        self._along = Program(
            lambda inputs, directions: jax.jvp(function, inputs, directions),
            _no_more,
            _as_it_is,
            LANES_OF_ONE_STEP,
        )

    def __call__(self, *inputs):
        count = carries(inputs)
        if not count:
            return super().__call__(*inputs)
        leaves, structure = jax.tree.flatten(inputs)
        shape = np.broadcast_shapes(*(np.shape(leaf) for leaf in leaves))
        rows = [carrying(leaf, count) for leaf in leaves]

        # One lane for each lane and parameter.
        def unfolded(arrays):
            spread = (np.broadcast_to(a, (count, *shape)).ravel() for a in arrays)
            return jax.tree.unflatten(structure, list(spread))

        values, slopes = self._along(
            unfolded(row.value for row in rows),
            unfolded(
                row.tangent.reshape(count, *(row.tangent.shape[1:] or (1,)))
                for row in rows
            ),
        )
        return jax.tree.map(
            lambda value, slope: Dual(
                value.reshape(count, *shape)[0], slope.reshape(count, *shape)
            ),
            values,
            slopes,
        )


def closed_form(function: Callable) -> ClosedProgram:
    """The program of a function that has its result at once."""
    return ClosedProgram(function)


def _no_more(state):
    return state, jnp.zeros((1,), bool)


def _as_it_is(state):
    return state

"""Functions of one lane in JAX, run over many lanes in machine code.

The run-out works lane by lane: no lane waits for the slowest, nothing is compiled again
for another number of lanes, and a lane's result does not depend, to the last bit, on
what runs beside it. The functions themselves are plain `jnp` of scalars and can be
differentiated. Users' shapes and laws that have no machine code are run by XLA.
"""

import concurrent.futures
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .._gc_pause import collector_paused
from ..backend.native_backend import without_machine_code
from ..backend.simd import Kernel, NoMachineCode, compile_kernel
from ..backend.threads import thread_count
from .dual import Dual, as_dual, tangent_count

LANES_PER_THREAD = 512
"""Lanes of a program of many steps that are worth a thread."""
LANES_PER_THREAD_OF_ONE_STEP = 16_384
"""Lanes of a program of one step that are worth a thread."""
LANES_OF_XLA = 512
"""Lanes that XLA takes at once, always so many."""


class Program:
    """Loop over the steps of each lane: begin, step until the last, finish.

    Args:
        begin: gives the state at the start from the inputs, scalars.
        step: gives the next state, and whether the lane goes on.
        finish: gives the results, a tree, from the last state.
        lanes_per_thread: number of lanes that are worth a thread.

    Called with trees of arrays that broadcast, a program gives the results as arrays of
    floats of their common shape. It is compiled, in some tenths of a second, on the
    first call with trees of a structure.
    """

    def __init__(
        self,
        begin: Callable,
        step: Callable,
        finish: Callable,
        lanes_per_thread: int = LANES_PER_THREAD,
    ):
        self.functions = begin, step, finish
        self.lanes_per_thread = lanes_per_thread
        self._kernels: dict = {}

    def __call__(self, *inputs) -> Any:
        leaves, structure = jax.tree.flatten(inputs)
        if structure not in self._kernels:
            self._kernels[structure] = self._compile(inputs)
        kernel = self._kernels[structure]
        shape = np.broadcast_shapes((1,), *(np.shape(leaf) for leaf in leaves))
        rows = np.empty((len(leaves), *shape))
        for row, leaf in enumerate(leaves):
            rows[row] = leaf
        results = self._run(kernel, rows.reshape(len(leaves), -1))
        return jax.tree.map(lambda row: row.reshape(shape), results)

    def _run(self, kernel, rows: np.ndarray):
        if isinstance(kernel, _ByXla):
            return kernel.run(rows)
        lanes = rows.shape[1]
        results = np.empty((kernel.code.result_rows, lanes))

        def work(places: np.ndarray) -> None:
            ended, found = kernel.workspace().run(places, rows[:, places], wait=False)
            results[:, ended] = found

        threads = max(1, min(thread_count(), lanes // self.lanes_per_thread))
        if threads == 1:
            work(np.arange(lanes))
        else:
            parts = [np.arange(i, lanes, threads) for i in range(threads)]
            with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                list(pool.map(work, parts))
        return jax.tree.unflatten(kernel.structure, list(results))

    def _compile(self, inputs) -> "Kernel | _ByXla":
        begin, step, finish = map(jax.vmap, self.functions)
        one = jax.ShapeDtypeStruct((1,), float)
        try:
            with collector_paused():
                return compile_kernel(
                    lambda inputs: begin(*inputs),
                    step,
                    lambda _, state: finish(state),
                    jax.tree.map(lambda _: one, inputs),
                )
        except NoMachineCode as problem:
            without_machine_code(problem)
            return _ByXla(self.functions, jax.tree.structure(inputs))


class _ByXla:
    """Program run by XLA, in parts of one size, which wait for their slowest lane."""

    def __init__(self, functions: tuple[Callable, Callable, Callable], structure):
        begin, step, finish = functions

        def run_lane(leaves):
            state = begin(*jax.tree.unflatten(structure, list(leaves)))
            state, _ = jax.lax.while_loop(
                lambda turn: turn[1], lambda turn: step(turn[0]), step(state)
            )
            return finish(state)

        self._run = jax.jit(jax.vmap(run_lane, in_axes=1))

    def run(self, rows: np.ndarray):
        """Compute results from inputs `(rows, lanes)`."""
        lanes = rows.shape[1]
        parts = []
        for start in range(0, max(lanes, 1), LANES_OF_XLA):
            part = rows[:, start : start + LANES_OF_XLA]
            missing = LANES_OF_XLA - part.shape[1]
            padded = np.pad(part, ((0, 0), (0, missing)), "edge" if lanes else "empty")
            found = self._run(padded)
            kept = LANES_OF_XLA - missing
            parts.append(jax.tree.map(lambda x, k=kept: np.array(x[:k], float), found))
        return jax.tree.map(lambda *x: np.concatenate(x), *parts)


class ClosedProgram(Program):
    """Program of a function without steps.

    Inputs that carry derivatives (`Dual`) give results that carry them too.
    """

    def __init__(self, function: Callable):
        super().__init__(function, _stop, _as_it_is, LANES_PER_THREAD_OF_ONE_STEP)
        self._jvp = Program(
            lambda inputs, directions: jax.jvp(function, inputs, directions),
            _stop,
            _as_it_is,
            LANES_PER_THREAD_OF_ONE_STEP,
        )

    def __call__(self, *inputs) -> Any:
        count = tangent_count(inputs)
        if not count:
            return super().__call__(*inputs)
        leaves, structure = jax.tree.flatten(inputs)
        shape = np.broadcast_shapes(*(np.shape(leaf) for leaf in leaves))
        rows = [as_dual(leaf, count) for leaf in leaves]

        # One lane for each lane and parameter.
        def unfolded(arrays):
            spread = (np.broadcast_to(a, (count, *shape)).ravel() for a in arrays)
            return jax.tree.unflatten(structure, list(spread))

        values, slopes = self._jvp(
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
    """Make the program of a function of scalars that needs no steps."""
    return ClosedProgram(function)


def _stop(state):
    return state, jnp.zeros((), bool)


def _as_it_is(state):
    return state

"""Functions of one lane in JAX, run over many lanes in machine code.

What a run-out asks of a block is worked out lane by lane: no lane waits for the
slowest, nothing is compiled again for another number of lanes, and a lane's result does
not depend, to the last bit, on what runs beside it. The functions themselves are plain
`jnp` of scalars and can be differentiated. Those of a user's shape or law that do what
has no machine code are run by XLA.
"""

import concurrent.futures
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from ..engines.machine import without_machine_code
from ..engines.native import Kernel, NoMachineCode, compile_kernel
from ..engines.threads import thread_count
from .dual import Dual, carries, carrying

LANES_OF_A_THREAD = 512
"""Lanes of many steps that are worth a thread of their own."""
LANES_OF_ONE_STEP = 16_384
"""The same of functions that have their result at once."""
LANES_OF_XLA = 512
"""Lanes that XLA takes at once, always so many."""


class Program:
    """What lanes do: begin, take steps until one says that it was the last, finish.

    Args:
        begin: from inputs, scalars, to the state at the start.
        step: from a state to the next, and whether the lane goes on.
        finish: from the last state to results, a tree.
        lanes_of_a_thread: so many lanes are worth a thread.

    Called with trees of arrays that broadcast, a program gives the results as arrays of
    floats of their common shape. It is compiled, in some tenths of a second,
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
        self._kernels: dict = {}

    def __call__(self, *inputs):
        leaves, structure = jax.tree.flatten(inputs)
        if structure not in self._kernels:
            self._kernels[structure] = self._compile(inputs)
        kernel = self._kernels[structure]
        shape = np.broadcast_shapes((1,), *(np.shape(leaf) for leaf in leaves))
        rows = np.empty((len(leaves), *shape))
        for row, leaf in zip(rows, leaves, strict=True):
            row[...] = leaf
        results = self._run(kernel, rows.reshape(len(leaves), -1))
        return jax.tree.map(lambda row: row.reshape(shape), results)

    def _run(self, kernel, rows: np.ndarray):
        if isinstance(kernel, _ByXla):
            return kernel.run(rows)
        lanes = rows.shape[1]
        results = np.empty((kernel.code.result_rows, lanes))

        def work(places: np.ndarray) -> None:
            ended, of_ended = kernel.workspace().run(
                places, rows[:, places], wait=False
            )
            results[:, ended] = of_ended

        threads = max(1, min(thread_count(), lanes // self.lanes_of_a_thread))
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
    """What lanes do, by XLA: in parts of one size, which wait for their slowest."""

    def __init__(self, functions: tuple[Callable, Callable, Callable], structure):
        begin, step, finish = functions

        def of_lane(leaves):
            state = begin(*jax.tree.unflatten(structure, list(leaves)))
            state, _ = jax.lax.while_loop(
                lambda turn: turn[1], lambda turn: step(turn[0]), step(state)
            )
            return finish(state)

        self._run = jax.jit(jax.vmap(of_lane, in_axes=1))

    def run(self, rows: np.ndarray):
        """Results of inputs `(rows, lanes)`."""
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
    return state, jnp.zeros((), bool)


def _as_it_is(state):
    return state

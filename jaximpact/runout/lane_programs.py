"""Functions of one lane in JAX, run over many lanes in machine code.

The run-out works lane by lane: no lane waits for the slowest, nothing is compiled again
for another number of lanes, and a lane's result does not depend, to the last bit, on
what runs beside it. The functions themselves are plain `jnp` of scalars. Users' shapes
and laws that have no machine code are run by XLA.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np

from .._settings import collector_paused
from ..backend.native_backend import kept_code, without_machine_code
from ..backend.simd import (
    Code,
    Kernel,
    KernelSet,
    NoMachineCode,
    compile_kernel,
)
from ..backend.threads import thread_count
from ..identity import PACKAGE, clear_when_edited, heed_edits, tracing

if TYPE_CHECKING:
    # The same formulas run on both; no union of them says so.
    Values = Any
else:
    Values = jax.Array | np.ndarray
"""Numbers of many blocks, `(lanes,)`: NumPy arrays between programs, JAX scalars inside
them."""

LANES_OF_XLA = 512
"""Lanes that XLA takes at once, always so many."""


class LaneProgram:
    """Loop over the steps of each lane: begin, step until the last, finish.

    Args:
        begin: gives the state at the start from the inputs, scalars.
        step: gives the next state, and whether the lane goes on.
        finish: gives the results, a tree, from the inputs and the last state.
        names: functions by whose names the code is kept; these three by default.
        lanes_per_thread: number of lanes that are worth a thread.

    Called with trees of arrays that broadcast, a program gives the results as arrays of
    floats of their common shape. It is compiled, in some tenths of a second, on the
    first call with trees of a structure, and kept on disk.
    """

    def __init__(
        self,
        begin: Callable,
        step: Callable,
        finish: Callable,
        names: Sequence[Callable] = (),
        lanes_per_thread: int = 512,
    ):
        self.functions = begin, step, finish
        self.names = names or self.functions
        self.lanes_per_thread = lanes_per_thread
        self._kernels: dict = {}
        clear_when_edited(self._kernels.clear)

    def __call__(self, *inputs) -> Any:
        leaves, structure = jax.tree.flatten(inputs)
        heed_edits(structure)
        if structure not in self._kernels:
            with tracing():
                self._kernels[structure] = self._kernel(inputs)
        kernel = self._kernels[structure]
        rows = _run(kernel, leaves, _shape_of(leaves), self.lanes_per_thread)
        return jax.tree.unflatten(kernel.structure, rows)

    def _kernel(self, inputs) -> "KernelSet | _ByXla":
        # A state may be without numbers, which would tell how many lanes there are.
        begin, step, finish = (jax.vmap(f, axis_size=1) for f in self.functions)
        one = jax.ShapeDtypeStruct((1,), float)

        def compiled() -> tuple[Code, Any]:
            kernel = compile_kernel(
                lambda leaves: begin(*leaves),
                step,
                finish,
                jax.tree.map(lambda _: one, inputs),
            )
            return kernel.code, _template(kernel.structure)

        try:
            code, results = _kept(self.names, inputs, compiled)
            return KernelSet([Kernel(code, jax.tree.structure(results))])
        except NoMachineCode as problem:
            without_machine_code(problem)
            return _ByXla(self.functions, jax.tree.structure(inputs))


def closed_form(function: Callable) -> LaneProgram:
    """Make a program of a function of scalars without steps; results may be numbers of
    any type, and become floats."""

    def finish(inputs, _):
        return jax.tree.map(lambda x: jnp.asarray(x, float), function(*inputs))

    # All is done as a lane ends, so that nothing is kept of it before.
    return LaneProgram(_nothing, _stop, finish, [function], lanes_per_thread=16_384)


def _nothing(*_) -> tuple:
    return ()


def _stop(state):
    return state, jnp.zeros((), bool)


def _kept(functions: Sequence[Callable], tree, compiled: Callable) -> Any:
    """Keep what is compiled of functions for inputs, a tree, if the package defines
    them under a name of their own."""
    names = [f"{f.__module__}.{f.__qualname__}" for f in functions]
    with collector_paused():
        if all(n.startswith(f"{PACKAGE}.") and "<" not in n for n in names):
            return kept_code(tuple(names), tree, compiled)
        return compiled()


def _template(structure) -> Any:
    """Make a tree of a structure, which can be pickled as the structure itself
    cannot."""
    return jax.tree.unflatten(structure, range(structure.num_leaves))


def _shape_of(leaves: list) -> tuple[int, ...]:
    """Return the shape that leaves broadcast to, of one axis at least."""
    shapes = set(map(np.shape, leaves)) - {(), (1,)}
    if len(shapes) == 1:  # as it mostly is; NumPy takes its time
        return shapes.pop()
    return np.broadcast_shapes((1,), *shapes)


def _run(kernel, leaves: list, shape: tuple[int, ...], lanes_per_thread: int) -> list:
    """Give the rows of results, of a shape, for rows of inputs that broadcast to it."""
    rows = np.empty((len(leaves), *shape))
    for row, leaf in enumerate(leaves):
        rows[row] = leaf
    rows = rows.reshape(len(leaves), -1)
    if isinstance(kernel, _ByXla):
        return [row.reshape(shape) for row in kernel.run(rows)]
    threads = max(1, min(thread_count(), rows.shape[1] // lanes_per_thread))
    results, _ = kernel.compute(rows, threads)
    return [row.reshape(shape) for row in results]


class _ByXla:
    """Program run by XLA, in parts of one size, which wait for their slowest lane."""

    def __init__(self, functions: tuple[Callable, Callable, Callable], structure):
        begin, step, finish = functions

        def run_lane(leaves):
            inputs = jax.tree.unflatten(structure, list(leaves))
            state = begin(*inputs)
            state, _ = jax.lax.while_loop(
                lambda turn: turn[1], lambda turn: step(turn[0]), step(state)
            )
            return finish(inputs, state)

        one = [jax.ShapeDtypeStruct((), float)] * structure.num_leaves
        self.structure = jax.tree.structure(jax.eval_shape(run_lane, one))
        self._run = jax.jit(jax.vmap(run_lane, in_axes=1))

    def run(self, rows: np.ndarray) -> list[np.ndarray]:
        """Compute rows of results from inputs `(rows, lanes)`."""
        lanes = rows.shape[1]
        parts = []
        for start in range(0, max(lanes, 1), LANES_OF_XLA):
            part = rows[:, start : start + LANES_OF_XLA]
            missing = LANES_OF_XLA - part.shape[1]
            mode = "edge" if lanes else "constant"
            padded = np.pad(part, ((0, 0), (0, missing)), mode)
            with tracing():
                leaves = jax.tree.leaves(self._run(padded))
            parts.append([np.array(x[: LANES_OF_XLA - missing], float) for x in leaves])
        return [np.concatenate(x) for x in zip(*parts, strict=True)]

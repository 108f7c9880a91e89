"""Functions of one lane in JAX, run over many lanes in machine code.

The run-out works lane by lane: no lane waits for the slowest, nothing is compiled again
for another number of lanes, and a lane's result does not depend, to the last bit, on
what runs beside it. The functions themselves are plain `jnp` of scalars. Users' shapes
and laws that have no machine code are run by XLA.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.extend.core import jaxpr_as_fun

from .._jax_internals import is_variable
from .._settings import collector_paused
from ..backend.native_backend import kept_code, without_machine_code
from ..backend.simd import (
    Code,
    Kernel,
    KernelSet,
    LaneFunctions,
    NoMachineCode,
    compile_code,
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
        finish: gives the results, a tree, from the last state.

    Called with trees of arrays that broadcast, a program gives the results as arrays of
    floats of their common shape. It is compiled, in some tenths of a second, on the
    first call with trees of a structure, and kept on disk.
    """

    def __init__(self, begin: Callable, step: Callable, finish: Callable):
        self.functions = begin, step, finish
        self._kernels: dict = {}
        clear_when_edited(self._kernels.clear)

    def __call__(self, *inputs) -> Any:
        leaves, structure = jax.tree.flatten(inputs)
        heed_edits(structure)
        if structure not in self._kernels:
            with tracing():
                self._kernels[structure] = self._kernel(inputs)
        kernel = self._kernels[structure]
        shape = _shape_of(leaves)
        # So many lanes of many steps are worth a thread.
        rows = _run(kernel, leaves, shape, lanes_per_thread=512)
        return jax.tree.unflatten(kernel.structure, rows)

    def _kernel(self, inputs) -> "KernelSet | _ByXla":
        begin, step, finish = map(jax.vmap, self.functions)
        one = jax.ShapeDtypeStruct((1,), float)

        def compiled() -> tuple[Code, Any]:
            kernel = compile_kernel(
                *(lambda leaves: begin(*leaves), step, lambda _, state: finish(state)),
                jax.tree.map(lambda _: one, inputs),
            )
            return kernel.code, _template(kernel.structure)

        try:
            code, results = _kept(self.functions, inputs, compiled)
            return KernelSet([Kernel(code, jax.tree.structure(results))])
        except NoMachineCode as problem:
            without_machine_code(problem)
            return _ByXla(self.functions, jax.tree.structure(inputs))


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
            state = begin(*jax.tree.unflatten(structure, list(leaves)))
            state, _ = jax.lax.while_loop(
                lambda turn: turn[1], lambda turn: step(turn[0]), step(state)
            )
            return finish(state)

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


class _Plan(NamedTuple):
    """Part of a function that has to be computed, for inputs of one structure."""

    used: list[int]  # places of the inputs that matter among the leaves
    passed: list[int | None]  # place, for each result, of the input that it is, or None
    results: Any  # template of the results
    code: Code | None = None
    """Computes the results that are not inputs, from the inputs that matter; None where
    there are none, or no machine code."""


class ClosedProgram:
    """Program of a function without steps.

    Called as a `LaneProgram` is. Results may be numbers of any type; all become floats.
    An input that is also a result is not copied, and one that is not used costs
    nothing.
    """

    def __init__(self, function: Callable):
        self.function = function
        self._plans: dict = {}
        clear_when_edited(self._plans.clear)

    def __call__(self, *inputs) -> Any:
        leaves, structure = jax.tree.flatten(inputs)
        heed_edits(structure)
        if structure not in self._plans:
            with tracing():
                self._plans[structure] = self._planned(inputs)
        plan, kernel = self._plans[structure]
        shape, computed = _shape_of(leaves), iter(())
        if kernel is not None:
            used = [leaves[place] for place in plan.used]
            needed = _shape_of(used)
            computed = iter(_run(kernel, used, needed, lanes_per_thread=16_384))
        results = [
            np.asarray(next(computed) if place is None else leaves[place], float)
            for place in plan.passed
        ]
        spread = (x if x.shape == shape else np.broadcast_to(x, shape) for x in results)
        return jax.tree.unflatten(jax.tree.structure(plan.results), list(spread))

    def _planned(self, inputs: tuple) -> tuple:
        """Give the plan, and what runs it."""
        structure = jax.tree.structure(inputs)

        def compiled() -> _Plan:
            plan, reduced = _plan_of(self.function, structure)
            if None not in plan.passed:
                return plan
            of_lanes, ended = jax.vmap(reduced), np.zeros(1, bool)
            # All is done as a lane ends, so that nothing is kept of it before.
            functions = LaneFunctions(
                lambda inputs: (),
                lambda state: (state, ended),
                lambda inputs, _: of_lanes(*inputs),
            )
            one = jax.ShapeDtypeStruct((1,), float)
            code = compile_code(functions, [one] * len(plan.used))
            return plan._replace(code=code)

        try:
            plan = _kept([self.function], inputs, compiled)
            return plan, plan.code and KernelSet([Kernel(plan.code, None)])
        except NoMachineCode as problem:
            without_machine_code(problem)
            plan, reduced = _plan_of(self.function, structure)
            rows = jax.tree.structure([*plan.used])
            return plan, _ByXla((reduced, _stop, lambda state: state), rows)


def _plan_of(function: Callable, structure) -> tuple[_Plan, Callable]:
    """Give the plan of a function, and the function that has to be computed."""

    def flat(*leaves):
        results = function(*jax.tree.unflatten(structure, leaves))
        return jax.tree.map(lambda x: jnp.asarray(x, float), results)

    one = [jax.ShapeDtypeStruct((), float)] * structure.num_leaves
    traced, results = jax.make_jaxpr(flat, return_shape=True)(*one)
    places = {variable: place for place, variable in enumerate(traced.jaxpr.invars)}
    # Literals among the operands have no place, and cannot be looked up.
    atoms = [x for equation in traced.jaxpr.eqns for x in equation.invars]
    used = sorted({places[x] for x in atoms if is_variable(x) and x in places})
    used = used or [0]  # A program needs some input.
    passed = [places.get(x) if is_variable(x) else None for x in traced.jaxpr.outvars]

    function_traced = jaxpr_as_fun(traced)

    def reduced(*values):
        by_place = dict(zip(used, values, strict=True))
        computed = function_traced(*(by_place.get(i, 0.0) for i in range(len(one))))
        return [x for x, place in zip(computed, passed, strict=True) if place is None]

    return _Plan(used, passed, _template(jax.tree.structure(results))), reduced


closed_form = ClosedProgram
"""Decorator of a function of scalars that needs no steps."""


def _stop(state):
    return state, jnp.zeros((), bool)

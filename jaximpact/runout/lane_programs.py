"""Functions of one lane in JAX, run over many lanes in machine code.

The run-out works lane by lane: no lane waits for the slowest, nothing is compiled again
for another number of lanes, and a lane's result does not depend, to the last bit, on
what runs beside it. The functions themselves are plain `jnp` of scalars and can be
differentiated. Users' shapes and laws that have no machine code are run by XLA.

`Carried` holds numbers of many blocks together with their derivatives, and `call` runs
a program on both. Of two functions the derivatives are stated here, `found_by_search`
and `root`: JAX cannot find them, or would find NaN where nothing changes.
"""

import concurrent.futures
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .._gc_pause import collector_paused
from .._jax_internals import is_variable
from ..backend.native_backend import without_machine_code
from ..backend.simd import Kernel, NoMachineCode, compile_kernel
from ..backend.threads import thread_count

if TYPE_CHECKING:
    # The same formulas run on both; no union of them says so.
    Values = Any
else:
    Values = jax.Array | np.ndarray
"""Numbers of many blocks, `(lanes,)`: NumPy arrays between programs, JAX scalars inside
them."""

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
        threads = max(1, min(thread_count(), lanes // self.lanes_per_thread))
        if threads == 1:
            results = _in_order(*kernel.workspace().run(np.arange(lanes), rows, False))
        else:
            results = np.empty((kernel.code.result_rows, lanes))

            def work(places: np.ndarray) -> None:
                ended, found = kernel.workspace().run(places, rows[:, places], False)
                results[:, ended] = found

            parts = [np.arange(i, lanes, threads) for i in range(threads)]
            with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                list(pool.map(work, parts))
        return jax.tree.unflatten(kernel.structure, list(results))

    def _lane_functions(self) -> tuple[Callable, Callable, Callable]:
        """Give functions for `compile_kernel`, of arrays with one lane."""
        begin, step, finish = map(jax.vmap, self.functions)
        return lambda inputs: begin(*inputs), step, lambda _, state: finish(state)

    def _compile(self, inputs) -> "Kernel | _ByXla":
        one = jax.ShapeDtypeStruct((1,), float)
        try:
            with collector_paused():
                return compile_kernel(
                    *self._lane_functions(), jax.tree.map(lambda _: one, inputs)
                )
        except NoMachineCode as problem:
            without_machine_code(problem)
            return _ByXla(self.functions, jax.tree.structure(inputs))


def _in_order(ended: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Bring results into the order of the lanes' numbers, from 0; lanes of one step end
    in order."""
    if np.array_equal(ended, np.arange(len(ended))):
        return found
    results = np.empty(found.shape)
    results[:, ended] = found
    return results


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


class _OneStep(Program):
    """Program of a function without steps: all is done as a lane ends, so that nothing
    is kept of it before."""

    def __init__(self, function: Callable):
        super().__init__(function, _stop, _as_it_is, LANES_PER_THREAD_OF_ONE_STEP)

    def _lane_functions(self) -> tuple[Callable, Callable, Callable]:
        function = jax.vmap(self.functions[0])
        ended = np.zeros(1, bool)
        return (
            lambda inputs: (),
            lambda state: (state, ended),
            lambda inputs, _: function(*inputs),
        )


class _Plan(NamedTuple):
    """What of a function has to be computed, for inputs of one structure."""

    program: _OneStep
    """Gives the results that are not inputs, from the inputs that matter."""
    used: list[int]
    """Places of those inputs among the leaves."""
    passed: list[int | None]
    """For each result the place of the input that it is, or None."""
    structure: Any
    """Of the results."""


class ClosedProgram:
    """Program of a function without steps, which can be differentiated.

    Called as a `Program` is. Results may be numbers of any type; all become floats. An
    input that is also a result is not copied, and one that is not used costs nothing.
    """

    def __init__(self, function: Callable):
        def in_floats(*inputs):
            return jax.tree.map(lambda x: jnp.asarray(x, float), function(*inputs))

        self.function = in_floats
        self._plans: dict = {}

    def __call__(self, *inputs) -> Any:
        return self._run(self.function, inputs)

    def along(self, inputs: tuple, tangents: tuple) -> Any:
        """Compute the derivatives of the results along some directions.

        Args:
            inputs: as for a call, arrays `(lanes,)`.
            tangents: directions, for each input a tree like it, of arrays
                `(parameters, lanes)`; None for an input that does not change.

        Returns:
            Results, a tree of arrays `(parameters, lanes)`: one lane of machine code
            for each pair of a lane and a parameter.
        """
        return self._run(self._derivative, (inputs, tangents))

    def _derivative(self, inputs: tuple, tangents: tuple) -> Any:
        def of_changing(changing: list) -> Any:
            rest = iter(changing)
            return self.function(
                *(
                    x if tangent is None else next(rest)
                    for x, tangent in zip(inputs, tangents, strict=True)
                )
            )

        pairs = zip(inputs, tangents, strict=True)
        changing = [(x, tangent) for x, tangent in pairs if tangent is not None]
        numbers, directions = map(list, zip(*changing, strict=True))
        return jax.jvp(of_changing, (numbers,), (directions,))[1]

    def _run(self, function: Callable, inputs: tuple) -> Any:
        leaves, structure = jax.tree.flatten(inputs)
        key = function == self.function, structure
        if key not in self._plans:
            self._plans[key] = _plan_of(function, structure)
        plan = self._plans[key]
        shape = np.broadcast_shapes((1,), *map(np.shape, leaves))
        computed = iter(())
        if None in plan.passed:
            computed = iter(plan.program(*(leaves[place] for place in plan.used)))
        results = [
            np.asarray(next(computed) if place is None else leaves[place], float)
            for place in plan.passed
        ]
        spread = (x if x.shape == shape else np.broadcast_to(x, shape) for x in results)
        return jax.tree.unflatten(plan.structure, list(spread))


def _plan_of(function: Callable, structure) -> _Plan:
    def flat(*leaves):
        return function(*jax.tree.unflatten(structure, leaves))

    one = [jax.ShapeDtypeStruct((), float)] * structure.num_leaves
    traced, results = jax.make_jaxpr(flat, return_shape=True)(*one)
    places = {variable: place for place, variable in enumerate(traced.jaxpr.invars)}
    # Literals among the operands have no place, and cannot be looked up.
    atoms = [x for equation in traced.jaxpr.eqns for x in equation.invars]
    used = sorted({places[x] for x in atoms if is_variable(x) and x in places})
    used = used or [0]  # A program needs some input.
    passed = [places.get(x) if is_variable(x) else None for x in traced.jaxpr.outvars]

    def reduced(*own):
        given = dict(zip(used, own, strict=True))
        found = jax.tree.leaves(flat(*(given.get(i, 0.0) for i in range(len(one)))))
        return [x for x, place in zip(found, passed, strict=True) if place is None]

    return _Plan(_OneStep(reduced), used, passed, jax.tree.structure(results))


def closed_form(function: Callable) -> ClosedProgram:
    """Make the program of a function of scalars that needs no steps."""
    return ClosedProgram(function)


def _stop(state):
    return state, jnp.zeros((), bool)


def _as_it_is(state):
    return state


def _product(slope: Values, change: Values) -> Values:
    # 0 x inf is 0: an unchanged input changes nothing, however steep the function.
    return jnp.where(change == 0.0, 0.0, slope * change)


@jax.custom_jvp
def found_by_search(value: Values, moved: Values, slope: Values = 1.0) -> Values:
    """Give a value that a search found, together with its derivative.

    Args:
        value: result of the search, whose own derivative does not count.
        moved: quantity that the result follows.
        slope: derivative of the result with respect to that quantity.
    """
    return value


@found_by_search.defjvp
def _found_by_search_jvp(numbers, changes):
    value, _, slope = numbers
    return value, _product(slope, changes[1])


@jax.custom_jvp
def root(x: Values) -> Values:
    """Square root of `max(x, 0)`; its derivative at 0 is infinite where x changes, and
    0 where it does not."""
    return jnp.sqrt(jnp.maximum(x, 0.0))


@root.defjvp
def _root_jvp(numbers, changes):
    (x,), (change,) = numbers, changes
    value = root(x)
    return value, _product(jnp.where(x < 0.0, 0.0, 0.5 / value), change)


class Carried(NamedTuple):
    """Numbers of many blocks, and the derivatives that they carry."""

    value: Any
    """Tree of arrays `(blocks,)`, or with more axes behind."""
    tangent: Any = None
    """Tree of the same structure, its arrays with an axis of the parameters in front;
    None where no derivatives are carried."""

    def at(self, *index: np.ndarray) -> "Carried":
        """Select blocks, or whatever the last axes of all arrays are of."""
        return self.map(lambda tree: jax.tree.map(lambda leaf: leaf[..., *index], tree))

    def put(self, lanes: np.ndarray, new: "Carried") -> None:
        """Set some blocks in all arrays."""
        own, other = jax.tree.leaves(self), jax.tree.leaves(new)
        for leaf, values in zip(own, other, strict=True):
            leaf[..., lanes] = values

    def map(self, function: Callable, of_tangent: Callable | None = None) -> "Carried":
        """Apply a linear function to the tree and to that of the derivatives, to which
        another may be applied in its place."""
        if self.tangent is None:
            return Carried(function(self.value))
        return Carried(function(self.value), (of_tangent or function)(self.tangent))

    def copy(self) -> "Carried":
        """Copy all arrays."""
        return self.map(lambda tree: jax.tree.map(np.copy, tree))

    def part(self, name: str) -> "Carried":
        """Take a field of the tree."""
        return self.map(lambda tree: getattr(tree, name))

    def split(self) -> "tuple[Carried, ...]":
        """Take a tuple of trees apart."""
        if self.tangent is None:
            return tuple(Carried(value) for value in self.value)
        return tuple(map(Carried, self.value, self.tangent))


def call(program: ClosedProgram, *inputs) -> Carried:
    """Compute a program's results, with derivatives if any input carries them.

    Values are the same with and without derivatives, to the last bit.

    Args:
        inputs: `Carried`, or trees of arrays without derivatives.
    """
    carried = [x if isinstance(x, Carried) else Carried(x) for x in inputs]
    values = tuple(x.value for x in carried)
    tangents = tuple(x.tangent for x in carried)
    found = program(*values)
    if all(tangent is None for tangent in tangents):
        return Carried(found)
    return Carried(found, program.along(values, tangents))

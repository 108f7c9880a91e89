"""Numbers of impacts, differentiable in both modes, whatever JAX does around them.

On a CPU the machine code computes them, as an operation of JAX (`operation`); for laws
that have none, and on other devices, XLA's program of the model does. That integrates
with diffrax, and is also the second way, by which the machine code can be checked.

The derivative is taken forward through the integration, for those inputs only that are
being differentiated (`jax.custom_jvp` with symbolic zeros). What remains is linear, so
JAX can transpose it: `jax.grad` costs as much as `jax.jacfwd` does, in proportion to
the number of parameters that vary.
"""

import concurrent.futures
import functools
import math
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from diffrax import AbstractAdaptiveSolver
from jax.custom_derivatives import SymbolicZero

from .._jax_internals import Tracer, namespace_of
from ..accuracy import Accuracy
from ..mechanics.model import MODELS, exact_models
from ..mechanics.problem import Assembly, pose
from ..precision import float64_leaf
from ..scene import Scene
from ..solver.any_solver import require_derivatives
from ..solver.integration import integrate
from ..solver.lanes import march, start_lanes
from ..summary import Numbers, numbers_of_no_value, summarise, summarise_lanes
from .compilation import unfused_jit
from .machine import compile_native, compile_native_along, computes_on_cpu
from .native import Kernel
from .operation import Operation, call, register
from .selection import MACHINE_CODE, Engine
from .threads import thread_count

MOST_DIRECTIONS = 3
"""Derivatives that share a run of an impact. Each costs some two thirds of the value;
more of them take longer to compile than they save."""


class Given(NamedTuple):
    """What is known of scenes before they are computed."""

    structure: jax.tree_util.PyTreeDef
    """Of the scene: its laws and shapes, without the numbers."""
    ledger: bool
    places: tuple[int, ...]
    """Of the leaves that are not known yet, or are arrays."""
    rest: np.ndarray
    """All other leaves, each at its place, then tolerance and floor. They stay known
    inside of `jax.jit`, and a single array is quicker to hand over than thirty."""
    engine: Engine

    def leaves(self, values: list) -> list:
        """Leaves of the scene, with the values of those at `places`."""
        leaves = list(self.rest[:-2])
        for place, value in zip(self.places, values, strict=True):
            leaves[place] = value
        return leaves

    @property
    def number_structure(self) -> jax.tree_util.PyTreeDef:
        return _number_structure(self.ledger)


@functools.cache
def _number_structure(ledger: bool):
    return jax.tree.structure(numbers_of_no_value(ledger))


def solve(
    structure,
    leaves,
    accuracy: Accuracy,
    ledger: bool,
    engine: Engine = Engine(MACHINE_CODE),  # noqa: B008
) -> Numbers:
    """Numbers of impacts, by the cheapest model that is exact for each.

    Args:
        structure, leaves: of a scene. Leaves are arrays that broadcast, whose shape the
            numbers have.
        ledger: also keep the energy ledger.
        engine: what computes them.
    """
    places, rest = [], np.empty(len(leaves) + 2)
    rest[-2:] = accuracy.tolerance, accuracy.floor
    for place, leaf in enumerate(leaves):
        if isinstance(leaf, Tracer) or np.ndim(leaf):
            places.append(place)
            rest[place] = np.nan
        else:
            rest[place] = leaf
    # Whoever puts leaves in place by himself may put numbers of another type.
    values = [_float64(leaves[place]) for place in places]
    given = Given(structure, ledger, tuple(places), rest, engine)
    if any(isinstance(value, Tracer) for value in values):
        return _solve(given, values)
    # Nothing to differentiate: half the time of a call would go into asking.
    return _values(given, values)


def _float64(leaf):
    return leaf if leaf.dtype == np.float64 else float64_leaf(leaf)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _solve(given: Given, values: list) -> Numbers:
    return _values(given, values)


@functools.partial(_solve.defjvp, symbolic_zeros=True)
def _solve_jvp(given: Given, primals, tangents):
    (values,), (steps,) = primals, tangents
    varied = [k for k, s in enumerate(steps) if not isinstance(s, SymbolicZero)]
    if not varied:
        numbers = _values(given, values)
        return numbers, jax.tree.map(jnp.zeros_like, numbers)
    numbers, columns = _columns(given, values, [given.places[k] for k in varied])
    changes = _along(columns, [steps[k] for k in varied])
    return numbers, jax.tree.unflatten(given.number_structure, changes)


@jax.jit
def _along(columns: list, steps: list) -> list:
    """Change of each number, by steps of the leaves. (`jit`: one operation in place of
    hundreds where it is called outside.)

    Args:
        columns: for each step, the derivatives of all numbers by it.
    """
    return [
        sum(column[k] * step for column, step in zip(columns, steps, strict=True))
        for k in range(len(columns[0]))
    ]


def _values(given: Given, values: list) -> Numbers:
    """Numbers alone."""
    chosen = _choose(given, values, [], 0)
    if chosen is None:
        return _by_xla(given, values, [])
    operation, *turn = chosen
    rows, _ = _call(operation, (), given.places, given.rest, values, *turn)
    return jax.tree.unflatten(given.number_structure, rows)


def _columns(given: Given, values: list, varied: list[int]):
    """Numbers, and for each of the leaves named in `varied` the derivatives of all
    numbers by it, on a first axis."""
    numbers, by_leaf = None, {}
    for group in _by_model(given, varied):
        found = _columns_of_group(given, values, group)
        numbers = found[0] if numbers is None else numbers
        by_leaf |= zip(group, found[1], strict=True)
    return numbers, [by_leaf[place] for place in varied]


def _by_model(given: Given, varied: list[int]) -> list[list[int]]:
    """The leaves in groups by the models that derivatives need.

    Derivatives by what may leave the symmetry need the planar model, and those by
    damping ratios dashpots; the others need no more than the value does.
    """
    posture, damping, others = _groups(given.structure)
    groups = (
        [place for place in varied if place in group]
        for group in (others, posture, damping)
    )
    return [group for group in groups if group]


def _columns_of_group(given: Given, values: list, varied: list[int]):
    # One code to compile for two and for more
    directions = 1 if len(varied) == 1 else MOST_DIRECTIONS
    chosen = _choose(given, values, varied, directions)
    if chosen is None:
        return _by_xla(given, values, varied)
    operation, *turn = chosen
    rows, columns = None, []
    for first in range(0, len(varied), directions):
        along = varied[first : first + directions]
        padded = (*along, *[-1] * (directions - len(along)))
        known = padded, given.places, _Unhashed(given.rest)
        rows, found = _first_order(operation, *known, values, *turn)
        columns += [found[k] for k in range(len(along))]
    return jax.tree.unflatten(given.number_structure, rows), columns


@functools.partial(jax.jit, static_argnums=(0, 1, 2), inline=True)
def _call(operation: Operation, along, places, rest, values, effort, program):
    """Rows of numbers, and their derivatives along the directions: one array with axes
    of directions and of rows first."""
    rows = call(operation, rest, places, values, effort, program, along)
    if not along:
        return rows, None
    count = operation.result_rows // (1 + len(along))
    columns = jnp.stack(rows[count:]).reshape(len(along), count, *rows[0].shape)
    return rows[:count], columns


class _Unhashed:
    """What goes through `custom_jvp` as it stands."""

    def __init__(self, value):
        self.value = value


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 1, 2, 3))
def _first_order(operation, along, places, rest, values, effort, program):
    return _call(operation, along, places, rest.value, values, effort, program)


@functools.partial(_first_order.defjvp, symbolic_zeros=True)
def _no_second_order(operation, along, places, rest, primals, tangents):
    if not all(isinstance(t, SymbolicZero) for t in jax.tree.leaves(tangents)):
        raise NotImplementedError(
            "second derivatives of an impact are asked for, but the machine code has "
            "first ones alone: take the products of first derivatives (Gauss and "
            "Newton's Hessian) or differences of gradients"
        )
    found = _call(operation, along, places, rest.value, *primals)
    return found, jax.tree.map(jnp.zeros_like, found)


def _choose(given: Given, values: list, varied: list[int], directions: int):
    """The operation, the effort of each lane and the place of its kernel; None where
    there is no machine code, or none is asked for."""
    if not (given.engine.is_machine_code and computes_on_cpu()):
        return None
    # A derivative leaves the symmetry that a cheaper model rests on.
    known = [x if isinstance(x, Tracer) else np.asarray(x) for x in values]
    leaves = given.leaves(known)
    many = any(isinstance(x, Tracer) or x.ndim for x in known)
    if many:
        scene = jax.tree.unflatten(given.structure, leaves)
        for place in varied:
            leaves[place] = np.nan
        models, possible = exact_models(jax.tree.unflatten(given.structure, leaves))
    else:
        models, possible = _exact_model(
            given.structure,
            tuple(
                math.nan if place in varied else float(leaves[place])
                for place in _deciding(given.structure)
            ),
        )
    operation = _operation(given.structure, given.ledger, tuple(possible), directions)
    if operation is None:
        return None
    programs = sum(((models > place) * 1.0 for place in possible[:-1]), 0.0)
    return operation, _effort(scene) if many else 0.0, programs


@functools.lru_cache(maxsize=256)
def _deciding(structure) -> tuple[int, ...]:
    """The leaves of a scene that decide which model is exact."""
    posture, damping, _ = _groups(structure)
    return tuple(sorted(posture | damping))


@functools.lru_cache(maxsize=1024)
def _exact_model(structure, deciding: tuple[float, ...]):
    """`exact_models` of a single impact, by the values that decide."""
    leaves = [np.nan] * structure.num_leaves
    for place, value in zip(_deciding(structure), deciding, strict=True):
        leaves[place] = np.float64(value)
    return exact_models(jax.tree.unflatten(structure, leaves))


@functools.lru_cache(maxsize=256)
def _groups(structure) -> tuple[set[int], set[int], set[int]]:
    """Leaves of a scene: those that may leave the symmetry, of dashpots, others."""
    scene = jax.tree.unflatten(structure, range(structure.num_leaves))
    posture = {*jax.tree.leaves((scene.block.shape, scene.impact))}
    posture -= {scene.impact.speed}
    damping = {*jax.tree.leaves(scene.soil.damping)}
    return posture, damping, {*range(structure.num_leaves)} - posture - damping


def _effort(scene: Scene):
    """What puts the longest contacts first, as `order_by_effort` does."""
    block, impact = scene.block, scene.impact
    xp = namespace_of(*jax.tree.leaves(scene))
    size = xp.cbrt(block.mass / block.density)
    return impact.speed * xp.cos(impact.angle) / xp.sqrt(size)


_operations: dict[tuple, Operation] = {}


def _operation(
    structure, ledger: bool, possible: tuple[int, ...], directions: int
) -> Operation | None:
    """The operation for the models that there may be."""
    key = structure, ledger, possible, directions
    if key not in _operations:

        def compiled(place: int) -> Kernel | None:
            assembly = Assembly(structure, MODELS[place], ledger)
            # What the caller has set in a `with` is not set in another thread.
            with jax.enable_x64(True):
                if directions:
                    return compile_native_along(assembly, directions)
                return compile_native(assembly)

        # At once, since LLVM leaves other threads of Python alone; the dearest first.
        with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
            kernels = list(pool.map(compiled, reversed(possible)))[::-1]
        if None in kernels:
            return None
        _operations[key] = register(kernels, directions)
    return _operations[key]


def compute(
    assembly: Assembly,
    scene: Scene,
    tolerance,
    floor,
    solver: AbstractAdaptiveSolver | None = None,
) -> Numbers:
    """Numbers of one impact: pure, differentiable in forward mode.

    Args:
        solver: as an `Engine` has it.
    """
    problem, vector = pose(scene, assembly, tolerance, floor)
    return summarise(scene, problem, integrate(problem, vector, solver))


def compute_lanes(assembly: Assembly, scenes: Scene, tolerance, floor) -> Numbers:
    """Numbers of many impacts side by side, to the slowest; scene fields are
    `(lanes,)`.

    Pure, differentiable in forward mode.
    """
    lanes = march(start_lanes(assembly, scenes, tolerance, floor))
    return summarise_lanes(scenes, lanes)


def _by_xla(given: Given, values: list, varied: list[int]):
    """Numbers, with leaves in `varied` also their derivatives, as `_columns` gives
    them, by XLA's program."""
    solver = given.engine.solver
    if varied:
        require_derivatives(solver)
    known = given.leaves([np.nan if isinstance(x, Tracer) else x for x in values])
    for place in varied:
        known[place] = np.nan
    known = [np.asarray(x) for x in known]
    _, possible = exact_models(jax.tree.unflatten(given.structure, known))
    assembly = Assembly(given.structure, MODELS[max(possible)], given.ledger)
    leaves, setting = given.leaves(values), given.rest[-2:]
    shape = np.broadcast_shapes(*map(np.shape, leaves))
    if not shape:
        return _in_xla(assembly, tuple(varied), solver, leaves, *setting)
    rows = [jnp.broadcast_to(leaf, shape).reshape(math.prod(shape)) for leaf in leaves]
    found = jax.vmap(
        lambda *row: _in_xla(assembly, tuple(varied), solver, row, *setting)
    )(*rows)
    if not varied:
        return jax.tree.map(lambda x: x.reshape(shape), found)
    numbers, columns = found
    columns = [jnp.moveaxis(column, 0, -1) for column in columns]
    columns = [column.reshape(len(column), *shape) for column in columns]
    return jax.tree.map(lambda x: x.reshape(shape), numbers), columns


def _compute_leaves(assembly, varied, solver, leaves, tolerance, floor):
    def of_varied(values):
        all_leaves = list(leaves)
        for place, value in zip(varied, values, strict=True):
            all_leaves[place] = value
        scene = jax.tree.unflatten(assembly.structure, all_leaves)
        numbers = compute(assembly, scene, tolerance, floor, solver)
        return jnp.stack(jax.tree.leaves(numbers)), numbers

    values = [leaves[place] for place in varied]
    if not varied:
        return of_varied(values)[1]
    columns, numbers = jax.jacfwd(of_varied, has_aux=True)(values)
    return numbers, columns


_in_xla = unfused_jit(_compute_leaves, static_argnums=(0, 1, 2))

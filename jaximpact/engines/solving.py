"""Numbers of impacts, differentiable in both modes, whatever JAX does around them.

On a CPU the machine code computes them, as an operation of JAX (`operation`); for laws
that have none, and on other devices, XLA's program of the model does.

The derivative is taken forward through the integration, for those inputs only that are
being differentiated (`jax.custom_jvp` with symbolic zeros). What remains is linear, so
JAX can transpose it: `jax.grad` costs as much as `jax.jacfwd` does, in proportion to
the number of parameters that vary.
"""

import functools
import math
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero

from .._jax_internals import Tracer, namespace_of
from ..accuracy import Accuracy
from ..mechanics.model import MODELS, exact_models
from ..mechanics.problem import Assembly, pose
from ..scene import Scene
from ..solver.integration import integrate
from ..solver.lanes import march, start_lanes
from ..summary import Numbers, numbers_of_no_value, summarise, summarise_lanes
from .compilation import unfused_jit
from .machine import compile_native, compile_native_along, computes_on_cpu
from .operation import Operation, call, register

MOST_DIRECTIONS = 3
"""Derivatives that share a run of an impact. Each costs some two thirds of the value;
more of them take longer to compile than they save."""


class Choice(NamedTuple):
    """What is computed of a scene."""

    structure: jax.tree_util.PyTreeDef
    """Of the scene: its laws and shapes, without the numbers."""
    ledger: bool


def solve(scene: Scene, accuracy: Accuracy, ledger: bool) -> Numbers:
    """Numbers of impacts, by the cheapest model that is exact for each.

    Args:
        scene: fields are arrays that broadcast, whose shape the numbers have.
        ledger: also keep the energy ledger.
    """
    leaves, structure = jax.tree.flatten(scene)
    choice = Choice(structure, ledger)
    setting = np.float64(accuracy.tolerance), np.float64(accuracy.floor)
    if any(isinstance(leaf, Tracer) for leaf in leaves):
        return _solve(choice, leaves, *setting)
    # Nothing to differentiate: half the time of a call would go into asking.
    return _values(choice, leaves, *setting)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _solve(choice: Choice, leaves: list, tolerance, floor) -> Numbers:
    return _values(choice, leaves, tolerance, floor)


@functools.partial(_solve.defjvp, symbolic_zeros=True)
def _solve_jvp(choice: Choice, primals, tangents):
    leaves, tolerance, floor = primals
    varied = tuple(
        place
        for place, tangent in enumerate(tangents[0])
        if not isinstance(tangent, SymbolicZero)
    )
    if not varied:
        numbers = _values(choice, leaves, tolerance, floor)
        return numbers, jax.tree.map(jnp.zeros_like, numbers)
    numbers, columns = _columns(choice, varied, leaves, tolerance, floor)
    return numbers, _along(columns, [tangents[0][place] for place in varied])


@jax.jit
def _along(columns: list[Numbers], steps: list) -> Numbers:
    """Change of the numbers, by steps of the leaves. (`jit`: one operation in place of
    hundreds where it is called outside.)"""

    def of_result(*derivatives):
        return sum(d * step for d, step in zip(derivatives, steps, strict=True))

    return jax.tree.map(of_result, *columns)


def _values(choice: Choice, leaves: list, tolerance, floor) -> Numbers:
    """Numbers alone."""
    chosen = _choose(choice, leaves, (), 0)
    if chosen is None:
        return _by_xla(choice, leaves, tolerance, floor)
    operation, *turn = chosen
    rows = _call(operation, (), [*leaves, tolerance, floor], *turn)
    return jax.tree.unflatten(_structure(choice.ledger), rows)


def _columns(choice: Choice, varied: tuple[int, ...], leaves, tolerance, floor):
    """Numbers, and a list of their derivatives by the leaves named in `varied`."""
    numbers, by_leaf = None, {}
    for group in _by_model(choice, varied):
        found = _columns_of_group(choice, group, leaves, tolerance, floor)
        numbers = found[0] if numbers is None else numbers
        by_leaf |= zip(group, found[1], strict=True)
    return numbers, [by_leaf[place] for place in varied]


def _by_model(choice: Choice, varied: tuple[int, ...]) -> list[tuple[int, ...]]:
    """The leaves in groups by the models that derivatives need.

    Derivatives by what may leave the symmetry need the planar model, and those by
    damping ratios dashpots; the others need no more than the value does.
    """
    places = range(choice.structure.num_leaves)
    scene = jax.tree.unflatten(choice.structure, places)
    posture = {*jax.tree.leaves((scene.block.shape, scene.impact))}
    posture -= {scene.impact.speed}
    damping = {*jax.tree.leaves(scene.soil.damping)}
    others = {*places} - posture - damping
    groups = (
        tuple(place for place in varied if place in group)
        for group in (others, posture, damping)
    )
    return [group for group in groups if group]


def _columns_of_group(
    choice: Choice, varied: tuple[int, ...], leaves, tolerance, floor
):
    # One code to compile for two and for more
    directions = 1 if len(varied) == 1 else MOST_DIRECTIONS
    chosen = _choose(choice, leaves, varied, directions)
    if chosen is None:
        return _by_xla(choice, leaves, tolerance, floor, varied)
    operation, *turn = chosen
    numbers, columns = None, []
    structure = jax.tree.structure((0, (0,) * directions))
    structure = structure.compose(_structure(choice.ledger))
    for first in range(0, len(varied), directions):
        along = varied[first : first + directions]
        padded = along + (-1,) * (directions - len(along))
        rows = _first_order(operation, padded, [*leaves, tolerance, floor], *turn)
        numbers, found = jax.tree.unflatten(structure, rows)
        columns += found[: len(along)]
    return numbers, columns


@functools.cache
def _structure(ledger: bool):
    return jax.tree.structure(numbers_of_no_value(ledger))


@functools.partial(jax.jit, static_argnums=(0, 1), inline=True)
def _call(operation: Operation, along: tuple[int, ...], inputs, effort, program):
    return call(operation, inputs, effort, program, along)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def _first_order(operation: Operation, along: tuple[int, ...], inputs, effort, program):
    return _call(operation, along, inputs, effort, program)


@functools.partial(_first_order.defjvp, symbolic_zeros=True)
def _no_second_order(operation, along, primals, tangents):
    if not all(isinstance(t, SymbolicZero) for t in jax.tree.leaves(tangents)):
        raise NotImplementedError(
            "second derivatives of an impact are asked for, but the machine code has "
            "first ones alone: take the products of first derivatives (Gauss and "
            "Newton's Hessian) or differences of gradients"
        )
    rows = _call(operation, along, *primals)
    return rows, [jnp.zeros_like(row) for row in rows]


def _choose(choice: Choice, leaves: list, varied: tuple[int, ...], directions: int):
    """The operation, the effort of each lane and the place of its kernel; None where
    there is no machine code."""
    if not computes_on_cpu():
        return None
    known = [leaf if isinstance(leaf, Tracer) else np.asarray(leaf) for leaf in leaves]
    scene = jax.tree.unflatten(choice.structure, known)
    # A derivative leaves the symmetry that a cheaper model rests on.
    differentiated = list(known)
    for place in varied:
        differentiated[place] = np.nan
    models, possible = exact_models(
        jax.tree.unflatten(choice.structure, differentiated)
    )
    operation = _operation(choice, tuple(possible), directions)
    if operation is None:
        return None
    programs = sum(((models > place) * 1.0 for place in possible[:-1]), 0.0)
    lanes = any(isinstance(x, Tracer) or x.ndim for x in known)
    return operation, _effort(scene) if lanes else 0.0, programs


def _effort(scene: Scene):
    """What puts the longest contacts first, as `order_by_effort` does."""
    block, impact = scene.block, scene.impact
    xp = namespace_of(*jax.tree.leaves(scene))
    size = xp.cbrt(block.mass / block.density)
    return impact.speed * xp.cos(impact.angle) / xp.sqrt(size)


_operations: dict[tuple, Operation] = {}


def _operation(
    choice: Choice, possible: tuple[int, ...], directions: int
) -> Operation | None:
    """The operation for the models that there may be."""
    key = choice, possible, directions
    if key not in _operations:
        kernels = []
        for place in possible:
            assembly = Assembly(choice.structure, MODELS[place], choice.ledger)
            if directions:
                kernels.append(compile_native_along(assembly, directions))
            else:
                kernels.append(compile_native(assembly))
            if kernels[-1] is None:
                return None
        _operations[key] = register(kernels, directions)
    return _operations[key]


def compute(assembly: Assembly, scene: Scene, tolerance, floor) -> Numbers:
    """Numbers of one impact: pure, differentiable in forward mode."""
    problem, vector = pose(scene, assembly, tolerance, floor)
    return summarise(scene, problem, integrate(problem, vector))


def compute_lanes(assembly: Assembly, scenes: Scene, tolerance, floor) -> Numbers:
    """Numbers of many impacts side by side, to the slowest; scene fields are
    `(lanes,)`.

    Pure, differentiable in forward mode.
    """
    lanes = march(start_lanes(assembly, scenes, tolerance, floor))
    return summarise_lanes(scenes, lanes)


def _by_xla(choice: Choice, leaves, tolerance, floor, varied=None):
    """Numbers, with `varied` also their derivatives, by XLA's program."""
    known = list(leaves)
    for place in varied or ():
        known[place] = np.nan
    known = [np.nan if isinstance(x, Tracer) else np.asarray(x) for x in known]
    _, possible = exact_models(jax.tree.unflatten(choice.structure, known))
    assembly = Assembly(choice.structure, MODELS[max(possible)], choice.ledger)
    shape = np.broadcast_shapes(*map(np.shape, leaves))
    if not shape:
        return _in_xla(assembly, varied, leaves, tolerance, floor)
    rows = [jnp.broadcast_to(leaf, shape).reshape(math.prod(shape)) for leaf in leaves]
    found = jax.vmap(lambda *row: _in_xla(assembly, varied, row, tolerance, floor))(
        *rows
    )
    return jax.tree.map(lambda x: x.reshape(shape), found)


def _compute_leaves(assembly, varied, leaves, tolerance, floor):
    if varied is None:
        scene = jax.tree.unflatten(assembly.structure, leaves)
        return compute(assembly, scene, tolerance, floor)

    def of_varied(values):
        all_leaves = list(leaves)
        for place, value in zip(varied, values, strict=True):
            all_leaves[place] = value
        numbers = _compute_leaves(assembly, None, all_leaves, tolerance, floor)
        return numbers, numbers

    columns, numbers = jax.jacfwd(of_varied, has_aux=True)(
        [leaves[place] for place in varied]
    )
    by_leaf = [
        jax.tree.map(lambda entry, k=k: entry[k], columns, is_leaf=_is_list)
        for k in range(len(varied))
    ]
    return numbers, by_leaf


def _is_list(value) -> bool:
    return isinstance(value, list)


_in_xla = unfused_jit(_compute_leaves, static_argnums=(0, 1))

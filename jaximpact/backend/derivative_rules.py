"""Numbers of impacts, differentiable in both modes, whatever JAX does around them.

On a CPU the machine code computes them, as an operation of JAX (`operation`); for laws
that have none, and on other devices, XLA's program of the model does. That integrates
with diffrax, and is also the second way, by which the machine code can be checked.

The derivative is taken forward through the integration, for those inputs only that are
being differentiated (`jax.custom_jvp` with symbolic zeros). What remains is linear, so
JAX can transpose it: `jax.grad` costs as much as `jax.jacfwd` does, in proportion to
the number of parameters that vary.
"""

import functools
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero
from jaxtyping import Array

from .._jax_internals import Tracer, is_inside_jit, namespace_of, number_in
from .._precision import float64_leaf
from .._transfers import own_transfers
from .._types import Structure
from ..accuracy import Accuracy
from ..errors import InputError
from ..identity import clear_when_edited, heed_edits, tracing
from ..impact.problem import Assembly, assemble
from ..impact.reduced_models import MODELS, exact_models
from ..impact.results import (
    History,
    ImpactSummary,
    Solution,
    empty_history,
    empty_summary,
    outside_contact,
)
from ..scene import Scene, shape_of
from . import NATIVE, Engine
from .native_backend import compile_native, compile_native_along, computes_on_cpu
from .operation import Operation, call, register

MOST_DIRECTIONS = 3
"""Derivatives that share a run of an impact. Each costs some two thirds of the value;
more of them take longer to compile than they save."""


class Given(NamedTuple):
    """Static description of the scenes to compute."""

    structure: Structure
    """Laws and shapes of the scene: its tree structure."""
    ledger: bool
    places: tuple[int, ...]
    """Indices of the leaves that are not known yet, or are arrays."""
    rest: np.ndarray
    """All other leaves, each at its place, then tolerance and floor. They stay known
    inside of `jax.jit`, and a single array is quicker to hand over than thirty."""
    engine: Engine
    sampled: bool = False
    """Whether a history is sampled at times that are asked for."""

    @property
    def place_of_times(self) -> int:
        """Index that stands for the times among the leaves: the one behind them."""
        return self.structure.num_leaves

    def leaves(self, values: list, unknown: Sequence[int] = ()) -> list:
        """Return the leaves of the scene, with the values of those at `places`, and
        with NaN for those that are not known."""
        leaves = list(self.rest[:-2])
        for place, value in zip(self.places, values, strict=True):
            leaves[place] = value
        for place in set(unknown) - {self.place_of_times}:
            leaves[place] = np.nan
        return leaves

    def solution(self, rows) -> Solution:
        """Return the results from their rows."""
        return jax.tree.unflatten(_structure(self.ledger, self.sampled), rows)


@functools.cache
def _structure(ledger: bool, sampled: bool):
    samples = empty_history(ledger) if sampled else None
    return jax.tree.structure(Solution(empty_summary(ledger), samples))


@own_transfers()
def solve(
    structure,
    leaves,
    accuracy: Accuracy,
    ledger: bool,
    engine: Engine = NATIVE,
) -> ImpactSummary:
    """Compute impacts, each by the cheapest model that is exact for it.

    Args:
        structure, leaves: of a scene. Leaves are arrays that broadcast, whose shape the
            numbers have.
        ledger: also keep the energy ledger.
        engine: what computes them.
    """
    return _solved(structure, leaves, accuracy, ledger, None, engine).numbers


@own_transfers()
def solve_at(
    structure, leaves, accuracy: Accuracy, ledger: bool, times: np.ndarray | Array
) -> tuple[ImpactSummary, History]:
    """Compute impacts and their histories at times, shape (..., times), whose leading
    axes broadcast with the leaves."""
    # Histories are NaN after the end on purpose, and padded by infinite times. What is
    # computed with them is checked again (`jax_debug_nans`).
    with jax.debug_nans(False), jax.debug_infs(False):
        return _solve_at(structure, leaves, accuracy, ledger, times)


def _solve_at(structure, leaves, accuracy: Accuracy, ledger: bool, times):
    solved = functools.partial(_solved, structure, leaves, accuracy, ledger)
    xp = namespace_of(times)
    order = xp.argsort(times, axis=-1)
    in_order = xp.take_along_axis(times, order, axis=-1)
    back = xp.argsort(order, axis=-1)
    if any(isinstance(x, Tracer) for x in (*leaves, times)):
        numbers, samples = solved(in_order)
        history = outside_contact(samples, numbers.outcome_code, in_order)
        if xp is jnp or np.any(order != np.arange(order.shape[-1])):
            history = _at_places(jnp, history, back)
        return numbers, history
    # Each number of times would be compiled for: there are more, by up to twice, of
    # which none comes.
    count = times.shape[-1]
    padded = np.full((*times.shape[:-1], 1 << max(count - 1, 0).bit_length()), np.inf)
    padded[..., :count] = in_order
    numbers, samples = solved(padded)
    history = outside_contact(samples, numbers.outcome_code, padded)
    history = _at_places(np, jax.tree.map(np.asarray, history), back)
    return numbers, jax.device_put(history)


@own_transfers()
def solve_recorded(
    scene: Scene, accuracy: Accuracy, engine: Engine = NATIVE
) -> tuple[ImpactSummary, History]:
    """Compute one impact with the energy ledger, and its history as NumPy arrays, with
    an entry for the start and each step.

    Raises ValueError under a JAX transformation, where the number of steps is not
    known, and InputError for many impacts.
    """
    if is_inside_jit(scene) or any(
        isinstance(leaf, Tracer) for leaf in jax.tree.leaves(scene)
    ):
        raise ValueError(
            "history=True cannot be used inside a JAX transformation, where the number "
            "of steps is not known; give the times that are wanted: save_at=times"
        )
    if shape_of(scene):
        raise InputError(
            "history=True records one impact, but the fields of the scene have the "
            f"shape {shape_of(scene)}; give the times that are wanted: save_at=times"
        )
    assembly = assemble(scene)
    kernel = None
    if engine.is_machine_code and computes_on_cpu():
        kernel = compile_native(assembly, sampled=True)
    if kernel is None:
        from .xla_backend import record_by_xla  # loads diffrax, which takes a while

        leaves, structure = jax.tree.flatten(scene)
        numbers = solve(structure, leaves, accuracy, True, engine)
        with tracing():
            return numbers, record_by_xla(scene, accuracy, engine.solver)
    inputs = [*jax.tree.leaves(scene), accuracy.tolerance, accuracy.floor]
    results, samples = kernel.workspace().record(np.array(inputs, float)[:, None])
    numbers = jax.tree.unflatten(kernel.structure, [row[0] for row in results])
    series = jax.tree.structure(empty_history(assembly.ledger))
    return jax.device_put(numbers), jax.tree.unflatten(series, list(samples))


def _at_places(xp, history: History, places) -> History:
    """Put the times of a history in another order, by NumPy or `jax.numpy`."""
    if places.ndim == 1:
        return jax.tree.map(lambda series: series[..., places], history)
    places = xp.broadcast_to(places, (*history.time.shape[:-1], places.shape[-1]))
    return jax.tree.map(
        lambda series: xp.take_along_axis(series, places, axis=-1), history
    )


def _solved(
    structure,
    leaves,
    accuracy: Accuracy,
    ledger: bool,
    times,
    engine: Engine = NATIVE,
) -> Solution:
    heed_edits(structure)
    places, rest = [], np.empty(len(leaves) + 2)
    rest[-2:] = accuracy.tolerance, accuracy.floor
    for place, leaf in enumerate(leaves):
        if isinstance(leaf, Tracer) or np.ndim(leaf):
            places.append(place)
            rest[place] = np.nan
        else:
            rest[place] = leaf
    # Whoever puts leaves in place by himself may put numbers of another type.
    values = [
        leaf if leaf.dtype == np.float64 else float64_leaf(leaf)
        for leaf in (leaves[place] for place in places)
    ]
    given = Given(structure, ledger, tuple(places), rest, engine, times is not None)
    if any(isinstance(value, Tracer) for value in (*values, times)):
        return _solve(given, values, times)
    # Nothing to differentiate: half the time of a call would go into asking.
    return _values(given, values, times)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _solve(given: Given, values: list, times) -> Solution:
    return _values(given, values, times)


@functools.partial(_solve.defjvp, symbolic_zeros=True)
def _solve_jvp(given: Given, primals, tangents):
    values, times = primals
    steps = dict(zip(given.places, tangents[0], strict=True))
    if given.sampled:
        steps[given.place_of_times] = tangents[1]
    steps = {k: s for k, s in steps.items() if not isinstance(s, SymbolicZero)}
    if not steps:
        solution = _values(given, values, times)
        return solution, jax.tree.map(jnp.zeros_like, solution)
    solution, columns = _columns(given, values, times, list(steps))
    if not given.sampled:
        of_numbers = [column for (column,) in columns]
        return solution, given.solution(_along(of_numbers, list(steps.values())))
    # No number changes with the times, and a sample with its own alone.
    by_time = steps.pop(given.place_of_times, None)
    of_numbers, of_samples = zip(*columns, strict=True)
    changes = _along(list(of_numbers[: len(steps)]), list(steps.values()))
    along_time = [jnp.expand_dims(step, -1) for step in steps.values()]
    along_time += [] if by_time is None else [by_time]
    if not steps:
        changes = [jnp.zeros_like(x) for x in jax.tree.leaves(solution.numbers)]
    of_samples = _along(list(of_samples), along_time)
    return solution, given.solution([*changes, *of_samples])


@jax.jit
def _along(columns: list, steps: list) -> list:
    """Change of each result with steps of the leaves.

    Args:
        columns: for each step, the derivatives of all results with respect to it.
    """
    # `jit` makes it one operation in place of hundreds where it is called outside.
    if not columns:
        return []
    return [
        sum(column[k] * step for column, step in zip(columns, steps, strict=True))
        for k in range(len(columns[0]))
    ]


def _values(given: Given, values: list, times) -> Solution:
    """Return the results without derivatives."""
    chosen = _choose(given, values, [], 0)
    if chosen is None:
        return _by_xla(given, values, times, [])
    operation, *turn = chosen
    rows, _ = _call(operation, (), given.places, given.rest, values, *turn, times)
    return given.solution(rows)


def _columns(given: Given, values: list, times, varied: list[int]) -> tuple[Any, Any]:
    """Results, and for each of the leaves in `varied` the derivatives of all results,
    and of all samples, with respect to it, on a first axis."""
    posture, damping, others = _groups(given.structure)
    solution, by_leaf = None, {}
    # Derivatives with respect to a leaf that may break the symmetry need the planar
    # model, with respect to damping ratios dashpots; the others need no more than the
    # value does.
    for group in (others | {given.place_of_times}, posture, damping):
        if of_group := [place for place in varied if place in group]:
            found = _columns_of_group(given, values, times, of_group)
            solution = found[0] if solution is None else solution
            by_leaf |= zip(of_group, found[1], strict=True)
    return solution, [by_leaf[place] for place in varied]


def _columns_of_group(given: Given, values: list, times, varied: list[int]):
    # One code to compile for two and for more
    directions = 1 if len(varied) == 1 else MOST_DIRECTIONS
    chosen = _choose(given, values, varied, directions)
    if chosen is None:
        return _by_xla(given, values, times, varied)
    operation, *turn = chosen
    rows, columns = None, []
    for first in range(0, len(varied), directions):
        along = varied[first : first + directions]
        padded = (*along, *[-1] * (directions - len(along)))
        known = padded, given.places, _Unhashed(given.rest)
        rows, found = _first_order(operation, *known, values, *turn, times)
        columns += [tuple(part[k] for part in found) for k in range(len(along))]
    return given.solution(rows), columns


@functools.partial(jax.jit, static_argnums=(0, 1, 2), inline=True)
def _call(operation: Operation, along, places, rest, values, effort, program, times):
    """Compute rows of numbers, then of samples, and the derivatives of either along the
    directions: an array with axes of directions and of rows first."""
    results = call(operation, rest, places, values, effort, program, along, times)
    if not along:
        return results, None
    rows, columns = [], []
    for part in results[: operation.result_rows], results[operation.result_rows :]:
        count = len(part) // (1 + len(along))
        if count:
            shape = len(along), count, *part[0].shape
            found = jnp.stack(part[count:]).reshape(shape)
            columns.append(_of_numbers(values, part[:count], found, bool(columns)))
        rows += part[:count]
    return rows, columns


def _of_numbers(values: list, rows: list, columns: Array, sampled: bool) -> Array:
    """Return derivatives, those of NaN as they have to be: NaN if an input is NaN, and
    else 0, that of no number.

    The integration gives what it has come to. An impact that failed, and a time after
    the end, must not spoil the derivatives of others: in reverse mode 0 times NaN is
    NaN, also for who leaves them out.

    Args:
        values: inputs.
        rows: results, whose derivatives the columns are, along their last axes.
        sampled: whether the rows are samples, which have an axis of times.
    """
    of_nan: Any = 0.0
    for value in values:
        missing = jnp.isnan(value[..., None] if sampled else value)
        of_nan = jnp.where(missing, jnp.nan, of_nan)
    return jnp.where(jnp.isnan(jnp.stack(rows)), of_nan, columns)


class _Unhashed:
    """Wrapper that passes an array through `custom_jvp` unhashed."""

    def __init__(self, value):
        self.value = value


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 1, 2, 3))
def _first_order(operation, along, places, rest, values, effort, program, times):
    return _call(operation, along, places, rest.value, values, effort, program, times)


@functools.partial(_first_order.defjvp, symbolic_zeros=True)
def _no_second_order(operation, along, places, rest, primals, tangents):
    if not all(isinstance(t, SymbolicZero) for t in jax.tree.leaves(tangents)):
        raise NotImplementedError(
            "second derivatives of an impact are asked for, but the machine code has "
            "first ones alone: take J.T @ J of the residuals, or wrap your function "
            "in jaximpact.with_second_derivatives, which takes differences "
            '(documentation: "Optimisers of SciPy")'
        )
    found = _call(operation, along, places, rest.value, *primals)
    return found, jax.tree.map(jnp.zeros_like, found)


def _choose(given: Given, values: list, varied: list[int], directions: int):
    """Choose the operation, and give the effort of each lane and the index of its
    kernel; None where there is no machine code, or none is asked for."""
    if not (given.engine.is_machine_code and computes_on_cpu()):
        return None
    # A derivative leaves the symmetry that a cheaper model rests on.
    known = [x if isinstance(x, Tracer) else np.asarray(x) for x in values]
    leaves = given.leaves(known)
    many = any(isinstance(x, Tracer) or x.ndim for x in known)
    if many:
        scene = jax.tree.unflatten(given.structure, leaves)
        # What is one number for all lanes decides as that number does.
        known = [number_in(x) if isinstance(x, Tracer) else x for x in known]
        leaves = given.leaves(known, varied)
        models, possible = exact_models(jax.tree.unflatten(given.structure, leaves))
    else:
        models, possible = _exact_model(
            given.structure,
            tuple(
                math.nan if place in varied else float(leaves[place])
                for place in _deciding(given.structure)
            ),
        )
    key = given.structure, given.ledger, given.sampled
    operation = _operation(*key, tuple(possible), directions)
    if operation is None:
        return None
    programs = sum(((models > place) * 1.0 for place in possible[:-1]), 0.0)
    return operation, effort(scene) if many else 0.0, programs


@functools.lru_cache(maxsize=256)
def _deciding(structure) -> tuple[int, ...]:
    """Choose the leaves of a scene that decide which model is exact."""
    posture, damping, _ = _groups(structure)
    return tuple(sorted(posture | damping))


@functools.lru_cache(maxsize=1024)
def _exact_model(structure, deciding: tuple[float, ...]):
    """`exact_models` of a single impact, by the values that decide."""
    leaves = [np.nan] * structure.num_leaves
    for place, value in zip(_deciding(structure), deciding, strict=True):
        leaves[place] = np.float64(value)
    return exact_models(jax.tree.unflatten(structure, leaves))


clear_when_edited(_exact_model.cache_clear)


@functools.lru_cache(maxsize=256)
def _groups(structure) -> tuple[set[int], set[int], set[int]]:
    """Return the leaves of a scene: those that may leave the symmetry, of dashpots,
    others."""
    scene = jax.tree.unflatten(structure, range(structure.num_leaves))
    posture = {*jax.tree.leaves((scene.block.shape, scene.impact))}
    posture -= {scene.impact.speed}
    damping = {*jax.tree.leaves(scene.soil.damping)}
    return posture, damping, {*range(structure.num_leaves)} - posture - damping


def effort(scene: Scene):
    """Compute a number that is larger for shorter contacts, to begin the longest ones
    first, so that few lanes stand empty at the end.

    Contacts are long where the speed into the ground is small beside what gravity gives
    over the size of a block.
    """
    block, impact = scene.block, scene.impact
    xp = namespace_of(*jax.tree.leaves(scene))
    size = xp.cbrt(block.mass / block.density)
    return impact.speed * xp.cos(impact.angle) / xp.sqrt(size)


_operations: dict[tuple, Operation] = {}
clear_when_edited(_operations.clear)


def _operation(
    structure, ledger: bool, sampled: bool, possible: tuple[int, ...], directions: int
) -> Operation | None:
    """Operation for a set of models."""
    key = structure, ledger, sampled, possible, directions
    if key not in _operations:
        kernels = []
        # One after the other: LLVM is called by one thread at a time (llvmlite).
        for place in possible:
            assembly = Assembly(structure, MODELS[place], ledger)
            if directions:
                kernel = compile_native_along(assembly, directions, sampled)
            else:
                kernel = compile_native(assembly, sampled)
            if kernel is None:
                return None
            kernels.append(kernel)
        _operations[key] = register(kernels, directions)
    return _operations[key]


def _by_xla(given: Given, values: list, times, varied: list[int]) -> Any:
    """Return the results by XLA's program, with leaves in `varied` also their
    derivatives, as `_columns` gives them."""
    from .xla_backend import in_xla  # loads diffrax, which takes a while

    known = [np.nan if isinstance(x, Tracer) else x for x in values]
    known = [np.asarray(x) for x in given.leaves(known, varied)]
    scene = jax.tree.unflatten(given.structure, known)
    _, possible = exact_models(scene)
    assembly = Assembly(given.structure, MODELS[max(possible)], given.ledger)
    leaves, (tolerance, floor) = given.leaves(values), given.rest[-2:]
    solver = given.engine.solver
    with tracing():
        found = in_xla(assembly, tuple(varied), solver, leaves, tolerance, floor, times)
    if not varied:
        return found
    solution, columns = found
    parts = [jax.tree.leaves(part) for part in solution if part is not None]
    return solution, [
        tuple(
            _of_numbers(values, rows, part, sampled == 1)
            for sampled, (rows, part) in enumerate(zip(parts, column, strict=True))
        )
        for column in columns
    ]

"""Numbers of impacts, differentiable in both modes, whatever JAX does around them.

The derivative is taken for those inputs only that are being differentiated
(`jax.custom_jvp` with symbolic zeros). Of up to six it is taken forward through the
integration, one by one. What remains is linear, so that JAX can transpose it:
`jax.grad` costs as much as `jax.jacfwd` does, in proportion to their number. Of more
(`many_leaves`) a gradient takes one run in reverse mode, at the cost of six values.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero
from jaxtyping import Array

from .._jax_internals import (
    Tracer,
    is_differentiated,
    is_inside_jit,
    known_primals,
    namespace_of,
)
from .._settings import own_settings
from ..accuracy import Accuracy
from ..errors import InputError
from ..identity import tracing
from ..impact.problem import assemble
from ..impact.results import (
    History,
    ImpactSummary,
    Solution,
    empty_history,
    outside_contact,
)
from ..scene import Scene, shape_of
from . import NATIVE, Engine
from .known_results import results_of
from .many_leaves import are_many, change_of_rows
from .native_backend import compile_side_by_side, computes_on_cpu
from .request import Request, request, row_of
from .rows import columns_of, refuse_second_order, values_of
from .simd import KernelSet


@own_settings()
def solve(
    structure,
    leaves,
    accuracy: Accuracy,
    ledger: bool,
    engine: Engine = NATIVE,
) -> ImpactSummary:
    """Compute impacts, each by the cheapest model that is exact for it. Leaves are
    arrays that broadcast, whose shape the numbers have."""
    return _solved(structure, leaves, accuracy, ledger, None, engine).numbers


@own_settings()
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


@own_settings()
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
        (kernel,) = compile_side_by_side([assembly], sampled=True)
    if kernel is None:
        from .xla_backend import record_by_xla  # loads diffrax, which takes a while

        leaves, structure = jax.tree.flatten(scene)
        numbers = solve(structure, leaves, accuracy, True, engine)
        with tracing():
            return numbers, record_by_xla(scene, accuracy, engine.solver)
    inputs = [*jax.tree.leaves(scene), accuracy.tolerance, accuracy.floor]
    results, samples = KernelSet([kernel]).record(np.array(inputs, float))
    numbers = jax.tree.unflatten(kernel.structure, list(results))
    series = jax.tree.structure(empty_history(assembly.ledger is True))
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
    sampled = times is not None
    wanted, values = request(structure, leaves, accuracy, ledger, engine, sampled)
    if any(isinstance(value, Tracer) for value in (*values, times)):
        known = None if sampled else known_primals(values)
        of_values = zip(wanted.places, values, strict=True)
        varied = {place: x for place, x in of_values if isinstance(x, Tracer)}
        if known is not None and not are_many(wanted, known, [*varied]):
            return wanted.solution(_known_rows(wanted, varied, known))
        return wanted.solution(_rows_of(*_solve(wanted, values, times)))
    # Nothing to differentiate: half the time of a call would go into asking. Handing
    # over the numbers of a single impact one by one would take as long as the impact.
    if not (values or sampled):
        return values_of(wanted, [], None, in_jax=True)
    return jax.device_put(values_of(wanted, values, times, in_jax=False))


def _known_rows(wanted: Request, varied: dict[int, Tracer], known: list) -> list[Array]:
    """Compute rows of numbers where JAX differentiates outside of `jit`: all is known,
    and rows and derivatives are computed without JAX."""
    known = [np.asarray(value) for value in known]
    solution, columns = columns_of(wanted, known, None, list(varied), in_jax=False)
    rows = np.array(jax.tree.leaves(solution))
    columns = [np.asarray(column) for (column,) in columns]
    return results_of(list(varied.values()), rows, columns)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _solve(wanted: Request, values: list, times) -> list[Array]:
    """Return the rows of numbers as one array, and those of samples, if there are any,
    as another: of each array that JAX differentiates outside of `jit` it asks much."""
    return _stacked(values_of(wanted, values, times, in_jax=True))


@functools.partial(_solve.defjvp, symbolic_zeros=True)
def _solve_jvp(wanted: Request, primals, tangents):
    values, times = primals
    steps = dict(zip(wanted.places, tangents[0], strict=True))
    if wanted.sampled:
        steps[wanted.place_of_times] = tangents[1]
    steps = {k: s for k, s in steps.items() if not isinstance(s, SymbolicZero)}
    if any(map(is_differentiated, (*values, times))):
        refuse_second_order()
    in_jax = any(isinstance(value, Tracer) for value in (*values, times))
    if not in_jax:  # a tenth of the time of an operation of JAX
        values, times = jax.tree.map(np.asarray, (values, times))
    if not steps:
        rows = _stacked(values_of(wanted, values, times, in_jax))
        return rows, [jnp.zeros_like(part) for part in rows]
    if are_many(wanted, values, list(steps)):
        if in_jax:
            rows = _solve(wanted, values, times)
            length = rows[0][row_of(wanted, "steps")]
        else:
            solution = values_of(wanted, values, times, in_jax)
            rows, length = _stacked(solution), solution.numbers.steps
        return rows, [change_of_rows(wanted, values, length, steps)]
    solution, columns = columns_of(wanted, values, times, list(steps), in_jax)
    rows = _stacked(solution)
    if not in_jax:  # what is transposed later is outside of `own_settings`
        columns = jax.device_put(columns)
    if not wanted.sampled:
        of_numbers = [column for (column,) in columns]
        return rows, [_along(of_numbers, list(steps.values()))]
    # No number changes with the times, and a sample with its own alone.
    by_time = steps.pop(wanted.place_of_times, None)
    of_numbers, of_samples = zip(*columns, strict=True)
    along_time = [jnp.expand_dims(step, -1) for step in steps.values()]
    along_time += [] if by_time is None else [by_time]
    changes = jnp.zeros_like(rows[0])
    if steps:
        changes = _along(list(of_numbers[: len(steps)]), list(steps.values()))
    return rows, [changes, _along(list(of_samples), along_time)]


def _stacked(solution: Solution) -> list[Array]:
    """Return the rows of numbers, and of samples, as an array each."""
    parts = [jax.tree.leaves(part) for part in solution if part is not None]
    return [jnp.asarray(namespace_of(*part).stack(part)) for part in parts]


# `jit` makes one operation in place of many of what is called outside of it.
@jax.jit
def _rows_of(*parts: Array) -> list[Array]:
    return [row for part in parts for row in part]


@jax.jit
def _along(columns: list[Array], steps: list) -> Array:
    """Compute the change of results with steps of the leaves; `columns` are, for each
    step, the derivatives of all results with respect to it."""
    changes = [column * step for column, step in zip(columns, steps, strict=True)]
    return functools.reduce(jnp.add, changes)

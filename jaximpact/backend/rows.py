"""Impacts as rows of numbers: results, and their derivatives by leaves of the scene.

The one function that computes impacts, whoever asks: `simulate` and what JAX makes of
it, batches, fits, elasticities and run-outs. It hands the lanes to the kernels that
`kernel_choice` has chosen: directly or, where JAX traces, as an operation of XLA
(`operation`). For laws that have no machine code, and on other devices, XLA's program
of the model does the work. That integrates with diffrax, and is also the second way, by
which the machine code can be checked.
"""

import concurrent.futures
import functools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NoReturn

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero

from .._jax_internals import Tracer, namespace_of
from ..accuracy import Accuracy
from ..identity import tracing
from ..impact.dynamics import LedgerItems
from ..impact.problem import Assembly
from ..impact.reduced_models import exact_for_all, exact_models
from ..impact.results import Solution
from . import MACHINE_CODE, XLA
from .kernel_choice import choose, groups_of_leaves
from .operation import call
from .request import Request, request
from .simd import MOST_DIRECTIONS, KernelSet, Mode
from .threads import thread_count

LANES_OF_XLA = 512
"""Impacts of a program of XLA where many are computed: fewer waste time on dispatch,
more on waiting for the slowest impact."""
LANES_AT_ONCE = 2_048
"""Impacts that a thread computes between two looks at progress: some 0.1 s, of which
0.3 % are spent waiting for the last ones."""


def compute_rows(
    structure,
    leaves: Sequence,
    accuracy: Accuracy,
    *,
    ledger: LedgerItems = False,
    varied: Sequence[int] = (),
) -> tuple[np.ndarray, np.ndarray]:
    """Compute impacts, on every core.

    Args:
        structure, leaves: of a scene: numbers, or arrays that broadcast to one shape.
        ledger: also keep the energy ledger, or the arm work of it.
        varied: indices of the leaves by which the results are differentiated.

    Returns:
        Results `(numbers, *shape)`, in the order of the leaves of an `ImpactSummary`,
        and their derivatives `(varied, numbers, *shape)`.
    """
    wanted, values = request(structure, leaves, accuracy, ledger)
    if not varied:
        rows = np.stack(jax.tree.leaves(values_of(wanted, values, None, False)))
        return rows, np.empty((0, *rows.shape))
    solution, columns = columns_of(wanted, values, None, list(varied), False)
    rows = np.stack(jax.tree.leaves(solution))
    return rows, np.stack([np.asarray(column) for (column,) in columns])


def in_parts(places: np.ndarray) -> Iterator[np.ndarray]:
    """Split many impacts, by their indices, into parts: after each of them progress is
    told and results are kept."""
    size = LANES_AT_ONCE * thread_count()
    for first in range(0, len(places), size):
        yield places[first : first + size]


def prepare(
    structure,
    leaves: Sequence,
    accuracy: Accuracy,
    *,
    ledger: LedgerItems = False,
    varied: Sequence[int] = (),
) -> str:
    """Compile what `compute_rows` needs, and return the name of what computes."""
    mode = Mode.FORWARD if varied else Mode.VALUES
    chosen = choose(*request(structure, leaves, accuracy, ledger), varied, mode)
    return XLA if chosen is None else MACHINE_CODE


def values_of(wanted: Request, values: list, times, in_jax: bool) -> Solution:
    """Compute results without derivatives: `in_jax`, where JAX may trace or
    differentiate; else values are known, and results are NumPy arrays."""
    chosen = choose(wanted, values, [])
    if chosen is None:
        return _by_xla(wanted, values, times, [], in_jax)
    kernels, *turn = chosen
    rows, _ = run_by(in_jax)(
        kernels, (), wanted.places, wanted.rest, values, *turn, times
    )
    return wanted.solution(rows)


def columns_of(
    wanted: Request, values: list, times, varied: list[int], in_jax: bool
) -> tuple[Any, Any]:
    """Compute results, and for each of the leaves in `varied` the derivatives of all
    results, and of all samples, with respect to it, on a first axis; see
    `values_of`."""
    posture, damping, others = groups_of_leaves(wanted.structure)
    solution, by_leaf = None, {}
    # Derivatives with respect to a leaf that may break the symmetry need the planar
    # model, with respect to damping ratios dashpots; the others need no more than the
    # value does.
    for group in (others | {wanted.place_of_times}, posture, damping):
        if of_group := [place for place in varied if place in group]:
            of_leaves = _columns_of_group(wanted, values, times, of_group, in_jax)
            solution = of_leaves[0] if solution is None else solution
            by_leaf |= zip(of_group, of_leaves[1], strict=True)
    return solution, [by_leaf[place] for place in varied]


def _columns_of_group(
    wanted: Request, values: list, times, varied: list[int], in_jax: bool
):
    chosen = choose(wanted, values, varied, Mode.FORWARD)
    if chosen is None:
        return _by_xla(wanted, values, times, varied, in_jax)
    kernels, *turn = chosen
    run, rows, columns = run_by(in_jax), None, []
    for first in range(0, len(varied), MOST_DIRECTIONS):
        along = tuple(varied[first : first + MOST_DIRECTIONS])
        inputs = wanted.places, wanted.rest, values, *turn, times
        rows, along_each = run(kernels.along(len(along)), along, *inputs)
        columns += [tuple(part[k] for part in along_each) for k in range(len(along))]
    return wanted.solution(rows), columns


def run_by(in_jax: bool) -> Callable:
    """Return the function by which kernels compute rows: `in_jax` or directly."""
    return _by_operation if in_jax else _directly


def _by_operation(
    kernels: KernelSet, along, places, rest, values, effort, program, times
):
    """Compute rows of numbers, then of samples, and the derivatives of either along the
    directions: an array with axes of directions and of rows first."""
    lanes = values, effort, program, times
    if not along:
        return _traced(kernels, along, places, rest, *lanes)
    return _first_order(kernels, along, places, _Unhashed(rest), *lanes)


def _directly(kernels: KernelSet, along, places, rest, values, effort, program, times):
    """Compute what `_by_operation` does from NumPy arrays, without JAX."""
    shape = np.broadcast_shapes(*map(np.shape, (*values, effort, program)))
    series = ()
    if times is not None:
        series = np.shape(times)[-1:]
        shape = np.broadcast_shapes(shape, np.shape(times)[:-1])
        times = np.broadcast_to(times, shape + series)
        times = times.reshape(math.prod(shape), *series)
    inputs = np.empty((len(values), *shape))
    for row, value in enumerate(values):
        inputs[row] = value
    results, samples = kernels.compute(
        inputs.reshape(len(values), math.prod(shape)),
        thread_count(),
        common=rest,
        places=places,
        effort=np.broadcast_to(effort, shape).ravel() if shape else None,
        program=np.broadcast_to(program, shape).ravel(),
        along=along,
        times=times,
    )
    parts = [results.reshape(len(results), *shape)]
    if samples is not None:
        parts.append(samples.reshape(len(samples), *shape, *series))
    return _split(along, values, parts, np.asarray)


def _split(along, values, parts: Sequence, stack: Callable):
    """Separate results from their derivatives along directions; the parts are rows of
    numbers, and of samples if there are any."""
    rows, columns = [], []
    for sampled, part in enumerate(parts):
        count = len(part) // (1 + len(along))
        rows.extend(part[:count])
        if along and count:
            along_each = stack(part[count:])
            along_each = along_each.reshape(len(along), count, *part[0].shape)
            known = stack(part[:count])
            columns.append(_of_numbers(values, known, along_each, sampled == 1))
    return rows, columns


@functools.partial(jax.jit, static_argnums=(0, 1, 2), inline=True)
def _traced(kernels, along, places, rest, values, effort, program, times):
    results = call(kernels, rest, places, values, effort, program, along, times)
    parts = results[: kernels.result_rows], results[kernels.result_rows :]
    return _split(along, values, parts, jnp.stack)


def _of_numbers(values: list, rows, columns, sampled: bool):
    """Return derivatives, those of NaN as they have to be: NaN if an input is NaN, and
    else 0, that of no number.

    The integration gives what it has come to. An impact that failed, and a time after
    the end, must not spoil the derivatives of others: in reverse mode 0 times NaN is
    NaN, also for who leaves them out.

    Args:
        columns: derivatives of the rows, along their last axes.
        sampled: whether the rows are samples, which have an axis of times.
    """
    xp, of_nan = namespace_of(*values, rows, columns), 0.0
    for value in values:
        missing = xp.isnan(value[..., None] if sampled else value)
        of_nan = xp.where(missing, xp.nan, of_nan)
    return xp.where(xp.isnan(rows), of_nan, columns)


class _Unhashed:
    """Wrapper that passes an array through `custom_jvp` unhashed."""

    def __init__(self, value):
        self.value = value


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 1, 2, 3))
def _first_order(kernels, along, places, rest, values, effort, program, times):
    return _traced(kernels, along, places, rest.value, values, effort, program, times)


@functools.partial(_first_order.defjvp, symbolic_zeros=True)
def _no_second_order(kernels, along, places, rest, primals, tangents):
    if not all(isinstance(t, SymbolicZero) for t in jax.tree.leaves(tangents)):
        refuse_second_order()
    results = _traced(kernels, along, places, rest.value, *primals)
    return results, jax.tree.map(jnp.zeros_like, results)


def refuse_second_order() -> NoReturn:
    """Raise NotImplementedError for derivatives of what has derivatives."""
    raise NotImplementedError(
        "second derivatives of an impact are asked for, or a derivative of one inside "
        "of another, but there are first ones alone: take J.T @ J of the residuals, or "
        "wrap your function in jaximpact.with_second_derivatives, which takes "
        "differences, and has no third ones (documentation: "
        '"Optimisers of SciPy")'
    )


@jax.custom_jvp
def _once(results):
    """Return results with derivatives, which are not differentiated again: steps of
    XLA's program have the widths that the value needs."""
    return results


@_once.defjvp
def _once_only(primals, tangents):
    refuse_second_order()


def _by_xla(
    wanted: Request, values: list, times, varied: list[int], in_jax: bool
) -> Any:
    """Compute by XLA's program, with leaves in `varied` also the derivatives, as
    `columns_of` gives them."""
    from .xla_backend import in_xla  # loads diffrax, which takes a while

    known = [np.nan if isinstance(x, Tracer) else x for x in values]
    known = [np.asarray(x) for x in wanted.leaves(known, varied)]
    scene = jax.tree.unflatten(wanted.structure, known)
    _, possible = exact_models(scene)
    assembly = Assembly(wanted.structure, exact_for_all(possible), wanted.ledger)
    program: Callable = functools.partial(
        in_xla, assembly, tuple(varied), wanted.engine.solver
    )
    leaves, (tolerance, floor) = wanted.leaves(values), wanted.rest[-2:]
    if in_jax:
        with tracing():
            results = program(leaves, tolerance, floor, times)
            results = _once(results) if varied else results
    else:
        results = _many_by_xla(program, leaves, (tolerance, floor), times)
    if not varied:
        return results
    solution, columns = results
    parts = [jax.tree.leaves(part) for part in solution if part is not None]
    stack = namespace_of(*jax.tree.leaves(solution)).stack
    return solution, [
        tuple(
            _of_numbers(values, stack(rows), part, sampled == 1)
            for sampled, (rows, part) in enumerate(zip(parts, column, strict=True))
        )
        for column in columns
    ]


def _many_by_xla(program: Callable, leaves: list, setting: tuple, times):
    """Compute arrays of impacts by a program of XLA, which then has one of few sizes,
    on every core."""
    of_times = () if times is None else np.shape(times)[:-1]
    shape = np.broadcast_shapes(of_times, *map(np.shape, leaves))
    lanes = math.prod(shape)
    if not shape or not lanes:
        with tracing():
            return program(leaves, *setting, times)
    rows = [np.broadcast_to(np.asarray(x), shape).reshape(lanes) for x in leaves]
    if times is not None:
        series = np.shape(times)[-1:]
        times = np.broadcast_to(times, shape + series).reshape(lanes, *series)
    width = min(LANES_OF_XLA, 1 << (lanes - 1).bit_length())

    def part(start: int):
        # Its last impacts fill the program up.
        chosen = np.minimum(np.arange(start, start + width), lanes - 1)
        at = None if times is None else times[chosen]
        return program([row[chosen] for row in rows], *setting, at)

    def joined(axis: int, *parts):
        whole = np.concatenate(parts, axis).take(range(lanes), axis)
        return whole.reshape(*whole.shape[:axis], *shape, *whole.shape[axis + 1 :])

    with tracing(), concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
        first = part(0)  # compiles what the others run
        parts = [first, *pool.map(part, range(width, lanes, width))]
    if isinstance(first, Solution):
        return jax.tree.map(functools.partial(joined, 0), *parts)
    solutions, columns = zip(*parts, strict=True)
    return (
        jax.tree.map(functools.partial(joined, 0), *solutions),
        jax.tree.map(functools.partial(joined, 1), *columns),
    )

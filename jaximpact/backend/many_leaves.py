"""Derivatives with respect to many leaves: two operations of JAX that are linear.

One gives the changes of all results with changes of the leaves, by one run of forward
mode along them. The other gives the gradient of a sum of results, by one run of reverse
mode. Each is the transpose of the other, so that `jax.jvp` and `jax.grad` take one run
each, however many leaves there are.

Of few leaves `derivative_rules` takes the derivatives one by one, with the values.
"""

import functools
from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import ShapedArray
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir
from jaxtyping import Array

from .._jax_internals import broadcast_shapes, namespace_of, vary_over_devices
from .._precision import handed_over
from .._settings import own_settings
from .._types import Structure
from ..identity import clear_when_edited, described, users_code
from ..impact.dynamics import LedgerItems
from ..impact.problem import Assembly, naming
from ..impact.reduced_models import PLANAR
from ..impact.results import empty_summary
from .kernel_choice import choose, groups_of_leaves
from .native_backend import computes_on_cpu
from .request import Request, row_of
from .rows import columns_of, refuse_second_order, run_by
from .shipped import is_shipped
from .simd import ALONG_INPUTS, Mode

MOST_COLUMNS = 6
"""Leaves up to which their derivatives one by one cost less than a run of reverse mode
does, which takes five times as long as the values."""
MOST_WITHOUT_CODE = 32
"""The same where no code for reverse mode is shipped, which takes twice as long to
compile as that for forward mode: more leaves than a scene of the package has."""
RUN_FORWARD, RUN_BACKWARD = 2, 6
"""What a run of either mode takes, in terms of the values. Of many runs at once, as for
a Jacobian, derivatives one by one cost less: each takes about as long as the values."""


def are_many(wanted: Request, values: Sequence, varied: Sequence[int]) -> bool:
    """Tell whether there are so many leaves that runs along all of them at once cost
    less than derivatives one by one; not inside `jax.shard_map`."""
    if (
        len(varied) <= MOST_COLUMNS
        or wanted.sampled
        or not (wanted.engine.is_machine_code and computes_on_cpu())
        or vary_over_devices(values)
    ):
        return False
    at_hand = _has_code(wanted.structure, wanted.ledger)
    return at_hand or len(varied) > MOST_WITHOUT_CODE


@functools.lru_cache(maxsize=256)
def _has_code(structure: Structure, ledger: LedgerItems) -> bool:
    """Tell whether code for reverse mode is shipped."""
    what, tree = naming(Assembly(structure, PLANAR, ledger), Mode.REVERSE, False)
    return not users_code(tree) and is_shipped(what, described(tree))


clear_when_edited(_has_code.cache_clear)


def change_of_rows(
    wanted: Request, values: Sequence, length, changes: dict[int, Any]
) -> Array:
    """Return the changes of rows of numbers with those of some leaves, as an operation
    that is linear in these.

    Args:
        length: steps that each impact takes.
    """
    many = _ManyLeaves(wanted, tuple(changes))
    # Those that take most steps begin first, beside others that take as many.
    operands = [*values, -length, *changes.values()]
    shape = broadcast_shapes(*map(np.shape, operands))
    of_lanes = [
        x if np.shape(x) == shape else namespace_of(x).broadcast_to(x, shape)
        for x in operands
    ]
    return _changes.bind(*of_lanes, many=many)


class _ManyLeaves:
    """What the operations are for, as JAX has to take it: to be compared as an object.

    Operands have the shape of the lanes: values, the effort of each lane, and either a
    step of each leaf, or the cotangents of all rows, whose axis is the first.
    """

    def __init__(self, wanted: Request, varied: tuple[int, ...]):
        self.wanted, self.varied = wanted, varied
        self.rows = jax.tree.structure(empty_summary(wanted.ledger)).num_leaves
        self.known = len(wanted.places) + 1
        """Operands in which the operations are not linear."""

    def shares(self) -> list[list[int]]:
        """Divide the leaves among runs: derivatives with respect to damping ratios need
        dashpots. All others share one model, that of the most general of them."""
        _, damping, _ = groups_of_leaves(self.wanted.structure)
        shares = [[], []]
        for place in self.varied:
            shares[place in damping].append(place)
        return [share for share in shares if share]

    def columns(self, values: Sequence, in_jax: bool, places: Sequence[int] = ()):
        """Compute the derivatives of the rows with respect to each of the leaves, or of
        some."""
        places = list(places or self.varied)
        _, columns = columns_of(self.wanted, [*values], None, places, in_jax)
        return [column for (column,) in columns]

    def changes(self, *operands, in_jax: bool):
        """Compute the changes of the rows with steps of the leaves."""
        *values, effort = operands[: self.known]
        step_of = dict(zip(self.varied, operands[self.known :], strict=True))
        changes = []
        for share in self.shares():
            steps = [step_of[place] for place in share]
            chosen = choose(self.wanted, values, share, Mode.FORWARD)
            if chosen is None:
                changes.append(_along(self.columns(values, in_jax, share), steps))
                continue
            kernels, _, program = chosen
            of_steps = [kernels.inputs + place for place in share]
            _, (along,) = run_by(in_jax)(
                kernels.along(1),
                (ALONG_INPUTS,),
                (*self.wanted.places, *of_steps),
                self.wanted.rest,
                [*values, *steps],
                effort,
                program,
                None,
            )
            changes.append(along[0])
        return functools.reduce(lambda a, b: a + b, changes)

    def gradient(self, *operands, in_jax: bool) -> list:
        """Compute the gradient, with respect to leaves, of the sum of the rows times
        their cotangents."""
        *values, effort = operands[: self.known]
        cotangents, of_leaf = operands[self.known], {}
        for share in self.shares():
            chosen = None
            if len(share) > MOST_COLUMNS:
                chosen = choose(self.wanted, values, share, Mode.REVERSE)
            if chosen is None:
                columns = self.columns(values, in_jax, share)
                of_leaf |= zip(share, _summed(columns, cotangents), strict=True)
                continue
            kernels, _, program = chosen
            first = len(self.wanted.rest)
            rows, _ = run_by(in_jax)(
                kernels,
                (),
                (*self.wanted.places, *range(first, first + self.rows)),
                np.concatenate([self.wanted.rest, np.zeros(self.rows)]),
                [*values, *cotangents],
                effort,
                program,
                None,
            )
            of_leaf |= self._gradient_in(rows, values, share)
        return [of_leaf[place] for place in self.varied]

    def _gradient_in(self, rows: Sequence, values: Sequence, share: list[int]) -> dict:
        """Take the gradient from what reverse mode gives. An impact that failed has
        none, and must not spoil that of others; it is NaN where an input is."""
        xp, of_failed = namespace_of(*values, *rows), 0.0
        for value in values:
            of_failed = xp.where(xp.isnan(value), xp.nan, of_failed)
        failed = xp.isnan(rows[row_of(self.wanted, "duration")])
        of_leaves = rows[self.rows :]
        return {place: xp.where(failed, of_failed, of_leaves[place]) for place in share}


def _along(columns: Sequence, steps: Sequence):
    """Add up derivatives with respect to leaves times steps of the leaves."""
    products = (c * step for c, step in zip(columns, steps, strict=True))
    return functools.reduce(lambda a, b: a + b, products)


def _summed(columns: Sequence, cotangents) -> list:
    """Add up, for each leaf, derivatives of rows times cotangents of the rows."""
    return [(column * cotangents).sum(axis=0) for column in columns]


def _define(
    operation: Primitive, compute: Callable, *, transposed: Callable, batched: Callable
) -> None:
    """Tell JAX what it has to know of an operation."""

    @operation.def_impl
    def at_once(*operands, many: _ManyLeaves):
        with own_settings():
            known = [np.asarray(operand) for operand in operands]
            return jax.tree.map(handed_over, compute(many, *known, in_jax=False))

    def in_jax(*operands, many: _ManyLeaves):
        return compute(many, *operands, in_jax=True)

    def jvp(operands, tangents, *, many: _ManyLeaves):
        steps = _once_only(many, tangents)
        along = operation.bind(*operands[: many.known], *steps, many=many)
        return operation.bind(*operands, many=many), along

    ad.primitive_jvps[operation] = jvp
    ad.primitive_transposes[operation] = transposed
    batching.primitive_batchers[operation] = batched
    lowered = mlir.lower_fun(in_jax, multiple_results=operation.multiple_results)
    mlir.register_lowering(operation, lowered)


def _once_only(many: _ManyLeaves, tangents: Sequence) -> list:
    """Return the tangents of what is linear. A change with the values would be a second
    derivative."""
    if not all(isinstance(tangent, ad.Zero) for tangent in tangents[: many.known]):
        refuse_second_order()
    return [ad.instantiate_zeros(tangent) for tangent in tangents[many.known :]]


def _batch_of(operands: Sequence, axes: Sequence, many: _ManyLeaves) -> list:
    """Put the axis of `jax.vmap` before those of the lanes. An operand without it has
    one of length 1; of what is linear JAX must see that it stands for all, to add up
    what is transposed."""
    lanes = operands[0].ndim - (axes[0] is not None)
    size, batch = _size_of(operands, axes), []
    for place, (operand, axis) in enumerate(zip(operands, axes, strict=True)):
        front = operand.ndim - lanes - (axis is not None)
        if axis is not None:
            operand = jnp.moveaxis(operand, axis, front)
        else:
            operand = jnp.expand_dims(operand, front)
            if place >= many.known:
                shape = operand.shape
                shape = (*shape[:front], size, *shape[front + 1 :])
                operand = jnp.broadcast_to(operand, shape)
        batch.append(operand)
    return batch


def _size_of(operands: Sequence, axes: Sequence):
    """Return the size of the axis of `jax.vmap`."""
    sizes = zip(operands, axes, strict=True)
    return next(x.shape[axis] for x, axis in sizes if axis is not None)


def _is_jacobian(operands, axes, run: int, others: int, many: _ManyLeaves) -> bool:
    """Tell whether an axis of `jax.vmap` is one of what is linear alone, along which
    runs would take longer than derivatives one by one."""
    if any(axis is not None for axis in axes[: many.known]):
        return False
    size = _size_of(operands, axes)
    # A size that is a symbol is not known.
    return isinstance(size, int) and run * size > others


# ---- Changes of rows with steps of leaves

_changes = Primitive("changes_of_impact")


@_changes.def_abstract_eval
def _type_of_changes(*operands, many: _ManyLeaves) -> ShapedArray:
    shape = broadcast_shapes(*(operand.shape for operand in operands))
    return ShapedArray((many.rows, *shape), np.dtype(float))


def _changes_transposed(cotangents, *operands, many: _ManyLeaves):
    known, steps = operands[: many.known], operands[many.known :]
    if isinstance(cotangents, ad.Zero):
        gradient = [ad.Zero(step.aval) for step in steps]
    else:
        gradient = _gradient.bind(*known, cotangents, many=many)
    return [*[None] * many.known, *gradient]


def _changes_batched(operands, axes, *, many: _ManyLeaves):
    if not _is_jacobian(operands, axes, RUN_FORWARD, len(many.varied), many):
        return _changes.bind(*_batch_of(operands, axes, many), many=many), 1
    columns = many.columns(operands[: many.known - 1], in_jax=True)
    of_steps = jax.vmap(functools.partial(_along, columns), (axes[many.known :],), 1)
    return of_steps(operands[many.known :]), 1


_define(
    _changes,
    _ManyLeaves.changes,
    transposed=_changes_transposed,
    batched=_changes_batched,
)

# ---- The gradient of a sum of rows

_gradient = Primitive("gradient_of_impact")
_gradient.multiple_results = True


@_gradient.def_abstract_eval
def _types_of_gradient(*operands, many: _ManyLeaves) -> list[ShapedArray]:
    *known, cotangents = operands
    shapes = *(operand.shape for operand in known), cotangents.shape[1:]
    return [ShapedArray(broadcast_shapes(*shapes), np.dtype(float))] * len(many.varied)


def _gradient_transposed(steps, *operands, many: _ManyLeaves):
    known = operands[: many.known]
    steps = [ad.instantiate_zeros(step) for step in steps]
    return [*[None] * many.known, _changes.bind(*known, *steps, many=many)]


def _gradient_batched(operands, axes, *, many: _ManyLeaves):
    count = len(many.varied)
    if not _is_jacobian(operands, axes, RUN_BACKWARD, count, many):
        gradient = _gradient.bind(*_batch_of(operands, axes, many), many=many)
        return gradient, [0] * count
    columns = many.columns(operands[: many.known - 1], in_jax=True)
    of_cotangents = jax.vmap(functools.partial(_summed, columns), axes[-1])
    return of_cotangents(operands[-1]), [0] * count


_define(
    _gradient,
    _ManyLeaves.gradient,
    transposed=_gradient_transposed,
    batched=_gradient_batched,
)

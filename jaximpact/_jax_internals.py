"""Uses of JAX beyond its public interface, in one place.

A new version of JAX that moves any of it is met here, and in the table of primitives
that have machine code (`backend.simd.lower_jaxpr`).
"""

import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import ShapedArray, Tracer, eval_context
from jax.extend.core import ClosedJaxpr, Jaxpr, Literal, set_current_trace
from jax.interpreters.ad import instantiate_zeros
from jax.sharding import NamedSharding, PartitionSpec

_CALLS = {"jit": "jaxpr", "pjit": "jaxpr", "custom_jvp_call": "call_jaxpr"}
_FIRST_DERIVATIVES = {"JVPTrace", "LinearizeTrace"}
_EAGER_TRACES = {"EvalTrace", "LinearizeTrace", "JVPTrace", "JaxprTrace", "BatchTrace"}


def setting(name: str):
    """Read a setting of `jax.config`, which type checkers do not see."""
    return getattr(jax.config, name)


def computed_at_once():
    """Have JAX compute with numbers that are known as it does where it neither traces
    nor differentiates; a context.

    Under `jax.ensure_compile_time_eval` it still looks for what to differentiate, which
    takes several times as long.
    """
    return eval_context()


def result_types(shapes: Sequence[tuple], operands: Sequence) -> list:
    """Return the types of float64 results of these shapes.

    Inside `jax.shard_map` they vary over the axes of the mesh over which what they come
    from does.
    """
    types = [jax.typeof(operand) for operand in operands]
    kinds, axes = _manual_axes(types)
    varying = frozenset().union(*axes)
    if not varying:
        return [jax.ShapeDtypeStruct(shape, jnp.float64) for shape in shapes]
    mesh = next(t for t, here in zip(types, axes, strict=True) if here).sharding.mesh
    said: dict[str, Any] = {"sharding": NamedSharding(mesh, PartitionSpec())}
    if kinds[0] is None:
        said["vma"] = varying
    else:
        said["manual_axis_type"] = type(kinds[0])(varying=varying)
    return [jax.ShapeDtypeStruct(shape, jnp.float64, **said) for shape in shapes]


def vary_over_devices(values: Sequence) -> bool:
    """Tell whether one of the values varies over a mesh, inside `jax.shard_map`."""
    _, axes = _manual_axes([jax.typeof(value) for value in values])
    return any(axes)


def _manual_axes(types: Sequence) -> tuple[list, list[frozenset]]:
    """Return the kinds of the axes of a mesh of types, and those over which they
    vary."""
    # JAX 0.10 and later; before it `vma`
    kinds = [getattr(t, "manual_axis_type", None) for t in types]
    axes = [
        t.vma if k is None else k.varying for k, t in zip(kinds, types, strict=True)
    ]
    return kinds, axes


def broadcast_shapes(*shapes: tuple) -> tuple:
    """`numpy.broadcast_shapes`, also of the symbolic dimensions of `jax.export`."""
    known = all(isinstance(size, int) for shape in shapes for size in shape)
    # NumPy takes a quarter of the time.
    return (np if known else jnp).broadcast_shapes(*shapes)


def namespace_of(*values) -> Any:
    """`jax.numpy` where JAX is tracing one of the values, else `numpy`, which is a
    hundred times quicker for a few numbers."""
    return jnp if any(isinstance(value, Tracer) for value in values) else np


def number_in(tracer: Tracer):
    """Find the number that a tracer stands for, if it is known and the same in all
    lanes of `jax.vmap`; else the tracer."""
    value = tracer
    while isinstance(value, Tracer):
        # Of what is batched, and of what is differentiated
        value = getattr(value, "val", getattr(value, "primal", None))
    if not isinstance(value, np.ndarray | np.generic | float | jax.Array):
        return tracer  # inside of `jax.jit` nothing is known
    if not np.size(value):
        return tracer
    values = np.asarray(value)
    least = np.min(values)
    return least if least == np.max(values) else tracer


def known_primals(values: Sequence) -> list | None:
    """Return the arrays that tracers of one first derivative outside of `jit` stand
    for, and other values as they are.

    None where there are other tracers, `jax.experimental.jet`'s too, and where some
    belong to a derivative inside of another one: whoever computed with their arrays
    would lose one of the two.
    """
    tracers = [value for value in values if isinstance(value, Tracer)]
    traces = {id(getattr(tracer, "_trace", None)) for tracer in tracers}
    if len(traces) > 1 or not all(map(is_differentiated, tracers)):
        return None
    primals = [x.primal if isinstance(x, Tracer) else x for x in values]
    return None if any(isinstance(x, Tracer) for x in primals) else primals


def is_differentiated(value) -> bool:
    """Tell whether JAX differentiates a value, inside of `jit` or outside."""
    return type(getattr(value, "_trace", None)).__name__ in _FIRST_DERIVATIVES


class LateResults(Protocol):
    """Results of an operation that is differentiated outside of `jit`, each worked out
    when JAX uses it."""

    def number(self, place: int) -> jax.Array:
        """Return the number of a result."""
        ...

    def change(self, place: int) -> Any:
        """Return how a result changes, by `of_changes`."""
        ...


def late_tracers(value: Tracer, results: LateResults, count: int, shape: tuple) -> list:
    """Make tracers for so many results of one shape, in the derivative that a value is
    of (`known_primals`).

    Of an operation with many results JAX makes tracers of all, and asks all of them for
    a cotangent, which takes longer than an impact.
    """
    trace: Any = value._trace
    kind, type_ = _late(type(value)), ShapedArray(shape, jnp.float64)
    return [kind(trace, type_, results, place) for place in range(count)]


def change_of(value: Tracer) -> Any:
    """Return how a value changes in the derivative that it is of."""
    return instantiate_zeros(value.tangent)  # pyright: ignore[reportAttributeAccessIssue]


def of_changes(value: Tracer):
    """Have JAX compute with changes, of the derivative that a value is of; a
    context."""
    trace: Any = value._trace
    reverse = getattr(trace, "tangent_trace", None)
    return set_current_trace(trace.parent_trace if reverse is None else reverse)


class _Late:
    __slots__ = ()


@functools.cache
def _late(kind: type) -> type:
    """Derive a class of tracers that asks for numbers and changes."""
    if issubclass(kind, _Late):
        return kind

    class Late(_Late, kind):
        __slots__ = ("place", "results")

        def __init__(self, trace, type_, results: LateResults, place: int):
            Tracer.__init__(self, trace, type_)
            self.results, self.place = results, place

        @property
        def primal(self):
            return self.results.number(self.place)

        @property
        def tangent(self):
            return self.results.change(self.place)

    return Late


def called(equation) -> ClosedJaxpr | None:
    """Find the function that an equation calls as it stands; None if it calls none."""
    name = _CALLS.get(equation.primitive.name)
    return None if name is None else equation.params[name]


def walk(
    jaxpr: Jaxpr, constants, arguments, literal: Callable, apply: Callable
) -> list:
    """Go through a jaxpr, equation by equation, with values of any kind, and return
    those of its outputs.

    Args:
        literal: gives the value of a literal.
        apply: gives the values of an equation's results, from the equation and the
            values of its operands.
    """
    values = dict(zip(jaxpr.constvars, constants, strict=True))
    values |= zip(jaxpr.invars, arguments, strict=True)

    def read(atoms) -> list:
        return [literal(x) if isinstance(x, Literal) else values[x] for x in atoms]

    for equation in jaxpr.eqns:
        results = apply(equation, read(equation.invars))
        values |= zip(equation.outvars, results, strict=True)
    return read(jaxpr.outvars)


def scan_counts(equation) -> tuple[int, int]:
    """Count the constants and the carried operands of a `scan`."""
    params = equation.params
    if "ft_in" in params:  # JAX 0.12 and later
        constants, carried, _ = params["ft_in"].update(equation.invars).unpack()
        return len(list(constants)), len(list(carried))
    return params["num_consts"], params["num_carry"]


def bind(equation, operands: Sequence) -> list:
    """Return the results of an equation's operation on other operands."""
    primitive = equation.primitive
    params = primitive.get_bind_params(equation.params)
    results = primitive.bind(*operands, **params)
    return results if primitive.multiple_results else [results]


def place_of(equation) -> str:
    """File, line and function that an equation comes from, outside of JAX; nothing
    where that is not known."""
    traceback = equation.source_info.traceback
    of_jax = str(Path(jax.__file__).parent)
    for frame in () if traceback is None else traceback.frames:
        if not frame.file_name.startswith(of_jax):
            return f"{frame.file_name}:{frame.line_num}, in {frame.function_name}"
    return ""


def is_inside_jit(*arguments) -> bool:
    """Tell whether a call with these arguments is being traced for compilation.

    Looks at the names of JAX's traces; a name it does not know counts as compilation,
    which costs speed and no correctness.
    """
    probe = jnp.zeros(()) + 0.0  # a tracer inside jit, even where no argument is
    leaves = [*jax.tree.leaves(arguments), probe]
    return any(not _traces(leaf) <= _EAGER_TRACES for leaf in leaves)


def _traces(value) -> set[str]:
    names, trace = set(), getattr(value, "_trace", None)
    while trace is not None:
        names.add(type(trace).__name__)
        trace = getattr(trace, "parent_trace", None)
    return names


def keep_programs_by(
    directory: Path,
    get: Callable[[str], bytes | None],
    put: Callable[[str, bytes], None],
) -> bool:
    """Have JAX call two functions for the compiled programs of a directory, in place of
    reading and writing its files. False where this version of JAX does not allow it.
    """
    try:
        from jax._src import compilation_cache
        from jax._src.compilation_cache_interface import CacheInterface

        of_jax = compilation_cache.get_file_cache
    except (ImportError, AttributeError):
        return False

    class Programs(CacheInterface):
        """The programs as JAX calls for them."""

        _path = directory

        def get(self, key: str) -> bytes | None:
            return get(key)

        def put(self, key: str, value: bytes) -> None:
            put(key, value)

    def get_file_cache(path: str):
        return (Programs(), path) if path == str(directory) else of_jax(path)

    compilation_cache.get_file_cache = get_file_cache
    return True

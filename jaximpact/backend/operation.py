"""The machine code as an operation of JAX: a custom call, which XLA makes by itself.

It goes through `jit`, `vmap` and whatever else JAX does with arrays, takes no part of
Python while it runs, and computes its lanes in threads of its own.
"""

import hashlib
import threading
from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from .._jax_internals import broadcast_shapes, result_types
from .simd import Kernel
from .simd.driver import PROGRAMS, Driver, driver_object, load_driver
from .simd.system_functions import thread_functions
from .threads import thread_count


class Operation(NamedTuple):
    """An operation that JAX knows by its name."""

    name: str
    result_rows: int
    sampled_rows: int
    directions: int


class _Registered(NamedTuple):
    """Objects that must live as long as JAX may call the operation: for ever."""

    operation: Operation
    driver: Driver
    kernels: tuple[Kernel, ...]


_registered: dict[str, _Registered] = {}
_lock = threading.Lock()


def register(kernels: Sequence[Kernel], directions: int = 0) -> Operation:
    """Make kernels an operation of JAX; each lane says which of them it is for.

    Args:
        kernels: with the same rows of inputs and of results.
        directions: along which they differentiate.
    """
    if len(kernels) > PROGRAMS:
        raise ValueError(f"{len(kernels)} kernels, but there can be {PROGRAMS}")
    # By its content: JAX keeps compiled programs, which call the operation by name, for
    # other processes. A name must never stand for other code.
    digest = hashlib.sha256(driver_object())
    digest.update(f"{len(kernels)} {directions}".encode())
    for kernel in kernels:
        digest.update(bytes(kernel.layout))
        digest.update(kernel.code.object_file)
    name = f"jaximpact_{digest.hexdigest()[:32]}"
    with _lock:
        if name not in _registered:
            _registered[name] = _register(name, tuple(kernels), directions)
    known = _registered[name]
    known.driver.operation.threads = thread_count()
    return known.operation


def _register(name: str, kernels: tuple[Kernel, ...], directions: int) -> _Registered:
    driver, first = load_driver(), kernels[0].program
    inside = driver.operation
    inside.count = len(kernels)
    for place, kernel in enumerate(kernels):
        inside.programs[place] = kernel.program
    inside.directions = directions
    inside.samples = first.sampled_rows > 0
    inside.leaves = kernels[0].code.common_inputs
    for field, address in thread_functions()._asdict().items():
        setattr(inside, field, address)
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(driver.handler), platform="cpu")
    operation = Operation(name, first.result_rows, first.sampled_rows, directions)
    return _Registered(operation, driver, kernels)


def call(
    operation: Operation,
    common: Array,
    places: Sequence[int],
    values: Sequence[Array],
    effort: Array,
    program: Array,
    along: Sequence[int] = (),
    times: Array | None = None,
) -> list[Array]:
    """Compute impacts by an operation, as one array for each row of results.

    Args:
        common: inputs of the kernels that all lanes have in common, one array.
        places, values: indices of the other inputs, and their values: float64 arrays
            that broadcast to the shape of the lanes.
        effort: how long a lane takes, less for longer, so that the longest begin first.
        program: the place of a lane's kernel.
        along: leaves of the directions; -1 for a direction that is not wanted.
        times: at which samples are taken, increasing along the last axis.

    Returns:
        Rows of results, each of the shape of the lanes; then what is sampled, with an
        axis of times behind.
    """
    lanes, own = [*values, effort, program], []
    shape = broadcast_shapes(*map(np.shape, lanes))
    if operation.directions:
        own.append(np.array(along, float))
    if times is not None:
        shape = broadcast_shapes(shape, np.shape(times)[:-1])
        own.append(times)
    shapes = [shape] * operation.result_rows
    if times is not None:
        shapes += [(*shape, np.shape(times)[-1])] * operation.sampled_rows
    of_all = [common, np.array(places, float)]
    operands = [
        *(_of_rank(x, len(shape) + 1) for x in of_all),
        *(_of_rank(x, len(shape)) for x in lanes),
        *(_of_rank(x, len(shape) + 1) for x in own),
    ]
    results = result_types(shapes, operands)
    return list(
        jax.ffi.ffi_call(operation.name, results, vmap_method="expand_dims")(*operands)
    )


def _of_rank(value, rank: int) -> Array:
    """Give a value axes of length 1 in front."""
    value = jnp.asarray(value)
    return value.reshape((1,) * (rank - value.ndim) + value.shape)

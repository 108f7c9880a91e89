"""The machine code as an operation of JAX: a custom call, which XLA makes by itself.

It goes through `jit`, `vmap` and whatever else JAX does with arrays, takes no part of
Python while it runs, and computes its lanes in threads of its own.
"""

import threading
from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from .._jax_internals import broadcast_shapes, result_types
from .simd import KernelSet
from .simd.driver import Driver
from .threads import thread_count

_registered: dict[str, tuple[KernelSet, Driver]] = {}
"""Operations by name; both must live as long as JAX may call them: for ever."""
_lock = threading.Lock()


def _name(kernels: KernelSet) -> str:
    """Make kernels an operation of JAX, if they are none yet, and return its name."""
    name = f"jaximpact_{kernels.digest}"
    with _lock:
        if name not in _registered:
            driver = kernels.load_driver()
            handler = jax.ffi.pycapsule(driver.handler)
            jax.ffi.register_ffi_target(name, handler, platform="cpu")
            _registered[name] = kernels, driver
    _, driver = _registered[name]
    driver.operation.threads = thread_count()
    return name


def call(
    kernels: KernelSet,
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
        effort, program, along, times: as for `KernelSet.compute`.

    Returns:
        Rows of results, each of the shape of the lanes; then what is sampled, with an
        axis of times behind.
    """
    lanes, further = [*values, effort, program], []
    shape = broadcast_shapes(*map(np.shape, lanes))
    if kernels.directions:
        further.append(np.array(along, float))
    if times is not None:
        shape = broadcast_shapes(shape, np.shape(times)[:-1])
        further.append(times)
    shapes = [shape] * kernels.result_rows
    if times is not None:
        shapes += [(*shape, np.shape(times)[-1])] * kernels.sampled_rows
    of_all = [common, np.array(places, float)]
    operands = [
        *(_of_rank(x, len(shape) + 1) for x in of_all),
        *(_of_rank(x, len(shape)) for x in lanes),
        *(_of_rank(x, len(shape) + 1) for x in further),
    ]
    results = result_types(shapes, operands)
    call_of = jax.ffi.ffi_call(_name(kernels), results, vmap_method="expand_dims")
    return list(call_of(*operands))


def _of_rank(value, rank: int) -> Array:
    value = jnp.asarray(value)
    return value.reshape((1,) * (rank - value.ndim) + value.shape)

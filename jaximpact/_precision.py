"""Double precision is required: contact stiffness and overstress span ten decades."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._jax_internals import Tracer, setting
from ._settings import own_transfers
from ._types import Number

MESSAGE = (
    "jaximpact computes in float64, but JAX is set to float32: call "
    "jax.config.update('jax_enable_x64', True) before the first use of jaximpact, "
    "or set JAX_ENABLE_X64=1 in the environment"
)


def require_float64() -> None:
    """Raise RuntimeError, with the cure, unless JAX is set to double precision."""
    if not setting("jax_enable_x64"):
        raise RuntimeError(MESSAGE)


def float64_leaf(value: Number) -> Float[Array, "..."]:
    """Return `value` as a float64 array: the converter of every parameter field.

    A plain number stays a concrete array even inside `jax.jit`, so that a simulation
    can still see there that a scene has no dashpots.
    """
    require_float64()
    if isinstance(value, Tracer):
        return value if value.dtype == jnp.float64 else value.astype(jnp.float64)
    if isinstance(value, float):
        # -0.0 equals 0.0
        return _number(float(value), math.copysign(1.0, value))
    if isinstance(value, jax.Array) and _is_float64(value):
        return value
    with jax.ensure_compile_time_eval(), own_transfers():
        return jnp.asarray(value, dtype=jnp.float64)


def _is_float64(value: jax.Array) -> bool:
    """Whether JAX would make nothing else of an array as a float64 array."""
    return value.dtype == jnp.float64 and not value.weak_type


@functools.lru_cache(maxsize=4096)
def _number(value: float, sign: float) -> Float[Array, ""]:
    """Turn a plain number into an array. A scene has thirty, most of them defaults."""
    with jax.ensure_compile_time_eval(), own_transfers():
        if math.isfinite(value):  # `jax_debug_nans` looks at what a program returns
            return _as_it_is(np.float64(value))
        return jnp.asarray(value, dtype=jnp.float64)


# A program hands a number over in a quarter of the time that `jnp.asarray` takes.
@jax.jit
def _as_it_is(value):
    return value

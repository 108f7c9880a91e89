"""Double precision is required: contact stiffness and overstress span ten decades."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ._jax_internals import Tracer, computed_at_once, setting
from ._settings import own_settings
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
    with computed_at_once(), own_settings():
        return jnp.asarray(value, dtype=jnp.float64)


def _is_float64(value: jax.Array) -> bool:
    """Whether an array is a float64 array already."""
    return value.dtype == jnp.float64 and not value.weak_type


@functools.lru_cache(maxsize=4096)
def _number(value: float, sign: float) -> Float[Array, ""]:
    """Turn a plain number into an array. A scene has thirty, most of them defaults."""
    with own_settings():
        return handed_over(np.float64(value))


def handed_over(numbers: np.ndarray | np.float64) -> Float[Array, "..."]:
    """Hand numbers over to JAX, also where it traces or differentiates. A program does
    it in a quarter of the time of `jax.device_put`."""
    with computed_at_once():
        if np.all(np.isfinite(numbers)):
            return _as_it_is(numbers)
        return jax.device_put(numbers)  # `jax_debug_nans` looks at programs


@jax.jit
def _as_it_is(numbers):
    return jnp.asarray(numbers)  # also under `jax.disable_jit`

"""Compiling for the CPU without fusion.

XLA's fusion on CPU copies shared arithmetic into every place where it is used. The
Jacobian of the contact laws, 650 products, becomes 3 300; it then compiles four times
as slowly and runs eight times as slowly as it does with the pass switched off (jax
0.10.2). The option can be given only to a `jax.jit` that is not inside another one.
"""

from collections.abc import Callable

import jax

from .._jax_internals import is_inside_jit

UNFUSED = {"xla_disable_hlo_passes": "fusion"}


def compile_unfused(function: Callable, *arguments) -> Callable:
    """The function compiled for arguments of these shapes, without fusion on a CPU."""
    on_cpu = jax.default_backend() == "cpu"
    jitted = jax.jit(function, compiler_options=UNFUSED if on_cpu else None)
    return jitted.lower(*arguments).compile()


def unfused_jit(function: Callable, static_argnums: tuple[int, ...] = ()) -> Callable:
    """`jax.jit` that leaves out fusion on a CPU.

    Inside another `jax.jit` the function is traced as it stands: it works, compiled as
    the outer function is.
    """
    unfused = jax.jit(function, static_argnums=static_argnums, compiler_options=UNFUSED)
    plain = jax.jit(function, static_argnums=static_argnums)

    def call(*arguments):
        dynamic = [a for i, a in enumerate(arguments) if i not in static_argnums]
        if jax.default_backend() != "cpu" or is_inside_jit(*dynamic):
            return plain(*arguments)
        return unfused(*arguments)

    return call

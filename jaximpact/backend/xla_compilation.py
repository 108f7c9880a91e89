"""Compilation by XLA: without some passes on a CPU, and with programs kept on disk.

XLA's fusion on CPU copies shared arithmetic into every place where it is used. The
Jacobian of the contact laws, 650 products, becomes 3 300; it then compiles four times
as slowly and runs eight times as slowly as it does with the pass switched off (jax
0.10.2). The passes over loops find nothing that pays in a loop over steps: without them
a derivative compiles in three quarters of the time. The option can be given only to a
`jax.jit` that is not inside another one.

Programs are kept for the commands. JAX's own directory of compiled programs is not
used: its files are run as they are found, whoever wrote them, and one that was cut
short is never replaced.
"""

from collections.abc import Callable

import jax

from .._jax_internals import is_inside_jit, keep_programs_by, setting
from ..store import open_cache
from .simd import host

UNFUSED = {
    "xla_disable_hlo_passes": "fusion,simplify-while-loops,"
    "while-loop-invariant-code-motion,while-loop-constant-sinking"
}


def unfused_jit(function: Callable, static_argnums: tuple[int, ...] = ()) -> Callable:
    """Compile like `jax.jit`, without fusion on a CPU.

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


def keep_programs() -> None:
    """Have JAX keep what it compiles in the package's cache, if there is one, and
    unless the user has named a directory to JAX."""
    cache = open_cache()
    if cache is None or setting("jax_compilation_cache_dir") is not None:
        return
    # JAX's key does not tell processors apart.
    kept = keep_programs_by(
        cache.path,
        lambda key: cache.get("xla", repr((key, host()))),
        lambda key, program: cache.put("xla", repr((key, host())), program),
    )
    if kept:
        jax.config.update("jax_compilation_cache_dir", str(cache.path))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.5)

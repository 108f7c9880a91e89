"""Programs of XLA kept on disk, for the commands.

JAX's own directory of compiled programs is not used: its files are run as they are
found, whoever wrote them, and one that was cut short is never replaced.
"""

import jax

from .._jax_internals import keep_programs_by
from ..cache import open_cache
from .native import host

LEAST_SECONDS = 0.5
"""What takes less to compile is not kept."""


def keep_programs() -> None:
    """Have JAX keep what it compiles in the package's cache, if there is one, and
    unless the user has named a directory to JAX."""
    cache = open_cache()
    if cache is None or jax.config.jax_compilation_cache_dir is not None:
        return
    # JAX's key does not tell processors apart.
    kept = keep_programs_by(
        cache.path,
        lambda key: cache.get("xla", repr((key, host()))),
        lambda key, program: cache.put("xla", repr((key, host())), program),
    )
    if kept:
        jax.config.update("jax_compilation_cache_dir", str(cache.path))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", LEAST_SECONDS)

"""Programs of XLA kept on disk, for the commands.

JAX's own directory of compiled programs is not used: its files are run as they are
found, whoever wrote them, and one that was cut short is never replaced.
"""

from pathlib import Path

import jax

from ..cache import Cache, open_cache
from .native import host

LEAST_SECONDS = 0.5
"""What takes less to compile is not kept."""


def keep_programs() -> None:
    """Have JAX keep what it compiles in the package's cache, if there is one, and
    unless the user has named a directory to JAX."""
    cache = open_cache()
    if cache is None or jax.config.jax_compilation_cache_dir is not None:
        return
    try:
        # JAX has no public place for another cache. Where a later version has changed,
        # nothing is kept.
        from jax._src import compilation_cache
        from jax._src.compilation_cache_interface import CacheInterface

        of_jax = compilation_cache.get_file_cache
    except (ImportError, AttributeError):
        return

    class Programs(CacheInterface):
        """The cache as JAX calls it."""

        def __init__(self, cache: Cache):
            self._cache, self._path = cache, Path(cache.path)

        def get(self, key: str) -> bytes | None:
            return self._cache.get("xla", _with_host(key))

        def put(self, key: str, value: bytes) -> None:
            self._cache.put("xla", _with_host(key), value)

    def get_file_cache(path: str):
        return (Programs(cache), path) if path == str(cache.path) else of_jax(path)

    compilation_cache.get_file_cache = get_file_cache
    jax.config.update("jax_compilation_cache_dir", str(cache.path))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", LEAST_SECONDS)


def _with_host(key: str) -> str:
    """JAX's key does not tell processors apart."""
    return repr((key, host()))

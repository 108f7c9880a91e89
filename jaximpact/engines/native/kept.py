"""Machine code kept on disk."""

from collections.abc import Callable

from ...cache import open_cache


def kept(key: str, make: Callable[[], bytes]) -> bytes:
    """What `make` gives, or gave another time under this key.

    Args:
        key: names everything that the code depends on.
    """
    cache = open_cache()
    if cache is None:
        return make()
    stored = cache.get("machine", key)
    if stored is None:
        stored = make()
        cache.put("machine", key, stored)
    return stored

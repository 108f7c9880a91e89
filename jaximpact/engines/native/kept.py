"""Machine code kept on disk."""

import json
from collections.abc import Callable

from ...cache import open_cache
from .kernel import Code


def kept(key: str, make: Callable[[], Code]) -> Code:
    """What `make` gives, or gave another time under this key.

    Args:
        key: names everything that the code depends on.
    """
    cache = open_cache()
    if cache is None:
        return make()
    stored = cache.get("machine", key)
    if stored is not None:
        numbers, _, object_file = stored.partition(b"\n")
        return Code(object_file, *json.loads(numbers))
    code = make()
    numbers = json.dumps(code[1:]).encode()
    cache.put("machine", key, numbers + b"\n" + code.object_file)
    return code

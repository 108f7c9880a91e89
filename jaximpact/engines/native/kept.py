"""Machine code kept on disk, where JAX keeps its compiled programs."""

import contextlib
import hashlib
import json
from collections.abc import Callable
from pathlib import Path

import jax

from ...formats.files import replacing
from .kernel import Code


def kept(key: str, make: Callable[[], Code]) -> Code:
    """What `make` gives, or gave another time under this key.

    It is kept in JAX's directory of compiled programs, if there is one
    (`JAX_COMPILATION_CACHE_DIR`). One that cannot be written to costs time only.

    Args:
        key: names everything that the code depends on.
    """
    directory = jax.config.jax_compilation_cache_dir
    if not directory:
        return make()
    name = hashlib.sha256(key.encode()).hexdigest()
    path = Path(directory) / f"jaximpact-{name}"
    code = _read(path)
    if code is None:
        code = make()
        with contextlib.suppress(OSError), replacing(path) as temporary:
            temporary.write_bytes(_written(code))
    return code


def _written(code: Code) -> bytes:
    numbers = code._replace(object_file="")._asdict()
    numbers["sha256"] = hashlib.sha256(code.object_file).hexdigest()
    return json.dumps(numbers).encode() + b"\n" + code.object_file


def _read(path: Path) -> Code | None:
    """The code in a file; None where there is none that is whole."""
    with contextlib.suppress(OSError, ValueError, TypeError, AttributeError):
        first, _, object_file = path.read_bytes().partition(b"\n")
        numbers = json.loads(first)
        if numbers.pop("sha256", "") == hashlib.sha256(object_file).hexdigest():
            return Code(**numbers | {"object_file": object_file})
    return None

"""Ctrl-C in work that keeps what it has."""

import contextlib
from collections.abc import Iterator


@contextlib.contextmanager
def resumable() -> Iterator[None]:
    """Where the work inside is interrupted, the interrupt says that it can go on."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt("the same command goes on from here") from None

"""Pause of Python's garbage collector, for large tables and for tracing."""

import contextlib
import gc
from collections.abc import Iterator


@contextlib.contextmanager
def collector_paused() -> Iterator[None]:
    """Pause the collection of reference cycles, for code that makes none.

    Many rows make it run often, and so does a graph that is traced; it goes through all
    that is being built again and again, and takes a third of the time. And JAX has a
    callback in it: Ctrl-C that arrives there is reported as ignored, and is lost.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()

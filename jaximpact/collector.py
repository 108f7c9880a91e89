"""Python's garbage collector, out of the way of tables of a million rows, and of
tracing and compiling."""

import contextlib
import gc
from collections.abc import Iterator


@contextlib.contextmanager
def collector_paused() -> Iterator[None]:
    """No collection of reference cycles inside; for code that makes none.

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

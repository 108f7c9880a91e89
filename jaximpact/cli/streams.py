"""Standard streams as commands find them: closed, full, or of another encoding."""

import contextlib
import os
import sys
import warnings

from ..errors import UnusualValueWarning
from .progress import forget, say


def prepare_streams() -> None:
    """Make the standard streams such that any text can be written to them.

    A character that the encoding lacks is replaced. Writing to a closed stdout fails as
    on a full disk, and to a closed stderr is lost. Descriptors 0 to 2 are taken, so
    that no file of ours gets one that other code writes to.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            # The lowest free descriptor is this one.
            os.open(os.devnull, os.O_RDWR if descriptor == 2 else os.O_RDONLY)
    if sys.stdout is None:
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    for stream, errors in ((sys.stdout, "replace"), (sys.stderr, "backslashreplace")):
        # Streams that stand in for them, as in tests, take every character.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=errors)


def stdout_problem() -> str | None:
    """Why stdout cannot be written to; then what it holds is let go of. None if it
    can."""
    try:
        sys.stdout.flush()
    except OSError as error:
        forget(sys.stdout)
        return f"stdout cannot be written: {error.strerror}"
    return None


@contextlib.contextmanager
def warnings_in_one_line():
    """Warnings are a line on stderr each, of unusual values one for each quantity."""
    told = set()

    def show(message, category, filename, lineno, file=None, line=None):
        quantity = getattr(message, "quantity", None)
        if issubclass(category, UnusualValueWarning) and quantity in told:
            return
        told.add(quantity)
        say(f"warning: {message}")

    with warnings.catch_warnings():
        warnings.showwarning = show
        yield

"""Lines on stderr: messages, and the progress of long work."""

import contextlib
import math
import os
import sys
import time
from collections.abc import Iterator
from typing import Any, TextIO

from .errors import InputError, shown
from .progress import (
    SILENT,
    Progress,
    ProgressFunction,
    in_words,
    listening,
    reporting_to,
)

ProgressChoice = Progress | ProgressFunction | bool | None
"""What a user gives: a function, False for silence, or None or True for lines on
stderr."""


def say(text: str) -> None:
    """Write a message on stderr, with the name of the command before it."""
    write(sys.stderr, f"jaximpact: {shown(text)}\n")


def write(stream: TextIO | None, text: str) -> None:
    """Write at once. What cannot be told, on a full disk or where there is no stderr,
    ends no computation."""
    if stream is None:  # of a program of Windows without a console
        return
    try:
        stream.write(text)
        if hasattr(stream, "flush"):
            stream.flush()
    except OSError:
        forget(stream)
    except ValueError:  # it was closed
        pass


def _is_terminal(stream: Any) -> bool:
    """Tell whether a stream is a terminal. None, and objects that stand in for stderr,
    may not know."""
    try:
        return stream.isatty()
    except (AttributeError, OSError, ValueError):
        return False


def forget(stream: TextIO) -> None:
    """Let go of what could not be written: Python must not try again at exit."""
    with contextlib.suppress(AttributeError, OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


class ProgressLines(Progress):
    """Progress as lines on stderr, to be used in a `with`.

    On a terminal and in a notebook each line overwrites the last one, and the end of
    the `with` ends the line. Elsewhere counted work has a line every tenth, and other
    work one every five seconds.

    Args:
        delay: seconds before the first line, so that short work has none.
    """

    def __init__(self, delay: float = 0.0):
        self._stream = sys.stderr
        in_notebook = type(self._stream).__module__.startswith("ipykernel")
        self._overwrites = _is_terminal(self._stream) or in_notebook
        self._first = time.monotonic() + delay
        self._length = 0
        self._last_part: tuple[str, int] | None = None
        self._last_time = -math.inf

    def __enter__(self) -> "ProgressLines":
        return self

    def __exit__(self, *exception) -> None:
        if self._length:
            write(self._stream, "\n")

    def __call__(self, what, done=None, total=None):
        super().__call__(what, done, total)
        if time.monotonic() < self._first:
            return
        text = shown(in_words(what, done, total))
        if done is not None and total is not None:
            text += f" ({100 * done // total} %)"
        if self._overwrites:
            write(self._stream, "\r" + text.ljust(self._length))
            self._length = len(text)
        elif self._is_due(what, done, total):
            write(self._stream, f"{text}\n")

    def _is_due(self, what, done, total) -> bool:
        """Tell whether the line is written where lines cannot overwrite each other."""
        if total is not None:
            before, self._last_part = self._last_part, (what, 10 * done // total)
            return self._last_part != before
        now = time.monotonic()
        due = now - self._last_time >= 5.0
        if due:
            self._last_time = now
        return due


@contextlib.contextmanager
def showing(progress: ProgressChoice, delay: float = 2.0) -> Iterator[None]:
    """Have what a user gave listen to the work inside; with None whoever listens
    already does, or else lines on stderr once it has taken so many seconds.

    Raises InputError for what is no function.
    """
    if progress is True:
        progress = None
    if not (progress is None or progress is False or callable(progress)):
        raise InputError(
            f"progress must be a function, True or False, but is {progress!r}"
        )
    if progress is None and listening() is SILENT:
        with ProgressLines(delay) as lines, reporting_to(lines):
            yield
    else:
        # Silence that was asked for is another one than that of nobody who listens.
        with reporting_to(Progress() if progress is False else progress):
            yield

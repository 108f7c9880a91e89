"""Progress of long work, on stderr."""

import contextlib
import os
import sys
from typing import TextIO

from ..errors import shown

PARTS = 10
"""Lines of progress in all where stderr is not a terminal."""


def say(text: str) -> None:
    """A line on stderr that tells whose it is."""
    write(sys.stderr, f"jaximpact: {shown(text)}\n")


def write(stream: TextIO, text: str) -> None:
    """Write at once. What cannot be told, on a full disk, ends no computation."""
    try:
        stream.write(text)
        stream.flush()
    except OSError:
        forget(stream)


def forget(stream: TextIO) -> None:
    """Let go of what could not be written: Python must not try again at exit."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


class Progress:
    """Says how far the work is: `progress(done, total)`.

    On a terminal one line that overwrites itself; else a line every tenth. To be used
    in a `with`, which ends the line that is open.
    """

    def __init__(self, unit: str):
        self.unit = unit
        self.stream = sys.stderr
        self.overwrites = self.stream.isatty()
        self.part = -1

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *exception) -> None:
        if self.overwrites and self.part >= 0:
            write(self.stream, "\n")

    def __call__(self, done: int, total: int) -> None:
        part = PARTS * done // total
        if not self.overwrites and part == self.part:
            return
        self.part = part
        percent = 100 * done // total
        text = f"{done} of {total} {self.unit} ({percent} %)"
        write(self.stream, f"\r{text}" if self.overwrites else f"{text}\n")

"""The errors of the package's edge: input that cannot be used, and results that could
not be had."""

import difflib
import os


class InputError(ValueError):
    """A file, or a value in it, that cannot be used.

    The message is one line: file, row and column as far as they apply, then what was
    got and what is needed. Rows are lines of the file, the first being 1.
    """

    def __init__(
        self,
        problem: str,
        *,
        file: str | os.PathLike | None = None,
        row: int | None = None,
        column: str | None = None,
        key: str | None = None,
    ):
        where = (
            (file, "{}"),
            (row, "row {}"),
            (column, "column {}"),
            (key, "key {}"),
        )
        place = ", ".join(text.format(item) for item, text in where if item is not None)
        message = f"{place}: {problem}" if place else problem
        super().__init__(" ".join(message.split("\n")))


class IncompleteError(Exception):
    """Something that a command was asked for could not be computed; the rest was. The
    message is one line."""


def nearest(name: str, known) -> str:
    """The known name most like a given one."""
    folded = {str(k).lower(): str(k) for k in known}
    matches = difflib.get_close_matches(str(name).lower(), folded, n=1, cutoff=0.0)
    return folded[matches[0]]

"""Errors and warnings: input that cannot be used, results that cannot be had."""

import contextlib
import difflib
import os
from collections.abc import Callable, Collection, Iterable, Iterator

LONGEST = 600
"""Characters of a message."""


class InputError(ValueError):
    """A file, or a value in it, that cannot be used.

    The message is one line: file, row and column as far as they apply, then what was
    got and what is needed. Rows are lines of the file, the first being 1. What it
    quotes of the input is `shown`.
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
        place = {"file": file, "row": row, "column": column, "key": key}
        self.place = {name: at for name, at in place.items() if at is not None}
        self.problem = problem
        words = [
            f"{at}" if name == "file" else f"{name} {at}"
            for name, at in self.place.items()
        ]
        super().__init__(shown(f"{', '.join(words)}: {problem}" if words else problem))


@contextlib.contextmanager
def located(**place) -> Iterator[None]:
    """Add the place, as `InputError` takes it, to an error that does not name it."""
    try:
        yield
    except InputError as error:
        place = {name: at for name, at in place.items() if at is not None}
        # An error of another file, such as that of a law, is quoted with its place.
        if "file" in error.place or place.keys() & error.place.keys():
            raise InputError(str(error), **place) from error
        raise InputError(error.problem, **place, **error.place) from error


class NoMachineCodeWarning(UserWarning):
    """Warning that XLA computes, as laws or the computer have no machine code."""


class NoWorkersWarning(UserWarning):
    """Warning that a client of Dask has no workers, so that its work stands still."""


class UnusualValueWarning(UserWarning):
    """A value far from what blocks and grounds have; its unit may be mistaken.

    Args:
        message: one line.
        quantity: name of its column.
    """

    def __init__(self, message: str, quantity: str):
        super().__init__(shown(message))
        self.quantity = quantity

    def __reduce__(self):
        return type(self), (str(self), self.quantity)


class IncompleteError(Exception):
    """A part of what was asked for that could not be computed, while the rest was.

    The message is one line.
    """


def shown(text: str) -> str:
    """Make one line of a text that a terminal can print.

    Control characters, marks that turn the direction of writing and halves of
    characters are escaped; a text that is too long loses its middle.
    """
    if len(text) > LONGEST:
        half = LONGEST // 2
        text = f"{text[:half]} ... {text[-half:]}"
    return "".join(
        c if c.isprintable() or c == "\u00a0" else c.encode("unicode_escape").decode()
        for c in text
    )


OTHER_WORDS = {
    "ground": ["soil"],
    "soil": ["ground"],
    "sphere": ["Ellipsoid"],
    "min": ["least", "lower"],
    "max": ["most", "upper"],
}
"""Words that users write for names of the package."""
FEW_NAMES = 15
"""Known names that an error lists where none is like the one that was given."""


def nearest(name, known: Iterable) -> str | None:
    """Find the known name most like an unknown one; None where none is like it."""
    folded = {str(k).lower(): str(k) for k in known}
    # Comparing takes as long as the name is.
    asked = str(name)[:LONGEST].lower()
    like = [k for k in OTHER_WORDS.get(asked, []) if k.lower() in folded]
    like = like or difflib.get_close_matches(asked, folded, n=1)
    like = like or [k for k in folded if len(asked) > 2 and k.startswith(asked)]
    return folded[like[0].lower()] if like else None


def did_you_mean(name, known: Iterable, show: Callable[[str], str] = str) -> str:
    """Say what may have been meant by an unknown name, to follow "is unknown; ".

    That is the known name most like it; where none is, all of them if they are few.

    Args:
        show: how a known name is shown.
    """
    names = [str(k) for k in known]
    near = nearest(name, names)
    if near is not None:
        return f"did you mean {show(near)}?"
    if len(names) > FEW_NAMES:
        return f"none of the {len(names)} known names is like it"
    return f"known are {', '.join(map(show, names))}"


def check_choice(name: str, value, known: Collection[str], **place) -> None:
    """Raise InputError, with the nearest known word, unless a value is one of them.

    Args:
        name: what an error calls the value; "" where its place says so.
        place: file, row, column and key of the error.
    """
    is_text = isinstance(value, str)
    if not is_text or value not in known:
        near = nearest(value, known) if is_text else None
        hint = f"; did you mean {near}?" if near else ""
        problem = f"must be one of {', '.join(known)}, but is {value!r}{hint}"
        raise InputError(f"{name} {problem}".lstrip(), **place)

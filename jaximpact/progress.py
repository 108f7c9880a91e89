"""Progress of computations: who listens is set once, where the work begins.

Users of the package give a plain function, or nothing. `as_progress` makes a `Progress`
of it, `telling` has it listen to the work inside, and whatever does a part of that work
calls `tell(what)` or, where the work is counted, `tell(what, done, total)`.
"""

import contextlib
import contextvars
import inspect
import logging
from collections.abc import Callable, Iterator
from typing import NamedTuple

ProgressFunction = Callable[[int, int], object] | Callable[[str], object]
"""Function that a user gives: of `(done, total)`, or of a line of text."""


LOGGER = logging.getLogger(__name__.partition(".")[0])


class Progress:
    """Progress of long work; this class itself tells only the logger "jaximpact"."""

    def __call__(
        self, what: str, done: int | None = None, total: int | None = None
    ) -> None:
        """Tell the step that begins, `"compiling once"`; or what is counted,
        `"impacts"`, how many are done, and how many there are in all. In the log steps
        are of the level INFO, counts DEBUG."""
        LOGGER.log(
            logging.INFO if total is None else logging.DEBUG,
            "%s",
            _Words(what, done, total),
        )

    def within(self, step: str) -> "Progress":
        """Return progress of a part of the work, whose lines begin with the step's
        name."""
        return _Within(self, step)


class _Words(NamedTuple):
    """Progress that is put into words if it is written."""

    what: str
    done: int | None
    total: int | None

    def __str__(self) -> str:
        return in_words(*self)


SILENT = Progress()
"""Progress for work that nobody watches."""
_listening: contextvars.ContextVar[Progress]
_listening = contextvars.ContextVar("_listening", default=SILENT)


@contextlib.contextmanager
def telling(progress: Progress) -> Iterator[None]:
    """Have a progress listen to the work inside, in this thread and in those that run
    in a copy of its context."""
    token = _listening.set(progress)
    try:
        yield
    finally:
        _listening.reset(token)


@contextlib.contextmanager
def reporting_to(progress: Progress | ProgressFunction | None) -> Iterator[None]:
    """Have what a user gave listen to the work inside; with None whoever listens
    already does."""
    with telling(listening() if progress is None else as_progress(progress)):
        yield


@contextlib.contextmanager
def within(step: str) -> Iterator[None]:
    """Put the name of a step in front of all lines that the work inside tells; also as
    a decorator."""
    with telling(listening().within(step)):
        yield


def listening() -> Progress:
    """Return the progress that listens here."""
    return _listening.get()


def tell(what: str, done: int | None = None, total: int | None = None) -> None:
    """Tell the progress that listens here how far the work is."""
    _listening.get()(what, done, total)


class _Within(Progress):
    def __init__(self, whole: Progress, step: str):
        self._whole, self._step = whole, step

    def __call__(self, what, done=None, total=None):
        self._whole(f"{self._step}{what}", done, total)


class _Given(Progress):
    def __init__(self, function: Callable):
        self._function = function
        self._takes_count = _takes(function, 0, 0)
        self._takes_text = _takes(function, "")

    def __call__(self, what, done=None, total=None):
        super().__call__(what, done, total)
        if total is not None and self._takes_count:
            self._function(done, total)
        elif self._takes_text:
            self._function(in_words(what, done, total))


def as_progress(function: Progress | ProgressFunction | None) -> Progress:
    """Make a `Progress` of what a user gave.

    A function of two arguments is told `(done, total)` of what is counted, and a
    function of one every line as a text; a function of any number of arguments, such as
    `print`, gets counts as two numbers and the rest as texts.
    """
    if function is None:
        return SILENT
    return function if isinstance(function, Progress) else _Given(function)


def in_words(what: str, done: int | None = None, total: int | None = None) -> str:
    """Return progress as a line of text: `"compiling once"`, `"3 of 10 impacts"`, with
    a step in front `"drops: 3 of 10 impacts"`."""
    if total is None:
        return what
    steps, colon, counted = what.rpartition(": ")
    return f"{steps}{colon}{done} of {total} {counted}"


def _takes(function: Callable, *arguments) -> bool:
    try:
        inspect.signature(function).bind(*arguments)
    except TypeError:
        return False
    except ValueError:  # a function of C that does not tell its arguments
        return True
    return True

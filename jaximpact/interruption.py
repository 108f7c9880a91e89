"""Interrupts by Ctrl-C, SIGTERM and SIGHUP, and what they leave behind.

In a process of the command line they end it from a thread of their own, and no
KeyboardInterrupt is raised: that exception is dropped inside callbacks of JAX, ctypes
and the garbage collector, becomes another one inside imports, and must wait while
native code compiles. Results that are kept are whole at any moment, as a kill demands;
what remains to be done is to remove the files being written. Where the package is used
from Python, KeyboardInterrupt is raised as ever.
"""

import contextlib
import os
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator

ENDINGS: dict[int, tuple[int, str]] = {
    signal.SIGINT: (130, "interrupted"),
    signal.SIGTERM: (143, "terminated"),
}
"""Signal -> exit code, and word for the message."""
if hasattr(signal, "SIGHUP"):  # not on Windows
    ENDINGS[signal.SIGHUP] = (129, "terminal closed")
PATIENCE = 2.0
"""Seconds that other threads have to finish the files they are writing."""
SETTLING = 0.02
"""Seconds in which a library's own thread ends what it was told to write."""

_prospects: list[Callable[[], str]] = []
_unfinished: dict[os.PathLike, tuple[int | None, "Remove"]] = {}
"""Files being written, the thread that is waited for, and what removes them."""
_beginning = threading.Lock()
"""Lock of whoever begins a file; held for good once the process is ending."""
_ending = threading.RLock()
"""Lock of whoever ends the process, whom a second signal may interrupt."""
_ended_by: list[int] = []
"""The signal that ends the process, once one does."""

Remove = Callable[[os.PathLike], bool]
"""Function that removes something, and tells whether there was anything."""


@contextlib.contextmanager
def resumable(
    prospect: Callable[[], str] = lambda: "the same command goes on from here",
) -> Iterator[None]:
    """Have an interrupt of the work inside say what becomes of that work: the prospect
    is called when it comes, from any thread."""
    _prospects.append(prospect)
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(prospect()) from None
    finally:
        _prospects.pop()


def is_interrupt(error: BaseException) -> bool:
    """Tell an interrupt by the user from whatever else was raised, such as a
    KeyboardInterrupt by a law in a process that `ending_on_signals`."""
    by_signal = signal.getsignal(signal.SIGINT) is not _end
    return isinstance(error, KeyboardInterrupt) and by_signal


def remove(path: os.PathLike) -> bool:
    """Remove a file or a directory as far as possible; tell whether there was one."""
    there = os.path.lexists(path)
    if os.path.isdir(path) and not os.path.islink(path):
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            os.unlink(path)
    return there


def remove_for_good(path: os.PathLike, remove: Remove = remove) -> None:
    """Remove what other threads may be writing still, until it stays away."""
    limit = time.monotonic() + PATIENCE
    while remove(path) and time.monotonic() < limit:
        time.sleep(SETTLING)


@contextlib.contextmanager
def unfinished(
    path: os.PathLike, remove: Remove = remove, *, awaited: bool = True
) -> Iterator[None]:
    """Have a signal remove the file or directory that is written inside, or a part of
    it.

    Args:
        awaited: whether a thread that is inside is to come to the end of it.
    """
    with _beginning:
        _unfinished[path] = threading.get_ident() if awaited else None, remove
    try:
        yield
    finally:
        _unfinished.pop(path, None)


@contextlib.contextmanager
def ending_on_signals() -> Iterator[None]:
    """End the process at once, with one line on stderr, on Ctrl-C or SIGTERM inside.

    For a process that does nothing else, and its main thread. What it was told to
    ignore it goes on ignoring (`nohup`); after the block it ignores both, since the
    work is done.
    """
    # Windows has no pipe that does not wait; KeyboardInterrupt is raised there.
    if os.name != "posix" or not hasattr(os, "set_blocking"):
        yield
        return
    ready, wake = os.pipe()
    os.set_blocking(wake, False)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    for number in ENDINGS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)
    threading.Thread(target=_watch, args=(ready,), daemon=True).start()
    try:
        yield
    finally:
        for number in ENDINGS:
            signal.signal(number, signal.SIG_IGN)


def _watch(ready: int) -> None:
    """End the process where the main thread cannot, since it is in native code: signals
    are written to the pipe as they come."""
    number = 0
    while number not in ENDINGS:
        number = os.read(ready, 1)[0]
    _end(number)


def _end(number: int, frame=None) -> None:
    """End the process: by the main thread, which a signal stops here, or another."""
    # Not released: of the two threads the second waits here for the end.
    _ending.acquire()
    if _ended_by:
        return  # A second signal has interrupted what serves the first one.
    _ended_by.append(number)
    code, word = ENDINGS[number]
    try:
        with contextlib.suppress(Exception):
            _remove_unfinished()
        with contextlib.suppress(Exception):
            word = f"{word}; {_prospects[-1]()}"
        # A line of progress may stand open on a terminal.
        begin = "\n" if os.isatty(2) else ""
        os.write(2, f"{begin}jaximpact: {word}\n".encode())
    finally:
        # Threads are compiling still: Python's own way out would pull the ground from
        # under them.
        os._exit(code)


def _remove_unfinished() -> None:
    limit = time.monotonic() + PATIENCE
    # Not waited for any longer: the main thread may stand still while it holds it.
    _beginning.acquire(timeout=PATIENCE)
    main = threading.main_thread().ident
    while time.monotonic() < limit:
        if not {thread for thread, _ in list(_unfinished.values())} - {main, None}:
            break
        time.sleep(0.002)
    if _unfinished:
        time.sleep(SETTLING)
    for path, (_, remove) in list(_unfinished.items()):
        remove_for_good(path, remove)

"""Interrupts by Ctrl-C and SIGTERM, and what they leave behind.

In a process of the command line they end it from a thread of their own, and no
KeyboardInterrupt is raised: that exception is dropped inside callbacks of JAX, ctypes
and the garbage collector, becomes another one inside imports, and must wait while
native code compiles. Results that are kept are whole at any moment, as a kill demands;
what remains to be done is to remove the files being written. Where the package is used
from Python, KeyboardInterrupt is raised as ever.
"""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator

ENDINGS: dict[int, tuple[int, str]] = {
    signal.SIGINT: (130, "interrupted"),
    signal.SIGTERM: (143, "terminated"),
}
"""Signal -> exit code, and word for the message."""
PATIENCE = 2.0
"""Seconds that other threads have to finish the files they are writing."""

_prospects: list[Callable[[], str]] = []
_unfinished: dict[os.PathLike, int] = {}
"""Files being written, and the thread of each."""
_beginning = threading.Lock()
"""Lock of whoever begins a file; held for good once the process is ending."""
_ending = threading.RLock()
"""Lock of whoever ends the process, whom a second signal may interrupt."""


def _goes_on() -> str:
    return "the same command goes on from here"


@contextlib.contextmanager
def resumable(prospect: Callable[[], str] = _goes_on) -> Iterator[None]:
    """Have an interrupt of the work inside say what becomes of that work.

    Args:
        prospect: called when the interrupt comes, from any thread.
    """
    _prospects.append(prospect)
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(prospect()) from None
    finally:
        _prospects.pop()


@contextlib.contextmanager
def unfinished(path: os.PathLike) -> Iterator[None]:
    """Have a signal remove the file that is written inside."""
    with _beginning:
        _unfinished[path] = threading.get_ident()
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
    while set(_unfinished.values()) - {main} and time.monotonic() < limit:
        time.sleep(0.002)
    for path in list(_unfinished):
        with contextlib.suppress(OSError):
            os.unlink(path)

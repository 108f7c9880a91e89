"""Locks on open files, between processes: of POSIX, or of Windows.

A lock ends with the process that has it, however that ends.
"""

import contextlib
import errno
import os
import time
from collections.abc import Callable

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None
try:
    import msvcrt
except ImportError:  # POSIX
    msvcrt = None

POLL = 0.05
"""Seconds between looks, on Windows, for the end of another's lock."""


def lock(descriptor: int, *, wait: bool) -> None:
    """Lock an open file, whose position goes to its start. Raises BlockingIOError if
    another process has the lock and this one does not wait, OSError where there are no
    locks."""
    if fcntl is not None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        return
    while not _lock_byte(descriptor):
        if not wait:
            raise BlockingIOError(errno.EAGAIN, "locked by another process")
        time.sleep(POLL)


def _lock_byte(descriptor: int) -> bool:
    """Lock a byte of a file as Windows does; False if another process has it."""
    if msvcrt is None:
        raise OSError(errno.ENOTSUP, "the system has no locks")
    # Behind whatever the file holds: nobody else can read what is locked.
    os.lseek(descriptor, 2**30, os.SEEK_SET)
    try:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)  # pyright: ignore
    except PermissionError:
        return False
    finally:
        os.lseek(descriptor, 0, os.SEEK_SET)
    return True


def close_and_remove(descriptor: int, remove: Callable[[], None]) -> None:
    """End a lock, and remove its file unless the file system refuses.

    The file goes while it is locked, lest another process has a lock on a file that
    nobody else finds. Windows keeps what is open: there it goes afterwards, unless
    another process waits with the file.
    """
    steps = [remove, lambda: os.close(descriptor)]
    for step in steps if fcntl is not None else reversed(steps):
        with contextlib.suppress(OSError):
            step()

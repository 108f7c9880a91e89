"""One process at a time for one output."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from ..interruption import unfinished

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None

SUFFIX = "jaximpact-lock"


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other processes that ask for this lock from writing a file or directory.

    The lock is on a hidden file, inside the directory or beside the file, which is
    removed when the block ends. What a killed process leaves of it locks nothing. Where
    the file system has no locks, the block runs without one.

    Raises BlockingIOError, in one sentence, if another process has the lock.
    """
    target = Path(os.path.realpath(path))
    directory = target.is_dir()
    file = target / f".{SUFFIX}" if directory else _beside(target)
    descriptor = _lock(file, path)
    try:
        # A signal that ends the process removes it as well.
        with unfinished(file) if descriptor is not None else contextlib.nullcontext():
            yield
    finally:
        if descriptor is not None:
            # Removed while it is still locked: see `_lock`.
            with contextlib.suppress(OSError):
                file.unlink(missing_ok=True)
            os.close(descriptor)


def _beside(target: Path) -> Path:
    return target.with_name(f".{target.name}.{SUFFIX}")


def _lock(file: Path, output: Path) -> int | None:
    """A descriptor that holds the lock; None where there are no locks."""
    while fcntl is not None:
        try:
            descriptor = os.open(file, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        except OSError:
            return None
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # The holder before may have removed the file after it was opened here.
            if _is_at(descriptor, file):
                os.truncate(descriptor, 0)
                os.write(descriptor, str(os.getpid()).encode())
                return descriptor
        except BlockingIOError:
            number = os.read(descriptor, 20).decode("ascii", "replace")
            os.close(descriptor)
            who = f"another jaximpact (process {number})" if number else "another"
            raise BlockingIOError(
                f"{output} is being written by {who}; wait for it or choose another "
                "--out"
            ) from None
        except OSError:
            with contextlib.suppress(OSError):
                file.unlink(missing_ok=True)
            os.close(descriptor)
            return None
        os.close(descriptor)
    return None


def _is_at(descriptor: int, file: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(file))
    except FileNotFoundError:
        return False

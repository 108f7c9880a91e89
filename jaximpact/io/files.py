"""Files that users name: read whole, written whole or not at all, by one process at a
time."""

import contextlib
import os
import re
import stat
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..errors import InputError
from ..interruption import unfinished

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None

CONTROLS = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
"""Control characters but for tabs and line ends."""
CONTROL_BYTES = bytes({*range(32), 127} - set(b"\t\n\r"))
NO_BACKSLASH = (
    "a backslash in double quotes begins an escape: write / or single quotes for a path"
)
"""Cure of paths of Windows in TOML."""
LOCK_SUFFIX = "jaximpact-lock"


# --- Reading.


def read_input(path: str | os.PathLike) -> bytes:
    """Read the bytes of a file or a pipe.

    Raises InputError, naming the file, for a directory, for a device, which may never
    end, and for what cannot be read.
    """
    try:
        with open(path, "rb") as file:
            mode = os.fstat(file.fileno()).st_mode
            if stat.S_ISBLK(mode) or (stat.S_ISCHR(mode) and not file.isatty()):
                raise InputError("is a device; a file is needed", file=path)
            return file.read()
    except OSError as error:
        # A path of Windows in double quotes of TOML: \n and \t are no letters there.
        cause = "" if os.fsdecode(path).isprintable() else f"; {NO_BACKSLASH}"
        raise InputError(
            f"cannot be read: {error.strerror}{cause}", file=path
        ) from error
    except InputError:
        raise
    except ValueError as error:
        # A null character, or half of one, in the name.
        raise InputError(f"is no name of a file: {error}", file=path) from None


def read_text(path: Path) -> str:
    """Read a text in UTF-8, with or without a byte order mark; InputError for
    others."""
    return as_text(path, read_input(path))


def as_text(path: Path, data: bytes) -> str:
    """Decode the bytes of a file as UTF-8. Raises InputError, naming the row, for other
    encodings."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            "is not text in UTF-8; save the file in that encoding",
            file=path,
            row=data.count(b"\n", 0, error.start) + 1,
        ) from None


def check_text(path: Path, data: bytes) -> None:
    """Raise InputError, naming the row, for bytes of a file that are no text in UTF-8
    or hold control characters."""
    as_text(path, data)
    # To delete them takes a third of the time that it takes to search for them.
    if len(data.translate(None, CONTROL_BYTES)) == len(data):
        return
    found = re.search(b"[" + re.escape(CONTROL_BYTES) + b"]", data)
    assert found is not None
    what = "a null byte" if found[0] == bytes(1) else found[0]
    raise InputError(
        f"holds {what}; is it a CSV?",
        file=path,
        row=data.count(b"\n", 0, found.start()) + 1,
    )


# --- Writing, whole or not at all.


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path to write to, which takes the name `path` when the block
    ends.

    It lies beside the target, so that the renaming is atomic, and keeps the target's
    suffix. It is removed when the block is left by an exception, and by Ctrl-C; what
    a killed process leaves is hidden and says `partial`. A link is followed.

    Raises OSError where the file system refuses.
    """
    target = _target(path)
    temporary = _temporary(target)
    with unfinished(temporary), naming(path):
        try:
            yield temporary
            os.replace(temporary, target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Have an OSError that names no file, as that of a full disk, name this one."""
    try:
        yield
    except OSError as error:
        if error.errno is not None and error.filename is None:
            error.filename = str(path)
        raise


def write_text(path: Path, text: str) -> None:
    """Write a text whole or not at all; OSError where the file system refuses."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def make_directory(path: Path, *, option: str) -> None:
    """Make a directory if it is not there; InputError, naming the option, where that
    cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{option} {path} cannot be made: {error.strerror}") from error


def check_writable(path: Path, *, option: str) -> None:
    """Raise InputError, naming the option, unless `replacing(path)` will work.

    To be called before a long computation. Devices and pipes are refused, since they
    would be replaced by a file.
    """
    target = _target(path)
    try:
        if target.exists() and not target.is_file():
            raise InputError(f"{option} must be a file, but {path} is something else")
        if not target.parent.is_dir():
            raise InputError(
                f"{option} must lie in an existing directory, but {target.parent} "
                "is none"
            )
        probe = _temporary(target)
        with unfinished(probe):
            probe.touch()
            probe.unlink()
    except OSError as error:
        raise InputError(
            f"{option} {path} cannot be written: {error.strerror}"
        ) from error


def refuse_inputs(outputs: Iterable[tuple[str, Path]], inputs: Iterable[Path]) -> None:
    """Raise InputError if an output, each with the name that messages call it by, is an
    input too."""
    inputs = [*inputs]
    for what, path in outputs:
        if (read := same_file(path, inputs)) is not None:
            raise InputError(
                f"{what} {path} would replace {read}, which is read; choose another "
                "name"
            )


def same_file(path: Path, others: Iterable[Path]) -> Path | None:
    """Find the first of some files that is this one, by whatever name or link; None
    where none is, or this one is not there."""
    for other in others:
        with contextlib.suppress(OSError):
            if os.path.samefile(path, other):
                return other
    return None


def _target(path: Path) -> Path:
    """Find the file to be replaced: a link's target, not the link."""
    return Path(os.path.realpath(path))


def _temporary(target: Path) -> Path:
    return target.with_name(f".{target.stem}.{os.getpid()}.partial{target.suffix}")


# --- Writing by one process at a time.


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other processes that ask for this lock from writing a file or directory.

    The lock is on a hidden file, inside the directory or beside the file, which is
    removed when the block ends. What a killed process leaves of it locks nothing. Where
    the file system has no locks, the block runs without one.

    Raises BlockingIOError, in one sentence, if another process has the lock.
    """
    target = _target(path)
    if target.is_dir():
        file = target / f".{LOCK_SUFFIX}"
    else:
        file = target.with_name(f".{target.name}.{LOCK_SUFFIX}")
    descriptor = _lock(file, path)
    if descriptor is None:
        yield
        return
    try:
        with unfinished(file):  # a signal that ends the process removes it as well
            yield
    finally:
        # Removed while it is still locked: see `_lock`.
        with contextlib.suppress(OSError):
            file.unlink(missing_ok=True)
        os.close(descriptor)


def _lock(file: Path, output: Path) -> int | None:
    """Open a descriptor that holds the lock; None where there are no locks."""
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

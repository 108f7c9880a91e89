"""Files that users name: read whole, written whole or not at all, by one process at a
time."""

import collections
import contextlib
import errno
import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from ..errors import InputError
from ..file_locks import close_and_remove, lock
from ..interruption import unfinished

CONTROLS = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
"""Control characters but for tabs and line ends."""
CONTROL_BYTES = bytes({*range(32), 127} - set(b"\t\n\r"))
WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")
"""First bytes of .xlsx and .xls."""
NO_BACKSLASH = (
    "a backslash in double quotes begins an escape: write / or single quotes for a path"
)
"""Cure of paths of Windows in TOML."""
LOCK_SUFFIX = "jaximpact-lock"
WITHOUT_WAITING = getattr(os, "O_NONBLOCK", 0)
"""Flag with which a pipe is opened at once; 0 on Windows, whose files are no pipes."""


# --- Reading.


def read_input(path: str | os.PathLike, *, once: bool = True) -> bytes:
    """Read the bytes of a file, or of a pipe that somebody writes to.

    Args:
        once: whether nobody opens it again; else a pipe, which is empty by then, is
            refused.

    Raises InputError, naming the file, for a directory, for a device, which may never
    end, for a pipe that would never begin, and for what cannot be read.
    """
    try:
        with open(path, "rb", buffering=0, opener=_open_at_once) as file:
            mode, start = os.fstat(file.fileno()).st_mode, b""
            if stat.S_ISBLK(mode) or (stat.S_ISCHR(mode) and not file.isatty()):
                raise InputError("is a device; a file is needed", file=path)
            if stat.S_ISFIFO(mode):
                if not once:
                    raise InputError(
                        "is a pipe, but is read more than once; a file is needed",
                        file=path,
                    )
                start = file.read(1)  # None while its writer has written nothing
                if start == b"":
                    raise InputError(
                        "is a pipe that nobody writes to; a file is needed", file=path
                    )
            if WITHOUT_WAITING and hasattr(os, "set_blocking"):  # not on Windows
                os.set_blocking(file.fileno(), True)
            return (start or b"") + file.readall()
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


def _open_at_once(path: str, flags: int) -> int:
    """Open a pipe without waiting for who writes to it."""
    return os.open(path, flags | WITHOUT_WAITING)


def read_text(path: Path) -> str:
    """Read a text in UTF-8, with or without a byte order mark; InputError for others,
    and as `read_input`."""
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
            row=_row_of(data, error.start),
        ) from None


def check_text(path: Path, data: bytes) -> None:
    """Raise InputError, naming the row, for bytes of a CSV that are no text in UTF-8 or
    hold control characters, and for a workbook."""
    if data.startswith(WORKBOOKS):
        raise InputError(
            "is a workbook of Excel or another packed file; save the sheet as CSV in "
            "UTF-8",
            file=path,
        )
    as_text(path, data)
    # To delete them takes a third of the time that it takes to search for them.
    if len(data.translate(None, CONTROL_BYTES)) == len(data):
        return
    control = re.search(b"[" + re.escape(CONTROL_BYTES) + b"]", data)
    assert control is not None
    what = "a null byte" if control[0] == bytes(1) else control[0]
    raise InputError(
        f"holds {what}; is it a CSV?",
        file=path,
        row=_row_of(data, control.start()),
    )


def _row_of(data: bytes, place: int) -> int:
    """Count the row of a byte, from 1, by line ends of any kind: a CSV from a Mac may
    have carriage returns alone."""
    return len(re.findall(b"\r\n?|\n", data[:place])) + 1


def by_name(checksums: Mapping[Path, str]) -> dict[str, str]:
    """Name files by their names alone, which another folder leaves as they are, but
    several of one name by their paths."""
    count = collections.Counter(file.name for file in checksums)
    return {
        file.name if count[file.name] == 1 else file.as_posix(): checksum
        for file, checksum in checksums.items()
    }


# --- Writing, whole or not at all.


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path to write to, which takes the name `path` when the block
    ends.

    It lies beside the target, so that the renaming is atomic, and has the suffix of
    `path`. It is removed when the block is left by an exception, and by Ctrl-C; what
    a killed process leaves is hidden and says `partial`. A link is followed.

    Raises OSError where the file system refuses, InputError for what is there and is no
    file.
    """
    target = target_of(path)
    _check_file(path, target)
    temporary = _temporary(path, target)
    with unfinished(temporary), naming(path, temporary):
        try:
            yield temporary
            # The name must not outlive the content in a power cut.
            with open(temporary, "r+b") as file:  # to write, as Windows asks for
                os.fsync(file.fileno())
            os.replace(temporary, target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


@contextlib.contextmanager
def naming(path: Path, temporary: str | Path = "") -> Iterator[None]:
    """Have an OSError that names no file, as that of a full disk, name this one; also
    one that names the temporary file in its place, which the user does not know."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(temporary)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def write_text(path: Path, text: str) -> None:
    """Write a text whole or not at all; OSError where the file system refuses."""
    with replacing(path) as temporary:
        put_text(temporary, text)


def put_text(path: Path, text: str) -> None:
    """Write a text in UTF-8 to a file, the same bytes on all operating systems."""
    path.write_text(text, encoding="utf-8", newline="")


def make_directory(path: Path, *, option: str) -> None:
    """Make a directory if it is not there; InputError, naming the option, where that
    cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{option} {path} cannot be made: {error.strerror}") from error


def check_writable(path: Path, *, option: str) -> None:
    """Raise InputError, naming the option, unless `replacing(path)` will work.

    Devices and pipes are refused, since they would be replaced by a file.
    """
    try:
        target = target_of(path)
        _check_file(path, target, option)
        if not target.parent.is_dir():
            raise InputError(
                f"{option} must lie in an existing directory, but {target.parent} "
                "is none"
            )
        probe = _temporary(path, target)
        with unfinished(probe):
            probe.touch()
            probe.unlink()
        if target.exists():
            # Refused by Windows while another program has the file open.
            os.replace(target, target)
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


def target_of(path: Path) -> Path:
    """Find the file to be replaced: a link's target, not the link. OSError for links
    that lead to each other."""
    target = Path(os.path.realpath(path))
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return target


def _check_file(path: Path, target: Path, option: str = "an output") -> None:
    if target.exists() and not target.is_file():
        raise InputError(f"{option} must be a file, but {path} is something else")


def _temporary(path: Path, target: Path) -> Path:
    # The suffix tells the format: the one that the user gave, not that of a target.
    return target.with_name(f".{target.stem}.{os.getpid()}.partial{path.suffix}")


# --- Writing by one process at a time.


@contextlib.contextmanager
def locked(path: Path, *, beside: bool = False) -> Iterator[None]:
    """Keep other processes that ask for this lock from writing a file or directory.

    The lock is on a hidden file, inside the directory or beside the file, which is
    removed when the block ends. What a killed process leaves of it locks nothing. Where
    the file system has no locks, the block runs without one.

    Args:
        beside: whether the lock of a directory is beside it, too.

    Raises BlockingIOError, in one sentence, if another process has the lock, InputError
    for what is in its place and is none.
    """
    target = target_of(path)
    if target.is_dir() and not beside:
        file = target / f".{LOCK_SUFFIX}"
    else:
        file = target.with_name(f".{target.name}.{LOCK_SUFFIX}")
    _check_lock(file)
    descriptor = _lock(file, path)
    if descriptor is None:
        yield
        return
    try:
        # A signal that ends the process removes it as well.
        with unfinished(file, awaited=False):
            yield
    finally:
        close_and_remove(descriptor, file.unlink)


def _check_lock(file: Path) -> None:
    """Raise InputError for a directory, a pipe, a device or a link in place of a lock:
    what is locked is written to, and removed afterwards."""
    try:
        status = os.lstat(file)
    except OSError:
        return
    if not stat.S_ISREG(status.st_mode) or status.st_nlink > 1:
        raise InputError(
            "is in the place of a lock, but is no file of jaximpact; remove it",
            file=file,
        )


def _lock(file: Path, output: Path) -> int | None:
    """Open a descriptor that holds the lock; None where there are no locks."""
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
    while True:
        try:
            descriptor = os.open(file, flags, 0o666)
        except OSError:
            return None
        try:
            lock(descriptor, wait=False)
            # The holder before may have removed the file after it was opened here.
            if _is_at(descriptor, file):
                os.ftruncate(descriptor, 0)
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
            close_and_remove(descriptor, file.unlink)
            return None
        os.close(descriptor)


def _is_at(descriptor: int, file: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(file))
    except FileNotFoundError:
        return False

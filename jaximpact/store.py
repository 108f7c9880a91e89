"""Results kept in files between runs: bytes, looked up by kind and key.

A file is named by its kind and the SHA-256 of its key, and begins with the SHA-256 of
its name and content: what was cut short, damaged or renamed counts as not there. Files
appear whole or not at all.

`Store` keeps what is only read, such as simulated data sets, beside the study that they
belong to. `PrivateStore` keeps what is run: compiled code. Whoever can write that can
run what he likes as this user, so directory and files must belong to the user, and
nobody else may write to them. On Windows the user's own profile stands for owner and
modes, which Python does not show there. docs/cache.md says what that protects from.
"""

import contextlib
import functools
import hashlib
import os
import re
import secrets
import stat
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

from .file_locks import close_and_remove, lock
from .interruption import unfinished

VARIABLE = "JAXIMPACT_CACHE_DIR"
CACHES = "LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME"
"""Environment variable that names the user's directory of caches."""
LIMIT = 512 * 2**20
"""Bytes of all files of compiled code together; beyond it those go that were not used
for longest."""
LOCK = ".lock"
FILE_NAME = re.compile(r"[a-z]+-[0-9a-f]{64}(\.[0-9a-f]{16}\.partial|\.lock)?")
CHECKSUM_BYTES = hashlib.sha256().digest_size
HAS_OWNERS = hasattr(os, "geteuid")
"""Whether the system says whose a file is and who may write to it; Windows does not."""
NO_LINKS = os.O_NOFOLLOW | os.O_NONBLOCK if HAS_OWNERS else 0
"""Flags with which no link is followed, and no pipe waits for who writes to it."""
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


class Refused(Exception):
    """A directory that others could have changed; the message is one line."""


class Store:
    """Bytes by kind and key, in files of a directory, which is there when something is
    put; whatever else it has is left alone."""

    def __init__(self, path: Path):
        self.path = path

    def get(self, kind: str, key: str) -> bytes | None:
        """Return the content put under a key; None where there is none that is
        whole."""
        path = self._path_of(kind, key)
        try:
            data = self._read(path)
        except OSError:
            return None
        content = data[CHECKSUM_BYTES:]
        return content if data == _with_checksum(path, content) else None

    def put(self, kind: str, key: str, content: bytes) -> None:
        """Keep content under a key; OSError where the file system refuses."""
        path = self._path_of(kind, key)
        self._write(path, _with_checksum(path, content), 0o666)

    def clear(self) -> None:
        """Remove all that is kept, and the directory if that leaves it empty."""
        with contextlib.suppress(OSError):
            for path in self._files():
                path.unlink()
            self.path.rmdir()

    def _path_of(self, kind: str, key: str) -> Path:
        return self.path / f"{kind}-{hashlib.sha256(key.encode()).hexdigest()}"

    def _files(self) -> list[Path]:
        return [path for path in self.path.iterdir() if FILE_NAME.fullmatch(path.name)]

    def _read(self, path: Path) -> bytes:
        with open(os.open(path, os.O_RDONLY | NO_LINKS), "rb") as file:
            status = os.fstat(file.fileno())
            # A device may have no end.
            if not stat.S_ISREG(status.st_mode) or not self._is_trusted(status):
                return b""
            return file.read()

    def _is_trusted(self, status: os.stat_result) -> bool:
        return True

    def _write(self, path: Path, data: bytes, mode: int) -> None:
        partial = path.with_name(f"{path.name}.{secrets.token_hex(8)}.partial")
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
        with unfinished(partial):
            try:
                with open(os.open(partial, flags, mode), "wb") as file:
                    file.write(data)
                os.replace(partial, path)
            except BaseException:
                with contextlib.suppress(OSError):
                    partial.unlink()
                raise


class PrivateStore(Store):
    """Compiled code by kind and key, in a directory made for the user alone if need be.

    Raises OSError where the file system refuses, Refused where others could write.
    """

    def __init__(self, path: Path):
        super().__init__(path)
        _make_private_directory(path)
        status = os.lstat(path)
        if stat.S_ISLNK(status.st_mode):
            raise Refused(f"{path} is a link")
        if HAS_OWNERS and status.st_uid != os.geteuid():
            raise Refused(f"{path} belongs to another user")
        # OSError for what is no directory.
        is_ours = len(self._files()) == len(os.listdir(path))
        if HAS_OWNERS and status.st_mode & OTHERS_WRITE:
            # A directory that is for other things too, such as /tmp, stays as it is.
            if not is_ours:
                raise Refused(f"others may write to {path}; chmod 700 would close it")
            path.chmod(stat.S_IRWXU)

    def get(self, kind: str, key: str) -> bytes | None:
        """Return the content put under a key; None where there is none, or none to be
        trusted."""
        content = super().get(kind, key)
        if content is not None:
            # The time of use; a directory may be for reading only.
            with contextlib.suppress(OSError):
                os.utime(self._path_of(kind, key))
        return content

    def put(self, kind: str, key: str, content: bytes) -> None:
        """Keep content under a key, unless the file system refuses."""
        path = self._path_of(kind, key)
        with contextlib.suppress(OSError):
            self._write(path, _with_checksum(path, content), 0o600)
            self._remove_oldest()

    @contextlib.contextmanager
    def making(self, kind: str, key: str) -> Iterator[None]:
        """Have other processes that make the same content wait inside this until it is
        there, so that workers that start together compile once.

        A process that is killed does not hold up the others. Where the file system has
        no locks, processes do not wait for each other.
        """
        path = self._path_of(kind, key).with_suffix(LOCK)
        descriptor = None
        with contextlib.ExitStack() as stack:
            # A directory may be for reading only.
            with contextlib.suppress(OSError):
                descriptor = os.open(path, os.O_RDWR | os.O_CREAT | NO_LINKS, 0o600)
                lock(descriptor, wait=True)
            # From here on the lock is this process's own.
            stack.enter_context(unfinished(path, awaited=False))
            try:
                yield
            finally:
                # Who waits for a file that is removed finds the content by then.
                if descriptor is not None:
                    close_and_remove(descriptor, path.unlink)

    def _is_trusted(self, status: os.stat_result) -> bool:
        return not HAS_OWNERS or (
            status.st_uid == os.geteuid() and not status.st_mode & OTHERS_WRITE
        )

    def _remove_oldest(self) -> None:
        uses = []
        for path in self._files():
            # Another process may have removed it.
            with contextlib.suppress(FileNotFoundError):
                status = path.lstat()
                uses.append((status.st_mtime_ns, status.st_size, path))
        total = sum(size for _, size, _ in uses)
        for _, size, path in sorted(uses):
            if total <= LIMIT:
                return
            with contextlib.suppress(OSError):
                path.unlink()
            total -= size


@functools.cache
def open_cache() -> PrivateStore | None:
    """Open the store of compiled code of this process; None where there can be none.

    It is in `JAXIMPACT_CACHE_DIR`, empty for no cache, else in `jaximpact` in the
    user's directory of caches (`XDG_CACHE_HOME`, on Windows `LOCALAPPDATA`; else
    `~/.cache`). Warns of a directory that is refused.
    """
    try:
        path = _directory()
        return None if path is None else PrivateStore(path)
    except Refused as refused:
        warnings.warn(f"compiled code is not kept: {refused}", stacklevel=2)
    except OSError:
        # A directory that cannot be written to costs time only.
        pass
    return None


def kept(key: str, make: Callable[[], bytes]) -> bytes:
    """Return the machine code that `make` gives, or gave another time under this key,
    which names everything that the code depends on."""
    cache = open_cache()
    if cache is None:
        return make()
    stored = cache.get("machine", key)
    if stored is None:
        with cache.making("machine", key):
            # Another process may have made it meanwhile.
            stored = cache.get("machine", key)
            if stored is None:
                stored = make()
                cache.put("machine", key, stored)
    return stored


def _directory() -> Path | None:
    stated = os.environ.get(VARIABLE)
    if stated == "":
        return None
    if stated is not None:
        if not os.path.isabs(stated):
            raise Refused(f"{VARIABLE} must be an absolute path, but is {stated}")
        if not HAS_OWNERS:
            _check_profile(stated)
        return Path(stated)
    caches = os.environ.get(CACHES, "")
    if not os.path.isabs(caches):
        # `~` itself where there is no home; one that is not there is not made.
        home = os.path.expanduser("~")
        if not os.path.isdir(home):
            return None
        caches = os.path.join(home, ".cache")
    return Path(caches, "jaximpact") if os.path.isabs(caches) else None


def _check_profile(path: str) -> None:
    """Raise Refused for a directory outside of the user's profile, which nothing shows
    to be the user's alone."""
    profile = os.path.realpath(os.path.expanduser("~"))
    if not Path(os.path.realpath(path)).is_relative_to(profile):
        raise Refused(
            f"{path} is not in {profile}, and only there the system keeps others from "
            "writing"
        )


def _with_checksum(path: Path, content: bytes) -> bytes:
    # Of the name too, so that no file can be put in place of another.
    return hashlib.sha256(f"{path.name}\n".encode() + content).digest() + content


def _make_private_directory(path: Path) -> None:
    missing = [each for each in (path, *path.parents) if not os.path.lexists(each)]
    for each in reversed(missing):
        with contextlib.suppress(FileExistsError):
            each.mkdir(stat.S_IRWXU)

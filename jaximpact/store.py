"""Results kept in files between runs: bytes, found again by kind and key.

A file is named by its kind and the SHA-256 of its key, and begins with a code of its
name and content: what was cut short, damaged or put in another's place counts as not
there. Files appear whole or not at all.

`Store` keeps what is only read, such as fits, beside the study that they belong to.
`PrivateStore` keeps what is run: compiled code. Whoever can write that can run what he
likes as this user, so nothing is read unless the directory and the file belong to the
user, nobody else may write to them, and the code was made with a key that only the user
can read (HMAC-SHA256). docs/cache.md says what that protects from.
"""

import contextlib
import functools
import hashlib
import hmac
import os
import re
import secrets
import stat
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

from .interruption import unfinished

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None

VARIABLE = "JAXIMPACT_CACHE_DIR"
LIMIT = 512 * 2**20
"""Bytes of all files of compiled code together; beyond it those go that were not used
for longest."""
LOCK = ".lock"
FILE_NAME = re.compile(r"[a-z]+-[0-9a-f]{64}(\.[0-9a-f]{16}\.partial|\.lock)?")
KEY = "key"
KEY_BYTES = 32
CODE_BYTES = hashlib.sha256().digest_size
OTHERS = stat.S_IRWXG | stat.S_IRWXO
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


class Refused(Exception):
    """A file or directory that others could have changed; the message is one line."""


class Store:
    """Bytes by kind and key, in files of a directory.

    Args:
        path: the directory, which is there when something is put; whatever else it
            holds is left alone.
    """

    def __init__(self, path: Path):
        self.path = path
        self._key = b""
        # Where a descriptor is held, files are looked up in the directory that was
        # checked, not by its path, where another one may lie by then.
        self._directory: int | None = None

    def get(self, kind: str, key: str) -> bytes | None:
        """Return the content put under a key; None where there is none, or none to be
        trusted."""
        name = _file_name(kind, key)
        with contextlib.suppress(OSError, Refused):
            data = self._read(name)
            content = data[CODE_BYTES:]
            if hmac.compare_digest(data[:CODE_BYTES], self._code(name, content)):
                return content
        return None

    def put(self, kind: str, key: str, content: bytes) -> None:
        """Keep content under a key; OSError where the file system refuses."""
        name = _file_name(kind, key)
        self._write(name, self._code(name, content) + content, 0o666)

    def clear(self) -> None:
        """Remove all that is kept, and the directory if that leaves it empty."""
        with contextlib.suppress(OSError):
            for path in self.path.iterdir():
                if FILE_NAME.fullmatch(path.name):
                    path.unlink()
            self.path.rmdir()

    def _code(self, name: str, content: bytes) -> bytes:
        # With its name, so that no file can be put in place of another.
        code = hmac.new(self._key, f"{name}\n".encode(), "sha256")
        code.update(content)
        return code.digest()

    def _read(self, name: str) -> bytes:
        path = self.path / name
        if not path.is_file():  # A pipe would wait for who writes to it.
            raise Refused(f"{path} is none of its files")
        return path.read_bytes()

    def _write(self, name: str, data: bytes, mode: int) -> None:
        partial = f"{name}.{secrets.token_hex(8)}.partial"
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
        here = self._directory
        before, after = (
            file if here is not None else self.path / file for file in (partial, name)
        )
        with unfinished(self.path / partial):
            try:
                with open(os.open(before, flags, mode, dir_fd=here), "wb") as file:
                    if here is not None:  # whatever the umask
                        os.fchmod(file.fileno(), mode)
                    file.write(data)
                os.replace(before, after, src_dir_fd=here, dst_dir_fd=here)
            except BaseException:
                with contextlib.suppress(OSError):
                    os.unlink(before, dir_fd=here)
                raise


class PrivateStore(Store):
    """Compiled code by kind and key, in a directory of the user's own that is checked
    and stays open.

    Args:
        path: the directory, made if need be.
        own: whether its name alone shows that it is for this.

    Raises OSError where the file system refuses, Refused where others could write.
    """

    def __init__(self, path: Path, *, own: bool):
        super().__init__(path)
        _make_private_directory(path)
        # Before it is opened, which the file system may refuse for another user's.
        self._check_owner(os.lstat(path))
        directory = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        self._directory = directory
        try:
            self._check_directory(directory, own)
            self._key = self._get_key()
        except BaseException:
            os.close(directory)
            raise

    def get(self, kind: str, key: str) -> bytes | None:
        """Return the content put under a key; None where there is none, or none to be
        trusted."""
        content = super().get(kind, key)
        if content is not None:
            # The time of use; a directory may be for reading only.
            with contextlib.suppress(OSError):
                os.utime(_file_name(kind, key), dir_fd=self._directory)
        return content

    def put(self, kind: str, key: str, content: bytes) -> None:
        """Keep content under a key, unless the file system refuses."""
        name = _file_name(kind, key)
        with contextlib.suppress(OSError):
            self._write(name, self._code(name, content) + content, 0o600)
            self._remove_oldest()

    @contextlib.contextmanager
    def making(self, kind: str, key: str) -> Iterator[None]:
        """Have other processes that make the same content wait inside this until it is
        there, so that workers that start together compile once.

        A process that is killed holds nobody up. Where the file system has no locks,
        processes do not wait for each other.
        """
        name = f"{_file_name(kind, key)}{LOCK}"
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW
        with contextlib.ExitStack() as stack:
            # A directory may be for reading only.
            with contextlib.suppress(OSError):
                descriptor = os.open(name, flags, 0o600, dir_fd=self._directory)
                stack.callback(os.close, descriptor)
                if fcntl is not None:
                    fcntl.flock(descriptor, fcntl.LOCK_EX)
            # From here on the lock is this process's own.
            stack.enter_context(unfinished(self.path / name, awaited=False))
            try:
                yield
            finally:
                # Who waits for a file that is removed finds the content by then.
                with contextlib.suppress(OSError):
                    os.unlink(name, dir_fd=self._directory)

    def _check_owner(self, status: os.stat_result) -> None:
        if stat.S_ISLNK(status.st_mode):
            raise Refused(f"{self.path} is a link")
        if status.st_uid != os.geteuid():
            raise Refused(f"{self.path} belongs to another user")

    def _check_directory(self, directory: int, own: bool) -> None:
        status = os.fstat(directory)
        self._check_owner(status)
        if not status.st_mode & OTHERS:
            return
        files = os.listdir(directory)
        # A directory that is for other things too, such as /tmp, stays as it is.
        if own or all(name == KEY or FILE_NAME.fullmatch(name) for name in files):
            os.fchmod(directory, stat.S_IRWXU)
        elif status.st_mode & OTHERS_WRITE:
            raise Refused(f"others may write to {self.path}")

    def _get_key(self) -> bytes:
        """Return the key of the directory, made where there is none: by one of the
        processes that start together, or what another keeps would count as not
        there."""
        key = self._stored_key()
        if key is None:
            with self.making(KEY, KEY):
                key = self._stored_key()
                if key is None:
                    self._write(KEY, secrets.token_bytes(KEY_BYTES), 0o600)
        # Where the file system has no locks another process may have written its own.
        return self._read(KEY, forbidden=OTHERS) if key is None else key

    def _stored_key(self) -> bytes | None:
        with contextlib.suppress(FileNotFoundError):
            key = self._read(KEY, forbidden=OTHERS)
            if len(key) == KEY_BYTES:
                return key
        return None

    def _read(self, name: str, forbidden: int = OTHERS_WRITE) -> bytes:
        """Read a file of the user's own; Refused if it has any of the forbidden
        modes."""
        # A pipe would wait for who writes to it.
        flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK
        with open(os.open(name, flags, dir_fd=self._directory), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode) or status.st_size > LIMIT:
                raise Refused(f"{self.path / name} is none of its files")
            if status.st_uid != os.geteuid():
                raise Refused(f"{self.path / name} belongs to another user")
            if status.st_mode & forbidden:
                raise Refused(f"{self.path / name} is open to others")
            return file.read()

    def _remove_oldest(self) -> None:
        found = []
        for name in filter(FILE_NAME.fullmatch, os.listdir(self._directory)):
            # Another process may have removed it.
            with contextlib.suppress(FileNotFoundError):
                status = os.stat(name, dir_fd=self._directory, follow_symlinks=False)
                found.append((status.st_mtime_ns, status.st_size, name))
        total = sum(size for _, size, _ in found)
        for _, size, name in sorted(found):
            if total <= LIMIT:
                return
            with contextlib.suppress(OSError):
                os.unlink(name, dir_fd=self._directory)
            total -= size


@functools.cache
def open_cache() -> PrivateStore | None:
    """Open the store of compiled code of this process; None where there can be none.

    It is in `JAXIMPACT_CACHE_DIR`, empty for no cache, else in `jaximpact` in the
    user's directory of caches (`XDG_CACHE_HOME`, else `~/.cache`). Warns of a directory
    that is refused.
    """
    try:
        place = _place()
        return None if place is None else PrivateStore(place[0], own=place[1])
    except Refused as refused:
        warnings.warn(f"compiled code is not kept: {refused}", stacklevel=2)
    except OSError:
        # A directory that cannot be written to costs time only.
        pass
    return None


def kept(key: str, make: Callable[[], bytes]) -> bytes:
    """Return the machine code that `make` gives, or gave another time under this key.

    Args:
        key: names everything that the code depends on.
    """
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


def _place() -> tuple[Path, bool] | None:
    """Find the directory, and whether its name alone shows that it is for this."""
    stated = os.environ.get(VARIABLE)
    if stated == "" or os.name != "posix":
        return None
    if stated is not None:
        if not os.path.isabs(stated):
            raise Refused(f"{VARIABLE} must be an absolute path, but is {stated}")
        return Path(stated), False
    caches = os.environ.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(caches):
        # `~` itself where there is no home; one that is not there is not made.
        home = os.path.expanduser("~")
        if not os.path.isdir(home):
            return None
        caches = os.path.join(home, ".cache")
    return (Path(caches, "jaximpact"), True) if os.path.isabs(caches) else None


def _file_name(kind: str, key: str) -> str:
    return f"{kind}-{hashlib.sha256(key.encode()).hexdigest()}"


def _make_private_directory(path: Path) -> None:
    """Make a directory and those above it for the user alone, whatever the umask."""
    missing = [each for each in (path, *path.parents) if not os.path.lexists(each)]
    for each in reversed(missing):
        with contextlib.suppress(FileExistsError):
            os.mkdir(each, stat.S_IRWXU)
            os.chmod(each, stat.S_IRWXU)

"""Results kept in files between runs: bytes, found again by kind and key.

A file is named by its kind and the SHA-256 of its key, and begins with a code of its
name and content: what was cut short, damaged or put in another's place counts as not
there. Files appear whole or not at all.

`Store` keeps what is only read, such as fits, beside the study that they belong to.
`PrivateStore` keeps what is run: compiled code. Whoever can write that can run what he
likes as this user, so nothing is read unless the directory and the file belong to the
user, nobody else may write to them, and the code was made with a key that only the user
can read (HMAC-SHA256). On Windows the user's own profile stands for owner and modes,
which Python does not show there. docs/cache.md says what that protects from.
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
KEY = "key"
KEY_BYTES = 32
CODE_BYTES = hashlib.sha256().digest_size
HAS_OWNERS = (
    all(
        hasattr(os, name)
        for name in ("geteuid", "fchmod", "O_DIRECTORY", "O_NOFOLLOW", "O_NONBLOCK")
    )
    and {os.open, os.stat, os.unlink, os.utime} <= os.supports_dir_fd
)
"""Whether the system says whose a file is and who may write to it, and finds files in a
directory that is held open. Windows does not."""
NO_LINKS = os.O_NOFOLLOW | os.O_NONBLOCK if HAS_OWNERS else 0
"""Flags with which no link is followed, and no pipe waits for who writes to it."""
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

    def _at(self, name: str) -> str | Path:
        """Return what to call a file by, beside the descriptor of its directory."""
        return self.path / name if self._directory is None else name

    def _read(self, name: str) -> bytes:
        path = self.path / name
        if not path.is_file():  # A pipe would wait for who writes to it.
            raise Refused(f"{path} is none of its files")
        return path.read_bytes()

    def _write(self, name: str, data: bytes, mode: int) -> None:
        partial = f"{name}.{secrets.token_hex(8)}.partial"
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
        here, before, after = self._directory, self._at(partial), self._at(name)
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

    Where there are no owners, on Windows, it is not held open, but in the user's
    profile, which the system keeps for the user.

    Args:
        path: the directory, made if need be.
        own: whether its name alone shows that it is for this.

    Raises OSError where the file system refuses, Refused where others could write.
    """

    def __init__(self, path: Path, *, own: bool):
        super().__init__(path)
        if not HAS_OWNERS:
            _check_profile(path, own)
        _make_private_directory(path)
        if not HAS_OWNERS:
            self._key = self._get_key()
            return
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
                os.utime(self._at(_file_name(kind, key)), dir_fd=self._directory)
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
        flags, descriptor = os.O_RDWR | os.O_CREAT | NO_LINKS, None
        with contextlib.ExitStack() as stack:
            # A directory may be for reading only.
            with contextlib.suppress(OSError):
                descriptor = os.open(
                    self._at(name), flags, 0o600, dir_fd=self._directory
                )
                lock(descriptor, wait=True)
            # From here on the lock is this process's own.
            stack.enter_context(unfinished(self.path / name, awaited=False))
            try:
                yield
            finally:
                # Who waits for a file that is removed finds the content by then.
                if descriptor is not None:
                    close_and_remove(descriptor, lambda: self._unlink(name))

    def _unlink(self, name: str) -> None:
        os.unlink(self._at(name), dir_fd=self._directory)

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
        flags, place = os.O_RDONLY | NO_LINKS, self._at(name)
        with open(os.open(place, flags, dir_fd=self._directory), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode) or status.st_size > LIMIT:
                raise Refused(f"{self.path / name} is none of its files")
            if HAS_OWNERS and status.st_uid != os.geteuid():
                raise Refused(f"{self.path / name} belongs to another user")
            if HAS_OWNERS and status.st_mode & forbidden:
                raise Refused(f"{self.path / name} is open to others")
            return file.read()

    def _remove_oldest(self) -> None:
        found = []
        here = self._directory
        names = os.listdir(self.path if here is None else here)
        for name in filter(FILE_NAME.fullmatch, names):
            # Another process may have removed it.
            with contextlib.suppress(FileNotFoundError):
                status = os.stat(self._at(name), dir_fd=here, follow_symlinks=False)
                found.append((status.st_mtime_ns, status.st_size, name))
        total = sum(size for _, size, _ in found)
        for _, size, name in sorted(found):
            if total <= LIMIT:
                return
            with contextlib.suppress(OSError):
                self._unlink(name)
            total -= size


@functools.cache
def open_cache() -> PrivateStore | None:
    """Open the store of compiled code of this process; None where there can be none.

    It is in `JAXIMPACT_CACHE_DIR`, empty for no cache, else in `jaximpact` in the
    user's directory of caches (`XDG_CACHE_HOME`, on Windows `LOCALAPPDATA`; else
    `~/.cache`). Warns of a directory that is refused.
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
    if stated == "":
        return None
    if stated is not None:
        if not os.path.isabs(stated):
            raise Refused(f"{VARIABLE} must be an absolute path, but is {stated}")
        return Path(stated), False
    caches = os.environ.get(CACHES, "")
    if not os.path.isabs(caches):
        # `~` itself where there is no home; one that is not there is not made.
        home = os.path.expanduser("~")
        if not os.path.isdir(home):
            return None
        caches = os.path.join(home, ".cache")
    return (Path(caches, "jaximpact"), True) if os.path.isabs(caches) else None


def _file_name(kind: str, key: str) -> str:
    return f"{kind}-{hashlib.sha256(key.encode()).hexdigest()}"


def _check_profile(path: Path, own: bool) -> None:
    """Raise Refused for a directory that nothing shows to be the user's alone: one that
    is named, and is not in the user's profile."""
    profile = os.path.realpath(os.path.expanduser("~"))
    if not own and not Path(os.path.realpath(path)).is_relative_to(profile):
        raise Refused(
            f"{path} is not in {profile}, and only there the system keeps others from "
            "writing"
        )


def _make_private_directory(path: Path) -> None:
    """Make a directory and those above it for the user alone, whatever the umask."""
    missing = [each for each in (path, *path.parents) if not os.path.lexists(each)]
    for each in reversed(missing):
        with contextlib.suppress(FileExistsError):
            os.mkdir(each, stat.S_IRWXU)
            os.chmod(each, stat.S_IRWXU)

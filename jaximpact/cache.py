"""Compiled code kept on disk, in a directory of the user's own.

What is kept is run, and so whoever can write it can run what he likes as this user.
Nothing is read unless the directory and the file belong to the user, nobody else may
write to them, and the file carries a code (HMAC-SHA256) made with a key that only the
user can read. docs/cache.md says what that protects from.
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
from pathlib import Path

from .interruption import unfinished

VARIABLE = "JAXIMPACT_CACHE_DIR"
LIMIT = 512 * 2**20
"""Bytes of all files together; beyond it those go that were not used for longest."""
FILE_NAME = re.compile(r"[a-z]+-[0-9a-f]{64}(\.[0-9a-f]{16}\.partial)?")
KEY = "key"
KEY_BYTES = 32
CODE_BYTES = hashlib.sha256().digest_size
OTHERS = stat.S_IRWXG | stat.S_IRWXO
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


class Refused(Exception):
    """What others could have changed is not used; the message is one line."""


class Cache:
    """Bytes by their names, in a directory that is checked and stays open.

    Args:
        path: the directory, made if need be.
        own: whether its name alone shows that it is for this.

    Raises OSError where the file system refuses, Refused where others could write.
    """

    def __init__(self, path: Path, *, own: bool):
        self.path = path
        _make_directory(path)
        # Before it is opened, which the file system may refuse for another user's.
        self._check_owner(os.lstat(path))
        # Files are looked up in the directory that was checked, not by its path, where
        # another one may lie by then.
        self._directory = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        try:
            self._check_directory(own)
            self._key = self._get_key()
        except BaseException:
            os.close(self._directory)
            raise

    def get(self, kind: str, key: str) -> bytes | None:
        """What was put under a key; None where nothing is, or nothing to be trusted."""
        name = _file_name(kind, key)
        with contextlib.suppress(OSError, Refused):
            data = self._read(name, OTHERS_WRITE)
            content = data[CODE_BYTES:]
            if hmac.compare_digest(data[:CODE_BYTES], self._code(name, content)):
                # The time of use; a directory may be for reading only.
                with contextlib.suppress(OSError):
                    os.utime(name, dir_fd=self._directory)
                return content
        return None

    def put(self, kind: str, key: str, content: bytes) -> None:
        """Keep something. Where the file system refuses it is not kept."""
        name = _file_name(kind, key)
        with contextlib.suppress(OSError):
            self._write(name, self._code(name, content) + content)
            self._remove_oldest()

    def _code(self, name: str, content: bytes) -> bytes:
        # With its name, so that no file can be put in place of another.
        code = hmac.new(self._key, f"{name}\n".encode(), "sha256")
        code.update(content)
        return code.digest()

    def _check_owner(self, status: os.stat_result) -> None:
        if stat.S_ISLNK(status.st_mode):
            raise Refused(f"{self.path} is a link")
        if status.st_uid != os.geteuid():
            raise Refused(f"{self.path} belongs to another user")

    def _check_directory(self, own: bool) -> None:
        status = os.fstat(self._directory)
        self._check_owner(status)
        if not status.st_mode & OTHERS:
            return
        files = os.listdir(self._directory)
        # A directory that is for other things too, such as /tmp, stays as it is.
        if own or all(name == KEY or FILE_NAME.fullmatch(name) for name in files):
            os.fchmod(self._directory, stat.S_IRWXU)
        elif status.st_mode & OTHERS_WRITE:
            raise Refused(f"others may write to {self.path}")

    def _get_key(self) -> bytes:
        """The key of the directory, made where there is none. Of processes that make
        one at once, one is lost, and what was kept with it is made again."""
        with contextlib.suppress(FileNotFoundError):
            key = self._read(KEY, OTHERS)
            if len(key) == KEY_BYTES:
                return key
        self._write(KEY, secrets.token_bytes(KEY_BYTES))
        return self._read(KEY, OTHERS)

    def _read(self, name: str, forbidden: int) -> bytes:
        """A file of the user's own; Refused if it has any of the forbidden modes."""
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

    def _write(self, name: str, data: bytes) -> None:
        partial = f"{name}.{secrets.token_hex(8)}.partial"
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
        here = {"src_dir_fd": self._directory, "dst_dir_fd": self._directory}
        with unfinished(self.path / partial):
            try:
                descriptor = os.open(partial, flags, 0o600, dir_fd=self._directory)
                with open(descriptor, "wb") as file:
                    os.fchmod(descriptor, 0o600)
                    file.write(data)
                os.replace(partial, name, **here)
            except BaseException:
                with contextlib.suppress(OSError):
                    os.unlink(partial, dir_fd=self._directory)
                raise

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
def open_cache() -> Cache | None:
    """The cache of this process; None where there can be none.

    It is in `JAXIMPACT_CACHE_DIR`, empty for no cache, else in `jaximpact` in the
    user's directory of caches (`XDG_CACHE_HOME`, else `~/.cache`). Warns of a directory
    that is refused.
    """
    try:
        place = _place()
        return None if place is None else Cache(place[0], own=place[1])
    except Refused as refused:
        warnings.warn(f"compiled code is not kept: {refused}", stacklevel=2)
    except OSError:
        # A directory that cannot be written to costs time only.
        pass
    return None


def _place() -> tuple[Path, bool] | None:
    """The directory, and whether its name alone shows that it is for this."""
    stated = os.environ.get(VARIABLE)
    if stated == "" or os.name != "posix":
        return None
    if stated is not None:
        if not os.path.isabs(stated):
            raise Refused(f"{VARIABLE} must be an absolute path, but is {stated}")
        return Path(stated), False
    caches = os.environ.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(caches):
        # `~` itself where there is no home.
        caches = os.path.expanduser("~/.cache")
    return (Path(caches, "jaximpact"), True) if os.path.isabs(caches) else None


def _file_name(kind: str, key: str) -> str:
    return f"{kind}-{hashlib.sha256(key.encode()).hexdigest()}"


def _make_directory(path: Path) -> None:
    """Make a directory and those above it for the user alone, whatever the umask."""
    missing = [each for each in (path, *path.parents) if not os.path.lexists(each)]
    for each in reversed(missing):
        with contextlib.suppress(FileExistsError):
            os.mkdir(each, stat.S_IRWXU)
            os.chmod(each, stat.S_IRWXU)

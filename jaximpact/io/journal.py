"""Results kept in a file as they come, so that a killed run is resumed.

The file is a line of JSON that says what is computed, then blocks: a count of rows and
a checksum, then the rows. A block that a kill or a power cut left unfinished does not
match its checksum; it and whatever follows is cut off when the journal is opened again.
So is a block with rows of an index beyond the end, or of one that came before.
"""

import contextlib
import json
import os
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..interruption import unfinished
from .files import check_writable, locked, naming

HEAD = struct.Struct("<QI")
"""Head of a block: count of rows, CRC-32 of their bytes."""


class Journal:
    """Rows of numbers, each with its index in the whole.

    Args:
        path: the file; made if it is not there.
        subject: what is computed, ready for JSON; equal subjects have equal results.
        columns: names of the numbers in a row.
        count: how many rows there are in all; indices run from 0.
        stays: whether the file stays at the end if it has no row.

    Raises InputError if the file is a journal of something else, or none, or cannot be
    written; BlockingIOError while another process writes it.
    """

    def __init__(
        self,
        path: Path,
        subject: dict,
        columns: list[str],
        count: int,
        *,
        stays: bool = False,
    ):
        self.path, self.count, self.stays = Path(path), count, stays
        check_writable(self.path, option="the journal")
        self.row = np.dtype([("index", "<i8"), ("numbers", "<f8", (len(columns),))])
        line = json.dumps(subject | {"columns": columns}, sort_keys=True) + "\n"
        self.first_line = line.encode()
        with contextlib.ExitStack() as stack:
            stack.enter_context(locked(self.path))
            try:
                self.file = stack.enter_context(open(self.path, "a+b"))
            except OSError as error:
                raise InputError(
                    f"cannot be written: {error.strerror}", file=self.path
                ) from error
            with naming(self.path):
                self._cut_off_unfinished()
            stack.enter_context(
                unfinished(self.path, self._remove_if_empty, awaited=False)
            )
            self._open = stack.pop_all()

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, *exception) -> None:
        # On a full disk closing fails too, and the lock is to go all the same.
        with self._open, naming(self.path):
            self.file.close()
            self._remove_if_empty(self.path)

    def append(self, indices: np.ndarray, numbers: np.ndarray) -> None:
        """Add rows: indices `(n,)`, numbers `(n, columns)`. The operating system has
        them when it returns."""
        rows = np.empty(len(indices), self.row)
        rows["index"], rows["numbers"] = indices, numbers
        data = rows.tobytes()
        with naming(self.path):
            self.file.write(HEAD.pack(len(rows), zlib.crc32(data)) + data)
            self.file.flush()

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Read places and numbers of all rows that are there."""
        rows = np.concatenate([np.empty(0, self.row), *self._whole_blocks()])
        return rows["index"], rows["numbers"]

    def _remove_if_empty(self, path: os.PathLike) -> bool:
        with contextlib.suppress(OSError):
            if not self.stays and os.path.getsize(path) == len(self.first_line):
                os.unlink(path)
                return True
        return False

    def _cut_off_unfinished(self) -> None:
        self.file.seek(0)
        first = self.file.readline(len(self.first_line) + 1)
        if not self.first_line.startswith(first):
            raise InputError(
                "is no journal of this run, but of other scenes, settings or "
                "versions; run what it belongs to, or remove it",
                file=self.path,
            )
        if first != self.first_line:
            self._begin()
        whole = len(self.first_line)
        for _ in self._whole_blocks():
            whole = self.file.tell()
        self.file.truncate(whole)

    def _begin(self) -> None:
        """Write the first line alone. On a full disk no file stays behind, and the
        error is that of writing: closing fails too, but closes."""
        self.file.truncate(0)
        try:
            self.file.write(self.first_line)
            self.file.flush()
        except OSError:
            with contextlib.suppress(OSError):
                self.file.close()
            self.path.unlink(missing_ok=True)
            raise

    def _whole_blocks(self) -> Iterator[np.ndarray]:
        """Yield the rows of one block after another, up to the first that is not
        whole."""
        self.file.seek(len(self.first_line))
        missing = np.ones(self.count, bool)
        while block := self._read_block():
            rows = np.frombuffer(block, self.row)
            indices = rows["index"]
            if np.min(indices) < 0 or np.max(indices) >= self.count:
                return
            if len(np.unique(indices)) < len(indices) or not np.all(missing[indices]):
                return
            missing[indices] = False
            yield rows

    def _read_block(self) -> bytes:
        """Read the next block's rows; empty where there is none that is whole."""
        head = self.file.read(HEAD.size)
        if len(head) < HEAD.size:
            return b""
        count, checksum = HEAD.unpack(head)
        # A count of noise must not be taken for a demand of memory.
        left = os.fstat(self.file.fileno()).st_size - self.file.tell()
        if count * self.row.itemsize > left:
            return b""
        data = self.file.read(count * self.row.itemsize)
        return data if zlib.crc32(data) == checksum else b""

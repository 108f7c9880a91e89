"""Results kept in a file as they come, so that a run that was killed can go on.

The file is a line of JSON that says what is computed, then blocks: a count of rows and
a checksum, then the rows. A block that a kill or a power cut left unfinished does not
match its checksum; it and whatever follows is cut off when the journal is opened again.
"""

import json
import os
import struct
import zlib
from pathlib import Path

import numpy as np

from ..errors import InputError
from .files import check_writable

HEAD = struct.Struct("<QI")
"""Of a block: count of rows, CRC-32 of their bytes."""


class Journal:
    """Rows of numbers, each with its place in the whole.

    Args:
        path: the file; made if it is not there.
        subject: what is computed, ready for JSON: equal subjects, equal results.
        columns: names of the numbers in a row.

    Raises InputError if the file is a journal of something else, or none, or cannot be
    written.
    """

    def __init__(self, path: Path, subject: dict, columns: list[str]):
        self.path = Path(path)
        check_writable(self.path, option="the journal")
        self.row = np.dtype([("place", "<i8"), ("numbers", "<f8", (len(columns),))])
        line = json.dumps(subject | {"columns": columns}, sort_keys=True) + "\n"
        self.first_line = line.encode()
        self._cut_off_what_is_not_whole()
        self.file = open(self.path, "ab")  # noqa: SIM115  (open as long as this is)

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, *exception) -> None:
        self.file.close()

    def append(self, places: np.ndarray, numbers: np.ndarray) -> None:
        """Add rows: places `(n,)`, numbers `(n, columns)`. Out of this process's hands
        when it returns."""
        rows = np.empty(len(places), self.row)
        rows["place"], rows["numbers"] = places, numbers
        data = rows.tobytes()
        self.file.write(HEAD.pack(len(rows), zlib.crc32(data)) + data)
        self.file.flush()

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Places and numbers of all rows that are there."""
        parts = [np.empty(0, self.row)]
        with open(self.path, "rb") as file:
            file.seek(len(self.first_line))
            while block := self._read_block(file):
                parts.append(np.frombuffer(block, self.row))
        rows = np.concatenate(parts)
        return rows["place"], rows["numbers"]

    def _cut_off_what_is_not_whole(self) -> None:
        with open(self.path, "a+b") as file:
            file.seek(0)
            first = file.readline()
            if not self.first_line.startswith(first):
                raise InputError(
                    "is no journal of this run, but of other scenes, settings or "
                    "versions; run what it belongs to, or remove it",
                    file=self.path,
                )
            if first != self.first_line:
                file.truncate(0)
                file.write(self.first_line)
                return
            whole = file.tell()
            while self._read_block(file):
                whole = file.tell()
            file.truncate(whole)

    def _read_block(self, file) -> bytes:
        """The next block's rows; empty where there is none that is whole."""
        head = file.read(HEAD.size)
        if len(head) < HEAD.size:
            return b""
        count, checksum = HEAD.unpack(head)
        # A count of noise must not be taken for a demand of memory.
        left = os.fstat(file.fileno()).st_size - file.tell()
        if count * self.row.itemsize > left:
            return b""
        data = file.read(count * self.row.itemsize)
        return data if zlib.crc32(data) == checksum else b""

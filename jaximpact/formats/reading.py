"""Files that users name, read whole."""

import os
import re
import stat
from pathlib import Path

from ..errors import InputError

CONTROLS = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
"""Control characters but for tabs and line ends."""
CONTROL_BYTES = bytes({*range(32), 127} - set(b"\t\n\r"))


def read_input(path: str | os.PathLike) -> bytes:
    """The bytes of a file or a pipe.

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
        raise InputError(f"cannot be read: {error.strerror}", file=path) from error
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        # A null character, or half of one, in the name.
        raise InputError(f"is no name of a file: {error}", file=path) from None


def read_text(path: Path) -> str:
    """A text in UTF-8, with or without a byte order mark; InputError for others."""
    return as_text(path, read_input(path))


def as_text(path: Path, data: bytes) -> str:
    """What bytes of a file say in UTF-8. Raises InputError, naming the row, for other
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
    if len(data.translate(None, CONTROL_BYTES)) < len(data):
        place = re.search(b"[" + re.escape(CONTROL_BYTES) + b"]", data).start()
        byte = data[place : place + 1]
        raise InputError(
            f"holds {'a null byte' if byte == bytes(1) else byte}; is it a CSV?",
            file=path,
            row=data.count(b"\n", 0, place) + 1,
        )

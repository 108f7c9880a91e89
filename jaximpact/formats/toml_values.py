"""Reading values of a TOML file: kinds, ranges and names, each error in one line."""

import math
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import NoReturn

from ..errors import InputError, nearest
from .columns import INPUT_COLUMNS, InputColumn

SOIL_COLUMNS = {n: c for n, c in INPUT_COLUMNS.items() if c.part == "soil"}


def load_toml(path: Path) -> dict:
    """The content of a file; InputError where it cannot be read."""
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=path) from error
    except UnicodeDecodeError as error:
        raise InputError("is not text in UTF-8", file=path) from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"is not valid TOML: {error}", file=path) from error


def unknown(path: Path, key: str, name: str, known) -> NoReturn:
    """Raise InputError for a name, with the nearest known."""
    raise InputError(
        f"is unknown; did you mean {nearest(name, known)}?", file=path, key=key
    )


def check_keys(path: Path, where: str, keys: Iterable[str], known) -> None:
    """Raise InputError for a key that is unknown; `where` is the name of its table, ""
    at the top of the file."""
    for key in keys:
        if key not in known:
            unknown(path, f"{where}.{key}" if where else key, key, known)


KIND_WORDS = {str: "a text", dict: "a table", list: "a list", int: "a whole number"}
REQUIRED = object()


def typed(path: Path, content: dict, key: str, kind: type, default=REQUIRED):
    """A value of one kind, or the default; InputError for another kind."""
    value = content.get(key, default)
    # A TOML boolean is a Python integer.
    if not isinstance(value, kind) or isinstance(value, bool):
        raise InputError(
            f"must be {KIND_WORDS[kind]}, but is {value!r}", file=path, key=key
        )
    return value


def known_table(path: Path, content: dict, name: str, known: tuple[str, ...]) -> dict:
    """A table of the file, with known keys only."""
    table = typed(path, content, name, dict, {})
    check_keys(path, name, table, known)
    return table


def whole(path: Path, content: dict, key: str, default: int, least: int) -> int:
    """A whole number of at least `least`."""
    value = typed(path, content, key, int, default)
    if value < least:
        raise InputError(
            f"must be at least {least}, but is {value}", file=path, key=key
        )
    return value


def choice(path: Path, content: dict, key: str, default: str, known) -> str:
    """One of the known words."""
    value = typed(path, content, key, str, default)
    if value not in known:
        raise InputError(
            f"must be one of {', '.join(known)}, but is {value!r}; did you mean "
            f"{nearest(value, known)}?",
            file=path,
            key=key,
        )
    return value


def number(path: Path, key: str, value) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"must be a number, but is {value!r}", file=path, key=key)
    if not math.isfinite(value):
        raise InputError(f"must be finite, but is {value}", file=path, key=key)
    return float(value)


def allowed(path: Path, key: str, column: InputColumn, value) -> float:
    """A number that the column may hold, in its unit."""
    checked = number(path, key, value)
    if not column.is_allowed(checked):
        raise InputError(
            f"must be {column.requirement}, but is {value}", file=path, key=key
        )
    return checked


def soil_values(path: Path, content: dict, where: str) -> dict[str, float]:
    """Soil parameters of a table; `where` is the table's name."""
    values = {}
    for name, value in content.items():
        if name not in SOIL_COLUMNS:
            unknown(path, f"{where}.{name}", name, SOIL_COLUMNS)
        values[name] = allowed(path, f"{where}.{name}", SOIL_COLUMNS[name], value)
    return values

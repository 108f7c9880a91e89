"""Reading values of a TOML file: kinds, ranges and names, each error in one line."""

import math
import re
import sys
import tomllib
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import NoReturn

from ..errors import InputError, UnusualValueWarning, nearest
from .columns import InputColumn, why_unknown
from .reading import CONTROLS, as_text, read_input

LARGEST_WHOLE = 2**63 - 1
"""What TOML promises to hold."""
DEEPEST = 20
"""Tables and lists inside one another."""
DOTTED = re.compile(r"^\[*(?:[\w-]+\.){500}", re.MULTILINE)
"""A key that tomllib takes minutes to read."""
DIGITS = re.compile(r"[0-9_]{1000,}")


def load_toml(path: Path) -> dict:
    """The content of a file; InputError where it cannot be used."""
    return parse_toml(path, read_input(path))


def parse_toml(path: Path, data: bytes) -> dict:
    """The content of the bytes of a file, of which every value can be shown and every
    text printed; InputError where that is not so."""
    text = as_text(path, data)
    if DOTTED.search(text):
        raise InputError(TOO_DEEP, file=path)
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"is not valid TOML: {error}", file=path) from error
    except RecursionError:
        raise InputError(TOO_DEEP, file=path) from None
    except ValueError:
        # More digits than Python reads.
        found = DIGITS.search(text)
        row = text.count("\n", 0, found.start()) + 1 if found else None
        raise InputError(TOO_LARGE, file=path, row=row) from None
    _check_values(path, content)
    return content


TOO_DEEP = f"holds tables or lists more than {DEEPEST} deep"
TOO_LARGE = (
    f"holds a whole number beyond {LARGEST_WHOLE}; one so large takes a point or an "
    "exponent"
)


def _check_values(path: Path, content: dict) -> None:
    """Raise InputError for what no key may hold."""
    level = [("", content)]
    for _ in range(DEEPEST):
        inner = []
        for key, value in level:
            if isinstance(value, dict):
                for name, one in value.items():
                    where = f"{key}.{name}" if key else name
                    _check_text(path, where, name)
                    inner.append((where, one))
            elif isinstance(value, list):
                inner += [(key, one) for one in value]
            elif isinstance(value, str):
                _check_text(path, key, value)
            elif isinstance(value, int) and abs(value) > LARGEST_WHOLE:
                raise InputError(TOO_LARGE, file=path, key=key)
        if not inner:
            return
        level = inner
    raise InputError(TOO_DEEP, file=path)


def _check_text(path: Path, key: str, text: str) -> None:
    # Tabs and line ends may stand in notes; an escape would command the terminal.
    if not text.isprintable() and CONTROLS.search(text):
        raise InputError(
            "holds a control character, such as an escape; remove it",
            file=path,
            key=key,
        )


def unknown(path: Path, key: str, name: str, known) -> NoReturn:
    """Raise InputError for a name, with what may have been meant."""
    raise InputError(f"is unknown; {why_unknown(name, known)}", file=path, key=key)


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


def whole(
    path: Path,
    content: dict,
    key: str,
    default: int,
    least: int,
    most: int = LARGEST_WHOLE,
) -> int:
    """A whole number from `least` to `most`."""
    value = typed(path, content, key, int, default)
    if not least <= value <= most:
        end = f"least {least}" if value < least else f"most {most}"
        raise InputError(f"must be at {end}, but is {value}", file=path, key=key)
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
    if abs(value) > sys.float_info.max or math.isnan(value):
        raise InputError(f"must be finite, but is {value}", file=path, key=key)
    return float(value)


def allowed(path: Path, key: str, column: InputColumn, value) -> float:
    """A number that the column may hold, in its unit."""
    checked = number(path, key, value)
    if not column.holds(checked):
        raise InputError(
            f"must be {column.requirement}, but is {value}"
            f"{column.hint(checked, column.unit)}",
            file=path,
            key=key,
        )
    return checked


def quantity(path: Path, key: str, column: InputColumn, value) -> float:
    """A number that the column may hold, in its unit, as something has it; warns of one
    that is unusual."""
    checked = allowed(path, key, column, value)
    if not column.is_usual(checked):
        text = f"{path}, key {key}: is {column.told(checked, column.unit)}"
        warnings.warn(UnusualValueWarning(text, column.name), stacklevel=2)
    return checked

"""TOML files: values checked for kind, range and name, and scenes; each error in one
line."""

import dataclasses
import math
import re
import sys
import tomllib
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from ..accuracy import PRESETS
from ..errors import InputError, check_choice, located
from ..parameters import Composite, Part, parts_of
from ..quantities import SLOTS, InputColumn, columns_of, why_unknown
from ..scene import PARTS, Scene
from ..scene_quantities import part_named, replaced_parts, scene_with
from .checks import warn_unusual
from .files import CONTROLS, NO_BACKSLASH, as_text, read_input

LARGEST_WHOLE = 2**63 - 1
"""Largest whole number that TOML promises to hold."""
DEEPEST = 20
"""Levels of tables and lists inside one another."""
DOTTED = re.compile(r"^\[*(?:[\w-]+\.){500}", re.MULTILINE)
"""A key that tomllib takes minutes to read."""
ROW = re.compile(r"at line (\d+)")
"""Row in an error of tomllib."""
BACKSLASH = re.compile(r'"[^"]*\\')
UNQUOTED = re.compile(r"""\s*\[[^]"']*[^]"'\x00-\x7f]""")
"""Head of a table whose name has a letter that TOML takes in quotes only."""
DIGITS = re.compile(r"[0-9_]{1000,}")
TOO_DEEP = f"holds tables or lists more than {DEEPEST} deep"
TOO_LARGE = (
    f"holds a whole number beyond {LARGEST_WHOLE}; one so large takes a point or an "
    "exponent"
)
KIND_WORDS = {str: "a text", dict: "a table", list: "a list", int: "a whole number"}
REQUIRED: Any = object()
ACCURACY_KEY = "accuracy"

Kind = TypeVar("Kind")


@dataclasses.dataclass(frozen=True)
class Key:
    """Key of a file, as errors name it: `Key(path)["soil"]["c_v"]`."""

    file: Path
    name: str | None = None
    """Key in full, such as soil.c_v; None for the file itself."""

    def __getitem__(self, inner: str) -> "Key":
        return Key(self.file, f"{self.name}.{inner}" if self.name else inner)

    @property
    def place(self) -> dict[str, Any]:
        """Place of an InputError, by its arguments."""
        return {"file": self.file, "key": self.name}

    def error(self, problem: str) -> InputError:
        """Make the error of its value."""
        return InputError(problem, **self.place)

    def located(self) -> AbstractContextManager[None]:
        """Add the key to an InputError of a check that does not know it."""
        return located(**self.place)


# --- Files.


def load_toml(path: Path) -> dict:
    """Read a file; InputError where it cannot be used."""
    return parse_toml(path, read_input(path))


def parse_toml(path: Path, data: bytes) -> dict:
    """Parse the bytes of a file, so that every value can be shown and every text
    printed; InputError where that is not so."""
    text = as_text(path, data)
    file = Key(path)
    if DOTTED.search(text):
        raise file.error(TOO_DEEP)
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise file.error(f"is not valid TOML: {error}{_cause(text, error)}") from error
    except RecursionError:
        raise file.error(TOO_DEEP) from None
    except ValueError:
        # More digits than Python reads.
        digits = DIGITS.search(text)
        row = text.count("\n", 0, digits.start()) + 1 if digits else None
        raise InputError(TOO_LARGE, file=path, row=row) from None
    _check_value(file, content)
    return content


def _cause(text: str, error: tomllib.TOMLDecodeError) -> str:
    """Give the reason of an error in a row with a backslash in double quotes, as in a
    path of Windows, or with a name that lacks its quotes; empty for other errors."""
    row = ROW.search(str(error))
    line = "".join(text.splitlines()[int(row[1]) - 1 : int(row[1])]) if row else ""
    if BACKSLASH.search(line):
        return f"; {NO_BACKSLASH}"
    if UNQUOTED.match(line):
        return "; a name with other letters than a to z is written in double quotes"
    return ""


def _check_value(key: Key, value: Any, depth: int = 0) -> None:
    if depth == DEEPEST:
        raise Key(key.file).error(TOO_DEEP)
    if isinstance(value, dict):
        for name, inner in value.items():
            _check_text(key[name], name)
            _check_value(key[name], inner, depth + 1)
    elif isinstance(value, list):
        for inner in value:
            _check_value(key, inner, depth + 1)
    elif isinstance(value, str):
        _check_text(key, value)
    elif isinstance(value, int) and abs(value) > LARGEST_WHOLE:
        raise key.error(TOO_LARGE)


def _check_text(key: Key, text: str) -> None:
    # Tabs and line ends may stand in notes; an escape would command the terminal.
    if not text.isprintable() and CONTROLS.search(text):
        raise key.error(
            f"holds a control character, such as an escape; remove it; {NO_BACKSLASH}"
        )


# --- Keys.


def unknown(table: Key, name: str, known: Iterable[str]) -> InputError:
    """Make the error for a name in a table, with what may have been meant."""
    return table[name].error(f"is unknown; {why_unknown(name, known)}")


def check_keys(table: Key, names: Iterable[str], known) -> None:
    """Raise InputError for a key of a table that is unknown."""
    for name in names:
        if name not in known:
            raise unknown(table, name, known)


def check_table(key: Key, entry, known, like: str) -> None:
    """Raise InputError for a value that is no table, saying what it is like, or for an
    unknown key."""
    if not isinstance(entry, dict):
        raise key.error(f"must be a table like {like}, but is {entry!r}")
    check_keys(key, entry, known)


def known_table(top: Key, content: dict, name: str, known: tuple[str, ...]) -> dict:
    """Read a table of the file, with known keys only; empty where there is none."""
    table = typed(top, content, name, dict, {})
    check_keys(top[name], table, known)
    return table


# --- Values: of a key, or of a name in a table, whose key is given.


def of_kind(key: Key, value: Any, kind: type[Kind]) -> Kind:
    """Return a value of one kind; InputError for another kind."""
    # A TOML boolean is a Python integer.
    if not isinstance(value, kind) or isinstance(value, bool):
        raise key.error(f"must be {KIND_WORDS[kind]}, but is {value!r}")
    return value


def typed(
    table: Key, content: Mapping, name: str, kind: type[Kind], default: Any = REQUIRED
) -> Kind:
    """Return a value of one kind, or the default; InputError for another kind."""
    return of_kind(table[name], content.get(name, default), kind)


def one_line(table: Key, content: Mapping, name: str, default: str) -> str:
    """Read a text that stands in tables: of one line, and not empty."""
    text = typed(table, content, name, str, default)
    if not text.strip():
        raise table[name].error("must be a text, but is empty")
    if text.splitlines() != [text]:
        raise table[name].error(f"must be one line, but is {text!r}")
    return text


def whole(
    table: Key,
    content: dict,
    name: str,
    default: int,
    least: int,
    most: int = LARGEST_WHOLE,
) -> int:
    """Read a whole number from `least` to `most`."""
    value = typed(table, content, name, int, default)
    if not least <= value <= most:
        end = f"least {least}" if value < least else f"most {most}"
        raise table[name].error(f"must be at {end}, but is {value}")
    return value


def choice(table: Key, content: dict, name: str, default: str, known) -> str:
    """Read one of the known words."""
    value = typed(table, content, name, str, default)
    check_choice("", value, known, **table[name].place)
    return value


def number(
    key: Key,
    value,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    unit: str = "",
) -> float:
    """Read a finite number, above `above` and of at least `least`."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise key.error(f"must be a number, but is {value!r}")
    if abs(value) > sys.float_info.max or math.isnan(value):
        raise key.error(f"must be finite, but is {value}")
    if not (value > above and value >= least):
        need = f"above {above:g}" if value <= above else f"at least {least:g}"
        raise key.error(f"must be {need} {unit}".rstrip() + f", but is {value:g}")
    return float(value)


def allowed(key: Key, column: InputColumn, value) -> float:
    """Read a number that the column may hold, in its unit."""
    checked = number(key, value)
    if not column.is_allowed(checked):
        hint = column.hint(checked, column.unit)
        raise key.error(f"must be {column.requirement}, but is {value}{hint}")
    return checked


def quantity(key: Key, column: InputColumn, value) -> float:
    """Read a number that the column may hold, in its unit, as something has it; warns
    of one that is unusual."""
    checked = allowed(key, column, value)
    if column.is_unusual(checked):
        description = column.describe(checked, column.unit)
        warn_unusual(f"is {description}", column.name, **key.place)
    return checked


def with_named_parts(key: Key, table: Mapping, whole: Composite) -> Composite:
    """Return a soil or a block with the laws or the shape that a table names; its other
    keys are passed over. Files of laws are looked for from the directory of the key's
    file."""
    parts = {
        slot: _named_part(key[slot], slot, table[slot])
        for slot in parts_of(type(whole))
        if slot in table
    }
    with key.located():
        return replaced_parts(whole, parts)


def _named_part(key: Key, slot: str, name) -> Part:
    text = of_kind(key, name, str)
    with key.located():
        return part_named(slot, text, key.file.parent)


# --- Scenes.

Found = Mapping[str, tuple[str | None, object]]
"""Key -> the table that it was found in, None before all tables, and its value."""


class SceneFile(NamedTuple):
    """A scene, and the accuracy that its file names."""

    scene: Scene
    accuracy: str | None
    """Name of a preset, or None where the file does not say."""


def read_scene(path: Path) -> SceneFile:
    """Read one scene.

    The keys are the columns of a table of scenes, with the units in their names, and
    the names of laws and shape (`SLOTS`), as `finding.find_part` takes them; files of
    laws are looked for from the directory of this one. Each stands in its table
    `[block]`, `[soil]` or `[impact]`, or before all tables. A missing key has its
    default. `accuracy`, before all tables, names a preset.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    return scene_from(path, load_toml(path))


def scene_from(path: Path, content: dict, others: tuple[str, ...] = ()) -> SceneFile:
    """Read the scene that part of a file describes, by the keys of `read_scene`.

    Args:
        path: the file, named in errors.
        content: its content as parsed.
        others: keys of the file that are not of the scene; passed over where they
            stand in `content`, and known when an unknown key is told the nearest.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    top = Key(path)
    accuracy, numbers, names = None, {}, {}
    for key, value in content.items():
        if key in others:
            continue
        if key == ACCURACY_KEY:
            check_choice("", value, PRESETS, **top[key].place)
            accuracy = value
        elif key in PARTS:
            for name, inner in typed(top, content, key, dict).items():
                if name in content:
                    raise top[name].error(
                        f"stands in [{key}] and before all tables; remove one"
                    )
                (names if name in SLOTS else numbers)[name] = key, inner
        else:
            (names if key in SLOTS else numbers)[key] = None, value
    base = _with_parts(top, names)
    return SceneFile(scene_with(base, _values(top, numbers, base, others)), accuracy)


def _with_parts(top: Key, names: Found) -> Scene:
    parts: dict[str, dict[str, Part]] = {part: {} for part in PARTS}
    for slot, (table, name) in names.items():
        _check_table(top[slot], table, SLOTS[slot])
        parts[SLOTS[slot]][slot] = _named_part(top[slot], slot, name)
    usual = Scene()
    with top.located():
        scene = Scene(
            *(replaced_parts(getattr(usual, p), slots) for p, slots in parts.items())
        )
        columns_of(scene)  # which are two of one name where laws do not fit together
        return scene


def _values(
    top: Key, numbers: Found, base: Scene, others: tuple[str, ...]
) -> dict[str, float]:
    columns, values = columns_of(base), {}
    for name, (table, value) in numbers.items():
        if name not in columns:
            more = () if table else (*PARTS, ACCURACY_KEY, *others)
            where = top[table] if table else top
            raise unknown(where, name, (*columns, *SLOTS, *more))
        _check_table(top[name], table, columns[name].part)
        values[name] = quantity(top[name], columns[name], value)
    return values


def _check_table(key: Key, table: str | None, part: str) -> None:
    if table not in (None, part):
        raise key.error(f"stands in [{table}], but belongs into [{part}]")

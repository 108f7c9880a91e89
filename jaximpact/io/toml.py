"""TOML files: values checked for kind, range and name, and scenes; each error in one
line."""

import math
import re
import sys
import tomllib
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, NoReturn, TypeVar

from ..accuracy import PRESETS
from ..errors import InputError, UnusualValueWarning, check_choice, located
from ..parameters import Composite, Part, parts_of
from ..quantities import SLOTS, InputColumn, columns_of, why_unknown
from ..scene import PARTS, Scene
from ..scene_quantities import part_named, replaced_parts, scene_with
from .files import CONTROLS, as_text, read_input

LARGEST_WHOLE = 2**63 - 1
"""Largest whole number that TOML promises to hold."""
DEEPEST = 20
"""Levels of tables and lists inside one another."""
DOTTED = re.compile(r"^\[*(?:[\w-]+\.){500}", re.MULTILINE)
"""A key that tomllib takes minutes to read."""
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


# --- Files.


def load_toml(path: Path) -> dict:
    """Read a file; InputError where it cannot be used."""
    return parse_toml(path, read_input(path))


def parse_toml(path: Path, data: bytes) -> dict:
    """Parse the bytes of a file, so that every value can be shown and every text
    printed; InputError where that is not so."""
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
    _check_value(path, "", content)
    return content


def _check_value(path: Path, key: str, value: Any, depth: int = 0) -> None:
    """Raise InputError for what no key may hold."""
    if depth == DEEPEST:
        raise InputError(TOO_DEEP, file=path)
    if isinstance(value, dict):
        for name, inner in value.items():
            where = f"{key}.{name}" if key else name
            _check_text(path, where, name)
            _check_value(path, where, inner, depth + 1)
    elif isinstance(value, list):
        for inner in value:
            _check_value(path, key, inner, depth + 1)
    elif isinstance(value, str):
        _check_text(path, key, value)
    elif isinstance(value, int) and abs(value) > LARGEST_WHOLE:
        raise InputError(TOO_LARGE, file=path, key=key)


def _check_text(path: Path, key: str, text: str) -> None:
    # Tabs and line ends may stand in notes; an escape would command the terminal.
    if not text.isprintable() and CONTROLS.search(text):
        raise InputError(
            "holds a control character, such as an escape; remove it",
            file=path,
            key=key,
        )


# --- Keys.


def unknown(path: Path, key: str, name: str, known: Iterable[str]) -> NoReturn:
    """Raise InputError for a name, with what may have been meant."""
    raise InputError(f"is unknown; {why_unknown(name, known)}", file=path, key=key)


def check_keys(path: Path, where: str, keys: Iterable[str], known) -> None:
    """Raise InputError for a key that is unknown; `where` is the name of its table, ""
    at the top of the file."""
    for key in keys:
        if key not in known:
            unknown(path, f"{where}.{key}" if where else key, key, known)


def check_table(path: Path, key: str, entry, known, like: str) -> None:
    """Raise InputError for a value that is no table, saying what it is like, or for an
    unknown key."""
    if not isinstance(entry, dict):
        raise InputError(
            f"must be a table like {like}, but is {entry!r}", file=path, key=key
        )
    check_keys(path, key, entry, known)


def known_table(path: Path, content: dict, name: str, known: tuple[str, ...]) -> dict:
    """A table of the file, with known keys only; empty where there is none."""
    table = typed(path, content, name, dict, {})
    check_keys(path, name, table, known)
    return table


# --- Values.


def typed(
    path: Path, content: Mapping, key: str, kind: type[Kind], default: Any = REQUIRED
) -> Kind:
    """A value of one kind, or the default; InputError for another kind."""
    value = content.get(key, default)
    # A TOML boolean is a Python integer.
    if not isinstance(value, kind) or isinstance(value, bool):
        raise InputError(
            f"must be {KIND_WORDS[kind]}, but is {value!r}", file=path, key=key
        )
    return value


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
    check_choice("", value, known, file=path, key=key)
    return value


def number(
    path: Path,
    key: str,
    value,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    unit: str = "",
) -> float:
    """A finite number, above `above` and of at least `least`."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"must be a number, but is {value!r}", file=path, key=key)
    if abs(value) > sys.float_info.max or math.isnan(value):
        raise InputError(f"must be finite, but is {value}", file=path, key=key)
    if not (value > above and value >= least):
        need = f"above {above:g}" if value <= above else f"at least {least:g}"
        problem = f"must be {need} {unit}".rstrip() + f", but is {value:g}"
        raise InputError(problem, file=path, key=key)
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


def with_named_parts(
    path: Path, where: str, table: Mapping, whole: Composite
) -> Composite:
    """A soil or a block with the laws or the shape that a table names; its other keys
    are passed over.

    Args:
        path: of the file, from whose directory files of laws are looked for.
        where: name of the table.

    Raises InputError, naming file and key, for a name that cannot be used.
    """
    found = {
        slot: _named_part(path, f"{where}.{slot}", slot, table[slot])
        for slot in parts_of(type(whole))
        if slot in table
    }
    with located(file=path, key=where):
        return replaced_parts(whole, found)


def _named_part(path: Path, key: str, slot: str, name) -> Part:
    text = typed(path, {key: name}, key, str)
    with located(file=path, key=key):
        return part_named(slot, text, path.parent)


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
    """The scene that part of a file describes, by the keys of `read_scene`.

    Args:
        path: the file, named in errors.
        content: its content as parsed.
        others: keys of the file that are not of the scene; passed over where they
            stand in `content`, and known when an unknown key is told the nearest.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    accuracy, numbers, names = None, {}, {}
    for key, value in content.items():
        if key in others:
            continue
        if key == ACCURACY_KEY:
            check_choice("", value, PRESETS, file=path, key=key)
            accuracy = value
        elif key in PARTS:
            for name, inner in typed(path, content, key, dict).items():
                if name in content:
                    raise InputError(
                        f"stands in [{key}] and before all tables; remove one",
                        file=path,
                        key=name,
                    )
                (names if name in SLOTS else numbers)[name] = key, inner
        else:
            (names if key in SLOTS else numbers)[key] = None, value
    base = _with_parts(path, names)
    return SceneFile(scene_with(base, _values(path, numbers, base, others)), accuracy)


def _with_parts(path: Path, names: Found) -> Scene:
    """The usual scene with the laws and the shape that a file names, by slot."""
    found: dict[str, dict[str, Part]] = {part: {} for part in PARTS}
    for slot, (table, name) in names.items():
        _check_table(path, slot, table, SLOTS[slot])
        found[SLOTS[slot]][slot] = _named_part(path, slot, slot, name)
    usual = Scene()
    with located(file=path):
        scene = Scene(
            *(replaced_parts(getattr(usual, p), slots) for p, slots in found.items())
        )
        columns_of(scene)  # which are two of one name where laws do not fit together
        return scene


def _values(
    path: Path, numbers: Found, base: Scene, others: tuple[str, ...]
) -> dict[str, float]:
    """The quantities of a file by their columns, checked."""
    columns, values = columns_of(base), {}
    for name, (table, value) in numbers.items():
        if name not in columns:
            top = () if table else (*PARTS, ACCURACY_KEY, *others)
            key = f"{table}.{name}" if table else name
            unknown(path, key, name, (*columns, *SLOTS, *top))
        _check_table(path, name, table, columns[name].part)
        values[name] = quantity(path, name, columns[name], value)
    return values


def _check_table(path: Path, name: str, table: str | None, part: str) -> None:
    if table not in (None, part):
        raise InputError(
            f"stands in [{table}], but belongs into [{part}]", file=path, key=name
        )

"""One scene from a TOML file."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from ..accuracy import PRESETS
from ..errors import InputError, located
from ..quantities import SLOTS, columns_of
from ..scene import PARTS, Scene
from ..scene_quantities import part_named, scene_with, with_parts
from .toml import load_toml, quantity, typed, unknown

ACCURACY_KEY = "accuracy"

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
            accuracy = _accuracy(path, value)
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
    texts = {}
    for slot, (table, name) in names.items():
        _check_table(path, slot, table, SLOTS[slot])
        texts[slot] = typed(path, {slot: name}, slot, str)
        with located(file=path, key=slot):
            part_named(slot, texts[slot], path.parent)
    with located(file=path):
        scene = with_parts(Scene(), texts, path.parent)
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


def _accuracy(path: Path, value) -> str:
    if not isinstance(value, str) or value not in PRESETS:
        raise InputError(
            f"must be one of {', '.join(PRESETS)}, but is {value!r}",
            file=path,
            key=ACCURACY_KEY,
        )
    return value

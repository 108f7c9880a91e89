"""One scene from a TOML file."""

from pathlib import Path
from typing import NamedTuple

from ..accuracy import PRESETS
from ..block import Block
from ..errors import InputError
from ..scene import PARTS, Impact, Scene
from ..soil import Soil
from .columns import INPUT_COLUMNS, InputColumn
from .toml_values import load_toml, quantity, unknown

ACCURACY_KEY = "accuracy"


class SceneFile(NamedTuple):
    """What the file says."""

    scene: Scene
    accuracy: str | None
    """Name of a preset, or None where the file does not say."""


def read_scene(path: Path) -> SceneFile:
    """Read one scene.

    The keys are the columns of a table of scenes, with the units in their names. Each
    stands in its table `[block]`, `[soil]` or `[impact]`, or before all tables. A
    missing key has its default. `accuracy`, before all tables, names a preset.

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
    fields = {part: {} for part in PARTS}
    accuracy = None
    for key, value in content.items():
        if key in others:
            continue
        if key == ACCURACY_KEY:
            accuracy = _accuracy(path, value)
        elif key in PARTS:
            if not isinstance(value, dict):
                raise InputError("must be a table", file=path, key=key)
            for name, number in value.items():
                column = _column(path, name, key, ())
                if name in content:
                    raise InputError(
                        f"stands in [{key}] and before all tables; remove one",
                        file=path,
                        key=name,
                    )
                fields[column.part][column.field] = _si_value(path, column, number)
        else:
            column = _column(path, key, None, others)
            fields[column.part][column.field] = _si_value(path, column, value)
    scene = Scene(
        Block(**fields["block"]), Soil(**fields["soil"]), Impact(**fields["impact"])
    )
    return SceneFile(scene, accuracy)


def _column(
    path: Path, name: str, table: str | None, others: tuple[str, ...]
) -> InputColumn:
    """The column that a key stands for; `table` is the one it was found in."""
    if name not in INPUT_COLUMNS:
        top = () if table else (*PARTS, ACCURACY_KEY, *others)
        key = f"{table}.{name}" if table else name
        unknown(path, key, name, (*INPUT_COLUMNS, *top))
    column = INPUT_COLUMNS[name]
    if table not in (None, column.part):
        raise InputError(
            f"stands in [{table}], but belongs into [{column.part}]",
            file=path,
            key=name,
        )
    return column


def _si_value(path: Path, column: InputColumn, value) -> float:
    return column.factor * quantity(path, column.name, column, value)


def _accuracy(path: Path, value) -> str:
    if not isinstance(value, str) or value not in PRESETS:
        raise InputError(
            f"must be one of {', '.join(PRESETS)}, but is {value!r}",
            file=path,
            key=ACCURACY_KEY,
        )
    return value

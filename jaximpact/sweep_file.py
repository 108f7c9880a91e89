"""A sweep from a TOML file."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from .errors import InputError, located
from .io.checks import check_memory
from .io.scene_file import scene_from
from .io.toml import check_keys, choice, load_toml, number, typed, whole
from .scene import Scene
from .scene_quantities import SHAPE, shape_named
from .sweeping import LABELS, Axes, check_axes, columns_of_axes, why_unknown_axis

AXES_KEY = "axes"
RANGE_KEYS = ("from", "to", "count", "spacing")
SPACINGS = {"linear": np.linspace, "logarithmic": np.geomspace}


class SweepStudy(NamedTuple):
    """What the file says."""

    base: Scene
    axes: Axes
    accuracy: str | None
    """Name of a preset, or None where the file does not say."""


def read_sweep_study(path: Path) -> SweepStudy:
    """Read a sweep: a scene as `read_scene` reads it, and a table `[axes]`.

    An axis is a list of numbers, or a range `{from = 1, to = 4, count = 7}` that holds
    both ends, with `spacing = "logarithmic"` if wanted; `shape` is a list of names of
    shapes. A table of axes inside it, `[axes.ground]`, holds quantities that vary
    together, and `name` for labels.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    content = load_toml(path)
    base, accuracy = scene_from(path, content, (AXES_KEY,))
    if AXES_KEY not in content:
        raise InputError(
            "is needed: which quantities vary, and over what", file=path, key=AXES_KEY
        )
    given = _with_shapes(path, AXES_KEY, typed(path, content, AXES_KEY, dict))
    with located(file=path):
        columns = columns_of_axes(given, base)
    axes = {
        name: _axis(path, f"{AXES_KEY}.{name}", name, value, columns)
        for name, value in given.items()
    }
    with located(file=path):
        check_axes(axes, base)
    return SweepStudy(base, axes, accuracy)


def _with_shapes(path: Path, key: str, axes: dict) -> dict:
    """Return the axes with classes in place of the names of shapes."""
    found = {}
    for name, value in axes.items():
        where = f"{key}.{name}"
        if name == SHAPE and isinstance(value, list):
            texts = [typed(path, {where: text}, where, str) for text in value]
            with located(file=path, key=where):
                found[name] = [shape_named(x, path.parent) for x in texts]
        else:
            inner = isinstance(value, dict)
            found[name] = _with_shapes(path, where, value) if inner else value
    return found


def _axis(path: Path, key: str, name: str, value, columns):
    if name in columns or name == SHAPE:
        return _values(path, key, name, value)
    if not isinstance(value, dict) or set(value) <= set(RANGE_KEYS):
        raise InputError(
            f"is unknown; {why_unknown_axis(name, columns)}", file=path, key=key
        )
    return {
        quantity: _values(path, f"{key}.{quantity}", quantity, values)
        for quantity, values in value.items()
    }


def _values(path: Path, key: str, name: str, value):
    """Return a list of numbers, labels or shapes, or the values of a range."""
    if isinstance(value, list):
        is_text = name in (LABELS, SHAPE)
        return value if is_text else [number(path, key, one) for one in value]
    if not isinstance(value, dict):
        raise InputError(
            "must be a list of numbers, or a range {from, to, count}, but is "
            f"{value!r}",
            file=path,
            key=key,
        )
    check_keys(path, key, value, RANGE_KEYS)
    for name in ("from", "to", "count"):
        if name not in value:
            raise InputError(f"needs {name}", file=path, key=key)
    ends = [number(path, f"{key}.{end}", value[end]) for end in ("from", "to")]
    count = whole(path, value, "count", 1, 1)
    check_memory(count, f"{count} values", file=path, key=f"{key}.count")
    spacing = choice(path, value, "spacing", "linear", tuple(SPACINGS))
    if spacing == "logarithmic" and min(ends) <= 0.0:
        raise InputError(
            f"must run between positive numbers to be logarithmic, but runs from "
            f"{ends[0]:g} to {ends[1]:g}",
            file=path,
            key=key,
        )
    return SPACINGS[spacing](*ends, count)

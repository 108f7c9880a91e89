"""A sweep from a TOML file."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from .errors import InputError
from .formats.checks import check_memory
from .formats.columns import INPUT_COLUMNS
from .formats.scene_file import scene_from
from .formats.toml_values import (
    check_keys,
    choice,
    load_toml,
    number,
    typed,
    unknown,
    whole,
)
from .scene import Scene
from .sweeping import LABELS, Axes, check_axes

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
    both ends, with `spacing = "logarithmic"` if wanted. A table of axes inside it,
    `[axes.ground]`, holds quantities that vary together, and `name` for labels.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    content = load_toml(path)
    base, accuracy = scene_from(path, content, (AXES_KEY,))
    if AXES_KEY not in content:
        raise InputError(
            "is needed: which quantities vary, and over what", file=path, key=AXES_KEY
        )
    axes = {
        name: _axis(path, f"{AXES_KEY}.{name}", name, value)
        for name, value in typed(path, content, AXES_KEY, dict).items()
    }
    try:
        check_axes(axes)
    except InputError as error:
        raise InputError(str(error), file=path) from None
    return SweepStudy(base, axes, accuracy)


def _axis(path: Path, key: str, name: str, value):
    if name in INPUT_COLUMNS:
        return _values(path, key, value)
    if not isinstance(value, dict) or set(value) <= set(RANGE_KEYS):
        unknown(path, key, name, INPUT_COLUMNS)
    return {
        quantity: _values(path, f"{key}.{quantity}", values, labels=quantity == LABELS)
        for quantity, values in value.items()
    }


def _values(path: Path, key: str, value, *, labels: bool = False):
    """A list as it stands, or what a range stands for."""
    if isinstance(value, list):
        return value if labels else [number(path, key, one) for one in value]
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

"""Barriers of a study: their table in the file.

A barrier is a vertical screen at x, from the ground to its top. Its height is measured
vertically, since a block passes it when its centre passes the vertical at x: there its
motion is known exactly, and every point above the ground has one height, on a break of
the profile too. A fence of length h across a slope of angle w stands h / cos(w) high
over the ground below its top.
"""

import math
from pathlib import Path
from typing import NamedTuple

from ...errors import InputError
from ...io.toml import check_keys, number, typed
from ..terrain import Profile

KEY = "barriers"
KEYS = ("name", "x_m", "height_m", "capacity_kJ")


class Barrier(NamedTuple):
    """Barrier across a profile, by which blocks are counted and not held back."""

    name: str
    x: float
    """Place along the profile [m]."""
    height: float
    """Height of its top above the ground at x, vertically [m]."""
    capacity: float
    """Largest kinetic energy of a block, of translation and rotation, that it stops
    [J]."""


def read_barriers(path: Path, content: dict, profile: Profile) -> tuple[Barrier, ...]:
    """Read the tables `[[barriers]]`, in their order; none where there are none.

    Args:
        content: content of the file.

    Raises InputError, naming file and key, for a barrier that is not on the profile,
    for heights and capacities that are not above 0, and for names that stand twice.
    """
    tables = content.get(KEY, [])
    if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
        raise InputError(
            "must be tables, each under a line [[barriers]]", file=path, key=KEY
        )
    barriers: list[Barrier] = []
    for place, table in enumerate(tables, 1):
        barrier = _barrier(path, f"{KEY}.{place}", table, profile)
        if barrier.name in [other.name for other in barriers]:
            raise InputError(
                f"{barrier.name!r} stands twice; name tells barriers apart",
                file=path,
                key=f"{KEY}.{place}.name",
            )
        barriers.append(barrier)
    return tuple(barriers)


def _barrier(path: Path, where: str, table: dict, profile: Profile) -> Barrier:
    check_keys(path, where, table, KEYS)
    numbers = {}
    for name in KEYS[1:]:
        key = f"{where}.{name}"
        if name not in table:
            raise InputError("is needed", file=path, key=key)
        above = -math.inf if name == "x_m" else 0.0
        numbers[name] = number(path, key, table[name], above=above)
    x, height, capacity = numbers.values()
    if not profile.x[0] < x < profile.x[-1]:
        raise InputError(
            f"must lie between the ends of the profile, {profile.x[0]:g} and "
            f"{profile.x[-1]:g}, but is {x:g}",
            file=path,
            key=f"{where}.x_m",
        )
    key = f"{where}.name"
    name = typed(path, {key: table.get("name", f"barrier at {x:g} m")}, key, str)
    if not name.strip():
        raise InputError("must be a text, but is empty", file=path, key=key)
    return Barrier(name, x, height, 1e3 * capacity)

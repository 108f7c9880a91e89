"""Coordinates of slopes: values that are none, and slopes that are none on Earth, which
another unit or a missing height has probably made.

A value that cannot be a coordinate is refused. A slope that is only larger, smaller or
steeper than those on Earth is warned of, since nothing else can tell its unit.
"""

from collections.abc import Iterator

import numpy as np

from ..io.checks import NO_DATA, warn_unusual
from ..io.display import range_of
from ..reports.tables import place_text

LARGEST = 1e8
"""Largest coordinate [m]. Those of national grids, with the number of the zone before
the easting too, are smaller; float64 resolves 1.5e-8 m there."""
NARROWEST = 1e-12
"""Distance in x [m] up to which points are above one another: the slope of such a wall
leaves the floating-point numbers."""
RESOLVED = 1e-6
"""Coarsest resolution of coordinates, as a fraction of a block's smallest semi-axis: a
block starts to be in the ground at as much."""
MARKS = (
    *NO_DATA,
    *(10.0**digits - 1.0 for digits in range(4, 10)),
    *(32767.0, 65535.0, 2147483647.0, 4294967295.0),
)
"""Numbers that maps hold where nothing is known."""
SHORT_MARK = -999.0
"""A mark that may be a height in a local system."""

LONGEST = 5000.0
"""Length of a profile [m]: falling blocks run less than 3 km, and only rock avalanches,
which are no single blocks, go farther."""
HIGHEST = 2500.0
"""Height of a profile [m]: the east face of Monte Rosa, the highest of the Alps, has
2400."""
SMALLEST = 5.0
"""Length and height of a profile [m]: a test pit is larger."""
HIGHEST_CLIFF = 1300.0
"""Height of a cliff [m]: the wall of Mount Thor, the highest, has 1250."""
SUMMIT = 9000.0
"""Elevation [m] above all mountains."""
FASTEST = 100.0
"""Speed of a block [m/s] that only falls from walls of 500 m and more have, as that of
the Happy Isles in 1996."""
LARGEST_ENERGY = 1e8
"""Kinetic energy of a block [J] that only large ones have: 100 t, some 40 m3, at
45 m/s."""


def first_turning_back(x: np.ndarray) -> int | None:
    """Find the first point from which x does not increase to the next by more than
    `NARROWEST`, by its index; None where there is none."""
    back = np.diff(x) <= NARROWEST
    return int(np.argmax(back)) if np.any(back) else None


def problem_with(values: np.ndarray, name: str) -> tuple[int, str] | None:
    """Find the first value that is no coordinate, of x or y of a profile's points [m].

    Returns:
        Its index, and what is wrong with it; None where all are coordinates.
    """
    for bad, problem in _problems(values, name):
        if np.any(bad):
            i = int(np.argmax(bad))
            return i, problem.format(values[i])
    return None


def _problems(values: np.ndarray, name: str) -> Iterator[tuple[np.ndarray, str]]:
    """Yield where values have a problem, and its words: each for values that have none
    of those before."""
    cure = "leave out the points without data"
    yield ~np.isfinite(values), f"must be finite, but is {{}}; {cure}"
    yield (
        np.abs(values) > LARGEST,
        f"must be within {LARGEST:g} m of 0, but is {{:g}}; {cure}, and count from an "
        "origin near the slope",
    )
    others = values[~_is_code(values)]
    among = f" among {range_of(others, place_text)} m" if len(others) else ""
    yield (
        _no_data(values, name),
        f"is {{:.10g}}{among}, a mark for no data; {cure}",
    )


def _no_data(values: np.ndarray, name: str) -> np.ndarray:
    """Find the numbers that stand for no data, and not for a coordinate among others
    that happens to be the same number."""
    codes = _is_code(values)
    others = values[~codes]
    if not len(others):
        return codes
    outside = np.maximum(np.min(others) - values, values - np.max(others))
    # The far end of a long plain may well lie at x = 9999 m.
    codes &= (values < 0.0) | (name == "y")
    # What may be a height takes three others, and to be far from them.
    short = values == SHORT_MARK
    codes &= ~short | (len(others) >= 3)
    return codes & (outside > np.where(short, 500.0, 1000.0))


def _is_code(values: np.ndarray) -> np.ndarray:
    return np.isin(values, MARKS) | (values == SHORT_MARK)


def warn_of_unusual(x: np.ndarray, y: np.ndarray) -> None:
    """Warn, in one sentence, of a profile that is smaller, steeper, higher or longer
    than any slope, naming the unit that is likely to have been taken for metres."""
    if unusual := _unusual(x, y):
        # From one place, so that profiles made of this one do not warn of it again.
        warn_unusual(f"a profile {unusual}", "profile")


def _unusual(x: np.ndarray, y: np.ndarray) -> str | None:
    """Say what is unusual of a profile, to follow the words "a profile"."""
    length, height = float(x[-1] - x[0]), float(np.ptp(y))
    size = f"is {length:.4g} m long and {height:.4g} m high"
    if length < SMALLEST and height < SMALLEST:
        far = abs(x[0]) > length
        unit = "degrees of longitude and latitude" if far else "kilometres"
        return f"{size}, smaller than any slope; {unit}?"
    # The walls of El Capitan and Mount Thor are less than 6 times as high as long.
    if height > 20.0 * length:
        unit = "y in millimetres" if height > HIGHEST else "x in degrees or kilometres"
        return f"{size}, steeper than any slope; is {unit}?"
    run, fall = np.diff(x), np.abs(np.diff(y))
    cliff = (fall > HIGHEST_CLIFF) & (fall > 5.0 * run)  # steeper than 79 degrees
    if np.any(cliff):
        i = int(np.argmax(cliff))
        return (
            f"goes from a height of {y[i]:g} m to {y[i + 1]:g} m within {run[i]:.4g} m "
            f"at point {i + 2}, more than the highest cliff; a mark for no data, or "
            "another unit?"
        )
    # A plane without heights is a test of something else than its length.
    if height > 0.0 and (length > LONGEST or height > HIGHEST):
        return (
            f"{size}, while usual are up to {LONGEST:g} and {HIGHEST:g} m; "
            f"{_other_unit(length, height)}"
        )
    top = float(y[np.argmax(np.abs(y))])
    # Northings are above, or below 0 as in S-JTSK.
    if abs(top) > SUMMIT:
        where = "above" if top > 0.0 else "below"
        return (
            f"has a height of {top:g} m, {where} all mountains; "
            f"{_other_unit(length, height, abs(top))}"
        )
    return None


def _other_unit(length: float, height: float, top: float = 0.0) -> str:
    """Name the unit in which a profile that is too large is a usual one."""
    for unit, size in (("feet", 0.3048), ("millimetres", 1e-3)):
        longest = size * length <= LONGEST and size * height <= HIGHEST
        small = size * length < SMALLEST and size * height < SMALLEST
        if longest and not small and size * top <= SUMMIT:
            usual = f"{size * length:.4g} m long and {size * height:.4g} m high"
            return f"if its coordinates are {unit}, it is {usual}"
    if top > SUMMIT:
        return "is y a northing, or are its coordinates no metres?"
    return "are its coordinates metres?"

"""Coordinates of slopes: values that are none, and slopes that are none on Earth, which
another unit or a missing height has probably made.

A value that cannot be a coordinate is refused. A slope that is only larger, smaller or
steeper than those on Earth is warned of, since nothing else can tell its unit.
"""

import warnings

import numpy as np

from ..errors import UnusualValueWarning
from ..io.checks import NO_DATA
from ..io.display import range_of

LARGEST = 1e8
"""Largest coordinate [m]. Those of national grids, with the number of the zone before
the easting too, are smaller; float64 resolves 1.5e-8 m there."""
NARROWEST = 1e-12
"""Distance in x [m] up to which points are above one another: a wall of that width is
so steep that its slope leaves the floating-point numbers."""
RESOLVED = 1e-6
"""Coarsest resolution of coordinates, as a fraction of a block's smallest semi-axis: a
block starts to be in the ground at as much."""
MARKS = (
    *NO_DATA,
    *(10.0**digits - 1.0 for digits in range(4, 10)),
    *(32767.0, 65535.0, 2147483647.0, 4294967295.0),
)
"""Numbers that maps hold where nothing is known."""
FAR = 1000.0
"""Distance from all other heights [m] beyond which such a number is no height."""
SHORT_MARK, SHORT_FAR, SHORT_AMONG = -999.0, 500.0, 3
"""A mark that may be a height in a local system; its distance from
all other heights [m], of at least so many, beyond which it is none."""

LONGEST = 5000.0
"""Length of a profile [m]: falling blocks run less than 3 km, and only rock avalanches,
which are no single blocks, go farther."""
HIGHEST = 2500.0
"""Height of a profile [m]: the east face of Monte Rosa, the highest of the Alps, has
2400."""
SMALLEST = 5.0
"""Length and height of a profile [m]: a test pit is larger."""
STEEPEST = 20.0
"""Height over length of a profile: the walls of El Capitan and Mount Thor have less
than 6."""
HIGHEST_CLIFF = 1300.0
"""Height of ground steeper than `CLIFF` [m]: the wall of Mount Thor, the highest, has
1250."""
CLIFF = 5.0
"""Slope, height over length, from which ground is a cliff: 79 degrees."""
SUMMIT = 9000.0
"""Elevation [m] above all mountains."""
FASTEST = 100.0
"""Speed of a block [m/s] that only falls from walls of 500 m and more have, as that of
the Happy Isles in 1996."""
UNITS = {"feet": 0.3048, "millimetres": 1e-3}
"""Units that are mistaken for metres, with their sizes in metres."""


def problem_with(values: np.ndarray, name: str) -> tuple[int, str] | None:
    """Find the first value that is no coordinate.

    Args:
        values: coordinates of a profile's points [m], `(points,)`.
        name: "x" or "y".

    Returns:
        Its index, and what is wrong with it; None where all are coordinates.
    """
    cure = "leave out the points without data"
    bad = ~np.isfinite(values)
    if np.any(bad):
        i = int(np.argmax(bad))
        return i, f"must be finite, but is {values[i]}; {cure}"
    bad = np.abs(values) > LARGEST
    if np.any(bad):
        i = int(np.argmax(bad))
        return i, (
            f"must be within {LARGEST:g} m of 0, but is {values[i]:g}; {cure}, and "
            "count from an origin near the slope"
        )
    bad = _no_data(values, name)
    if np.any(bad):
        i = int(np.argmax(bad))
        others = values[~_is_code(values)]
        among = f" among {range_of(others)} m" if len(others) else ""
        return i, f"is {values[i]:.10g}{among}, a mark for no data; {cure}"
    return None


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
    short = values == SHORT_MARK
    codes &= ~short | (len(others) >= SHORT_AMONG)
    return codes & (outside > np.where(short, SHORT_FAR, FAR))


def _is_code(values: np.ndarray) -> np.ndarray:
    return np.isin(values, MARKS) | (values == SHORT_MARK)


def warn_of_unusual(x: np.ndarray, y: np.ndarray) -> None:
    """Warn, in one sentence, of a profile that is smaller, steeper, higher or longer
    than any slope, naming the unit that is likely to have been taken for metres."""
    unusual = _unusual(x, y)
    if unusual:
        # Of one place, so that profiles made of this one do not warn of it again.
        warning = UnusualValueWarning(f"a profile {unusual}", "profile")
        warnings.warn(warning, stacklevel=1)


def _unusual(x: np.ndarray, y: np.ndarray) -> str | None:
    """Say what is unusual of a profile, to follow the words "a profile"."""
    length, height = float(x[-1] - x[0]), float(np.ptp(y))
    small = f"is {length:.4g} m long"
    if length < SMALLEST and height < SMALLEST:
        far = abs(x[0]) > length
        unit = "degrees of longitude and latitude" if far else "kilometres"
        return f"{small} and {height:.4g} m high, smaller than any slope; {unit}?"
    if height > STEEPEST * length:
        unit = "y in millimetres" if height > HIGHEST else "x in degrees or kilometres"
        return f"{small} and {height:.4g} m high, steeper than any slope; is {unit}?"
    run, fall = np.diff(x), np.abs(np.diff(y))
    cliff = (fall > HIGHEST_CLIFF) & (fall > CLIFF * run)
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
            f"{small} and {height:.4g} m high, while usual are up to {LONGEST:g} and "
            f"{HIGHEST:g} m; {_other_unit(length, height)}"
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
    for unit, size in UNITS.items():
        longest = size * length <= LONGEST and size * height <= HIGHEST
        small = size * length < SMALLEST and size * height < SMALLEST
        if longest and not small and size * top <= SUMMIT:
            usual = f"{size * length:.4g} m long and {size * height:.4g} m high"
            return f"if its coordinates are {unit}, it is {usual}"
    if top > SUMMIT:
        return "is y a northing, or are its coordinates no metres?"
    return "are its coordinates metres?"

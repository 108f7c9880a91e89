"""The slope: a polyline, and what its ground is made of."""

import dataclasses
import io
import math
from pathlib import Path

import jax
import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError, nearest
from ..fields import expect, real_numbers
from ..formats.columns import InputColumn, columns_of_part
from ..formats.reading import read_text
from ..formats.scenes import SLOTS
from ..formats.tables import reads_as_number, records_of
from ..soil import Soil
from ..units import DEGREE

ROLLING_FRICTION_ANGLE = math.radians(20.0)
"""Default [rad]: an assumption, as the paper gives none."""
ROLLING_COLUMN = "rolling_friction_angle_deg"
ROUGHNESS_COLUMN = "roughness_deg"
ROUGHEST = math.radians(30.0)
"""Largest roughness [rad]."""
POINT_COLUMNS = ("x_m", "y_m")


@dataclasses.dataclass(frozen=True)
class Profile:
    """A polyline of points from left to right, ground below it, air above.

    Args:
        x, y: coordinates of the points [m], shape `(points,)`; x strictly increasing.
        soil: ground of the segments; fields that broadcast to `(points - 1,)`.
        rolling_friction_angle: of the segments [rad], likewise, in [0, pi/2).
        roughness: of the segments [rad], likewise, from 0 to `ROUGHEST`: the standard
            deviation of the angle of their facets; see `roughness`.

    Segments descend at an angle w, negative where they rise to the right. Their frame
    is t = (cos w, -sin w), along the segment to the right, and n = -(sin w, cos w),
    into the ground.

    Raises ValueError, in one sentence, for what is no such polyline.
    """

    x: np.ndarray
    y: np.ndarray
    soil: Soil = dataclasses.field(default_factory=Soil)
    rolling_friction_angle: ArrayLike = ROLLING_FRICTION_ANGLE
    roughness: ArrayLike = 0.0

    def __post_init__(self):
        x, y = (
            np.array(real_numbers(f"a profile's {name}", getattr(self, name)))
            for name in ("x", "y")
        )
        expect("a profile's soil", self.soil, Soil)
        problem = _problem_with_points(x, y)
        if problem:
            raise ValueError(f"a profile {problem}")
        segments = (len(x) - 1,)

        def of_segments(name: str, values) -> np.ndarray:
            numbers = real_numbers(f"a profile's {name}", values)
            try:
                return np.array(np.broadcast_to(numbers, segments), float)
            except ValueError:
                raise ValueError(
                    f"a profile of {segments[0]} segments takes one {name} or as many, "
                    f"but got shape {np.shape(values)}"
                ) from None

        rolling = of_segments("rolling_friction_angle", self.rolling_friction_angle)
        _check_angle(
            "rolling_friction_angle",
            rolling,
            (rolling >= 0.0) & (rolling < 0.5 * np.pi),
            "[0, 90)",
        )
        roughness = of_segments("roughness", self.roughness)
        _check_angle(
            "roughness",
            roughness,
            (roughness >= 0.0) & (roughness <= ROUGHEST),
            f"[0, {ROUGHEST / DEGREE:g}]",
        )
        soil = {}
        for column in columns_of_part("soil", self.soil).values():
            field = column.field
            soil[field] = of_segments(f"Soil.{field}", getattr(self.soil, field))
            _check_soil(column, soil[field])
        object.__setattr__(self, "x", x)
        object.__setattr__(self, "y", y)
        object.__setattr__(self, "rolling_friction_angle", rolling)
        object.__setattr__(self, "roughness", roughness)
        # Arrays of NumPy, as the rest: they are looked up lane by lane.
        soil = jax.tree.map(np.asarray, dataclasses.replace(self.soil, **soil))
        object.__setattr__(self, "soil", soil)

    @property
    def segments(self) -> int:
        """How many there are."""
        return len(self.x) - 1

    @property
    def slope(self) -> np.ndarray:
        """Angles w at which the segments descend to the right [rad], `(segments,)`."""
        return -np.arctan2(np.diff(self.y), np.diff(self.x))

    @property
    def length(self) -> np.ndarray:
        """Lengths of the segments [m], `(segments,)`."""
        return np.hypot(np.diff(self.x), np.diff(self.y))

    def height(self, x: ArrayLike) -> np.ndarray:
        """Height of the ground at x [m]; beyond the ends that of the end points."""
        return np.interp(x, self.x, self.y)


def _problem_with_points(x: np.ndarray, y: np.ndarray) -> str | None:
    """What keeps points from being a profile, to follow "a profile"."""
    if x.ndim != 1 or x.shape != y.shape:
        return f"needs as many y as x, but got shapes {x.shape} and {y.shape}"
    if len(x) < 2:
        return f"needs at least two points, but got {len(x)}"
    bad = ~(np.isfinite(x) & np.isfinite(y))
    if np.any(bad):
        return f"needs finite coordinates, but point {np.argmax(bad) + 1} has none"
    back = np.diff(x) <= 0.0
    if np.any(back):
        i = int(np.argmax(back))
        wall = "; a wall needs some width, such as 0.01 m" if x[i] == x[i + 1] else ""
        return (
            f"needs x that increases from point to point, but x goes from {x[i]:g} to "
            f"{x[i + 1]:g} at point {i + 2}{wall}"
        )
    return None


def _check_angle(name: str, values: np.ndarray, allowed: np.ndarray, range_deg: str):
    if not np.all(allowed):
        i = int(np.argmin(allowed))
        raise ValueError(
            f"a profile's {name} must be in {range_deg} deg, but is "
            f"{values[i] / DEGREE:g} on segment {i + 1}"
        )


def _check_soil(column: InputColumn, values: np.ndarray) -> None:
    bad = ~column.is_allowed(values / column.factor)
    if np.any(bad):
        i = int(np.argmax(bad))
        raise ValueError(
            f"a profile's {column.name} must be {column.requirement}, but is "
            f"{column.told(values[i], column.si_unit, f' on segment {i + 1}')}"
        )


def read_profile(
    path: Path,
    soil: Soil | None = None,
    rolling_friction_angle: float = ROLLING_FRICTION_ANGLE,
    roughness: float = 0.0,
) -> Profile:
    """Read a profile from a CSV file.

    The first row names the columns: `x_m` and `y_m`, and if wanted any quantity of the
    soil, those of its laws among them, `rolling_friction_angle_deg` and
    `roughness_deg`. A row is a point; what it says of the ground holds from there to
    the next point, so that the last row's is not used.

    Args:
        path: the file, UTF-8, separated by commas.
        soil: its laws, and what the file does not say, scalars.
        rolling_friction_angle, roughness: likewise [rad].

    Raises InputError, naming file and row, for whatever cannot be used.
    """
    path = Path(path)
    file = io.StringIO(read_text(path), newline="")
    rows = [
        (line, cells)
        for line, _, cells in records_of(path, file)
        if any(map(str.strip, cells))
    ]
    if not rows:
        raise InputError("is empty; a header and points are needed", file=path)
    (line, header), *rows = rows
    names = [name.strip() for name in header]
    soil = soil or Soil()
    of_soil = columns_of_part("soil", soil)
    _check_header(path, line, names, of_soil)
    columns = {name: np.empty(len(rows)) for name in names}
    for i, (line, cells) in enumerate(rows):
        if len(cells) != len(names):
            raise InputError(
                f"has {len(cells)} cells, but the header has {len(names)}",
                file=path,
                row=line,
            )
        for name, cell in zip(names, cells, strict=True):
            columns[name][i] = _number(path, line, name, cell)
    fields = {}
    for name, values in columns.items():
        if name in of_soil:
            column = of_soil[name]
            fields[column.field] = column.factor * values[:-1]
    rolling = rolling_friction_angle
    if ROLLING_COLUMN in columns:
        rolling = DEGREE * columns[ROLLING_COLUMN][:-1]
    if ROUGHNESS_COLUMN in columns:
        roughness = DEGREE * columns[ROUGHNESS_COLUMN][:-1]
    x, y = (columns[name] for name in POINT_COLUMNS)
    try:
        soil = dataclasses.replace(soil, **fields)
        return Profile(x, y, soil, rolling, roughness)
    except ValueError as error:
        raise InputError(str(error), file=path) from None


def _check_header(path: Path, line: int, names: list[str], of_soil) -> None:
    known = (*POINT_COLUMNS, *of_soil, ROLLING_COLUMN, ROUGHNESS_COLUMN)
    for mark, marks in ((";", "semicolons"), ("\t", "tabs")):
        if len(names) == 1 and mark in names[0]:
            raise InputError(
                f"needs commas between columns, but has {marks}", file=path, row=line
            )
    for place, name in enumerate(names):
        if name in SLOTS:
            raise InputError(
                f"names a law, but a profile has one {name} for all its segments; name "
                "it under [ground] or in the soil",
                file=path,
                row=line,
                column=name,
            )
        if name not in known:
            raise InputError(
                f"is unknown; did you mean {nearest(name, known)}?",
                file=path,
                row=line,
                column=name or str(place + 1),
            )
        if name in names[:place]:
            raise InputError(
                "stands twice in the header", file=path, row=line, column=name
            )
    for name in POINT_COLUMNS:
        if name not in names:
            raise InputError(f"needs a column {name}", file=path, row=line)


def _number(path: Path, line: int, name: str, cell: str) -> float:
    if not reads_as_number(cell):
        raise InputError(
            f"must be a number, but is {cell.strip()!r}",
            file=path,
            row=line,
            column=name,
        )
    return float(cell)

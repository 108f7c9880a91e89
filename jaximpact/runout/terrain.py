"""Slope profiles, and the ground that each block finds on them."""

import copy
import dataclasses
import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import jax
import numpy as np
from numpy.typing import ArrayLike

from .._checks import expect, real_numbers, whole_number
from ..errors import InputError
from ..io.display import Rows, ShownAsTable, range_of
from ..quantities import InputColumn, columns_of_part
from ..reports.tables import place_text
from ..scene import Soil
from ..units import DEGREE
from . import libm
from .coordinates import first_turning_back, problem_with, warn_of_unusual
from .covers import cover_table
from .smoothing import smooth_heights

ORIGINS = 1000.0
"""Distance between the places that may be an origin [m]."""
ROLLING_FRICTION_ANGLE = math.radians(20.0)
"""Default [rad]: an assumption, as the paper gives none."""
ROLLING_COLUMN = "rolling_friction_angle_deg"
ROUGHNESS_COLUMN = "roughness_deg"


ANGLE_COLUMNS: dict[str, InputColumn] = {
    name: InputColumn(
        name=name,
        part="ground",
        field=name.removesuffix("_deg"),
        factor=DEGREE,
        default=default / DEGREE,
        lower=0.0,
        upper=upper,
        lower_allowed=True,
        upper_allowed=upper_allowed,
        unit="deg",
        meaning=meaning,
    )
    for name, default, upper, upper_allowed, meaning in (
        (
            *(ROLLING_COLUMN, ROLLING_FRICTION_ANGLE, 90.0, False),
            "angle of rolling friction",
        ),
        (
            *(ROUGHNESS_COLUMN, 0.0, 30.0, True),
            "standard deviation of the angle of the ground's facets",
        ),
    )
}
"""Columns of the ground beside those of its soil."""


def ground_columns(soil: Soil) -> dict[str, InputColumn]:
    """List the columns of a ground: those of its soil and of the soil's laws, and
    `ANGLE_COLUMNS`."""
    return columns_of_part("soil", soil) | ANGLE_COLUMNS


@dataclasses.dataclass(frozen=True, init=False, repr=False)
class Profile(ShownAsTable):
    """Slope profile: a polyline of points from left to right, ground below, air above.

    Segments descend at an angle w, negative where they rise to the right. Their frame
    is t = (cos w, -sin w), along the segment to the right, and n = -(sin w, cos w),
    into the ground.

    Args:
        x, y: coordinates of the points [m], shape `(points,)`; x strictly increasing.
        soil: ground of the segments; fields that broadcast to `(points - 1,)`.
        rolling_friction_angle: angles of rolling friction of the segments [rad], in
            [0, pi/2), broadcast likewise.
        roughness: standard deviations of the angle of the segments' facets [rad], from
            0 to 30 degrees, broadcast likewise; see `contacts.roughness`.

    Raises ValueError, in one sentence, for points that make no such polyline, and for
    ground out of range.
    """

    x: np.ndarray
    y: np.ndarray
    soil: Soil
    rolling_friction_angle: np.ndarray
    roughness: np.ndarray

    def __init__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        soil: Soil | None = None,
        rolling_friction_angle: ArrayLike = ROLLING_FRICTION_ANGLE,
        roughness: ArrayLike = 0.0,
    ):
        x, y = (
            np.array(real_numbers(f"a profile's {name}", values))
            for name, values in (("x", x), ("y", y))
        )
        soil = Soil() if soil is None else soil
        expect("a profile's soil", soil, Soil)
        problem = _problem_with_points(x, y)
        if problem:
            raise ValueError(f"a profile{problem}")
        warn_of_unusual(x, y)
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

        angles = {ROLLING_COLUMN: rolling_friction_angle, ROUGHNESS_COLUMN: roughness}
        checked = {}
        for name, column in ground_columns(soil).items():
            if name in angles:
                values = of_segments(column.field, angles[name])
            else:
                values = getattr(soil, column.field)
                values = of_segments(f"Soil.{column.field}", values)
            allowed = column.is_allowed(values / column.factor)
            if not np.all(allowed):
                i = int(np.argmin(allowed))
                where = f" on segment {i + 1}"
                raise ValueError(
                    f"a profile's {column.name} must be {column.requirement}, but is "
                    f"{column.describe(values[i], column.si_unit, where)}"
                )
            checked[name] = values
        soil, *of_angles = with_ground_values(soil, checked)
        # NumPy arrays, since they are looked up lane by lane.
        values = x, y, jax.tree.map(np.asarray, soil), *of_angles
        for field, value in zip(dataclasses.fields(self), values, strict=True):
            object.__setattr__(self, field.name, value)

    @property
    def segments(self) -> int:
        """Number of segments."""
        return len(self.x) - 1

    @cached_property
    def slope(self) -> np.ndarray:
        """Angles w at which the segments descend to the right [rad], `(segments,)`."""
        return _fixed(-libm.arctan2(np.diff(self.y), np.diff(self.x)))

    @cached_property
    def length(self) -> np.ndarray:
        """Lengths of the segments [m], `(segments,)`."""
        return _fixed(np.hypot(np.diff(self.x), np.diff(self.y)))

    @cached_property
    def normal(self) -> tuple[np.ndarray, np.ndarray]:
        """Normals out of the ground, x and y, each `(segments,)`."""
        return _fixed(libm.sin(self.slope)), _fixed(libm.cos(self.slope))

    @cached_property
    def size(self) -> float:
        """Largest coordinate of the points, without sign [m]."""
        return float(max(np.max(np.abs(self.x)), np.max(np.abs(self.y))))

    @cached_property
    def covers(self) -> np.ndarray:
        """Tree of covers over the segments; see `covers.cover_table`."""
        return _fixed(cover_table(self.x, self.y))

    def __getstate__(self) -> dict[str, Any]:
        """Give the fields, without what was computed from them."""
        return {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}

    @cached_property
    def straight_length(self) -> np.ndarray:
        """Lengths of the straight lines that the segments belong to [m],
        `(segments,)`."""
        line = straight_lines(self.x, self.y)
        return _fixed(np.bincount(line, weights=self.length)[line])

    def columns_between(
        self, left: np.ndarray, right: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Find the first and the last segment whose columns lie between two places, or
        reach into there, for each lane."""
        first = np.searchsorted(self.x, left, side="left") - 1
        last = np.searchsorted(self.x, right, side="right") - 1
        return np.maximum(first, 0), np.minimum(last, self.segments - 1)

    def height(self, x) -> np.ndarray:
        """Interpolate the height of the ground at x [m]; beyond the ends it is that of
        the end points."""
        return np.interp(x, self.x, self.y)

    @property
    def origin(self) -> float:
        """Place near the start of the profile [m]; 0 where that is near 0."""
        return float(ORIGINS * np.round(self.x[0] / ORIGINS))

    @cached_property
    def from_origin(self) -> "Profile":
        """Profile with x counted from `origin`."""
        there = copy.copy(self)
        object.__setattr__(there, "x", self.x - self.origin)
        return there

    def smoothed(self, length: float) -> "Profile":
        """Smooth the heights, to take the noise out of a measured profile.

        Each height becomes that of a parabola through the points about it, weighted by
        a Gaussian along x. Points stay at their x, and segments keep their ground.

        Args:
            length: standard deviation of the Gaussian [m], at most a tenth of the
                profile's length; some times the distance of the points.

        Raises InputError for a length out of range. Warns of heights that change by
        more than 0.5 m, as those of walls do, and of a length below the distance of the
        points.
        """
        return dataclasses.replace(self, y=smooth_heights(self.x, self.y, length))

    def display_rows(self) -> tuple[str, Rows]:
        """Give the number of segments, and ranges of what they are."""
        rows = [
            ("x", range_of(self.x, place_text), "m"),
            ("y", range_of(self.y, place_text), "m"),
            ("slope", range_of(self.slope / DEGREE + 0.0), "deg"),
        ]
        columns = ground_columns(self.soil)
        for name, values in ground_values(self).items():
            shown = range_of(values / columns[name].factor)
            rows.append((name, shown, columns[name].unit))
        return f"Profile: {self.segments} segments", rows


def _fixed(values: np.ndarray) -> np.ndarray:
    """Make an array that is handed out many times read-only."""
    values.setflags(write=False)
    return values


def in_pairs(
    first: np.ndarray, last: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield pairs of lanes and segments, some at a time, each lane with its segments
    from the first to the last; none where the last is less."""
    count = np.maximum(last - first + 1, 0)
    ends = np.cumsum(count)
    start, begun = 0, 0
    while start < len(count):
        # As many at once as the memory for them allows.
        stop = int(np.searchsorted(ends, begun + 2**18, side="right"))
        stop = max(start + 1, stop)
        lanes = np.repeat(np.arange(start, stop), count[start:stop])
        before = (ends - count)[lanes]
        yield lanes, first[lanes] + np.arange(begun, begun + len(lanes)) - before
        start, begun = stop, int(ends[stop - 1])


def stretches(chosen: np.ndarray) -> list[tuple[int, int]]:
    """List where neighbours that are chosen begin and end: the first of each stretch,
    and the first behind it."""
    steps = np.diff(np.concatenate([[0], chosen.astype(int), [0]]))
    ends = (np.flatnonzero(steps == step).tolist() for step in (1, -1))
    return list(zip(*ends, strict=True))


def straight_lines(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Give the number of the straight line that each segment of a polyline belongs to,
    from 0: points on a line divide it into segments, and change nothing."""
    d_x, d_y = np.diff(x), np.diff(y)
    length = np.sqrt(d_x**2 + d_y**2)
    turn = (d_y[:-1] * d_x[1:] - d_x[:-1] * d_y[1:]) / (length[:-1] * length[1:])
    # Planes are the same within this sine of the angle between them.
    return np.concatenate([[0], np.cumsum(np.abs(turn) > 1e-9)])


def _problem_with_points(x: np.ndarray, y: np.ndarray) -> str | None:
    """Say what keeps points from being a profile, to follow the words "a profile"."""
    if x.ndim != 1 or x.shape != y.shape:
        return f" needs as many y as x, but got shapes {x.shape} and {y.shape}"
    if len(x) < 2:
        return f" needs at least two points, but got {len(x)}"
    for name, values in (("x", x), ("y", y)):
        if bad := problem_with(values, name):
            i, problem = bad
            return f"'s {name} of point {i + 1} {problem}"
    i = first_turning_back(x)
    if i is not None:
        hint = ""
        if x[i] == x[i + 1]:
            hint = "; a wall needs some width, such as 0.01 m"
            if y[i] == y[i + 1]:
                hint = ", which is the point before once more"
        return (
            f" needs x that increases from point to point, but x goes from {x[i]:.10g} "
            f"to {x[i + 1]:.10g} at point {i + 2}{hint}"
        )
    return None


@dataclasses.dataclass(frozen=True, init=False)
class Ground:
    """Ground as each block finds it: soil, rolling friction and roughness.

    Args:
        soil: fields that broadcast to `(blocks, segments)`.
        rolling_friction_angle: angle of rolling friction [rad], in [0, pi/2), broadcast
            likewise.
        roughness: standard deviation of the angle of the facets [rad], from 0 to 30
            degrees, broadcast likewise; see `contacts.roughness`.
        seed: of the facets, a whole number from 0.
        numbers: block numbers, `(blocks,)`, whole and from 0, that select the blocks'
            random facets; from 0 on if not given.

    Raises ValueError, in one sentence, for values out of range.
    """

    soil: Soil
    rolling_friction_angle: np.ndarray
    roughness: np.ndarray
    seed: int
    numbers: np.ndarray | None

    def __init__(
        self,
        soil: Soil | None = None,
        rolling_friction_angle: ArrayLike = ROLLING_FRICTION_ANGLE,
        roughness: ArrayLike = 0.0,
        seed: int = 0,
        numbers: ArrayLike | None = None,
    ):
        soil = Soil() if soil is None else soil
        expect("a ground's soil", soil, Soil)
        seed = whole_number("a ground's seed", seed, 0)
        # NumPy arrays, since they are looked up lane by lane.
        soil = jax.tree.map(lambda leaf: np.asarray(leaf, float), soil)
        angles = [
            np.asarray(real_numbers(f"a ground's {name}", values), float)
            for name, values in (
                ("rolling_friction_angle", rolling_friction_angle),
                ("roughness", roughness),
            )
        ]
        if numbers is not None:
            given = np.asarray(real_numbers("a ground's numbers", numbers))
            whole = np.clip(np.floor(given), 0.0, 2.0**53)
            if given.ndim != 1 or not np.array_equal(given, whole):
                raise InputError(
                    "a ground's numbers must be a list of whole numbers from 0, but "
                    f"are {numbers!r}"
                )
            numbers = whole.astype(int)
        values = soil, *angles, seed, numbers
        for field, value in zip(dataclasses.fields(self), values, strict=True):
            object.__setattr__(self, field.name, value)
        columns = ground_columns(self.soil)
        for name, values in ground_values(self).items():
            column = columns[name]
            allowed = column.is_allowed(values / column.factor)
            if not np.all(allowed):
                value = float(values[~allowed].flat[0])
                raise InputError(
                    f"a ground's {column.name} must be {column.requirement}, but holds "
                    f"{column.describe(value, column.si_unit)}"
                )

    @classmethod
    def of_profile(cls, profile: Profile, seed: int = 0) -> "Ground":
        """Take the ground of a profile, alike for all blocks."""
        return cls(
            profile.soil, profile.rolling_friction_angle, profile.roughness, seed
        )

    def with_soil(self, soil: Soil) -> "Ground":
        """Put another soil in place."""
        return dataclasses.replace(self, soil=soil)

    def of_blocks(self, chosen: np.ndarray) -> "Ground":
        """Select the ground of some blocks, which keep their numbers."""

        def select(values):
            differs = values.ndim == 2 and len(values) > 1
            return values[chosen] if differs else values

        return Ground(
            jax.tree.map(select, self.soil),
            select(self.rolling_friction_angle),
            select(self.roughness),
            self.seed,
            chosen if self.numbers is None else self.numbers[chosen],
        )


def check_inside(profile: Profile, x: float, verb: str = "is", **place) -> None:
    """Raise InputError, with its place in a file, for an x at or beyond the ends."""
    if not profile.x[0] < x < profile.x[-1]:
        raise InputError(
            f"must lie between the ends of the profile, {profile.x[0]:.10g} and "
            f"{profile.x[-1]:.10g}, but {verb} {x:.10g}",
            **place,
        )


def ground_values(ground: Profile | Ground) -> dict[str, np.ndarray]:
    """List the quantities of a ground by the names of their columns, in SI units."""
    return {
        name: np.asarray(
            getattr(ground.soil if column.part == "soil" else ground, column.field)
        )
        for name, column in ground_columns(ground.soil).items()
    }


def with_ground_values(soil: Soil, values: Mapping[str, Any]) -> tuple[Soil, Any, Any]:
    """Give soil, angle of rolling friction and roughness with other quantities, by the
    names of their columns, in SI units. The soil gives what is not among the values;
    angles that are not there have their defaults."""
    columns = columns_of_part("soil", soil)
    fields = {c.field: values[name] for name, c in columns.items() if name in values}
    rolling, roughness = (
        values.get(name, column.factor * column.default)
        for name, column in ANGLE_COLUMNS.items()
    )
    return dataclasses.replace(soil, **fields), rolling, roughness


def spread(values: ArrayLike, blocks: int, segments: int) -> np.ndarray:
    """Broadcast a quantity of the ground to `(blocks, segments)`, without a copy.

    Raises ValueError, in one sentence, where its shape does not allow that.
    """
    try:
        return np.broadcast_to(values, (blocks, segments))
    except ValueError:
        raise ValueError(
            f"fields of a ground must broadcast to {blocks} blocks and {segments} "
            f"segments, but one has shape {np.shape(values)}"
        ) from None


SAME_PLACE = 1e-6
"""Distance up to which two x are one place [m]: what a file gives in millimetres, or in
national coordinates, differs by rounding from the same in metres."""


def subdivide(profile: Profile, places: ArrayLike) -> tuple[Profile, np.ndarray]:
    """Cut the segments of a profile at some x [m], in any order; those at its points,
    to `SAME_PLACE`, or beyond its ends, cut nothing.

    The pieces have their segment's ground, and go straight on but for rounding.

    Returns:
        The profile, and for each of its segments the index of the one that it is a
        piece of, `(segments,)`. The profile itself where nothing is cut.
    """
    places = np.unique(np.asarray(places, float))
    after = np.clip(np.searchsorted(profile.x, places), 1, profile.segments)
    nearest = np.minimum(
        places - profile.x[after - 1], profile.x[after] - places
    )  # negative beyond the ends
    places = places[nearest > SAME_PLACE]
    x = np.union1d(profile.x, places[np.diff(places, prepend=-np.inf) > SAME_PLACE])
    if len(x) == len(profile.x):
        return profile, np.arange(profile.segments)
    piece = np.searchsorted(profile.x, x[:-1], side="right") - 1
    soil = jax.tree.map(lambda leaf: leaf[piece], profile.soil)
    angles = profile.rolling_friction_angle[piece], profile.roughness[piece]
    return Profile(x, profile.height(x), soil, *angles), piece

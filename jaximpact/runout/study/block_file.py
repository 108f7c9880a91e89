"""Blocks and releases of a study, from its file: shapes, quantities and places."""

import dataclasses
import math
from collections.abc import Mapping
from typing import NamedTuple, cast

import numpy as np

from ...io.toml import Key, known_table, number, typed, with_named_parts
from ...quantities import INPUT_COLUMNS, InputColumn, columns_of_part
from ...scene import Block
from ...scene_quantities import SHAPE, part_named, replaced_parts
from ...shapes import AbstractShape, shape_of_each
from ...units import DEGREE
from .. import libm
from ..blocks import Release
from ..flight.placement import check_release, lying_height
from ..random_inputs import Quantity, Uniform
from ..terrain import Profile
from .quantity import read_quantity

MASS, VOLUME = "mass_kg", "volume_m3"
VOLUME_COLUMN = dataclasses.replace(
    INPUT_COLUMNS[MASS],
    name=VOLUME,
    field="volume",
    default=math.nan,
    unit="m3",
    meaning="volume",
    usual=(1e-9, 1e5),
)
"""Volume as a study may have it in place of the mass."""


class BlockInput(NamedTuple):
    """Blocks as the file says them, in the units of its names."""

    kinds: tuple[type[AbstractShape], ...]  # shapes of the blocks
    base: Block  # block with a shape of each kind, all else being the default
    quantities: dict[str, Quantity]  # by name; several shapes as their indices

    @property
    def columns(self) -> dict[str, InputColumn]:
        """Columns of the blocks, by name."""
        return columns_of_part("block", self.base)

    def of_samples(self, samples: Mapping[str, np.ndarray], count: int) -> Block:
        """Make the blocks of samples `(count,)` by name."""
        base = self.base
        if len(self.kinds) > 1:
            kinds = [self.kinds[int(i)] for i in samples[SHAPE]]
            base = cast(Block, replaced_parts(base, {SHAPE: shape_of_each(kinds)}))
        fields = {
            column.field: column.factor * samples[name]
            for name, column in self.columns.items()
            if name in samples
        }
        if VOLUME in samples:
            density = fields.get("density", float(base.density))
            with np.errstate(over="ignore"):  # a mass of inf is refused
                fields["mass"] = density * samples[VOLUME]
        fields.setdefault("mass", np.full(count, float(base.mass)))
        return dataclasses.replace(base, **fields)


def read_blocks(top: Key, content: dict) -> BlockInput:
    """Read the table [block] of a study."""
    key, (kinds, base) = top["block"], _shapes(top, content)
    columns = columns_of_part("block", base)
    table = known_table(top, content, "block", (*columns, VOLUME, SHAPE))
    if MASS in table and VOLUME in table:
        raise key.error(
            "takes mass_kg or volume_m3, not both: the mass is density_kgm3 times the "
            "volume"
        )
    quantities, columns = {}, columns | {VOLUME: VOLUME_COLUMN}
    for name, value in table.items():
        if name != SHAPE:
            quantities[name] = read_quantity(key[name], value, columns[name])
        elif isinstance(value, list):
            quantities[name] = tuple(map(float, range(len(value))))
    return BlockInput(kinds, base, quantities)


def _shapes(top: Key, content: dict) -> tuple[tuple[type[AbstractShape], ...], Block]:
    """Read the shapes that the file names: one, or a list; and make a block with a
    shape of each."""
    table = typed(top, content, "block", dict, {})
    key = top["block"]
    names = table.get(SHAPE)
    if not isinstance(names, list):
        base = cast(Block, with_named_parts(key, table, Block()))
        return (type(base.shape),), base
    if not names or not all(isinstance(name, str) for name in names):
        raise key[SHAPE].error(f"must be a name or a list of names, but is {names!r}")
    with key[SHAPE].located():
        shapes = [part_named(SHAPE, name, top.file.parent) for name in names]
        kinds = [type(cast(AbstractShape, shape)) for shape in shapes]
        one_of_each = {SHAPE: shape_of_each(kinds)}
        base = cast(Block, replaced_parts(Block(), one_of_each))
    if len(set(kinds)) < len(kinds):
        raise key[SHAPE].error("holds a shape twice")
    return tuple(kinds), base


RELEASE_COLUMNS = {
    name: INPUT_COLUMNS[name] for name in ("orientation_deg", "angular_velocity_degps")
}
LINE, SPACING = "along_x_m", "spacing_m"
"""Keys of a line of releases: x of its ends, and the distance along the ground from one
to the next."""
RELEASE_KEYS = (
    *("x_m", "y_m", "clearance_m", "speed_mps", "direction_deg", "v_x_mps", "v_y_mps"),
    *("orientation_deg", "angular_velocity_degps", LINE, SPACING),
)
NOT_NEGATIVE = ("clearance_m", "speed_mps")


def read_release(top: Key, content: dict, profile: Profile) -> dict[str, Quantity]:
    """Read the table [release] of a study: its quantities by name. One named `LINE` is
    a distance along the ground from the profile's left end [m]."""
    key = top["release"]
    table = dict(known_table(top, content, "release", RELEASE_KEYS))
    spacing, line = table.pop(SPACING, None), table.pop(LINE, None)
    quantities = {
        name: read_quantity(key[name], v, RELEASE_COLUMNS.get(name))
        for name, v in table.items()
    }
    _check_alternatives(key, quantities, line is not None)
    if line is not None:
        quantities[LINE] = _line(key, line, spacing, profile)
    elif spacing is not None:
        raise key[SPACING].error(f"needs {LINE} too")
    return quantities


def make_release(
    top: Key, samples: dict[str, np.ndarray], profile: Profile, blocks: BlockInput
) -> Release:
    """Make the releases of samples `(blocks,)` by name; InputError for blocks that do
    not start on or above the ground."""
    count = len(next(iter(samples.values())))

    def si(name: str, default: float = 0.0) -> np.ndarray:
        factor = DEGREE if "_deg" in name else 1.0
        return factor * samples.get(name, np.full(count, default))

    block = blocks.of_samples(samples, count)
    x, orientation = si("x_m"), si("orientation_deg")
    if LINE in samples:
        x = np.interp(samples[LINE], _along_ground(profile), profile.x)
    speed, direction = si("speed_mps"), si("direction_deg")
    along, up = si("v_x_mps"), si("v_y_mps")
    try:
        high = Release(block, x, 0.0, orientation=orientation)
        y = si("y_m") if "y_m" in samples else si("clearance_m")
        if "y_m" not in samples:
            y = y + lying_height(profile, high.outline, x, orientation)
        release = Release(
            block,
            x,
            np.where(np.isfinite(y), y, 0.0),  # off the profile, which is refused next
            along + speed * libm.cos(direction),
            up + speed * libm.sin(direction),
            orientation,
            si("angular_velocity_degps"),
        )
        check_release(release, profile)
    except ValueError as error:
        raise top["release"].error(str(error)) from None
    return release


def _along_ground(profile: Profile) -> np.ndarray:
    """Compute the distance along the ground of each point from the left end [m]."""
    return np.concatenate([[0.0], np.cumsum(profile.length)])


def _line(key: Key, line, spacing, profile: Profile) -> Quantity:
    """Read a line of releases: uniform along the ground between two x, or places at
    equal spacing from the first on."""
    if not isinstance(line, list) or len(line) != 2:
        raise key[LINE].error(f"must be a list of two x, [from, to], but is {line!r}")
    start, stop = (number(key[LINE], x) for x in line)
    if not profile.x[0] <= start < stop <= profile.x[-1]:
        raise key[LINE].error(
            "must go up, between the ends of the profile, "
            f"{profile.x[0]:.10g} and {profile.x[-1]:.10g}, but is {line!r}"
        )
    ends = np.interp([start, stop], profile.x, _along_ground(profile)).tolist()
    if spacing is None:
        return Uniform(*ends)
    spacing = number(key[SPACING], spacing)
    length = ends[1] - ends[0]
    # The last place may be the end of the line, but for rounding.
    if not 0.0 < spacing <= length or length / spacing > 100_000:
        raise key[SPACING].error(
            f"must be above 0 and at most the line's length along the ground, "
            f"{length:g} m, with at most 100000 places, but is {spacing:g}"
        )
    places = ends[0] + spacing * np.arange(int(length / spacing * (1.0 + 1e-12)) + 1)
    return tuple(np.minimum(places, ends[1]).tolist())


def _check_alternatives(
    key: Key, quantities: dict[str, Quantity], has_line: bool
) -> None:
    if ("x_m" in quantities) == has_line:
        if has_line:
            raise key.error(f"takes x_m or {LINE}, not both")
        raise key.error(f"needs x_m or {LINE}, but has neither")
    heights = [n for n in ("y_m", "clearance_m") if n in quantities]
    if len(heights) != 1:
        has = "both" if heights else "neither"
        raise key.error(f"needs y_m or clearance_m, but has {has}")
    polar = [n for n in ("speed_mps", "direction_deg") if n in quantities]
    cartesian = [n for n in ("v_x_mps", "v_y_mps") if n in quantities]
    if polar and cartesian:
        raise key.error(
            f"takes speed_mps and direction_deg, or v_x_mps and v_y_mps, but has "
            f"{polar[0]} and {cartesian[0]}"
        )

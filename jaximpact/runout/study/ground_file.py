"""Ground of a study, from its file."""

import dataclasses
import hashlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np

from ...errors import InputError
from ...io.toml import known_table, typed, unknown, with_named_parts
from ...parameters import parts_of
from ...quantities import columns_of_part
from ...soil import Soil
from ..random_inputs import Quantity
from ..terrain import (
    ROLLING_FRICTION_ANGLE,
    Ground,
    Profile,
    ground_columns,
    read_profile,
)
from .calibrated import Calibrated, read_calibrated
from .quantity import read_quantity

LAWS = tuple(parts_of(Soil))
"""Keys of the ground that name laws."""
NO_QUANTITIES = ("segment", "from", "variant", *LAWS)
"""Keys of the ground that are no quantities."""


class GroundInput(NamedTuple):
    """Ground as the file says it, in the units of its names."""

    path: Path
    soil: Soil
    """Soil with the laws; the values of parameters are in the other fields."""
    everywhere: dict[str, Quantity]
    """Quantities of all segments, by name."""
    segments: dict[int, dict[str, Quantity]]
    """Quantities of single segments, by the segment's number from 0."""
    calibrated: Calibrated | None
    """Calibration to sample parameters from, other than those in `everywhere`."""

    @classmethod
    def read(cls, path: Path, content: dict) -> "GroundInput":
        """Read the table [ground] of a study."""
        table = typed(path, content, "ground", dict, {})
        calibrated = _calibrated(path, table)
        soil = calibrated.soil if calibrated else Soil()
        soil = cast(Soil, with_named_parts(path, "ground", table, soil))
        segments = {}
        for name, values in typed(path, table, "segment", dict, {}).items():
            key = f"ground.segment.{name}"
            if not re.fullmatch("[1-9][0-9]*|0", name):
                raise InputError("must be the number of a segment", file=path, key=key)
            values = typed(path, table["segment"], name, dict)
            segments[int(name) - 1] = _ground_quantities(path, values, key, soil)
        everywhere = {k: v for k, v in table.items() if k not in NO_QUANTITIES}
        everywhere = _ground_quantities(path, everywhere, "ground", soil)
        if calibrated is not None:
            _check_calibrated(path, table, calibrated, everywhere)
            everywhere = calibrated.fixed | everywhere
        return cls(path, soil, everywhere, segments, calibrated)

    def sampled_jointly(self) -> dict[str, str]:
        """List the parameters that are sampled from a calibration, by key."""
        names = self.calibrated.names if self.calibrated else ()
        return {f"ground.{n}": n for n in names if n not in self.everywhere}

    def sample_jointly(
        self, samples: Mapping[str, np.ndarray], count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Sample these parameters.

        Args:
            samples: samples of the quantities of `varied`, by key.

        Returns:
            Samples `(count,)` by key.
        """
        if self.calibrated is None or not self.sampled_jointly():
            return {}
        given = {
            name: np.broadcast_to(samples.get(f"ground.{name}", value), (count,))
            for name, value in self.everywhere.items()
            if name in self.calibrated.names
        }
        found = self.calibrated.draw(given, count, seed)
        return {f"ground.{name}": values for name, values in found.items()}

    def varied(self) -> dict[str, Quantity]:
        """List the quantities that differ from block to block by themselves, by key."""
        keys = {f"ground.{name}": q for name, q in self.everywhere.items()}
        for segment, quantities in self.segments.items():
            where = f"ground.segment.{segment + 1}"
            keys |= {f"{where}.{name}": q for name, q in quantities.items()}
        return {key: q for key, q in keys.items() if not isinstance(q, float)}

    def of_blocks(self, profile: Profile, samples: Mapping, seed: int) -> Ground:
        """Make the ground as each block finds it.

        Args:
            samples: samples by the keys of `varied` and `sampled_jointly`.
        """
        ground = Ground.of_profile(profile, seed)
        columns = ground_columns(ground.soil)
        soil = {
            column.field: getattr(ground.soil, column.field)
            for column in columns.values()
            if column.part == "soil"
        }
        angles = {
            name: getattr(ground, name)
            for name in ("rolling_friction_angle", "roughness")
        }
        for key in (*self.sampled_jointly(), *self.varied()):
            _, *where, name = key.split(".")
            column = columns[name]
            fields = soil if column.part == "soil" else angles
            values = column.factor * samples[key][:, None]
            if where:
                segment = int(where[1]) - 1
                shape = (len(values), profile.segments)
                whole = np.array(np.broadcast_to(fields[column.field], shape))
                whole[:, segment] = values[:, 0]
                values = whole
            elif any(name in quantities for quantities in self.segments.values()):
                shape = (len(values), profile.segments)
                given = [s for s, q in self.segments.items() if name in q]
                values = np.array(np.broadcast_to(values, shape))
                values[:, given] = fields[column.field][given]
            fields[column.field] = values
        soil = dataclasses.replace(ground.soil, **soil)
        return Ground(soil, **angles, seed=seed)


def _ground_quantities(
    path: Path, values: dict, where: str, soil: Soil
) -> dict[str, Quantity]:
    columns = ground_columns(soil)
    for name in values:
        key = f"{where}.{name}"
        if name in LAWS:
            raise InputError(
                f"names a law of one segment, but a slope has one {name} for all; name "
                "it under [ground]",
                file=path,
                key=key,
            )
        if name not in columns:
            unknown(path, key, name, (*columns, *NO_QUANTITIES))
    return {
        name: read_quantity(path, f"{where}.{name}", value, columns[name])
        for name, value in values.items()
    }


def _calibrated(path: Path, table: dict) -> Calibrated | None:
    """Read the calibration that the table names, if it names one."""
    if "from" not in table:
        if "variant" in table:
            raise InputError("needs from too", file=path, key="ground.variant")
        return None
    variant = typed(path, table, "variant", str) if "variant" in table else None
    return read_calibrated(path.parent / typed(path, table, "from", str), variant)


def _check_calibrated(
    path: Path, table: dict, calibrated: Calibrated, said: dict
) -> None:
    """Raise InputError for a law beside a calibration, and for a parameter that is
    neither in the table nor identifiable.

    Args:
        said: quantities in the table.
    """
    for slot in LAWS:
        if slot in table:
            raise InputError(
                "comes with the calibration that from names; remove it",
                file=path,
                key=f"ground.{slot}",
            )
    for name, reason in calibrated.undetermined.items():
        if name not in said:
            raise InputError(
                f"must say {name}, which the tests do not determine: {reason}",
                file=path,
                key="ground",
            )


def read_ground_profile(
    path: Path, content: dict, ground: GroundInput, checksums: dict[Path, str]
) -> Profile:
    """Read the profile, with the ground that is alike for all blocks; add the checksums
    of files that are read."""
    if ground.calibrated is not None:
        checksums[ground.calibrated.file] = ground.calibrated.checksum
    table = known_table(path, content, "profile", ("points_m", "csv"))
    if len(table) != 1:
        raise InputError(
            "needs points_m or csv, and not both", file=path, key="profile"
        )
    fields, angles = _alike(ground.everywhere, ground.soil)
    soil = dataclasses.replace(ground.soil, **fields)
    angles.setdefault("rolling_friction_angle", ROLLING_FRICTION_ANGLE)
    if "csv" in table:
        csv = path.parent / typed(path, table, "csv", str)
        profile = read_profile(csv, soil, **angles)
        checksums[csv] = hashlib.sha256(csv.read_bytes()).hexdigest()
        _check_said_once(ground, csv)
    else:
        points = typed(path, table, "points_m", list)
        try:
            if not all(type(c) in (int, float) for point in points for c in point):
                raise TypeError
            x, y = np.array(points, float).reshape(len(points), 2).T
            profile = Profile(x, y, soil, **angles)
        except (TypeError, ValueError) as error:
            told = str(error)
            if not told.startswith("a profile"):
                told = f"must be a list of [x, y], but is {points!r}"
            raise InputError(told, file=path, key="profile.points_m") from None
    return _with_segments(path, profile, ground.segments)


def _alike(quantities: dict[str, Quantity], soil: Soil) -> tuple[dict, dict]:
    """Select quantities that are one number: fields of the soil, and angles of the
    ground, in SI units."""
    of_soil, angles, columns = {}, {}, ground_columns(soil)
    for name, value in quantities.items():
        if isinstance(value, float):
            column = columns[name]
            fields = of_soil if column.part == "soil" else angles
            fields[column.field] = column.factor * value
    return of_soil, angles


def _check_said_once(ground: GroundInput, csv: Path) -> None:
    """Raise InputError for a distribution that a column of the profile would hide."""
    header = csv.read_bytes().decode("utf-8-sig").lstrip().splitlines()[0]
    columns = {name.strip() for name in header.split(",")}
    varied = [*ground.varied(), *ground.sampled_jointly()]
    for name in columns:
        if f"ground.{name}" in varied:
            raise InputError(
                f"differs from block to block, but {csv.name} has a column of it",
                file=ground.path,
                key=f"ground.{name}",
            )


def _with_segments(path: Path, profile: Profile, segments: dict) -> Profile:
    fields = {
        column.field: np.array(getattr(profile.soil, column.field))
        for column in columns_of_part("soil", profile.soil).values()
    }
    angles = {
        name: getattr(profile, name).copy()
        for name in ("rolling_friction_angle", "roughness")
    }
    for segment, quantities in segments.items():
        if not 0 <= segment < profile.segments:
            raise InputError(
                f"must be the number of a segment, from 1 to {profile.segments}",
                file=path,
                key=f"ground.segment.{segment + 1}",
            )
        of_soil, of_angles = _alike(quantities, profile.soil)
        for values, given in ((fields, of_soil), (angles, of_angles)):
            for field, value in given.items():
                values[field][segment] = value
    soil = dataclasses.replace(profile.soil, **fields)
    return Profile(profile.x, profile.y, soil, **angles)

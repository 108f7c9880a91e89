"""Ground of a study, from its file."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np

from ...io.toml import Key, number, typed, unknown, with_named_parts
from ...parameters import parts_of
from ...scene import Soil
from ..random_inputs import Quantity, RandomField
from ..terrain import Ground, ground_columns, ground_values, with_ground_values
from .calibrated import Calibrated, read_calibrated
from .ground_layout import GroundLayout, GroundPart
from .quantity import read_ground_quantity

LAWS = tuple(parts_of(Soil))
"""Keys of the ground that name laws."""
PARTS = ("segment", "materials")
NO_QUANTITIES = (*PARTS, "from", "variant", *LAWS)
"""Keys of the ground that are no quantities."""
ENDS = ("from_x_m", "to_x_m")
"""Keys of a material that are no quantities."""
SEGMENT_NAME, MATERIAL_NAME = "[1-9][0-9]*|0", r"[A-Za-z0-9_-]+"


class GroundInput(NamedTuple):
    """Ground as the file says it, in the units of its names."""

    path: Path
    soil: Soil
    """Soil with the laws; the values of parameters are in the other fields."""
    everywhere: dict[str, Quantity | RandomField]
    """Quantities of the whole slope, by name."""
    parts: dict[str, GroundPart]
    """Segments and materials with quantities of their own, by key."""
    calibrated: Calibrated | None
    """Calibration to sample parameters from, other than those in `everywhere`."""

    @classmethod
    def read(cls, path: Path, content: dict) -> "GroundInput":
        """Read the table [ground] of a study."""
        top = Key(path)
        key, table = top["ground"], typed(top, content, "ground", dict, {})
        calibrated = _calibrated(key, table)
        soil = calibrated.soil if calibrated else Soil()
        soil = cast(Soil, with_named_parts(key, table, soil))
        if all(kind in table for kind in PARTS):
            raise key.error(
                "has segments and materials; say what differs along the slope by one "
                "of them"
            )
        parts = _segments(key, table, soil) | _materials(key, table, soil)
        everywhere = {k: v for k, v in table.items() if k not in NO_QUANTITIES}
        everywhere = _quantities(key, everywhere, soil, NO_QUANTITIES)
        if calibrated is not None:
            _check_calibrated(key, table, calibrated, everywhere)
            everywhere = calibrated.fixed | everywhere
        return cls(path, soil, everywhere, parts, calibrated)

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
        given = {}
        for name, value in self.everywhere.items():
            if name in self.calibrated.names:
                sampled = samples.get(f"ground.{name}")
                # Without samples a number: fields are refused beside a calibration.
                given[name] = np.full(count, value) if sampled is None else sampled
        found = self.calibrated.draw(given, count, seed)
        return {f"ground.{name}": values for name, values in found.items()}

    def _by_key(self) -> dict[str, Quantity | RandomField]:
        keys = {f"ground.{name}": q for name, q in self.everywhere.items()}
        for part in self.parts.values():
            keys |= {f"ground.{part.key}.{n}": q for n, q in part.quantities.items()}
        return keys

    def varied(self) -> dict[str, Quantity]:
        """List the quantities that differ from block to block by themselves, by key."""
        keys = self._by_key().items()
        return {k: q for k, q in keys if not isinstance(q, float | RandomField)}

    def fields(self) -> dict[str, RandomField]:
        """List the quantities that vary along the slope, by key."""
        return {k: q for k, q in self._by_key().items() if isinstance(q, RandomField)}

    def sample_fields(
        self, layout: GroundLayout, count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Sample these, `(count, segments where they hold)` by key."""
        start = layout.profile.x[0]
        return {
            key: field.values(
                key, field.cells(layout.middles[layout.where(key)], start), count, seed
            )
            for key, field in self.fields().items()
        }

    def of_blocks(self, layout: GroundLayout, samples: Mapping, seed: int) -> Ground:
        """Make the ground as each block finds it.

        Args:
            samples: samples by the keys of `varied`, `fields` and `sampled_jointly`.
        """
        profile = layout.profile
        columns, found = ground_columns(profile.soil), ground_values(profile)
        for key in (*self.sampled_jointly(), *self.varied(), *self.fields()):
            name = key.split(".")[-1]
            own = samples[key].reshape(len(samples[key]), -1)
            values, where = columns[name].factor * own, layout.where(key)
            if not np.all(where):
                whole = np.broadcast_to(found[name], (len(values), profile.segments))
                whole = np.array(whole)
                whole[:, where] = values
                values = whole
            found[name] = values
        return Ground(*with_ground_values(profile.soil, found), seed)


def _segments(ground: Key, table: dict, soil: Soil) -> dict[str, GroundPart]:
    parts, segments = {}, typed(ground, table, "segment", dict, {})
    for name in segments:
        key = ground["segment"][name]
        if not re.fullmatch(SEGMENT_NAME, name):
            raise key.error("must be the number of a segment")
        values = typed(ground["segment"], segments, name, dict)
        quantities = _quantities(key, values, soil)
        parts[f"segment.{name}"] = GroundPart(
            f"segment.{name}", quantities, int(name) - 1
        )
    return parts


def _materials(ground: Key, table: dict, soil: Soil) -> dict[str, GroundPart]:
    parts, materials = {}, typed(ground, table, "materials", dict, {})
    for name in materials:
        key = ground["materials"][name]
        if not re.fullmatch(MATERIAL_NAME, name):
            raise key.error("must be a name of letters, digits, _ and -")
        values = dict(typed(ground["materials"], materials, name, dict))
        ends = [number(key[end], values.pop(end)) for end in ENDS if end in values]
        quantities = _quantities(key, values, soil, ENDS)
        if len(ends) == 1 or (ends and not ends[0] < ends[1]):
            raise key.error("needs from_x_m and to_x_m, the larger one")
        parts[f"materials.{name}"] = GroundPart(
            f"materials.{name}", quantities, ends=tuple(ends) or None
        )
    return parts


def _quantities(
    table: Key, values: dict, soil: Soil, others: tuple = ()
) -> dict[str, Quantity | RandomField]:
    """Read quantities of the ground.

    Args:
        others: further keys that the table may hold.
    """
    columns = ground_columns(soil)
    for name in values:
        if name in LAWS:
            raise table[name].error(
                f"names a law of one part of the slope, but a slope has one {name} for "
                "all; name it under [ground]"
            )
        if name not in columns:
            raise unknown(table, name, (*columns, *others))
    return {
        name: read_ground_quantity(table[name], value, columns[name])
        for name, value in values.items()
    }


def _calibrated(ground: Key, table: dict) -> Calibrated | None:
    """Read the calibration that the table names, if it names one."""
    if "from" not in table:
        if "variant" in table:
            raise ground["variant"].error("needs from too")
        return None
    variant = typed(ground, table, "variant", str) if "variant" in table else None
    directory = ground.file.parent
    return read_calibrated(directory / typed(ground, table, "from", str), variant)


def _check_calibrated(
    key: Key, table: dict, calibrated: Calibrated, said: dict
) -> None:
    """Raise InputError for a law beside a calibration, for a parameter that is neither
    in the table nor identifiable, and for a fitted one that varies along the slope.

    Args:
        said: quantities in the table.
    """
    for slot in LAWS:
        if slot in table:
            raise key[slot].error(
                "comes with the calibration that from names; remove it"
            )
    for name, reason in calibrated.undetermined.items():
        if name not in said:
            raise key.error(
                f"must say {name}, which the tests do not determine: {reason}"
            )
    for name in calibrated.names:
        if isinstance(said.get(name), RandomField):
            raise key[name].error(
                "varies along the slope, but the calibration samples other parameters "
                "conditional on it; leave out correlation_length_m"
            )

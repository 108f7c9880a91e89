"""Ground of a study, from its file: quantities of the whole slope and of parts of it,
and where on the profile each of them holds."""

import re
import warnings
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple, cast

import numpy as np

from ...errors import did_you_mean
from ...io.toml import Key, number, of_kind, typed, unknown, with_named_parts
from ...laws import WorkConjugate
from ...parameters import parts_of
from ...scene import Soil
from ..random_inputs import Quantity, RandomField
from ..smoothing import Smoothing
from ..terrain import (
    Ground,
    Profile,
    ground_columns,
    ground_values,
    stretches,
    subdivide,
    with_ground_values,
)
from .calibrated_ground import Calibrated, read_calibrated
from .quantity import LENGTH, read_ground_quantity

LAWS = tuple(parts_of(Soil))
"""Keys of the ground that name laws."""
PARTS = ("segment", "materials")
NO_QUANTITIES = (*PARTS, "from", "variant", *LAWS)
"""Keys of the ground that are no quantities."""
ENDS = ("from_x_m", "to_x_m")
"""Keys of a material that are no quantities."""
MOST_CELLS = 5_000
"""Largest number of cells of a field: a block that rolls takes an event for each, and
has 10 000 unless the study says otherwise."""

Quantities = dict[str, Quantity | RandomField]
"""Quantities of the ground by their keys in the file."""


class GroundPart(NamedTuple):
    """Part of the slope with quantities of its own: a segment or a material."""

    name: str  # of a material, number of a segment
    segment: int | None = None  # index, from 0
    ends: tuple[float, ...] | None = None
    """Least and largest x of a material [m]; None where the profile names it."""


class GroundLayout(NamedTuple):
    """Profile of a study, with what holds on which of its segments."""

    profile: Profile
    """The profile, cut where the ground changes within a segment, with the ground that
    is alike for all blocks."""
    places: dict[str, np.ndarray]  # bool `(segments,)` of each part, by key
    owners: dict[str, list[str]]  # keys of the parts with a quantity of their own
    materials: tuple[str, ...]  # material of each segment, "" for none
    smoothing: Smoothing | None = None  # what a smoothing did to the profile

    @property
    def middles(self) -> np.ndarray:
        """x of the middles of the segments [m], `(segments,)`."""
        return 0.5 * (self.profile.x[1:] + self.profile.x[:-1])

    def where(self, key: str) -> np.ndarray:
        """Tell on which segments a quantity holds, by its key, bool `(segments,)`: on
        its part, or for the whole slope where no part has one of its own."""
        _, *part, name = key.split(".")
        if part:
            return self.places[".".join(part)]
        elsewhere = np.zeros(self.profile.segments, bool)
        for owner in self.owners.get(name, ()):
            elsewhere |= self.places[owner]
        return ~elsewhere


class GroundInput(NamedTuple):
    """Ground as the file says it, in the units of its names.

    Keys of quantities are those of the file, such as ground.c_v and
    ground.materials.scree.c_v.
    """

    top: Key  # of the file
    soil: Soil  # gives the laws; values are in the other fields
    quantities: Quantities
    parts: dict[str, GroundPart]  # by keys under [ground]: materials.scree
    calibrated: Calibrated | None  # to sample the rest from

    @classmethod
    def read(cls, top: Key, content: dict) -> "GroundInput":
        """Read the table [ground] of a study."""
        key, table = top["ground"], typed(top, content, "ground", dict, {})
        calibrated = _calibrated(key, table)
        soil = calibrated.soil if calibrated else _default_soil(content)
        soil = cast(Soil, with_named_parts(key, table, soil))
        if all(kind in table for kind in PARTS):
            raise key.error(
                "has segments and materials; say what differs along the slope by one "
                "of them"
            )
        everywhere = {k: v for k, v in table.items() if k not in NO_QUANTITIES}
        quantities = _quantities(key, everywhere, soil, NO_QUANTITIES)
        if calibrated is not None:
            _check_calibrated(key, table, calibrated, quantities)
            fixed = {f"ground.{name}": v for name, v in calibrated.fixed.items()}
            quantities = fixed | quantities
        parts: dict[str, GroundPart] = {}
        for kind, read in (("segment", _segment), ("materials", _material)):
            for name, values in typed(key, table, kind, dict, {}).items():
                parts[f"{kind}.{name}"], of_part = read(key[kind], name, values, soil)
                quantities |= of_part
        return cls(top, soil, quantities, parts, calibrated)

    def sampled_jointly(self) -> dict[str, str]:
        """List the parameters that are sampled from a calibration, by key."""
        names = self.calibrated.names if self.calibrated else ()
        keys = {f"ground.{name}": name for name in names}
        return {key: n for key, n in keys.items() if key not in self.quantities}

    def sample_jointly(
        self, samples: Mapping[str, np.ndarray], count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Sample these parameters, `(count,)` by key, given the samples of `varied`."""
        if self.calibrated is None or not self.sampled_jointly():
            return {}
        said = {}
        for name in self.calibrated.names:
            if (value := self.quantities.get(f"ground.{name}")) is not None:
                sampled = samples.get(f"ground.{name}")
                # Without samples a number: fields are refused beside a calibration.
                said[name] = np.full(count, value) if sampled is None else sampled
        drawn = self.calibrated.draw(said, count, seed)
        return {f"ground.{name}": values for name, values in drawn.items()}

    def alike(self) -> Iterator[tuple[str, str, float]]:
        """Yield key, name and value, in SI units, of the quantities that are a
        number."""
        columns = ground_columns(self.soil)
        for key, value in self.quantities.items():
            if isinstance(value, float):
                name = key.split(".")[-1]
                yield key, name, columns[name].factor * value

    def varied(self) -> dict[str, Quantity]:
        """List the quantities that differ from block to block by themselves, by key."""
        quantities = self.quantities.items()
        return {k: q for k, q in quantities if not isinstance(q, float | RandomField)}

    def fields(self) -> dict[str, RandomField]:
        """List the quantities that vary along the slope, by key."""
        quantities = self.quantities.items()
        return {k: q for k, q in quantities if isinstance(q, RandomField)}

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
        """Make the ground as each block finds it, from samples by the keys of `varied`,
        `fields` and `sampled_jointly`."""
        profile = layout.profile
        columns, by_name = ground_columns(profile.soil), ground_values(profile)
        for key in (*self.sampled_jointly(), *self.varied(), *self.fields()):
            name, where = key.split(".")[-1], layout.where(key)
            values = samples[key].reshape(len(samples[key]), -1)
            values = columns[name].factor * values
            if not np.all(where):
                shape = len(values), profile.segments
                whole = np.array(np.broadcast_to(by_name[name], shape))
                whole[:, where] = values
                values = whole
            by_name[name] = values
        return Ground(*with_ground_values(profile.soil, by_name), seed)


def _default_soil(content: dict) -> Soil:
    """Make the soil of run-outs: by `WorkConjugate`, whose contacts give no block
    energy without a source. Beside tables, which were made by `tabulate`, it is
    the soil of impacts."""
    laws = content.get("contacts")
    laws = laws if isinstance(laws, list) else [laws]
    if any(isinstance(law, dict) and law.get("law") == "table" for law in laws):
        return Soil()
    return Soil(kinematics=WorkConjugate())


def _segment(
    table: Key, name: str, values, soil: Soil
) -> tuple[GroundPart, Quantities]:
    if not re.fullmatch("[1-9][0-9]*|0", name):
        raise table[name].error("must be the number of a segment")
    values = of_kind(table[name], values, dict)
    return GroundPart(name, int(name) - 1), _quantities(table[name], values, soil)


def _material(
    table: Key, name: str, values, soil: Soil
) -> tuple[GroundPart, Quantities]:
    key = table[name]
    if not re.fullmatch(r"[\w-]+", name):
        raise key.error("must be a name of letters, digits, _ and -")
    values = dict(of_kind(key, values, dict))
    ends = [number(key[end], values.pop(end)) for end in ENDS if end in values]
    quantities = _quantities(key, values, soil, ENDS)
    if len(ends) == 1 or (ends and not ends[0] < ends[1]):
        raise key.error("needs from_x_m and to_x_m, the larger one")
    return GroundPart(name, ends=tuple(ends) or None), quantities


def _quantities(table: Key, values: dict, soil: Soil, others: tuple = ()) -> Quantities:
    """Read quantities of the ground from a table that may hold other keys too."""
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
        f"{table.name}.{name}": read_ground_quantity(table[name], value, columns[name])
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
    key: Key, table: dict, calibrated: Calibrated, said: Mapping[str, object]
) -> None:
    """Raise InputError for a law beside a calibration, for a parameter that is neither
    among the quantities of the table nor identifiable, and for a fitted one that varies
    along the slope."""
    for slot in LAWS:
        if slot in table:
            raise key[slot].error(
                "comes with the calibration that from names; remove it"
            )
    for name, reason in calibrated.undetermined.items():
        if f"ground.{name}" not in said:
            raise key.error(
                f"must say {name}, which is not identifiable from the tests: {reason}"
            )
    for name in calibrated.names:
        if isinstance(said.get(f"ground.{name}"), RandomField):
            raise key[name].error(
                "varies along the slope, but the calibration samples other parameters "
                "conditional on it; leave out correlation_length_m"
            )


def lay_out(
    ground: GroundInput,
    profile: Profile,
    materials: tuple[str, ...] | None,
    has_base: bool,
) -> GroundLayout:
    """Find where parts of the ground are, and cut the profile where they and the cells
    of fields begin and end.

    Args:
        profile: as its file has it.
        materials: material of each segment, where the profile names them.
        has_base: whether anything is known of the rest of the slope.

    Raises InputError, naming the key, for parts that are nowhere, for materials that
    overlap, and for ground without any. Warns of ground without a material where
    [ground] holds.
    """
    key, parts, fields = ground.top["ground"], ground.parts, ground.fields()
    if materials is not None:
        _check_names(key, materials, parts)
    _check_cells(key, profile, fields)
    ends = [end for part in parts.values() for end in part.ends or ()]
    owners: dict[str, list[str]] = {}
    for quantity in ground.quantities:
        _, *part, name = quantity.split(".")
        if part:
            owners.setdefault(name, []).append(".".join(part))
    whole, piece = subdivide(profile, ends)
    layout = GroundLayout(whole, {}, owners, ())
    for name, part in parts.items():
        layout.places[name] = _segments_of(
            key[name], part, profile, layout.middles, piece, materials
        )
    _check_cover(key, layout, parts, has_base)
    # All cuts at once: cutting pieces again would undo the turns of the first cuts.
    cuts = np.concatenate([ends, *_boundaries(layout, fields)])
    final, _ = subdivide(profile, cuts)
    middles = 0.5 * (final.x[1:] + final.x[:-1])
    piece = np.searchsorted(whole.x, middles) - 1
    places = {name: place[piece] for name, place in layout.places.items()}
    named = np.full(final.segments, "", object)
    for name, part in parts.items():
        if part.segment is None:
            named[places[name]] = part.name
    return GroundLayout(final, places, owners, tuple(named))


def _segments_of(
    key: Key,
    part: GroundPart,
    profile: Profile,
    middles: np.ndarray,
    piece: np.ndarray,
    materials: tuple[str, ...] | None,
) -> np.ndarray:
    """Find the segments of a part, after cuts of the profile.

    Args:
        middles, piece: x of the middle of each segment [m], and the index of the
            segment before the cuts that it is a piece of.
    """
    if part.segment is not None:
        if not 0 <= part.segment < profile.segments:
            raise key.error(
                f"must be the number of a segment, from 1 to {profile.segments}"
            )
        return piece == part.segment
    if materials is not None:
        if part.ends is not None:
            raise key.error(
                "has from_x_m and to_x_m, but the profile has a column material; leave "
                "one of them out"
            )
        chosen = np.array(materials)[piece] == part.name
        problem = "no row of the profile names it"
    elif part.ends is None:
        raise key.error(
            "needs from_x_m and to_x_m, or a column material in the profile's CSV"
        )
    else:
        chosen = (middles > part.ends[0]) & (middles < part.ends[1])
        ends = f"{profile.x[0]:.10g} to {profile.x[-1]:.10g}"
        problem = f"the profile goes from x = {ends}"
    if not np.any(chosen):
        raise key.error(f"is nowhere on the slope: {problem}")
    return chosen


def _check_names(
    key: Key, materials: Iterable[str], parts: Mapping[str, GroundPart]
) -> None:
    """Raise InputError for a material of the profile that the study does not define."""
    known = [part.name for part in parts.values() if part.segment is None]
    for name in materials:
        if name not in known:
            hint = f"; {did_you_mean(name, known, repr)}" if known else ""
            raise key["materials"].error(
                f"must define the material {name!r} of the profile{hint}"
            )


def _check_cover(
    key: Key, layout: GroundLayout, parts: Mapping[str, GroundPart], has_base: bool
) -> None:
    """Raise InputError where materials overlap or leave ground without any; only warn
    of the latter where [ground] holds."""
    covers = {
        part.name: layout.places[name]
        for name, part in parts.items()
        if part.segment is None
    }
    if not covers:
        return
    times, x = np.sum([*covers.values()], axis=0), layout.profile.x
    if np.any(times > 1):
        i = int(np.argmax(times > 1))
        first, second, *_ = (name for name, cover in covers.items() if cover[i])
        raise key["materials"].error(
            f"overlap: {first} and {second} are both at x = {x[i]:.10g} to "
            f"{x[i + 1]:.10g} m"
        )
    if np.any(times == 0):
        ends = stretches(times == 0)
        gaps = ", ".join(f"{x[i]:.10g} to {x[j]:.10g} m" for i, j in ends)
        if not has_base:
            raise key["materials"].error(
                f"leave x = {gaps} without a material; let one of them reach so far, "
                "or say under [ground] what is there"
            )
        warnings.warn(
            f"{key.file}, key ground.materials: no material is at x = {gaps}; what "
            "[ground] says holds there",
            stacklevel=2,
        )


def _check_cells(key: Key, profile: Profile, fields: Mapping[str, RandomField]) -> None:
    for name, field in fields.items():
        cells = (profile.x[-1] - profile.x[0]) / field.cell
        if cells > MOST_CELLS:
            raise Key(key.file)[name][LENGTH].error(
                f"cuts the profile into {cells:.3g} cells of {field.cell:g} m; at most "
                f"{MOST_CELLS} are computed, so a longer length is needed"
            )


def _boundaries(
    layout: GroundLayout, fields: Mapping[str, RandomField]
) -> list[np.ndarray]:
    """List the boundaries of the cells of each field where it holds [m], without those
    within a tenth of a cell of another cut."""
    boundaries, points = [], layout.profile.x
    for key, field in fields.items():
        x = field.boundaries(points[0], points[-1])
        segment = np.searchsorted(layout.profile.x, x, side="right") - 1
        x = x[layout.where(key)[segment]]
        left = np.searchsorted(points, x, side="right") - 1
        apart = np.minimum(x - points[left], points[left + 1] - x)
        x = x[apart > 0.1 * field.cell]
        boundaries.append(x)
        points = np.union1d(points, x)
    return boundaries

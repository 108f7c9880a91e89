"""Grounds along the profile of a study."""

import warnings
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ...errors import nearest
from ...io.toml import Key
from ..random_inputs import Quantity, RandomField
from ..smoothing import Smoothing
from ..terrain import Profile, subdivide

LEAST_PIECE = 0.1
"""Least width of a piece between a boundary of a field's cells and another point, as a
fraction of a cell; a boundary that is nearer cuts nothing."""

MOST_CELLS = 5_000
"""Largest number of cells of a field: a block that rolls takes an event for each, and
has 10 000 unless the study says otherwise."""


class GroundPart(NamedTuple):
    """Part of the slope with quantities of its own: a segment or a material."""

    key: str
    """Key under [ground]: segment.2 or materials.scree."""
    quantities: dict[str, Quantity | RandomField]
    """Quantities by name, in the units of the names."""
    segment: int | None = None
    """Index of a segment, from 0."""
    ends: tuple[float, ...] | None = None
    """Least and largest x of a material [m]; None where the profile names it."""

    @property
    def name(self) -> str:
        """Name of a material, number of a segment."""
        return self.key.split(".")[1]


class GroundLayout(NamedTuple):
    """Profile of a study, with what holds on which of its segments."""

    profile: Profile
    """The profile, cut where the ground changes within a segment, with the ground that
    is alike for all blocks."""
    places: dict[str, np.ndarray]
    """Segments of each part, by its key, bool `(segments,)`."""
    owners: dict[str, list[str]]
    """Keys of the parts that have a quantity of their own, by its name."""
    smoothing: Smoothing | None = None
    """What a smoothing did to the profile."""

    @property
    def middles(self) -> np.ndarray:
        """x of the middles of the segments [m], `(segments,)`."""
        return 0.5 * (self.profile.x[1:] + self.profile.x[:-1])

    def materials(self, parts: Iterable[GroundPart]) -> tuple[str, ...]:
        """Name the material of each segment, "" for none, of the parts of the slope."""
        found = np.full(self.profile.segments, "", object)
        for part in parts:
            if part.segment is None:
                found[self.places[part.key]] = part.name
        return tuple(found)

    def where(self, key: str) -> np.ndarray:
        """Tell on which segments a quantity holds, by its key, bool `(segments,)`.

        One of a part holds on the part, one of the whole slope where no part has one of
        its own.
        """
        _, *part, name = key.split(".")
        if part:
            return self.places[".".join(part)]
        elsewhere = np.zeros(self.profile.segments, bool)
        for owner in self.owners.get(name, ()):
            elsewhere |= self.places[owner]
        return ~elsewhere


def lay_out(
    key: Key,
    profile: Profile,
    materials: tuple[str, ...] | None,
    parts: Mapping[str, GroundPart],
    fields: Mapping[str, RandomField],
    has_base: bool,
) -> GroundLayout:
    """Find where parts of the ground are, and cut the profile where they and the cells
    of fields begin and end.

    Args:
        key: of the table [ground].
        profile: as its file has it.
        materials: material of each segment, where the profile names them.
        parts: segments and materials, by key.
        fields: quantities that vary along the slope, by key.
        has_base: whether [ground] says anything for the rest of the slope.

    Raises InputError, naming the key, for parts that are nowhere, for materials that
    overlap, and for ground without any. Warns of ground without a material where
    [ground] holds.
    """
    if materials is not None:
        _check_names(key, materials, parts)
    ends = [end for part in parts.values() for end in part.ends or ()]
    owners: dict[str, list[str]] = {}
    _check_cells(key, profile, fields)
    for part in parts.values():
        for name in part.quantities:
            owners.setdefault(name, []).append(part.key)
    whole, piece = subdivide(profile, ends)
    layout = GroundLayout(whole, {}, owners)
    for part in parts.values():
        layout.places[part.key] = _segments_of(
            key[part.key], part, profile, layout.middles, piece, materials
        )
    _check_cover(key, layout, parts, has_base)
    # All cuts at once: cutting pieces again would undo the turns of the first cuts.
    cuts = np.concatenate([ends, *_boundaries(layout, fields)])
    final, _ = subdivide(profile, cuts)
    middles = 0.5 * (final.x[1:] + final.x[:-1])
    piece = np.searchsorted(whole.x, middles) - 1
    places = {key: found[piece] for key, found in layout.places.items()}
    return GroundLayout(final, places, owners)


def _segments_of(
    key: Key,
    part: GroundPart,
    given: Profile,
    middles: np.ndarray,
    piece: np.ndarray,
    materials: tuple[str, ...] | None,
) -> np.ndarray:
    """Find the segments of a part.

    Args:
        given: the profile before any cut.
        middles, piece: of each segment after the cuts, x of its middle [m], and the
            index of the segment that it is a piece of.
    """
    if part.segment is not None:
        if not 0 <= part.segment < given.segments:
            raise key.error(
                f"must be the number of a segment, from 1 to {given.segments}"
            )
        return piece == part.segment
    if materials is not None:
        if part.ends is not None:
            raise key.error(
                "has from_x_m and to_x_m, but the profile has a column material; leave "
                "one of them out"
            )
        found = np.array(materials)[piece] == part.name
    elif part.ends is None:
        raise key.error(
            "needs from_x_m and to_x_m, or a column material in the profile's CSV"
        )
    else:
        found = (middles > part.ends[0]) & (middles < part.ends[1])
    if not np.any(found):
        where = "no row of the profile names it"
        if part.ends is not None:
            where = f"the profile goes from x = {given.x[0]:g} to {given.x[-1]:g}"
        raise key.error(f"is nowhere on the slope: {where}")
    return found


def _check_names(
    key: Key, materials: Iterable[str], parts: Mapping[str, GroundPart]
) -> None:
    """Raise InputError for a material of the profile that the study does not define."""
    known = [part.name for part in parts.values() if part.segment is None]
    for name in materials:
        if name not in known:
            hint = f"; did you mean {nearest(name, known)!r}?" if known else ""
            raise key["materials"].error(
                f"must define the material {name!r} of the profile{hint}"
            )


def _check_cover(
    key: Key, layout: GroundLayout, parts: Mapping[str, GroundPart], has_base: bool
) -> None:
    """Raise InputError where materials overlap or leave ground without any; only warn
    of the latter where [ground] holds."""
    ours = [part for part in parts.values() if part.segment is None]
    if not ours:
        return
    times = np.sum([layout.places[part.key] for part in ours], axis=0)
    x = layout.profile.x
    if np.any(times > 1):
        i = int(np.argmax(times > 1))
        first, second, *_ = (p.name for p in ours if layout.places[p.key][i])
        raise key["materials"].error(
            f"overlap: {first} and {second} are both at x = {x[i]:.10g} to "
            f"{x[i + 1]:.10g} m"
        )
    if np.any(times == 0):
        gaps = _stretches(x, times == 0)
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


def _stretches(x: np.ndarray, chosen: np.ndarray) -> str:
    """Name the stretches that chosen segments make, as text."""
    steps = np.diff(np.concatenate([[0], chosen.astype(int), [0]]))
    ends = zip(np.flatnonzero(steps == 1), np.flatnonzero(steps == -1), strict=True)
    return ", ".join(f"{x[left]:.10g} to {x[right]:.10g} m" for left, right in ends)


def _check_cells(key: Key, profile: Profile, fields: Mapping[str, RandomField]) -> None:
    for name, field in fields.items():
        cells = (profile.x[-1] - profile.x[0]) / field.cell
        if cells > MOST_CELLS:
            raise Key(key.file)[name]["correlation_length_m"].error(
                f"cuts the profile into {cells:.3g} cells of {field.cell:g} m; at most "
                f"{MOST_CELLS} are computed, so a longer length is needed"
            )


def _boundaries(
    layout: GroundLayout, fields: Mapping[str, RandomField]
) -> list[np.ndarray]:
    """List the boundaries of the cells of each field where it holds, without those that
    lie next to another cut [m]."""
    found, points = [], layout.profile.x
    for key, field in fields.items():
        x = field.boundaries(points[0], points[-1])
        segment = np.searchsorted(layout.profile.x, x, side="right") - 1
        x = x[layout.where(key)[segment]]
        left = np.searchsorted(points, x, side="right") - 1
        apart = np.minimum(x - points[left], points[left + 1] - x)
        x = x[apart > LEAST_PIECE * field.cell]
        found.append(x)
        points = np.union1d(points, x)
    return found

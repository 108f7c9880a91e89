"""A run-out study from a TOML file."""

import dataclasses
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..block import Block
from ..columns import DEGREE, INPUT_COLUMNS, InputColumn
from ..errors import InputError
from ..soil import Soil
from ..toml_values import (
    allowed,
    load_toml,
    number,
    typed,
    unknown,
    whole,
)
from .clearance import lying_height
from .contact_laws import check_law, read_laws
from .ground import GROUND_COLUMNS, Ground
from .profile import (
    ROLLING_FRICTION_ANGLE,
    ROUGHNESS_COLUMN,
    Profile,
    read_profile,
)
from .quantities import Normal, Quantity, Uniform, combinations, draw, is_random
from .rebounds import Contacts
from .release import Release, check_release
from .trajectories import EVENT_LIMIT, TIME_LIMIT

TABLES = ("profile", "ground", "block", "release", "contacts")
NUMBERS = (
    *("title", "accuracy", "count", "seed", "collectors_m", "bins"),
    *("time_limit_s", "event_limit"),
)
BLOCK_COLUMNS = {n: c for n, c in INPUT_COLUMNS.items() if c.part == "block"}
RELEASE_KEYS = (
    *("x_m", "y_m", "clearance_m", "speed_mps", "direction_deg", "v_x_mps", "v_y_mps"),
    *("orientation_deg", "angular_velocity_degps"),
)
NOT_NEGATIVE = ("clearance_m", "speed_mps")
DEFAULT_COUNT = 1000
"""Where something is drawn at random."""
DEFAULT_BINS = 50
LARGEST_SEED = 2**63 - 1


class SlopeStudy(NamedTuple):
    """What the file says."""

    path: Path
    checksums: dict[str, str]
    """SHA-256 of the file, and of those that it names, by name."""
    title: str
    profile: Profile
    release: Release
    ground: Ground
    """As each block finds it."""
    ground_drawn: dict[str, np.ndarray]
    """What of it differs from block to block, `(blocks,)`, in the units of the names:
    quantities of the whole ground, and of segments as `segment_2_c_v`."""
    ground_told: dict
    """The ground as the file says it, ready for JSON."""
    contacts: Contacts
    law: dict
    """The contacts in words, ready for JSON."""
    law_name: str
    """In comparisons."""
    law_directory: str
    """For its files there."""
    seed: int
    collectors: np.ndarray
    """Places [m], increasing."""
    bins: int
    """Of the envelopes along the profile."""
    time_limit: float
    """[s]"""
    event_limit: int


def read_slope_study(path: Path, accuracy: str | None = None) -> SlopeStudy:
    """Read a study of blocks on a slope, with one law of contacts.

    `jaximpact runout --help` describes the file.

    Args:
        path: the file.
        accuracy: of the full model, in place of the file's.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    studies = read_slope_studies(path, accuracy)
    if len(studies) > 1:
        raise InputError(
            f"names {len(studies)} laws; read_slope_studies reads them",
            file=Path(path),
            key="contacts",
        )
    return studies[0]


def read_slope_studies(path: Path, accuracy: str | None = None) -> list[SlopeStudy]:
    """Read a study that may compare laws of contacts: one for each, with the same
    blocks, releases and ground. See `read_slope_study`."""
    path = Path(path)
    content = load_toml(path)
    for key in content:
        if key not in (*TABLES, *NUMBERS):
            unknown(path, key, key, (*TABLES, *NUMBERS))
    checksums = {path.name: hashlib.sha256(path.read_bytes()).hexdigest()}
    told_ground = _Ground.read(path, content)
    profile = _profile(path, content, told_ground, checksums)
    laws = read_laws(path, content, accuracy)
    seed = whole(path, content, "seed", 0, 0)
    if seed > LARGEST_SEED:
        raise InputError(
            f"must be at most {LARGEST_SEED}, but is {seed}", file=path, key="seed"
        )
    time_limit = number(path, "time_limit_s", content.get("time_limit_s", TIME_LIMIT))
    if time_limit <= 0.0:
        raise InputError(
            f"must be above 0 s, but is {time_limit:g}", file=path, key="time_limit_s"
        )
    varied = told_ground.varied()
    quantities = varied | _quantities(path, content)
    is_rough = np.any(profile.roughness > 0.0) or any(
        key.endswith(ROUGHNESS_COLUMN) for key in quantities
    )
    by_chance = is_random(quantities) or is_rough
    count = DEFAULT_COUNT if by_chance else combinations(quantities)
    drawn = draw(quantities, whole(path, content, "count", count, 1), seed)
    for name, values in drawn.items():
        _check_drawn(path, name, values)
    release = _release(path, drawn, profile)
    ground = told_ground.of_blocks(profile, drawn, seed)
    for law in laws:
        check_law(path, law, profile, release, ground)
    return [
        SlopeStudy(
            path=path,
            checksums=checksums | law.checksums,
            title=typed(path, content, "title", str, path.stem),
            profile=profile,
            release=release,
            ground=ground,
            ground_drawn={
                key.removeprefix("ground.").replace(".", "_"): drawn[key]
                for key in varied
            },
            ground_told=content.get("ground", {}),
            contacts=law.contacts,
            law=law.told,
            law_name=law.name,
            law_directory=law.directory,
            seed=seed,
            collectors=_collectors(path, content, profile),
            bins=whole(path, content, "bins", DEFAULT_BINS, 1),
            time_limit=time_limit,
            event_limit=whole(path, content, "event_limit", EVENT_LIMIT, 1),
        )
        for law in laws
    ]


class _Ground(NamedTuple):
    """The ground as the file says it, in the units of its names."""

    path: Path
    everywhere: dict[str, Quantity]
    segments: dict[int, dict[str, Quantity]]
    """By their numbers from 0."""

    @classmethod
    def read(cls, path: Path, content: dict) -> "_Ground":
        table = typed(path, content, "ground", dict, {})
        segments = {}
        for name, values in typed(path, table, "segment", dict, {}).items():
            key = f"ground.segment.{name}"
            if not name.isdecimal():
                raise InputError("must be the number of a segment", file=path, key=key)
            values = typed(path, table["segment"], name, dict)
            segments[int(name) - 1] = _ground_quantities(path, values, key)
        everywhere = {k: v for k, v in table.items() if k != "segment"}
        return cls(path, _ground_quantities(path, everywhere, "ground"), segments)

    def varied(self) -> dict[str, Quantity]:
        """What differs from block to block, by its key."""
        keys = {f"ground.{name}": q for name, q in self.everywhere.items()}
        for segment, quantities in self.segments.items():
            where = f"ground.segment.{segment + 1}"
            keys |= {f"{where}.{name}": q for name, q in quantities.items()}
        return {key: q for key, q in keys.items() if not isinstance(q, float)}

    def of_blocks(self, profile: Profile, drawn: Mapping, seed: int) -> Ground:
        """With what the blocks draw of it.

        Args:
            drawn: by the keys of `varied`.
        """
        ground = Ground.of_profile(profile, seed)
        soil = {f.name: getattr(ground.soil, f.name) for f in dataclasses.fields(Soil)}
        angles = {
            name: getattr(ground, name)
            for name in ("rolling_friction_angle", "roughness")
        }
        for key in self.varied():
            _, *where, name = key.split(".")
            column = GROUND_COLUMNS[name]
            fields = soil if column.part == "soil" else angles
            values = column.factor * drawn[key][:, None]
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
        return Ground(Soil(**soil), **angles, seed=seed)


def _ground_quantities(path: Path, values: dict, where: str) -> dict[str, Quantity]:
    for name in values:
        if name not in GROUND_COLUMNS:
            unknown(path, f"{where}.{name}", name, (*GROUND_COLUMNS, "segment"))
    return {
        name: _quantity(path, f"{where}.{name}", value, GROUND_COLUMNS[name])
        for name, value in values.items()
    }


def _profile(
    path: Path, content: dict, ground: _Ground, checksums: dict[str, str]
) -> Profile:
    """The profile, with what of the ground is alike for all blocks."""
    table = _table(path, content, "profile", ("points_m", "csv"))
    if len(table) != 1:
        raise InputError(
            "needs points_m or csv, and not both", file=path, key="profile"
        )
    soil, angles = _alike(ground.everywhere)
    angles.setdefault("rolling_friction_angle", ROLLING_FRICTION_ANGLE)
    if "csv" in table:
        csv = path.parent / typed(path, table, "csv", str)
        profile = read_profile(csv, Soil(**soil), **angles)
        checksums[csv.name] = hashlib.sha256(csv.read_bytes()).hexdigest()
        _check_said_once(ground, csv)
    else:
        points = typed(path, table, "points_m", list)
        try:
            x, y = np.array(points, float).reshape(len(points), 2).T
            profile = Profile(x, y, Soil(**soil), **angles)
        except (TypeError, ValueError) as error:
            told = str(error)
            if not told.startswith("a profile"):
                told = f"must be a list of [x, y], but is {points!r}"
            raise InputError(told, file=path, key="profile.points_m") from None
    return _with_segments(path, profile, ground.segments)


def _alike(quantities: dict[str, Quantity]) -> tuple[dict, dict]:
    """Fields of the soil, and angles of the ground, that are one number, in SI."""
    soil, angles = {}, {}
    for name, value in quantities.items():
        if isinstance(value, float):
            column = GROUND_COLUMNS[name]
            fields = soil if column.part == "soil" else angles
            fields[column.field] = column.factor * value
    return soil, angles


def _check_said_once(ground: _Ground, csv: Path) -> None:
    """A distribution must not be hidden by a column of the profile."""
    header = csv.read_bytes().decode("utf-8-sig").lstrip().splitlines()[0]
    columns = {name.strip() for name in header.split(",")}
    for name, quantity in ground.everywhere.items():
        if name in columns and not isinstance(quantity, float):
            raise InputError(
                f"differs from block to block, but {csv.name} has a column of it",
                file=ground.path,
                key=f"ground.{name}",
            )


def _with_segments(path: Path, profile: Profile, segments: dict) -> Profile:
    fields = {
        f.name: np.array(getattr(profile.soil, f.name))
        for f in dataclasses.fields(Soil)
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
        of_soil, of_angles = _alike(quantities)
        for values, given in ((fields, of_soil), (angles, of_angles)):
            for field, value in given.items():
                values[field][segment] = value
    return Profile(profile.x, profile.y, Soil(**fields), **angles)


def _collectors(path: Path, content: dict, profile: Profile) -> np.ndarray:
    key = "collectors_m"
    places = [number(path, key, x) for x in typed(path, content, key, list, [])]
    for x in places:
        if not profile.x[0] < x < profile.x[-1]:
            raise InputError(
                f"must lie between the ends of the profile, {profile.x[0]:g} and "
                f"{profile.x[-1]:g}, but holds {x:g}",
                file=path,
                key=key,
            )
    if len(set(places)) < len(places):
        raise InputError("holds a place twice", file=path, key=key)
    return np.array(sorted(places))


def _quantities(path: Path, content: dict) -> dict[str, Quantity]:
    """Quantities of blocks and releases."""
    quantities = {}
    for where, known in (("block", tuple(BLOCK_COLUMNS)), ("release", RELEASE_KEYS)):
        for name, value in _table(path, content, where, known).items():
            column = BLOCK_COLUMNS.get(name)
            quantities[name] = _quantity(path, f"{where}.{name}", value, column)
    _check_alternatives(path, quantities)
    return quantities


def _release(path: Path, drawn: dict[str, np.ndarray], profile: Profile) -> Release:
    count = len(next(iter(drawn.values())))

    def si(name: str, default: float = 0.0) -> np.ndarray:
        factor = DEGREE if "_deg" in name else 1.0
        return factor * drawn.get(name, np.full(count, default))

    fields = {
        c.field: c.factor * drawn[n] for n, c in BLOCK_COLUMNS.items() if n in drawn
    }
    fields.setdefault("mass", np.full(count, BLOCK_COLUMNS["mass_kg"].default))
    block = Block(**fields)
    x, orientation = si("x_m"), si("orientation_deg")
    speed, direction = si("speed_mps"), si("direction_deg")
    along, up = si("v_x_mps"), si("v_y_mps")
    try:
        high = Release(block, x, 0.0, orientation=orientation)
        y = si("y_m") if "y_m" in drawn else si("clearance_m")
        if "y_m" not in drawn:
            y = y + lying_height(profile, high.outline, x, orientation)
        release = Release(
            block,
            x,
            np.where(np.isfinite(y), y, 0.0),  # off the profile, which is told next
            along + speed * np.cos(direction),
            up + speed * np.sin(direction),
            orientation,
            si("angular_velocity_degps"),
        )
        check_release(release, profile)
    except ValueError as error:
        raise InputError(str(error), file=path, key="release") from None
    return release


def _check_alternatives(path: Path, quantities: dict[str, Quantity]) -> None:
    if "x_m" not in quantities:
        raise InputError("is needed", file=path, key="release.x_m")
    if ("y_m" in quantities) == ("clearance_m" in quantities):
        raise InputError("needs y_m or clearance_m, not both", file=path, key="release")
    polar = [n for n in ("speed_mps", "direction_deg") if n in quantities]
    plain = [n for n in ("v_x_mps", "v_y_mps") if n in quantities]
    if polar and plain:
        raise InputError(
            f"takes speed_mps and direction_deg, or v_x_mps and v_y_mps, but has "
            f"{polar[0]} and {plain[0]}",
            file=path,
            key="release",
        )


def _check_drawn(path: Path, name: str, values: np.ndarray) -> None:
    """Ranges that a distribution may leave."""
    of_ground = name.startswith("ground.")
    if of_ground or name in BLOCK_COLUMNS:
        column = (GROUND_COLUMNS if of_ground else BLOCK_COLUMNS)[name.split(".")[-1]]
        key = name if of_ground else f"block.{name}"
        needed, bad = column.requirement, ~column.is_allowed(values)
    else:
        key, needed = f"release.{name}", "at least 0"
        bad = (values < 0.0) & (name in NOT_NEGATIVE)
    if np.any(bad):
        i = int(np.argmax(bad))
        raise InputError(
            f"must be {needed}, but is {values[i]:g} for block {i}; least and most "
            "cut a normal distribution off",
            file=path,
            key=key,
        )


def _quantity(path: Path, key: str, value, column: InputColumn | None) -> Quantity:
    def one(value, key=key) -> float:
        if column is None:
            return number(path, key, value)
        return allowed(path, key, column, value)

    if isinstance(value, list):
        if not value:
            raise InputError("is an empty list", file=path, key=key)
        return tuple(one(v) for v in value)
    if not isinstance(value, dict):
        return one(value)
    kinds = (("mean", "sd", "least", "most"), ("from", "to"))
    for name in value:
        if name not in kinds[0] + kinds[1]:
            unknown(path, f"{key}.{name}", name, kinds[0] + kinds[1])
    if set(value) == set(kinds[1]):
        ends = [one(value[n], f"{key}.{n}") for n in kinds[1]]
        if not ends[0] < ends[1]:
            raise InputError(
                f"must go up, but goes from {ends[0]:g} to {ends[1]:g}",
                file=path,
                key=key,
            )
        return Uniform(*ends)
    if not {"mean", "sd"} <= set(value) <= set(kinds[0]):
        raise InputError(
            "must be a number, a list, { from, to } or { mean, sd }, the latter with "
            f"least and most if wanted, but is {value!r}",
            file=path,
            key=key,
        )
    given = {n: number(path, f"{key}.{n}", v) for n, v in value.items()}
    normal = Normal(**given)
    if normal.sd <= 0.0:
        raise InputError(
            f"must be above 0, but is {normal.sd:g}", file=path, key=f"{key}.sd"
        )
    if not normal.least < normal.most:
        raise InputError(
            f"needs least below most, but they are {normal.least:g} and "
            f"{normal.most:g}",
            file=path,
            key=key,
        )
    return normal


def _table(path: Path, content: dict, name: str, known: tuple[str, ...]) -> dict:
    """A table with known keys only."""
    table = typed(path, content, name, dict, {})
    for key in table:
        if key not in known:
            unknown(path, f"{name}.{key}", key, known)
    return table

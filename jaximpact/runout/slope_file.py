"""A run-out study from a TOML file."""

import dataclasses
import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..accuracy import DEFAULT_ACCURACY, PRESETS
from ..block import Block
from ..columns import DEGREE, INPUT_COLUMNS, InputColumn
from ..errors import InputError
from ..rebound import (
    BozzoloPamini,
    ConstantCoefficients,
    FrictionalEllipsoid,
    PfeifferBowen,
    RigidEllipsoid,
)
from ..soil import Soil
from ..toml_values import (
    SOIL_COLUMNS,
    allowed,
    choice,
    load_toml,
    number,
    soil_values,
    typed,
    unknown,
    whole,
)
from .clearance import lying_height
from .profile import ROLLING_COLUMN, ROLLING_FRICTION_ANGLE, Profile, read_profile
from .quantities import Normal, Quantity, Uniform, combinations, draw, is_random
from .rebounds import ClosedForm, Contacts, FullModel
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
GROUND_KEYS = (*SOIL_COLUMNS, ROLLING_COLUMN)
FULL_MODEL = "full model"
COEFFICIENT = (0.0, 1.0)
LAWS = {
    "constant coefficients": (
        ConstantCoefficients,
        {"e_n": COEFFICIENT, "e_t": COEFFICIENT},
    ),
    "Pfeiffer and Bowen": (
        PfeifferBowen,
        {"normal_coefficient": (1e-6, 1.0), "tangential_coefficient": COEFFICIENT},
    ),
    "rigid ellipsoid": (RigidEllipsoid, {"e_contact": COEFFICIENT}),
    "frictional ellipsoid": (
        FrictionalEllipsoid,
        {"e_contact": COEFFICIENT, "friction_coefficient": (0.0, 100.0)},
    ),
    "Bozzolo and Pamini": (BozzoloPamini, {}),
}
DEFAULT_COUNT = 1000
"""Where something is drawn at random."""
DEFAULT_BINS = 50
LARGEST_SEED = 2**63 - 1


class SlopeStudy(NamedTuple):
    """What the file says."""

    path: Path
    checksums: dict[str, str]
    """SHA-256 of the file, and of the profile's if it has one of its own, by name."""
    title: str
    profile: Profile
    release: Release
    contacts: Contacts
    law: dict
    """The contacts in words, ready for JSON."""
    seed: int
    collectors: np.ndarray
    """Places [m], increasing."""
    bins: int
    """Of the envelopes along the profile."""
    time_limit: float
    """[s]"""
    event_limit: int


def read_slope_study(path: Path, accuracy: str | None = None) -> SlopeStudy:
    """Read a study of blocks on a slope.

    `jaximpact runout --help` describes the file.

    Args:
        path: the file.
        accuracy: of the full model, in place of the file's.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    content = load_toml(path)
    for key in content:
        if key not in (*TABLES, *NUMBERS):
            unknown(path, key, key, (*TABLES, *NUMBERS))
    checksums = {path.name: hashlib.sha256(path.read_bytes()).hexdigest()}
    profile = _profile(path, content, checksums)
    contacts, law = _contacts(path, content, accuracy)
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
    return SlopeStudy(
        path=path,
        checksums=checksums,
        title=typed(path, content, "title", str, path.stem),
        profile=profile,
        release=_release(path, content, profile, seed),
        contacts=contacts,
        law=law,
        seed=seed,
        collectors=_collectors(path, content, profile),
        bins=whole(path, content, "bins", DEFAULT_BINS, 1),
        time_limit=time_limit,
        event_limit=whole(path, content, "event_limit", EVENT_LIMIT, 1),
    )


def _profile(path: Path, content: dict, checksums: dict[str, str]) -> Profile:
    table = _table(path, content, "profile", ("points_m", "csv"))
    if len(table) != 1:
        raise InputError(
            "needs points_m or csv, and not both", file=path, key="profile"
        )
    ground = typed(path, content, "ground", dict, {})
    segments = typed(path, ground, "segment", dict, {})
    soil, rolling = _ground(
        path, {k: v for k, v in ground.items() if k != "segment"}, "ground"
    )
    whole_soil = Soil(**soil)
    rolling = ROLLING_FRICTION_ANGLE if rolling is None else rolling
    if "csv" in table:
        csv = path.parent / typed(path, table, "csv", str)
        profile = read_profile(csv, whole_soil, rolling)
        checksums[csv.name] = hashlib.sha256(csv.read_bytes()).hexdigest()
    else:
        points = typed(path, table, "points_m", list)
        try:
            x, y = np.array(points, float).reshape(len(points), 2).T
            profile = Profile(x, y, whole_soil, rolling)
        except (TypeError, ValueError) as error:
            told = str(error)
            if not told.startswith("a profile"):
                told = f"must be a list of [x, y], but is {points!r}"
            raise InputError(told, file=path, key="profile.points_m") from None
    return _with_segments(path, profile, segments)


def _with_segments(path: Path, profile: Profile, segments: dict) -> Profile:
    fields = {
        f.name: np.array(getattr(profile.soil, f.name))
        for f in dataclasses.fields(Soil)
    }
    angles = profile.rolling_friction_angle.copy()
    for name in segments:
        key = f"ground.segment.{name}"
        if not (name.isdecimal() and 1 <= int(name) <= profile.segments):
            raise InputError(
                f"must be the number of a segment, from 1 to {profile.segments}",
                file=path,
                key=key,
            )
        soil, rolling = _ground(path, typed(path, segments, name, dict), key)
        for field, value in soil.items():
            fields[field][int(name) - 1] = value
        if rolling is not None:
            angles[int(name) - 1] = rolling
    return Profile(profile.x, profile.y, Soil(**fields), angles)


def _ground(path: Path, values: dict, where: str) -> tuple[dict, float | None]:
    """Fields of the soil, and the angle of rolling friction if it is given, in SI."""
    for name in values:
        if name not in GROUND_KEYS:
            unknown(path, f"{where}.{name}", name, (*GROUND_KEYS, "segment"))
    rolling = None
    if ROLLING_COLUMN in values:
        key = f"{where}.{ROLLING_COLUMN}"
        rolling = number(path, key, values[ROLLING_COLUMN])
        if not 0.0 <= rolling < 90.0:
            raise InputError(
                f"must be in [0, 90) deg, but is {rolling:g}", file=path, key=key
            )
        rolling *= DEGREE
    soil = soil_values(
        path, {n: v for n, v in values.items() if n != ROLLING_COLUMN}, where
    )
    return {
        SOIL_COLUMNS[n].field: SOIL_COLUMNS[n].factor * v for n, v in soil.items()
    }, rolling


def _contacts(path: Path, content: dict, accuracy: str | None) -> tuple[Contacts, dict]:
    table = typed(path, content, "contacts", dict, {"law": FULL_MODEL})
    law = choice(path, table, "law", FULL_MODEL, (FULL_MODEL, *LAWS))
    if law == FULL_MODEL:
        _table(path, {"contacts": table}, "contacts", ("law",))
        accuracy = accuracy or choice(
            path, content, "accuracy", DEFAULT_ACCURACY, tuple(PRESETS)
        )
        return FullModel(accuracy), {"law": law, "accuracy": accuracy}
    if accuracy is not None or "accuracy" in content:
        raise InputError(
            f"accuracy is of the full model; the law {law} takes none",
            file=path,
            key="contacts.law",
        )
    kind, coefficients = LAWS[law]
    _table(path, {"contacts": table}, "contacts", ("law", *coefficients))
    values = {}
    for name, (least, most) in coefficients.items():
        key = f"contacts.{name}"
        if name not in table:
            raise InputError(f"is needed by the law {law}", file=path, key=key)
        values[name] = number(path, key, table[name])
        if not least <= values[name] <= most:
            raise InputError(
                f"must be in [{least:g}, {most:g}], but is {values[name]:g}",
                file=path,
                key=key,
            )
    return ClosedForm(kind(**values)), {"law": law} | values


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


def _release(path: Path, content: dict, profile: Profile, seed: int) -> Release:
    quantities = {}
    for where, known in (("block", tuple(BLOCK_COLUMNS)), ("release", RELEASE_KEYS)):
        for name, value in _table(path, content, where, known).items():
            column = BLOCK_COLUMNS.get(name)
            quantities[name] = _quantity(path, f"{where}.{name}", value, column)
    _check_alternatives(path, quantities)
    count = DEFAULT_COUNT if is_random(quantities) else combinations(quantities)
    count = whole(path, content, "count", count, 1)
    drawn = draw(quantities, count, seed)
    for name, values in drawn.items():
        _check_drawn(path, name, values)

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
    if name in BLOCK_COLUMNS:
        where, needed = "block", BLOCK_COLUMNS[name].requirement
        bad = ~BLOCK_COLUMNS[name].is_allowed(values)
    else:
        where, needed = "release", "at least 0"
        bad = (values < 0.0) & (name in NOT_NEGATIVE)
    if np.any(bad):
        i = int(np.argmax(bad))
        raise InputError(
            f"must be {needed}, but is {values[i]:g} for block {i}; least and most "
            "cut a normal distribution off",
            file=path,
            key=f"{where}.{name}",
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

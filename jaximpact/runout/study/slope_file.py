"""Run-out study from a TOML file."""

import dataclasses
import hashlib
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np

from ...errors import InputError, located
from ...identity import part_names
from ...io.checks import NUMBERS_PER_IMPACT, check_memory
from ...io.files import read_input
from ...io.toml import (
    check_keys,
    known_table,
    number,
    parse_toml,
    typed,
    whole,
    with_named_parts,
)
from ...quantities import INPUT_COLUMNS, InputColumn, columns_of_part
from ...scene import Block
from ...scene_quantities import SHAPE, part_named, replaced_parts
from ...shapes import AbstractShape, shape_of_each
from ...units import DEGREE
from ..blocks import Release
from ..contacts.contact_models import Contacts
from ..flight.placement import check_release, lying_height
from ..random_inputs import Quantity, combinations, draw, is_random
from ..scheduler import EVENT_LIMIT, TIME_LIMIT
from ..terrain import (
    ANGLE_COLUMNS,
    ROUGHNESS_COLUMN,
    Ground,
    Profile,
    ground_columns,
)
from .contact_laws import check_law, read_laws
from .ground_file import GroundInput, read_ground_profile
from .quantity import read_quantity

TABLES = ("profile", "ground", "block", "release", "contacts")
NUMBERS = (
    *("title", "accuracy", "count", "seed", "collectors_m", "bins"),
    *("time_limit_s", "event_limit"),
)
RELEASE_COLUMNS = {
    name: INPUT_COLUMNS[name] for name in ("orientation_deg", "angular_velocity_degps")
}
RELEASE_KEYS = (
    *("x_m", "y_m", "clearance_m", "speed_mps", "direction_deg", "v_x_mps", "v_y_mps"),
    *("orientation_deg", "angular_velocity_degps"),
)
NOT_NEGATIVE = ("clearance_m", "speed_mps")
DEFAULT_COUNT = 1000
"""Default number of blocks where something is random."""
DEFAULT_BINS = 50


class SlopeStudy(NamedTuple):
    """Run-out study of one contact law."""

    path: Path
    """The study's file."""
    checksums: dict[str, str]
    """SHA-256 of the file, and of those that it names, by name."""
    inputs: list[Path]
    """Paths of these files."""
    title: str
    profile: Profile
    release: Release
    ground: Ground
    """Ground as each block finds it."""
    ground_samples: dict[str, np.ndarray]
    """Quantities of the ground that differ from block to block, `(blocks,)`, in the
    units of the names: those of a segment as `segment_2_c_v`."""
    ground_told: dict
    """Ground as the file says it, with the angles that have their defaults, ready for
    JSON."""
    laws: dict[str, str]
    """Laws of the soil and shapes of the blocks, with digests of those that are not the
    package's; see `identity.part_names`."""
    contacts: Contacts
    """Contact model."""
    law: dict
    """Description of the contact law, ready for JSON."""
    law_name: str
    """Name of the contact law in comparisons."""
    law_directory: str
    """Directory of the contact law's files in a comparison."""
    seed: int
    """Seed of all random inputs."""
    collectors: np.ndarray
    """Places of the collectors [m], increasing, `(collectors,)`."""
    bins: int
    """Number of bins of the envelopes along the profile."""
    time_limit: float
    """Longest trajectory [s]."""
    event_limit: int
    """Most contacts and legs of a trajectory."""


def read_slope_study(path: Path, accuracy: str | None = None) -> SlopeStudy:
    """Read a study of blocks on a slope, with one law of contacts.

    `jaximpact runout --help` describes the file.

    Args:
        path: the file.
        accuracy: accuracy of the full model, in place of the file's.

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
    """Read a study that may compare contact laws.

    There is one study for each law, with the same blocks, releases and ground. See
    `read_slope_study`.
    """
    path = Path(path)
    data = read_input(path)
    content = parse_toml(path, data)
    check_keys(path, "", content, (*TABLES, *NUMBERS))
    checksums = {path: hashlib.sha256(data).hexdigest()}
    ground_input = GroundInput.read(path, content)
    profile = read_ground_profile(path, content, ground_input, checksums)
    laws = read_laws(path, content, accuracy)
    seed = whole(path, content, "seed", 0, 0)
    time_limit = number(path, "time_limit_s", content.get("time_limit_s", TIME_LIMIT))
    if time_limit <= 0.0:
        raise InputError(
            f"must be above 0 s, but is {time_limit:g}", file=path, key="time_limit_s"
        )
    blocks = _blocks(path, content)
    quantities = ground_input.varied() | _quantities(path, content, blocks)
    jointly = ground_input.sampled_jointly()
    count = _count(path, content, quantities, profile, bool(jointly))
    bins = whole(path, content, "bins", DEFAULT_BINS, 1)
    check_memory(
        count * (bins + NUMBERS_PER_IMPACT),
        f"{count} blocks in {bins} bins of the envelopes",
        file=path,
        key="count",
    )
    samples = draw(quantities, count, seed)
    samples |= ground_input.sample_jointly(samples, count, seed)
    columns = {"ground": ground_columns(profile.soil), "block": blocks.columns}
    for name, values in samples.items():
        _check_sample(path, name, values, columns)
    release = _release(path, samples, profile, blocks)
    ground = ground_input.of_blocks(profile, samples, seed)
    for law in laws:
        check_law(path, law, profile, release, ground)
    inputs = [*checksums, *(file for law in laws for file in law.checksums)]
    return [
        SlopeStudy(
            path=path,
            checksums={f.name: c for f, c in (checksums | law.checksums).items()},
            inputs=inputs,
            title=typed(path, content, "title", str, path.stem),
            profile=profile,
            release=release,
            ground=ground,
            ground_samples={
                key.removeprefix("ground.").replace(".", "_"): samples[key]
                for key in (*jointly, *ground_input.varied())
            },
            ground_told=_default_angles(profile) | content.get("ground", {}),
            laws=part_names(ground.soil, release.block),
            contacts=law.contacts,
            law=law.told,
            law_name=law.name,
            law_directory=law.directory,
            seed=seed,
            collectors=_collectors(path, content, profile),
            bins=bins,
            time_limit=time_limit,
            event_limit=whole(path, content, "event_limit", EVENT_LIMIT, 1),
        )
        for law in laws
    ]


def _count(
    path: Path,
    content: dict,
    quantities: dict[str, Quantity],
    profile: Profile,
    jointly: bool,
) -> int:
    """Read the number of blocks; without one, take all combinations of lists, or the
    default number where something is random."""
    is_rough = np.any(profile.roughness > 0.0) or any(
        key.endswith(ROUGHNESS_COLUMN) for key in quantities
    )
    by_chance = is_random(quantities) or is_rough or jointly
    count = DEFAULT_COUNT if by_chance else combinations(quantities)
    return whole(path, content, "count", count, 1)


def _default_angles(profile: Profile) -> dict[str, float]:
    """List the angles of the ground that have their defaults on every segment."""
    return {
        name: column.default
        for name, column in ANGLE_COLUMNS.items()
        if np.all(getattr(profile, column.field) == column.factor * column.default)
    }


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


class _Blocks(NamedTuple):
    """Shapes of the blocks."""

    kinds: tuple[type[AbstractShape], ...]
    base: Block
    """Block with a shape of each kind, all else being the default."""

    @property
    def columns(self) -> dict[str, InputColumn]:
        return columns_of_part("block", self.base)

    def of(self, index: np.ndarray) -> Block:
        """Make blocks of some of the kinds, by their index."""
        if len(self.kinds) == 1:
            return self.base
        shapes = shape_of_each([self.kinds[int(i)] for i in index])
        return cast(Block, replaced_parts(self.base, {SHAPE: shapes}))


def _blocks(path: Path, content: dict) -> _Blocks:
    """Read the shapes that the file names: one, or a list."""
    table = typed(path, content, "block", dict, {})
    key = f"block.{SHAPE}"
    names = table.get(SHAPE)
    if not isinstance(names, list):
        base = cast(Block, with_named_parts(path, "block", table, Block()))
        return _Blocks((type(base.shape),), base)
    if not names or not all(isinstance(name, str) for name in names):
        raise InputError(
            f"must be a name or a list of names, but is {names!r}", file=path, key=key
        )
    with located(path, key):
        shapes = [part_named(SHAPE, name, path.parent) for name in names]
        kinds = [type(cast(AbstractShape, shape)) for shape in shapes]
        one_of_each = {SHAPE: shape_of_each(kinds)}
        base = cast(Block, replaced_parts(Block(), one_of_each))
    if len(set(kinds)) < len(kinds):
        raise InputError("holds a shape twice", file=path, key=key)
    return _Blocks(tuple(kinds), base)


def _quantities(path: Path, content: dict, blocks: _Blocks) -> dict[str, Quantity]:
    """Read quantities of blocks and releases; a list of shapes as their indices."""
    quantities, of_block = {}, blocks.columns
    for where, known in (
        ("block", (*of_block, SHAPE)),
        ("release", RELEASE_KEYS),
    ):
        for name, value in known_table(path, content, where, known).items():
            if name == SHAPE:
                if isinstance(value, list):
                    quantities[name] = tuple(map(float, range(len(value))))
                continue
            column = (of_block | RELEASE_COLUMNS).get(name)
            quantities[name] = read_quantity(path, f"{where}.{name}", value, column)
    _check_alternatives(path, quantities)
    return quantities


def _release(
    path: Path, samples: dict[str, np.ndarray], profile: Profile, blocks: _Blocks
) -> Release:
    count = len(next(iter(samples.values())))

    def si(name: str, default: float = 0.0) -> np.ndarray:
        factor = DEGREE if "_deg" in name else 1.0
        return factor * samples.get(name, np.full(count, default))

    base = blocks.of(samples.get(SHAPE, np.zeros(count)))
    fields = {
        c.field: c.factor * samples[n]
        for n, c in blocks.columns.items()
        if n in samples
    }
    fields.setdefault("mass", np.full(count, float(base.mass)))
    block = dataclasses.replace(base, **fields)
    x, orientation = si("x_m"), si("orientation_deg")
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
    cartesian = [n for n in ("v_x_mps", "v_y_mps") if n in quantities]
    if polar and cartesian:
        raise InputError(
            f"takes speed_mps and direction_deg, or v_x_mps and v_y_mps, but has "
            f"{polar[0]} and {cartesian[0]}",
            file=path,
            key="release",
        )


def _check_sample(
    path: Path, name: str, values: np.ndarray, columns: dict[str, dict]
) -> None:
    """Raise InputError for a sample of a distribution that is out of range."""
    where = "ground" if name.startswith("ground.") else "block"
    column = columns[where].get(name.split(".")[-1])
    if column is not None:
        key = name if where == "ground" else f"block.{name}"
        needed, bad = column.requirement, ~column.is_allowed(values)
    else:
        key, needed = f"release.{name}", "at least 0"
        bad = (values < 0.0) & (name in NOT_NEGATIVE)
    if np.any(bad):
        i = int(np.argmax(bad))
        raise InputError(
            f"must be {needed}, but is {values[i]:g} for block {i}; least and most "
            "truncate a distribution",
            file=path,
            key=key,
        )

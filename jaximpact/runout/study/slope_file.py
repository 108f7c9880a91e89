"""Run-out study from a TOML file."""

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..._settings import numpy_settings
from ...identity import part_names
from ...io.checks import NUMBERS_PER_IMPACT, check_memory
from ...io.files import by_name, read_input
from ...io.toml import Key, check_keys, number, parse_toml, typed, whole
from ..blocks import Release
from ..random_inputs import Quantity, combinations, draw, is_random
from ..smoothing import Smoothing
from ..state import EVENT_LIMIT, HOP_THRESHOLD, TIME_LIMIT, Limits
from ..terrain import (
    ANGLE_COLUMNS,
    ROUGHNESS_COLUMN,
    Ground,
    Profile,
    check_inside,
    ground_columns,
)
from .barriers import Barrier, read_barriers
from .block_file import (
    NOT_NEGATIVE,
    VOLUME,
    VOLUME_COLUMN,
    BlockInput,
    make_release,
    read_blocks,
    read_release,
)
from .contact_laws import NamedLaw, check_law, read_laws
from .ground_file import GroundInput, GroundLayout
from .profile_file import MapPlacement, read_ground_profile, read_map_placement

TABLES = (
    *("profile", "ground", "block", "release", "contacts", "barriers"),
    *("fit", "observed"),
)
"""Tables of a study; `fit` and `observed` are for back-analyses, and passed over by
run-outs."""
NUMBERS = (
    *("title", "accuracy", "count", "seed", "collectors_m", "bins"),
    *("time_limit_s", "event_limit", "hop_threshold", "export_trajectories"),
)
DEFAULT_COUNT = 1000
"""Default number of blocks where something is random."""
DEFAULT_BINS = 50
DEFAULT_EXPORT = 50
"""Default number of trajectories in files."""


class StudySettings(NamedTuple):
    """What a study counts, and for how long."""

    collectors: np.ndarray
    """Places of the collectors [m], increasing, `(collectors,)`."""
    bins: int = DEFAULT_BINS
    """Number of bins of the envelopes along the profile."""
    limits: Limits = Limits()
    barriers: tuple[Barrier, ...] = ()
    """Barriers, by which blocks are counted."""
    export_trajectories: int = DEFAULT_EXPORT
    """Number of trajectories in files: the first ones."""


class StudyInputs(NamedTuple):
    """Inputs of a study as its file says them."""

    path: Path
    """The study's file."""
    checksums: dict[Path, str]
    """SHA-256 of the file, and of those that it names."""
    title: str
    seed: int
    """Seed of all random inputs."""
    ground_table: dict
    """Ground as the file says it, with the angles that have their defaults, ready for
    JSON."""
    ground_samples: dict[str, np.ndarray]
    """Quantities of the ground that differ from block to block, `(blocks,)`, in the
    units of the names, by their keys under [ground]: of a segment `segment.2.c_v`."""
    random_ground: dict[str, np.ndarray]
    """Quantities of the ground that differ from block to block, by name: whether they
    do on each segment, `(segments,)`."""
    materials: tuple[str, ...]
    """Material of each segment, "" for none."""
    placement: MapPlacement | None = None
    """Place of the profile on the map."""
    smoothing: Smoothing | None = None
    """What a smoothing did to the profile."""

    @property
    def files(self) -> list[Path]:
        """Paths of the files."""
        return [*self.checksums]

    @property
    def checksums_by_name(self) -> dict[str, str]:
        """SHA-256 of the files by their names."""
        return by_name(self.checksums)


class SlopeStudy(NamedTuple):
    """Run-out study of one contact law."""

    profile: Profile
    release: Release
    ground: Ground
    """Ground as each block finds it."""
    law: NamedLaw
    """Contact law."""
    settings: StudySettings
    inputs: StudyInputs

    @property
    def laws(self) -> dict[str, str]:
        """Laws of the soil and shapes of the blocks, with digests of those that are not
        the package's; see `identity.part_names`."""
        return part_names(self.ground.soil, self.release.block)


class SlopeInput(NamedTuple):
    """Study as its file says it, before any block is sampled."""

    top: Key  # of the file
    checksums: dict[Path, str]  # SHA-256 of the files that the study names
    ground: GroundInput
    layout: GroundLayout
    blocks: BlockInput
    start: dict[str, Quantity]  # quantities of the releases
    laws: list[NamedLaw]
    limits: Limits
    seed: int

    @property
    def quantities(self) -> dict[str, Quantity]:
        """Quantities that are sampled by themselves, by key."""
        return self.ground.varied() | self.blocks.quantities | self.start

    def sample(
        self, count: int, seed: int, fixed: Mapping[str, np.ndarray] | None = None
    ) -> tuple[dict[str, np.ndarray], Release, Ground]:
        """Sample blocks with their releases and their ground.

        Quantities that are not sampled have `fixed` values, `(count,)` by key.

        Returns:
            Samples by key, blocks at release, and the ground as each block finds it.

        Raises InputError, naming file and key, for samples out of range.
        """
        profile, fixed = self.layout.profile, fixed or {}
        rest = {k: q for k, q in self.quantities.items() if k not in fixed}
        samples = draw(rest, count, seed) | dict(fixed)
        samples |= self.ground.sample_jointly(samples, count, seed)
        check_memory(
            count * profile.segments * len(self.ground.fields()),
            f"{count} blocks with ground of {profile.segments} cells each",
            **self.top["ground"].place,
        )
        samples |= self.ground.sample_fields(self.layout, count, seed)
        columns = ground_columns(profile.soil), self.blocks.columns
        for name, values in samples.items():
            _check_sample(self.top, name, values, *columns)
        release = make_release(self.top, samples, profile, self.blocks)
        ground = self.ground.of_blocks(self.layout, samples, seed)
        for law in self.laws:
            check_law(self.top, law, profile, release, ground)
        return samples, release, ground


def read_slope_input(
    top: Key, content: dict, accuracy: str | None = None
) -> SlopeInput:
    """Read what a study, with this content, says of ground, blocks, releases and laws;
    the accuracy of the full model stands in place of the file's.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    check_keys(top, content, (*TABLES, *NUMBERS))
    checksums: dict[Path, str] = {}
    ground = GroundInput.read(top, content)
    layout = read_ground_profile(top, content, ground, checksums)
    time = content.get("time_limit_s", TIME_LIMIT)
    hop_threshold = content.get("hop_threshold", HOP_THRESHOLD)
    return SlopeInput(
        top=top,
        checksums=checksums,
        ground=ground,
        layout=layout,
        laws=read_laws(top, content, accuracy),
        seed=whole(top, content, "seed", 0, 0),
        limits=Limits(
            number(top["time_limit_s"], time, above=0.0, unit="s"),
            whole(top, content, "event_limit", EVENT_LIMIT, 1),
            number(top["hop_threshold"], hop_threshold, least=0.0),
        ),
        blocks=read_blocks(top, content),
        start=read_release(top, content, layout.profile),
    )


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
        raise Key(Path(path))["contacts"].error(
            f"names {len(studies)} laws; read_slope_studies reads them"
        )
    return studies[0]


@numpy_settings()
def read_slope_studies(path: Path, accuracy: str | None = None) -> list[SlopeStudy]:
    """Read a study that may compare contact laws.

    There is one study for each law, with the same blocks, releases and ground. See
    `read_slope_study`.
    """
    path = Path(path)
    top, data = Key(path), read_input(path)
    content = parse_toml(path, data)
    slope = read_slope_input(top, content, accuracy)
    ground, profile = slope.ground, slope.layout.profile
    jointly, fields = ground.sampled_jointly(), ground.fields()
    count = _count(top, content, slope, by_chance=bool(jointly or fields))
    # More bins than a drawing shows are columns of every block.
    bins = whole(top, content, "bins", DEFAULT_BINS, 1, 10_000)
    check_memory(
        count * (bins + NUMBERS_PER_IMPACT),
        f"{count} blocks in {bins} bins of the envelopes",
        **top["count"].place,
    )
    samples, release, ground_of_blocks = slope.sample(count, slope.seed)
    exported = whole(top, content, "export_trajectories", DEFAULT_EXPORT, 1)
    settings = StudySettings(
        collectors=_collectors(top, content, profile),
        bins=bins,
        limits=slope.limits,
        barriers=read_barriers(top, content, profile),
        export_trajectories=exported,
    )
    varied = *jointly, *ground.varied()
    _check_variables(top, varied)
    inputs = StudyInputs(
        path=path,
        checksums={path: hashlib.sha256(data).hexdigest()} | slope.checksums,
        title=typed(top, content, "title", str, path.stem),
        seed=slope.seed,
        ground_table=_default_angles(profile) | content.get("ground", {}),
        ground_samples={key.removeprefix("ground."): samples[key] for key in varied},
        random_ground=_random_ground(slope.layout, (*varied, *fields)),
        materials=slope.layout.materials,
        placement=read_map_placement(top, content, profile),
        smoothing=slope.layout.smoothing,
    )
    return [
        SlopeStudy(
            profile=profile,
            release=release,
            ground=ground_of_blocks,
            law=law,
            settings=settings,
            inputs=inputs._replace(checksums=inputs.checksums | law.checksums),
        )
        for law in slope.laws
    ]


def _count(top: Key, content: dict, slope: SlopeInput, by_chance: bool) -> int:
    """Read the number of blocks; without one, take all combinations of lists, or the
    default number where something is random."""
    quantities = slope.quantities
    by_chance |= bool(np.any(slope.layout.profile.roughness > 0.0))
    by_chance |= any(key.endswith(ROUGHNESS_COLUMN) for key in quantities)
    by_chance |= is_random(quantities)
    count = DEFAULT_COUNT if by_chance else combinations(quantities)
    return whole(top, content, "count", count, 1)


def variable_of_ground(key: str) -> str:
    """Name the variable of a dataset for a quantity of the ground by its key."""
    return key.replace(".", "_")


def _check_variables(top: Key, keys: Iterable[str]) -> None:
    """Raise InputError for two quantities of the ground that one variable would have to
    hold, as names of materials may have underscores."""
    known: dict[str, str] = {}
    for key in keys:
        other = known.setdefault(variable_of_ground(key), key)
        if other != key:
            raise top[key].error(
                f"and {other} would both be {variable_of_ground(key)} in the results; "
                "rename one of the materials"
            )


def _random_ground(layout: GroundLayout, keys: Iterable[str]) -> dict[str, np.ndarray]:
    """Tell by name on which segments quantities of the ground differ from block to
    block, of which there may be several of a name."""
    where: dict[str, np.ndarray] = {}
    for key in keys:
        name = key.split(".")[-1]
        where[name] = layout.where(key) | where.get(name, False)
    return where


def _default_angles(profile: Profile) -> dict[str, float]:
    """List the angles of the ground that have their defaults on every segment."""
    return {
        name: column.default
        for name, column in ANGLE_COLUMNS.items()
        if np.all(getattr(profile, column.field) == column.factor * column.default)
    }


def _collectors(top: Key, content: dict, profile: Profile) -> np.ndarray:
    key = top["collectors_m"]
    places = [number(key, x) for x in typed(top, content, "collectors_m", list, [])]
    # Each is rows of every table.
    if len(places) > 100:
        raise key.error(
            f"holds {len(places)} places, but tables list at most 100; bins gives "
            "energies, speeds and heights all along the slope"
        )
    for x in places:
        check_inside(profile, x, "holds", **key.place)
    if len(set(places)) < len(places):
        raise key.error("holds a place twice")
    return np.array(sorted(places))


def _check_sample(
    top: Key, name: str, values: np.ndarray, of_ground: dict, of_block: dict
) -> None:
    """Raise InputError for samples of a distribution, `(blocks, ...)`, that are out of
    range."""
    if name.startswith("ground."):
        key, column = name, of_ground.get(name.split(".")[-1])
    else:
        column = VOLUME_COLUMN if name == VOLUME else of_block.get(name)
        key = f"block.{name}" if column else f"release.{name}"
    if column is not None:
        needed, bad = column.requirement, ~column.is_allowed(values)
    else:
        needed, bad = "at least 0", (values < 0.0) & (name in NOT_NEGATIVE)
    if np.any(bad):
        place = np.unravel_index(np.argmax(bad), bad.shape)
        raise top[key].error(
            f"must be {needed}, but is {values[place]:g} for block {place[0]}; least "
            "and most truncate a distribution"
        )

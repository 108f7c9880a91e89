"""Observations on a slope, from the table [observed] of a study and the files that it
names."""

import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ...io.checks import warn_unusual
from ...io.scene_table import reads_as_number
from ...io.toml import Key, check_keys, known_table, number, of_kind, typed, whole
from ...reports.tables import at_x
from ..coordinates import FASTEST, HIGHEST_CLIFF, LARGEST_ENERGY
from ..profile_formats import cell_error, records_of_file
from ..terrain import Profile, check_inside

KEYS = ("blocks", "stops", "passages", "counts", "held_out_m", "sigma")
COUNT_KEYS = ("x_m", "passed", "of")
STOP_COLUMN, COLLECTOR_COLUMN = "x_m", "collector_m"
PASSAGE_COLUMNS = ("speed_mps", "height_m", "energy_kJ")
"""Speed, height of the centre above the ground, and kinetic energy of translation and
rotation, at the first passage."""
USUAL = {
    "speed_mps": FASTEST,
    "height_m": HIGHEST_CLIFF,  # no block flies higher
    "energy_kJ": 1e-3 * LARGEST_ENERGY,
}
"""Values of these that hardly any block has: a unit may be mistaken."""
PER_PLACE = len(PASSAGE_COLUMNS) + 1
"""Number of quantities at a place of simulated data sets: of what can be observed, then
the height of the lowest point, which tells what barriers do."""
MOST_BLOCKS = 400
"""Number of blocks of a data set from which on a random part of them is used."""


class ObservedValues(NamedTuple):
    """Values of one quantity: places where blocks stopped, or passages of a
    collector."""

    quantity: str  # name with unit: `STOP_COLUMN`, or one of `PASSAGE_COLUMNS`
    place: float | None  # x of the collector [m]; None for stopping points
    values: np.ndarray
    """Values in that unit, one for each block that stopped or passed, `(blocks,)`."""
    held_out: bool = False  # true for values that are predicted, and not fitted

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return len(self.values)

    @property
    def words(self) -> str:
        """Name in reports."""
        if self.place is None:
            return f"{self.quantity} of stopping points"
        return f"{self.quantity} at {at_x(self.place)}"


class ObservedCount(NamedTuple):
    """Number of blocks that pass a line."""

    place: float  # x of the line [m]
    passed: int
    blocks: int  # number of blocks released

    @property
    def words(self) -> str:
        """Name in reports."""
        return f"share past {at_x(self.place)}"


Channel = ObservedValues | ObservedCount


def is_held_out(channel: Channel) -> bool:
    """Tell whether a channel is predicted and not fitted."""
    return isinstance(channel, ObservedValues) and channel.held_out


class Observations(NamedTuple):
    """All that was observed on a slope."""

    channels: tuple[Channel, ...]
    sigma: dict[str, float]
    """Standard deviations of the errors of measurement, by column."""
    released: int  # number of blocks that a data set begins with
    inputs: tuple[Path, ...]  # files that were read
    remarks: tuple[str, ...]  # remarks on what was not used as it stands

    @property
    def fitted(self) -> tuple[Channel, ...]:
        """Channels that are fitted."""
        return tuple(c for c in self.channels if not is_held_out(c))

    @property
    def held_out(self) -> tuple[ObservedValues, ...]:
        """Channels that are predicted only."""
        values = (c for c in self.channels if isinstance(c, ObservedValues))
        return tuple(c for c in values if c.held_out)


def read_observed(top: Key, content: dict, profile: Profile, seed: int) -> Observations:
    """Read the table [observed] of a study, and the files that it names.

    The seed chooses blocks where there are more than `MOST_BLOCKS`.

    Raises InputError, naming file, row and key, for whatever cannot be used. Warns of
    columns that are not used.
    """
    key = top["observed"]
    if "observed" not in content:
        raise key.error("needs a table [observed]")
    table = known_table(top, content, "observed", KEYS)
    channels: list[Channel] = []
    inputs: list[Path] = []
    remarks: list[str] = []
    places = typed(key, table, "held_out_m", list, [])
    held_out = [number(key["held_out_m"], x) for x in places]
    if "stops" in table:
        inputs.append(top.file.parent / typed(key, table, "stops", str))
        channels += _stops(inputs[-1], profile, remarks)
    if "passages" in table:
        inputs.append(top.file.parent / typed(key, table, "passages", str))
        channels += _passages(inputs[-1], profile, held_out, remarks)
    for x in held_out:
        if x not in {channel.place for channel in channels}:
            raise key["held_out_m"].error(f"holds {x:.10g}, where no passage is")
    channels += _counts(key, table, profile)
    if all(map(is_held_out, channels)):
        raise key.error("needs stops, passages or counts that are fitted")
    least = max(channel.blocks for channel in channels)
    released = whole(key, table, "blocks", least, 1)
    if released < least:
        raise key["blocks"].error(
            f"must be at least {least}, the blocks observed, but is {released}"
        )
    if least > MOST_BLOCKS:
        share = MOST_BLOCKS / least
        rng = np.random.default_rng((seed, least))
        channels = [_thinned(channel, share, rng) for channel in channels]
        remarks.append(
            f"{least} blocks were observed; {MOST_BLOCKS} of them, chosen at random, "
            "are used, so that intervals are those of so many"
        )
        released = round(share * released)
    errors, at = typed(key, table, "sigma", dict, {}), key["sigma"]
    check_keys(at, errors, (STOP_COLUMN, *PASSAGE_COLUMNS))
    sigma = {name: number(at[name], of, least=0.0) for name, of in errors.items()}
    for remark in remarks:
        warnings.warn(f"{top.file}: {remark}", stacklevel=2)
    return Observations(tuple(channels), sigma, released, tuple(inputs), tuple(remarks))


def _thinned(channel: Channel, share: float, rng: np.random.Generator) -> Channel:
    """Choose a share of the blocks of a channel at random, one at least."""
    size = max(1, round(share * channel.blocks))
    if isinstance(channel, ObservedCount):
        rest = channel.blocks - channel.passed
        passed = int(rng.hypergeometric(channel.passed, rest, size))
        return channel._replace(passed=passed, blocks=size)
    return channel._replace(values=rng.choice(channel.values, size, replace=False))


def _stops(file: Path, profile: Profile, remarks: list[str]) -> list[ObservedValues]:
    columns, lines = _columns(file, STOP_COLUMN, (), remarks)
    x = columns[STOP_COLUMN]
    for line, place in zip(lines, x, strict=True):
        if not profile.x[0] <= place <= profile.x[-1]:
            problem = (
                f"must lie on the profile, x = {profile.x[0]:.10g} to "
                f"{profile.x[-1]:.10g} m, but is {place:.10g}"
            )
            raise cell_error(file, problem, line, STOP_COLUMN)
    return [ObservedValues(STOP_COLUMN, None, x)]


def _passages(
    file: Path, profile: Profile, held_out: list[float], remarks: list[str]
) -> list[ObservedValues]:
    columns, lines = _columns(file, COLLECTOR_COLUMN, PASSAGE_COLUMNS, remarks)
    places = columns.pop(COLLECTOR_COLUMN)
    if not columns:
        raise InputError(
            f"needs one of the columns {', '.join(PASSAGE_COLUMNS)}", file=file
        )
    for line, x in zip(lines, places, strict=True):
        check_inside(profile, x, file=file, row=line, column=COLLECTOR_COLUMN)
    channels = []
    for name, values in columns.items():
        for line, value in zip(lines, values, strict=True):
            if value <= 0.0:
                problem = f"must be above 0, but is {value:g}"
                raise cell_error(file, problem, line, name)
        if np.any(unusual := values > (usual := USUAL[name])):
            i = int(np.argmax(unusual))
            warn_unusual(
                f"is {values[i]:g}, while usual are up to {usual:g}; is it a mark for "
                "no data, or in another unit?",
                name,
                file=file,
                row=lines[i],
                column=name,
            )
        for x in np.unique(places).tolist():
            here = values[(places == x) & np.isfinite(values)]
            if len(here):
                channels.append(ObservedValues(name, x, here, x in held_out))
    if not channels:
        raise InputError("holds no measured value", file=file)
    return channels


def _columns(
    file: Path, needed: str, others: tuple[str, ...], remarks: list[str]
) -> tuple[dict[str, np.ndarray], list[int]]:
    """Read columns of numbers, NaN for an empty cell, and the line of each row."""
    first, header, rows = records_of_file(file)
    names = [name.strip() for name in header]
    if names.count(needed) != 1:
        raise InputError(f"needs one column {needed}", file=file, row=first)
    if not rows:
        raise InputError("has a header, but no row", file=file)
    unused = [name for name in names if name not in (needed, *others)]
    if unused:
        told = ", ".join(name or "one without a name" for name in unused)
        remarks.append(f"{file.name}: not used are the columns {told}")
    columns = {}
    for place, name in enumerate(names):
        if name in unused:
            continue
        if name in columns:
            raise InputError("stands twice in the header", file=file, column=name)
        cells = [cells[place].strip() for _, cells in rows]
        for (line, _), cell in zip(rows, cells, strict=True):
            # The squares of larger numbers would leave the summaries.
            is_number = reads_as_number(cell) and abs(float(cell)) < 1e9
            if not is_number and (cell or name == needed):
                problem = f"must be a number, but is {cell!r}"
                raise cell_error(file, problem, line, name)
        columns[name] = np.array([float(cell) if cell else np.nan for cell in cells])
    return columns, [line for line, _ in rows]


def _counts(key: Key, table: dict, profile: Profile) -> list[ObservedCount]:
    counts = []
    for place, entry in enumerate(typed(key, table, "counts", list, []), 1):
        where = key["counts"][str(place)]
        check_keys(where, of_kind(where, entry, dict), COUNT_KEYS)
        for name in COUNT_KEYS:
            if name not in entry:
                raise where[name].error("is needed")
        x = number(where["x_m"], entry["x_m"])
        check_inside(profile, x, **where["x_m"].place)
        blocks = whole(where, entry, "of", 1, 1)
        passed = whole(where, entry, "passed", 0, 0, blocks)
        counts.append(ObservedCount(x, passed, blocks))
    return counts

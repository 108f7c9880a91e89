"""Trajectories: their pieces, contacts and endings."""

import dataclasses
import enum
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._checks import real_number, whole_number
from ..errors import InputError
from ..impact.events import Outcome
from ..io.display import Rows, ShownAsTable, range_of
from ..reports.tables import place_text
from ..scene import GRAVITY
from ..units import variable_attributes
from .blocks import Body, Release, select
from .lane_programs import Values
from .terrain import Profile

if TYPE_CHECKING:  # both take a while to load
    import pandas as pd
    import xarray as xr


class MotionMode(enum.IntEnum):
    """Kinds of motion of a block on a piece of its trajectory."""

    flight = 0
    rolling = 1
    sliding = 2
    contact = 3
    """A contact that takes time; or the way of a block out of the ground, or to where a
    round block rolls in its place."""

    def __str__(self) -> str:
        return self.name


class Pieces(NamedTuple):
    """Pieces of trajectories, arrays `(pieces,)`, trajectory after trajectory, in time.

    Every piece is a motion at constant acceleration, with a spin that changes at a
    constant rate, so that it can be drawn, or met with a wall, in closed form. It takes
    time, and begins where and when the one before ended, but for rounding.
    """

    trajectory: Values
    """Number of the block, from 0."""
    motion: Values
    """Codes of `MotionMode`."""
    time: Values
    """Time at the start since release [s]."""
    duration: Values
    """Duration [s]."""
    x: Values
    """Centre at the start [m]."""
    y: Values
    v_x: Values
    """Velocity of the centre at the start [m/s]."""
    v_y: Values
    a_x: Values
    """Acceleration of the centre [m/s2]."""
    a_y: Values
    orientation: Values
    """Angle phi at the start [rad]."""
    angular_velocity: Values
    """Angular velocity at the start [rad/s]."""
    angular_acceleration: Values
    """Angular acceleration [rad/s2]."""


class ContactRecord(NamedTuple):
    """Contacts, arrays `(contacts,)`, trajectory after trajectory, in time.

    Velocities are in the frame of the plane that was struck: n into the ground, t along
    it to the right, rotation clockwise. Velocities after the contact are those with
    which the trajectory continues, once the block is out of its crater.
    """

    trajectory: Values
    """Number of the block, from 0."""
    time: Values
    """Time of touch since release [s]."""
    segment: Values
    """Number of the segment that was struck, from 0."""
    slope: Values
    """Angle of the plane that was struck [rad]: the segment's, a facet's, or one
    between two segments at a break."""
    x: Values
    """Centre at touch [m]."""
    y: Values
    orientation: Values
    """Angle Theta at touch [rad]."""
    normal_velocity_before: Values
    """Velocity v_n at touch [m/s]."""
    tangential_velocity_before: Values
    """Velocity v_t at touch [m/s]."""
    angular_velocity_before: Values
    """Angular velocity at touch [rad/s]."""
    normal_velocity: Values
    """Velocity v_n after the contact [m/s]."""
    tangential_velocity: Values
    """Velocity v_t after the contact [m/s]."""
    angular_velocity: Values
    """Angular velocity after the contact [rad/s]."""
    x_after: Values
    """Centre as the trajectory continues [m]."""
    y_after: Values
    duration: Values
    """Duration of the contact [s]."""
    sinking: Values
    """Penetration of the lowest point at the end [m], out of which the block climbs."""
    outcome: Values
    """Code of `Outcome`; -1 for a touch too slow to be an impact."""
    hop: Values
    """True where the block would have left the ground by less than it heaves as it
    rolls, and went on along the ground instead; see `contacts.impact`."""
    arm_work: Values
    """Work of the normal force through its lever arm [J], see `EnergyLedger`; only the
    full model knows of it, else 0."""


NOTABLE_E_N = 0.6
"""Coefficient of restitution above which impacts are counted."""


class ImpactEnergies(NamedTuple):
    """Energies of impacts; arrays `(impacts,)`, trajectory after trajectory."""

    trajectory: np.ndarray
    """Number of the block, from 0."""
    energy: Values
    """Kinetic energy at touch [J]."""
    arm_work: Values
    """Work of the normal force through its lever arm [J]: energy without a source,
    above 0 where it is given to the block."""
    e_n: Values
    """Normal velocity after the contact over that before; NaN for a block that turns
    into the ground while its centre does not come down."""
    gain: Values
    """Kinetic and potential energy after the contact less those before [J]."""

    def sums(self, blocks: int) -> dict[str, np.ndarray]:
        """Sum over the impacts of each block, `(blocks,)`, by names with the unit. A
        gain of a rounding is none."""
        is_high = self.e_n > NOTABLE_E_N
        summed = {
            "energy_at_impacts_J": self.energy,
            "arm_work_given_J": np.maximum(self.arm_work, 0.0),
            "arm_work_taken_J": np.maximum(-self.arm_work, 0.0),
            "impacts_of_high_e_n": is_high,
            "energy_of_high_e_n_J": np.where(is_high, self.energy, 0.0),
            "impacts_that_gain": self.gain > 1e-9 * self.energy,
        }
        return {
            name: np.bincount(self.trajectory, values, blocks)
            for name, values in summed.items()
        }


COLUMN_TYPES: dict[str, type] = {
    **dict.fromkeys(("trajectory", "motion", "segment", "outcome"), int),
    "hop": bool,
}
"""Types of the columns that are not floats."""


class Recorder:
    """Collector of rows of `Pieces` or of `ContactRecord`, which come in any order of
    blocks."""

    def __init__(self, kind: type):
        self.kind = kind
        none = kind(*(np.zeros(0) for _ in kind._fields))
        self.parts = [(np.zeros(0, int), none)]

    def add(self, lanes: np.ndarray, rows: Pieces | ContactRecord) -> None:
        """Append a row for each of some blocks; whose it is gets written here."""
        if len(lanes):
            self.parts.append((lanes, rows))


def joined(recorders: Sequence[Recorder], indices: Sequence[np.ndarray]) -> Any:
    """Sort the rows of several recorders by trajectory, and within each by time, with
    the indices of the blocks of each recorder."""
    parts = [
        (of_blocks[lanes], rows)
        for recorder, of_blocks in zip(recorders, indices, strict=True)
        for lanes, rows in recorder.parts
    ]
    trajectory = np.concatenate([lanes for lanes, _ in parts])
    order = np.argsort(trajectory, kind="stable")
    columns = zip(*(rows for _, rows in parts), strict=True)
    rows = recorders[0].kind(*(np.concatenate(column)[order] for column in columns))
    rows = rows._replace(trajectory=trajectory[order])
    kinds = COLUMN_TYPES.items()
    return rows._replace(
        **{n: getattr(rows, n).astype(kind) for n, kind in kinds if hasattr(rows, n)}
    )


class Ending(enum.IntEnum):
    """Reasons why a trajectory ended."""

    stopped = 0
    """The block came to rest, on the ground, in its crater, or wedged in a place
    narrower than itself."""
    left_profile = 1
    """The centre passed an end of the profile."""
    time_limit = 2
    """The block was still moving at the time limit."""
    event_limit = 3
    """The block was still moving after the largest number of contacts and legs."""
    failed = 4
    """A contact could not be integrated, or a search for contact was given up."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")


@dataclasses.dataclass(frozen=True, repr=False)
class Runs(ShownAsTable):
    """Trajectories of blocks; arrays `(blocks,)`."""

    profile: Profile
    release: Release
    ending: np.ndarray
    """Codes of `Ending`."""
    x: Values
    """Centre at the end of the trajectory [m]; NaN for a block that failed."""
    y: Values
    time: Values
    """Time of the end since release [s]."""
    events: np.ndarray
    """Number of contacts and of legs along the ground."""
    contacts: ContactRecord
    pieces: Pieces

    def count_endings(self) -> dict[str, int]:
        """Count trajectories by ending; endings that did not occur are left out."""
        codes, counts = np.unique(self.ending, return_counts=True)
        return {
            str(Ending(code)): int(count)
            for code, count in zip(codes, counts, strict=True)
        }

    def to_dataframe(self) -> "pd.DataFrame":
        """Make a table with one row a block: `ending` in words, `x_m`, `y_m` and
        `time_s` of the end, and `events`. Contacts and pieces are columns already:
        `pandas.DataFrame(runs.contacts._asdict())`."""
        return self.to_xarray().to_dataframe()

    def to_xarray(self) -> "xr.Dataset":
        """Make a dataset of the same over `block`, with units."""
        import xarray as xr

        endings = np.array([str(ending) for ending in Ending])[self.ending]
        variables = {"ending": ("block", endings, {"long_name": "ending"})}
        for name, values, unit, meaning in (
            ("x_m", self.x, "m", "x of the centre at the end"),
            ("y_m", self.y, "m", "y of the centre at the end"),
            ("time_s", self.time, "s", "time of the end since release"),
            ("events", self.events, "-", "contacts and legs along the ground"),
        ):
            variables[name] = ("block", values, variable_attributes(meaning, unit))
        return xr.Dataset(variables, {"block": np.arange(len(self.ending))})

    def plot(self, path=None, *, ax=None):
        """Draw the trajectories, coloured by speed, over the profile, and return the
        axes.

        Args:
            path: file to save the figure in too; replaced once the new one is whole.
            ax: axes to draw on. Without axes and path the figure is one of
                `matplotlib.pyplot`, which notebooks show.
        """
        from ..plotting.style import plotted
        from .trajectory_drawing import draw_runs

        return plotted(partial(draw_runs, self), path, ax)

    def energy_of_pieces(self) -> np.ndarray:
        """Compute kinetic and potential energy at the start of each piece [J], shape
        `(pieces,)`, with the height measured from y = 0."""
        pieces = self.pieces
        of_each = select(self.release.mass_properties, pieces.trajectory)
        kinetic = of_each.kinetic_energy(
            pieces.v_x, pieces.v_y, pieces.angular_velocity
        )
        return kinetic + of_each.mass * GRAVITY * pieces.y

    def impact_energies(self) -> ImpactEnergies:
        """Compute the energies of all impacts; touches too slow to be an impact, and
        impacts that failed, are left out."""
        known = (self.contacts.outcome >= 0) & (self.contacts.outcome != Outcome.failed)
        c = select(self.contacts, known)
        of_each = select(self.release.mass_properties, c.trajectory)
        v_n = c.normal_velocity_before
        before = of_each.kinetic_energy(
            v_n, c.tangential_velocity_before, c.angular_velocity_before
        )
        after = of_each.kinetic_energy(
            c.normal_velocity, c.tangential_velocity, c.angular_velocity
        )
        comes_down = v_n > 0.0
        e_n = -c.normal_velocity / np.where(comes_down, v_n, 1.0)
        return ImpactEnergies(
            trajectory=c.trajectory,
            energy=before,
            arm_work=c.arm_work,
            e_n=np.where(comes_down, e_n, np.nan),
            gain=after - before + of_each.mass * GRAVITY * (c.y_after - c.y),
        )

    def path(self, trajectory: int, spacing: float = 0.05) -> dict[str, np.ndarray]:
        """Sample the trajectory of one block.

        Args:
            trajectory: number of the block, from 0.
            spacing: largest time between two samples [s], above 0.

        Returns:
            Arrays `time` [s], `x`, `y` [m], `v_x`, `v_y` [m/s], `orientation` [rad] and
            `angular_velocity` [rad/s]; both ends of every piece are among the samples.

        Raises InputError for a number that no block has, and a spacing that is not
        above 0.
        """
        trajectory = whole_number("trajectory", trajectory, 0, len(self.ending) - 1)
        spacing = real_number("spacing", spacing)
        if spacing <= 0.0:
            raise InputError(f"spacing must be above 0 s, but is {spacing!r}")
        first, last = np.searchsorted(
            self.pieces.trajectory, [trajectory, trajectory + 1]
        )
        names = ("time", *Body._fields)
        samples = [(np.zeros(0),) * len(names)]
        for i in range(first, last):
            piece = select(self.pieces, i)
            count = max(2, int(np.ceil(piece.duration / spacing)) + 1)
            t = np.linspace(0.0, piece.duration, count)
            samples.append((piece.time + t, *state_after(piece, t)))
        columns = map(np.concatenate, zip(*samples, strict=True))
        return dict(zip(names, columns, strict=True))

    def display_rows(self) -> tuple[str, Rows]:
        """Give the number of blocks and how they ended, and ranges of results."""
        endings = ", ".join(f"{n} {name}" for name, n in self.count_endings().items())
        rows = [
            ("x at the end", range_of(self.x, place_text), "m"),
            ("y at the end", range_of(self.y, place_text), "m"),
            ("time", range_of(self.time), "s"),
            ("events", range_of(self.events), "-"),
            *_rows_of_energies(self.impact_energies()),
        ]
        count = len(self.ending)
        blocks = "1 block" if count == 1 else f"{count} blocks"
        return f"Runs: {blocks}; {endings}", rows


def _rows_of_energies(ledger: ImpactEnergies) -> Rows:
    """Write what to look at before impacts are believed; nothing without impacts."""
    if not len(ledger.energy):
        return []
    together = ledger._replace(trajectory=np.zeros(len(ledger.energy), int))
    total = {name: float(sum_) for name, (sum_,) in together.sums(1).items()}
    energy = total["energy_at_impacts_J"] or 1.0
    given, taken = total["arm_work_given_J"], total["arm_work_taken_J"]
    share = total["impacts_of_high_e_n"] / len(ledger.energy)
    high = f"impacts with e_n above {NOTABLE_E_N}"
    rows = [
        (high, f"{share:.1%}", ""),
        ("impacts that gain energy", f"{total['impacts_that_gain']:.0f}", ""),
    ]
    arm = f"gives {given / energy:.1%}, takes {taken / energy:.1%}"
    return [("arm work", arm, "of the energy at impact")] * (given + taken > 0.0) + rows


class Stretches(NamedTuple):
    r"""Parts of trajectories on which x only grows, or only falls.

    Arrays `(stretches,)`, trajectory after trajectory, in time. On a piece
    $x(t) = x_0 + v t + a t^2/2$; a stretch is such a piece, or its part up to where
    $v + at = 0$, or from there on. The velocity at a place X is
    $w = \pm\sqrt{v^2 + 2a(X - x_0)}$ with the sign of the stretch, and the time there
    $2(X - x_0)/(v + w)$ or $(w - v)/a$, whichever does not cancel.
    """

    piece: np.ndarray  # number of the piece, from 0
    start: Values  # start, from the start of the piece [s]
    stop: Values  # end, from the start of the piece [s]
    sign: np.ndarray  # direction: 1 to the right, -1 to the left, 0 where x stays
    x_start: Values  # x at the start [m]
    x_stop: Values  # x at the end [m]


def stretches_of(runs: Runs) -> Stretches:
    """Cut trajectories into stretches."""
    p = runs.pieces
    bends = p.a_x != 0.0
    turning = np.where(bends, -p.v_x / np.where(bends, p.a_x, 1.0), -1.0)
    turns = np.flatnonzero((turning > 0.0) & (turning < p.duration))
    piece = np.concatenate([np.arange(len(p.x)), turns])
    start = np.concatenate([np.zeros(len(p.x)), turning[turns]])
    stop = np.concatenate([p.duration, p.duration[turns]])
    stop[turns] = turning[turns]
    order = np.argsort(piece, kind="stable")
    piece, start, stop = piece[order], start[order], stop[order]
    p = select(runs.pieces, piece)
    middle = state_after(p, 0.5 * (start + stop))
    return Stretches(
        piece,
        start,
        stop,
        np.sign(middle.v_x),
        state_after(p, start).x,
        state_after(p, stop).x,
    )


def state_after(p: Pieces, time: Values) -> Body:
    """Compute position and motion on pieces, a time after the start of each [s]."""
    return Body(
        x=p.x + (p.v_x + 0.5 * p.a_x * time) * time,
        y=p.y + (p.v_y + 0.5 * p.a_y * time) * time,
        v_x=p.v_x + p.a_x * time,
        v_y=p.v_y + p.a_y * time,
        orientation=p.orientation
        + (p.angular_velocity + 0.5 * p.angular_acceleration * time) * time,
        angular_velocity=p.angular_velocity + p.angular_acceleration * time,
    )


def time_at(runs: Runs, chosen: Stretches, x: Values) -> Values:
    """Compute when stretches are at x, from the start of their pieces [s]; where they
    do not reach it, when they are nearest."""
    v, a = runs.pieces.v_x[chosen.piece], runs.pieces.a_x[chosen.piece]
    distance = x - runs.pieces.x[chosen.piece]
    there = chosen.sign * np.sqrt(np.maximum(v**2 + 2.0 * a * distance, 0.0))
    straight = chosen.sign * v >= 0.0
    total = np.where(v + there == 0.0, 1.0, v + there)
    turned = (there - v) / np.where(straight, 1.0, a)
    time = np.where(straight, 2.0 * distance / total, turned)
    return np.clip(time, chosen.start, chosen.stop)

"""Trajectories computed: how each ended, and what it did on its way."""

import dataclasses
import enum

import numpy as np

from ..scene import GRAVITY
from .profile import Profile
from .record import ContactRecord, Pieces
from .release import Release


class Ending(enum.IntEnum):
    """Why a trajectory ended."""

    stopped = 0
    """The block came to rest, on the ground or in its crater."""
    left_profile = 1
    """Its centre passed an end of the profile."""
    time_limit = 2
    """It was still going at the limit of time."""
    event_limit = 3
    """It was still going after as many contacts and legs as are followed."""
    failed = 4
    """A contact could not be integrated, or a search was given up."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")


@dataclasses.dataclass(frozen=True)
class Runs:
    """Trajectories of blocks; arrays `(blocks,)`."""

    profile: Profile
    release: Release
    ending: np.ndarray
    """Codes of `Ending`."""
    x: np.ndarray
    """Where each ended [m]: the centre."""
    y: np.ndarray
    time: np.ndarray
    """When [s], since release."""
    events: np.ndarray
    """Contacts and legs along the ground that it took."""
    contacts: ContactRecord
    pieces: Pieces

    def count_endings(self) -> dict[str, int]:
        """How many ended in which way, endings that did not occur left out."""
        codes, counts = np.unique(self.ending, return_counts=True)
        return {
            str(Ending(code)): int(count)
            for code, count in zip(codes, counts, strict=True)
        }

    def energy_of_pieces(self) -> np.ndarray:
        """Kinetic and potential energy at the start of each piece [J], with the height
        measured from y = 0."""
        pieces = self.pieces
        mass, inertia = (value[pieces.trajectory] for value in self.release.matter)
        return (
            0.5 * mass * (pieces.v_x**2 + pieces.v_y**2)
            + 0.5 * inertia * pieces.angular_velocity**2
            + mass * GRAVITY * pieces.y
        )

    def path(self, trajectory: int, spacing: float = 0.05) -> dict[str, np.ndarray]:
        """The way of one block, at moments no farther apart than `spacing` [s].

        Returns arrays `time`, `x`, `y`, `v_x`, `v_y`, `orientation` and
        `angular_velocity`; the ends of all pieces are among the moments.
        """
        first, last = np.searchsorted(
            self.pieces.trajectory, [trajectory, trajectory + 1]
        )
        names = ("time", "x", "y", "v_x", "v_y", "orientation", "angular_velocity")
        columns = {name: [np.zeros(0)] for name in names}
        for i in range(first, last):
            p = type(self.pieces)(*(column[i] for column in self.pieces))
            count = max(2, int(np.ceil(p.duration / spacing)) + 1)
            t = np.linspace(0.0, p.duration, count)
            values = (
                p.time + t,
                p.x + (p.v_x + 0.5 * p.a_x * t) * t,
                p.y + (p.v_y + 0.5 * p.a_y * t) * t,
                p.v_x + p.a_x * t,
                p.v_y + p.a_y * t,
                p.orientation
                + (p.angular_velocity + 0.5 * p.angular_acceleration * t) * t,
                p.angular_velocity + p.angular_acceleration * t,
            )
            for name, value in zip(names, values, strict=True):
                columns[name].append(value)
        return {name: np.concatenate(parts) for name, parts in columns.items()}

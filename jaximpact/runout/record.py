"""What is written down of trajectories as they go: contacts, and the pieces of the way.

Every piece of the way is a motion at constant acceleration, with a spin that changes at
a constant rate, so that it can be drawn, or met with a wall, without another
computation.
"""

import enum
from typing import NamedTuple

import numpy as np


class Way(enum.IntEnum):
    """What a block does on a piece of its way."""

    flight = 0
    rolling = 1
    sliding = 2
    contact = 3

    def __str__(self) -> str:
        return self.name


class Pieces(NamedTuple):
    """Pieces of the way, arrays `(pieces,)`, trajectory after trajectory, in time."""

    trajectory: np.ndarray
    way: np.ndarray
    """Codes of `Way`."""
    time: np.ndarray
    """At the start [s], since release."""
    duration: np.ndarray
    """[s]"""
    x: np.ndarray
    """Of the centre at the start [m]."""
    y: np.ndarray
    v_x: np.ndarray
    """At the start [m/s]."""
    v_y: np.ndarray
    a_x: np.ndarray
    """[m/s2]"""
    a_y: np.ndarray
    orientation: np.ndarray
    """At the start [rad]."""
    angular_velocity: np.ndarray
    """At the start [rad/s]."""
    angular_acceleration: np.ndarray
    """[rad/s2]"""


class ContactRecord(NamedTuple):
    """Contacts, arrays `(contacts,)`, trajectory after trajectory, in time.

    Velocities are in the frame of the plane that was struck: n into the ground, t along
    it to the right, rotation clockwise. Those after are as the block goes on, out of
    its crater.
    """

    trajectory: np.ndarray
    time: np.ndarray
    """At touch [s], since release."""
    segment: np.ndarray
    """Which was struck."""
    slope: np.ndarray
    """Of the plane that was struck [rad]: the segment's, or between two at a break."""
    x: np.ndarray
    """Of the centre at touch [m]."""
    y: np.ndarray
    orientation: np.ndarray
    """Theta at touch [rad]."""
    normal_velocity_before: np.ndarray
    tangential_velocity_before: np.ndarray
    angular_velocity_before: np.ndarray
    normal_velocity: np.ndarray
    """After [m/s]."""
    tangential_velocity: np.ndarray
    angular_velocity: np.ndarray
    x_after: np.ndarray
    """Of the centre as it goes on [m]."""
    y_after: np.ndarray
    duration: np.ndarray
    """[s]"""
    sinking: np.ndarray
    """At the end [m], out of which the block has to climb."""
    outcome: np.ndarray
    """Code of `Outcome`; -1 for a touch too slow to be an impact."""


class Growing:
    """Rows that come in any order, kept by trajectory."""

    def __init__(self, kind: type):
        self.kind, self.parts = kind, []

    def add(self, *columns) -> None:
        """Rows of lanes; columns broadcast."""
        if len(columns[0]):
            self.parts.append(np.broadcast_arrays(*columns))

    def whole(self):
        """All rows, by trajectory and then as they came."""
        parts = self.parts or [[np.zeros(0)] * len(self.kind._fields)]
        columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
        order = np.argsort(columns[0], kind="stable")
        return self.kind(*(column[order] for column in columns))

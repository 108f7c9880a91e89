"""Slope run-out: blocks that fly, strike, roll and stop on a profile."""

from .profile import Profile, read_profile
from .rebounds import Blows, ClosedForm, Contacts, FullModel
from .record import ContactRecord, Pieces, Way
from .release import Release
from .runs import Ending, Runs
from .trajectories import simulate_runout

__all__ = [
    "Blows",
    "ClosedForm",
    "ContactRecord",
    "Contacts",
    "Ending",
    "FullModel",
    "Pieces",
    "Profile",
    "Release",
    "Runs",
    "Way",
    "read_profile",
    "simulate_runout",
]

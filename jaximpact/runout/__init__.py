"""Slope run-out: blocks that fly, strike, roll and stop on a profile."""

from .collectors import Passages, first_passages, passages
from .dual import Dual
from .envelopes import Maxima, maxima_along
from .gradients import Standing, differentiate_runout, runout_gradients
from .ground import Ground
from .profile import Profile, read_profile
from .quantities import Normal, Uniform, draw
from .rebounds import Blows, ClosedForm, Contacts, FullModel
from .record import ContactRecord, Pieces, Way
from .release import Release
from .runs import Ending, Runs
from .slope_file import SlopeStudy, read_slope_studies, read_slope_study
from .study import run_slope_study
from .trajectories import simulate_runout

__all__ = [
    "Blows",
    "ClosedForm",
    "ContactRecord",
    "Contacts",
    "Dual",
    "Ending",
    "FullModel",
    "Ground",
    "Maxima",
    "Normal",
    "Passages",
    "Pieces",
    "Profile",
    "Release",
    "Runs",
    "SlopeStudy",
    "Standing",
    "Uniform",
    "Way",
    "differentiate_runout",
    "draw",
    "first_passages",
    "maxima_along",
    "passages",
    "read_profile",
    "read_slope_studies",
    "read_slope_study",
    "run_slope_study",
    "runout_gradients",
    "simulate_runout",
]

"""The public names, for type checkers and editors; `__init__.py` loads each when it is
asked for."""

from ..impact_response import ImpactResponse, ImpactResponses
from .analysis import Maxima, Passages, first_passages, maxima_along, passages
from .back_analysis.calibrate import calibrate_slope
from .back_analysis.predictive import SlopeCalibration
from .blocks import Release
from .contacts.contact_models import ClosedForm, Contacts, FullModel
from .profile_formats import read_profile
from .random_inputs import Lognormal, Normal, PowerLaw, Uniform, draw
from .scheduler import simulate_runout
from .study.barriers import Barrier
from .study.contact_laws import NamedLaw
from .study.profile_file import MapPlacement
from .study.run_study import run_slope_study
from .study.slope_file import (
    SlopeStudy,
    StudyInputs,
    StudySettings,
    read_slope_studies,
    read_slope_study,
)
from .terrain import Ground, Profile
from .trajectory import (
    ContactRecord,
    Ending,
    ImpactEnergies,
    MotionMode,
    Pieces,
    Runs,
)

__all__ = [
    "Barrier",
    "ClosedForm",
    "ContactRecord",
    "Contacts",
    "Ending",
    "FullModel",
    "Ground",
    "ImpactEnergies",
    "ImpactResponse",
    "ImpactResponses",
    "Lognormal",
    "MapPlacement",
    "Maxima",
    "MotionMode",
    "NamedLaw",
    "Normal",
    "Passages",
    "Pieces",
    "PowerLaw",
    "Profile",
    "Release",
    "Runs",
    "SlopeCalibration",
    "SlopeStudy",
    "StudyInputs",
    "StudySettings",
    "Uniform",
    "calibrate_slope",
    "draw",
    "first_passages",
    "maxima_along",
    "passages",
    "read_profile",
    "read_slope_studies",
    "read_slope_study",
    "run_slope_study",
    "simulate_runout",
]

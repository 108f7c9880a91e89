"""jaximpact: differentiable impacts of rock blocks on deformable ground."""

from .accuracy import PRESETS, Accuracy
from .batch import simulate_batch
from .block import Block
from .formats.netcdf import read_netcdf, write_netcdf
from .mechanics.laws import Laws
from .mechanics.model import select_model
from .mechanics.outcomes import Outcome
from .parametric_sets import parametric_set
from .rebound import (
    BozzoloPamini,
    ConstantCoefficients,
    FrictionalEllipsoid,
    PfeifferBowen,
    Rebound,
    RigidEllipsoid,
)
from .restitution import energetic_coefficient, vijayakumar_coefficient
from .scene import Impact, Scene
from .sensitivity import Range, elasticities, morris, sobol
from .simulation import ImpactResult, simulate
from .soil import Soil
from .summary import EnergyLedger
from .sweeping import repeat_sweep, sweep

__all__ = [
    "PRESETS",
    "Accuracy",
    "Block",
    "BozzoloPamini",
    "ConstantCoefficients",
    "EnergyLedger",
    "FrictionalEllipsoid",
    "Impact",
    "ImpactResult",
    "Laws",
    "Outcome",
    "PfeifferBowen",
    "Range",
    "Rebound",
    "RigidEllipsoid",
    "Scene",
    "Soil",
    "calibrate",
    "elasticities",
    "energetic_coefficient",
    "morris",
    "parametric_set",
    "predict",
    "read_netcdf",
    "repeat_sweep",
    "select_model",
    "simulate",
    "simulate_batch",
    "sobol",
    "sweep",
    "vijayakumar_coefficient",
    "write_netcdf",
]

_TAKES_LONG = ("calibrate", "predict")
"""Imported when asked for: statistics and drawing take a second to load."""


def __getattr__(name: str):
    if name in _TAKES_LONG:
        from . import calibration

        return getattr(calibration, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

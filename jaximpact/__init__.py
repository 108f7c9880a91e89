"""jaximpact: differentiable impacts of rock blocks on deformable ground."""

import importlib

from .accuracy import PRESETS, Accuracy
from .batch import simulate_batch
from .block import Block
from .mechanics.laws import Laws
from .mechanics.model import select_model
from .mechanics.outcomes import Outcome
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
from .simulation import ImpactResult, simulate
from .soil import Soil
from .summary import EnergyLedger

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

_LATER = {
    "calibration": ("calibrate", "predict"),
    "formats.netcdf": ("read_netcdf", "write_netcdf"),
    "parametric_sets": ("parametric_set",),
    "sensitivity": ("Range", "elasticities", "morris", "sobol"),
    "sweeping": ("repeat_sweep", "sweep"),
}
"""By module, what is imported when asked for: xarray, statistics and drawing take a
second to load."""


def __getattr__(name: str):
    for module, names in _LATER.items():
        if name in names:
            return getattr(importlib.import_module(f".{module}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

"""The public names, for type checkers and editors; `__init__.py` loads each when it is
asked for."""

from .accuracy import PRESETS, Accuracy
from .batch import simulate_batch
from .calibration import calibrate, compare, predict
from .impact.events import Outcome
from .impact.reduced_models import select_model
from .impact.results import EnergyLedger
from .io.datasets import read_netcdf, write_netcdf
from .lazy import simulate_dataset, write_zarr
from .parametric_sets import parametric_set, simulate_set
from .rebound import (
    AnglePowerLaw,
    BozzoloPamini,
    ConstantCoefficients,
    FrictionalEllipsoid,
    PfeifferBowen,
    Rebound,
    RigidEllipsoid,
)
from .restitution import energetic_coefficient, vijayakumar_coefficient
from .result import ImpactResult
from .scene import Block, Impact, Scene, Soil
from .second_derivatives import with_second_derivatives
from .sensitivity import Range, elasticities, morris, sobol
from .simulation import simulate
from .sweeping import sweep

__version__: str

__all__ = [
    "PRESETS",
    "Accuracy",
    "AnglePowerLaw",
    "Block",
    "BozzoloPamini",
    "ConstantCoefficients",
    "EnergyLedger",
    "FrictionalEllipsoid",
    "Impact",
    "ImpactResult",
    "Outcome",
    "PfeifferBowen",
    "Range",
    "Rebound",
    "RigidEllipsoid",
    "Scene",
    "Soil",
    "calibrate",
    "compare",
    "elasticities",
    "energetic_coefficient",
    "morris",
    "parametric_set",
    "predict",
    "read_netcdf",
    "select_model",
    "simulate",
    "simulate_batch",
    "simulate_dataset",
    "simulate_set",
    "sobol",
    "sweep",
    "vijayakumar_coefficient",
    "with_second_derivatives",
    "write_netcdf",
    "write_zarr",
]

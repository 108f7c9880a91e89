"""jaximpact: differentiable impacts of rock blocks on deformable ground."""

import importlib

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

_MODULES = {
    "accuracy": ("PRESETS", "Accuracy"),
    "batch": ("simulate_batch",),
    "block": ("Block",),
    "calibration": ("calibrate", "predict"),
    "formats.netcdf": ("read_netcdf", "write_netcdf"),
    "mechanics.laws": ("Laws",),
    "mechanics.model": ("select_model",),
    "mechanics.outcomes": ("Outcome",),
    "parametric_sets": ("parametric_set",),
    "rebound": (
        *("BozzoloPamini", "ConstantCoefficients", "FrictionalEllipsoid"),
        *("PfeifferBowen", "Rebound", "RigidEllipsoid"),
    ),
    "restitution": ("energetic_coefficient", "vijayakumar_coefficient"),
    "scene": ("Impact", "Scene"),
    "sensitivity": ("Range", "elasticities", "morris", "sobol"),
    "simulation": ("ImpactResult", "simulate"),
    "soil": ("Soil",),
    "summary": ("EnergyLedger",),
    "sweeping": ("repeat_sweep", "sweep"),
}
"""By module, what is imported when asked for: the command line answers without JAX, and
can say what is wrong where JAX cannot be imported."""


def __getattr__(name: str):
    for module, names in _MODULES.items():
        if name in names:
            found = getattr(importlib.import_module(f".{module}", __name__), name)
            globals()[name] = found
            return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

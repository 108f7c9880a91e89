"""jaximpact: differentiable impacts of rock blocks on deformable ground."""

import importlib

_MODULES = {
    "accuracy": ("PRESETS", "Accuracy"),
    "batch": ("simulate_batch",),
    "calibration": ("calibrate", "compare", "predict"),
    "io.datasets": ("read_netcdf", "write_netcdf"),
    "impact.events": ("Outcome",),
    "impact.reduced_models": ("select_model",),
    "impact.results": ("EnergyLedger",),
    "lazy": ("simulate_dataset", "write_zarr"),
    "parametric_sets": ("parametric_set", "simulate_set"),
    "rebound": (
        "AnglePowerLaw",
        "BozzoloPamini",
        "ConstantCoefficients",
        "FrictionalEllipsoid",
        "PfeifferBowen",
        "Rebound",
        "RigidEllipsoid",
    ),
    "result": ("ImpactResult",),
    "restitution": ("energetic_coefficient", "vijayakumar_coefficient"),
    "scene": ("Block", "Impact", "Scene", "Soil"),
    "second_derivatives": ("with_second_derivatives",),
    "sensitivity": ("Range", "elasticities", "morris", "sobol"),
    "simulation": ("simulate",),
    "sweeping": ("sweep",),
}
"""Where the public names are. Each module is imported when it is asked for: JAX takes a
second to load, in which the commands must serve Ctrl-C already, and xarray, statistics
and drawing take another."""

_PLACES = {name: module for module, names in _MODULES.items() for name in names}
__all__ = sorted(_PLACES)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str):
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = importlib.import_module(f".{_PLACES[name]}", __name__)
    value = globals()[name] = getattr(module, name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

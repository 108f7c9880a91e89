"""What a result carries so that it can be computed again."""

import dataclasses
import platform
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..accuracy import Accuracy
from .columns import INPUT_COLUMNS

if TYPE_CHECKING:  # the command line names the version without loading JAX
    from ..mechanics.laws import Laws
    from ..scene import Scene

PACKAGES = (
    *("jaximpact", "jax", "jaxlib", "diffrax", "equinox", "optimistix", "optax"),
    "llvmlite",
)


def version_of(package: str) -> str:
    """Version of an installed package, or the words "not installed"."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that a result depends on."""
    found = {"python": platform.python_version()}
    return found | {package: version_of(package) for package in PACKAGES}


def law_names(laws: "Laws") -> dict[str, str]:
    """Where the constitutive functions are defined: law -> module and name."""
    return {
        law: f"{function.__module__}.{getattr(function, '__qualname__', '<unnamed>')}"
        for law, function in vars(laws).items()
    }


def scene_values(scene: "Scene") -> dict:
    """The scene in the units of the tables."""
    values = {}
    for column in INPUT_COLUMNS.values():
        value = np.asarray(getattr(getattr(scene, column.part), column.field))
        values[column.name] = (value / column.factor).tolist()
    return values


def manifest(
    scene: "Scene", accuracy: Accuracy, model_tolerance: float, laws: "Laws"
) -> dict:
    """Parameters, laws, versions and accuracy, ready for JSON."""
    return {
        "scene": scene_values(scene),
        "laws": law_names(laws),
        "accuracy": dataclasses.asdict(accuracy),
        "model_tolerance": model_tolerance,
        "versions": versions(),
    }


def batch_manifest(
    table: Path,
    sha256: str,
    accuracy: Accuracy,
    model_tolerance: float,
    outcomes: dict[str, int],
) -> dict:
    """What a table of results was computed from and with, ready for JSON.

    Args:
        table: the file of scenes; only its name is kept.
        sha256: of that file.
        accuracy: the setting used.
        model_tolerance: error for which a cheaper model was allowed.
        outcomes: how many impacts ended in which way.
    """
    return {
        "scenes": {"file": table.name, "sha256": sha256},
        "accuracy": dataclasses.asdict(accuracy),
        "model_tolerance": model_tolerance,
        "outcomes": outcomes,
        "versions": versions(),
    }

"""What a result carries so that it can be computed again."""

import dataclasses
import platform
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from ..accuracy import Accuracy

if TYPE_CHECKING:  # the command line names the version without loading JAX
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


def manifest(
    scene: "Scene", accuracy: Accuracy, model_tolerance: float, engine: str
) -> dict:
    """Parameters, laws, shape, versions, accuracy and engine, ready for JSON."""
    from ..identity import part_names
    from .scenes import scene_values

    return {
        "scene": scene_values(scene),
        "laws": part_names(scene.soil, scene.block),
        "accuracy": dataclasses.asdict(accuracy),
        "model_tolerance": model_tolerance,
        "engine": engine,
        "versions": versions(),
    }


def batch_manifest(
    table: Path,
    sha256: str,
    base: "Scene",
    accuracy: Accuracy,
    model_tolerance: float,
    outcomes: dict[str, int],
) -> dict:
    """What a table of results was computed from and with, ready for JSON.

    Args:
        table: the file of scenes; only its name is kept.
        sha256: of that file.
        base: laws, shapes, and what stands for columns that the table does not have.
        accuracy: the setting used.
        model_tolerance: error for which a cheaper model was allowed.
        outcomes: how many impacts ended in which way.
    """
    from ..identity import part_names
    from .scenes import scene_values

    values = scene_values(base)
    return {
        "scenes": {"file": table.name, "sha256": sha256},
        # What differs from row to row stands in the table.
        "base": {k: v for k, v in values.items() if not isinstance(v, list)},
        "laws": part_names(base.soil, base.block),
        "accuracy": dataclasses.asdict(accuracy),
        "model_tolerance": model_tolerance,
        "outcomes": outcomes,
        "versions": versions(),
    }

"""Versions of Python and of the packages that a result depends on."""

import platform
from importlib import metadata

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
    """Versions of Python and of the packages that a result depends on, by name."""
    found = {"python": platform.python_version()}
    return found | {package: version_of(package) for package in PACKAGES}

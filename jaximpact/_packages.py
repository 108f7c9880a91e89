"""Packages: the versions of those that results depend on, and optional ones."""

import importlib
import platform
from importlib import metadata
from typing import Any

from .errors import InputError


def needed(package: str, what: str, extra: str = "cluster") -> Any:
    """Import a package of an extra.

    Args:
        what: what it is needed for, the subject of the error.

    Raises InputError, with the cure, where it is not installed.
    """
    top = package.partition(".")[0]
    try:
        importlib.import_module(top)
    except ModuleNotFoundError as error:
        if error.name != top:
            raise
        raise InputError(
            f"{what} needs the package {top}, which is not installed: pip install "
            f"'jaximpact[{extra}]'"
        ) from None
    return importlib.import_module(package)


PACKAGES = (
    *("jaximpact", "jax", "jaxlib", "diffrax", "equinox", "optimistix", "optax"),
    "llvmlite",
)


def version_of(package: str) -> str:
    """Return the version of an installed package, or the words "not installed"."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that a result depends on, by
    name."""
    found = {"python": platform.python_version()}
    return found | {package: version_of(package) for package in PACKAGES}

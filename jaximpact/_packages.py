"""Packages: versions of those that results depend on, optional ones, installed ones."""

import functools
import importlib
import platform
import site
import sys
import sysconfig
from importlib import metadata
from pathlib import Path
from typing import Any

from .errors import InputError


def needed(package: str, what: str, extra: str = "cluster") -> Any:
    """Import a package of an extra; InputError, with the cure, where it is not
    installed. `what` needs it: the subject of the error."""
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
    installed = {"python": platform.python_version()}
    return installed | {package: version_of(package) for package in PACKAGES}


PACKAGE = __name__.partition(".")[0]
FOUNDATIONS = {PACKAGE, "jax", "jaxlib", "equinox", "numpy"}
"""Packages that no user's law is part of, wherever they are installed."""


def top_of(module: str) -> str:
    """Return the package that a module is in."""
    return module.partition(".")[0]


def is_of_python(module: str) -> bool:
    """Tell whether a module belongs to Python itself."""
    is_standard = top_of(module) in sys.stdlib_module_names or module == "builtins"
    return is_standard and module != "__main__"


@functools.lru_cache(maxsize=4096)
def is_installed(module: str, file: str | None) -> bool:
    """Tell whether a module is of this package, of Python, or of what is installed."""
    if module == "__main__":
        return False
    if top_of(module) in FOUNDATIONS or is_of_python(module):
        return True
    if file is None:
        return False
    return any(Path(file).is_relative_to(place) for place in _places())


@functools.cache
def _places() -> tuple[Path, ...]:
    names = ("stdlib", "platstdlib", "purelib", "platlib")
    places = [sysconfig.get_path(name) for name in names]
    return tuple(Path(place) for place in (*places, *site.getsitepackages()))

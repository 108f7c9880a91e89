"""Optional packages, imported when they are asked for."""

import importlib
from typing import Any

from .errors import InputError


def needed(package: str, what: str) -> Any:
    """Import a package of the extra `cluster`.

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
            "'jaximpact[cluster]'"
        ) from None
    return importlib.import_module(package)

"""Slope run-out: blocks that fly, strike, roll and stop on a profile.

The public names stand in `__init__.pyi`. Each module is imported when a name of it is
asked for: xarray and drawing take a second to load, which run-outs in Python need not.
"""

from .. import _public_names

__getattr__, __dir__, __all__ = _public_names.of_package(__name__, __file__)  # pyright: ignore[reportUnsupportedDunderAll]

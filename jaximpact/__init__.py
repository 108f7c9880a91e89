"""jaximpact: differentiable impacts of rock blocks on deformable ground.

The public names stand in `__init__.pyi`. Each module is imported when a name of it is
asked for: JAX takes a second to load, in which the commands must serve Ctrl-C already,
and xarray, statistics and drawing take another.
"""

from . import _public_names

_load, __dir__, __all__ = _public_names.of_package(__name__, __file__)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str):
    if name == "__version__":
        from ._packages import version_of

        return version_of(__name__)
    return _load(name)

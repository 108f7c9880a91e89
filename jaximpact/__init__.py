"""jaximpact: differentiable impacts of rock blocks on deformable ground.

The public names stand in `__init__.pyi`. Each module is imported when a name of it is
asked for: JAX takes a second to load, in which the commands must serve Ctrl-C already,
and xarray, statistics and drawing take another.
"""

import ast
import importlib
from pathlib import Path

_PLACES = {
    alias.name: node.module
    for node in ast.parse(Path(__file__).with_suffix(".pyi").read_text("utf-8")).body
    if isinstance(node, ast.ImportFrom)
    for alias in node.names
}
__all__ = sorted(_PLACES)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str):
    if name == "__version__":
        return importlib.import_module("._packages", __name__).version_of(__name__)
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = importlib.import_module(f".{_PLACES[name]}", __name__)
    value = globals()[name] = getattr(module, name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

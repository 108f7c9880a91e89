"""Public names of a package, each loaded when it is asked for."""

import ast
import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any


def of_package(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Give the functions `__getattr__` and `__dir__` of a package, and its `__all__`.

    Args:
        package, file: `__name__` and `__file__` of the package. Beside the file its
            stub, `__init__.pyi`, imports each public name from where it is.
    """
    stub = ast.parse(Path(file).with_suffix(".pyi").read_text("utf-8"))
    places = {
        alias.name: "." * node.level + (node.module or "")
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }

    def load(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(importlib.import_module(places[name], package), name)
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *places})

    return load, names, sorted(places)

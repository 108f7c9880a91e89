"""Base of laws, shapes and what is made of them, and how its pickles are read."""

import dataclasses
from typing import TYPE_CHECKING, Any, ClassVar

import equinox as eqx

from ._precision import require_float64

if TYPE_CHECKING:

    class Module:
        """Signature of `equinox.Module` for type checkers.

        The constructor of a composite takes parameters of parts by their names too;
        that of a part they read off its fields.
        """

        __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[Any]]]

        def __init__(self, *values: Any, **named: Any) -> None: ...
else:
    Module = eqx.Module


def set_in_float64(module: Module, fields: dict[str, Any]) -> None:
    """Set the fields of a module that is read from a pickle, as its `__setstate__`.

    Raises RuntimeError in float32, in which JAX has cut the numbers without a word.
    """
    require_float64()
    vars(module).update(fields)

"""Fields of laws and shapes that are no parameters: static, so that JAX compares them,
and a part of what is compiled."""

import dataclasses
import functools
from typing import Any

import jax
import numpy as np

from .errors import InputError


@functools.cache
def fixed_fields(kind: type) -> dict[str, Any]:
    """Return the default of each field of a class that is no parameter."""
    fields = dataclasses.fields(kind)
    return {f.name: f.default for f in fields if f.metadata.get("static")}


def unusual_fields(part) -> dict[str, Any]:
    """Collect the fields that are no parameters and not at their defaults."""
    usual = fixed_fields(type(part))
    values = ((name, getattr(part, name)) for name in usual)
    return {n: v for n, v in values if (type(v), v) != (type(usual[n]), usual[n])}


def check_fixed_fields(part) -> None:
    """Raise InputError for an array, which cannot be compared."""
    kind = type(part)
    for name in fixed_fields(kind):
        if isinstance(getattr(part, name), np.ndarray | jax.Array):
            raise InputError(
                f"{kind.__name__}.{name} is an array, but no parameter; write a tuple "
                "of numbers, or a constant of the module"
            )

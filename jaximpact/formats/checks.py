"""Checks at the boundary: values that a scene may have, and names that are chosen."""

import dataclasses
from collections.abc import Collection, Iterable

import numpy as np

from .._jax_internals import Tracer
from ..errors import InputError, nearest
from ..scene import PARTS, Scene
from .columns import column_of_field


def check_scene(scene: Scene, *, batched: bool = False) -> None:
    """Raise ValueError, in one sentence, for the first value that is out of range.

    Values that are being traced by JAX cannot be looked at and pass.

    Args:
        scene: what to check.
        batched: allow arrays; else every field must be a scalar.
    """
    for part in PARTS:
        owner = getattr(scene, part)
        for field in dataclasses.fields(owner):
            value = getattr(owner, field.name)
            name = f"{type(owner).__name__}.{field.name}"
            if np.ndim(value) > 0 and not batched:
                raise ValueError(
                    f"{name} must be a scalar, but has shape {np.shape(value)}; use "
                    "simulate_batch, or jax.vmap around simulate, for many scenes"
                )
            if isinstance(value, Tracer):
                continue
            column = column_of_field(part, field.name)
            values = np.asarray(value) / column.factor
            bad = ~column.is_allowed(values)
            if np.any(bad):
                where = f" (scene {int(np.argmax(bad))})" if np.ndim(value) else ""
                raise ValueError(
                    f"{name} must be {column.requirement}, but is "
                    f"{float(np.ravel(values)[np.argmax(bad)]):g}{where}"
                )


def checked_names(
    kind: str, names: Iterable[str], known: Collection[str]
) -> tuple[str, ...]:
    """The names, of a `kind` in one word. Raises InputError for a name that is unknown,
    with the nearest known, or stands twice, and for none."""
    if isinstance(names, str):
        raise InputError(f"{kind}s must be a list of names, but is {names!r}")
    names = tuple(names)
    if not names:
        raise InputError(f"at least one {kind} is needed, but none is given")
    for name in names:
        if not isinstance(name, str) or name not in known:
            raise InputError(
                f"{kind} {name} is unknown; did you mean {nearest(name, known)}?"
            )
        if names.count(name) > 1:
            raise InputError(f"{kind} {name} stands twice; remove one")
    return names

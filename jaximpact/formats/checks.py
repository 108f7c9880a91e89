"""Checks at the boundary: values that a scene may have, and names that are chosen."""

import functools
import math
import os
import warnings
from collections.abc import Collection, Iterable

import jax
import numpy as np
from numpy.typing import ArrayLike

from .._jax_internals import Tracer
from ..block import Block
from ..errors import InputError, UnusualValueWarning
from ..fields import expect, real_numbers
from ..identity import is_ours
from ..laws.checking import check_law
from ..parameters import parts_of
from ..scene import Impact, Scene
from ..shapes.checking import check_shape
from ..soil import Soil
from .columns import (
    INPUT_COLUMNS,
    RESULT_COLUMNS,
    InputColumn,
    columns_of,
    leaf_places,
    why_unknown,
)

KINDS = {"block": Block, "soil": Soil, "impact": Impact}
MEMORY = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
"""Of this machine [bytes]."""
NUMBERS_PER_IMPACT = len(INPUT_COLUMNS) + len(RESULT_COLUMNS)
"""At the least: what a batch takes and gives."""


def check_scene(
    scene: Scene, *, batched: bool = False, warn: bool = False, of: str = "scene"
) -> None:
    """Raise InputError, in one sentence, for the first value that is out of range, and
    for a part of another kind.

    Values that are being traced by JAX cannot be looked at and pass.

    Args:
        scene: what to check.
        batched: allow arrays; else every field must be a scalar.
        warn: also of values that are unusual, in the name of the caller's caller.
        of: what an entry of an array is called.
    """
    expect("scene", scene, Scene)
    for part, kind in KINDS.items():
        expect(part, getattr(scene, part), kind)
    check_laws(jax.tree.structure(scene.soil))
    check_shape(scene.block.shape)
    for column in columns_of(scene).values():
        value = getattr(getattr(scene, column.part), column.field)
        name = f"{KINDS[column.part].__name__}.{column.field}"
        if np.ndim(value) > 0 and not batched:
            raise InputError(
                f"{name} must be a scalar, but has shape {np.shape(value)}; use "
                "simulate_batch, or jax.vmap around simulate, for many scenes"
            )
        if isinstance(value, Tracer) or not np.size(value):
            continue
        _check_field(name, column, value, warn=warn, of=of)


def sound_values(structure: jax.tree_util.PyTreeDef, leaves: list) -> np.ndarray | None:
    """The numbers of a single impact, if `check_scene` has nothing to say of them; None
    also where that would have to look closer. A tenth of its time.

    Args:
        structure, leaves: of the scene.
    """
    limits = _limits(structure)
    if limits is None or any(isinstance(leaf, Tracer) for leaf in leaves):
        return None
    try:
        values = np.array(leaves, float)
    except ValueError:  # of several shapes
        return None
    sound = values.ndim == 1 and np.all((limits[0] <= values) & (values <= limits[1]))
    return values if sound else None


@functools.lru_cache(maxsize=256)
def _limits(structure: jax.tree_util.PyTreeDef) -> tuple[np.ndarray, ...] | None:
    """Least and largest usual values of the leaves of a scene, in SI; None where parts
    are not the package's own."""
    scene = jax.tree.unflatten(structure, list(range(structure.num_leaves)))
    if not isinstance(scene, Scene) or not all(
        isinstance(getattr(scene, part), kind) for part, kind in KINDS.items()
    ):
        return None
    parts = [getattr(scene.soil, slot) for slot in parts_of(Soil)]
    if not all(is_ours(type(part)) for part in (*parts, scene.block.shape)):
        return None
    places = leaf_places(scene)
    low, high = np.full((2, structure.num_leaves), np.nan)  # no limits: not looked at
    for name, column in columns_of(scene).items():
        ends = [
            (column.lower, column.lower_allowed, math.inf),
            (column.upper, column.upper_allowed, -math.inf),
        ]
        # An end that is left out, and infinity, are inside of the next number.
        least, most = (
            end if allowed and math.isfinite(end) else math.nextafter(end, inwards)
            for end, allowed, inwards in ends
        )
        low[places[name]] = max(least, column.usual[0]) * column.factor
        high[places[name]] = min(most, column.usual[1]) * column.factor
    return low, high


def check_times(
    name: str, times: ArrayLike, lanes: tuple[int, ...]
) -> tuple[np.ndarray | jax.Array, tuple[int, ...]]:
    """Times at which histories are wanted, as float64 numbers, and the shape of the
    impacts by times and scenes.

    Raises InputError for what is no series of numbers, for NaN, and for axes before
    that of time that do not broadcast with those of the scenes.

    Args:
        name: what an error calls them. lanes: shape of the scenes.
    """
    times = real_numbers(name, times)
    if not times.ndim:
        raise InputError(f"{name} must be a series of times, but is one: {times}")
    try:
        shape = np.broadcast_shapes(lanes, times.shape[:-1])
    except ValueError:
        raise InputError(
            f"{name} has the shape {times.shape}; need (times,), or axes before that "
            f"of time that broadcast with those of the scenes, {lanes}"
        ) from None
    if isinstance(times, Tracer):
        return times.astype(float), shape
    times = np.asarray(times, float)
    if np.any(np.isnan(times)):
        place = int(np.argmax(np.isnan(times)))
        raise InputError(f"{name} must be times in seconds, but time {place} is NaN")
    return times, shape


@functools.lru_cache(maxsize=256)
def check_laws(structure: jax.tree_util.PyTreeDef) -> None:
    """Raise InputError, naming the law, what it does and the cure, for a law of a
    user's that the model cannot use.

    Args:
        structure: of a soil.
    """
    soil = jax.tree.unflatten(structure, list(range(structure.num_leaves)))
    for slot in parts_of(Soil):
        law = getattr(soil, slot)
        if not is_ours(type(law)):
            check_law(slot, law)


def _check_field(
    name: str,
    column: InputColumn,
    value: ArrayLike,
    *,
    warn: bool,
    of: str,
) -> None:
    """Raise InputError for the first value of a field, in SI, that its column may not
    hold.

    Args:
        name: what messages call it.
        warn: also of values that are unusual, in the name of the caller of the caller's
            caller.
        of: what an entry of an array is called.
    """
    values = np.asarray(value)
    # Both ends tell whether there is anything to look for; NaN is both.
    ends = (values,) if values.ndim == 0 else (np.min(values), np.max(values))
    low, high = float(ends[0]) / column.factor, float(ends[-1]) / column.factor
    if not (column.holds(low) and column.holds(high)):
        bad = ~column.is_allowed(values / column.factor)
        raise InputError(
            f"{name} must be {column.requirement}, but is "
            f"{_told(column, values, bad, of)}"
        )
    if warn and not (column.is_usual(low) and column.is_usual(high)):
        inside = values / column.factor
        bad = (inside < column.usual[0]) | (inside > column.usual[1])
        text = f"{name} is {_told(column, values, bad, of)}"
        warnings.warn(UnusualValueWarning(text, column.name), stacklevel=4)


def _told(column: InputColumn, values: np.ndarray, bad: np.ndarray, of: str) -> str:
    """The first of the bad values, with its place."""
    place, more = int(np.argmax(bad)), np.count_nonzero(bad) - 1
    where = f" ({of} {place}" + (f" and {more} more)" if more else ")")
    value = float(np.ravel(values)[place])
    return column.told(value, column.si_unit, where if values.ndim else "")


def check_memory(numbers: float, what: str, **place) -> None:
    """Raise InputError unless so many numbers fit into this machine's memory.

    Args:
        numbers: how many of eight bytes there will be, at the least.
        what: what they are of, to stand before "would take".
        place: file, row, column and key of the error.
    """
    needed = 8.0 * numbers
    if needed > MEMORY:
        raise InputError(
            f"{what} would take {needed / 2**30:.3g} GiB of memory or more, but this "
            f"machine has {MEMORY / 2**30:.3g} GiB",
            **place,
        )


def checked_names(
    kind: str, names: Iterable[str], known: Collection[str]
) -> tuple[str, ...]:
    """The names, of a `kind` in one word. Raises InputError for a name that is unknown,
    with what may have been meant, or stands twice, and for none."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise InputError(f"{kind}s must be a list of names, but is {names!r}")
    names = tuple(names)
    if not names:
        raise InputError(f"at least one {kind} is needed, but none is given")
    for name in names:
        if not isinstance(name, str) or name not in known:
            raise InputError(f"{kind} {name} is unknown; {why_unknown(name, known)}")
        if names.count(name) > 1:
            raise InputError(f"{kind} {name} stands twice; remove one")
    return names

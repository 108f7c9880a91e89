"""Checks at the boundary: values that a scene may have, and names that are chosen."""

import contextlib
import functools
import math
import os
import warnings
from collections.abc import Collection, Iterable, Mapping
from typing import Any

import jax
import numpy as np
from numpy.typing import ArrayLike

from .._checks import expect, real_numbers
from .._jax_internals import Tracer, broadcast_shapes
from ..errors import InputError, UnusualValueWarning
from ..identity import heed_edits, is_ours
from ..parameters import parts_of
from ..part_checks import check_part
from ..quantities import (
    INPUT_COLUMNS,
    RESULT_COLUMNS,
    InputColumn,
    columns_of,
    leaf_places,
    why_unknown,
)
from ..scene import KINDS, Scene, Soil
from ..units import UNITS


def _memory() -> float:
    """Return the memory of this machine [bytes]; infinite where nothing tells."""
    with contextlib.suppress(AttributeError, ValueError, OSError):
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    # Windows, where psutil is among the dependencies
    with contextlib.suppress(ImportError, AttributeError, OSError):
        import psutil

        return psutil.virtual_memory().total
    return math.inf


MEMORY = _memory()
"""Memory of this machine [bytes]."""
NO_DATA = (
    *(1.0 - 10.0**digits for digits in range(4, 10)),
    *(-32768.0, -32767.0, -2147483648.0, -2147483647.0, -1e20),
    *(float(np.float32(-3.4028235e38)), -3.4028235e38, -3.4e38),
)
"""Numbers that programs write where nothing was measured."""
NUMBERS_PER_IMPACT = len(INPUT_COLUMNS) + len(RESULT_COLUMNS)
"""Least count of numbers that a batch takes and gives for each impact."""


def check_scene(
    scene: Scene,
    *,
    batched: bool = False,
    warn: bool = False,
    of: str = "scene",
    laws: bool = True,
) -> None:
    """Raise InputError, in one sentence, for the first value that is out of range, and
    for a part of another kind. Values that JAX traces are not known and pass.

    Args:
        batched: allow arrays; else every field must be a scalar.
        warn: also warn of unusual values, in the name of the caller's caller.
        of: what messages call an entry of an array.
        laws: also try laws of the user's, which takes half a second in each process.
    """
    expect("scene", scene, Scene)
    for part, kind in KINDS.items():
        expect(part, getattr(scene, part), kind)
    heed_edits(jax.tree.structure(scene))
    if laws:
        for slot in parts_of(Soil):
            check_part(slot, getattr(scene.soil, slot))
    check_part("shape", scene.block.shape)
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
        check_field(name, column, value, warn=warn, of=of)


def usual_values(structure: Any, leaves: list) -> Any:
    """Return the numbers of a single impact, from a scene as a pytree, if all that JAX
    does not trace are usual; None where `check_scene` has to look closer. Takes a tenth
    of its time."""
    limits = _limits(structure)
    if limits is None:
        return None
    low, high = limits
    known, traced = [], []
    for place, leaf in enumerate(leaves):
        if getattr(leaf, "ndim", 0):
            return None
        if isinstance(leaf, Tracer):
            traced.append(place)
            known.append(low[place])
        else:
            # `float` of an array of JAX takes ten times as long.
            known.append(np.asarray(leaf))
    values = np.array(known, float)
    if not np.all((low <= values) & (values <= high)):
        return None
    if not traced:
        return values
    kept: list = values.tolist()
    for place in traced:
        kept[place] = leaves[place]
    return kept


@functools.lru_cache(maxsize=256)
def _limits(structure: Any) -> tuple[np.ndarray, ...] | None:
    """Compute the least and largest usual values of the leaves of a scene, in SI; None
    where parts are not the package's own."""
    scene = jax.tree.unflatten(structure, list(range(structure.num_leaves)))
    if not isinstance(scene, Scene) or not all(
        isinstance(getattr(scene, part), kind) for part, kind in KINDS.items()
    ):
        return None
    parts = [getattr(scene.soil, slot) for slot in parts_of(Soil)]
    if not all(is_ours(type(part)) for part in (*parts, scene.block.shape)):
        return None
    places = leaf_places(scene)
    # What has no limits is not within them: NaN compares with nothing.
    low, high = np.full((2, structure.num_leaves), np.nan)
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
    times: ArrayLike, lanes: tuple[int, ...]
) -> tuple[np.ndarray | jax.Array, tuple[int, ...]]:
    """Return the times at which histories are wanted, as float64 numbers, and the shape
    of the impacts by times and scenes, of which `lanes` is the shape.

    Raises InputError for what is no series of numbers, for NaN, and for axes before
    that of time that do not broadcast with those of the scenes.
    """
    times = real_numbers("save_at", times)
    if not times.ndim:
        raise InputError(f"save_at must be a series of times, but is one: {times}")
    try:
        shape = broadcast_shapes(lanes, times.shape[:-1])
    except ValueError:
        raise InputError(
            f"save_at has the shape {times.shape}; need (times,), or axes before that "
            f"of time that broadcast with those of the scenes, {lanes}"
        ) from None
    if isinstance(times, Tracer):
        return times.astype(float), shape
    times = np.asarray(times, float)
    if np.any(np.isnan(times)):
        index = int(np.argmax(np.isnan(times)))
        raise InputError(f"save_at must be times in seconds, but time {index} is NaN")
    return times, shape


def check_units(name: str, column: InputColumn, values: Any) -> None:
    """Raise InputError where values say, in an attribute `units` as those of xarray
    have, that they are in another unit than their column's. Words that are unknown, of
    which many mean the same, say nothing."""
    attributes = getattr(values, "attrs", None)
    said = attributes.get("units") if isinstance(attributes, Mapping) else None
    known = {unit for alike in UNITS.values() for unit in alike}
    if isinstance(said, str) and said in known - {column.unit}:
        raise InputError(
            f"{name} must have the unit {column.unit!r}, but its attribute units says "
            f"{said!r}; convert the numbers, or correct the attribute"
        )


def check_field(
    name: str, column: InputColumn, value: ArrayLike, *, warn: bool, of: str
) -> None:
    """Raise InputError for the first value of a field, in SI, that its column may not
    hold; otherwise warn of the first unusual one, in the name of the caller of the
    caller's caller."""
    values = np.asarray(value)
    # Both ends tell whether there is anything to look for; NaN is both.
    ends = np.array([np.min(values), np.max(values)]) / column.factor

    def describe_first(bad: np.ndarray) -> str:
        """Name the first of the bad values, with its index."""
        index, more = int(np.argmax(bad)), np.count_nonzero(bad) - 1
        where = f" ({of} {index}" + (f" and {more} more)" if more else ")")
        first = float(np.ravel(values)[index])
        return column.describe(first, column.si_unit, where if values.ndim else "")

    if not np.all(column.is_allowed(ends)):
        bad = ~column.is_allowed(values / column.factor)
        needed = column.requirement_of(np.ravel(values)[np.argmax(bad)])
        raise InputError(f"{name} must be {needed}, but is {describe_first(bad)}")
    if warn and np.any(column.is_unusual(ends)):
        text = f"{name} is {describe_first(column.is_unusual(values / column.factor))}"
        warnings.warn(UnusualValueWarning(text, column.name), stacklevel=4)


def warn_unusual(problem: str, quantity: str, **place) -> None:
    """Warn of an unusual value; at its place, which is worded as in an InputError."""
    text = str(InputError(problem, **place))
    warnings.warn(UnusualValueWarning(text, quantity), stacklevel=2)


def check_memory(numbers: float, what: str, **place) -> None:
    """Raise InputError unless so many numbers of eight bytes, at least, fit into this
    machine's memory.

    Args:
        what: what they belong to, to stand before "would take".
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
    """Return the names of some `kind`, as a tuple. Raises InputError for a name that is
    unknown, with what may have been meant, or stands twice, and for no names."""
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

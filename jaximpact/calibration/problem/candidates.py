"""Candidates for further tests, and how well their results could be measured."""

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..._checks import real_numbers
from ...errors import InputError, did_you_mean
from ...io.checks import NUMBERS_PER_IMPACT, check_memory
from ...io.toml import Key, check_keys, choice, known_table, number, typed, whole
from ...quantities import CURVE_COLUMNS, TARGET_COLUMNS, InputColumn, why_unknown

KEYS = ("candidates", "measure", "count", "criterion")
"""Keys of the table `further_tests`."""
CRITERIA = ("D", "A")
COUNT = 3
MOST = 1000
"""Largest number of further tests."""


class Sigma(NamedTuple):
    """Standard deviation of a measurement: root of the sum of both squares."""

    absolute: float = 0.0
    """Absolute part [unit of the result's column]."""
    relative: float = 0.0
    """Fraction of the predicted value."""

    def __str__(self) -> str:
        parts = [f"{self.absolute:.3g}"] if self.absolute else []
        parts += [f"{100 * self.relative:.3g} %"] if self.relative else []
        return " and ".join(parts)


@dataclasses.dataclass(frozen=True)
class Candidates:
    """Further tests as a study states them."""

    axes: dict[str, np.ndarray] | None = None
    """Quantities of block and impact with their values; None for the defaults."""
    measure: dict[str, Sigma] | None = None
    """Results that can be measured; None for the defaults."""
    count: int = COUNT
    criterion: str = CRITERIA[0]


def checked_axes(
    candidates: Mapping[str, ArrayLike],
    fitted: tuple[str, ...],
    columns: Mapping[str, InputColumn],
    *,
    key: str = "candidates",
    file: Path | None = None,
) -> dict[str, np.ndarray]:
    """Check the values of each quantity, a column of the scene.

    Raises InputError, naming key and file, for a quantity that is unknown, fitted or
    out of range.
    """
    axes = {}
    for name, stated in candidates.items():
        place = {"file": file, "key": f"{key}.{name}"}
        if name not in columns:
            raise InputError(f"is unknown; {why_unknown(name, columns)}", **place)
        if name in fitted:
            raise InputError("is fitted; a test cannot choose it", **place)
        column = columns[name]
        try:
            values = np.atleast_1d(real_numbers(name, stated))
        except InputError:
            values = np.empty(0)
        if values.ndim != 1 or not values.size or not np.all(column.is_allowed(values)):
            raise InputError(
                f"must hold numbers {column.requirement}, but is {stated!r}", **place
            )
        axes[name] = values
    size = math.prod(map(len, axes.values()))
    check_memory(size * NUMBERS_PER_IMPACT, f"{size} candidates", file=file, key=key)
    return axes


def checked_measure(
    measure: Mapping[str, float | Sigma], *, key: str = "measure", file=None
) -> dict[str, Sigma]:
    """Check the sigma of each result.

    Raises InputError for a result that is unknown, or without a sigma above 0.
    """
    sigmas = {}
    for name, stated in measure.items():
        place = {"file": file, "key": f"{key}.{name}"}
        if name not in TARGET_COLUMNS or name in CURVE_COLUMNS:
            raise InputError(
                f"is unknown; {did_you_mean(name, TARGET_COLUMNS)}", **place
            )
        sigma = stated if isinstance(stated, Sigma) else Sigma(absolute=float(stated))
        if not (min(sigma) >= 0.0 and 0.0 < max(sigma) < np.inf):
            raise InputError(f"needs a sigma above 0, but it is {stated}", **place)
        sigmas[name] = sigma
    return sigmas


def read_candidates(
    top: Key, content: dict, fitted: tuple[str, ...], columns: Mapping[str, InputColumn]
) -> Candidates:
    """Read the table `further_tests` of a study with these fitted parameters and
    columns of the scene."""
    key = top["further_tests"]
    entries = known_table(top, content, "further_tests", KEYS)
    candidates = typed(key, entries, "candidates", dict, {})
    axes = checked_axes(candidates, fitted, columns, **key["candidates"].place)
    sigmas = {
        name: _sigma(key["measure"][name], entry)
        for name, entry in typed(key, entries, "measure", dict, {}).items()
    }
    return Candidates(
        axes or None,
        checked_measure(sigmas, **key["measure"].place) or None,
        whole(key, entries, "count", COUNT, 1, MOST),
        choice(key, entries, "criterion", CRITERIA[0], CRITERIA),
    )


def _sigma(key: Key, entry) -> Sigma:
    """Read a number, or a table like { absolute = 0.01, relative = 0.1 }."""
    if not isinstance(entry, dict):
        return Sigma(absolute=number(key, entry))
    check_keys(key, entry, Sigma._fields)
    return Sigma(**{n: number(key[n], v) for n, v in entry.items()})

"""Over what a parameter varies."""

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError, nearest
from ..fields import expect, real_number
from ..formats.columns import InputColumn
from ..scene import Scene
from .names import parameter_columns

UNIFORM, LOG_UNIFORM = DISTRIBUTIONS = ("uniform", "log-uniform")


@dataclasses.dataclass(frozen=True)
class Range:
    """Values that a parameter may have, in the unit of its column.

    Between `lower` and `upper`, all equally likely ("uniform"), or all their logarithms
    ("log-uniform"): for what is known to a factor, such as a stiffness.
    """

    lower: float
    upper: float
    distribution: str = UNIFORM

    def values(self, share: ArrayLike) -> np.ndarray:
        """The value below which a share of the range lies, 0 to 1."""
        share = np.asarray(share, float)
        if self.distribution == LOG_UNIFORM:
            values = self.lower * (self.upper / self.lower) ** share
        else:
            values = self.lower + share * (self.upper - self.lower)
        # Rounding must not pass the end of what is allowed.
        return np.clip(values, self.lower, self.upper)


def check_ranges(
    scene: Scene, ranges: Mapping[str, Range | tuple[float, float]]
) -> dict[str, Range]:
    """The ranges of parameters of a scene by the names of their columns; a pair is
    uniform.

    Raises InputError for an unknown name, ends out of the column's range or in the
    wrong order, an unknown distribution, and for fewer than two parameters.
    """
    expect("ranges", ranges, Mapping)
    checked = {}
    for column in parameter_columns(scene, ranges):
        given = ranges[column.name]
        if not isinstance(given, Range):
            try:
                lower, upper = given
            except (TypeError, ValueError):
                raise InputError(
                    f"the range of {column.name} must be Range(lower, upper) or a pair "
                    f"of numbers, but is {given!r}"
                ) from None
            given = Range(lower, upper)
        check_range(column, given)
        checked[column.name] = given
    if len(checked) < 2:
        raise InputError(
            "at least two parameters must vary together, but there is only "
            f"{next(iter(checked))}"
        )
    return checked


def check_range(column: InputColumn, given: Range) -> None:
    """Raise InputError unless it is a range of that column."""
    name = column.name
    if given.distribution not in DISTRIBUTIONS:
        raise InputError(
            f"the distribution of {name} must be one of {', '.join(DISTRIBUTIONS)}, "
            f"but is {given.distribution!r}; did you mean "
            f"{nearest(given.distribution, DISTRIBUTIONS)}?"
        )
    for name_of_end in ("lower", "upper"):
        end = real_number(f"{name_of_end} of {name}", getattr(given, name_of_end))
        if not column.is_allowed(end):
            raise InputError(
                f"{name} must be {column.requirement}, but ranges to {end:g}"
            )
    if not given.lower < given.upper:
        raise InputError(
            f"the range of {name} must run upwards, but runs from {given.lower:g} to "
            f"{given.upper:g}"
        )
    if given.distribution == LOG_UNIFORM and not given.lower > 0.0:
        raise InputError(
            f"the range of {name} must begin above 0 to be {LOG_UNIFORM}, but begins "
            f"at {given.lower:g}"
        )

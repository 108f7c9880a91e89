"""Parameters that vary, the ranges over which they do, and outputs, by the names of
the tables."""

import dataclasses
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from .._checks import expect, real_number
from ..errors import InputError, check_choice
from ..io.checks import checked_names
from ..io.datasets import OUTPUT_COLUMNS
from ..quantities import RESULT_COLUMNS, InputColumn, ResultColumn, columns_of
from ..scene import Scene

UNIFORM, LOG_UNIFORM = DISTRIBUTIONS = ("uniform", "log-uniform")
USUAL_PARAMETERS = ("c_v", "gamma_v", "k_E")
DEFAULT_OUTPUTS = tuple(RESULT_COLUMNS)
WATCHED = {name: c for name, c in OUTPUT_COLUMNS.items() if name != "steps"}
"""Outputs that may be asked for: the numbers of the impact, not of its integration."""


def default_parameters(scene: Scene) -> tuple[str, ...]:
    """Return those of c_v, gamma_v and k_E that the scene's laws have."""
    columns = columns_of(scene)
    names = tuple(name for name in USUAL_PARAMETERS if name in columns)
    if not names:
        raise InputError(
            f"parameters must be named, as the scene's laws have none of "
            f"{', '.join(USUAL_PARAMETERS)}"
        )
    return names


def parameter_columns(scene: Scene, names: Iterable[str]) -> tuple[InputColumn, ...]:
    """Return the columns of parameters of a scene. Raises InputError for a name that is
    unknown or stands twice, and for none."""
    columns = columns_of(scene)
    names = checked_names("parameter", names, columns)
    return tuple(columns[name] for name in names)


def output_columns(names: Iterable[str]) -> tuple[ResultColumn, ...]:
    """Return the columns of outputs. Raises InputError as `parameter_columns` does."""
    return tuple(WATCHED[name] for name in checked_names("output", names, WATCHED))


def axes_of_names(
    inputs: tuple[InputColumn, ...], results: tuple[ResultColumn, ...]
) -> dict:
    """Return the coordinates of a dataset over parameters and outputs: names, units."""
    return {
        "parameter": [column.name for column in inputs],
        "output": [column.name for column in results],
        "parameter_unit": ("parameter", [column.unit for column in inputs]),
        "output_unit": ("output", [column.unit for column in results]),
    }


@dataclasses.dataclass(frozen=True)
class Range:
    """Distribution of a parameter between two ends, in the unit of its column.

    "uniform", or "log-uniform" (uniform in the logarithm) for what is known to a
    factor, such as a stiffness.
    """

    lower: float
    """Lower end."""
    upper: float
    """Upper end."""
    distribution: str = UNIFORM
    """ "uniform" or "log-uniform"."""

    def values(self, fraction: ArrayLike) -> np.ndarray:
        """Return the quantiles of the distribution, for fractions 0 to 1."""
        fraction = np.asarray(fraction, float)
        if self.distribution == LOG_UNIFORM:
            values = self.lower * (self.upper / self.lower) ** fraction
        else:
            values = self.lower + fraction * (self.upper - self.lower)
        # Rounding must not pass the end of what is allowed.
        return np.clip(values, self.lower, self.upper)


def check_ranges(
    scene: Scene, ranges: Mapping[str, Range | tuple[float, float]]
) -> dict[str, Range]:
    """Check the ranges of parameters of a scene, by the names of their columns, and
    return them; a pair of numbers is a uniform range. At least two are needed."""
    expect("ranges", ranges, Mapping)
    checked = {}
    for column in parameter_columns(scene, ranges):
        interval = ranges[column.name]
        if not isinstance(interval, Range):
            try:
                lower, upper = interval
            except (TypeError, ValueError):
                raise InputError(
                    f"the range of {column.name} must be Range(lower, upper) or a pair "
                    f"of numbers, but is {interval!r}"
                ) from None
            interval = Range(lower, upper)
        _check_range(column, interval)
        # Python's numbers, which attributes of a dataset can hold.
        ends = float(interval.lower), float(interval.upper)
        checked[column.name] = Range(*ends, interval.distribution)
    if len(checked) < 2:
        raise InputError(
            "at least two parameters must vary together, but there is only "
            f"{next(iter(checked))}"
        )
    return checked


def _check_range(column: InputColumn, interval: Range) -> None:
    name = column.name
    check_choice(f"the distribution of {name}", interval.distribution, DISTRIBUTIONS)
    for name_of_end in ("lower", "upper"):
        end = real_number(f"{name_of_end} of {name}", getattr(interval, name_of_end))
        if not column.is_allowed(end):
            raise InputError(
                f"{name} must be {column.requirement}, but ranges to {end:g}"
            )
    if not interval.lower < interval.upper:
        raise InputError(
            f"the range of {name} must run upwards, but runs from "
            f"{interval.lower:g} to {interval.upper:g}"
        )
    if interval.distribution == LOG_UNIFORM and not interval.lower > 0.0:
        raise InputError(
            f"the range of {name} must begin above 0 to be {LOG_UNIFORM}, but begins "
            f"at {interval.lower:g}"
        )

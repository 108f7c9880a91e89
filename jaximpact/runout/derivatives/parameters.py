"""Parameters with respect to which a run-out can be differentiated.

A parameter shifts a run-out: by a number, for a difference, or by zero with a
derivative of one (`Dual`), to carry derivatives.
"""

import copy
import dataclasses
import operator
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from ...io.checks import checked_names
from ...parameters import Composite, Part
from ...quantities import InputColumn, columns_of_part, own_columns
from ...units import DEGREE
from ..blocks import Release
from ..contacts.contact_models import ClosedForm, FullModel
from ..dual import Dual, primal
from ..terrain import ROLLING_COLUMN, Ground, Profile


class Case(NamedTuple):
    """Run-out to compute."""

    profile: Profile
    release: Release
    contacts: FullModel | ClosedForm
    ground: Ground


Amount = np.ndarray | float | Dual


@dataclasses.dataclass(frozen=True)
class Parameter:
    """Parameter of a run-out."""

    name: str
    unit: str
    factor: float
    """SI value over the value in the unit."""
    value: Callable[[Case], np.ndarray]
    """Gives the value in SI units: one number, or one for each block, segment, or
    both."""
    shift: Callable[[Case, Amount], Case]
    """Adds an amount, in SI units, to the parameter of a case; unchecked."""
    column: InputColumn | None = None
    """Gives the range of allowed values, where there is one."""
    of_blocks: bool = False
    """True if each block has its own value."""

    def size(self, case: Case) -> np.ndarray:
        """Give the scale of its steps: its own value, averaged over the ground, or one
        unit where that is zero; one radian for angles. One number, or one for each
        block where each has its own."""
        if self.unit == "deg":
            return np.ones(())
        values = np.abs(self.value(case))
        values = values if self.of_blocks else np.mean(values)
        return np.where(values > 0.0, values, self.factor)

    def allows(self, case: Case) -> bool:
        """Tell whether its values in a case are in range."""
        if self.column is None:
            return True
        return bool(np.all(self.column.is_allowed(self.value(case) / self.factor)))


def chosen_parameters(case: Case, names: Iterable[str]) -> tuple[Parameter, ...]:
    """Look up parameters by name. Raises InputError for a name that is unknown, with
    the nearest known, or stands twice, and for none."""
    known = _known(case)
    return tuple(known[name] for name in checked_names("parameter", names, known))


def replaced(instance: Any, **fields) -> Any:
    """Copy an instance with other fields, unchecked: they may carry derivatives."""
    other = copy.copy(instance)
    for name, value in fields.items():
        object.__setattr__(other, name, value)
    return other


def _known(case: Case) -> dict[str, Parameter]:
    known = [
        *_fields("soil", "ground.soil", case.ground.soil),
        _ROLLING,
        *_fields("block", "release.block", case.release.block, of_blocks=True),
        *_OF_RELEASE,
    ]
    law = getattr(case.contacts, "law", None)
    if isinstance(law, Part):
        known += [
            _field(f"contacts.law.{c.field}", c.name, c.unit, c.factor, c)
            for c in own_columns(type(law))
        ]
    return {parameter.name: parameter for parameter in known}


def _field(
    path: str,
    name: str,
    unit: str,
    factor: float = 1.0,
    column: InputColumn | None = None,
    of_blocks: bool = False,
) -> Parameter:
    """Describe a field that lies in a case at a path of names; all its values shift
    alike."""
    get = operator.attrgetter(path)
    part, *inner = path.split(".")

    def value(case: Case) -> np.ndarray:
        return np.asarray(get(case))

    def shift(case: Case, amount: Amount) -> Case:
        shifted = _with(getattr(case, part), inner, value(case) + amount)
        return case._replace(**{part: shifted})

    return Parameter(name, unit, factor, value, shift, column, of_blocks)


def _with(owner, path: list[str], value):
    """Copy an object with another value at a path in it."""
    name, *inner = path
    if inner:
        value = _with(getattr(owner, name), inner, value)
    return replaced(owner, **{name: value})


def _fields(
    part: str, path: str, whole: Composite, of_blocks: bool = False
) -> list[Parameter]:
    """Describe the parameters of a part of the scene."""
    return [
        _field(
            ".".join((path, *whole.path_of(c.field))),
            *(c.name, c.unit, c.factor, c, of_blocks),
        )
        for c in columns_of_part(part, whole).values()
    ]


def _speed(case: Case) -> np.ndarray:
    return np.hypot(primal(case.release.v_x), primal(case.release.v_y))


def _direction(case: Case) -> np.ndarray:
    return np.arctan2(primal(case.release.v_y), primal(case.release.v_x))


def _shift_speed(case: Case, amount: Amount) -> Case:
    release, direction = case.release, _direction(case)
    return case._replace(
        release=replaced(
            release,
            v_x=release.v_x + np.cos(direction) * amount,
            v_y=release.v_y + np.sin(direction) * amount,
        )
    )


def _shift_direction(case: Case, amount: Amount) -> Case:
    release, cos, sin = case.release, np.cos(amount), np.sin(amount)
    return case._replace(
        release=replaced(
            release,
            v_x=release.v_x * cos - release.v_y * sin,
            v_y=release.v_x * sin + release.v_y * cos,
        )
    )


_ROLLING = _field("ground.rolling_friction_angle", ROLLING_COLUMN, "deg", DEGREE)
_OF_RELEASE = [
    _field("release.x", "x_m", "m", of_blocks=True),
    _field("release.y", "y_m", "m", of_blocks=True),
    Parameter("speed_mps", "m/s", 1.0, _speed, _shift_speed, of_blocks=True),
    Parameter(
        "direction_deg", "deg", DEGREE, _direction, _shift_direction, of_blocks=True
    ),
    _field("release.orientation", "orientation_deg", "deg", DEGREE, of_blocks=True),
    _field(
        *("release.angular_velocity", "angular_velocity_degps", "deg/s", DEGREE),
        of_blocks=True,
    ),
]

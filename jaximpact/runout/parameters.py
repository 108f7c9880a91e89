"""By what a run-out can be differentiated.

A parameter is told by how it moves a run-out: by a number, to see what comes of it, or
by nothing with a derivative of one (`Dual`), to carry derivatives.
"""

import copy
import dataclasses
import operator
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from ..formats.checks import checked_names
from ..formats.columns import InputColumn, columns_of_part, own_columns
from ..parameters import Composite, Part
from ..units import DEGREE
from .dual import Dual, plain
from .ground import Ground
from .profile import ROLLING_COLUMN, Profile
from .rebounds import Contacts
from .release import Release


class Case(NamedTuple):
    """A run-out to be computed."""

    profile: Profile
    release: Release
    contacts: Contacts
    ground: Ground


Amount = np.ndarray | float | Dual


@dataclasses.dataclass(frozen=True)
class Parameter:
    """Something that moves a run-out."""

    name: str
    unit: str
    factor: float
    """SI value = factor x value in the unit."""
    value: Callable[[Case], np.ndarray]
    """In SI units, one number, or one for each block, segment, or both."""
    move: Callable[[Case, Amount], Case]
    """The case with so much more of it, in SI units; not checked."""
    column: InputColumn | None = None
    """Says which values are allowed, where not all are."""
    of_blocks: bool = False
    """Whether each block has its own."""

    def size(self, case: Case) -> np.ndarray:
        """What changes of it are measured by: itself, in the mean over the ground,
        where that is not zero, else one unit; angles by one radian. One number, or one
        for each block where it belongs to them."""
        if self.unit == "deg":
            return np.ones(())
        values = np.abs(self.value(case))
        values = values if self.of_blocks else np.mean(values)
        return np.where(values > 0.0, values, self.factor)

    def allows(self, case: Case) -> bool:
        """Whether its values in a case are in range."""
        if self.column is None:
            return True
        return bool(np.all(self.column.is_allowed(self.value(case) / self.factor)))


def chosen_parameters(case: Case, names: Iterable[str]) -> tuple[Parameter, ...]:
    """The parameters of some names. Raises InputError for a name that is unknown, with
    the nearest known, or stands twice, and for none."""
    known = _known(case)
    return tuple(known[name] for name in checked_names("parameter", names, known))


def replaced(instance, **fields):
    """A copy with other fields, unchecked: they may carry derivatives."""
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
    """A field that lies in a case at a path of names; all its values move alike."""
    get = operator.attrgetter(path)
    part, *inner = path.split(".")

    def value(case: Case) -> np.ndarray:
        return np.asarray(get(case))

    def move(case: Case, amount: Amount) -> Case:
        moved = _with(getattr(case, part), inner, value(case) + amount)
        return case._replace(**{part: moved})

    return Parameter(name, unit, factor, value, move, column, of_blocks)


def _with(owner, path: list[str], value):
    """A copy with another value of what lies at a path in it."""
    name, *inner = path
    if inner:
        value = _with(getattr(owner, name), inner, value)
    return replaced(owner, **{name: value})


def _fields(
    part: str, path: str, whole: Composite, of_blocks: bool = False
) -> list[Parameter]:
    """Those of a part of the scene."""
    return [
        _field(
            ".".join((path, *whole.path_of(c.field))),
            *(c.name, c.unit, c.factor, c, of_blocks),
        )
        for c in columns_of_part(part, whole).values()
    ]


def _speed(case: Case) -> np.ndarray:
    return np.hypot(plain(case.release.v_x), plain(case.release.v_y))


def _direction(case: Case) -> np.ndarray:
    return np.arctan2(plain(case.release.v_y), plain(case.release.v_x))


def _move_speed(case: Case, amount: Amount) -> Case:
    release, direction = case.release, _direction(case)
    return case._replace(
        release=replaced(
            release,
            v_x=release.v_x + np.cos(direction) * amount,
            v_y=release.v_y + np.sin(direction) * amount,
        )
    )


def _turn(case: Case, amount: Amount) -> Case:
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
    Parameter("speed_mps", "m/s", 1.0, _speed, _move_speed, of_blocks=True),
    Parameter("direction_deg", "deg", DEGREE, _direction, _turn, of_blocks=True),
    _field("release.orientation", "orientation_deg", "deg", DEGREE, of_blocks=True),
    _field(
        *("release.angular_velocity", "angular_velocity_degps", "deg/s", DEGREE),
        of_blocks=True,
    ),
]

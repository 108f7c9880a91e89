"""By what a run-out can be differentiated.

A parameter is told by how it moves a run-out: by a number, to see what comes of it, or
by nothing with a derivative of one (`Dual`), to carry derivatives.
"""

import copy
import dataclasses
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from ..formats.checks import checked_names
from ..formats.columns import DEGREE, INPUT_COLUMNS, InputColumn
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
    columns = INPUT_COLUMNS.values()
    known = [_of_soil(column) for column in columns if column.part == "soil"]
    known += [_ROLLING]
    known += [_of_block(column) for column in columns if column.part == "block"]
    known += _OF_RELEASE
    law = getattr(case.contacts, "law", None)
    if dataclasses.is_dataclass(law):
        known += [_of_law(field.name) for field in dataclasses.fields(law)]
    return {parameter.name: parameter for parameter in known}


def _of_soil(column: InputColumn) -> Parameter:
    """A field of the soil, of all segments alike."""

    def move(case: Case, amount: Amount) -> Case:
        soil = case.ground.soil
        moved = getattr(soil, column.field) + amount
        soil = replaced(soil, **{column.field: moved})
        return case._replace(ground=replaced(case.ground, soil=soil))

    return Parameter(
        column.name,
        column.unit,
        column.factor,
        lambda case: getattr(case.ground.soil, column.field),
        move,
        column,
    )


def _of_block(column: InputColumn) -> Parameter:
    def move(case: Case, amount: Amount) -> Case:
        block = case.release.block
        moved = getattr(block, column.field) + amount
        block = replaced(block, **{column.field: moved})
        return case._replace(release=replaced(case.release, block=block))

    return Parameter(
        column.name,
        column.unit,
        column.factor,
        lambda case: getattr(case.release.block, column.field),
        move,
        column,
        of_blocks=True,
    )


def _of_release(name: str, unit: str, field: str, factor: float = 1.0) -> Parameter:
    def move(case: Case, amount: Amount) -> Case:
        moved = getattr(case.release, field) + amount
        return case._replace(release=replaced(case.release, **{field: moved}))

    return Parameter(
        name,
        unit,
        factor,
        lambda case: getattr(case.release, field),
        move,
        of_blocks=True,
    )


def _of_law(field: str) -> Parameter:
    """A field of a law in closed form."""

    def value(case: Case) -> np.ndarray:
        return np.asarray(getattr(case.contacts.law, field))

    def move(case: Case, amount: Amount) -> Case:
        law = replaced(case.contacts.law, **{field: value(case) + amount})
        return case._replace(contacts=replaced(case.contacts, law=law))

    return Parameter(field, "-", 1.0, value, move)


def _move_rolling(case: Case, amount: Amount) -> Case:
    angle = case.ground.rolling_friction_angle + amount
    return case._replace(ground=replaced(case.ground, rolling_friction_angle=angle))


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


_ROLLING = Parameter(
    ROLLING_COLUMN,
    "deg",
    DEGREE,
    lambda case: case.ground.rolling_friction_angle,
    _move_rolling,
)
_OF_RELEASE = [
    _of_release("x_m", "m", "x"),
    _of_release("y_m", "m", "y"),
    Parameter("speed_mps", "m/s", 1.0, _speed, _move_speed, of_blocks=True),
    Parameter("direction_deg", "deg", DEGREE, _direction, _turn, of_blocks=True),
    _of_release("orientation_deg", "deg", "orientation", DEGREE),
    _of_release("angular_velocity_degps", "deg/s", "angular_velocity", DEGREE),
]

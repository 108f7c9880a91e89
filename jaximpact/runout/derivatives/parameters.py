"""Parameters with respect to which a run-out can be differentiated: what a change of
each changes, for differences, and at what rates, for derivatives."""

import copy
import dataclasses
import operator
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import jax
import numpy as np

from ...io.checks import checked_names
from ...parameters import Composite, Part
from ...quantities import InputColumn, columns_of_part, own_columns
from ...units import DEGREE
from ..blocks import Body, Release, select
from ..contacts.contact_models import ClosedForm, FullModel
from ..state import Directions
from ..terrain import ROLLING_COLUMN, Ground, Profile


class Case(NamedTuple):
    """Run-out to compute."""

    profile: Profile
    release: Release
    contacts: FullModel | ClosedForm
    ground: Ground

    def of_blocks(self, chosen: np.ndarray) -> "Case":
        """Select some blocks; one may be chosen several times."""
        release = replaced(
            self.release,
            block=select(self.release.block, chosen),
            **select(self.release.body, chosen)._asdict(),
        )
        return self._replace(release=release, ground=self.ground.of_blocks(chosen))


@dataclasses.dataclass(frozen=True)
class Parameter:
    """Parameter of a run-out."""

    name: str
    unit: str
    factor: float
    """SI value over the value in the unit."""
    part: str
    """Part of a case that holds it: "release", "ground" or "contacts"."""
    value: Callable[[Case], np.ndarray]
    """Gives the value in SI units: one number, or one for each block, segment, or
    both."""
    move: Callable[[Case, np.ndarray], Case]
    """Adds amounts, in SI units, to the parameter of a case; unchecked."""
    rates: Callable[[Case], dict[str, np.ndarray]]
    """Gives the derivatives of the numbers of a case that change with the parameter, by
    their path, such as `release.v_x`; arrays that broadcast to theirs."""
    column: InputColumn | None = None
    """Gives the range of allowed values, where there is one."""

    def size(self, case: Case) -> np.ndarray:
        """Give the scale of its steps: its own value, averaged over the ground, or one
        unit where that is zero; one radian for angles. One number, or one for each
        block where each has its own."""
        if self.unit == "deg":
            return np.ones(())
        values = np.abs(self.value(case))
        values = values if self.part == "release" else np.mean(values)
        return np.where(values > 0.0, values, self.factor)

    def shift(self, case: Case, amounts: np.ndarray) -> Case:
        """Add an amount to the parameter of each block, `(blocks,)`, in SI units;
        unchecked."""
        return self.move(case, amounts[:, None] if self.part == "ground" else amounts)

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


def directions_of(case: Case, parameters: tuple[Parameter, ...]) -> Directions:
    """Compute the derivatives of what a run begins with."""
    rates = [parameter.rates(case) for parameter in parameters]

    def along(path: str, values) -> np.ndarray:
        """Give the derivatives of some values of the case, with as many axes."""
        return np.stack(
            [np.broadcast_to(of.get(path, 0.0), np.shape(values)) for of in rates]
        ).astype(float)

    def of_tree(path: str, tree, least_axes: int = 0):
        def of_leaf(place, leaf):
            found = along(path + jax.tree_util.keystr(place), leaf)
            missing = max(least_axes - np.ndim(leaf), 0)
            return found.reshape(len(rates), *(1,) * missing, *np.shape(leaf))

        return jax.tree_util.tree_map_with_path(of_leaf, tree)

    release, ground = case.release, case.ground
    body = release.body._asdict()
    angle = ground.rolling_friction_angle
    return Directions(
        body=Body(**{n: along(f"release.{n}", v) for n, v in body.items()}),
        block=of_tree("release.block", release.block),
        soil=of_tree("ground.soil", ground.soil, 2),
        rolling_friction_angle=of_tree("ground.rolling_friction_angle", angle, 2),
        law=of_tree("contacts.law", getattr(case.contacts, "law", None)),
    )


def replaced(instance: Any, **fields) -> Any:
    """Copy an instance with other fields, unchecked."""
    other = copy.copy(instance)
    for name, value in fields.items():
        object.__setattr__(other, name, value)
    return other


def _known(case: Case) -> dict[str, Parameter]:
    known = [
        *_fields("soil", "ground.soil", case.ground.soil),
        _ROLLING,
        *_fields("block", "release.block", case.release.block),
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
) -> Parameter:
    """Describe a field that lies in a case at a path of names; all its values shift
    alike."""
    get = operator.attrgetter(path)
    part, *inner = path.split(".")

    def value(case: Case) -> np.ndarray:
        return np.asarray(get(case))

    def move(case: Case, amount: np.ndarray) -> Case:
        shifted = _with(getattr(case, part), inner, value(case) + amount)
        return case._replace(**{part: shifted})

    def rates(case: Case) -> dict[str, np.ndarray]:
        return {path: np.ones(())}

    return Parameter(name, unit, factor, part, value, move, rates, column)


def _with(owner, path: list[str], value):
    """Copy an object with another value at a path in it."""
    name, *inner = path
    if inner:
        value = _with(getattr(owner, name), inner, value)
    return replaced(owner, **{name: value})


def _fields(part: str, path: str, whole: Composite) -> list[Parameter]:
    """Describe the parameters of a part of the scene."""
    return [
        _field(
            ".".join((path, *whole.path_of(c.field))),
            *(c.name, c.unit, c.factor, c),
        )
        for c in columns_of_part(part, whole).values()
    ]


def _speed(case: Case) -> np.ndarray:
    return np.hypot(case.release.v_x, case.release.v_y)


def _direction(case: Case) -> np.ndarray:
    return np.arctan2(case.release.v_y, case.release.v_x)


def _rates_by_speed(case: Case) -> dict[str, np.ndarray]:
    direction = _direction(case)
    return {"release.v_x": np.cos(direction), "release.v_y": np.sin(direction)}


def _move_speed(case: Case, amount: np.ndarray) -> Case:
    rates, release = _rates_by_speed(case), case.release
    v_x = release.v_x + rates["release.v_x"] * amount
    v_y = release.v_y + rates["release.v_y"] * amount
    return case._replace(release=replaced(release, v_x=v_x, v_y=v_y))


def _rates_by_direction(case: Case) -> dict[str, np.ndarray]:
    return {"release.v_x": -case.release.v_y, "release.v_y": case.release.v_x}


def _move_direction(case: Case, amount: np.ndarray) -> Case:
    release, cos, sin = case.release, np.cos(amount), np.sin(amount)
    v_x = release.v_x * cos - release.v_y * sin
    v_y = release.v_x * sin + release.v_y * cos
    return case._replace(release=replaced(release, v_x=v_x, v_y=v_y))


_ROLLING = _field("ground.rolling_friction_angle", ROLLING_COLUMN, "deg", DEGREE)
_OF_RELEASE = [
    _field("release.x", "x_m", "m"),
    _field("release.y", "y_m", "m"),
    Parameter(
        *("speed_mps", "m/s", 1.0, "release"),
        *(_speed, _move_speed, _rates_by_speed),
    ),
    Parameter(
        *("direction_deg", "deg", DEGREE, "release"),
        *(_direction, _move_direction, _rates_by_direction),
    ),
    _field("release.orientation", "orientation_deg", "deg", DEGREE),
    _field("release.angular_velocity", "angular_velocity_degps", "deg/s", DEGREE),
]

"""The edge of the package: names and units of every quantity in tables and files.

A column of a table, a key of a TOML file and a parameter of `Block`, `Soil`, `Impact`,
a law or a shape belong together. What they are is read off where the parameter is
declared.
"""

import dataclasses
import functools
import math
from collections.abc import Iterable
from typing import Any

import jax
import numpy as np

from ._jax_internals import namespace_of
from .errors import InputError, did_you_mean
from .finding import shipped
from .identity import clear_when_edited
from .parameters import Composite, Declared, Part, declared_of, default_part, parts_of
from .scene import KINDS, PARTS, Scene
from .units import RESULT_SUFFIXES, UNITS


@dataclasses.dataclass(frozen=True)
class InputColumn:
    """A quantity of the scene as users write it."""

    name: str
    part: str
    """"block", "soil" or "impact"."""
    field: str
    factor: float
    """SI value = factor x value in the column's unit."""
    default: float
    lower: float
    upper: float
    lower_allowed: bool
    upper_allowed: bool
    unit: str
    meaning: str
    usual: tuple[float, float] = (-math.inf, math.inf)
    """Values beyond which a unit may have been mistaken, in the column's unit."""

    @property
    def range_text(self) -> str:
        """The range in words."""
        if self.lower == -math.inf and self.upper == math.inf:
            return "finite"
        if self.upper == math.inf:
            return f"{'at least' if self.lower_allowed else 'above'} {self.lower:g}"
        left = "[" if self.lower_allowed else "("
        right = "]" if self.upper_allowed else ")"
        return f"in {left}{self.lower:g}, {self.upper:g}{right}"

    @property
    def requirement(self) -> str:
        """The range with its unit, to follow "must be"."""
        has_unit = self.unit != "-" and self.range_text != "finite"
        return f"{self.range_text} {self.unit}" if has_unit else self.range_text

    def requirement_of(self, number: float) -> str:
        """What a number that is not allowed does not meet, to follow "must be": that it
        is finite too, which a range without an upper end does not say."""
        unsaid = not math.isfinite(number) and self.range_text != "finite"
        return f"finite and {self.requirement}" if unsaid else self.requirement

    @property
    def si_unit(self) -> str:
        """Unit of the field."""
        units = UNITS.get(self.unit, {})
        return next((u for u, size in units.items() if size * self.factor == 1.0), "-")

    def hint(self, number: float, unit: str) -> str:
        """Which unit may have been meant by a number that was taken to be in `unit`, to
        follow a message; empty if none makes it usual."""
        units = UNITS.get(self.unit, {})
        for other, size in units.items():
            value = size * number
            if other == unit or not self.is_allowed(value) or self.is_unusual(value):
                continue
            if other != "%" or 1.0 < number <= 100.0:
                meant = f"{value / units[unit]:.4g} {unit}".removesuffix(" -")
                return f"; {other}? {number:g} {other} is {meant}"
        return ""

    def describe(self, number: float, unit: str, where: str = "") -> str:
        """Write a number in `unit` in words, with the column's unit, its place, the
        usual values if it is no error, and the unit that may be meant."""
        number = float(number)  # whose overflow NumPy would tell of
        value = UNITS.get(self.unit, {}).get(unit, 1.0) * number
        text = f"{number:g} {unit}".removesuffix(" -")
        if unit != self.unit:
            text += f" = {value:.4g} {self.unit}"
        text += where
        if self.is_allowed(value):
            usual = "usual are {:g} to {:g} {}".format(*self.usual, self.unit)
            text += "; " + usual.removesuffix(" -")
        return text + self.hint(number, unit)

    def is_unusual(self, values) -> np.ndarray:
        """Tell which values, in the column's unit, are beyond the usual ones."""
        low, high = self.usual
        return (values < low) | (values > high)

    def is_allowed(self, values) -> Any:
        """Tell which values, in the column's unit, are finite and in range, by NumPy or
        `jax.numpy`."""
        xp = namespace_of(values)
        values = xp.asarray(values, float)
        above = values >= self.lower if self.lower_allowed else values > self.lower
        below = values <= self.upper if self.upper_allowed else values < self.upper
        with np.errstate(over="ignore"):
            finite = xp.isfinite(values) & xp.isfinite(values * self.factor)
        return finite & above & below


def _column(part: str, field: str, declared: Declared) -> InputColumn:
    lower, upper = declared.ends
    return InputColumn(
        name=declared.column,
        part=part,
        field=field,
        factor=declared.factor,
        default=declared.default,
        lower=lower,
        upper=upper,
        lower_allowed=declared.range[0] == "[",
        upper_allowed=declared.range[-1] == "]",
        unit=declared.unit,
        meaning=declared.meaning,
        usual=declared.usual,
    )


def own_columns(kind: type[Part]) -> list[InputColumn]:
    """Return the columns of a law that belongs to no scene, as of rebound."""
    return [_column("law", *pair) for pair in declared_of(kind).items()]


def columns_of(scene: Scene) -> dict[str, InputColumn]:
    """Return the columns of a scene: those of its parts, with those of the laws and the
    shape that it has."""
    wholes = ((part, getattr(scene, part)) for part in PARTS)
    return _columns_of(*((part, type(whole), *_held(whole)) for part, whole in wholes))


def columns_of_part(part: str, whole: Composite) -> dict[str, InputColumn]:
    """Return the columns of a soil or a block alone."""
    return _columns_of((part, type(whole), *_held(whole)))


def _held(whole: Composite) -> list[type[Part]]:
    return [type(getattr(whole, slot)) for slot in parts_of(type(whole))]


@functools.cache
def _columns_of(*parts: tuple) -> dict[str, InputColumn]:
    """Of the name of each part of a scene, its class and those of its laws or shape."""
    return _by_name(
        [
            _column(part, *pair)
            for part, *kinds in parts
            for kind in kinds
            for pair in declared_of(kind).items()
        ]
    )


clear_when_edited(_columns_of.cache_clear)


@functools.cache
def _taken() -> dict[str, str]:
    """Return the names that tables and files have for something else, and for what."""
    results = (*RESULT_COLUMNS, *FURTHER_COLUMNS, *ENERGY_COLUMNS, OUTCOME_COLUMN)
    results += (*DERIVED_COLUMNS, *CURVE_COLUMNS, TIME_COLUMN)
    return {
        **dict.fromkeys(
            (*results, *(SIGMA_PREFIX + n for n in results)), "that of a result"
        ),
        **dict.fromkeys(LABEL_COLUMNS, "one of free text"),
        **dict.fromkeys(SLOTS, "the name of a law or of the shape"),
        "accuracy": "the key of the accuracy",
    }


def _by_name(columns: list[InputColumn]) -> dict[str, InputColumn]:
    by_name: dict[str, InputColumn] = {}
    for column in columns:
        name = column.name
        if name in _taken():
            raise InputError(
                f"the parameter {column.field} of the {column.part} has the column "
                f"{name}, which is {_taken()[name]}; rename it"
            )
        if name in by_name:
            raise InputError(
                f"two parameters have the column {name}: {by_name[name].field} of the "
                f"{by_name[name].part} and {column.field} of the {column.part}; rename "
                "the one that is yours"
            )
        by_name[name] = column
    return by_name


SLOTS: dict[str, str] = {
    slot: part for part, kind in KINDS.items() for slot in parts_of(kind)
}
"""Slots for laws and for the shape, as keys of files -> the part of the scene that they
belong to."""
BASES: dict[str, type[Part]] = {
    slot: base for kind in KINDS.values() for slot, base in parts_of(kind).items()
}
"""Slot -> the base class of what stands in it."""
USUAL: dict[str, type[Part]] = {
    slot: default_part(kind, slot) for kind in KINDS.values() for slot in parts_of(kind)
}
"""Slot -> the law or shape that a scene has if none is named."""


def shipped_parts(slot: str) -> list[type[Part]]:
    """List the package's own laws for a slot, or its shapes, the usual one first."""
    return sorted(shipped(BASES[slot]), key=lambda kind: kind is not USUAL[slot])


def columns_of_class(slot: str, kind: type[Part]) -> dict[str, InputColumn]:
    """Return the columns of the parameters of a law or a shape alone."""
    return _by_name([_column(SLOTS[slot], *pair) for pair in declared_of(kind).items()])


def why_unknown(name: str, known: Iterable[str]) -> str:
    """What may have been meant by an unknown name, to follow "is unknown; ": where
    parameters of the scene are known, the part of the scene that it belongs to, or
    which of the package's laws and shapes have it as a parameter; else the nearest
    known."""
    known = tuple(known)
    parts = {INPUT_COLUMNS[one].part for one in known if one in INPUT_COLUMNS}
    for slot in SLOTS:
        kinds = shipped_parts(slot)
        owners = [k.__name__ for k in kinds if str(name) in columns_of_class(slot, k)]
        if owners and SLOTS[slot] in parts:
            return (
                f"it belongs to the {slot.replace('_', ' ')} {' or '.join(owners)}, "
                f'which is not chosen ({slot} = "{owners[0]}")'
            )
        if owners and parts:
            return f"it is a quantity of the {SLOTS[slot]}"
    column = INPUT_COLUMNS.get(str(name))
    if parts and column is not None and column.part not in parts:
        return f"it is a quantity of the {column.part}"
    return did_you_mean(name, known)


def leaf_places(scene: Scene) -> dict[str, int]:
    """Find the place of each column among the leaves of a scene."""
    structure = jax.tree.structure(scene)
    places = jax.tree.unflatten(structure, list(range(structure.num_leaves)))
    return {
        name: getattr(getattr(places, column.part), column.field)
        for name, column in columns_of(scene).items()
    }


@dataclasses.dataclass(frozen=True)
class ResultColumn:
    """A number of the result as users read it."""

    name: str
    field: str
    unit: str
    meaning: str


def _results(*rows: tuple[str, str, str]) -> dict[str, ResultColumn]:
    """Make columns of fields of `ImpactSummary`, of rows of field, unit and meaning;
    the unit stands behind the name."""
    stems = {
        "normal_velocity": "v_n",
        "tangential_velocity": "v_t",
        "angular_velocity": "omega",
    }
    columns = {}
    for field, unit, meaning in rows:
        name = stems.get(field, field) + RESULT_SUFFIXES[unit]
        columns[name] = ResultColumn(name, field, unit, meaning)
    return columns


RESULT_COLUMNS = _results(
    ("e_n", "-", "apparent normal restitution"),
    ("e_t", "-", "apparent tangential restitution"),
    ("e_contact", "-", "normal restitution at the contact"),
    ("e_bar", "-", "energetic restitution"),
    ("R_r", "-", "final rotational over total kinetic energy"),
    ("max_penetration", "m", "largest penetration of the centre"),
    ("max_sinking", "m", "largest penetration of the lowest point"),
    ("max_normal_force", "N", "largest normal force"),
    ("max_moment", "N m", "largest moment in magnitude"),
    ("duration", "s", "time in contact"),
    ("rotation", "rad", "rotation during contact"),
    ("normal_velocity", "m/s", "final normal velocity, into the ground"),
    ("tangential_velocity", "m/s", "final tangential velocity, down-slope"),
    ("angular_velocity", "rad/s", "final angular velocity, clockwise"),
)
"""Results that a table of results holds, by the names of their columns."""
FURTHER_COLUMNS = _results(
    ("e_n_vijayakumar", "-", "e_n of a rigid body"),
    ("max_tangential_force", "N", "largest tangential force in magnitude"),
    ("time_of_max_penetration", "s", "time of the largest penetration of the centre"),
    ("time_of_max_sinking", "s", "time of the largest penetration of the lowest point"),
    ("time_of_max_normal_force", "s", "time of the largest normal force"),
    ("time_of_max_tangential_force", "s", "time of the largest tangential force"),
    ("time_of_max_moment", "s", "time of the largest moment"),
    ("final_penetration", "m", "penetration of the centre at the end"),
    ("final_sinking", "m", "penetration of the lowest point at the end"),
    ("steps", "-", "steps of the integration"),
)
"""Results that a table of results does not hold."""
DERIVED_COLUMNS = {
    name: ResultColumn(name, "", unit, meaning)
    for name, unit, meaning in (
        ("translational_ratio", "-", "translational energy after over before"),
        ("rebound_angle_deg", "deg", "angle of the velocity after from the normal"),
        ("normal_impulse_Ns", "N s", "momentum into the ground that is lost"),
        ("tangential_impulse_Ns", "N s", "momentum down-slope that is lost"),
    )
}
"""Results that follow from velocities, mass and angle; they are fitted, no more."""
TIME_COLUMN, CURVE_FILE = "time_s", "force_curve"
"""Columns of a table of tests: the time of a force since first touch, and the file of a
curve of forces against time."""
CURVE_COLUMNS = _results(
    ("normal_force", "N", "normal force at the time of the row"),
    ("tangential_force", "N", "tangential force at the time of the row, down-slope"),
)
"""Forces at a time, which are fitted, no more."""
TARGET_COLUMNS = {
    **RESULT_COLUMNS,
    **{
        n: c
        for n, c in FURTHER_COLUMNS.items()
        if n not in ("e_n_vijayakumar", "steps")
    },
    **DERIVED_COLUMNS,
    **CURVE_COLUMNS,
}
"""Results that a table of tests may hold, measured."""
NEVER_NEGATIVE = (
    *("e_bar", "R_r", "translational_ratio", "duration_s", "final_sinking_m"),
    *(n for n, column in TARGET_COLUMNS.items() if column.field.startswith("max_")),
    *(n for n, column in TARGET_COLUMNS.items() if column.field.startswith("time_")),
)
"""Results whose measurements cannot be below 0."""
ENERGY_COLUMNS = {
    f"energy_{item}_J": ResultColumn(f"energy_{item}_J", item, "J", meaning)
    for item, meaning in {
        "kinetic_in": "kinetic energy at impact",
        "gravity": "work of gravity",
        "arm": "work of the arm between centre and deepest point",
        "stiffness": "work of the change of stiffness",
        "kinetic_out": "kinetic energy at the end",
        "elastic": "elastic energy left",
        "viscoplastic": "dissipated by yielding",
        "slider": "dissipated by sliding",
        "dashpot": "dissipated by damping",
        "residual": "error of the integration: first four less the next five",
    }.items()
}
"""The items of the energy ledger."""
OUTCOME_COLUMN = "outcome"
OUTCOME_MEANING = (
    "outcome: detached, toppled, arrested, in contact, separating or failed"
)
SIGMA_PREFIX = "sigma_"
"""Before the name of a result column: the standard deviation of a measured value."""
LABEL_COLUMNS = (
    *("name", "id", "test", "date", "campaign", "source", "note", "comment"),
    CURVE_FILE,
)
"""Columns of free text, which identify a row and are carried along."""


# Without making a scene: at import JAX may be in float32 still.
INPUT_COLUMNS: dict[str, InputColumn] = _columns_of(
    *(
        (part, kind, *(USUAL[slot] for slot in parts_of(kind)))
        for part, kind in KINDS.items()
    )
)
"""Columns of a scene with the usual laws and shape; `columns_of` gives those of
another."""

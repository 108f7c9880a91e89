"""Laws, shapes and what is made of them: modules whose parameters tell what they are.

A parameter says its default, unit, range and meaning where it is declared; columns of
tables, keys of files, checks and the order of a program's inputs are read off there.
"""

import dataclasses
import functools
import math
from typing import NamedTuple

import equinox as eqx
import jax
import numpy as np

from ._jax_internals import Tracer
from .errors import InputError, nearest
from .fields import real_numbers
from .finding import find_part
from .precision import float64_leaf
from .units import SIZES, SUFFIXES

EVERYWHERE = (-math.inf, math.inf)


class Declared(NamedTuple):
    """What a parameter says of itself, in the unit that users write it in."""

    default: float
    unit: str
    range: str
    """An interval: "(0, inf)", "[0, 1]"."""
    meaning: str
    column: str
    """Name of the column of tables, and of the key of files, that holds it."""
    usual: tuple[float, float]
    """Values beyond which a unit may have been mistaken."""

    @property
    def factor(self) -> float:
        """Value in SI units = factor x value in `unit`."""
        return SIZES.get(self.unit, 1.0)

    @property
    def si_default(self) -> float:
        """The default in SI units and radians."""
        if self.unit == "deg":
            return math.radians(self.default)
        return self.default * self.factor


def parameter(
    default: float,
    unit: str,
    range: str,
    meaning: str,
    *,
    column: str | None = None,
    usual: tuple[float, float] = EVERYWHERE,
):
    """A parameter of a law, a shape or a part of the scene.

    The field holds a float64 array in SI units and radians. It can be swept, batched,
    differentiated and fitted.

    Args:
        default: value if none is given, in `unit`.
        unit: of the default, the range and the column: an SI unit as "m/s" or "1/s",
            "-" for none, "deg", "deg/s" or "kN/m3".
        range: interval of the values allowed, with round brackets where an end is left
            out: "(0, inf)", "[0, 1]".
        meaning: a few words.
        column: name of its column in tables and of its key in files; by default the
            field's name, with the unit behind it where that is not SI
            (`friction_angle_deg`).
        usual: values beyond which a warning asks whether the unit was mistaken.

    Raises InputError for what cannot be understood.
    """
    told = f"parameter({default!r}, {unit!r}, {range!r}, {meaning!r})"
    if isinstance(default, str) or not all(
        isinstance(text, str) for text in (unit, range, meaning)
    ):
        raise InputError(
            f"{told}: must be parameter(default, unit, range, meaning), a number and "
            "three texts"
        )
    lower, upper = _ends(told, range)
    above = default >= lower if range[0] == "[" else default > lower
    below = default <= upper if range[-1] == "]" else default < upper
    if not (above and below):
        raise InputError(f"{told}: the default is not in the range")
    declared = Declared(float(default), unit, range, meaning, column or "", usual)
    return eqx.field(
        default=declared.si_default,
        converter=float64_leaf,
        metadata={"declared": declared},
    )


def _ends(told: str, interval: str) -> tuple[float, float]:
    try:
        if interval[0] not in "([" or interval[-1] not in ")]":
            raise ValueError
        lower, upper = (float(end) for end in interval[1:-1].split(","))
    except (ValueError, IndexError):
        raise InputError(
            f"{told}: the range must be an interval as in '(0, inf)' or '[0, 1]', but "
            f"is {interval!r}"
        ) from None
    return lower, upper


@functools.cache
def declared_of(kind: type) -> dict[str, Declared]:
    """The parameters that a class declares itself: field to what it says."""
    found = {}
    for field in dataclasses.fields(kind):
        declared = field.metadata.get("declared")
        if declared is not None:
            suffix = SUFFIXES.get(declared.unit, "")
            name = declared.column or field.name + suffix
            found[field.name] = declared._replace(column=name)
    return found


class Parameters(eqx.Module):
    """Fields that are real numbers or arrays of them, as `real_numbers` allows.

    Raises InputError for a value of another kind, TypeError for an unknown field, with
    the nearest known.
    """

    def __new__(cls, *given, **named):
        names = _names(cls)
        for name in named:
            if name not in names:
                raise TypeError(
                    f"{cls.__name__} has no field {name!r}; did you mean "
                    f"{nearest(name, names)}?"
                )
        # More than there are fields: Python itself complains.
        pairs = (*zip(names, given, strict=False), *named.items())
        for name, value in pairs:
            if type(value) is not float and name in _numeric(cls):
                real_numbers(f"{cls.__name__}.{name}", value)
        return super().__new__(cls)


@functools.cache
def _names(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in dataclasses.fields(kind))


@functools.cache
def _numeric(kind: type) -> set[str]:
    fields = dataclasses.fields(kind)
    return {field.name for field in fields if not field.metadata.get("static")}


def _line(name: str, said: Declared, value) -> str:
    """A parameter with its value, unit and meaning."""
    return f"{name:<18} {_shown(value, said):<14} {said.meaning}"


def _shown(value, said: Declared) -> str:
    """A value in the unit that users write it in; of an array its ends and size."""
    unit = "" if said.unit == "-" else f" {said.unit}"
    if isinstance(value, Tracer) or not isinstance(value, np.ndarray | jax.Array):
        return f"{value}{unit}" if isinstance(value, int | float) else "(traced)"
    values = np.asarray(value) / said.factor
    if values.ndim == 0:
        return f"{float(values):.6g}{unit}"
    if not values.size:
        return "(empty)"
    ends = f"{np.min(values):.6g} to {np.max(values):.6g}"
    return f"{ends}{unit} {values.shape}"


class Part(Parameters):
    """A law or a shape: one replaceable part of a `Composite`, with parameters of its
    own."""

    def __repr__(self) -> str:
        said = parameters_of(self)
        inside = (f"{name}={_shown(getattr(self, name), said[name])}" for name in said)
        return f"{type(self).__name__}({', '.join(inside)})"


def part(base: type[Part], default: type[Part]):
    """A field that holds a part: of a class derived from `base`, by default of
    `default`."""
    return eqx.field(default_factory=default, metadata={"base": base})


@functools.cache
def parts_of(kind: type) -> dict[str, type[Part]]:
    """The fields of a composite that hold parts, and the classes these derive from."""
    fields = dataclasses.fields(kind)
    return {f.name: f.metadata["base"] for f in fields if "base" in f.metadata}


class Composite(eqx.Module):
    """Parameters of its own, and parts that own theirs.

    All parameters are set and read by their names alone, wherever they stand:
    `Soil(gamma_v=5.0)` is `Soil(flow=Perzyna(gamma_v=5.0))`, and `soil.gamma_v` is
    `soil.flow.gamma_v`. A parameter given by its name takes precedence over the one of
    a part given beside it, so that `dataclasses.replace(soil, gamma_v=5.0)` does what
    it says.
    """

    def __init__(self, *given, **named):
        kind = type(self)
        fields = {field.name: field for field in dataclasses.fields(kind)}
        if len(given) > len(fields):
            raise TypeError(
                f"{kind.__name__} takes at most {len(fields)} values, but {len(given)} "
                "were given"
            )
        named = dict(zip(fields, given, strict=False)) | named
        owner: dict[str, str] = {}
        for slot, base in parts_of(kind).items():
            given_part = named.pop(slot, None)
            if given_part is None:
                given_part = fields[slot].default_factory()
            elif isinstance(given_part, str):
                given_part = find_part(slot, base, given_part)
            _check_part(f"{kind.__name__}.{slot}", base, given_part)
            object.__setattr__(self, slot, given_part)
            _own(self, slot, owner)
        changed: dict[str, dict] = {}
        for name, value in named.items():
            if name in owner:
                _check(kind, name, value)
                changed.setdefault(owner[name], {})[name] = value
            elif name not in fields:
                known = (*fields, *owner)
                raise TypeError(
                    f"{kind.__name__} has no parameter {name!r}{_of_parts(self)}; did "
                    f"you mean {nearest(name, known)}?"
                )
        for slot, values in changed.items():
            object.__setattr__(
                self, slot, dataclasses.replace(getattr(self, slot), **values)
            )
        for name in declared_of(kind):
            value = named.get(name, fields[name].default)
            _check(kind, name, value)
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        said = declared_of(type(self))
        inside = [f"{name}={_shown(getattr(self, name), said[name])}" for name in said]
        inside += [f"{slot}={getattr(self, slot)!r}" for slot in parts_of(type(self))]
        return f"{type(self).__name__}({', '.join(inside)})"

    def __str__(self) -> str:
        """A table of all parameters, with units and meanings, part by part."""
        lines = [type(self).__name__]
        for name, said in declared_of(type(self)).items():
            lines.append("  " + _line(name, said, getattr(self, name)))
        for slot in parts_of(type(self)):
            held = getattr(self, slot)
            lines.append(f"  {slot}: {type(held).__name__}")
            for name, said in parameters_of(held).items():
                lines.append("    " + _line(name, said, getattr(held, name)))
        return "\n".join(lines)

    def path_of(self, name: str) -> tuple[str, ...]:
        """Names that lead to a parameter: its own, behind the field of the part that
        owns it."""
        for slot in parts_of(type(self)):
            if name in parameters_of(vars(self)[slot]):
                return slot, name
        return (name,)

    def __getattr__(self, name: str):
        if not name.startswith("__"):
            held = vars(self)
            for slot in parts_of(type(self)):
                if slot in held and name in parameters_of(held[slot]):
                    return getattr(held[slot], name)
            if all(slot in held for slot in parts_of(type(self))):
                known = [*held]
                for slot in parts_of(type(self)):
                    known += parameters_of(held[slot])
                raise AttributeError(
                    f"{type(self).__name__} has no parameter {name!r}"
                    f"{_of_parts(self)}; did you mean {nearest(name, known)}?"
                )
        raise AttributeError(f"{type(self).__name__!r} object has no {name!r}")

    def __dir__(self):
        names = set(super().__dir__())
        for slot in parts_of(type(self)):
            names |= set(parameters_of(vars(self)[slot]))
        return sorted(names)


def _own(whole: Composite, slot: str, owner: dict[str, str]) -> None:
    """Note that the parameters of a part are its own. Raises InputError where one of
    them has the name of another's."""
    part = getattr(whole, slot)
    for name in parameters_of(part):
        if name in owner or name in _names(type(whole)):
            other = getattr(whole, owner[name]) if name in owner else whole
            raise InputError(
                f"{type(part).__name__}.{name} and {type(other).__name__}.{name} are "
                "two parameters of one name; rename the one that is yours"
            )
        owner[name] = slot


def _check_part(name: str, base: type[Part], part) -> None:
    if isinstance(part, type) and issubclass(part, base):
        raise InputError(
            f"{name} must be an object, but is the class {part.__name__}; write "
            f"{part.__name__}()"
        )
    if not isinstance(part, base):
        raise InputError(
            f"{name} must be of a class derived from {base.__name__}, but is of type "
            f"{type(part).__name__}"
        )
    _check_fields(type(part))


@functools.cache
def _check_fields(kind: type[Part]) -> None:
    """Raise InputError for a field of a part that is neither a parameter nor static."""
    for field in dataclasses.fields(kind):
        if "declared" not in field.metadata and not field.metadata.get("static"):
            raise InputError(
                f"{kind.__name__}.{field.name} is no parameter; write {field.name}: "
                "Scalar = parameter(default, unit, range, meaning)"
            )


def _check(kind: type, name: str, value) -> None:
    if type(value) is not float:
        real_numbers(f"{kind.__name__}.{name}", value)


def _of_parts(whole: Composite) -> str:
    """The parts of a composite that are not its usual ones, to follow a message."""
    fields = {field.name: field for field in dataclasses.fields(whole)}
    others = [
        f"{slot} {type(held).__name__}"
        for slot in parts_of(type(whole))
        if type(held := vars(whole)[slot]) is not fields[slot].default_factory
    ]
    return f" with {' and '.join(others)}" if others else ""


def parameters_of(part: Part) -> dict[str, Declared]:
    """The parameters of a part: field to what it says."""
    return declared_of(type(part))

"""Laws, shapes and what is made of them: modules whose parameters tell what they are.

A parameter has its default, unit, range and meaning where it is declared; columns of
tables, keys of files, checks, docstrings and the order of a program's inputs are read
off there.
"""

import dataclasses
import functools
import inspect
import math
import warnings
import weakref
from collections.abc import Mapping
from typing import (
    Any,
    ClassVar,
    NamedTuple,
    TypeVar,
    cast,
    dataclass_transform,
)

import equinox as eqx
import jax
import numpy as np

from ._checks import real_numbers
from ._fixed_fields import check_fixed_fields, fixed_fields, unusual_fields
from ._module import Module, set_in_float64
from ._precision import float64_leaf
from ._tables import Row, html_table
from ._types import Number, Shown
from .errors import InputError, UnusualValueWarning, did_you_mean
from .finding import find_part
from .units import SIZES, SUFFIXES, check_unit, with_unit

Made = TypeVar("Made", bound=Module | eqx.Module)

EVERYWHERE = (-math.inf, math.inf)


class Declared(NamedTuple):
    """Unit, range and meaning of a parameter, in the unit that users write it in."""

    default: float
    """Value if none is given; NaN for a parameter that must be given."""
    unit: str
    """Unit of the default, the range and the column."""
    range: str
    """Interval of the values allowed: "(0, inf)", "[0, 1]"."""
    meaning: str
    """Meaning in a few words."""
    column: str
    """Name of the column of tables, and of the key of files, that holds it."""
    usual: tuple[float, float]
    """Values beyond which a unit may have been mistaken."""

    @property
    def factor(self) -> float:
        """Ratio of the value in SI units to the value in `unit`."""
        return SIZES.get(self.unit, 1.0)

    @property
    def si_default(self) -> float:
        """Default in SI units and radians."""
        if self.unit == "deg":
            return math.radians(self.default)
        return self.default * self.factor

    @property
    def ends(self) -> tuple[float, float]:
        """Lower and upper end of the range, in `unit`."""
        lower, upper = (float(end) for end in self.range[1:-1].split(","))
        return lower, upper


def parameter(
    default: float | None,
    unit: str,
    range: str,
    meaning: str,
    *,
    column: str | None = None,
    usual: tuple[float, float] = EVERYWHERE,
) -> Any:
    """Declare a parameter of a law, a shape or a part of the scene.

    The field holds a float64 array in SI units and radians. It can be swept, batched,
    differentiated and fitted.

    Args:
        default: value if none is given, in `unit`; None for a parameter of a law of
            rebound that must be given. Laws of the soil and shapes need a default.
        unit: of the default, the range and the column: an SI unit without a prefix, as
            "m/s" or "1/s", "-" for none, "deg", "deg/s", "kN/m3" or "kPa".
        range: interval of the values allowed, with round brackets where an end is left
            out: "(0, inf)", "[0, 1]".
        meaning: a few words, for tables, docstrings and messages.
        column: name of its column in tables and of its key in files; by default the
            field's name, with the unit behind it where that is not SI
            (`friction_angle_deg`).
        usual: values beyond which a warning asks whether the unit was mistaken.

    Raises InputError for what cannot be understood.
    """
    call = f"parameter({default!r}, {unit!r}, {range!r}, {meaning!r})"
    if isinstance(default, str) or not all(
        isinstance(text, str) for text in (unit, range, meaning)
    ):
        raise InputError(
            f"{call}: must be parameter(default, unit, range, meaning), a number and "
            "three texts"
        )
    check_unit(call, unit)
    value = math.nan if default is None else float(default)
    declared = Declared(value, unit, range, meaning, column or "", usual)
    lower, upper = _checked_ends(call, declared)
    if default is None:
        return eqx.field(converter=float64_leaf, metadata={"declared": declared})
    above = default >= lower if range[0] == "[" else default > lower
    below = default <= upper if range[-1] == "]" else default < upper
    if not (above and below):
        raise InputError(f"{call}: the default is not in the range")
    return eqx.field(
        default=declared.si_default,
        converter=float64_leaf,
        metadata={"declared": declared},
    )


def _checked_ends(call: str, declared: Declared) -> tuple[float, float]:
    interval = declared.range
    try:
        if interval[0] not in "([" or interval[-1] not in ")]":
            raise ValueError
        return declared.ends
    except (ValueError, IndexError):
        raise InputError(
            f"{call}: the range must be an interval as in '(0, inf)' or '[0, 1]', but "
            f"is {interval!r}"
        ) from None


@functools.cache
def declared_of(kind: type) -> dict[str, Declared]:
    """Return what a class declares itself of its parameters, by field name."""
    declarations = {}
    for field in dataclasses.fields(kind):
        declared = field.metadata.get("declared")
        if declared is not None:
            suffix = SUFFIXES.get(declared.unit, "")
            name = declared.column or field.name + suffix
            declarations[field.name] = declared._replace(column=name)
    return declarations


TABLE_HEADING = (
    "Parameters (given in SI units and radians; here in the unit of tables):"
)
"""Line above the table of parameters in the docstring of a class."""


def _fields_being_made(kind: type) -> dict[str, dataclasses.Field]:
    """Return the fields of a class being made, which is no dataclass yet."""
    fields = dict(getattr(kind, "__dataclass_fields__", {}))
    own = {n: f for n, f in vars(kind).items() if isinstance(f, dataclasses.Field)}
    return fields | own


def _add_table(kind: type) -> None:
    """Add a table of the parameters to the docstring of a class being made.

    Not when it is asked for: `help` takes a docstring that is no plain text for none.
    """
    if kind.__doc__ is None:
        return
    fields, rows = _fields_being_made(kind), []
    for name, field in fields.items():
        if declared := field.metadata.get("declared"):
            rows.append(_declared_cells(name, declared))
        elif "base" in field.metadata:
            part_class = cast(type[Part], field.default_factory)
            rows.append((f"{name}: {part_class.__name__}", "", "", "", ""))
            rows += [_declared_cells(*pair) for pair in declared_of(part_class).items()]
    if not rows:
        return
    rows = [("name", "default", "unit", "range", "meaning"), *rows]
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    rows.insert(1, tuple("-" * width for width in widths))
    table = "\n".join(f"| {' | '.join(map(str.ljust, r, widths))} |" for r in rows)
    kind.__doc__ = f"{inspect.cleandoc(kind.__doc__)}\n\n{TABLE_HEADING}\n\n{table}\n"


def _signature(kind: type) -> inspect.Signature:
    """Make the signature of a composite being made: its own fields by place or name,
    the parameters of its usual parts by name, and those of other parts."""
    own: list[tuple] = [("self", inspect.Parameter.empty, inspect.Parameter.empty)]
    of_parts: list[tuple] = []
    for name, field in _fields_being_made(kind).items():
        if declared := field.metadata.get("declared"):
            own.append((name, declared.si_default, Number))
        elif "base" in field.metadata:
            usual = cast(type[Part], field.default_factory)
            base = field.metadata["base"]
            own.append((name, Shown(f"{usual.__name__}()"), base | str))
            of_parts += [
                (name, said.si_default, Number)
                for name, said in declared_of(usual).items()
            ]
    parameters = [
        inspect.Parameter(name, how, default=default, annotation=annotation)
        for how, entries in (
            (inspect.Parameter.POSITIONAL_OR_KEYWORD, own),
            (inspect.Parameter.KEYWORD_ONLY, of_parts),
        )
        for name, default, annotation in entries
    ]
    if of_parts:
        others = inspect.Parameter.VAR_KEYWORD
        parameters.append(
            inspect.Parameter("of_other_parts", others, annotation=Number)
        )
    return inspect.Signature(parameters)


def _declared_cells(name: str, said: Declared) -> tuple[str, ...]:
    default = "" if math.isnan(said.default) else f"{said.default:g}"
    return name, default, said.unit, said.range, said.meaning


def _own_rows(whole: "Part | Composite") -> list[Row]:
    """Return name, value and meaning of the parameters that an object declares
    itself."""
    return [
        (name, with_unit(getattr(whole, name), said.unit, said.factor), said.meaning)
        for name, said in declared_of(type(whole)).items()
    ]


_with_own_constructor: weakref.WeakSet[type] = weakref.WeakSet()
"""Classes of parts that do more when they are made than take their fields."""


@dataclass_transform()
class Part(Module):
    """A law or a shape: one replaceable part of a `Composite`, with own parameters.

    Raises InputError for a parameter that is no number and no array of numbers (see
    `real_numbers`), TypeError for an unknown field, with the nearest known.
    """

    statements: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Attributes that state what functions of a class do, and these functions. A
    derived class that overrides one of the functions must state it anew; otherwise the
    attribute of this class, which is right for all functions, takes its place."""

    def __init_subclass__(cls, **arguments):
        super().__init_subclass__(**arguments)
        _add_table(cls)
        _withdraw_statements(cls)
        constructors = {"__init__", "__post_init__", "__check_init__", "__new__"}
        if constructors & vars(cls).keys():
            _with_own_constructor.add(cls)

    def __new__(cls, *values, **named):
        names = _names(cls)
        for name in named:
            if name not in names:
                hint = did_you_mean(name, names) if names else "it has none"
                raise TypeError(f"{cls.__name__} has no field {name!r}; {hint}")
        # More than there are fields: Python itself complains.
        for name, value in (*zip(names, values, strict=False), *named.items()):
            if name in _numeric(cls):
                _check(cls, name, value)
        return super().__new__(cls)

    __setstate__ = set_in_float64

    def __repr__(self) -> str:
        inside = [f"{name}={value}" for name, value, _ in _own_rows(self)]
        inside += [f"{name}={of!r}" for name, of in unusual_fields(self).items()]
        return f"{type(self).__name__}({', '.join(inside)})"

    def _repr_html_(self) -> str:
        return html_table([type(self).__name__], _own_rows(self))


def _withdraw_statements(kind: type[Part]) -> None:
    """Withdraw statements about functions that a class overrides; see `Part`."""
    classes = kind.__mro__

    def place(name: str) -> int:
        return next((k for k, c in enumerate(classes) if name in vars(c)), len(classes))

    for general in classes:
        for name, functions in vars(general).get("statements", {}).items():
            if min(map(place, functions)) < place(name) < classes.index(general):
                setattr(kind, name, vars(general)[name])


@functools.cache
def _names(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in dataclasses.fields(kind))


@functools.cache
def _takes_fields_alone(kind: type[Part]) -> bool:
    """Whether a part of a class is made by taking its fields, and nothing else."""
    return not any(base in _with_own_constructor for base in kind.__mro__)


def with_fields(kind: type[Made], fields: dict[str, Any]) -> Made:
    """Make a module of all its fields, which have been checked and converted.

    It takes a tenth of the time of the constructor.
    """
    made = object.__new__(kind)
    vars(made).update(fields)
    return made


def _changed(part: Part, values: dict[str, Any]) -> Part:
    """Return a part with other values of some parameters, which have been checked."""
    kind = type(part)
    if not _takes_fields_alone(kind):
        return dataclasses.replace(part, **values)
    converted = {name: float64_leaf(value) for name, value in values.items()}
    return with_fields(kind, vars(part) | converted)


@functools.cache
def _numeric(kind: type) -> set[str]:
    return {f.name for f in dataclasses.fields(kind)} - fixed_fields(kind).keys()


def part(base: type[Part], default: type[Part]) -> Any:
    """Declare a field that holds a part.

    Args:
        base: class from which the part must derive.
        default: class of the part if none is given.
    """
    return eqx.field(default_factory=default, metadata={"base": base})


@functools.cache
def parts_of(kind: type) -> dict[str, type[Part]]:
    """Return the fields of a composite that hold parts, with their base classes."""
    fields = dataclasses.fields(kind)
    return {f.name: f.metadata["base"] for f in fields if "base" in f.metadata}


def default_part(kind: type, slot: str) -> type[Part]:
    """Return the class that a slot of a composite has if none is given."""
    (field,) = (field for field in dataclasses.fields(kind) if field.name == slot)
    return cast(type[Part], field.default_factory)


@functools.cache
def _default_of(kind: type, slot: str) -> Part:
    """Make the part that a slot has if none is given: one for all, to save time."""
    return default_part(kind, slot)()


class Composite(Module):
    """Parameters of its own, and parts that own theirs.

    All parameters are set and read by their names alone, wherever they stand:
    `Soil(gamma_v=5.0)` is `Soil(flow=Perzyna(gamma_v=5.0))`, and `soil.gamma_v` is
    `soil.flow.gamma_v`. A parameter given by its name takes precedence over the one of
    a part given beside it, so that `dataclasses.replace(soil, gamma_v=5.0)` does what
    it says.

    Raises InputError for values that are no numbers and parts of another class,
    TypeError for an unknown parameter, with the nearest known.
    """

    def __init_subclass__(cls, **arguments):
        super().__init_subclass__(**arguments)
        _add_table(cls)

        @functools.wraps(Composite.__init__)
        def init(self, *values, **named):
            Composite.__init__(self, *values, **named)

        # Equinox reads the signature of a class off its `__init__`.
        init.__signature__ = _signature(cls)  # pyright: ignore[reportAttributeAccessIssue]
        cls.__init__ = init

    __setstate__ = set_in_float64

    def __init__(self, *values, **named):
        kind = type(self)
        fields = {field.name: field for field in dataclasses.fields(kind)}
        if len(values) > len(fields):
            raise TypeError(
                f"{kind.__name__} takes at most {len(fields)} values, but "
                f"{len(values)} were given"
            )
        by_place = dict(zip(fields, values, strict=False))
        if twice := by_place.keys() & named.keys():
            raise TypeError(f"{kind.__name__} got two values of {min(twice)!r}")
        named = by_place | named
        for slot, base in parts_of(kind).items():
            given_part = named.pop(slot, None)
            if isinstance(given_part, str):
                given_part = find_part(slot, base, given_part)
            if given_part is None:
                given_part = _default_of(kind, slot)
            else:
                _check_part(f"{kind.__name__}.{slot}", base, given_part)
            object.__setattr__(self, slot, given_part)
        owner = _owners(kind, tuple(type(vars(self)[slot]) for slot in parts_of(kind)))
        changed: dict[str, dict] = {}
        for name, value in named.items():
            if name in owner:
                slot = owner[name]
                _check(kind, name, value, type(vars(self)[slot]))
                changed.setdefault(slot, {})[name] = value
            elif name not in fields:
                known = (*fields, *owner)
                raise TypeError(
                    f"{kind.__name__} has no parameter {name!r}{_unusual_parts(self)}; "
                    f"{did_you_mean(name, known)}"
                )
        for slot, values in changed.items():
            object.__setattr__(self, slot, _changed(vars(self)[slot], values))
        for name in declared_of(kind):
            value = named.get(name, fields[name].default)
            _check(kind, name, value)
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        inside = [f"{name}={value}" for name, value, _ in _own_rows(self)]
        inside += [f"{slot}={getattr(self, slot)!r}" for slot in parts_of(type(self))]
        return f"{type(self).__name__}({', '.join(inside)})"

    def __str__(self) -> str:
        """Write a table of all parameters, with units and meanings, part by part."""
        lines, indent = [type(self).__name__], "  "
        for row in self.rows():
            if len(row) == 1:
                lines.append(f"  {row[0]}")
                indent = "    "
            else:
                lines.append(f"{indent}{row[0]:<18} {row[1]:<14} {row[2]}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return html_table([type(self).__name__], self.rows())

    def rows(self) -> list[Row]:
        """Return name, value and meaning of every parameter; above those of a part a
        row of one cell with its field and class."""
        rows = _own_rows(self)
        for slot in parts_of(type(self)):
            part = getattr(self, slot)
            rows += [(f"{slot}: {type(part).__name__}",), *_own_rows(part)]
        return rows

    def path_of(self, name: str) -> tuple[str, ...]:
        """Return field names that lead to a parameter: that of the part that owns it,
        if one does, and its own."""
        for slot in parts_of(type(self)):
            if name in parameters_of(vars(self)[slot]):
                return slot, name
        return (name,)

    def __getattr__(self, name: str) -> Any:
        slots, fields = parts_of(type(self)), vars(self)
        if not name.startswith("__"):
            for slot in slots:
                if slot in fields and name in parameters_of(fields[slot]):
                    return getattr(fields[slot], name)
            if all(slot in fields for slot in slots):
                known = [*fields, *(n for s in slots for n in parameters_of(fields[s]))]
                raise AttributeError(
                    f"{type(self).__name__} has no parameter {name!r}"
                    f"{_unusual_parts(self)}; {did_you_mean(name, known)}"
                )
        raise AttributeError(f"{type(self).__name__!r} object has no {name!r}")

    def __dir__(self):
        slots = parts_of(type(self))
        names = (n for slot in slots for n in parameters_of(vars(self)[slot]))
        return sorted({*super().__dir__(), *names})


@functools.cache
def _owners(kind: type[Composite], parts: tuple[type[Part], ...]) -> dict[str, str]:
    """Find the slot of each parameter of the parts. Raises InputError where two of them
    have one name."""
    owners: dict[str, type] = dict.fromkeys(_names(kind), kind)
    slots: dict[str, str] = {}
    for slot, part_class in zip(parts_of(kind), parts, strict=True):
        for name in declared_of(part_class):
            if name in owners:
                raise InputError(
                    f"{part_class.__name__}.{name} and {owners[name].__name__}.{name} "
                    "are two parameters of one name; rename the one that is yours"
                )
            owners[name], slots[name] = part_class, slot
    return slots


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
    check_fixed_fields(part)


@functools.cache
def _check_fields(kind: type[Part]) -> None:
    """Raise InputError for a field of a part that is neither a parameter nor static."""
    for field in dataclasses.fields(kind):
        if "declared" not in field.metadata and not field.metadata.get("static"):
            raise InputError(
                f"{kind.__name__}.{field.name} is no parameter; write {field.name}: "
                "Scalar = parameter(default, unit, range, meaning)"
            )


def _check(kind: type, name: str, value, owner: type | None = None) -> None:
    """Check a parameter that a class is given, and that it or another one owns."""
    # Most values are floats, and numbers for sure.
    if type(value) is not float:
        value = real_numbers(f"{kind.__name__}.{name}", value)
    declared = declared_of(owner or kind).get(name)
    # To look at an array of JAX would wait for it, or fail while it is traced.
    if declared and declared.unit == "deg" and not isinstance(value, jax.Array):
        _check_radians(f"{kind.__name__}.{name}", declared, value)


def _check_radians(place: str, declared: Declared, value) -> None:
    """Warn of angles that were likely given in degrees."""
    ranges = declared.ends, declared.usual
    largest = min(max(map(abs, ends)) for ends in ranges)
    size = np.max(np.abs(value), initial=0.0)
    if size > math.radians(largest) * (1.0 + 1e-9):
        text = (
            f"{place} is in radians, and {size:.6g} rad are {math.degrees(size):.4g} "
            f"deg, beyond {largest:g} deg; for degrees, write math.radians({size:.6g})"
        )
        # Of the caller of a class, behind what Equinox and this module do
        warnings.warn(UnusualValueWarning(text, declared.column), stacklevel=7)


def _unusual_parts(whole: Composite) -> str:
    """Name the unusual parts of a composite, to follow a message."""
    kind = type(whole)
    others = [
        f"{slot} {type(part).__name__}"
        for slot in parts_of(kind)
        if type(part := vars(whole)[slot]) is not default_part(kind, slot)
    ]
    return f" with {' and '.join(others)}" if others else ""


def parameters_of(part: Part) -> dict[str, Declared]:
    """Return the parameters of a part: field name to what is declared of it."""
    return declared_of(type(part))


caches_by_class = (
    declared_of,
    _names,
    _numeric,
    _takes_fields_alone,
    parts_of,
    _default_of,
    _owners,
    _check_fields,
    fixed_fields,
)
"""What is worked out once for each class."""

"""A study: what is fitted to which data, read from TOML and CSV."""

import dataclasses
import math
from pathlib import Path

import numpy as np

from ..accuracy import DEFAULT_ACCURACY, PRESETS
from ..columns import RESULT_COLUMNS, SIGMA_PREFIX
from ..errors import InputError, nearest
from ..tables import Table, read_table
from ..toml_values import (
    SOIL_COLUMNS,
    allowed,
    choice,
    load_toml,
    number,
    soil_values,
    typed,
    unknown,
    whole,
)
from .fit import METHODS

KEYS = (
    "title",
    "source",
    "notes",
    "data",
    "targets",
    "starts",
    "seed",
    "accuracy",
    "method",
    "parameters",
    "soil",
    "default_sigma",
    "variants",
)
DEFAULT_BOUNDS = {
    "c_v": (0.01, 10.0),
    "gamma_v": (0.05, 500.0),
    "k_E": (10.0, 1e5),
}
"""Of the parameters that are fitted unless a study says otherwise."""
NOMINAL_SIGMA = 0.05
"""Part of a target's root mean square that stands for a sigma that is not given: it
weighs targets of different units, and the variance is then estimated."""


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A soil parameter to be fitted, in the unit of its column."""

    name: str
    start: float
    lower: float
    upper: float

    @property
    def logarithmic(self) -> bool:
        """Whether it is fitted in the logarithm: where it is always positive."""
        return self.lower > 0.0


@dataclasses.dataclass(frozen=True)
class Variant:
    """The same fit with some of the fixed soil values changed."""

    name: str
    soil: dict[str, float]


@dataclasses.dataclass(frozen=True)
class Study:
    """A study, checked."""

    path: Path
    title: str
    source: str
    notes: str
    table: Table
    parameters: tuple[Parameter, ...]
    soil: dict[str, float]
    targets: tuple[str, ...]
    measured: np.ndarray
    sigma: np.ndarray
    sigma_given: bool
    starts: int
    seed: int
    accuracy: str
    method: str
    variants: tuple[Variant, ...]


def read_study(path: Path) -> Study:
    """Read a study and its data.

    Raises InputError, naming file and key, or file, row and column, for whatever cannot
    be used.
    """
    path = Path(path)
    content = load_toml(path)
    for key in content:
        if key not in KEYS:
            unknown(path, key, key, KEYS)
    if "data" not in content:
        raise InputError(
            "is missing; it names the table of tests", file=path, key="data"
        )
    table = read_table(path.parent / typed(path, content, "data", str), measured=True)
    parameters = _parameters(path, content)
    fixed = soil_values(path, typed(path, content, "soil", dict, {}), "soil")
    variants = _variants(path, content)
    _check_given_once(path, table, parameters, fixed, variants)
    targets = _targets(path, content, table)
    sigma, sigma_given = _sigma(path, content, table, targets)
    accuracy = choice(path, content, "accuracy", DEFAULT_ACCURACY, tuple(PRESETS))
    return Study(
        path=path,
        title=typed(path, content, "title", str, path.parent.name),
        source=typed(path, content, "source", str, ""),
        notes=typed(path, content, "notes", str, ""),
        table=table,
        parameters=parameters,
        soil=fixed,
        targets=targets,
        measured=np.stack([table.numbers[name] for name in targets], axis=1),
        sigma=sigma,
        sigma_given=sigma_given,
        starts=whole(path, content, "starts", 16, 1),
        seed=whole(path, content, "seed", 0, 0),
        accuracy=accuracy,
        method=choice(path, content, "method", METHODS[0], METHODS),
        variants=variants,
    )


def _parameters(path: Path, content: dict) -> tuple[Parameter, ...]:
    chosen = typed(
        path, content, "parameters", dict, {name: {} for name in DEFAULT_BOUNDS}
    )
    if not chosen:
        raise InputError("names no parameter to fit", file=path, key="parameters")
    return tuple(_parameter(path, name, entry) for name, entry in chosen.items())


def _parameter(path: Path, name: str, entry) -> Parameter:
    key = f"parameters.{name}"
    if name not in SOIL_COLUMNS:
        unknown(path, key, name, SOIL_COLUMNS)
    if not isinstance(entry, dict):
        raise InputError(
            "must be a table like { start = 1.0, lower = 0.1, upper = 10.0 }, but is "
            f"{entry!r}",
            file=path,
            key=key,
        )
    known = ("start", "lower", "upper")
    for inner in entry:
        if inner not in known:
            unknown(path, f"{key}.{inner}", inner, known)
    column = SOIL_COLUMNS[name]
    lower, upper = DEFAULT_BOUNDS.get(name, (None, None))
    values = {"start": column.default, "lower": lower, "upper": upper} | entry
    for inner, value in values.items():
        if value is None:
            raise InputError(
                f"is missing; {name} has no default bounds",
                file=path,
                key=f"{key}.{inner}",
            )
        values[inner] = allowed(path, f"{key}.{inner}", column, value)
    if not values["lower"] < values["upper"]:
        raise InputError(
            f"must be above lower, {values['lower']:g}, but is {values['upper']:g}",
            file=path,
            key=f"{key}.upper",
        )
    if not values["lower"] < values["start"] < values["upper"]:
        raise InputError(
            f"must lie between {values['lower']:g} and {values['upper']:g}, but is "
            f"{values['start']:g}",
            file=path,
            key=f"{key}.start",
        )
    return Parameter(name, **values)


def _variants(path: Path, content: dict) -> tuple[Variant, ...]:
    entries = typed(path, content, "variants", list, [{}])
    if not entries:
        raise InputError("holds no variant; leave it out", file=path, key="variants")
    variants = []
    for place, entry in enumerate(entries, 1):
        where = f"variants[{place}]"
        if not isinstance(entry, dict):
            raise InputError(f"must be a table, but is {entry!r}", file=path, key=where)
        named = dict(entry)
        words = (
            "as given" if not entry else ", ".join(f"{k} {v}" for k, v in entry.items())
        )
        name = typed(path, named, "name", str, words)
        named.pop("name", None)
        variants.append(Variant(name, soil_values(path, named, where)))
    names = [variant.name for variant in variants]
    for place, name in enumerate(names, 1):
        if names.count(name) > 1:
            raise InputError(
                f"name {name!r} stands twice", file=path, key=f"variants[{place}]"
            )
    return tuple(variants)


def _check_given_once(path, table, parameters, fixed, variants) -> None:
    """Raise InputError for a soil value that stands in two places."""
    for parameter in parameters:
        for place, values in (
            ("soil", fixed),
            *((f"variants[{i}]", v.soil) for i, v in enumerate(variants, 1)),
            (table.path.name, table.numbers),
        ):
            if parameter.name in values:
                raise InputError(
                    f"is fitted, but stands in {place} too; remove one",
                    file=path,
                    key=f"parameters.{parameter.name}",
                )
    for where, values in (
        ("soil", fixed),
        *((f"variants[{i}]", v.soil) for i, v in enumerate(variants, 1)),
    ):
        for name in values:
            if name in table.numbers:
                raise InputError(
                    f"stands in {table.path.name} too; remove one",
                    file=path,
                    key=f"{where}.{name}",
                )


def _targets(path: Path, content: dict, table: Table) -> tuple[str, ...]:
    present = [name for name in RESULT_COLUMNS if name in table.numbers]
    if not present:
        raise InputError(
            "has no measured result to fit; add a column like e_n, or any of "
            f"{', '.join(list(RESULT_COLUMNS)[1:])}",
            file=table.path,
        )
    targets = typed(path, content, "targets", list, present)
    if not targets:
        raise InputError("names no result to fit", file=path, key="targets")
    for name in targets:
        if name not in tuple(RESULT_COLUMNS):
            raise InputError(
                f"{name!r} is unknown; did you mean {nearest(name, RESULT_COLUMNS)}?",
                file=path,
                key="targets",
            )
        if name not in present:
            raise InputError(
                f"{name} is no column of {table.path.name}", file=path, key="targets"
            )
        if targets.count(name) > 1:
            raise InputError(f"{name} stands twice", file=path, key="targets")
    angles = table.numbers.get("angle_deg", np.zeros(len(table.rows)))
    if "e_t" in targets and np.any(angles == 0.0):
        raise InputError(
            "e_t has no meaning at angle_deg 0; remove such tests or the target",
            file=table.path,
            column="e_t",
        )
    return tuple(targets)


def _sigma(path, content, table, targets) -> tuple[np.ndarray, bool]:
    """Sigma of every test and target, and whether they were given."""
    defaults = typed(path, content, "default_sigma", dict, {})
    for name, value in defaults.items():
        key = f"default_sigma.{name}"
        if name not in RESULT_COLUMNS:
            unknown(path, key, name, RESULT_COLUMNS)
        if not number(path, key, value) > 0.0:
            raise InputError(f"must be above 0, but is {value}", file=path, key=key)
    given = [n for n in targets if SIGMA_PREFIX + n in table.numbers or n in defaults]
    if given and len(given) < len(targets):
        missing = next(name for name in targets if name not in given)
        raise InputError(
            f"{missing} has no sigma, but {given[0]} has; give both or none",
            file=path,
            key="default_sigma",
        )
    columns = []
    for name in targets:
        measured = table.numbers[name]
        scale = math.sqrt(np.mean(measured**2)) or 1.0
        default = defaults.get(name, NOMINAL_SIGMA * scale)
        fallback = np.full(len(measured), float(default))
        columns.append(table.numbers.get(SIGMA_PREFIX + name, fallback))
    return np.stack(columns, axis=1), bool(given)

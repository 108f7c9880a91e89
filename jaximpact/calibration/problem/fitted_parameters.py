"""Fitted parameters of a study: bounds, priors, ties, and deviations of groups."""

import dataclasses
from collections.abc import Iterable, Mapping
from pathlib import Path

from ...errors import InputError
from ...io.toml import allowed, check_keys, check_table, choice, number, typed, unknown
from ...quantities import LABEL_COLUMNS, InputColumn
from .dataset import CAMPAIGN, Measurements
from .expressions import Tied, read_tied
from .nuisance import (
    EACH_TEST,
    MOST_GROUP_SD,
    NOMINAL_GROUP_SD,
    Nuisance,
    Prior,
    pooled_nuisance,
    read_prior,
)

DEFAULT_BOUNDS = {
    "c_v": (0.01, 10.0),
    "gamma_v": (0.05, 500.0),
    "k_E": (10.0, 1e5),
}
"""Bounds of the parameters that are fitted by default [units of the columns]."""
ESTIMATED = "estimated"


@dataclasses.dataclass(frozen=True)
class Parameter:
    """Soil parameter to be fitted, in the unit of its column."""

    name: str
    start: float
    lower: float
    upper: float
    prior: Prior | None = None

    @property
    def logarithmic(self) -> bool:
        """Whether its logarithm is fitted, as where it is always positive."""
        return self.lower > 0.0


def read_parameters(
    path: Path,
    content: dict,
    columns: Mapping[str, InputColumn],
    fixed: dict[str, float],
    tests: Measurements,
) -> tuple[tuple[Parameter, ...], tuple[Tied, ...], tuple[Nuisance, ...]]:
    """Read the fitted parameters, those tied to them, and deviations of groups."""
    columns = {name: c for name, c in columns.items() if c.part == "soil"}
    usual = {name: {} for name in DEFAULT_BOUNDS if name in columns}
    chosen = typed(path, content, "parameters", dict, usual)
    if not chosen:
        raise InputError("names no parameter to fit", file=path, key="parameters")
    chosen = dict(chosen)
    expressions = {
        name: chosen.pop(name)
        for name, entry in [*chosen.items()]
        if isinstance(entry, dict) and "expression" in entry
    }
    fitted = tuple(_parameter(path, *named, columns) for named in chosen.items())
    ranges = {p.name: (p.lower, p.upper) for p in fitted}
    tied = []
    for name, entry in expressions.items():
        key = f"parameters.{name}"
        if name not in columns:
            unknown(path, key, name, columns)
        check_keys(path, key, entry, ("expression",))
        if not fitted:
            raise InputError("names no fitted parameter", file=path, key=key)
        given = key, name, entry["expression"]
        tied.append(read_tied(path, *given, ranges, fixed, columns[name]))
    pooled = (_pooled(path, p, chosen[p.name], tests) for p in fitted)
    return fitted, tuple(tied), tuple(one for one in pooled if one is not None)


def _pooled(
    path: Path, parameter: Parameter, entry: dict, tests: Measurements
) -> Nuisance | None:
    """Read the groups of a parameter, if it has any."""
    key = f"parameters.{parameter.name}"
    if "by" not in entry and "group_sd" not in entry:
        return None
    if "by" not in entry:
        raise InputError(
            "is missing: the column whose values are the groups of group_sd",
            file=path,
            key=f"{key}.by",
        )
    by = choice(path, entry, "by", CAMPAIGN, (*LABEL_COLUMNS, EACH_TEST))
    stated = entry.get("group_sd", ESTIMATED)
    estimated = stated == ESTIMATED
    sd = NOMINAL_GROUP_SD if estimated else number(path, f"{key}.group_sd", stated)
    if not (0.0 < sd <= MOST_GROUP_SD and parameter.logarithmic):
        raise InputError(
            f"must lie above 0 and up to {MOST_GROUP_SD:g}, for a parameter whose "
            f"lower bound is above 0, but is {sd:g}",
            file=path,
            key=f"{key}.group_sd",
        )
    sd = None if estimated else sd
    return pooled_nuisance(path, parameter.name, by, sd, tests)


def _parameter(
    path: Path, name: str, entry, columns: Mapping[str, InputColumn]
) -> Parameter:
    key = f"parameters.{name}"
    if name not in columns:
        unknown(path, key, name, columns)
    keys = "start", "lower", "upper", "prior", "by", "group_sd"
    check_table(path, key, entry, keys, "{ start = 1.0, lower = 0.1, upper = 10.0 }")
    entry = {name: entry[name] for name in entry if name in keys[:4]}
    column = columns[name]
    lower, upper = DEFAULT_BOUNDS.get(name, (None, None))
    values = {"start": column.default, "lower": lower, "upper": upper} | entry
    prior = None
    if "prior" in values:
        prior = read_prior(path, f"{key}.prior", values.pop("prior"))
    for inner, value in values.items():
        if value is None:
            raise InputError(
                f"is missing; {name} has no default bounds: say lower and upper",
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
        usual = "is" if "start" in entry else "is not given, and the usual value is"
        raise InputError(
            f"must lie between {values['lower']:g} and {values['upper']:g}, but "
            f"{usual} {values['start']:g}",
            file=path,
            key=f"{key}.start",
        )
    return Parameter(name, **values, prior=prior)


def check_constants(
    path: Path, tied: Iterable[Tied], soils: Iterable[Mapping[str, float]]
) -> None:
    """Raise InputError where a variant changes a value of the soil that an expression
    holds fixed."""
    changed = {name for soil in soils for name in soil}
    for one in tied:
        for name in one.constants:
            if name in changed:
                raise InputError(
                    f"names {name}, which the variants change; fit them in studies of "
                    "their own",
                    file=path,
                    key=f"parameters.{one.name}.expression",
                )

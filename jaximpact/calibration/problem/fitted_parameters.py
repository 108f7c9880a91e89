"""Fitted parameters of a study: bounds, priors, ties, and deviations of groups."""

import dataclasses
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from ...io.toml import (
    Key,
    allowed,
    check_keys,
    check_table,
    choice,
    number,
    typed,
    unknown,
)
from ...quantities import LABEL_COLUMNS, InputColumn
from .dataset import CAMPAIGN, Measurements
from .expressions import Tied, read_tied
from .nuisance import EACH_TEST, REACH, Nuisance, Prior, pooled_nuisance, read_prior

FITTED = "c_v", "gamma_v", "k_E"
"""Parameters that are fitted by default."""
DEFAULTS: dict[str, dict[str, Any]] = {
    "c_v": {"lower": 0.01, "upper": 10.0},
    "gamma_v": {"lower": 0.05, "upper": 500.0},
    "k_E": {"lower": 10.0, "upper": 1e5},
    # From no cohesion that would matter to that of soft rock
    "cohesion_kPa": {"start": 10.0, "lower": 0.01, "upper": 1e4},
}
"""Bounds, and the start where the soil's own value is none, of parameters for which
neither need be given [units of the columns]."""


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
    top: Key,
    content: dict,
    columns: Mapping[str, InputColumn],
    fixed: dict[str, float],
    tests: Measurements,
) -> tuple[tuple[Parameter, ...], tuple[Tied, ...], tuple[Nuisance, ...]]:
    """Read the fitted parameters, those tied to them, and deviations of groups."""
    columns = {name: c for name, c in columns.items() if c.part == "soil"}
    usual = {name: {} for name in FITTED if name in columns}
    chosen = typed(top, content, "parameters", dict, usual)
    if not chosen:
        raise top["parameters"].error("names no parameter to fit")
    chosen = dict(chosen)
    expressions = {
        name: chosen.pop(name)
        for name, entry in [*chosen.items()]
        if isinstance(entry, dict) and "expression" in entry
    }
    fitted = tuple(_parameter(top, *named, columns) for named in chosen.items())
    ranges = {p.name: (p.lower, p.upper, p.start) for p in fitted}
    tied = []
    for name, entry in expressions.items():
        key = top["parameters"][name]
        if name not in columns:
            raise unknown(top["parameters"], name, columns)
        check_keys(key, entry, ("expression",))
        if not fitted:
            raise key.error("names no fitted parameter")
        expression = key["expression"], name, entry["expression"]
        tied.append(read_tied(*expression, ranges, fixed, columns[name]))
    pooled = (_pooled(top, p, chosen[p.name], tests) for p in fitted)
    return fitted, tuple(tied), tuple(one for one in pooled if one is not None)


def _pooled(
    top: Key, parameter: Parameter, entry: dict, tests: Measurements
) -> Nuisance | None:
    key = top["parameters"][parameter.name]
    if "by" not in entry and "group_sd" not in entry:
        return None
    if "by" not in entry:
        raise key["by"].error(
            "is missing: the column whose values are the groups of group_sd"
        )
    by = choice(key, entry, "by", CAMPAIGN, (*LABEL_COLUMNS, EACH_TEST))
    if "group_sd" not in entry:
        raise key["group_sd"].error(
            "is missing: the standard deviation of the groups' logarithms, like 0.3"
        )
    sd = number(key["group_sd"], entry["group_sd"])
    # Factors of a group reach up to exp(REACH * sd).
    if not (0.0 < sd <= 1.0 and parameter.logarithmic):
        raise key["group_sd"].error(
            "must lie above 0 and up to 1, for a parameter whose lower bound is above "
            f"0, but is {sd:g}"
        )
    return pooled_nuisance(top, parameter.name, by, sd, tests)


def _parameter(
    top: Key, name: str, entry, columns: Mapping[str, InputColumn]
) -> Parameter:
    key = top["parameters"][name]
    if name not in columns:
        raise unknown(top["parameters"], name, columns)
    keys = "start", "lower", "upper", "prior", "by", "group_sd"
    check_table(key, entry, keys, "{ start = 1.0, lower = 0.1, upper = 10.0 }")
    entry = {name: entry[name] for name in entry if name in keys[:4]}
    column = columns[name]
    values = {"start": column.default, "lower": None, "upper": None}
    values |= DEFAULTS.get(name, {}) | entry
    prior = None
    if "prior" in values:
        prior = read_prior(key["prior"], values.pop("prior"))
    for inner, value in values.items():
        if value is None:
            raise key[inner].error(
                f"is missing; {name} has no default bounds: say lower and upper"
            )
        values[inner] = allowed(key[inner], column, value)
    if not values["lower"] < values["upper"]:
        raise key["upper"].error(
            f"must be above lower, {values['lower']:g}, but is {values['upper']:g}"
        )
    if not values["lower"] < values["start"] < values["upper"]:
        usual = "is" if "start" in entry else "is not given, and the usual value is"
        raise key["start"].error(
            f"must lie between {values['lower']:g} and {values['upper']:g}, but "
            f"{usual} {values['start']:g}"
        )
    if prior is not None:
        nearest = min(max(prior.mean, values["lower"]), values["upper"])
        if abs(prior.mean - nearest) > REACH * prior.sd:
            raise key["prior"].error(
                f"must not lie more than {REACH:g} standard deviations beyond "
                f"the bounds, {values['lower']:g} and {values['upper']:g}, but is "
                f"{prior.mean:g} +- {prior.sd:g}"
            )
    return Parameter(name, **values, prior=prior)


def check_constants(
    top: Key,
    tied: Iterable[Tied],
    soils: Iterable[Mapping[str, float]],
    nuisances: Collection[str],
) -> None:
    """Raise InputError where a variant or a nuisance changes a value of the soil that
    an expression holds fixed."""
    changed = {name for soil in soils for name in soil}
    for one in tied:
        for name in one.constants:
            if name in nuisances:
                raise top["parameters"][one.name]["expression"].error(
                    f"names {name}, which is a nuisance; write its value instead"
                )
            if name in changed:
                raise top["parameters"][one.name]["expression"].error(
                    f"names {name}, which the variants change; fit them in studies of "
                    "their own"
                )

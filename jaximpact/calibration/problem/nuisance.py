"""Nuisance parameters: poorly known quantities of the tests, fitted under a prior.

A nuisance parameter has a value for each group of tests: a slope for each campaign, an
orientation for each test. Where the tables hold the column, it is added to their
values; otherwise it is the value itself.
"""

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ...io.scene_table import MOST_MEASURED
from ...io.toml import Key, check_table, choice, number, typed, unknown
from ...quantities import LABEL_COLUMNS
from .dataset import Measurements

EACH_TEST = "row"
"""Value of `by` for groups of one test each."""
REACH = 5.0
"""Half range of the search in standard deviations of the prior: no value farther off is
meant by it."""


@dataclasses.dataclass(frozen=True)
class Prior:
    """Normal prior distribution, in the unit of the column."""

    mean: float
    sd: float


@dataclasses.dataclass(frozen=True)
class Nuisance:
    """Nuisance parameter: one column, with a value for each group."""

    name: str
    by: str
    groups: tuple[str, ...]
    group: np.ndarray
    """Index of the group of each test, shape (tests,)."""
    prior: Prior
    base: np.ndarray
    """Value to which it is added, shape (tests,): the tables' column, or zero."""
    lower: np.ndarray
    """Lower bounds, shape (groups,); `upper` holds the upper ones."""
    upper: np.ndarray
    pooled: bool = False
    """Whether it is the logarithm of a group's factor on a fitted parameter."""

    def label(self, group: int) -> str:
        """Return the name of a group's value."""
        return f"{self.name}[{self.groups[group]}]"

    def places_in(
        self, unknowns: tuple[str, ...], tests: Measurements
    ) -> list[int | None]:
        """Find the groups of tests among the unknowns of a fit; None for a new one, as
        where each test is a group, or where a file name stands for a campaign."""
        labels = [self.label(group) for group in range(len(self.groups))]
        if self.by == EACH_TEST or self.by not in tests.files[0].labels:
            return [None] * len(labels)
        return [unknowns.index(n) if n in unknowns else None for n in labels]


def read_prior(key: Key, entry, mean: float | None = None) -> Prior:
    """Read a prior like `{ mean = 30.0, sd = 5.0 }`; the mean may have a default."""
    check_table(key, entry, ("mean", "sd"), "{ mean = 30.0, sd = 5.0 }")
    values: dict[str, Any] = {"mean": mean} | entry
    for name in ("mean", "sd"):
        if values.get(name) is None:
            raise key[name].error("is missing")
        values[name] = number(key[name], values[name])
    values["sd"] = read_size(key["sd"], values["sd"])
    return Prior(**values)


def read_size(key: Key, value) -> float:
    """Read a number above 0, like a standard deviation, of which costs have the
    square: as large or small as one in a table."""
    size = number(key, value, above=0.0)
    if not 1.0 / MOST_MEASURED <= size <= MOST_MEASURED:
        raise key.error(
            f"must be from {1.0 / MOST_MEASURED:g} to {MOST_MEASURED:g}, but is "
            f"{size:g}"
        )
    return size


def read_nuisances(
    top: Key, content: dict, tests: Measurements, soil: dict[str, float]
) -> tuple[Nuisance, ...]:
    """Read the table `nuisance` of a study."""
    entries = typed(top, content, "nuisance", dict, {})
    return tuple(_nuisance(top, n, e, tests, soil) for n, e in entries.items())


def open_nuisances(
    entries: Mapping[str, Mapping], tests: Measurements, soil: dict[str, float]
) -> tuple[Nuisance, ...]:
    """Select the nuisance parameters of a fit, as `entries_of` writes them, that new
    tests leave open.

    Raises InputError for new tests without a column to which the fit has added.
    """
    top, chosen, pooled = Key(tests.files[0].path), {}, []
    for name, entry in entries.items():
        in_table = name in tests.inputs
        if entry.get("pooled"):
            sd = entry["prior"]["sd"]
            pooled.append(pooled_nuisance(top, name, entry["by"], sd, tests))
        elif entry["added"] and not in_table:
            raise top.error(
                f"has no column {name}, to which the fit added what it found"
            )
        elif entry["added"] or not in_table:  # else known here, unlike in the fit
            chosen[name] = {key: entry[key] for key in entry if key != "added"}
    return (*read_nuisances(top, {"nuisance": chosen}, tests, soil), *pooled)


def pooled_nuisance(
    top: Key, name: str, by: str, sd: float, tests: Measurements
) -> Nuisance:
    """Make the groups' deviations from a fitted parameter: logarithms of factors, under
    a normal prior of mean 0."""
    groups, group = _groups(top["parameters"][name], by, tests)
    reach = np.full(len(groups), REACH * sd)
    prior, base = Prior(0.0, sd), np.zeros(len(tests))
    return Nuisance(name, by, groups, group, prior, base, -reach, reach, pooled=True)


def entries_of(nuisances: Iterable[Nuisance], tests: Measurements) -> dict[str, dict]:
    """Write nuisance parameters of fitted tests for fit.json: also whether each was
    `added` to a column of the tests, and whether it is `pooled`."""
    return {
        n.name: {"by": n.by, "prior": dataclasses.asdict(n.prior)}
        | {"added": n.name in tests.inputs}
        | ({"pooled": True} if n.pooled else {})
        for n in nuisances
    }


def _nuisance(top: Key, name: str, entry, tests: Measurements, soil) -> Nuisance:
    key = top["nuisance"][name]
    columns = tests.known_columns
    if name not in columns:
        raise unknown(top["nuisance"], name, columns)
    like = '{ by = "campaign", prior = { mean = 30.0, sd = 5.0 } }'
    check_table(key, entry, ("by", "prior"), like)
    by = choice(key, entry, "by", "campaign", (*LABEL_COLUMNS, EACH_TEST))
    if "prior" not in entry:
        raise key["prior"].error("is missing, like { mean = 30.0, sd = 5.0 }")
    in_tables = name in tests.inputs
    known = 0.0 if in_tables else soil.get(name)
    prior = read_prior(key["prior"], entry["prior"], known)
    base = tests.inputs.get(name, np.zeros(len(tests)))
    groups, group = _groups(key, by, tests)
    lower = np.full(len(groups), prior.mean - REACH * prior.sd)
    upper = np.full(len(groups), prior.mean + REACH * prior.sd)
    # The ends of the column's range are not in it, as 0 of a mass.
    room = 1e-6 * 2.0 * REACH * prior.sd
    column = columns[name]
    np.maximum.at(lower, group, column.lower - base + room)
    np.minimum.at(upper, group, column.upper - base - room)
    if not np.all((lower < prior.mean) & (prior.mean < upper)):
        raise key["prior"]["mean"].error(
            f"{name} must be {column.requirement}; the prior's mean puts it outside"
        )
    return Nuisance(name, by, groups, group, prior, base, lower, upper)


def _groups(key: Key, by: str, tests: Measurements):
    """List the groups in the order of the tests, and the index of each test's."""
    if by == EACH_TEST:
        first, group = np.unique(tests.first_of_row, return_inverse=True)
        return tests.names_apart(first), group
    if by not in tests.labels:
        raise key["by"].error(f"{by!r} is no column of {tests.files[0].path.name}")
    labels = tests.labels[by]
    if "" in labels:
        raise tests.error(labels.index(""), by, "is empty, but groups the tests")
    groups = tuple(dict.fromkeys(labels))
    return groups, np.array([groups.index(label) for label in labels])

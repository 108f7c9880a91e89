"""Contact laws of a study, as its file names them."""

import hashlib
import itertools
import math
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...accuracy import DEFAULT_ACCURACY, PRESETS
from ...finding import file_of, find_class, shipped
from ...identity import name_of
from ...io.files import read_input
from ...io.toml import Key, allowed, check_keys, choice, of_kind, one_line, typed
from ...lookup import Tabulated, read_table
from ...quantities import InputColumn, own_columns
from ...rebound import AbstractRebound
from ..blocks import Release
from ..contacts.contact_models import ClosedForm, Contacts, FullModel
from ..contacts.roughness import CUT
from ..terrain import Ground, Profile, spread

FULL_MODEL, TABLE = "full model", "table"
CLOSED_FORMS = {kind.words: kind for kind in shipped(AbstractRebound)}
LAWS = (FULL_MODEL, TABLE, *CLOSED_FORMS)


class NamedLaw(NamedTuple):
    """Contact law of a study."""

    name: str
    """Name in drawings and tables; the law's own if the file gives none."""
    contacts: Contacts
    """Contact model."""
    description: dict
    """Description, ready for JSON."""
    checksums: dict[Path, str]
    """SHA-256 of the files that the law is read from."""

    @property
    def directory(self) -> str:
        """Name of the directory for its files."""
        return re.sub(r"[\W_]+", "-", self.name.lower()).strip("-")


def read_laws(top: Key, content: dict, accuracy: str | None) -> list[NamedLaw]:
    """Read one law from `[contacts]`, or as many as there are `[[contacts]]`; the
    accuracy of the full model stands in place of the file's."""
    key, tables = top["contacts"], content.get("contacts", {"law": FULL_MODEL})
    if isinstance(tables, list) and not tables:
        raise key.error("is an empty list")
    if not isinstance(tables, list):
        tables = [typed(top, content, "contacts", dict, tables)]
    laws = [_law(top, content, table, accuracy) for table in tables]
    if (accuracy is not None or "accuracy" in content) and not any(
        isinstance(law.contacts, FullModel) for law in laws
    ):
        raise key["law"].error(
            "accuracy is of the full model; the law "
            f"{laws[0].description['law']} takes none"
        )
    for one, law in itertools.combinations(laws, 2):
        if law.name == one.name:
            raise key["name"].error(f"{law.name!r} stands twice; name tells laws apart")
        if law.directory == one.directory:
            raise key["name"].error(
                f"{one.name!r} and {law.name!r} would both have the directory "
                f"{law.directory}; they must differ by more than capitals and signs"
            )
    return laws


def _law(top: Key, content: dict, table, accuracy: str | None) -> NamedLaw:
    key = top["contacts"]
    law = typed(key, of_kind(key, table, dict), "law", str, FULL_MODEL)
    kind = _closed_form_class(top, law)
    if ":" in law and kind:
        law = kind.__name__
    else:
        law = choice(key, table, "law", FULL_MODEL, LAWS)
    name = one_line(key, table, "name", law)
    if not re.search(r"[^\W_]", name):
        raise key["name"].error(f"needs a letter or a digit, but is {name!r}")
    if law == TABLE:
        check_keys(key, table, ("law", "name", "files"))
        return _tables(top, name, table)
    if law == FULL_MODEL:
        check_keys(key, table, ("law", "name"))
        accuracy = accuracy or choice(
            top, content, "accuracy", DEFAULT_ACCURACY, tuple(PRESETS)
        )
        described = {"law": law, "accuracy": accuracy}
        return NamedLaw(name, FullModel(accuracy), described, {})
    assert kind is not None
    return _closed_form(key, table, law, name, kind)


def _closed_form(
    key: Key, table: dict, law: str, name: str, kind: type[AbstractRebound]
) -> NamedLaw:
    """Make a closed-form law of its class and the parameters in its table."""
    columns = {column.name: column for column in own_columns(kind)}
    check_keys(key, table, ("law", "name", *columns))
    values = {}
    for parameter, column in columns.items():
        if parameter in table:
            values[parameter] = allowed(key[parameter], column, table[parameter])
        elif math.isnan(column.default):
            raise key[parameter].error(f"is needed by the law {law}")
        else:
            values[parameter] = column.default
    fields = {
        columns[parameter].field: columns[parameter].factor * v
        for parameter, v in values.items()
    }
    described, checksums = {"law": law} | values, {}
    if law not in CLOSED_FORMS:
        described["class"] = name_of(kind)
        checksums = {file: _checksum(file) for file in [file_of(kind)] if file}
    try:
        contacts = ClosedForm(kind(**fields))
    except TypeError as error:
        raise key["law"].error(
            f"{law} cannot be made of its parameters alone: {error}; declare each "
            "field as name: Scalar = parameter(default, unit, range, meaning)"
        ) from error
    return NamedLaw(name, contacts, described, checksums)


def columns_of_law(top: Key, table: dict) -> dict[str, InputColumn]:
    """List the parameters of the law in closed form that a table names, by name; none
    for another law."""
    law = typed(top["contacts"], table, "law", str, FULL_MODEL)
    kind = _closed_form_class(top, law)
    return {column.name: column for column in own_columns(kind)} if kind else {}


def _closed_form_class(top: Key, law: str) -> type[AbstractRebound] | None:
    """Find the class of a law in closed form, shipped or a user's; None for another
    law."""
    if ":" not in law:
        return CLOSED_FORMS.get(law)
    with top["contacts"]["law"].located():
        return find_class("law", AbstractRebound, law, top.file.parent)


def _checksum(file: Path) -> str:
    return hashlib.sha256(read_input(file, once=False)).hexdigest()


def _tables(top: Key, name: str, table: dict) -> NamedLaw:
    key = top["contacts"]
    if "files" not in table:
        raise key["files"].error("is needed by the law table")
    names = typed(key, table, "files", list)
    if not names or not all(isinstance(n, str) for n in names):
        raise key["files"].error(f"must be a list of files, but is {names!r}")
    files = [top.file.parent / n for n in names]
    checksums = {file: _checksum(file) for file in files}
    tables = [read_table(file) for file in files]
    errors = [table.error for table in tables if table.error is not None]
    described = {
        "law": TABLE,
        "files": list(dict.fromkeys(names)),
        "median error": [float(f"{error.median:.3g}") for error in errors],
        "99 % error": [float(f"{error.of_99_percent:.3g}") for error in errors],
    }
    return NamedLaw(name, Tabulated(tables), described, checksums)


def check_law(
    top: Key, law: NamedLaw, profile: Profile, release: Release, ground: Ground
) -> None:
    """Raise InputError where tables lack blocks or ground of a study."""
    if not isinstance(law.contacts, Tabulated):
        return
    slope = profile.slope
    # At a convex break planes between the two segments are struck.
    convex = slope[1:] > slope[:-1]
    least, most = slope.copy(), slope.copy()
    least[1:] = np.where(convex, slope[:-1], slope[1:])
    most[:-1] = np.where(convex, slope[1:], slope[:-1])
    widest = CUT * spread(ground.roughness, release.count, profile.segments)
    problem = law.contacts.problem_with(
        release.block,
        ground.soil,
        least - widest,
        most + widest,
    )
    if problem:
        raise top["contacts"]["files"].error(problem)

"""Contact laws of a study, as its file names them."""

import hashlib
import math
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...accuracy import DEFAULT_ACCURACY, PRESETS
from ...errors import InputError, located
from ...finding import file_of, find_class, shipped
from ...identity import name_of
from ...io.toml import allowed, check_keys, choice, typed
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
    told: dict
    """Description, ready for JSON."""
    checksums: dict[Path, str]
    """SHA-256 of the files that the law is read from."""

    @property
    def directory(self) -> str:
        """Name of the directory for its files."""
        return re.sub(r"[^a-z0-9]+", "-", self.name.lower()).strip("-")


def read_laws(path: Path, content: dict, accuracy: str | None) -> list[NamedLaw]:
    """Read one law from `[contacts]`, or as many as there are `[[contacts]]`; with
    `contact_error` the full model is always one of them.

    Args:
        content: content of the file.
        accuracy: accuracy of the full model, in place of the file's.
    """
    tables = content.get("contacts", {"law": FULL_MODEL})
    if isinstance(tables, list) and not tables:
        raise InputError("is an empty list", file=path, key="contacts")
    if not isinstance(tables, list):
        tables = [typed(path, content, "contacts", dict, tables)]
    laws = [_law(path, content, table, accuracy) for table in tables]
    if "contact_error" in content:
        laws += _full_model_if_missing(path, content, laws, accuracy)
    if (accuracy is not None or "accuracy" in content) and not any(
        isinstance(law.contacts, FullModel) for law in laws
    ):
        raise InputError(
            f"accuracy is of the full model; the law {laws[0].told['law']} takes none",
            file=path,
            key="contacts.law",
        )
    for place, law in enumerate(laws):
        if law.directory in [other.directory for other in laws[:place]]:
            raise InputError(
                f"{law.name!r} stands twice; name tells laws apart",
                file=path,
                key="contacts.name",
            )
    return laws


def _full_model_if_missing(
    path: Path, content: dict, laws: list[NamedLaw], accuracy: str | None
) -> list[NamedLaw]:
    """Make the full model, by which the errors of the others are measured."""
    given = [law for law in laws if isinstance(law.contacts, FullModel)]
    if len(given) > 1:
        raise InputError(
            "holds the full model twice; contact_error is measured by one",
            file=path,
            key="contacts",
        )
    return [] if given else [_law(path, content, {"law": FULL_MODEL}, accuracy)]


def _law(path: Path, content: dict, table, accuracy: str | None) -> NamedLaw:
    if not isinstance(table, dict):
        raise InputError(
            f"must be a table, but is {table!r}", file=path, key="contacts"
        )
    law = typed(path, table, "law", str, FULL_MODEL)
    own = _own_law(path, law) if ":" in law else None
    law = own.__name__ if own else choice(path, table, "law", FULL_MODEL, LAWS)
    name = typed(path, table, "name", str, law)
    if not re.search("[A-Za-z0-9]", name):
        raise InputError(
            f"needs a letter or a digit, but is {name!r}",
            file=path,
            key="contacts.name",
        )
    if law == TABLE:
        check_keys(path, "contacts", table, ("law", "name", "files"))
        return _tables(path, name, table)
    if law == FULL_MODEL:
        check_keys(path, "contacts", table, ("law", "name"))
        accuracy = accuracy or choice(
            path, content, "accuracy", DEFAULT_ACCURACY, tuple(PRESETS)
        )
        told = {"law": law, "accuracy": accuracy}
        return NamedLaw(name, FullModel(accuracy), told, {})
    return _closed_form(path, table, law, name, own or CLOSED_FORMS[law])


def _closed_form(
    path: Path, table: dict, law: str, name: str, kind: type[AbstractRebound]
) -> NamedLaw:
    """Make a closed-form law of its class and the parameters in its table."""
    columns = {column.name: column for column in own_columns(kind)}
    check_keys(path, "contacts", table, ("law", "name", *columns))
    values = {}
    for key, column in columns.items():
        where = f"contacts.{key}"
        if key in table:
            values[key] = allowed(path, where, column, table[key])
        elif math.isnan(column.default):
            raise InputError(f"is needed by the law {law}", file=path, key=where)
        else:
            values[key] = column.default
    fields = {columns[key].field: columns[key].factor * v for key, v in values.items()}
    told, checksums = {"law": law} | values, {}
    if law not in CLOSED_FORMS:
        told["class"] = name_of(kind)
        checksums = {file: _checksum(file) for file in [file_of(kind)] if file}
    try:
        contacts = ClosedForm(kind(**fields))
    except TypeError as error:
        raise InputError(
            f"{law} cannot be made of its parameters alone: {error}; declare each "
            "field as name: Scalar = parameter(default, unit, range, meaning)",
            file=path,
            key="contacts.law",
        ) from error
    return NamedLaw(name, contacts, told, checksums)


def columns_of_law(path: Path, table: dict) -> dict[str, InputColumn]:
    """List the parameters of the law in closed form that a table names, by name; none
    for another law."""
    law = typed(path, table, "law", str, FULL_MODEL)
    kind = _own_law(path, law) if ":" in law else CLOSED_FORMS.get(law)
    return {column.name: column for column in own_columns(kind)} if kind else {}


def _own_law(path: Path, text: str) -> type[AbstractRebound]:
    """Find the class of a user's law."""
    with located(path, "contacts.law"):
        return find_class("law", AbstractRebound, text, path.parent)


def _checksum(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _tables(path: Path, name: str, table: dict) -> NamedLaw:
    if "files" not in table:
        raise InputError("is needed by the law table", file=path, key="contacts.files")
    names = typed(path, table, "files", list)
    if not names or not all(isinstance(n, str) for n in names):
        raise InputError(
            f"must be a list of files, but is {names!r}",
            file=path,
            key="contacts.files",
        )
    files = [path.parent / n for n in names]
    tables = [read_table(file) for file in files]
    checksums = {file: _checksum(file) for file in files}
    errors = [table.error for table in tables if table.error is not None]
    told = {
        "law": TABLE,
        "files": list(dict.fromkeys(file.name for file in files)),
        "median error": [float(f"{error.median:.3g}") for error in errors],
        "99 % error": [float(f"{error.of_99_percent:.3g}") for error in errors],
    }
    return NamedLaw(name, Tabulated(tables), told, checksums)


def check_law(
    path: Path, law: NamedLaw, profile: Profile, release: Release, ground: Ground
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
        raise InputError(problem, file=path, key="contacts.files")

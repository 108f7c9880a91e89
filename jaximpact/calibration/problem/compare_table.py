"""The table `compare` of a study: laws that are compared, and groups left out."""

from pathlib import Path
from typing import NamedTuple

from ...errors import InputError
from ...io.toml import known_table


class CompareTable(NamedTuple):
    """Laws that a study compares, and the groups that it leaves out."""

    laws: tuple[str, ...] | None = None
    """Names of the laws; None for the default."""
    by: tuple[str, ...] | None = None
    """Columns whose groups are left out; None for the default."""


def read_compare_table(path: Path, content: dict) -> CompareTable | None:
    """Read the table `compare` of a study; None where there is none."""
    if "compare" not in content:
        return None
    entries = known_table(path, content, "compare", CompareTable._fields)
    names = {}
    for key, given in entries.items():
        given = [given] if isinstance(given, str) else given
        if not isinstance(given, list) or not all(isinstance(n, str) for n in given):
            raise InputError(
                f"must be a name or a list of names, but is {given!r}",
                file=path,
                key=f"compare.{key}",
            )
        names[key] = tuple(given)
    return CompareTable(**names)

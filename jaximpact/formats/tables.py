"""Tables of scenes: a CSV checked and turned into a `Scene` of arrays.

Checks are vectorised over a slice of rows; cells are looked at one by one only to find
the one to blame.
"""

import csv
import dataclasses
import hashlib
import io
import itertools
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import numpy as np

from ..block import Block
from ..collector import collector_paused
from ..errors import InputError, UnusualValueWarning, nearest
from ..scene import Impact, Scene
from ..soil import Soil
from .columns import (
    INPUT_COLUMNS,
    LABEL_COLUMNS,
    OUTCOME_COLUMN,
    RESULT_COLUMNS,
    SIGMA_PREFIX,
)
from .reading import check_text, read_input

SLICE_ROWS = 2_000
"""Rows converted at once: bounds the memory that cells take as Python strings."""
SIGMA_COLUMNS = tuple(SIGMA_PREFIX + name for name in RESULT_COLUMNS)


@dataclasses.dataclass(frozen=True)
class Table:
    """A checked table."""

    path: Path
    sha256: str
    """Of the bytes that were read."""
    header: str
    """The header as it stands in the file, without its line end."""
    rows: list[str]
    """The rows likewise; blank lines are left out."""
    numbers: dict[str, np.ndarray]
    """Each column of numbers, in the unit of its name; NaN where a table of tests has
    an empty cell."""
    lines: np.ndarray
    """Line of the file at which each row begins."""
    censored: dict[str, np.ndarray]
    """Of a table of tests, for each measured column: 1 in rows where the true value is
    said to be above the number (`>0.3`), -1 where below (`<0.1`), else 0."""
    labels: dict[str, list[str]]
    """Of a table of tests, each column of free text."""

    def scene(self) -> Scene:
        """All rows as one scene, in SI; the default stands for a missing column.

        The mass is an array of one value a row; a field without a column is a scalar.
        """
        fields = {"block": {}, "soil": {}, "impact": {}}
        for column in INPUT_COLUMNS.values():
            if column.name in self.numbers:
                values = column.factor * self.numbers[column.name]
                fields[column.part][column.field] = values
        default = INPUT_COLUMNS["mass_kg"].default
        fields["block"].setdefault("mass", np.full(len(self.rows), default))
        return Scene(
            Block(**fields["block"]), Soil(**fields["soil"]), Impact(**fields["impact"])
        )


def read_table(path: Path, *, measured: bool = False) -> Table:
    """Read a CSV of scenes.

    The file is UTF-8, with or without a byte order mark, separated by commas, and its
    first row names the columns: any of `INPUT_COLUMNS` and `LABEL_COLUMNS`.

    Args:
        path: the file; read once, so a pipe will do.
        measured: allow result columns too, with `sigma_` columns (above zero) and the
            outcome, as a table of tests has them. Their cells may be empty, and those
            of results limits like `>0.3` or `<0.1`. Without it they are refused, as
            they would stand twice in the output.

    Raises InputError, naming file, row and column, for whatever cannot be used. Of
    several bad cells the one in the leftmost column is named.
    """
    path = Path(path)
    return table_of(read_input(path), path, measured=measured)


@collector_paused()
def table_of(data: bytes, path: Path, *, measured: bool = False) -> Table:
    """A table of the bytes of a CSV, as `read_table` reads them.

    Args:
        path: what errors call it.
    """
    check_text(path, data)
    file = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="")
    records = records_of(path, file)
    first = next(records, None)
    if first is None:
        raise InputError("is empty; a header and rows are needed", file=path)
    header_line, header, cells = first
    names = [cell.strip() for cell in cells]
    _check_header(path, header_line, names, measured)
    rows, parts = [], {name: [] for name in names if _holds_numbers(name)}
    starts: list[np.ndarray] = []
    limits = {name: [] for name in names if name in RESULT_COLUMNS}
    labels = {name: [] for name in names if name in LABEL_COLUMNS and measured}
    while piece := list(itertools.islice(records, SLICE_ROWS)):
        lines, texts, cells_of_rows = zip(*piece, strict=True)
        _check_lengths(path, lines, cells_of_rows, len(names))
        rows += texts
        starts.append(np.array(lines))
        for name, cells in zip(names, zip(*cells_of_rows, strict=True), strict=True):
            if name in labels:
                labels[name] += [cell.strip() for cell in cells]
            elif name in limits:
                values, signs = _measured(path, lines, name, cells)
                parts[name].append(values)
                limits[name].append(signs)
            elif name in SIGMA_COLUMNS:
                parts[name].append(_present(path, lines, name, cells))
            elif name in parts:
                parts[name].append(_numbers(path, lines, name, cells))
    if not rows:
        raise InputError("has a header but no rows", file=path)
    numbers = {name: np.concatenate(pieces) for name, pieces in parts.items()}
    lines = np.concatenate(starts)
    _warn_of_unusual(path, numbers, lines)
    return Table(
        path=path,
        sha256=hashlib.sha256(data).hexdigest(),
        header=header,
        rows=rows,
        numbers=numbers,
        lines=lines,
        censored={name: np.concatenate(pieces) for name, pieces in limits.items()},
        labels=labels,
    )


def _warn_of_unusual(path: Path, numbers: dict[str, np.ndarray], lines) -> None:
    """One warning for each column of the scene with values that are unusual."""
    for name, values in numbers.items():
        column = INPUT_COLUMNS.get(name)
        if column is None or (
            column.is_usual(np.min(values)) and column.is_usual(np.max(values))
        ):
            continue
        bad = (values < column.usual[0]) | (values > column.usual[1])
        place, more = int(np.argmax(bad)), np.count_nonzero(bad) - 1
        where = f" and {more} more rows" if more else ""
        warnings.warn(
            UnusualValueWarning(
                f"{path}, row {lines[place]}, column {name}: is "
                f"{column.told(values[place], column.unit, where)}",
                name,
            ),
            stacklevel=3,
        )


def records_of(path: Path, file: TextIO) -> Iterator[tuple[int, str, list[str]]]:
    """Line number, text and cells of each record of a CSV that is not blank. Raises
    InputError, naming the row, for what is no CSV."""
    lines, same_lines = itertools.tee(file)
    reader = csv.reader(lines, strict=True)
    first = 1
    try:
        for cells in reader:
            # A quoted cell may hold line ends, so a record may take several lines.
            count = reader.line_num - first + 1
            text = "".join(itertools.islice(same_lines, count)).rstrip("\r\n")
            if text.strip():
                yield first, text, cells
            first += count
    except csv.Error as error:
        raise InputError(f"is not valid CSV: {error}", file=path, row=first) from error


def _holds_numbers(name: str) -> bool:
    """Whether a known column holds numbers."""
    return name not in LABEL_COLUMNS and name != OUTCOME_COLUMN


def _check_header(path: Path, line: int, names: list[str], measured: bool) -> None:
    """Raise InputError for the first name that cannot stand in the header."""
    for separator, word in ((";", "';'"), ("\t", "tabs")):
        if any(separator in name for name in names):
            raise InputError(
                f"columns are separated by {word}; separate them by ',' and write "
                "decimals with a point",
                file=path,
                row=line,
            )
    for place, name in enumerate(names):
        problem = _problem_with_name(name, names[:place], measured)
        if problem:
            column = name or str(place + 1)
            raise InputError(problem, file=path, row=line, column=column)


def _problem_with_name(name: str, before: list[str], measured: bool) -> str | None:
    """What is wrong with a name in the header, given the names to its left."""
    results = (*RESULT_COLUMNS, OUTCOME_COLUMN, *SIGMA_COLUMNS)
    known = (*INPUT_COLUMNS, *LABEL_COLUMNS, *(results if measured else ()))
    if not name:
        return "has no name"
    if reads_as_number(name):
        return "is a number; the first row must name the columns"
    if name in before:
        return "stands twice in the header"
    if name in results and not measured:
        return "is a result; remove it, as it would stand twice in the output"
    if name not in known:
        return f"is unknown; did you mean {nearest(name, known)}?"
    return None


def _check_lengths(path: Path, lines, cells_of_rows, count: int) -> None:
    """Raise InputError for the first row that does not have `count` cells."""
    if set(map(len, cells_of_rows)) == {count}:
        return
    for line, cells in zip(lines, cells_of_rows, strict=True):
        if len(cells) != count:
            hint = "; write decimals with a point" if len(cells) > count else ""
            raise InputError(
                f"has {len(cells)} cells, but the header has {count}{hint}",
                file=path,
                row=line,
            )


LIMITS = {">": 1, "<": -1}


def _measured(path: Path, lines, name: str, cells) -> tuple[np.ndarray, np.ndarray]:
    """A column of measured values, and of which only a limit is known."""
    stripped = [cell.strip() for cell in cells]
    signs = np.array([LIMITS.get(cell[:1], 0) for cell in stripped])
    if ">" in stripped or "<" in stripped:
        row = next(line for line, c in zip(lines, stripped, strict=True) if c in LIMITS)
        raise InputError("has a sign without a number", file=path, row=row, column=name)
    plain = [c[1:] if sign else c for c, sign in zip(stripped, signs, strict=True)]
    return _present(path, lines, name, plain), signs


def _present(path: Path, lines, name: str, cells) -> np.ndarray:
    """A column's cells as checked numbers, NaN for the empty ones."""
    values = np.full(len(cells), np.nan)
    filled = [place for place, cell in enumerate(cells) if cell.strip()]
    if filled:
        lines, cells = (
            [column[place] for place in filled] for column in (lines, cells)
        )
        values[filled] = _numbers(path, lines, name, cells)
    return values


def _numbers(path: Path, lines, name: str, cells) -> np.ndarray:
    """A column's cells as checked numbers, in the column's unit."""
    try:
        values = np.fromiter(map(float, cells), float, len(cells))
    except ValueError:
        values = np.array([float(c) if reads_as_number(c) else np.nan for c in cells])
    allowed = _allowed(name, values)
    if "_" in "".join(cells):
        allowed &= np.array(["_" not in cell for cell in cells])
    if np.all(allowed):
        return values
    bad = int(np.argmin(allowed))
    problem = _describe_bad_cell(name, cells[bad])
    raise InputError(problem, file=path, row=lines[bad], column=name)


def _allowed(name: str, values: np.ndarray) -> np.ndarray:
    """Which values a column of numbers may hold."""
    if name in INPUT_COLUMNS:
        return INPUT_COLUMNS[name].is_allowed(values)
    if name in SIGMA_COLUMNS:
        return np.isfinite(values) & (values > 0.0)
    return np.isfinite(values)


def _describe_bad_cell(name: str, cell: str) -> str:
    if not cell.strip():
        return "is empty, but a number is needed"
    if not reads_as_number(cell):
        hint = "; write decimals with a point" if "," in cell else ""
        return f"must be a number, but is {cell!r}{hint}"
    hint = ""
    if name in INPUT_COLUMNS:
        column = INPUT_COLUMNS[name]
        requirement = column.requirement
        hint = column.hint(float(cell), column.unit)
    else:
        requirement = "above 0" if name in SIGMA_COLUMNS else "finite"
    return f"must be {requirement}, but is {cell.strip()}{hint}"


def reads_as_number(cell: str) -> bool:
    """Whether a cell is a number. Python reads 1_000 as one, no other program does."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell

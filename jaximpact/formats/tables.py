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
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TextIO

import numpy as np

from ..collector import collector_paused
from ..errors import InputError, UnusualValueWarning
from ..parameters import Part
from ..scene import Scene
from ..shapes import MixedShapes
from .columns import (
    LABEL_COLUMNS,
    OUTCOME_COLUMN,
    RESULT_COLUMNS,
    SIGMA_PREFIX,
    SLOTS,
    InputColumn,
    columns_of,
    columns_of_class,
    why_unknown,
)
from .reading import check_text, read_input
from .scenes import (
    SHAPE,
    part_named,
    scene_with,
    value_of,
    with_parts,
    with_shapes,
)

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
    an empty cell, and where the shape of the row has no such parameter."""
    lines: np.ndarray
    """Line of the file at which each row begins."""
    censored: dict[str, np.ndarray]
    """Of a table of tests, for each measured column: 1 in rows where the true value is
    said to be above the number (`>0.3`), -1 where below (`<0.1`), else 0."""
    labels: dict[str, list[str]]
    """Of a table of tests, each column of free text."""
    base: Scene
    """The laws, the shape of each row, and what stands for a missing column."""

    def scene(self) -> Scene:
        """All rows as one scene, in SI.

        The mass is an array of one value a row; a field without a column is a scalar.
        """
        values = {}
        for name, column in columns_of(self.base).items():
            if name in self.numbers:
                given = self.numbers[name]
                if np.any(missing := np.isnan(given)):
                    given = np.where(missing, value_of(self.base, column), given)
                values[name] = given
            elif name == "mass_kg":
                values[name] = np.full(len(self.rows), value_of(self.base, column))
        return scene_with(self.base, values)


def read_table(
    path: Path, *, measured: bool = False, base: Scene | None = None
) -> Table:
    """Read a CSV of scenes.

    The file is UTF-8, with or without a byte order mark, separated by commas, and its
    first row names the columns: parameters of the scene, those of its laws and shapes
    among them, `LABEL_COLUMNS` and `SLOTS`. The columns of the latter hold names of
    laws and shapes, as `finding.find_part` takes them, which is told the file's
    directory. Rows may have different shapes, but have the same laws; a cell is empty
    if it is of a parameter that the shape of its row does not have.

    Args:
        path: the file; read once, so a pipe will do.
        base: the scene, of scalars, that says what the file does not; the defaults if
            not given.
        measured: allow result columns too, with `sigma_` columns (above zero) and the
            outcome, as a table of tests has them. Their cells may be empty, and those
            of results limits like `>0.3` or `<0.1`. Without it they are refused, as
            they would stand twice in the output.

    Raises InputError, naming file, row and column, for whatever cannot be used. Of
    several bad cells the one in the leftmost column is named.
    """
    path = Path(path)
    return table_of(read_input(path), path, measured=measured, base=base)


@collector_paused()
def table_of(
    data: bytes, path: Path, *, measured: bool = False, base: Scene | None = None
) -> Table:
    """A table of the bytes of a CSV, as `read_table` reads them.

    Args:
        path: what errors call it.
    """
    check_text(path, data)
    records = _records_of_data(path, data)
    first = next(records, None)
    if first is None:
        raise InputError("is empty; a header and rows are needed", file=path)
    header_line, header, cells = first
    names = [cell.strip() for cell in cells]
    _check_separators(path, header_line, names)
    base = Scene() if base is None else base
    if any(name in SLOTS for name in names):
        base = _with_named_parts(path, data, names, base)
    columns = columns_of(base)
    _check_header(path, header_line, names, columns, measured)
    of_shapes = _OfShapes.of(base, names)
    rows, parts = [], {name: [] for name in names if _holds_numbers(name)}
    starts: list[np.ndarray] = []
    limits = {name: [] for name in names if name in RESULT_COLUMNS}
    labels = {name: [] for name in names if name in LABEL_COLUMNS and measured}
    while piece := list(itertools.islice(records, SLICE_ROWS)):
        lines, texts, cells_of_rows = zip(*piece, strict=True)
        _check_lengths(path, lines, cells_of_rows, len(names))
        place = slice(len(rows), len(rows) + len(texts))
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
            elif name in of_shapes.columns:
                parts[name].append(of_shapes.numbers(path, lines, name, cells, place))
            elif name in parts:
                parts[name].append(_numbers(path, lines, name, cells, columns[name]))
    if not rows:
        raise InputError("has a header but no rows", file=path)
    numbers = {name: np.concatenate(pieces) for name, pieces in parts.items()}
    lines = np.concatenate(starts)
    _warn_of_unusual(path, columns, numbers, lines)
    return Table(
        path=path,
        sha256=hashlib.sha256(data).hexdigest(),
        header=header,
        rows=rows,
        numbers=numbers,
        lines=lines,
        censored={name: np.concatenate(pieces) for name, pieces in limits.items()},
        labels=labels,
        base=base,
    )


def _with_named_parts(path: Path, data: bytes, names: list[str], base: Scene) -> Scene:
    """The scene with the laws and the shapes that the rows name."""
    slots = [(place, name) for place, name in enumerate(names) if name in SLOTS]
    found: dict[tuple[str, str], Part] = {}
    laws: dict[str, str] = {}
    kinds = []
    for line, _, cells in itertools.islice(_records_of_data(path, data), 1, None):
        _check_lengths(path, [line], [cells], len(names))
        for place, slot in slots:
            text = cells[place].strip()
            key = slot, text
            if key not in found:
                found[key] = _part_of_cell(path, line, slot, text)
            if slot == SHAPE:
                kinds.append(type(found[key]))
            elif laws.setdefault(slot, text) != text:
                raise InputError(
                    f"must be the same law in all rows, but is {text} after "
                    f"{laws[slot]}; split the table",
                    file=path,
                    row=line,
                    column=slot,
                )
    try:
        base = with_parts(base, laws, path.parent)
        base = with_shapes(base, kinds) if kinds else base
        columns_of(base)  # which are two of one name where laws do not fit together
        return base
    except InputError as error:
        raise InputError(str(error), file=path) from error


def _part_of_cell(path: Path, line: int, slot: str, text: str) -> Part:
    try:
        if not text:
            raise InputError("is empty, but a name is needed")
        return part_named(slot, text, path.parent)
    except InputError as error:
        raise InputError(str(error), file=path, row=line, column=slot) from error


@dataclasses.dataclass(frozen=True)
class _OfShapes:
    """Parameters that are not the same for all shapes of a table."""

    kinds: tuple[type[Part], ...]
    index: np.ndarray
    """Which of them each row has."""
    columns: dict[str, list[InputColumn | None]]
    """Column -> what it is for each of the shapes; None where there is no such
    parameter."""

    @classmethod
    def of(cls, base: Scene, names: list[str]) -> "_OfShapes":
        shape = base.block.shape
        if not isinstance(shape, MixedShapes):
            return cls((), np.zeros(0, int), {})
        of_kinds = [columns_of_class(SHAPE, kind) for kind in shape.kinds]
        found = {name: [of.get(name) for of in of_kinds] for name in names}
        columns = {
            name: entries
            for name, entries in found.items()
            if any(entries) and any(entry != entries[0] for entry in entries)
        }
        return cls(shape.kinds, np.asarray(shape.index, int), columns)

    def numbers(self, path: Path, lines, name: str, cells, rows: slice) -> np.ndarray:
        """A column's cells as checked numbers; NaN where the shape has none."""
        values = np.full(len(cells), np.nan)
        index = self.index[rows]
        for place, (kind, column) in enumerate(
            zip(self.kinds, self.columns[name], strict=True)
        ):
            chosen = np.flatnonzero(index == place)
            own_lines, own = ([x[i] for i in chosen] for x in (lines, cells))
            if column is not None:
                values[chosen] = _numbers(path, own_lines, name, own, column)
                continue
            for line, cell in zip(own_lines, own, strict=True):
                if cell.strip():
                    raise InputError(
                        f"must be empty, as the shape {kind.__name__} of this row has "
                        f"no such parameter, but is {cell.strip()}",
                        file=path,
                        row=line,
                        column=name,
                    )
        return values


def _warn_of_unusual(
    path: Path,
    columns: Mapping[str, InputColumn],
    numbers: dict[str, np.ndarray],
    lines,
) -> None:
    """One warning for each column of the scene with values that are unusual."""
    for name, values in numbers.items():
        column = columns.get(name)
        if column is None or (
            column.is_usual(np.nanmin(values)) and column.is_usual(np.nanmax(values))
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


def _records_of_data(path: Path, data: bytes) -> Iterator[tuple[int, str, list[str]]]:
    file = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="")
    return records_of(path, file)


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
    return name not in (*LABEL_COLUMNS, *SLOTS, OUTCOME_COLUMN)


def _check_separators(path: Path, line: int, names: list[str]) -> None:
    for separator, word in ((";", "';'"), ("\t", "tabs")):
        if any(separator in name for name in names):
            raise InputError(
                f"columns are separated by {word}; separate them by ',' and write "
                "decimals with a point",
                file=path,
                row=line,
            )


def _check_header(
    path: Path,
    line: int,
    names: list[str],
    columns: Mapping[str, InputColumn],
    measured: bool,
) -> None:
    """Raise InputError for the first name that cannot stand in the header."""
    for place, name in enumerate(names):
        problem = _problem_with_name(name, names[:place], columns, measured)
        if problem:
            column = name or str(place + 1)
            raise InputError(problem, file=path, row=line, column=column)


def _problem_with_name(
    name: str, before: list[str], columns: Mapping[str, InputColumn], measured: bool
) -> str | None:
    """What is wrong with a name in the header, given the names to its left."""
    results = (*RESULT_COLUMNS, OUTCOME_COLUMN, *SIGMA_COLUMNS)
    known = (*columns, *SLOTS, *LABEL_COLUMNS, *(results if measured else ()))
    if not name:
        return "has no name"
    if reads_as_number(name):
        return "is a number; the first row must name the columns"
    if name in before:
        return "stands twice in the header"
    if name in results and not measured:
        return "is a result; remove it, as it would stand twice in the output"
    if name not in known:
        return f"is unknown; {why_unknown(name, known)}"
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


def _numbers(
    path: Path, lines, name: str, cells, column: InputColumn | None = None
) -> np.ndarray:
    """A column's cells as checked numbers, in the column's unit.

    Args:
        column: of a parameter of the scene.
    """
    try:
        values = np.fromiter(map(float, cells), float, len(cells))
    except ValueError:
        values = np.array([float(c) if reads_as_number(c) else np.nan for c in cells])
    allowed = _allowed(name, column, values)
    if "_" in "".join(cells):
        allowed &= np.array(["_" not in cell for cell in cells])
    if np.all(allowed):
        return values
    bad = int(np.argmin(allowed))
    problem = _describe_bad_cell(name, column, cells[bad])
    raise InputError(problem, file=path, row=lines[bad], column=name)


def _allowed(name: str, column: InputColumn | None, values: np.ndarray) -> np.ndarray:
    """Which values a column of numbers may hold."""
    if column is not None:
        return column.is_allowed(values)
    if name in SIGMA_COLUMNS:
        return np.isfinite(values) & (values > 0.0)
    return np.isfinite(values)


def _describe_bad_cell(name: str, column: InputColumn | None, cell: str) -> str:
    if not cell.strip():
        return "is empty, but a number is needed"
    if not reads_as_number(cell):
        hint = "; write decimals with a point" if "," in cell else ""
        return f"must be a number, but is {cell!r}{hint}"
    hint = ""
    if column is not None:
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

"""Tables of scenes: a CSV checked and turned into a `Scene` of arrays.

Checks are vectorised over a slice of rows; cells are looked at one by one only to find
the one to blame.
"""

import csv
import dataclasses
import hashlib
import io
import itertools
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._settings import collector_paused
from ..errors import InputError, located
from ..parameters import Part
from ..quantities import (
    CURVE_FILE,
    LABEL_COLUMNS,
    OUTCOME_COLUMN,
    SIGMA_PREFIX,
    SLOTS,
    TARGET_COLUMNS,
    TIME_COLUMN,
    InputColumn,
    columns_of,
    columns_of_class,
    why_unknown,
)
from ..scene import Scene
from ..scene_quantities import (
    SHAPE,
    part_named,
    scene_with,
    value_of,
    with_parts,
    with_shapes,
)
from ..shapes import MixedShapes
from .checks import NO_DATA, warn_unusual
from .files import check_text, read_input
from .parquet import csv_of_frame, is_parquet, read_frame

if TYPE_CHECKING:
    import pandas as pd

SLICE_ROWS = 2_000
"""Rows converted at once: bounds the memory that cells take as Python strings."""
NOT_MEASURED = ("", "nan", "na", "n/a")
"""Cells of results that were not measured, in small letters."""
SHORT_MARKS = {
    -99.0: ("-", "m", "s"),
    -999.0: ("-", "m", "s", "m/s", "rad", "deg"),
}
"""Marks for no data that may be a value too, each with the units of values that are
not so large. Those of `NO_DATA` are no result, and are refused as one."""
SIGMA_COLUMNS = tuple(SIGMA_PREFIX + name for name in TARGET_COLUMNS)
THOUSANDS = re.compile(r"[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+(\.[0-9]*)?")
"""A number with commas between its thousands."""
WITH_POINT = re.compile(r"[+-]?[0-9]+\.0")
"""Whole number as of a column of floats."""
LIMITS = {">": 1, "<": -1}
"""Signs of a measured value of which only a limit is known -> where the true value
lies."""


@dataclasses.dataclass(frozen=True)
class SceneTable:
    """A checked table."""

    path: Path
    sha256: str
    """SHA-256 of the bytes that were read."""
    header: str
    """The header as it stands in the file, without its line end."""
    rows: list[str]
    """The rows as they stand in the file; blank lines are left out."""
    numbers: dict[str, np.ndarray]
    """Each column of numbers, in the unit of its name, shape (rows,); NaN where a table
    of tests has an empty cell, and where the shape of the row has no such parameter."""
    lines: np.ndarray
    """Line of the file at which each row begins, shape (rows,)."""
    censored: dict[str, np.ndarray]
    """Each measured column of a table of tests, shape (rows,): 1 in rows where the true
    value is said to be above the number (`>0.3`), -1 where below (`<0.1`), else 0."""
    labels: dict[str, list[str]]
    """Each column of free text of a table of tests; whole numbers without a point."""
    base: Scene
    """The laws, the shape of each row, and what stands for a missing column."""
    beside: tuple["SceneTable", ...] = ()
    """Tables of the files that rows name, as of curves."""
    frame: "pd.DataFrame | None" = None
    """The columns with their types, of a file of Parquet."""

    def scene(self) -> Scene:
        """Return all rows as one scene, in SI.

        The mass is an array of one value a row; a field without a column is a scalar.
        """
        values = {}
        for name, column in columns_of(self.base).items():
            if name in self.numbers:
                of_rows = self.numbers[name]
                if np.any(missing := np.isnan(of_rows)):
                    of_rows = np.where(missing, value_of(self.base, column), of_rows)
                values[name] = of_rows
            elif name == "mass_kg":
                values[name] = np.full(len(self.rows), value_of(self.base, column))
        return scene_with(self.base, values)


def read_table(
    path: Path, *, measured: bool = False, base: Scene | None = None
) -> SceneTable:
    """Read a table of scenes: a CSV, or a file of Parquet by its name.

    A CSV is UTF-8, with or without a byte order mark, separated by commas, and its
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
    data = read_input(path)
    frame = read_frame(path, data) if is_parquet(path) else None
    text = data if frame is None else csv_of_frame(frame)
    table = table_of(text, path, measured=measured, base=base)
    sha256 = hashlib.sha256(data).hexdigest()
    return dataclasses.replace(table, sha256=sha256, frame=frame)


@collector_paused()
def table_of(
    data: bytes, path: Path, *, measured: bool = False, base: Scene | None = None
) -> SceneTable:
    """Read a table of the bytes of a CSV, as `read_table` reads them.

    Args:
        path: what errors call it.
    """
    check_text(path, data)
    with located(file=path):
        table = _table_of(data, path, measured, Scene() if base is None else base)
    columns = columns_of(table.base)
    for name, values in table.numbers.items():
        if name in columns:
            warn_of_unusual(path, columns[name], values, table.lines)
        elif name in TARGET_COLUMNS:
            unit = TARGET_COLUMNS[name].unit
            _warn_of_marks(
                path, name, unit, values, table.lines, "leave the cell empty"
            )
    return table


def _table_of(data: bytes, path: Path, measured: bool, base: Scene) -> SceneTable:
    records = records_of(data)
    first = next(records, None)
    if first is None:
        raise InputError("is empty; a header and rows are needed")
    header_line, header, cells = first
    names = [cell.strip() for cell in cells]
    if any(name in SLOTS for name in names):
        base = _with_named_parts(data, names, base, path.parent)
    columns = columns_of(base)
    _check_header(header_line, names, columns, measured)
    labels = {name: [] for name in names if name in LABEL_COLUMNS and measured}
    signs = {name: [] for name in names if name in TARGET_COLUMNS}
    texts_only = {*LABEL_COLUMNS, *SLOTS, OUTCOME_COLUMN}
    parts: dict[str, list[np.ndarray]]
    parts = {name: [] for name in names if name not in texts_only}
    rows: list[str] = []
    starts: list[np.ndarray] = []
    while piece := list(itertools.islice(records, SLICE_ROWS)):
        lines, texts, cells_of_rows = zip(*piece, strict=True)
        _check_lengths(lines, cells_of_rows, len(names))
        for name, column in zip(names, zip(*cells_of_rows, strict=True), strict=True):
            cells = _Cells(name, lines, column, len(rows))
            if name in labels:
                labels[name] += [cell.strip() for cell in column]
            elif name in columns:
                parts[name].append(_parameters(cells, columns[name], base))
            elif name in parts:
                values, limits = _measurements(cells)
                parts[name].append(values)
                if name in signs:
                    signs[name].append(limits)
        rows += texts
        starts.append(np.array(lines))
    if not rows:
        raise InputError("has a header but no rows")
    return SceneTable(
        path=path,
        sha256=hashlib.sha256(data).hexdigest(),
        header=header,
        rows=rows,
        numbers={name: np.concatenate(pieces) for name, pieces in parts.items()},
        lines=np.concatenate(starts),
        censored={name: np.concatenate(pieces) for name, pieces in signs.items()},
        labels={
            name: texts if name == CURVE_FILE else _whole_numbers(texts)
            for name, texts in labels.items()
        },
        base=base,
    )


def _whole_numbers(texts: list[str]) -> list[str]:
    """Write labels that are all whole numbers with a point, as programs write a column
    with an empty cell, without it: 1.0 is the campaign 1 of another table. Others, as
    1.1 beside 1.10, are texts."""
    if all(WITH_POINT.fullmatch(text) for text in texts if text):
        return [text.removesuffix(".0") for text in texts]
    return texts


# --- Records and header.


def records_of(data: bytes) -> Iterator[tuple[int, str, list[str]]]:
    """Yield the line number, text and cells of each record of a CSV that is not blank.
    Raises InputError, naming the row, for what is no CSV."""
    file = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="")
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
        raise InputError(f"is not valid CSV: {error}", row=first) from error


def check_separator(line: int, header: list[str]) -> None:
    """Raise InputError for a header whose columns are not separated by commas."""
    for separator, word in ((";", "';'"), ("\t", "tabs")):
        if any(separator in name for name in header):
            raise InputError(
                f"columns are separated by {word}; separate them by ',' and write "
                "decimals with a point",
                row=line,
            )


def _check_header(
    line: int, names: list[str], columns: Mapping[str, InputColumn], measured: bool
) -> None:
    check_separator(line, names)
    results = (*TARGET_COLUMNS, OUTCOME_COLUMN, *SIGMA_COLUMNS, TIME_COLUMN)
    known = (*columns, *SLOTS, *LABEL_COLUMNS, *(results if measured else ()))
    for index, name in enumerate(names):
        if not name:
            problem = "has no name"
        elif reads_as_number(name):
            problem = "is a number; the first row must name the columns"
        elif name in names[:index]:
            problem = "stands twice in the header"
        elif name in results and not measured:
            problem = "is a result; remove it, as it would stand twice in the output"
        elif name not in known:
            problem = (
                f"is unknown; {why_unknown(name, known)} (`jaximpact batch --help` "
                "lists all columns)"
            )
        else:
            continue
        raise InputError(problem, row=line, column=name or str(index + 1))


def _check_lengths(lines, cells_of_rows, count: int) -> None:
    if set(map(len, cells_of_rows)) == {count}:
        return
    for line, cells in zip(lines, cells_of_rows, strict=True):
        if len(cells) != count:
            hint = _cure_of_length(cells) if len(cells) > count else ""
            raise InputError(
                f"has {len(cells)} cells, but the header has {count}{hint}", row=line
            )


def _cure_of_length(cells: list[str]) -> str:
    """Say what to do about a row with too many cells, to follow its message."""
    if any(cell[:1].isspace() and cell.lstrip()[:1] == '"' for cell in cells):
        return "; remove the blank before the quotation mark"
    return "; write decimals with a point, and thousands without a comma"


# --- Laws and shapes that cells name.


def _with_named_parts(
    data: bytes, names: list[str], base: Scene, directory: Path
) -> Scene:
    slots = [(index, name) for index, name in enumerate(names) if name in SLOTS]
    parts: dict[tuple[str, str], Part] = {}
    laws: dict[str, str] = {}
    kinds = []
    for line, _, cells in itertools.islice(records_of(data), 1, None):
        _check_lengths([line], [cells], len(names))
        for index, slot in slots:
            text = cells[index].strip()
            key = slot, text
            with located(row=line, column=slot):
                if not text:
                    raise InputError("is empty, but a name is needed")
                if key not in parts:
                    parts[key] = part_named(slot, text, directory)
                if slot != SHAPE and laws.setdefault(slot, text) != text:
                    raise InputError(
                        f"must be the same law in all rows, but is {text} after "
                        f"{laws[slot]}; split the table"
                    )
            if slot == SHAPE:
                kinds.append(type(parts[key]))
    base = with_parts(base, laws, directory)
    return with_shapes(base, kinds) if kinds else base


# --- Columns of numbers.


class _Cells(NamedTuple):
    """Cells of one column, in a slice of the rows or some of them."""

    name: str
    lines: Sequence[int]
    texts: Sequence[str]
    start: int
    """Index of the slice's first row in the table."""

    def error(self, index: int, problem: str) -> InputError:
        return InputError(problem, row=self.lines[index], column=self.name)

    def some(self, indices: Sequence[int]) -> "_Cells":
        lines, texts = ([each[k] for k in indices] for each in (self.lines, self.texts))
        return self._replace(lines=lines, texts=texts)


MOST_MEASURED = 1e30
"""Largest measured value in size, and largest and one over the least of a standard
deviation: the squares of their ratios are floating-point numbers still."""


def _parameters(cells: _Cells, column: InputColumn, base: Scene) -> np.ndarray:
    """Read cells of a parameter of the scene; NaN in rows whose shape has none."""
    shape = base.block.shape
    if not isinstance(shape, MixedShapes):
        return _numbers(cells, column)
    entries = [columns_of_class(SHAPE, kind).get(cells.name) for kind in shape.kinds]
    # What all shapes have alike, or none has, is the same in all rows.
    if all(entry == entries[0] for entry in entries):
        return _numbers(cells, column)
    values = np.full(len(cells.texts), np.nan)
    rows = np.asarray(shape.index, int)[cells.start : cells.start + len(values)]
    for k, entry in enumerate(entries):
        indices = np.flatnonzero(rows == k).tolist()
        if entry is not None:
            values[indices] = _numbers(cells.some(indices), entry)
            continue
        for index in indices:
            if text := cells.texts[index].strip():
                raise cells.error(
                    index,
                    f"must be empty, as the shape {shape.kinds[k].__name__} of this "
                    f"row has no such parameter, but is {text}",
                )
    return values


def _measurements(cells: _Cells) -> tuple[np.ndarray, np.ndarray]:
    """Read cells of what was measured, NaN where it was not, and the signs of limits,
    which only results may have."""
    texts = [text.strip() for text in cells.texts]
    signs = np.zeros(len(texts), int)
    if cells.name in TARGET_COLUMNS:
        signs = np.array([LIMITS.get(text[:1], 0) for text in texts])
        texts = [text[abs(sign) :] for text, sign in zip(texts, signs, strict=True)]
    missing = [text.strip().casefold() in NOT_MEASURED for text in texts]
    for index in np.flatnonzero(signs).tolist():
        if missing[index]:
            raise cells.error(index, "has a sign without a number")
    values = np.full(len(texts), np.nan)
    filled = np.flatnonzero(~np.array(missing)).tolist()
    values[filled] = _numbers(cells._replace(texts=texts).some(filled))
    return values, signs


def _numbers(cells: _Cells, column: InputColumn | None = None) -> np.ndarray:
    """Read a column's cells as checked numbers, in the column's unit; `column` is that
    of a parameter of the scene."""
    texts = cells.texts
    try:
        values = np.fromiter(map(float, texts), float, len(texts))
    except ValueError:
        values = np.array([float(t) if reads_as_number(t) else np.nan for t in texts])
    if column is not None:
        allowed = column.is_allowed(values)
    else:
        allowed = (np.abs(values) <= MOST_MEASURED) & ~np.isin(values, NO_DATA)
        if cells.name in SIGMA_COLUMNS:
            allowed &= values >= 1.0 / MOST_MEASURED
    together = "".join(texts)
    if "_" in together or not together.isascii():
        allowed &= np.array([reads_as_number(text) for text in texts])
    if not np.all(allowed):
        bad = int(np.argmin(allowed))
        raise cells.error(bad, _problem_with_number(cells.name, column, texts[bad]))
    return values


def _problem_with_number(name: str, column: InputColumn | None, cell: str) -> str:
    if not cell.strip():
        return (
            "is empty, but a number is needed; without this column all rows have the "
            "default"
        )
    if not reads_as_number(cell):
        return f"must be a number, but is {cell!r}{_cure_of_comma(cell.strip())}"
    if column is not None:
        number = float(cell)
        needed, hint = column.requirement_of(number), column.hint(number, column.unit)
        return f"must be {needed}, but is {cell.strip()}{hint}"
    if float(cell) in NO_DATA:
        return f"is {cell.strip()}, a mark for no data; leave the cell empty"
    if 0.0 < abs(float(cell)) < np.inf and not (
        name in SIGMA_COLUMNS and float(cell) < 0.0
    ):
        return (
            f"must be from {1.0 / MOST_MEASURED:g} to {MOST_MEASURED:g} in size, but "
            f"is {cell.strip()}"
        )
    requirement = "above 0" if name in SIGMA_COLUMNS else "finite"
    return f"must be {requirement}, but is {cell.strip()}"


def _cure_of_comma(cell: str) -> str:
    """Say how to write a number with a comma, to follow its message; empty without."""
    if not THOUSANDS.fullmatch(cell):
        return "; write decimals with a point" if "," in cell else ""
    cure = f"; write {cell.replace(',', '')}, without a separator of thousands"
    may_be_decimal = cell.count(",") == 1 and "." not in cell
    return f"{cure}, or {cell.replace(',', '.')}" if may_be_decimal else cure


def reads_as_number(cell: str) -> bool:
    """Whether a cell is a number. Python reads 1_000 and digits of other scripts as
    one, no other program does."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell and cell.strip().isascii()


def warn_of_unusual(
    path: Path,
    column: InputColumn,
    values: np.ndarray,
    lines: Sequence[int] | np.ndarray,
) -> None:
    """Warn of the first unusual value of a column, in its unit, and of the first usual
    one that may be a mark for no data; name its row by the line of each, `(rows,)`."""
    bad = column.is_unusual(values)

    def words(index: int, where: str) -> str:
        return column.describe(values[index], column.unit, where)

    _warn_of_first(path, column.name, lines, bad, words)
    usual = np.where(bad, np.nan, values)
    _warn_of_marks(path, column.name, column.unit, usual, lines, "write the true value")


def _warn_of_marks(
    path: Path,
    name: str,
    unit: str,
    values: np.ndarray,
    lines: Sequence[int] | np.ndarray,
    cure: str,
) -> None:
    """Warn of the first value of a column that may be a mark for no data; `cure` says
    what to do if it is."""
    short = [mark for mark, units in SHORT_MARKS.items() if unit in units]
    marks = [*NO_DATA, *short]

    def words(index: int, where: str) -> str:
        return f"{values[index]:g}{where}; if that is a mark for no data, {cure}"

    _warn_of_first(path, name, lines, np.isin(values, marks), words)


def _warn_of_first(
    path: Path,
    name: str,
    lines: Sequence[int] | np.ndarray,
    bad: np.ndarray,
    words: Callable[[int, str], str],
) -> None:
    """Warn of the first bad value of a column, if there is one. What it is, in words,
    comes from its index, and from how many rows more are bad."""
    if not np.any(bad):
        return
    index, more = int(np.argmax(bad)), np.count_nonzero(bad) - 1
    what = words(index, f" and {more} more rows" if more else "")
    warn_unusual(f"is {what}", name, file=path, row=lines[index], column=name)

"""Tests of a study, joined from one or several tables, with the curves of their forces.

Each time of a curve is a row of the tests, with the impact of its test, the time in
`time_s`, and the forces there. Points of one curve share one simulated impact.
"""

import collections
import csv
import dataclasses
import itertools
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ...errors import InputError
from ...io.scene_table import SIGMA_COLUMNS, SceneTable, read_table
from ...parameters import Part, parameters_of
from ...quantities import (
    CURVE_COLUMNS,
    CURVE_FILE,
    LABEL_COLUMNS,
    SIGMA_PREFIX,
    SLOTS,
    TARGET_COLUMNS,
    TIME_COLUMN,
    InputColumn,
    columns_of,
)
from ...scene import PARTS, Scene
from ...scene_quantities import SHAPE, value_of, with_shapes
from ...shapes import AbstractShape, MixedShapes

CAMPAIGN = "campaign"
OF_CURVES = (*CURVE_COLUMNS, *(SIGMA_PREFIX + name for name in CURVE_COLUMNS))
"""Columns of a curve's file, beside the time."""
LIMITS = {1: ">", -1: "<", 0: ""}
"""Sign of a limit, as tables write it, for each code in `censored`."""


@dataclasses.dataclass(frozen=True)
class Measurements:
    """Tests in the order of their files and rows."""

    files: tuple[SceneTable, ...]
    base: Scene
    """Laws, and the shape of each test; its numbers have no meaning."""
    inputs: dict[str, np.ndarray]
    """Columns of the scene in any of the files, in the unit of their name, shape
    (tests,); the default where a file does not have one. Also `time_s`, NaN where it
    is not given."""
    measured: dict[str, np.ndarray]
    """Result columns, shape (tests,); NaN where there is no measurement."""
    censored: dict[str, np.ndarray]
    """1 where the true value is above, -1 where it is below, else 0, by result."""
    sigmas: dict[str, np.ndarray]
    """Standard deviations of result columns; NaN where none is given."""
    labels: dict[str, list[str]]
    """Columns of text; without a column `campaign` it is the name of the file."""

    def __len__(self) -> int:
        return sum(len(table.rows) for table in self.files)

    def place(self, test: int | np.integer) -> tuple[Path, int]:
        """Find file and row of a test."""
        for table in self.files:
            if test < len(table.rows):
                return table.path, int(table.lines[test])
            test -= len(table.rows)
        raise IndexError(test)

    def error(self, test: int | np.integer, column: str, problem: str) -> InputError:
        """Make the error of the cell of a test in a column."""
        file, row = self.place(test)
        return InputError(problem, file=file, row=row, column=column)

    def name(self, test: int | np.integer) -> str:
        """Return the name of a test, or its file and row, with the time of a force."""
        time = self.times[test]
        at = f" at {time:.4g} s" if np.isfinite(time) else ""
        for column in ("name", "test", "id"):
            labels = self.labels.get(column)
            if labels and labels[test]:
                return labels[test] + at
        return self._row_of(test) + at

    def names_apart(self, tests: Iterable[int] | None = None) -> tuple[str, ...]:
        """Return the names of tests, by default of all, with file and row where two
        have one name."""
        chosen = range(len(self)) if tests is None else tests
        names = {test: self.name(test) for test in chosen}
        count = collections.Counter(names.values())
        return tuple(
            f"{name} ({self._row_of(test)})" if count[name] > 1 else name
            for test, name in names.items()
        )

    @property
    def file_names(self) -> dict[Path, str]:
        """Names of the tables, by their paths; see `names_of_files`."""
        return names_of_files([table.path for table in self.files])

    def _row_of(self, test: int | np.integer) -> str:
        """Name the row of a test, with its file where there are several."""
        path, row = self.place(test)
        paths = [table.path for table in self.files]
        file = f"{_names_of(paths)[paths.index(path)]} " if len(paths) > 1 else ""
        return f"{file}row {row}"

    def missing_in_words(self, fitted: Collection[str] = ()) -> str:
        """Say which inputs of block and impact the tables lack, but for fitted ones,
        with their defaults; empty where they lack none."""
        missing = [
            f"{name} {column.default:g}"
            for name, column in self.known_columns.items()
            if column.part != "soil" and name not in (*self.inputs, *fitted)
        ]
        if not missing:
            return ""
        return f"Not in the table, default values: {', '.join(missing)}."

    @property
    def repeated(self) -> list[tuple[int, int]]:
        """Pairs of tests that are the same in all columns, each with the first such; a
        campaign that no table states is none."""
        columns = [*self.inputs.values(), *self.measured.values()]
        columns += [*self.censored.values(), *self.sigmas.values()]
        numbers = np.stack(columns, axis=1)
        # The copy of a file is no campaign of its own.
        campaigns = _chained(
            table.labels.get(CAMPAIGN, [""] * len(table.rows)) for table in self.files
        )
        labels = self.labels | {CAMPAIGN: campaigns}
        texts = zip(self.shapes, *labels.values(), strict=True)
        first: dict[tuple, int] = {}
        # NaN is not equal to itself, its bits are.
        same = [
            first.setdefault((row.tobytes(), text), test)
            for test, (row, text) in enumerate(zip(numbers, texts, strict=True))
        ]
        return [(one, test) for test, one in enumerate(same) if one != test]

    def repeated_in_words(self) -> list[str]:
        """Say which tests, and which points of curves, stand there twice."""
        pairs, row = self.repeated, self.first_of_row
        tests = [pair for pair in pairs if row[pair[1]] == pair[1]]
        # A repeated test has its curve again.
        points = [pair for pair in pairs if (row[pair[0]], row[pair[1]]) not in tests]
        lines = []
        if tests:
            one, other = map(self._row_of, tests[0])
            lines.append(
                f"Tests that are the same as another in every column: {len(tests)}, "
                f"the first of them {other} as {one}."
            )
        if points:
            point = points[0][1]
            lines.append(
                f"Points of curves that are the same as another: {len(points)}, the "
                f"first of them at {self.times[point]:.4g} s in "
                f"{self.labels[CURVE_FILE][point]}."
            )
        mistaken = (
            " If they stand there twice by mistake, standard errors are too small."
        )
        return [line + mistaken for line in lines]

    @property
    def times(self) -> np.ndarray:
        """Time of the forces of each test [s], shape (tests,); NaN without one."""
        return self.inputs.get(TIME_COLUMN, np.full(len(self), np.nan))

    def stated_sigma(self, target: str) -> np.ndarray:
        """Return the column of sigmas of a target, shape (tests,); NaN where none is
        stated."""
        return self.sigmas.get(target, np.full(len(self), np.nan))

    def at_times(self, targets: Collection[str]) -> np.ndarray:
        """Find the tests whose forces at a time are compared, as a mask (tests,); none
        where no force is among the targets."""
        has_force = any(name in CURVE_COLUMNS for name in targets)
        return np.isfinite(self.times) & has_force

    @property
    def sources(self) -> list[SceneTable]:
        """Tables of all files that were read, those of curves too."""
        return [one for table in self.files for one in (table, *table.beside)]

    @property
    def checksums(self) -> list[dict[str, str]]:
        """The `file` name and the `sha256` of all files that were read."""
        names = names_of_files([table.path for table in self.sources])
        return [{"file": names[t.path], "sha256": t.sha256} for t in self.sources]

    @property
    def first_of_row(self) -> np.ndarray:
        """Index of the first test from the same row of a file, shape (tests,): itself,
        but for the points of a curve."""
        rows = [(k, line) for k, table in enumerate(self.files) for line in table.lines]
        first: dict[tuple, int] = {}
        return np.array([first.setdefault(row, test) for test, row in enumerate(rows)])

    @property
    def described(self) -> str:
        """Number and files of the tests, and the number of points of their curves."""
        files = ", ".join(self.file_names.values())
        count = len(np.unique(self.first_of_row))
        points = len(self) - count
        curves = f" and {points} points of their curves" if points else ""
        return f"{count} test{'s' if count != 1 else ''} of {files}{curves}"

    @property
    def slots(self) -> set[str]:
        """Slots of laws or shapes that the files name: `flow`, `shape`."""
        headers = (next(csv.reader([table.header])) for table in self.files)
        return {name.strip() for header in headers for name in header} & {*SLOTS}

    @property
    def parts(self) -> dict[str, Part]:
        """Laws, and the shape unless the files state it, by slot."""
        return {
            slot: getattr(getattr(self.base, whole), slot)
            for slot, whole in SLOTS.items()
            if not (slot == SHAPE and SHAPE in self.slots)
        }

    @property
    def shapes(self) -> list[str]:
        """Names of the shapes of the tests' blocks."""
        shape, count = self.base.block.shape, len(self)
        return [kind.__name__ for kind in _kinds_of(shape, count)]

    @property
    def known_columns(self) -> dict[str, InputColumn]:
        """Columns of the scene."""
        return columns_of(self.base)

    def with_laws(self, laws: Mapping[str, Part]) -> "Measurements":
        """Return the tests on a ground of other laws."""
        if not laws:
            return self
        soil = dataclasses.replace(self.base.soil, **laws)
        base = Scene(self.base.block, soil, self.base.impact)
        return dataclasses.replace(self, base=base)

    def with_inputs(self, values: Mapping[str, float]) -> "Measurements":
        """Return the tests with columns of one value each, where they do not have
        them."""
        added = {
            name: np.full(len(self), value)
            for name, value in values.items()
            if name not in self.inputs
        }
        return dataclasses.replace(self, inputs=self.inputs | added)

    def columns(self, fixed: Mapping[str, float]) -> dict[str, np.ndarray]:
        """Collect every column of the scene, shape (tests,), in the unit of its name.

        Args:
            fixed: values that are in no file; parameters of other laws do not count.
        """
        return {
            name: np.broadcast_to(
                np.asarray(
                    self.inputs.get(name, fixed.get(name, column.default)), float
                ),
                len(self),
            )
            for name, column in self.known_columns.items()
        }

    def scene(self, fixed: Mapping[str, float]) -> Scene:
        """Make one scene of all tests, arrays (tests,) in SI.

        Args:
            fixed: values as for `columns`.
        """
        known = self.known_columns
        fields: dict[str, dict] = {part: {} for part in PARTS}
        for name, values in self.columns(fixed).items():
            fields[known[name].part][known[name].field] = known[name].factor * values
        scene = Scene(
            **{
                part: dataclasses.replace(getattr(self.base, part), **fields[part])
                for part in PARTS
            }
        )
        return jax.tree.map(lambda leaf: jnp.broadcast_to(leaf, len(self)), scene)


def read_tests(paths: list[Path], base: Scene) -> Measurements:
    """Read and join tables. Raises InputError as `read_table` and `joined_tables` do.

    Args:
        base: laws, and the shape of tests whose file does not say it.
    """
    tables = (read_table(path, measured=True, base=base) for path in paths)
    return joined_tables(tuple(tables))


def joined_tables(files: tuple[SceneTable, ...]) -> Measurements:
    """Join tables of tests, with the points of their curves. Raises InputError where
    their laws differ, and for a file that is no curve."""
    files = tuple(_with_curves(table) for table in files)
    base = _joined_base(files)
    known = columns_of(base)

    def pieces(names, of_table: str, filling: Any) -> dict[str, list]:
        """Collect columns that any table has, a piece from each."""
        columns = [(getattr(table, of_table), len(table.rows)) for table in files]
        return {
            name: [of_one.get(name, [filling] * count) for of_one, count in columns]
            for name in names
            if any(name in of_one for of_one, _ in columns)
        }

    def joined(names, of_table="numbers", filling=np.nan) -> dict[str, np.ndarray]:
        by_name = pieces(names, of_table, filling)
        return {name: np.concatenate(parts) for name, parts in by_name.items()}

    texts = pieces(LABEL_COLUMNS, "labels", "")
    labels = {name: _chained(parts) for name, parts in texts.items()}
    of_files = zip(_names_of([table.path for table in files]), files, strict=True)
    stems = _chained([name] * len(table.rows) for name, table in of_files)
    labels[CAMPAIGN] = [
        label or stem
        for label, stem in zip(labels.get(CAMPAIGN, stems), stems, strict=True)
    ]
    sigmas = joined(SIGMA_PREFIX + name for name in TARGET_COLUMNS)
    return Measurements(
        files=files,
        base=base,
        inputs={
            name: _filled(base, known[name], values)
            for name, values in joined(known).items()
        }
        | joined((TIME_COLUMN,)),
        measured=joined(TARGET_COLUMNS),
        censored=joined(TARGET_COLUMNS, "censored", 0),
        sigmas={name.removeprefix(SIGMA_PREFIX): v for name, v in sigmas.items()},
        labels=labels,
    )


def _with_curves(table: SceneTable) -> SceneTable:
    """Append the points of the curves that rows of a table of tests name.

    Raises InputError for a file that is no curve.
    """
    curves = {
        row: _read_curve(table, row, name)
        for row, name in enumerate(table.labels.get(CURVE_FILE, ()))
        if name
    }
    if not curves:
        return table
    count = len(table.rows)
    sizes = [len(curve.rows) for curve in curves.values()]
    row_of = np.concatenate([np.arange(count), np.repeat([*curves], sizes)])
    results = TIME_COLUMN, *TARGET_COLUMNS, *SIGMA_COLUMNS
    tables = (table, *curves.values())

    def joined(name: str, of_table: str = "numbers", filling=np.nan) -> np.ndarray:
        columns = [(getattr(one, of_table), len(one.rows)) for one in tables]
        parts = [of.get(name, np.full(count, filling)) for of, count in columns]
        return np.concatenate(parts)

    names = dict.fromkeys((*table.numbers, TIME_COLUMN))
    names |= dict.fromkeys(name for one in tables for name in one.numbers)
    base, shape = table.base, table.base.block.shape
    if isinstance(shape, MixedShapes):
        base = with_shapes(base, [shape.kinds[int(shape.index[r])] for r in row_of])
    return dataclasses.replace(
        table,
        rows=[table.rows[row] for row in row_of],
        lines=table.lines[row_of],
        numbers={
            name: joined(name) if name in results else table.numbers[name][row_of]
            for name in names
        },
        censored={n: joined(n, "censored", 0) for n in names if n in TARGET_COLUMNS},
        labels={n: [texts[row] for row in row_of] for n, texts in table.labels.items()},
        base=base,
        beside=tuple({curve.path: curve for curve in curves.values()}.values()),
    )


def _read_curve(table: SceneTable, row: int, name: str) -> SceneTable:
    place = {"file": table.path, "row": int(table.lines[row]), "column": CURVE_FILE}
    path = table.path.parent / name
    if not path.is_file():
        raise InputError(f"names {name}, which is no file in {path.parent}", **place)
    curve = read_table(path, measured=True)
    columns = [*curve.numbers, *curve.labels]
    for column in columns:
        if column not in (TIME_COLUMN, *OF_CURVES):
            raise InputError(
                f"belongs into {table.path.name}: a curve holds {TIME_COLUMN} and "
                f"{' or '.join(CURVE_COLUMNS)}",
                file=path,
                column=column,
            )
    if TIME_COLUMN not in columns or not {*columns} & {*CURVE_COLUMNS}:
        raise InputError(
            f"must have {TIME_COLUMN} and {' or '.join(CURVE_COLUMNS)}", file=path
        )
    for point in np.flatnonzero(~np.isfinite(curve.numbers[TIME_COLUMN]))[:1]:
        raise InputError(
            "is empty, but the point of a curve needs its time since first touch",
            file=path,
            row=int(curve.lines[point]),
            column=TIME_COLUMN,
        )
    return curve


def _joined_base(files: tuple[SceneTable, ...]) -> Scene:
    """Find the laws of all tables, and the shape of each of their rows."""
    base = files[0].base
    for table in files[1:]:
        laws = [jax.tree.structure(scene.soil) for scene in (base, table.base)]
        if laws[0] != laws[1]:
            raise InputError(
                f"has other laws than {files[0].path.name}; one study has one ground",
                file=table.path,
            )
    kinds = _chained(
        _kinds_of(table.base.block.shape, len(table.rows)) for table in files
    )
    return base if len(set(kinds)) == 1 else with_shapes(base, kinds)


def names_of_files(paths: Sequence[Path]) -> dict[Path, str]:
    """Name files with as many of their folders as tell those of one name apart."""
    longest = max(len(path.parts) for path in paths)
    for count in range(1, longest + 1):
        names = {path: "/".join(path.parts[-count:]) for path in paths}
        if len(set(names.values())) == len(names):
            break
    return names


def _names_of(paths: Sequence[Path]) -> list[str]:
    """Name files as `names_of_files`, without their suffix where these stay apart."""
    names = [*names_of_files(paths).values()]
    stems = [str(PurePosixPath(name).with_suffix("")) for name in names]
    return stems if len(set(stems)) == len(set(names)) else names


def _kinds_of(shape: AbstractShape, count: int) -> list[type[AbstractShape]]:
    if isinstance(shape, MixedShapes):
        return [shape.kinds[int(place)] for place in shape.index]
    return [type(shape)] * count


def _filled(base: Scene, column: InputColumn, values: np.ndarray) -> np.ndarray:
    """Replace NaN in a column by the default, which may differ with the shape."""
    missing = np.isnan(values)
    if not np.any(missing):
        return values
    of_shape = column.field in parameters_of(base.block.shape)
    default = value_of(base, column) if of_shape else column.default
    return np.where(missing, default, values)


def _chained(lists) -> list:
    return list(itertools.chain.from_iterable(lists))

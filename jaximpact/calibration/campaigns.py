"""The tests of a study: one table or several, put together."""

import dataclasses
import itertools
from pathlib import Path

import numpy as np

from ..block import Block
from ..formats.columns import INPUT_COLUMNS, LABEL_COLUMNS, RESULT_COLUMNS, SIGMA_PREFIX
from ..formats.tables import Table, read_table
from ..scene import Impact, Scene
from ..soil import Soil

CAMPAIGN = "campaign"


@dataclasses.dataclass(frozen=True)
class Measurements:
    """All tests, in the order of their files and rows."""

    files: tuple[Table, ...]
    inputs: dict[str, np.ndarray]
    """Columns of the scene that stand in any of the files, in the unit of their name;
    the default where a file does not have one."""
    measured: dict[str, np.ndarray]
    """Result columns; NaN where nothing was measured."""
    censored: dict[str, np.ndarray]
    """Of each 1 where the true value is above, -1 where it is below, else 0."""
    sigmas: dict[str, np.ndarray]
    """Of result columns; NaN where none is given."""
    labels: dict[str, list[str]]
    """Columns of text. Without a column `campaign`, a test's is its file's name."""

    def __len__(self) -> int:
        return sum(len(table.rows) for table in self.files)

    def place(self, test: int) -> tuple[Path, int]:
        """File and row of a test."""
        for table in self.files:
            if test < len(table.rows):
                return table.path, int(table.lines[test])
            test -= len(table.rows)
        raise IndexError(test)

    def name(self, test: int) -> str:
        """What a test is called: its name, or its file and row."""
        for column in ("name", "test", "id"):
            if self.labels.get(column, [""] * (test + 1))[test]:
                return self.labels[column][test]
        path, row = self.place(test)
        return f"{path.stem} row {row}" if len(self.files) > 1 else f"row {row}"

    def columns(self, soil: dict[str, float]) -> dict[str, np.ndarray]:
        """Every column of the scene, `(tests,)`, in the unit of its name.

        Args:
            soil: values that stand in no file.
        """
        return {
            name: np.broadcast_to(
                np.asarray(
                    self.inputs.get(name, soil.get(name, column.default)), float
                ),
                len(self),
            )
            for name, column in INPUT_COLUMNS.items()
        }

    def scene(self, soil: dict[str, float]) -> Scene:
        """The tests as one scene of arrays, in SI.

        Args:
            soil: values that stand in no file.
        """
        fields = {"block": {}, "soil": {}, "impact": {}}
        for name, values in self.columns(soil).items():
            column = INPUT_COLUMNS[name]
            fields[column.part][column.field] = column.factor * values
        return Scene(
            Block(**fields["block"]), Soil(**fields["soil"]), Impact(**fields["impact"])
        )


def read_tests(paths: list[Path]) -> Measurements:
    """Read and join tables. Raises InputError as `read_table` does."""
    return joined_tables(tuple(read_table(path, measured=True) for path in paths))


def joined_tables(files: tuple[Table, ...]) -> Measurements:
    """Tables of tests put together."""

    def joined(names, filling, of_table) -> dict[str, np.ndarray]:
        present = [n for n in names if any(n in of_table(table) for table in files)]
        return {
            name: np.concatenate(
                [
                    of_table(table).get(name, np.full(len(table.rows), filling(name)))
                    for table in files
                ]
            )
            for name in present
        }

    def numbers(table: Table) -> dict[str, np.ndarray]:
        return table.numbers

    labels = {
        name: _chained(
            table.labels.get(name, [""] * len(table.rows)) for table in files
        )
        for name in LABEL_COLUMNS
        if any(name in table.labels for table in files)
    }
    stems = _chained([table.path.stem] * len(table.rows) for table in files)
    labels[CAMPAIGN] = [
        label or stem
        for label, stem in zip(labels.get(CAMPAIGN, stems), stems, strict=True)
    ]
    sigmas = joined(
        (SIGMA_PREFIX + name for name in RESULT_COLUMNS), lambda _: np.nan, numbers
    )
    return Measurements(
        files=files,
        inputs=joined(INPUT_COLUMNS, lambda n: INPUT_COLUMNS[n].default, numbers),
        measured=joined(RESULT_COLUMNS, lambda _: np.nan, numbers),
        censored=joined(RESULT_COLUMNS, lambda _: 0, lambda table: table.censored),
        sigmas={name.removeprefix(SIGMA_PREFIX): v for name, v in sigmas.items()},
        labels=labels,
    )


def _chained(lists) -> list[str]:
    return list(itertools.chain.from_iterable(lists))

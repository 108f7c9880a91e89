"""The table of results: the rows that came in, with the results appended."""

import csv
import dataclasses
import itertools
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from .._packages import versions
from .._settings import collector_paused
from ..accuracy import Accuracy
from ..identity import part_names
from ..impact.events import Outcome
from ..impact.results import ImpactSummary
from ..quantities import OUTCOME_COLUMN, RESULT_COLUMNS
from ..scene_quantities import scene_values
from .files import refuse_inputs
from .output_files import manifest_path, replacing_with_manifest
from .parquet import is_parquet, write_columns
from .scene_table import SLICE_ROWS, SceneTable


def outcomes_in_words(codes) -> np.ndarray:
    """Return the words of outcomes, as an array of the shape of their codes."""
    words = np.array([str(outcome) for outcome in Outcome])
    return words[np.asarray(codes).astype(int)]


def count_outcomes(summary: ImpactSummary) -> dict[str, int]:
    """Count the impacts that ended in each way; ways that did not occur are left
    out."""
    return count_words(outcomes_in_words(summary.outcome_code))


def count_words(words: np.ndarray) -> dict[str, int]:
    """Count the outcomes of each kind; those that do not occur are left out."""
    counts = {str(outcome): int(np.sum(words == str(outcome))) for outcome in Outcome}
    return {word: count for word, count in counts.items() if count}


@collector_paused()
def write_results(
    path: Path,
    table: SceneTable,
    summary: ImpactSummary,
    accuracy: Accuracy,
) -> None:
    """Write the table with its results, and the manifest beside it.

    Header and rows stand as they came; `RESULT_COLUMNS` and the outcome follow, every
    number with the digits that it takes to read the same number back, `nan` where there
    is none. A name that ends in .parquet gets a file of Parquet, in which columns that
    came from such a file keep their types. Both files appear whole or not at all; files
    of the same names are replaced.

    Raises InputError for a path that would replace the table of scenes, OSError where
    the file system refuses.
    """
    path = Path(path)
    outputs = [("the table of results", path), ("its manifest", manifest_path(path))]
    refuse_inputs(outputs, [table.path])
    base = scene_values(table.base)
    manifest = {
        "scenes": {"file": table.path.name, "sha256": table.sha256},
        # What differs from row to row stands in the table.
        "base": {k: v for k, v in base.items() if not isinstance(v, list)},
        "laws": part_names(table.base.soil, table.base.block),
        "accuracy": dataclasses.asdict(accuracy),
        "outcomes": count_outcomes(summary),
        "versions": versions(),
    }
    with replacing_with_manifest(path, manifest) as temporary:
        if is_parquet(path):
            write_columns(temporary, _columns(table, summary))
            return
        with open(temporary, "w", encoding="utf-8", newline="") as file:
            header = (table.header, *RESULT_COLUMNS, OUTCOME_COLUMN)
            file.write(",".join(header) + "\n")
            for lines in _lines(table, summary):
                file.write("\n".join(lines) + "\n")


def _columns(table: SceneTable, summary: ImpactSummary) -> dict:
    if table.frame is not None:
        columns: dict = {str(name).strip(): of for name, of in table.frame.items()}
    else:
        names = next(csv.reader([table.header]))
        cells = zip(*csv.reader(table.rows), strict=True)
        columns = {
            name.strip(): table.numbers.get(name.strip(), np.array(texts))
            for name, texts in zip(names, cells, strict=True)
        }
    for name, column in RESULT_COLUMNS.items():
        columns[name] = np.asarray(getattr(summary, column.field))
    return columns | {OUTCOME_COLUMN: outcomes_in_words(summary.outcome_code)}


def _lines(table: SceneTable, summary: ImpactSummary) -> Iterator[Iterator[str]]:
    columns = [np.asarray(getattr(summary, c.field)) for c in RESULT_COLUMNS.values()]
    outcomes = outcomes_in_words(summary.outcome_code)
    for start in itertools.count(0, SLICE_ROWS):
        chosen = slice(start, start + SLICE_ROWS)
        rows = table.rows[chosen]
        if not rows:
            return
        numbers = [map(repr, values[chosen].tolist()) for values in columns]
        yield map(",".join, zip(rows, *numbers, outcomes[chosen].tolist(), strict=True))

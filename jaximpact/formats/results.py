"""The table of results: the rows that came in, with the results appended."""

import itertools
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..collector import collector_paused
from ..mechanics.outcomes import Outcome
from .columns import OUTCOME_COLUMN, RESULT_COLUMNS
from .files import refuse_inputs, replacing
from .outputs import manifest_path
from .provenance import batch_manifest
from .tables import SLICE_ROWS, Table

if TYPE_CHECKING:
    from ..result import ImpactResult


def outcomes_in_words(codes) -> np.ndarray:
    """The words of outcomes, as an array of the shape of their codes."""
    words = np.array([str(outcome) for outcome in Outcome])
    return words[np.asarray(codes).astype(int)]


def count_outcomes(result: "ImpactResult") -> dict[str, int]:
    """How many impacts ended in which way, outcomes that did not occur left out."""
    codes, counts = np.unique(
        np.asarray(result.outcome_code).astype(int), return_counts=True
    )
    return {
        str(Outcome(code)): int(count)
        for code, count in zip(codes, counts, strict=True)
    }


@collector_paused()
def write_results(path: Path, table: Table, result: "ImpactResult") -> None:
    """Write the table with its results, and the manifest beside it.

    Header and rows stand as they came; `RESULT_COLUMNS` and the outcome follow, every
    number with the digits that it takes to read the same number back, `nan` where there
    is none. Both files appear whole or not at all; files of the same names are
    replaced.

    Raises InputError for a path that would replace the table of scenes, OSError where
    the file system refuses.
    """
    path = Path(path)
    outputs = [("the table of results", path), ("its manifest", manifest_path(path))]
    refuse_inputs(outputs, [table.path])
    manifest = batch_manifest(
        table.path,
        table.sha256,
        table.base,
        result.accuracy,
        result.model_tolerance,
        count_outcomes(result),
    )
    with (
        replacing(manifest_path(path)) as manifest_temporary,
        replacing(path) as temporary,
    ):
        manifest_temporary.write_text(json.dumps(manifest, indent=2) + "\n")
        with open(temporary, "w", encoding="utf-8", newline="") as file:
            header = (table.header, *RESULT_COLUMNS, OUTCOME_COLUMN)
            file.write(",".join(header) + "\n")
            for lines in _lines(table, result):
                file.write("\n".join(lines) + "\n")
            file.flush()
            # The name must not outlive the content in a power cut.
            os.fsync(file.fileno())


def _lines(table: Table, result: "ImpactResult") -> Iterator[Iterator[str]]:
    """The lines of one slice of rows after another."""
    numbers = [
        np.asarray(getattr(result, column.field)) for column in RESULT_COLUMNS.values()
    ]
    codes = np.asarray(result.outcome_code).astype(int)
    names = [str(outcome) for outcome in Outcome]
    for start in itertools.count(0, SLICE_ROWS):
        chosen = slice(start, start + SLICE_ROWS)
        rows = table.rows[chosen]
        if not rows:
            return
        columns = [map(repr, values[chosen].tolist()) for values in numbers]
        outcomes = [names[code] for code in codes[chosen].tolist()]
        yield map(",".join, zip(rows, *columns, outcomes, strict=True))

"""Figures 4 to 14 of the paper, computed again, and written to files.

A figure is a table, computed from the paper's parametric sets or from runs down its
slope, and a drawing of that table alone: figure-N.png, drawn from figure-N.csv, with
figure-N.csv.manifest.json, which says what it was computed from. Source: Dattola et al.
(2023), section 3 and Fig. 13.
"""

import dataclasses
import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from jaximpact._packages import versions
from jaximpact.accuracy import get_accuracy
from jaximpact.errors import check_choice
from jaximpact.identity import part_names
from jaximpact.io.files import make_directory, put_text, replacing
from jaximpact.plotting.style import png_bytes
from jaximpact.quantities import OUTCOME_COLUMN
from jaximpact.scene_quantities import scene_values

from ..study import Study
from .impact_figures import IMPACT_FIGURES
from .slope_figures import ENDING_COLUMN, SLOPE_FIGURES
from .tables import PaperFigure, Table

_FIGURES = sorted((*IMPACT_FIGURES, *SLOPE_FIGURES), key=lambda one: int(one.number))
PAPER_FIGURES = {figure.number: figure for figure in _FIGURES}
"""Figures by number in the paper, in its order."""


def write_figures(
    out: Path, study: Study, *, only: Sequence[str], say: Callable[[str], None]
) -> None:
    """Compute, draw and write.

    Args:
        out: directory, made if need be; files of these names are replaced, those of a
            figure together.
        only: numbers of figures; all for none.
        say: called with a line for each figure written.

    Raises InputError for unknown figures or a directory that cannot be made, OSError
    where the file system refuses.
    """
    for number in only:
        check_choice("--only", number, PAPER_FIGURES)
    figures = [f for n, f in PAPER_FIGURES.items() if not only or n in only]
    make_directory(out, option="--out")
    for figure in figures:
        begin = time.perf_counter()
        table = figure.compute(study)
        rows = _rows(table)
        _write(out, figure, table, _manifest(figure, study) | {"rows": rows})
        seconds, failed = time.perf_counter() - begin, rows.get("failed", 0)
        say(
            f"{out / figure.name}.png: {figure.title} ({seconds:.1f} s)"
            + (f"; {failed} of {len(table)} rows failed" if failed else "")
        )


def _write(out: Path, figure: PaperFigure, table: Table, manifest: dict) -> None:
    """Write the three files of a figure, whole or not at all."""
    path = out / f"{figure.name}.csv"
    with (
        replacing(path.with_name(f"{path.name}.manifest.json")) as beside,
        replacing(path.with_suffix(".png")) as drawing,
        replacing(path) as data,
    ):
        write_table(data, table)
        drawing.write_bytes(png_bytes(figure.draw(table)))
        put_text(beside, json.dumps(manifest, indent=2) + "\n")


def write_table(path: Path, table: Table) -> None:
    """Write a figure's table as CSV, every number with the digits that it takes to read
    the same number back, `nan` where there is none."""
    table.to_csv(path, index=False, na_rep="nan", lineterminator="\n")


def _rows(table: Table) -> dict[str, int]:
    """Count the rows of each outcome, of an impact or of its whole run."""
    name = OUTCOME_COLUMN if OUTCOME_COLUMN in table else ENDING_COLUMN
    return table[name].value_counts().to_dict() if name in table else {}


def _manifest(figure: PaperFigure, study: Study) -> dict:
    """Say what the figure is computed from and with; what varies is in its table."""
    bases = {name: study.parametric_set(name)[0] for name in figure.sets or ("I",)}
    base = next(iter(bases.values()))
    case = {} if figure.sets else dataclasses.asdict(study.reading.slope.case)
    return {
        "figure": figure.number,
        "title": figure.title,
        "ground": study.ground,
        "sets": {name: scene_values(base) for name, base in bases.items()},
        **({"slope": case} if case else {}),
        "accuracy": dataclasses.asdict(get_accuracy(study.accuracy)),
        "laws": part_names(base.soil, base.block),
        "versions": versions(),
    }

"""The figures to their files.

Each is figure-N.png, drawn from figure-N.csv, with figure-N.csv.manifest.json, which
says what it was computed from.
"""

import dataclasses
import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from ..accuracy import get_accuracy
from ..errors import InputError, nearest
from ..formats.columns import OUTCOME_COLUMN
from ..formats.directory import NewFile, output_directory
from ..formats.files import replacing
from ..formats.outputs import manifest_path
from ..formats.provenance import versions
from ..formats.scenes import scene_values
from ..identity import part_names
from ..mechanics.outcomes import Outcome
from ..precision import require_float64
from .drawing import save_png
from .figure_4 import FIGURE_4
from .figure_5 import FIGURE_5
from .figure_6 import FIGURE_6
from .figure_7 import FIGURE_7
from .figure_8 import FIGURE_8
from .figure_9 import FIGURE_9
from .figure_10 import FIGURE_10
from .figure_11 import FIGURE_11
from .figure_12 import FIGURE_12
from .figure_13 import FIGURE_13
from .figure_14 import FIGURE_14
from .paper_figure import PaperFigure
from .slope_runs import ENDING_COLUMN, case_values
from .study import Study

PAPER_FIGURES = {
    figure.number: figure
    for figure in (
        FIGURE_4,
        FIGURE_5,
        FIGURE_6,
        FIGURE_7,
        FIGURE_8,
        FIGURE_9,
        FIGURE_10,
        FIGURE_11,
        FIGURE_12,
        FIGURE_13,
        FIGURE_14,
    )
}
"""By number in the paper."""


def choose_figures(numbers: Sequence[str]) -> list[PaperFigure]:
    """The figures of these numbers, in the paper's order; all for none.

    Raises InputError for a number that is not known, with the nearest known.
    """
    for number in numbers:
        if number not in PAPER_FIGURES:
            raise InputError(
                f"--only takes {', '.join(PAPER_FIGURES)}, but got {number!r}; did you "
                f"mean {nearest(number, PAPER_FIGURES)!r}?"
            )
    return [f for n, f in PAPER_FIGURES.items() if not numbers or n in numbers]


def write_figures(
    out: Path,
    *,
    only: Sequence[str] = (),
    study: Study | None = None,
    say: Callable[[str], None] | None = None,
) -> None:
    """Compute, draw and write.

    Args:
        out: directory, made if need be. Figures that are there of another ground or
            accuracy are removed; of these ones, each figure's files are replaced
            together.
        only: numbers of figures; all for none.
        study: ground and accuracy; Table 1 at `reference` if not given.
        say: called with a line for each figure written.

    Raises InputError for unknown figures or a directory that cannot be used,
    RuntimeError if JAX is set to float32, OSError where the file system refuses or
    another process writes there.
    """
    require_float64()
    figures = choose_figures(only)
    study = study or Study()
    names = [name for figure in figures for name in _names(figure)]
    told = _conditions(study)
    with output_directory(out, "figures", names, study=told) as new:
        for figure in figures:
            begin = time.perf_counter()
            table = figure.compute(_naming(study, figure))
            _write(new, figure, study, table)
            if say is not None:
                seconds = time.perf_counter() - begin
                failed = _rows(table).get(str(Outcome.failed), 0)
                say(
                    f"{out / figure.name}.png: {figure.title} ({seconds:.1f} s)"
                    + (f"; {failed} of {len(table)} rows failed" if failed else "")
                )


def _naming(study: Study, figure: PaperFigure) -> Study:
    """The study, with the figure's name in its lines of progress."""
    return dataclasses.replace(
        study, progress=lambda text: study.progress(f"{figure.name}: {text}")
    )


def _names(figure: PaperFigure) -> tuple[str, str, str]:
    """Names of a figure's manifest, drawing and table."""
    data = f"{figure.name}.csv"
    return str(manifest_path(Path(data))), f"{figure.name}.png", data


def _write(new: NewFile, figure: PaperFigure, study: Study, table) -> None:
    """The three files of a figure, whole or not at all."""
    manifest, drawing, data = map(new, _names(figure))
    with (
        replacing(manifest) as manifest_temporary,
        replacing(drawing) as drawing_temporary,
        replacing(data) as data_temporary,
    ):
        write_table(data_temporary, table)
        save_png(figure.draw(table), drawing_temporary)
        text = json.dumps(_manifest(figure, study, table), indent=2)
        manifest_temporary.write_text(text + "\n", encoding="utf-8")


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a figure's table as CSV, every number with the digits that it takes to read
    the same number back, `nan` where there is none."""
    table.to_csv(path, index=False, na_rep="nan", lineterminator="\n")


def _rows(table: pd.DataFrame) -> dict[str, int]:
    """How many rows have which outcome, of an impact or of its whole run."""
    for name in (OUTCOME_COLUMN, ENDING_COLUMN):
        if name in table:
            counts = table[name].value_counts()
            return {outcome: int(count) for outcome, count in counts.items()}
    return {}


def _conditions(study: Study) -> dict:
    """What the figures of one directory have in common, ready for JSON."""
    base, _ = study.parametric_set("I")
    return {
        "ground": study.ground,
        "accuracy": dataclasses.asdict(get_accuracy(study.accuracy)),
        "laws": part_names(base.soil, base.block),
        "versions": versions(),
    }


def _manifest(figure: PaperFigure, study: Study, table: pd.DataFrame) -> dict:
    """What the figure was computed from and with; what varies is in its table."""
    return {
        "figure": figure.number,
        "title": figure.title,
        "sets": {
            name: scene_values(study.parametric_set(name)[0]) for name in figure.sets
        },
        **({"slope": case_values(study)} if figure.on_the_slope else {}),
        "rows": _rows(table),
        **_conditions(study),
    }

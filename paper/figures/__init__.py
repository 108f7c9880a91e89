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
from jaximpact._precision import require_float64
from jaximpact.accuracy import get_accuracy
from jaximpact.identity import part_names
from jaximpact.impact.events import Outcome
from jaximpact.io.checks import chosen_values
from jaximpact.io.files import put_text, replacing
from jaximpact.io.output_files import NewFile, manifest_path, output_directory
from jaximpact.plotting.style import png_bytes
from jaximpact.quantities import OUTCOME_COLUMN
from jaximpact.scene_quantities import scene_values

from .impact_figures import IMPACT_FIGURES
from .slope_figures import ENDING_COLUMN, SLOPE_FIGURES, case_values
from .tables import PaperFigure, Study, Table

__all__ = ["PAPER_FIGURES", "PaperFigure", "Study", "write_figures"]

_FIGURES = sorted((*IMPACT_FIGURES, *SLOPE_FIGURES), key=lambda one: int(one.number))
PAPER_FIGURES = {figure.number: figure for figure in _FIGURES}
"""Figures by number in the paper, in its order."""


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
    out = Path(out)
    figures = chosen_values("--only", only, PAPER_FIGURES)
    study = study or Study()
    names = [name for figure in figures for name in _names(figure)]
    told = _conditions(study)
    with output_directory(out, "figures", names, study=told) as new:
        for figure in figures:
            begin = time.perf_counter()
            progress = study.progress.within(f"{figure.name}: ")
            table = figure.compute(dataclasses.replace(study, progress=progress))
            _write(new, figure, study, table)
            if say is not None:
                seconds = time.perf_counter() - begin
                failed = _rows(table).get(str(Outcome.failed), 0)
                say(
                    f"{out / figure.name}.png: {figure.title} ({seconds:.1f} s)"
                    + (f"; {failed} of {len(table)} rows failed" if failed else "")
                )


def _names(figure: PaperFigure) -> tuple[str, str, str]:
    """Names of a figure's manifest, drawing and table."""
    data = f"{figure.name}.csv"
    return str(manifest_path(Path(data))), f"{figure.name}.png", data


def _write(new: NewFile, figure: PaperFigure, study: Study, table) -> None:
    """Write the three files of a figure, whole or not at all."""
    manifest, drawing, data = map(new, _names(figure))
    with (
        replacing(manifest) as manifest_temporary,
        replacing(drawing) as drawing_temporary,
        replacing(data) as data_temporary,
    ):
        write_table(data_temporary, table)
        drawing_temporary.write_bytes(png_bytes(figure.draw(table)))
        text = json.dumps(_manifest(figure, study, table), indent=2)
        put_text(manifest_temporary, text + "\n")


def write_table(path: Path, table: Table) -> None:
    """Write a figure's table as CSV, every number with the digits that it takes to read
    the same number back, `nan` where there is none."""
    table.to_csv(path, index=False, na_rep="nan", lineterminator="\n")


def _rows(table: Table) -> dict[str, int]:
    """Count the rows of each outcome, of an impact or of its whole run."""
    name = OUTCOME_COLUMN if OUTCOME_COLUMN in table else ENDING_COLUMN
    return table[name].value_counts().to_dict() if name in table else {}


def _conditions(study: Study) -> dict:
    """Collect what the figures of one directory have in common, ready for JSON."""
    base, _ = study.parametric_set("I")
    return {
        "ground": study.ground,
        "accuracy": dataclasses.asdict(get_accuracy(study.accuracy)),
        "laws": part_names(base.soil, base.block),
        "versions": versions(),
    }


def _manifest(figure: PaperFigure, study: Study, table: Table) -> dict:
    """Write what the figure was computed from and with; what varies is in its table."""
    return {
        "figure": figure.number,
        "title": figure.title,
        "sets": {n: scene_values(study.parametric_set(n)[0]) for n in figure.sets},
        **({} if figure.sets else {"slope": case_values(study)}),
        "rows": _rows(table),
        **_conditions(study),
    }

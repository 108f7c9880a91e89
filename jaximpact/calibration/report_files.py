"""The report in files: report.html, and report.md with its pictures in report/."""

from pathlib import Path

from ..formats.files import replacing
from .document import as_html, as_markdown, save_pictures
from .examination import Examination
from .page import study_page
from .study import StudyResult

FOLDER = "report"


def write_report(result: StudyResult, examined: list[Examination], out: Path) -> None:
    """Write page, Markdown and pictures, each whole or not at all.

    Raises OSError where the file system refuses.
    """
    blocks = study_page(result, examined)
    with replacing(out / "report.html") as temporary:
        temporary.write_text(as_html(blocks), encoding="utf-8")
    save_pictures(blocks, out / FOLDER)
    with replacing(out / "report.md") as temporary:
        temporary.write_text(as_markdown(blocks, FOLDER), encoding="utf-8")

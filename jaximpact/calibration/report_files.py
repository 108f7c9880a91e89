"""The report in files: report.html, and report.md with its pictures in report/."""

from ..formats.directory import NewFile
from ..formats.files import write_text
from .document import as_html, as_markdown, save_pictures
from .examination import Examination
from .page import study_page
from .study import StudyResult

FOLDER = "report"


def write_report(
    result: StudyResult, examined: list[Examination], new: NewFile
) -> None:
    """Write page, Markdown and pictures, each whole or not at all.

    Raises OSError where the file system refuses.
    """
    blocks = study_page(result, examined)
    # First, since their names, which depend on the fit, are not checked beforehand.
    save_pictures(blocks, FOLDER, new)
    write_text(new("report.html"), as_html(blocks))
    write_text(new("report.md"), as_markdown(blocks, FOLDER))

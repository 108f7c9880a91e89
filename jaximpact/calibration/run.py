"""A study from its file to its report."""

from pathlib import Path

from ..precision import require_float64
from .examination import Examination, examine
from .least_squares import Progress
from .memory import Memory
from .output import study_directory, write_all
from .sampling import check_extra
from .study import StudyResult, fit_study
from .study_file import Study, read_study

UNFINISHED = "unfinished"


def run_study(
    study_path: Path,
    out_dir: Path,
    *,
    posterior: bool = False,
    progress: Progress | None = None,
) -> StudyResult:
    """Fit a study, examine the fit, and write report.html, report.md with its pictures
    in report/, report.txt, fit.json, fitted.csv and fit.png.

    Finished fits are kept in the directory's `unfinished` until the files are written:
    a run that was cut short goes on there.

    Args:
        study_path: the TOML file, the tables it names lying relative to it; or a table
            of tests alone.
        out_dir: made if need be; files of an earlier study there are replaced or
            removed, each new one once it is whole.
        posterior: whether to sample it too, by NUTS, and write posterior.nc for ArviZ,
            one for each variant; needs the extra `jaximpact[bayes]`.
        progress: called with lines of text.

    Raises InputError for a study or a directory that cannot be used, BlockingIOError
    while another process writes there, RuntimeError if JAX is set to float32.
    """
    require_float64()
    study = read_study(study_path)
    result, _ = fit_and_examine(
        study, Path(out_dir), posterior=posterior, progress=progress
    )
    return result


def fit_and_examine(
    study: Study,
    out_dir: Path | None,
    *,
    posterior: bool = False,
    progress: Progress | None = None,
) -> tuple[StudyResult, list[Examination]]:
    """Fit a study and examine the fit; write the files of `run_study` if there is a
    directory for them."""
    require_float64()
    if posterior:
        check_extra()
    progress = progress or (lambda text: None)
    if out_dir is None:
        result = fit_study(study, progress=progress)
        return result, examine(result, posterior=posterior, progress=progress)
    with study_directory(study, out_dir, posterior=posterior) as new:
        memory = Memory(out_dir / UNFINISHED)
        result = fit_study(study, memory=memory, progress=progress)
        examined = examine(result, posterior=posterior, progress=progress)
        progress("drawing")
        write_all(result, examined, new)
        memory.forget()
    return result, examined

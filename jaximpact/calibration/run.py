"""A study from its file to its report."""

from pathlib import Path

from ..precision import require_float64
from .examination import examine
from .least_squares import Progress
from .memory import Memory
from .output import make_directory, write_all
from .sampling import check_extra
from .study import StudyResult, fit_study
from .study_file import read_study

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
        study_path: the TOML file; the table it names lies relative to it.
        out_dir: made if need be; files of the same names are replaced, each once it is
            whole.
        posterior: whether to sample it too, by NUTS, and write posterior.nc for ArviZ,
            one for each variant; needs the extra `jaximpact[bayes]`.
        progress: called with lines of text.

    Raises InputError for a study that cannot be used, RuntimeError if JAX is set to
    float32.
    """
    require_float64()
    if posterior:
        check_extra()
    study = read_study(study_path)
    make_directory(Path(out_dir))
    progress = progress or (lambda text: None)
    memory = Memory(Path(out_dir) / UNFINISHED)
    result = fit_study(study, memory=memory, progress=progress)
    examined = examine(result, posterior=posterior, progress=progress)
    progress("drawing")
    write_all(result, examined, Path(out_dir))
    memory.forget()
    return result

"""A study from its file to its report."""

from pathlib import Path

from ..precision import require_float64
from .least_squares import Progress
from .output import make_directory, write_all
from .study import StudyResult, fit_study
from .study_file import read_study


def run_study(
    study_path: Path, out_dir: Path, *, progress: Progress | None = None
) -> StudyResult:
    """Fit a study, and write report.txt, fit.json, fitted.csv and fit.png.

    Args:
        study_path: the TOML file; the table it names lies relative to it.
        out_dir: made if need be; files of the same names are replaced, each once it is
            whole.
        progress: called with lines of text.

    Raises InputError for a study that cannot be used, RuntimeError if JAX is set to
    float32.
    """
    require_float64()
    study = read_study(study_path)
    make_directory(Path(out_dir))
    result = fit_study(study, progress=progress or (lambda text: None))
    write_all(result, Path(out_dir))
    return result

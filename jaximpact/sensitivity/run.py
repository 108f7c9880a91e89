"""A study from its file to its tables, drawings and manifest."""

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from ..accuracy import DEFAULT_ACCURACY
from ..formats.directory import output_directory
from ..precision import require_float64
from . import elasticity
from .elasticity import elasticities
from .in_words import in_words
from .morris_effects import morris
from .output import files_of_method, write_study
from .sobol_indices import sobol
from .study_file import ELASTICITIES, MORRIS, SensitivityStudy, read_study

Progress = Callable[
    [str], contextlib.AbstractContextManager[Callable[[int, int], None] | None]
]
"""For the name of a method, a context that gives what is called with how many impacts
are done and how many there are."""


class StudyResult(NamedTuple):
    """A study, and a dataset for each of its methods."""

    study: SensitivityStudy
    datasets: dict[str, xr.Dataset]

    def in_words(self) -> str:
        """The tables, one under the other."""
        return "\n\n".join(in_words(dataset) for dataset in self.datasets.values())


def run_study(
    path: Path,
    out: Path,
    *,
    method: str | None = None,
    accuracy: str | None = None,
    progress: Progress = lambda name: contextlib.nullcontext(),
) -> StudyResult:
    """Compute a study, and write report.txt, manifest.json, and for each method its
    table in CSV and its drawings.

    Args:
        path: the TOML file.
        out: made if need be; files of an earlier study there are replaced or removed,
            each new one once it is whole. Journals lie there until all is written, so
            that a run that was cut short goes on.
        method: in place of the file's.
        accuracy: in place of the file's; "reference" for elasticities and "balanced"
            for the rest where neither says.
        progress: see `Progress`.

    Raises InputError for a study or a directory that cannot be used, BlockingIOError
    while another process writes there, RuntimeError if JAX is set to float32.
    """
    require_float64()
    study = read_study(path, method)
    out = Path(out)
    accuracy = accuracy or study.accuracy
    journals = {name: out / f"{name}.journal" for name in study.methods}
    names = [file for name in study.methods for file in files_of_method(name)]
    names += ["report.txt", "manifest.json"]
    datasets = {}
    with output_directory(out, "sensitivity", names, inputs=[study.path]) as new:
        for name, journal in journals.items():
            with progress(name) as told:
                datasets[name] = _compute(study, name, accuracy, journal, told)
        result = StudyResult(study, datasets)
        write_study(study, datasets, result.in_words(), new)
        for name in study.methods:
            if name != ELASTICITIES:  # which keeps none
                journals[name].unlink()
    return result


def _compute(study, name, accuracy, journal, progress) -> xr.Dataset:
    if name == ELASTICITIES:
        return elasticities(
            study.base,
            study.parameters,
            study.outputs,
            accuracy=accuracy or elasticity.DEFAULT_ACCURACY,
            progress=progress,
        )
    how = {
        "seed": study.seed,
        "accuracy": accuracy or DEFAULT_ACCURACY,
        "journal": journal,
        "progress": progress,
    }
    if name == MORRIS:
        how["trajectories"] = study.trajectories
        return morris(study.base, study.ranges, study.outputs, **how)
    how["blocks"] = study.blocks
    return sobol(study.base, study.ranges, study.outputs, **how)

"""Back-analysis of a slope in one call."""

import concurrent.futures
import os
from pathlib import Path

from ..._checks import expect
from ..._precision import require_float64
from ..._settings import numpy_settings
from ...io.files import make_directory
from ...io.output_files import output_directory, together
from ...progress import Progress, ProgressFunction
from ...store import Store
from ...tasks import computing
from .posterior import posterior_of, search
from .predictive import SlopeCalibration, predict
from .problem import SlopeFit, read_slope_fit

UNFINISHED = "unfinished"
"""Directory of simulated data sets, until the report is written."""


@numpy_settings()
def calibrate_slope(
    study: str | os.PathLike,
    out: str | os.PathLike | None = None,
    *,
    executor: concurrent.futures.Executor | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> SlopeCalibration:
    """Fit ground parameters of a slope to stopping points, passages and counts.

    Data sets of as many blocks as were observed are simulated for candidates from the
    priors, in rounds that narrow down to what is plausible, and the posterior is found
    by regression on their summaries; see `regression`. Every data set is computed by
    the study's own law of contacts. Equal files give equal numbers on one machine.

    Args:
        study: file of a slope with the tables [fit] and [observed], as
            `jaximpact calibrate --help` describes it.
        out: directory for report.html, fit.json, samples.csv, exceedance.csv
            and, where there are barriers, barriers.csv; an interrupted call continues
            there.
        executor: simulates in other processes, as for `simulate_batch`; no number
            changes by it.
        progress: called with lines of text, or as `progress(done, data sets)`.

    Returns:
        Posterior, predictions, and what they rest on.

    Raises InputError, naming file and key, for input that cannot be used, and where
    hardly any candidate gives what was observed; RuntimeError if JAX is set to float32.
    """
    require_float64()
    expect("study", study, str, os.PathLike)
    expect("out", out, str, os.PathLike, type(None))
    fit = read_slope_fit(Path(study))
    with computing(progress=progress, executor=executor):
        return _calibrate(fit) if out is None else _calibrate_into(Path(out), fit)


def _calibrate_into(directory: Path, fit: SlopeFit) -> SlopeCalibration:
    """Calibrate, and write the report into a directory."""
    # Late imports: Matplotlib and Jinja are for the report alone.
    from .report import BARRIER_FILE, FILES, write_report

    files = (*FILES, BARRIER_FILE) if fit.barriers else FILES
    with output_directory(directory, "calibrate", files, inputs=fit.inputs) as new:
        folder = directory / UNFINISHED
        make_directory(folder, option="the directory")
        store = Store(folder)
        calibration = _calibrate(fit, store)
        with together(new) as add:
            write_report(calibration, add)
        store.clear()
    return calibration


def _calibrate(fit: SlopeFit, store: Store | None = None) -> SlopeCalibration:
    searched = search(fit, store)
    posterior = posterior_of(fit, searched)
    predicted = predict(fit, posterior, store)
    return SlopeCalibration(fit, searched, posterior, predicted)

"""`jaximpact calibrate` and `jaximpact predict`: soil parameters from measured impacts,
or from where blocks stopped on a slope, and predictions with them."""

import argparse
import contextlib
import time
from pathlib import Path

from ..errors import InputError
from ..interruption import resumable
from ..io.output_files import manifest_path, output_files
from ..progress import reporting_to
from ..progress_lines import ProgressLines, say
from . import options

DESCRIPTION = """\
Fit soil parameters to a table of measured impacts, and say which of them are not
identifiable from these data.

What to fit is a table of tests (CSV), or a study that names one. Of a table alone c_v,
gamma_v and k_E are fitted to all the results that it holds. A study is a TOML file:
  title, source, notes  free text
  data                  the table of tests (CSV), relative to the study, or a list of
                        tables, one a campaign; columns are those of `jaximpact batch`,
                        in and out, and `sigma_` with the name of a result for the
                        standard deviation of its measurement. A cell of a result may
                        be empty, or a limit like >0.3 or <0.1
  targets               results to fit (default: all that the tables hold)
  starts, seed          how many candidates search together, and the seed of the
                        random numbers (default: 48, 0); 1 fits from the start alone
  accuracy              fast, balanced or reference (default: reference)
  method                trust-region, adam or l-bfgs (default: the first)
  loss                  gaussian, soft-l1 or student (default: the first)
  [parameters]          what is fitted, for example
                        c_v = { start = 1.0, lower = 0.01, upper = 10.0 }
                        with prior = { mean = 1.0, sd = 0.5 } if there is one
                        (default: c_v, gamma_v and k_E); parameters of laws of your
                        own are fitted likewise. One may be tied to others,
                        k_E = { expression = "600 * c_v" }, or differ from group to
                        group, c_v = { by = "campaign", group_sd = 0.3 }
  [nuisance.slope_deg]  a column that was not measured, or not well: fitted for each
                        group, and added to the column where the tables hold it;
                        by = "campaign" (or another column of text, or "row"),
                        prior = { mean = 30.0, sd = 5.0 }
  [soil]                fixed values in place of the defaults, and laws in place of
                        the usual ones: flow = "FluidityRate", one of the package, or
                        flow = "my_laws.py:MyFlow", relative to the study; then its
                        parameters have columns of their own, my_rate = 3.0
  [block]               likewise what all blocks have in common and no table says:
                        shape = "EllipticCylinder" and its parameters. The tables may
                        have columns `shape`, a name in each row, and `flow` and so on
  [default_sigma]       for each target, where the tables have no column for it; where
                        neither is there, sigma is estimated from the scatter
  [scatter]             for each target whose sigma is estimated, "constant" or
                        "proportional" to its value; or scatter = one of them for all
                        (default: constant, or the better of the two where the values
                        of a target span a decade)
  [weights]             for each target, on its losses (default: 1)
  [[variants]]          soil values or laws to be changed; each is fitted by itself
  [compare]             laws to compare with: laws = ["model", "model with cohesion",
                        "constant coefficients", "my_laws.py:MyRebound"], and
                        by = ["shape"], columns whose groups are left out (default: see
                        --compare)
  [further_tests]       what could be measured next (default: usual impacts, and the
                        targets, depth and force), for example
                        candidates = { angle_deg = [0, 30, 60], speed_mps = [10, 20] }
                        measure = { e_n = 0.05, max_penetration_m = { relative = 0.1 } }
                        count = 3, criterion = "D" or "A"

The report is printed. Written to DIR: report.html, the same with pictures on one page;
fit.json with a manifest; fitted.csv; and of a comparison comparison.csv.

A slope to fit, slope.toml, is a study of `jaximpact runout` with two tables more:
  [fit]                 quantities of the ground to fit, each with its prior as a
                        distribution, for example
                        rolling_friction_angle_deg = { from = 15, to = 40 }
                        gamma_v = { median = 5, geometric_sd = 2 }
                        for the whole slope; [fit.materials.NAME] or [fit.segment.N]
                        for a part of it; [fit.contacts] for parameters of a law in
                        closed form, such as e_n
    data_sets           simulated data sets behind the posterior (default: 1500)
  [observed]            what was observed, any of:
    stops               CSV with the column x_m, where blocks stopped
    passages            CSV with collector_m and any of speed_mps, height_m (of the
                        centre above the ground) and energy_kJ, at first passage; a
                        cell may be empty
    counts              list of { x_m = 400, passed = 12, of = 60 }: blocks that passed
                        a line, of those released
    held_out_m          list of collectors that are predicted, and not fitted
    sigma               standard deviations of the errors of measurement, by column
    blocks              number released, if more than were observed
All blocks are taken as independent samples of the releases and blocks of the study. Of
more than 400 a random part is used. The report is printed; written are report.html,
fit.json with a manifest, samples.csv (the posterior), exceedance.csv (curves at
collectors, lines and barriers) and, with [[barriers]], barriers.csv (shares and design
values). Simulated data sets are kept in DIR/unfinished until then."""
PREDICT = """\
Predict tests with the ground that `jaximpact calibrate` fitted, and score what was
measured of them.

Printed, for each variant of the fit: rms and bias of every target, how many
measurements lie in their intervals of 50 and 95 %, the mean continuous ranked
probability score (CRPS), and the same for the mean of the fitted tests as a plain
forecast; which tests lie outside the range of the fitted ones; what was not
identifiable; and, of up to 30 tests, each prediction. Intervals hold what the fit
leaves open and the scatter of a measurement as the fit states it. Beside the model
stand constant coefficients, and Pfeiffer and Bowen, fitted to the same tests.

The ground has the laws of the fit, and blocks its shape where the tests do not say
theirs; a law that was edited since is refused.

Tests need no result columns; those that are there may have empty cells, limits like
>0.3 or <0.1, and `sigma_` columns, as for `jaximpact calibrate`."""


def add_parser(commands) -> None:
    """Add both commands to the command line."""
    parser = options.add_command(
        commands,
        "calibrate",
        run,
        help="fit soil parameters to measured impacts, or to a slope",
        description=DESCRIPTION,
    )
    parser.add_argument(
        "study",
        type=Path,
        metavar="STUDY",
        help="study.toml, what to fit to which data and how; tests.csv, the tests "
        "alone; or slope.toml, a slope with what was observed there",
    )
    options.add_directory(parser, "report and fitted values")
    parser.add_argument(
        "--posterior",
        action="store_true",
        help="sample the posterior too, by NUTS, some minutes for each variant, and "
        "write posterior.nc for ArviZ; needs pip install 'jaximpact[bayes]'",
    )

    parser.add_argument(
        "--compare",
        action="store_true",
        help="find out too which law predicts tests left out best, about a minute: the "
        "model; the model with modulus at contact pressure, and with inertia; each "
        "with cohesion; constant coefficients, Pfeiffer and Bowen, a power law in the "
        "angle, and a rigid ellipsoid; or the laws that [compare] in the study names",
    )

    options.add_engine(parser, "slopes only: ")
    parser = options.add_command(
        commands,
        "predict",
        run_predict,
        help="predict further tests with fitted soil parameters, and score them",
        description=PREDICT,
    )
    parser.add_argument(
        "result",
        type=Path,
        metavar="RESULT",
        help="the directory that `jaximpact calibrate` wrote, or its fit.json",
    )
    parser.add_argument(
        "tests", type=Path, metavar="tests.csv", help="the tests to predict"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="predictions.csv",
        help="table of all predictions, with scores and origin beside it in "
        "predictions.csv.manifest.json",
    )


def run(arguments: argparse.Namespace) -> None:
    """Fit to impacts, or to a slope."""
    from ..calibration.api import fit_and_examine
    from ..calibration.problem.config import SlopeStudyError, read_study
    from ..calibration.report.study_report import study_report

    try:
        study = read_study(arguments.study)
    except SlopeStudyError:
        _run_slope(arguments)
        return
    if arguments.workers is not None or arguments.scheduler is not None:
        raise InputError(
            "--workers and --scheduler are for slopes; a fit to impacts runs in this "
            "process"
        )
    begin = time.monotonic()
    with ProgressLines() as progress, reporting_to(progress):
        result, examined, others = fit_and_examine(
            study,
            arguments.out,
            posterior=arguments.posterior,
            compare=arguments.compare,
        )
    print(study_report(result, examined, others.compared).text(), end="")
    seconds = time.monotonic() - begin
    say(f"{result.seconds:.0f} s for the fits, {seconds:.0f} s in all")
    say(f"the report is {arguments.out / 'report.html'}")


def _run_slope(arguments: argparse.Namespace) -> None:
    from ..runout import calibrate_slope
    from ..runout.back_analysis.report import report

    if arguments.posterior:
        raise InputError(
            "--posterior is for impacts; of a slope samples.csv has the posterior"
        )
    if arguments.compare:
        raise InputError("--compare is for impacts; a slope has the laws of its study")
    begin = time.monotonic()
    with (
        resumable(),
        options.engine_of(arguments) as executor,
        ProgressLines() as progress,
    ):
        result = calibrate_slope(
            arguments.study, arguments.out, executor=executor, progress=progress
        )
    print(report(result).text(), end="")
    say(f"{time.monotonic() - begin:.0f} s in all")
    say(f"the report is {arguments.out / 'report.html'}")


def run_predict(arguments: argparse.Namespace) -> None:
    """Predict."""
    from ..calibration.api import predict
    from ..calibration.fitted_ground import files_of_fit

    out, files = arguments.out, contextlib.nullcontext()
    if out is not None:
        files = output_files(
            {"--out": out},
            inputs=[arguments.tests, *files_of_fit(arguments.result)],
            manifests=[manifest_path(out)],
        )
    with files:
        if out is not None:
            options.check_ending("--out", out, ".csv")
        with ProgressLines() as progress:
            prediction = predict(arguments.result, arguments.tests, progress=progress)
        if out is not None:
            prediction.write(out)
    print(prediction, end="")

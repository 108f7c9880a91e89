"""`jaximpact calibrate`: soil parameters from measured impacts."""

import argparse
import sys
import time
from pathlib import Path

from ..errors import shown
from ..interruption import resumable
from . import options
from .progress import say, write

DESCRIPTION = """\
Fit soil parameters to a table of measured impacts, and say what the data do not
determine.

What to fit is a table of tests (CSV), or a study that names one. Of a table alone c_v,
gamma_v and k_E are fitted to all the results that it holds. A study is a TOML file:
  title, source, notes  free text
  data                  the table of tests (CSV), relative to the study, or a list of
                        tables, one a campaign; columns are those of `jaximpact batch`,
                        in and out, and `sigma_` with the name of a result for the
                        standard deviation of its measurement. A cell of a result may
                        be empty, or a limit like >0.3 or <0.1
  targets               results to fit (default: all that the tables hold)
  starts, seed          how many fits, from where (default: 64, 0)
  accuracy              fast, balanced or reference (default: reference)
  method                levenberg-marquardt, adam or l-bfgs (default: the first)
  loss                  gaussian, soft-l1 or student (default: the first)
  [parameters]          what is fitted, for example
                        c_v = { start = 1.0, lower = 0.01, upper = 10.0 }
                        with prior = { mean = 1.0, sd = 0.5 } if there is one
                        (default: c_v, gamma_v and k_E); parameters of laws of your
                        own are fitted likewise
  [nuisance.slope_deg]  a column that was not measured, or not well: fitted for each
                        group, and added to the column where the tables hold it;
                        by = "campaign" (or another column of text, or "row"),
                        prior = { mean = 30.0, sd = 5.0 }; of slope_deg also
                        turns_ground = true: angle_deg and orientation_deg turn with it
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
                        (default: constant)
  [weights]             for each target, on its losses (default: 1)
  [[variants]]          soil values or laws to be changed; each is fitted by itself
  [further_tests]       what could be measured next (default: usual impacts, and the
                        targets, depth and force), for example
                        candidates = { angle_deg = [0, 30, 60], speed_mps = [10, 20] }
                        measure = { e_n = 0.05, max_penetration_m = { relative = 0.1 } }
                        count = 3, criterion = "D" or "A"

Written to DIR: report.html, one page with all that was found, and the same as report.md
with pictures in report/; report.txt (also printed), fit.json with a manifest,
fitted.csv and fit.png. Finished fits are kept in DIR/unfinished until then: after
Ctrl-C the same command goes on there."""
SAY_EVERY = 5.0
"""Seconds between lines of progress where stderr is not a terminal."""


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "calibrate",
        help="fit soil parameters to measured impacts",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "study",
        type=Path,
        metavar="STUDY",
        help="study.toml, what to fit to which data and how; or tests.csv, the tests "
        "alone",
    )
    options.add_directory(parser, "report, fitted values and plot")
    parser.add_argument(
        "--posterior",
        action="store_true",
        help="sample the posterior too, by NUTS, some minutes for each variant, and "
        "write posterior.nc for ArviZ; needs pip install 'jaximpact[bayes]'",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Fit."""
    from ..calibration.report import as_text
    from ..calibration.reservations import of_all
    from ..calibration.run import UNFINISHED, fit_and_examine
    from ..calibration.study_file import read_study

    kept = arguments.out / UNFINISHED

    def prospect() -> str:
        if kept.is_dir() and any(kept.iterdir()):
            return f"finished fits are kept in {kept}; the same command goes on there"
        return "no fit was finished; the same command starts anew"

    begin = time.monotonic()
    with resumable(prospect), Lines() as progress:
        result, examined = fit_and_examine(
            read_study(arguments.study),
            arguments.out,
            posterior=arguments.posterior,
            progress=progress,
        )
    print(as_text(result, of_all(result, examined)), end="")
    seconds = time.monotonic() - begin
    say(f"{result.seconds:.0f} s for the fits, {seconds:.0f} s in all")
    say(f"the report is {arguments.out / 'report.html'}")


class Lines:
    """Lines of progress on stderr: on a terminal each in place of the last, else one
    every few seconds. To be used in a `with`, which ends the line that is open."""

    def __init__(self):
        self.stream = sys.stderr
        self.overwrites = self.stream.isatty()
        self.length = 0
        self.last = -SAY_EVERY

    def __enter__(self) -> "Lines":
        return self

    def __exit__(self, *exception) -> None:
        if self.length:
            write(self.stream, "\n")

    def __call__(self, text: str) -> None:
        text, now = shown(text), time.monotonic()
        if self.overwrites:
            write(self.stream, "\r" + text.ljust(self.length))
            self.length = len(text)
        elif now - self.last >= SAY_EVERY:
            write(self.stream, f"{text}\n")
            self.last = now

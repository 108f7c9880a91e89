"""`jaximpact calibrate`: soil parameters from measured impacts."""

import argparse
import sys
import time
from pathlib import Path

from .progress import say

DESCRIPTION = """\
Fit soil parameters to a table of measured impacts, and say what the data do not
determine.

The study is a TOML file:
  title, source, notes  free text
  data                  the table of tests (CSV), relative to the study; its columns are
                        those of `jaximpact batch`, in and out, and `sigma_` with the
                        name of a result for the standard deviation of its measurement
  targets               results to fit (default: all that the table holds)
  starts, seed          how many fits, from where (default: 16, 0)
  accuracy              fast, balanced or reference (default: balanced)
  method                levenberg-marquardt or adam (default: the first)
  [parameters]          what is fitted, for example
                        c_v = { start = 1.0, lower = 0.01, upper = 10.0 }
                        (default: c_v, gamma_v and k_E)
  [soil]                fixed values in place of the defaults
  [default_sigma]       for each target, where the table has no column for it
  [[variants]]          soil values to be changed; each is fitted by itself

Written to DIR: report.txt (also printed), fit.json with a manifest, fitted.csv and
fit.png."""
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
        metavar="STUDY.toml",
        help="what to fit to which data, and how",
    )
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="DIR",
        help="directory for report, fitted values and plot; made if need be",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Fit."""
    from ..calibration.report import as_text
    from ..calibration.run import run_study

    with Lines() as progress:
        result = run_study(arguments.study, arguments.out, progress=progress)
    print(as_text(result), end="")
    say(f"{result.seconds:.0f} s in all")


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
            self.stream.write("\n")

    def __call__(self, text: str) -> None:
        now = time.monotonic()
        if self.overwrites:
            self.stream.write("\r" + text.ljust(self.length))
            self.length = len(text)
        elif now - self.last >= SAY_EVERY:
            self.stream.write(f"{text}\n")
            self.last = now
        self.stream.flush()

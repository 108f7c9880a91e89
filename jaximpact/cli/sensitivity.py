"""`jaximpact sensitivity`: which parameters matter."""

import argparse
from pathlib import Path

from ..interruption import resumable
from . import options
from .progress import ProgressLines, say

METHODS = ("elasticities", "morris", "sobol", "all")
"""Names of the methods, as in `sensitivity.study_file`, which loads JAX."""
DESCRIPTION = """\
Say which parameters matter for one impact, and over ranges of its parameters.

  elasticities  per cent of an output for one per cent of a parameter, by automatic
                differentiation, checked by differences
  morris        elementary effects over the ranges: a screening, at little cost
  sobol         parts of the output's variance over the ranges, with intervals

The study is a TOML file: a scene, as `jaximpact simulate` takes it, and
  title            free text
  [parameters]     what is varied (default: those of c_v, gamma_v and k_E that the laws
                   have, without ranges), for example
                   c_v = { lower = 0.1, upper = 10, distribution = "log-uniform" }
                   angle_deg = { lower = 10, upper = 60 }
                   dilatancy = {}
                   the distribution is uniform or log-uniform; {} is for elasticities
  outputs          results to look at (default: all that `jaximpact batch` appends)
  method           as --method
  blocks           of the sample for sobol, a power of two (default: 4096); each takes
                   an impact for every parameter and two more
  trajectories     for morris (default: 256)
  seed             of the samples (default: 0)

Blocks and trajectories with an impact that failed are left out whole, and counted.
Written to DIR: report.txt (also printed), manifest.json, and for each method NAME.csv
and drawings. After a run that was cut short the same command goes on from there."""


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = options.add_command(
        commands,
        "sensitivity",
        run,
        help="which parameters matter",
        description=DESCRIPTION,
        epilog=lambda: options.input_help("Parameters:"),
    )
    parser.add_argument(
        "study", type=Path, metavar="study.toml", help="scene and parameters"
    )
    options.add_directory(parser, "report, tables and drawings")
    parser.add_argument(
        "--method",
        choices=METHODS,
        help="what to compute (default: the study's, else all where every parameter "
        "has a range, else elasticities)",
    )
    options.add_accuracy(
        parser,
        otherwise="the study's, else reference for elasticities and balanced for the "
        "rest",
    )


def run(arguments: argparse.Namespace) -> None:
    """Compute the study."""
    from ..sensitivity.study import run_study

    with resumable(), ProgressLines() as progress:
        report = run_study(
            arguments.study,
            arguments.out,
            method=arguments.method,
            accuracy=arguments.accuracy,
            progress=progress,
        )
    print(report)
    say(f"tables and drawings written to {arguments.out}")

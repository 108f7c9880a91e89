"""`jaximpact figures`: the paper's figures, computed again."""

import argparse

from ..interruption import resumable
from . import options
from .calibrate import Lines
from .progress import say

ACCURACY = "reference"
DESCRIPTION = """\
Compute and draw figures 4 to 14 of Dattola, Crosta and di Prisco (2023).

  4   set I: displacement and force over time
  5   sets I and II: their largest values against aspect ratio
  6   set III at 20 degrees: displacement, force, rotation and R_r over time
  7   set III along the major axis: largest values and rotation against impact angle
  8   set IV: restitution, largest values and rotation against orientation
  9   set III: restitution against impact angle
  10  the slope of two planes
  11  runs down it without initial spin: path, height, velocities
  12  heights of jumps in runs with all spins, with exponential fits
  13  coefficients of a spinning block against orientation
  14  restitution in all impacts of these runs, with normal fits

Each is figure-N.png, drawn from the table figure-N.csv; figure-N.csv.manifest.json says
what it was computed from. All together take a minute on two cores."""


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "figures",
        help="the paper's figures, computed again",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    options.add_directory(parser, "drawings and tables")
    parser.add_argument(
        "--only",
        nargs="+",
        default=(),
        metavar="N",
        help="numbers of figures (default: all)",
    )
    parser.add_argument(
        "--ground",
        metavar="NAME",
        help='"Table 1" (default), or of the supplementary material '
        '"c_v 0.5, gamma_v 1.70" or "c_v 0.5, gamma_v 0.85"',
    )
    options.add_accuracy(parser, otherwise=ACCURACY)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Compute and draw."""
    from ..figures import Study, write_figures
    from ..parametric_sets import TABLE_1

    with (
        resumable(lambda: "figures that were written are whole"),
        Lines() as progress,
    ):
        study = Study(
            arguments.ground or TABLE_1, arguments.accuracy or ACCURACY, progress
        )
        write_figures(arguments.out, only=arguments.only, study=study, say=say)

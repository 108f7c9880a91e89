"""`jaximpact figures` and `jaximpact validate`: the paper's figures and claims."""

import argparse

from ..errors import IncompleteError
from ..interruption import resumable
from . import options
from .progress import ProgressLines, say

ACCURACY = "reference"
FIGURES = """\
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
VALIDATE = """\
Recompute the claims that the paper makes of its model, and laws that others fitted to
measured impacts, and say of each whether it holds, partly or not, with the numbers that
decide. How each is judged was written down before it was computed.

Written to DIR: validation.md, validation.csv and validation.json with a manifest, and
drawings of the laws. With --readings also readings.csv: the claims under other readings
of what the paper does not print. That takes some minutes; in DIR an interrupted run
goes on where it stopped.

A claim that fails is a result. The exit code is 1 only if something could not be
computed."""


def add_parser(commands) -> None:
    """Add both commands to the command line."""
    parser = options.add_command(
        commands,
        "figures",
        run_figures,
        help="the paper's figures, computed again",
        description=FIGURES,
    )
    options.add_directory(parser, "drawings and tables")
    options.add_only(parser, "N", "numbers of figures")
    parser.add_argument(
        "--ground",
        metavar="NAME",
        help='"Table 1" (default), or of the supplementary material '
        '"c_v 0.5, gamma_v 1.70" or "c_v 0.5, gamma_v 0.85"',
    )
    options.add_accuracy(parser, otherwise=ACCURACY)

    parser = options.add_command(
        commands,
        "validate",
        run_validate,
        help="the paper's claims and other laws, recomputed",
        description=VALIDATE,
    )
    options.add_directory(parser, "tables and drawings", required=False)
    options.add_only(parser, "ID", "claims to judge, as in C07 C08, and laws")
    parser.add_argument(
        "--readings",
        action="store_true",
        help="also under other readings of the model: which claims hang on which",
    )


def run_figures(arguments: argparse.Namespace) -> None:
    """Compute and draw."""
    from ..paper.figures import Study, write_figures
    from ..paper.sets import TABLE_1

    with (
        resumable(lambda: "figures that were written are whole"),
        ProgressLines() as progress,
    ):
        study = Study(
            arguments.ground or TABLE_1, arguments.accuracy or ACCURACY, progress
        )
        write_figures(arguments.out, only=arguments.only, study=study, say=say)


def run_validate(arguments: argparse.Namespace) -> None:
    """Judge."""
    from ..paper import validate
    from ..paper.report import as_text

    with ProgressLines() as progress:
        validation = validate(
            arguments.out,
            only=arguments.only,
            readings=arguments.readings,
            progress=progress,
            say=say,
        )
    print(as_text(validation), end="")
    if validation.missing:
        raise IncompleteError(f"not computed: {', '.join(validation.missing)}")

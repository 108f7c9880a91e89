"""`python -m paper`: the paper's figures and claims, recomputed."""

import argparse
import sys

from jaximpact.cli import Parser, main, options
from jaximpact.cli.progress import ProgressLines, say
from jaximpact.errors import IncompleteError
from jaximpact.interruption import ending_on_signals, resumable

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
CLAIMS = """\
Recompute the claims that the paper makes of its model, and say of each whether it
holds, partly or not, with the numbers that decide. How each is judged was written down
before it was computed. Written to DIR: validation.md, validation.csv and
validation.json with a manifest.

A claim that fails is a result. The exit code is 1 only if something could not be
computed."""
READINGS = """\
Judge the claims as `claims` does, and again under other readings of what the paper does
not print: which claims hang on which. That takes some minutes. Verdicts are written to
readings.csv in DIR after each reading; there an interrupted run goes on."""


def make_parser() -> Parser:
    """The parser of the commands."""
    parser = Parser(
        prog="python -m paper",
        description="The paper's figures and claims, recomputed.",
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    figures = options.add_command(
        commands,
        "figures",
        run_figures,
        help="figures 4 to 14",
        description=FIGURES,
    )
    options.add_directory(figures, "drawings and tables")
    options.add_only(figures, "N", "numbers of figures")
    figures.add_argument(
        "--ground",
        metavar="NAME",
        help='"Table 1" (default), or of the supplementary material '
        '"c_v 0.5, gamma_v 1.70" or "c_v 0.5, gamma_v 0.85"',
    )
    options.add_accuracy(figures, otherwise=ACCURACY)
    for name, help_line, text in (
        ("claims", "the claims, judged", CLAIMS),
        ("readings", "the claims under other readings of the model", READINGS),
    ):
        command = options.add_command(
            commands, name, run_claims, help=help_line, description=text
        )
        command.set_defaults(readings=name == "readings")
        options.add_directory(command, "tables", required=False)
        options.add_only(command, "ID", "claims to judge, as in C07 C08")
    return parser


def run_figures(arguments: argparse.Namespace) -> None:
    """Compute and draw."""
    from jaximpact.parametric_sets import TABLE_1

    from .figures import Study, write_figures

    with (
        resumable(lambda: "figures that were written are whole"),
        ProgressLines() as progress,
    ):
        study = Study(
            arguments.ground or TABLE_1, arguments.accuracy or ACCURACY, progress
        )
        write_figures(arguments.out, only=arguments.only, study=study, say=say)


def run_claims(arguments: argparse.Namespace) -> None:
    """Judge."""
    from .report import as_text
    from .validation import validate

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


if __name__ == "__main__":
    with ending_on_signals():
        sys.exit(main(make_parser=make_parser))

"""`python -m paper`: the paper's figures and claims, recomputed."""

import argparse
import sys

from jaximpact.cli import Parser, main, options
from jaximpact.errors import IncompleteError, check_choice
from jaximpact.interruption import ending_on_signals, resumable
from jaximpact.io.files import make_directory, write_text
from jaximpact.progress_lines import say

ACCURACY = "reference"
KEPT = "made if need be; files of the same names are replaced"
"""Which directory takes results."""
FIGURES = """\
Compute and draw figures 4 to 14 of Dattola, Crosta and di Prisco (2023).

{}

Each is figure-N.png, drawn from the table figure-N.csv; figure-N.csv.manifest.json says
what it was computed from. All together take a minute on two cores."""
CLAIMS = """\
Recompute the claims that the paper makes of its model, and say of each whether it
holds, partly or not, with the numbers that decide. How each is judged was written down
before it was computed. In DIR: claims.md and claims.csv.

A claim that fails is a result. The exit code is 1 only if something could not be
computed. A minute on two cores."""
READINGS = """\
Judge the claims again under other readings of what the paper does not print: which
claims hang on which. In DIR: readings.md and readings.csv. That takes 15 minutes; in
DIR an interrupted run goes on."""


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
        description=_figures_help,
    )
    options.add_directory(figures, "drawings and tables", which=KEPT)
    options.add_only(figures, "N", "numbers of figures")
    figures.add_argument(
        "--ground",
        metavar="NAME",
        default="Table 1",
        help='"Table 1" (default), or of the supplementary material '
        '"c_v 0.5, gamma_v 1.70" or "c_v 0.5, gamma_v 0.85"',
    )
    options.add_accuracy(figures, otherwise=ACCURACY)
    for name, run, help_line, text in (
        ("claims", run_claims, "the claims, judged", CLAIMS),
        ("readings", run_readings, "the claims under other readings", READINGS),
    ):
        command = options.add_command(
            commands, name, run, help=help_line, description=text
        )
        options.add_directory(command, "tables", required=False, which=KEPT)
        options.add_only(command, "ID", "claims to judge, as in C07 C08")
    return parser


def _figures_help() -> str:
    from .figures import PAPER_FIGURES

    titles = [f"  {n:<3} {figure.title}" for n, figure in PAPER_FIGURES.items()]
    return FIGURES.format("\n".join(titles))


def run_figures(arguments: argparse.Namespace) -> None:
    """Compute and draw."""
    from .figures import write_figures
    from .study import Study

    study = Study(arguments.ground, accuracy=arguments.accuracy or ACCURACY)
    with resumable(lambda: "figures that were written are whole"):
        write_figures(arguments.out, study, only=arguments.only, say=say)


def run_claims(arguments: argparse.Namespace) -> None:
    """Judge the claims."""
    from .claims import read_claims
    from .judging import judge_claim
    from .report import claims_page, claims_table, counts, in_words
    from .study import Study

    out, claims, judgements = arguments.out, read_claims(), {}
    names, study = _chosen(arguments), Study()
    for name in names:
        judgements[name] = judge_claim(name, study)
        print(in_words(claims[name], judgements[name]), flush=True)
    print(counts(judgements))
    if out is not None:
        write_text(out / "claims.csv", claims_table(claims, judgements))
        write_text(out / "claims.md", claims_page(claims, judgements))
    _refuse_missing(judgements)


def run_readings(arguments: argparse.Namespace) -> None:
    """Judge the claims under all readings."""
    from .judging import judge_readings
    from .report import readings_page

    with resumable():
        readings = judge_readings(_chosen(arguments), arguments.out, say)
    page = readings_page(readings)
    print(page, end="")
    if arguments.out is not None:
        write_text(arguments.out / "readings.md", page)
    for judgements in readings.values():
        _refuse_missing(judgements)


def _chosen(arguments: argparse.Namespace) -> list[str]:
    """Ids of the claims that are asked for; makes the directory."""
    from .claims import JUDGES

    for name in arguments.only:
        check_choice("--only", name, JUDGES)
    if arguments.out is not None:
        make_directory(arguments.out, option="--out")
    return [name for name in JUDGES if not arguments.only or name in arguments.only]


def _refuse_missing(judgements) -> None:
    """Raise IncompleteError where a claim could not be judged."""
    missing = [n for n, one in judgements.items() if one.verdict == "not computed"]
    if missing:
        raise IncompleteError(f"not computed: {', '.join(missing)}")


if __name__ == "__main__":
    with ending_on_signals():
        sys.exit(main(make_parser=make_parser))

"""`jaximpact calibrate`: soil parameters from measured impacts."""

import argparse
from pathlib import Path


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "calibrate",
        help="fit soil parameters to measured impacts",
        description="Fit soil parameters to a table of measured impacts.",
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
        help="directory for the report, the fitted values and the plot",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Fit."""
    from ..calibration.study import run_study

    run_study(arguments.study, arguments.out)

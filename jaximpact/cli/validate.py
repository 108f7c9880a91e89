"""`jaximpact validate`: the paper's claims and laws of others, against the model."""

import argparse

from ..errors import IncompleteError
from . import options
from .calibrate import Lines
from .progress import say

DESCRIPTION = """\
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
    """Add the command to the command line."""
    parser = commands.add_parser(
        "validate",
        help="the paper's claims and other laws, recomputed",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    options.add_directory(parser, "tables and drawings", required=False)
    parser.add_argument(
        "--only",
        nargs="+",
        default=(),
        metavar="ID",
        help="claims to judge, as in C07 C08, and laws (default: all)",
    )
    parser.add_argument(
        "--readings",
        action="store_true",
        help="also under other readings of the model: which claims hang on which",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Judge."""
    from ..validation import validate
    from ..validation.report import as_text

    with Lines() as progress:
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

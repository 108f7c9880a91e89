"""`jaximpact predict`: tests that a calibration has not seen."""

import argparse
import contextlib
from pathlib import Path

from ..formats.outputs import manifest_path, output_files

DESCRIPTION = """\
Predict tests with the ground that `jaximpact calibrate` fitted, and score what was
measured of them.

Printed, for each variant of the fit: rms and bias of every target, how many
measurements lie in their intervals of 50 and 95 %, the mean continuous ranked
probability score (CRPS), and the same for the mean of the fitted tests as a plain
forecast; which tests lie outside the range of the fitted ones; what the fit did not
determine; and, of up to 30 tests, each prediction. Intervals hold what the fit leaves
open and the scatter of a measurement as the fit states it.

The ground has the laws of the fit, and blocks its shape where the tests do not say
theirs; a law that was edited since is refused.

Tests need no result columns; those that are there may have empty cells, limits like
>0.3 or <0.1, and `sigma_` columns, as for `jaximpact calibrate`."""


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "predict",
        help="predict further tests with fitted soil parameters, and score them",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
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
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Predict."""
    from ..calibration.fitted_ground import files_of_fit
    from ..calibration.prediction import predict
    from .calibrate import Lines

    out, files = arguments.out, contextlib.nullcontext()
    if out is not None:
        files = output_files(
            {"--out": out},
            inputs=[arguments.tests, *files_of_fit(arguments.result)],
            beside={manifest_path(out): manifest_path(out)},
        )
    with files:
        with Lines() as progress:
            found = predict(arguments.result, arguments.tests, progress=progress)
        if out is not None:
            found.write(out)
    print(found, end="")

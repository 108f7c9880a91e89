"""`python -m benchmarks`: speed against accuracy, charted."""

import argparse
import sys
from pathlib import Path

from jaximpact.cli import Parser, main, options
from jaximpact.interruption import ending_on_signals
from jaximpact.progress_lines import ProgressLines, say

DESCRIPTION = """\
Measure speed and accuracy of this solver and of others on the same impacts, and draw
the charts.

Sections, each NAME.png with its data NAME.csv and its figures NAME.md:
  work-precision  error of e_n against time, one impact at a time and in batches
  gradient        the same for derivatives with respect to k_E, gamma_v, c_v
  target          impacts a second at 95 % of errors within 1e-3, against numbalsoda
  in-jax          what jit, vmap and grad add to an impact, and to many
  ladder          error against cost of each model on each parametric set
  throughput      impacts a second against the size of the batch
  compile-time    first uses, each in a process of its own
  stability       which methods finish, lie and fail, at the extremes
  explicit-step   the largest step at which an explicit method is right

manifest.json says what they were measured with. A section that was measured before with
the same settings is drawn again and not measured again, so that an interrupted
benchmark goes on; remove its CSV to measure it again. The machine should be idle.

Other solvers are the modules *_peer.py of the directory benchmarks/peers, and need
`pip install -e '.[peers]'`; one whose packages are missing is left out."""


def make_parser() -> Parser:
    """The parser of the command."""
    parser = Parser(
        prog="python -m benchmarks",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    options.add_directory(parser, "charts and data")
    options.add_only(parser, "NAME", "sections to measure")
    parser.add_argument(
        "--peers",
        type=Path,
        metavar="DIR",
        help="directory of other solvers (default: benchmarks/peers)",
    )
    parser.set_defaults(run=run)
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Measure and draw."""
    from .charts import run_benchmark

    with ProgressLines() as progress:
        text = run_benchmark(
            arguments.out,
            only=arguments.only,
            peers=arguments.peers,
            progress=progress,
            say=say,
        )
    print(text, end="")


if __name__ == "__main__":
    with ending_on_signals():
        sys.exit(main(make_parser=make_parser))

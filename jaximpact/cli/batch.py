"""`jaximpact batch`: many impacts from a table."""

import argparse
import math
from pathlib import Path

from ..accuracy import DEFAULT_ACCURACY
from ..interruption import resumable
from ..io.output_files import journal_path, manifest_path, output_files
from . import options
from .progress import ProgressLines, say

DESCRIPTION = """\
Compute every impact of a table of scenes and append the results to its rows. Tables are
CSV; or Parquet, in and out, where their names end in .parquet (needs
jaximpact[cluster]).

A column that is missing takes its value in the scene of --base, or its default. Text
columns `flow`, `hardening` and so on name laws, one for the whole table; a column
`shape` names the shape of each row. Cells of what the row's shape has no parameter for
stay empty.

A scene that cannot be solved gets the outcome `failed` and nan, and the rest go on. A
manifest with laws, versions, accuracy and the checksum of the scenes is written beside
the results.

Results are kept in results.csv.journal as they come. After a run that was cut short, by
Ctrl-C, kill or a power cut, the same command goes on where it stopped."""


def _columns() -> str:
    inputs = options.input_help("Columns of the scenes:")
    return f"{inputs}\n\n{options.label_help()}\n\n{options.result_help()}"


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = options.add_command(
        commands,
        "batch",
        run,
        help="many impacts from a CSV",
        description=DESCRIPTION,
        epilog=_columns,
    )
    parser.add_argument(
        "scenes", type=Path, metavar="scenes.csv", help="table of scenes, one a row"
    )
    parser.add_argument(
        "--base",
        type=Path,
        metavar="scene.toml",
        help="scene, as `jaximpact simulate` takes it, whose laws, shape and values "
        "stand for the columns that the table does not have",
    )
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="results.csv",
        help="table of results; an existing one is replaced once the new one is whole",
    )
    options.add_accuracy(parser, otherwise=f"the base's, else {DEFAULT_ACCURACY}")
    parser.add_argument(
        "--model-tolerance",
        type=_tolerance,
        default=0.0,
        metavar="ERROR",
        help="take cheaper models where they were measured to be within this error of "
        "e_n and e_bar (default: 0, only where they are exact)",
    )
    parser.add_argument(
        "--timing",
        action="store_true",
        help="print seconds of compilation and of running, and impacts per second",
    )
    options.add_engine(parser)


def _tolerance(text: str) -> float:
    value = float(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"must be at least 0, but is {text}")
    return value


def run(arguments: argparse.Namespace) -> None:
    """Compute the table."""
    from ..batch import simulate_batch
    from ..io.result_table import count_outcomes, write_results
    from ..io.scene_table import read_table
    from ..io.toml import read_scene

    scenes, base, out = arguments.scenes, arguments.base, arguments.out
    timing = {}
    manifest, journal = manifest_path(out), journal_path(out)
    files = output_files(
        {"--out": out},
        inputs=[scenes, *([] if base is None else [base])],
        beside={manifest: manifest},
        journals=[journal],
    )
    with files, resumable():
        accuracy = arguments.accuracy
        if base is not None:
            base, of_file = read_scene(base)
            accuracy = accuracy or of_file
        table = read_table(scenes, base=base)
        with options.engine_of(arguments) as executor, ProgressLines() as progress:
            progress("impacts", 0, len(table.rows))
            result = simulate_batch(
                table.scene(),
                accuracy=accuracy or DEFAULT_ACCURACY,
                model_tolerance=arguments.model_tolerance,
                journal=journal,
                progress=progress,
                timing=timing,
                executor=executor,
            )
        write_results(out, table, result, result.accuracy, result.model_tolerance)
    if arguments.timing:
        rate = timing["impacts"] / timing["run_s"]
        say(
            f"{timing['compile_s']:.2f} s compiling, {timing['run_s']:.2f} s running, "
            f"{rate:.0f} impacts/s in {timing['engine']}"
        )
    counts = [f"{count} {words}" for words, count in count_outcomes(result).items()]
    say(f"{len(table.rows)} impacts: {', '.join(counts)}")

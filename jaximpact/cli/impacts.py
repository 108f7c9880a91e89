"""`jaximpact simulate` and `batch`: one impact from a file, many from a table."""

import argparse
import contextlib
import json
from pathlib import Path
from typing import TYPE_CHECKING

from ..accuracy import DEFAULT_ACCURACY
from ..errors import InputError
from ..interruption import resumable
from ..io.files import replacing
from ..io.output_files import journal_path, manifest_path, output_files
from ..progress_lines import ProgressLines, say
from . import options

if TYPE_CHECKING:
    from ..result import ImpactResult

PLOT_SUFFIXES = (".png", ".pdf", ".svg")
SIMULATE = """\
Compute one impact and print every result with its energy ledger.

The scene is a TOML file with the tables [block], [soil] and [impact], or with the keys
of all three before any table. A key that is missing takes its default. Laws and shape
are named by keys of [soil] and [block], and bring keys of their own:

    [soil]
    flow = "FluidityRate"
    [block]
    shape = "my_shapes.py:Capsule"

`accuracy`, before any table, is used unless --accuracy is given."""


def add_parser(commands) -> None:
    """Add both commands to the command line."""
    _add_simulate(commands)
    _add_batch(commands)


def _add_simulate(commands) -> None:
    parser = options.add_command(
        commands,
        "simulate",
        run_simulate,
        help="one impact from a TOML file",
        description=SIMULATE,
        epilog=lambda: options.input_help("Keys of the scene:"),
    )
    parser.add_argument(
        "scene", type=Path, metavar="scene.toml", help="block, soil and impact"
    )
    parser.add_argument(
        "--json",
        action="store_true",
        help="print JSON, with what is needed to compute the impact again",
    )
    parser.add_argument(
        "--plot",
        type=Path,
        metavar="out.png",
        help="draw force, penetration, rotation and energy against time; "
        f"{', '.join(PLOT_SUFFIXES)}",
    )
    options.add_accuracy(parser, otherwise=f"the file's, else {DEFAULT_ACCURACY}")


def _add_batch(commands) -> None:
    parser = options.add_command(
        commands,
        "batch",
        run_batch,
        help="many impacts from a CSV",
        description=BATCH,
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
        "--timing",
        action="store_true",
        help="print seconds of compilation and of running, and impacts per second",
    )
    options.add_engine(parser)


def run_simulate(arguments: argparse.Namespace) -> None:
    """Compute one impact."""
    from ..io.toml import read_scene
    from ..simulation import simulate

    plot, files = arguments.plot, contextlib.nullcontext()
    if plot is not None:
        if plot.suffix not in PLOT_SUFFIXES:
            raise InputError(
                f"--plot must end in one of {', '.join(PLOT_SUFFIXES)}, but is {plot}"
            )
        files = output_files({"--plot": plot}, inputs=[arguments.scene])
    with files:
        scene, accuracy = read_scene(arguments.scene)
        result = simulate(
            scene.block,
            scene.soil,
            scene.impact,
            accuracy=arguments.accuracy or accuracy or DEFAULT_ACCURACY,
        )
        if plot is not None:
            with replacing(plot) as temporary:
                result.plot(temporary)
    if arguments.json:
        print(json.dumps(as_json(result), indent=2, allow_nan=False))
    else:
        print(as_text(result))


def as_text(result: "ImpactResult") -> str:
    """Return every result and the energy ledger as a table with units and meanings."""
    from .. import quantities
    from .._tables import align

    columns = quantities.RESULT_COLUMNS | quantities.FURTHER_COLUMNS
    ledger = quantities.ENERGY_COLUMNS.values()
    numbers = [(name, result, c) for name, c in columns.items()]
    numbers += [(f"energy {c.field}", result.energy, c) for c in ledger]
    rows = [
        (quantities.OUTCOME_COLUMN, str(result.outcome), "", quantities.OUTCOME_MEANING)
    ]
    rows += [
        (name, f"{float(getattr(owner, c.field)):.6g}", c.unit, c.meaning)
        for name, owner, c in numbers
    ]
    return align(rows)


def as_json(result: "ImpactResult") -> dict:
    """Return the same as a tree of plain values, None for NaN, with the manifest."""
    from .. import quantities
    from ..reports.json_tree import plain

    columns = quantities.RESULT_COLUMNS | quantities.FURTHER_COLUMNS
    ledger = [column.field for column in quantities.ENERGY_COLUMNS.values()]
    numbers = {name: float(getattr(result, c.field)) for name, c in columns.items()}
    return plain(
        {
            quantities.OUTCOME_COLUMN: str(result.outcome),
            **numbers,
            "energy_J": {of: float(getattr(result.energy, of)) for of in ledger},
            "manifest": result.manifest(),
        }
    )


BATCH = """\
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
    from .. import quantities
    from .._tables import align

    results = quantities.RESULT_COLUMNS.values()
    rows = [("name", "unit", "meaning")]
    rows += [(column.name, column.unit, column.meaning) for column in results]
    rows += [(quantities.OUTCOME_COLUMN, "-", quantities.OUTCOME_MEANING)]
    return (
        f"{options.input_help('Columns of the scenes:')}\n\n"
        "Columns of free text, carried along unchanged: "
        f"{', '.join(quantities.LABEL_COLUMNS)}.\n\n"
        f"Columns that are appended:\n{align(rows)}"
    )


def run_batch(arguments: argparse.Namespace) -> None:
    """Compute the table."""
    from .._packages import needed
    from ..batch import simulate_batch
    from ..io.parquet import is_parquet
    from ..io.result_table import count_outcomes, write_results
    from ..io.scene_table import read_table
    from ..io.toml import read_scene

    scenes, base, out = arguments.scenes, arguments.base, arguments.out
    if is_parquet(out):
        needed("pyarrow", f"--out {out}")
    timing = {}
    journal = journal_path(out)
    files = output_files(
        {"--out": out},
        inputs=[scenes, *([] if base is None else [base])],
        manifests=[manifest_path(out)],
        journals=[journal],
    )
    with files, resumable():
        options.check_ending("--out", out, ".csv", ".parquet")
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
                journal=journal,
                progress=progress,
                timing=timing,
                executor=executor,
            )
        write_results(out, table, result, result.accuracy)
    if arguments.timing and not timing["impacts"]:
        say(f"no impact was computed: {journal} held all results")
    elif arguments.timing:
        rate = timing["impacts"] / timing["run_s"]
        say(
            f"{timing['compile_s']:.2f} s compiling, {timing['run_s']:.2f} s running, "
            f"{rate:.0f} impacts/s in {timing['engine']}"
        )
    counts = [f"{count} {words}" for words, count in count_outcomes(result).items()]
    say(f"{len(table.rows)} impacts: {', '.join(counts)}")

"""`jaximpact tabulate`: the model's impacts in a table."""

import argparse
from functools import partial
from pathlib import Path

from ..errors import InputError
from ..interruption import resumable
from ..io.output_files import journal_path, manifest_path, output_files
from ..progress_lines import ProgressLines, say
from . import options

OUTPUTS = {
    "out": (".nc", "the table"),
    "csv": (".csv", "its nodes as text"),
}
"""Option -> suffix of its file, and help."""
DESCRIPTION = """\
Compute impacts of one block on one ground by the full model and keep them in a table,
from which run-outs and other rockfall programs look them up.

What to tabulate is a TOML file; what it does not say has its default:

    [block]
    mass_kg = 100
    aspect_ratio = 2
    shape = "Ellipsoid"             # the default

    [ground]                        # one number for each quantity of the soil
    gamma_v = 8.7
    flow = "Perzyna"                # the default; or one of your own, "laws.py:MyFlow"

    [table]
    slopes_deg = [0, 29.9]          # default [0]; between them the table is linear
    total_speeds_mps = [0.1, 120]   # first and last
    nodes = { speed = 12, elevation = 20, azimuth = 37, orientation = 20 }

--out: the table for `jaximpact runout`, under [[contacts]] with law = "table" and
files = ["table.nc"]. It belongs to this block on this ground and is refused for others,
other shapes and other laws.
A run-out meets the slopes of its segments, with roughness 3 standard deviations to both
sides; the table must cover them.
--csv: the same for other programs, a row for each node, units in the names of columns.

The error of the table on 10 000 random impacts is printed, and stays in its file. After
a run that was cut short the same command goes on from there."""


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = options.add_command(
        commands,
        "tabulate",
        run,
        help="impacts in tables, for run-outs and other programs",
        description=DESCRIPTION,
        epilog=lambda: options.input_help(
            "Quantities of block and ground, among others:"
        ),
    )
    parser.add_argument(
        "study", type=Path, metavar="table.toml", help="block, ground and axes"
    )
    for name, (suffix, what) in OUTPUTS.items():
        parser.add_argument(f"--{name}", type=Path, metavar=f"file{suffix}", help=what)
    options.add_accuracy(parser, otherwise="the file's, else fast")


def run(arguments: argparse.Namespace) -> None:
    """Make the table."""
    from ..lookup import tabulate, write_csv, write_table
    from ..lookup.table_study import read_table_study

    paths = ((f"--{name}", getattr(arguments, name)) for name in OUTPUTS)
    outputs = {option: path for option, path in paths if path is not None}
    if not outputs:
        raise InputError("--out or --csv is needed")
    study = read_table_study(arguments.study, arguments.accuracy)
    for option, path in outputs.items():
        suffix, _ = OUTPUTS[option[2:]]
        if path.suffix != suffix:
            raise InputError(f"{option} must end in {suffix}, but is {path}")
    csv = arguments.csv
    journal = journal_path(arguments.out or csv)
    files = output_files(
        outputs,
        inputs=[arguments.study],
        manifests=[manifest_path(csv)] if csv else [],
        journals=[journal],
    )
    with files, resumable():
        with ProgressLines() as lines:
            progress = partial(lines, "impacts of the table")
            table = tabulate(**study._asdict(), journal=journal, progress=progress)
        if arguments.out:
            write_table(arguments.out, table)
        if csv:
            write_csv(csv, table)
        print(table.in_words())
    say(f"written to {', '.join(map(str, outputs.values()))}")

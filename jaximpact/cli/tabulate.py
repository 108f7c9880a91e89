"""`jaximpact tabulate`: the model's impacts in tables."""

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..interruption import resumable
from ..io.output_files import journal_path, manifest_path, output_files
from . import options
from .progress import ProgressLines, say

if TYPE_CHECKING:
    from ..lookup.table_study import TableStudy

OUTPUTS = {
    "out": (".nc", "the table"),
    "csv": (".csv", "its nodes as text"),
    "map": (".csv", "restitution over all orientations"),
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

    [map]
    speeds_mps = [5, 10, 20, 40]
    angles_deg = [0, 20, 40, 60, 80]
    angular_velocities_degps = [0, 1000]
    slope_deg = 0
    orientations = 180              # over half a turn, all equally likely

--out: the table for `jaximpact runout`, under [[contacts]] with law = "table" and
files = ["table.nc"]. It belongs to this block on this ground and is refused for others,
other shapes and other laws.
A run-out meets the slopes of its segments, with roughness 3 standard deviations to both
sides; the table must cover them.
--csv: the same for other programs, a row for each node, units in the names of columns.
--map: mean, standard deviation, 5 and 95 % of the restitution coefficients over all
orientations, a row for each speed, angle and spin, and a drawing of it beside. It is
computed by the model itself and not looked up.

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
    """Make the tables."""
    from ..lookup.table_study import read_table_study

    given = ((f"--{name}", getattr(arguments, name)) for name in OUTPUTS)
    outputs = {option: path for option, path in given if path is not None}
    if not outputs:
        raise InputError("one of --out, --csv and --map is needed")
    study = read_table_study(arguments.study, arguments.accuracy)
    for option, path in outputs.items():
        suffix, _ = OUTPUTS[option[2:]]
        if path.suffix != suffix:
            raise InputError(f"{option} must end in {suffix}, but is {path}")
    table, csv, of_map = arguments.out or arguments.csv, arguments.csv, arguments.map
    beside = {}
    if csv:
        beside[manifest_path(csv)] = manifest_path(csv)
    if of_map:
        for path in (manifest_path(of_map), of_map.with_suffix(".png")):
            beside[path] = manifest_path(of_map)
    files = output_files(
        outputs,
        inputs=[arguments.study],
        beside=beside,
        journals=[journal_path(path) for path in (table, of_map) if path],
    )
    with files, resumable():
        if table:
            _make_table(study, arguments.out, csv, journal_path(table))
        if of_map:
            _make_map(study, of_map)
    say(f"written to {', '.join(map(str, outputs.values()))}")


def _make_table(
    study: "TableStudy", out: Path | None, csv: Path | None, journal: Path
) -> None:
    from ..lookup import tabulate, write_csv, write_table

    with ProgressLines() as lines:
        table = tabulate(
            study.block,
            study.soil,
            slopes=study.slopes,
            speeds=study.speeds,
            nodes=study.nodes,
            accuracy=study.accuracy,
            journal=journal,
            progress=partial(lines, "impacts of the table"),
        )
    if out:
        write_table(out, table)
    if csv:
        write_csv(csv, table)
    print(table.in_words())


def _make_map(study: "TableStudy", path: Path) -> None:
    from ..lookup import orientation_map, write_map
    from ..lookup.orientation_map import map_in_words

    with ProgressLines() as lines:
        dataset = orientation_map(
            study.block,
            study.soil,
            study.map_axes,
            accuracy=study.accuracy,
            journal=journal_path(path),
            progress=partial(lines, "impacts of the map"),
        )
    write_map(path, dataset)
    print(map_in_words(dataset))

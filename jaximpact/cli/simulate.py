"""`jaximpact simulate`: one impact from a file."""

import argparse
import contextlib
import json
from pathlib import Path

from ..accuracy import DEFAULT_ACCURACY
from ..errors import InputError
from ..formats.files import replacing
from ..formats.outputs import output_files
from . import options

PLOT_SUFFIXES = (".png", ".pdf", ".svg")
DESCRIPTION = """\
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
    """Add the command to the command line."""
    parser = commands.add_parser(
        "simulate",
        help="one impact from a TOML file",
        description=DESCRIPTION,
        epilog=lambda: options.input_help("Keys of the scene:"),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
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
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Compute the impact."""
    from ..formats.scene_file import read_scene
    from ..simulation import simulate
    from . import report

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
        print(json.dumps(report.as_json(result), indent=2, allow_nan=False))
    else:
        print(report.as_text(result))

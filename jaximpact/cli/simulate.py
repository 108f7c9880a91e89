"""`jaximpact simulate`: one impact from a file."""

import argparse
import contextlib
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

from ..accuracy import DEFAULT_ACCURACY
from ..errors import InputError
from ..io.files import replacing
from ..io.output_files import output_files
from . import options

if TYPE_CHECKING:
    from ..result import ImpactResult

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
    parser = options.add_command(
        commands,
        "simulate",
        run,
        help="one impact from a TOML file",
        description=DESCRIPTION,
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


def run(arguments: argparse.Namespace) -> None:
    """Compute the impact."""
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
    from ..io.display import align

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

    def number(owner, field: str) -> float | None:
        value = float(getattr(owner, field))
        return value if math.isfinite(value) else None

    columns = quantities.RESULT_COLUMNS | quantities.FURTHER_COLUMNS
    ledger = [column.field for column in quantities.ENERGY_COLUMNS.values()]
    return {
        quantities.OUTCOME_COLUMN: str(result.outcome),
        **{name: number(result, column.field) for name, column in columns.items()},
        "energy_J": {field: number(result.energy, field) for field in ledger},
        "manifest": result.manifest(),
    }

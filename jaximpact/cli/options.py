"""Options and help that several commands share."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from ..accuracy import PRESETS
from ..io.output_files import LIST

if TYPE_CHECKING:
    from ..quantities import InputColumn


def add_command(
    commands, name: str, run: Callable[[argparse.Namespace], None], **texts
) -> argparse.ArgumentParser:
    """Add a command to the command line.

    Args:
        commands: the subparsers of the command line.
        name: what users type.
        run: called with the arguments.
        texts: `help` in one line, `description`, and `epilog` if there is one; a text
            that is read off the laws is a function, since these load JAX.
    """
    parser = commands.add_parser(
        name,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
        **texts,
    )
    parser.set_defaults(run=run)
    return parser


def add_accuracy(parser: argparse.ArgumentParser, *, otherwise: str) -> None:
    """Add `--accuracy`; None where it is not given, which help calls `otherwise`."""
    parser.add_argument(
        "--accuracy",
        choices=tuple(PRESETS),
        help=(
            "error control of the integration; relative tolerance per step: "
            + ", ".join(f"{name} {p.tolerance:g}" for name, p in PRESETS.items())
            + f" (default: {otherwise})"
        ),
    )


def add_directory(
    parser: argparse.ArgumentParser, holds: str, *, required: bool = True
) -> None:
    """Add `--out`, a directory; help says what it `holds`."""
    parser.add_argument(
        "--out",
        type=Path,
        required=required,
        metavar="DIR",
        help=f"directory for {holds}; made if need be. Its {LIST} lists what was "
        "written: a later run replaces or removes these files and touches no others",
    )


def add_only(parser: argparse.ArgumentParser, metavar: str, what: str) -> None:
    """Add `--only`, a choice among several; help says `what` they are."""
    parser.add_argument(
        "--only", nargs="+", default=(), metavar=metavar, help=f"{what} (default: all)"
    )


def input_help(title: str) -> str:
    """List the quantities of a scene with unit, default, range and meaning, the laws
    and shapes by name, and the quantities that only these have."""
    from ..io.display import align
    from ..quantities import INPUT_COLUMNS, SLOTS, columns_of_class, shipped_parts

    rows = [("name", "unit", "default", "range", "meaning")]
    rows += [_row(column) for column in INPUT_COLUMNS.values()]
    names = [
        (slot, ", ".join(kind.__name__ for kind in shipped_parts(slot)))
        for slot in SLOTS
    ]
    others = [("of", *rows[0])]
    for slot in SLOTS:
        for kind in shipped_parts(slot):
            others += [
                (kind.__name__, *_row(column))
                for column in columns_of_class(slot, kind).values()
                if INPUT_COLUMNS.get(column.name) != column
            ]
    return (
        f"{title}\n{align(rows)}\n\n"
        "Laws and shapes by name, the usual one first; one of your own is named as\n"
        '"file.py:Class", the path from the file that names it, or\n'
        '"package.module:Class". Its parameters are quantities like the others.\n'
        f"{align(names)}\n\n"
        f"Quantities of those that are not the usual ones:\n{align(others)}"
    )


def _row(column: "InputColumn") -> tuple[str, ...]:
    default = f"{column.default:g}"
    return column.name, column.unit, default, column.range_text, column.meaning


def label_help() -> str:
    """List the columns of free text."""
    from ..quantities import LABEL_COLUMNS

    return f"Columns of free text, carried along unchanged: {', '.join(LABEL_COLUMNS)}."


def result_help() -> str:
    """List the results with unit and meaning."""
    from ..io.display import align
    from ..quantities import OUTCOME_COLUMN, OUTCOME_MEANING, RESULT_COLUMNS

    rows = [("name", "unit", "meaning")]
    rows += [(c.name, c.unit, c.meaning) for c in RESULT_COLUMNS.values()]
    rows += [(OUTCOME_COLUMN, "-", OUTCOME_MEANING)]
    return f"Columns that are appended:\n{align(rows)}"

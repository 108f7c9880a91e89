"""Options and help that several commands share."""

import argparse
from pathlib import Path

from ..accuracy import PRESETS
from ..formats.align import align
from ..formats.columns import (
    INPUT_COLUMNS,
    LABEL_COLUMNS,
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    RESULT_COLUMNS,
)
from ..formats.directory import LIST


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


def input_help(title: str) -> str:
    """The quantities of a scene: name, unit, default, range and meaning."""
    rows = [("name", "unit", "default", "range", "meaning")]
    rows += [
        (c.name, c.unit, f"{c.default:g}", c.range_text, c.meaning)
        for c in INPUT_COLUMNS.values()
    ]
    return f"{title}\n{align(rows)}"


def label_help() -> str:
    """The columns of free text."""
    return f"Columns of free text, carried along unchanged: {', '.join(LABEL_COLUMNS)}."


def result_help() -> str:
    """The results: name, unit and meaning."""
    rows = [("name", "unit", "meaning")]
    rows += [(c.name, c.unit, c.meaning) for c in RESULT_COLUMNS.values()]
    rows += [(OUTCOME_COLUMN, "-", OUTCOME_MEANING)]
    return f"Columns that are appended:\n{align(rows)}"

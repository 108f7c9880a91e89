"""Options and help that several commands share, and what computes them."""

import argparse
import contextlib
import logging
import os
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING

from ..accuracy import PRESETS
from ..errors import IncompleteError, InputError
from ..interruption import remove, unfinished

if TYPE_CHECKING:
    from ..quantities import InputColumn


def add_command(
    commands, name: str, run: Callable[[argparse.Namespace], None], **texts
) -> argparse.ArgumentParser:
    """Add a command, which calls `run` with the arguments.

    Args:
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


def check_ending(option: str, path: Path, *endings: str) -> None:
    """Raise InputError unless the name of a file to be written has one of the
    endings."""
    if path.suffix.lower() not in endings:
        raise InputError(f"{option} must end in {' or '.join(endings)}, but is {path}")


def add_directory(
    parser: argparse.ArgumentParser,
    holds: str,
    *,
    required: bool = True,
    which: str = "a new one, or that of an earlier run of the same study",
) -> None:
    """Add `--out`, a directory; help says what it `holds`, and which it may be."""
    parser.add_argument(
        "--out",
        type=Path,
        required=required,
        metavar="DIR",
        help=f"directory for {holds}: {which}",
    )


def add_only(parser: argparse.ArgumentParser, metavar: str, what: str) -> None:
    """Add `--only`, a choice among several; help says `what` they are."""
    parser.add_argument(
        "--only", nargs="+", default=(), metavar=metavar, help=f"{what} (default: all)"
    )


def input_help(title: str) -> str:
    """List the quantities of a scene with unit, default, range and meaning, the laws
    and shapes by name, and the quantities that only these have."""
    from .._tables import align
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


SETTINGS = {
    # A worker that died may take long to start again: a busy machine takes more than
    # the 15 s of Dask, and then nobody would compute.
    "distributed.deploy.lost-worker-timeout": "10 minutes",
    # Workers that may die over a part before Dask gives it up.
    "distributed.scheduler.allowed-failures": 10,
    "distributed.comm.timeouts.connect": "20s",
    "distributed.admin.large-graph-warning-threshold": "1GB",
    # A worker of one thread that asks itself 100 times a second what it is doing, and
    # 50 times whether it answers, loses 2 to 5 % of its time to that.
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.worker.memory.monitor-interval": "500ms",
}
"""Settings of Dask, of which workers of this machine inherit all."""


def add_engine(parser: argparse.ArgumentParser, only: str = "") -> None:
    """Add `--workers` and `--scheduler`, with words for what alone they are for."""
    engine = parser.add_mutually_exclusive_group()
    engine.add_argument(
        "--workers",
        type=_count,
        metavar="N",
        help=f"{only}compute in N processes of this machine, one thread each, by Dask "
        "(needs jaximpact[cluster]; default: in this process, on all cores)",
    )
    engine.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help=f"{only}compute on the workers of a scheduler of Dask, such as "
        "tcp://node1:8786; they must have the same versions of jaximpact and its "
        "packages",
    )


def _count(text: str) -> int:
    try:
        count = int(text)
    except ValueError:
        count = 0
    if count < 1:
        raise argparse.ArgumentTypeError(
            f"must be a whole number from 1, but is {text}"
        )
    return count


@contextlib.contextmanager
def engine_of(arguments: argparse.Namespace) -> Iterator[Executor | None]:
    """Give the executor that the options ask for; None where they ask for none.

    Inside the block its client is the one that lazy arrays are computed by.

    Raises InputError for a scheduler that does not answer, for more workers than fit
    into memory, and where Dask is not installed; IncompleteError for a worker that died
    as it was started.
    """
    if arguments.workers is None and arguments.scheduler is None:
        yield None
        return
    from .._packages import needed
    from ..io.checks import check_memory

    option = "--workers" if arguments.scheduler is None else "--scheduler"
    dask, distributed = needed("dask", option), needed("distributed", option)
    with dask.config.set(SETTINGS), contextlib.ExitStack() as stack:
        address, count = arguments.scheduler, arguments.workers
        if count is not None:
            # A worker that has loaded JAX takes 200 MB.
            check_memory(25e6 * count, f"{count} workers")
            setting = "temporary-directory"
            place = dask.config.get(setting, None)
            scratch = Path(tempfile.mkdtemp(prefix="jaximpact-", dir=place))
            stack.enter_context(unfinished(scratch, awaited=False))
            stack.callback(remove, scratch)
            stack.enter_context(dask.config.set({setting: str(scratch)}))
            # Python's process that removes semaphores tells of it after Ctrl-C.
            filters = os.environ.get("PYTHONWARNINGS"), "ignore:resource_tracker"
            os.environ["PYTHONWARNINGS"] = ",".join(filter(None, filters))
            try:
                address = stack.enter_context(
                    distributed.LocalCluster(
                        n_workers=count,
                        threads_per_worker=1,
                        dashboard_address=":0",
                        silence_logs=logging.CRITICAL,
                    )
                )
            except RuntimeError as error:
                raise IncompleteError(
                    f"a worker died as it was started: {error} The same command "
                    "starts others"
                ) from None
        try:
            client = stack.enter_context(distributed.Client(address))
        except (OSError, ValueError) as error:
            raise InputError(
                f"--scheduler {address} cannot be reached: {error}"
            ) from None
        yield client.get_executor(pure=False)

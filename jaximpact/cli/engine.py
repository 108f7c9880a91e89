"""Options that say which machines compute: workers here, or a scheduler of Dask."""

import argparse
import contextlib
import logging
from collections.abc import Iterator
from concurrent.futures import Executor

from ..errors import InputError

LOST = 10
"""Workers that may die over a part before Dask gives it up."""
STARTING = "10 minutes"
"""How long a worker that died may take to start again before it is given up; a busy
machine takes longer than the 15 s of Dask, and then nobody computes."""
PATIENCE = "20s"
"""How long a scheduler that does not answer is waited for."""


def add_engine(parser: argparse.ArgumentParser) -> None:
    """Add `--workers` and `--scheduler`."""
    engine = parser.add_mutually_exclusive_group()
    engine.add_argument(
        "--workers",
        type=_count,
        metavar="N",
        help="compute in N processes of this machine, one thread each, by Dask (needs "
        "jaximpact[cluster]; default: in this process, on all cores)",
    )
    engine.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="compute on the workers of a scheduler of Dask, such as tcp://node1:8786; "
        "they must have the same versions of jaximpact and its packages",
    )


def _count(text: str) -> int:
    count = int(text)
    if count < 1:
        raise argparse.ArgumentTypeError(f"must be at least 1, but is {text}")
    return count


@contextlib.contextmanager
def engine_of(arguments: argparse.Namespace) -> Iterator[Executor | None]:
    """Give the executor that the options ask for; None where they ask for none.

    Inside the block its client is the one that lazy arrays are computed by.

    Raises InputError for a scheduler that does not answer, and where Dask is not
    installed.
    """
    if arguments.workers is None and arguments.scheduler is None:
        yield None
        return
    from .._packages import needed

    option = "--workers" if arguments.scheduler is None else "--scheduler"
    dask, distributed = needed("dask", option), needed("distributed", option)
    settings = {
        "distributed.deploy.lost-worker-timeout": STARTING,
        "distributed.scheduler.allowed-failures": LOST,
        "distributed.comm.timeouts.connect": PATIENCE,
        "distributed.admin.large-graph-warning-threshold": "1GB",
    }
    with dask.config.set(settings), contextlib.ExitStack() as stack:
        address = arguments.scheduler
        if address is None:
            address = stack.enter_context(
                distributed.LocalCluster(
                    n_workers=arguments.workers,
                    threads_per_worker=1,
                    dashboard_address=":0",
                    silence_logs=logging.CRITICAL,
                )
            )
        try:
            client = stack.enter_context(distributed.Client(address))
        except (OSError, ValueError) as error:
            raise InputError(
                f"--scheduler {address} cannot be reached: {error}"
            ) from None
        yield client.get_executor(pure=False)

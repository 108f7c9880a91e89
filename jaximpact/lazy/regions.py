"""Regions of a store on the workers of a client of Dask, or on this machine."""

import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

from .._packages import needed
from ..errors import IncompleteError, NoWorkersWarning
from ..tasks import is_loss

WORKERLESS = 10.0
"""Seconds without a region that is finished after which workers are looked for."""
POLL = 0.05
"""Seconds between looks for finished regions, as often as Dask's own."""


def compute_regions(engine: Any, regions: list, tell: Callable[[int], None]) -> None:
    """Compute regions.

    Args:
        engine: the scheduler of Dask that is set, or that of a client.
        regions: delayed; each writes itself.
        tell: called with the number of those that are done.

    Raises what a region raises, and IncompleteError where workers were lost for good.
    """
    client = getattr(engine, "__self__", None)
    if client is not None and hasattr(client, "scheduler_info"):
        _on_client(client, regions, tell)
    else:
        _on_this_machine(regions, tell)


def _on_client(client: Any, regions: list, tell: Callable[[int], None]) -> None:
    """Have a client compute regions. What a killed worker had is computed by another;
    where Dask gives a region up since too many workers died over it, the others go
    on."""
    futures, lost = client.compute(regions), []
    try:
        done = 0
        for future in _finished(client, futures):
            error = future.exception()
            if error is None:
                done += 1
                tell(done)
            elif is_loss(error):
                lost.append(error)
            else:
                raise error
    finally:
        client.cancel(futures)
    if lost:
        raise IncompleteError(
            f"{len(lost)} regions lost their workers ({lost[0]}); the same call goes "
            "on from there"
        )


def _finished(client: Any, futures: list) -> Iterator[Any]:
    """Futures as they finish; warns where none does since there are no workers."""
    waiting = needed("distributed", "a client").as_completed(futures)
    last, warned = time.monotonic(), False
    while not waiting.is_empty():
        if finished := waiting.next_batch(block=False):
            yield from finished
            last, warned = time.monotonic(), False
            continue
        if not warned and time.monotonic() - last > WORKERLESS:
            last, warned = time.monotonic(), not client.nthreads()
            if warned:
                warnings.warn(
                    "the client has no workers left: regions wait until it has some; "
                    "of a cluster of Dask, cluster.scale(n) starts n",
                    NoWorkersWarning,
                    stacklevel=2,
                )
        time.sleep(POLL)


def _on_this_machine(regions: list, tell: Callable[[int], None]) -> None:
    """Compute regions by the scheduler of Dask that is set, threads by default."""
    dask, callbacks = needed("dask", "a store"), needed("dask.callbacks", "a store")
    keys, done = {region.key for region in regions}, []

    def count(key, *_) -> None:
        if key in keys:
            done.append(key)
            tell(len(done))

    with callbacks.Callback(posttask=count):
        dask.compute(*regions)

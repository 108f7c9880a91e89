"""Regions of a store on the workers of a client of Dask, or on this machine."""

import time
import uuid
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from .._packages import needed
from ..errors import IncompleteError
from ..tasks import WorkerlessWarner, error_of, is_loss

POLL = 0.05
"""Seconds between looks for finished regions, as often as Dask's own."""


def compute_regions(
    written: Any, missing: np.ndarray, tell: Callable[[int], None]
) -> None:
    """Compute regions by the scheduler of Dask that is set, or that of a client.

    Args:
        written: array of Dask whose blocks each write a region.
        missing: indices of the blocks that are to be computed.
        tell: called with the number of those that are done.

    Raises what a region raises, and IncompleteError where workers were lost for good.
    """
    engine = needed("dask.base", "a store").get_scheduler(collections=[written])
    client = getattr(engine, "__self__", None)
    regions = _one_task_each(written, missing)
    if client is not None and hasattr(client, "scheduler_info"):
        _on_client(client, regions, tell)
    else:
        _on_this_machine(regions, tell)


class _Region:
    """Function that runs all tasks of a region: one task for Dask, whose scheduler can
    hand out some thousands a second to all workers together."""

    def __init__(self, tasks: dict, key: Hashable, given: list[Hashable]):
        self.tasks, self.key, self.given = tasks, key, given

    def __call__(self, *values: Any) -> np.ndarray:
        given = dict(zip(self.given, values, strict=True))
        needed("dask", "a store").get(self.tasks | given, self.key)
        return np.ones(1, bool)


def _one_task_each(written: Any, missing: np.ndarray) -> Any:
    """Return the array of Dask of the missing regions alone, each of them one task.

    What several regions need stays a task of its own, computed once, and so do futures
    of a client; but parts of arrays of NumPy go with each region that needs them.
    """
    array, core = needed("dask.array", "a store"), needed("dask.core", "a store")
    graph, needs = written.dask.to_dict(), written.dask.get_all_dependencies()
    keys = [*core.flatten(written.__dask_keys__())]
    keys = [keys[number] for number in missing]
    futures = {key for key, of in graph.items() if type(of).__name__ == "Future"}
    owners = _owners(keys, needs, futures)
    name = f"region-{uuid.uuid4().hex}"
    tasks = {key: graph[key] for key, owner in owners.items() if owner is None}
    for number, key in enumerate(keys):
        own, given, todo = {}, [], [key]
        while todo:
            one = todo.pop()
            if owners[one] == key or _is_plain(graph[one]):
                own[one] = graph[one]
                todo += needs[one] - {*own, *given}
            elif one not in given:
                given.append(one)
        tasks[name, number] = (_Region(own, key, given), *given)
    layers = needed("dask.highlevelgraph", "a store").HighLevelGraph.from_collections(
        name, tasks, dependencies=()
    )
    return array.Array(layers, name, ((1,) * len(keys),), dtype=bool)


def _owners(
    keys: Iterable[Hashable],
    needs: Mapping[Hashable, Iterable[Hashable]],
    shared: Iterable[Hashable],
) -> dict[Hashable, Hashable]:
    """Find, for each task that some of the keys need, the key that alone needs it; else
    None.

    Args:
        needs: tasks that each task needs at once.
        shared: tasks that are nobody's own.
    """
    owners: dict[Hashable, Any] = dict.fromkeys(shared)
    for key in keys:
        todo = [key]
        while todo:
            one = todo.pop()
            if one not in owners:
                owners[one] = key
            elif owners[one] in (None, key):
                continue  # All that it needs was seen with it.
            else:
                owners[one] = None
            todo += needs[one]
    return owners


def _is_plain(of: Any) -> bool:
    """Tell whether a task of Dask is an array that is there."""
    return isinstance(getattr(of, "value", of), np.ndarray)


def _on_client(client: Any, regions: Any, tell: Callable[[int], None]) -> None:
    """Have a client compute regions. What a killed worker had is computed by another;
    where Dask gives a region up since too many workers died over it, the others go
    on."""
    distributed = needed("distributed", "a client")
    futures, lost = distributed.futures_of(client.persist(regions)), []
    try:
        done = 0
        for future in _finished(client, futures):
            error = error_of(future)
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
    """Yield futures as they finish; warns where none does since there are no
    workers."""
    waiting = needed("distributed", "a client").as_completed(futures)
    warn = WorkerlessWarner(client)
    while not waiting.is_empty():
        finished = waiting.next_batch(block=False)
        warn(finished=bool(finished))
        yield from finished
        if not finished:
            time.sleep(POLL)


def _on_this_machine(regions: Any, tell: Callable[[int], None]) -> None:
    """Compute regions by the scheduler of Dask that is set, threads by default."""
    callbacks, done = needed("dask.callbacks", "a store"), []
    keys = {*regions.__dask_keys__()}

    def count(key, *_) -> None:
        if key in keys:
            done.append(key)
            tell(len(done))

    with callbacks.Callback(posttask=count):
        regions.compute()

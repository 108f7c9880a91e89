"""The variants of a study on threads of their own.

Machine code runs outside Python's lock, so that one variant's arithmetic in Python is
done while the impacts of another are computed. Numbers are the same as one by one.
"""

import concurrent.futures
import threading
from collections.abc import Callable, Sequence
from typing import TypeVar

from .engine import Engine
from .least_squares import Progress

Item = TypeVar("Item")
Result = TypeVar("Result")


class _Stopped(Exception):
    """Another one has failed, or the run was interrupted."""


def side_by_side(
    function: Callable[[Item, Progress], Result],
    items: Sequence[Item],
    progress: Progress,
) -> list[Result]:
    """The function of every item, in their order.

    Args:
        function: of an item, and of what it tells its progress; where one has failed
            the others end the next time that they tell it.
        items: each is taken by a thread.
        progress: called by one thread at a time.
    """
    stop, speaking = threading.Event(), threading.Lock()

    def tell(text: str) -> None:
        with speaking:
            if stop.is_set():
                raise _Stopped
            progress(text)

    with concurrent.futures.ThreadPoolExecutor(len(items)) as pool:
        running = [pool.submit(function, item, tell) for item in items]
        try:
            for ended in concurrent.futures.as_completed(running):
                ended.result()
        except BaseException:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [ended.result() for ended in running]


def each_variant(
    engines: Sequence[Engine],
    function: Callable[[Item, Progress], Result],
    variants: Sequence[Item],
    progress: Progress,
) -> list[Result]:
    """The function of every variant: side by side in machine code, else one by one, for
    XLA would compile for each."""
    in_xla = any(engine.kernel is None for engine in engines)
    if in_xla or len(variants) == 1:
        return [function(variant, progress) for variant in variants]
    return side_by_side(function, variants, progress)

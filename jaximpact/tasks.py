"""Work for other processes and machines, through engines that are there already.

A `Task` is a function with its arguments, pickled. Where it is called it first sets its
process up (float64, the cache of compiled code), and only then unpickles: JAX in
float32 would cut arrays short without a word. It computes on one thread, since engines
run as many tasks at once as a worker has threads.

`run_tasks` gives tasks to whatever has the interface of `concurrent.futures.Executor`:
process pools of Python and joblib, MPI (mpi4py.futures), a client of Dask.
"""

import concurrent.futures
import functools
import hashlib
import io
import os
import pickle
from collections.abc import Callable, Iterable
from typing import Any

import jax

from ._jax_internals import setting
from .backend.threads import one_thread
from .backend.xla_compilation import keep_programs
from .errors import IncompleteError, InputError
from .finding import class_of_file, file_of
from .store import VARIABLE as CACHE_VARIABLE

WAITING = 256
"""Tasks that an engine holds at once: enough for a hundred workers, few enough for the
memory of the process that gives them out."""


class Task:
    """A function of a module with its first arguments, to be called in any process.

    Args:
        function: of a module that workers can import.
        arguments: what can be pickled. Laws and shapes of a file of the user's are
            found by its path, which workers must see.

    Raises InputError for what cannot be pickled.
    """

    def __init__(self, function: Callable, *arguments):
        stream = io.BytesIO()
        try:
            _Pickler(stream, pickle.HIGHEST_PROTOCOL).dump((function, arguments))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise InputError(
                f"cannot be sent to another process: {error}; a class must stand in a "
                "module or a file, not inside a function"
            ) from error
        self.payload = stream.getvalue()
        self.__name__ = function.__name__  # by which engines show it
        self.cache = os.environ.get(CACHE_VARIABLE)

    def __call__(self, *further) -> Any:
        """Call the function, with further arguments, on one thread."""
        set_up_process(self.cache)
        function, arguments = _unpickled(self.payload)
        with one_thread():
            return function(*arguments, *further)

    def __dask_tokenize__(self):
        return type(self).__name__, hashlib.sha256(self.payload).hexdigest()


def set_up_process(cache: str | None) -> None:
    """Set JAX to float64, and what is compiled to be kept, in the process of a worker.

    A process that computes in float64 already is left as it is.

    Args:
        cache: directory of compiled code that the sender was told, unless this process
            was told another; None where nobody said.
    """
    if setting("jax_enable_x64"):
        return
    if cache is not None:
        os.environ.setdefault(CACHE_VARIABLE, cache)
    jax.config.update("jax_enable_x64", True)
    keep_programs()


@functools.lru_cache(maxsize=8)
def _unpickled(payload: bytes) -> Any:
    return pickle.loads(payload)


class _Pickler(pickle.Pickler):
    """Pickles classes that were read from a user's file as that file and their name."""

    def reducer_override(self, value):
        file = file_of(value) if isinstance(value, type) else None
        if file is None:
            return NotImplemented
        return class_of_file, (str(file), value.__qualname__)


def check_executor(executor: Any) -> None:
    """Raise InputError for what has not the interface of
    `concurrent.futures.Executor`, and for a pool of processes that are forks."""
    if not callable(getattr(executor, "submit", None)):
        raise InputError(
            "executor must have the interface of concurrent.futures.Executor, but is "
            f"{executor!r}; of a client of Dask give client.get_executor()"
        )
    context = getattr(executor, "_mp_context", None)
    method = context and getattr(context, "get_start_method", lambda: None)()
    if method == "fork":
        raise InputError(
            "executor makes processes by fork, in which JAX hangs; give "
            "mp_context=multiprocessing.get_context('forkserver') or 'spawn'"
        )


def run_tasks(
    executor: concurrent.futures.Executor,
    tasks: Iterable[Callable[[], Any]],
    take: Callable[[int, Any], None],
) -> None:
    """Run tasks on an executor, and take each result as it comes.

    Args:
        executor: see `check_executor`.
        tasks: made one by one as the executor has room, at most `WAITING` at a time.
        take: called as `take(place, result)`, in this thread; place counts the tasks.

    Raises what a task raises, and IncompleteError where workers were lost for good; all
    other results were taken by then.
    """
    running: dict[concurrent.futures.Future, int] = {}
    lost: list[BaseException] = []
    numbered = enumerate(tasks)
    try:
        more = True
        while more or running:
            while more and len(running) < WAITING:
                place, task = next(numbered, (None, None))
                if place is None or task is None:
                    more = False
                else:
                    running[executor.submit(task)] = place
            done, _ = concurrent.futures.wait(
                running, return_when=concurrent.futures.FIRST_COMPLETED
            )
            for future in done:
                place = running.pop(future)
                error = future.exception()
                if error is None:
                    take(place, future.result())
                elif is_loss(error):
                    lost.append(error)
                    # A broken pool takes no more tasks.
                    more = more and not isinstance(
                        error, concurrent.futures.BrokenExecutor
                    )
                else:
                    raise error
    finally:
        for future in running:
            future.cancel()
    if lost:
        raise IncompleteError(
            f"{len(lost)} parts lost their workers ({lost[0]}); what was computed is "
            "kept where there is a journal, and the same call goes on from there"
        )


def run_task(executor: concurrent.futures.Executor, task: Callable[[], Any]) -> Any:
    """Run one task on an executor and return its result. Raises as `run_tasks`."""
    results: list = []
    run_tasks(executor, [task], lambda _, result: results.append(result))
    return results[0]


def is_loss(error: BaseException) -> bool:
    """Whether a worker died, and not what it was computing."""
    names = {kind.__name__ for kind in type(error).__mro__}
    return isinstance(error, concurrent.futures.BrokenExecutor) or bool(
        names & {"KilledWorker", "CommClosedError"}
    )

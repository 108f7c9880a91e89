"""Work for other processes and machines, through engines that are there already.

A `Task` is a function with its arguments, pickled. Where it is called it first sets its
process up (float64, the cache of compiled code), and only then unpickles: JAX in
float32 would cut arrays short without a word. It computes on one thread, since engines
run as many tasks at once as a worker has threads.

`run_tasks` gives tasks to whatever has the interface of `concurrent.futures.Executor`:
process pools of Python and joblib, a client of Dask.
"""

import concurrent.futures
import contextlib
import contextvars
import functools
import hashlib
import io
import operator
import os
import pickle
import platform
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from typing import Any, TypeVar

import jax

from ._jax_internals import setting
from ._packages import versions
from .backend.threads import one_thread
from .backend.xla_compilation import keep_programs
from .errors import IncompleteError, InputError, NoWorkersWarning
from .finding import class_of_file, describe_error, file_of, users_line
from .identity import code_digest, is_ours, name_of
from .parameters import Part
from .progress import Progress, ProgressFunction, as_progress, listening, telling
from .store import VARIABLE as CACHE_VARIABLE

WAITING = 256
"""Tasks that an engine holds at once: enough for a hundred workers, few enough for the
memory of the process that gives them out."""
WORKERLESS = 10.0
"""Seconds without anything that finishes after which workers are looked for."""
POLL = 0.5
"""Seconds between looks for workers, and for a reason to stop."""

Item = TypeVar("Item")
Result = TypeVar("Result")


class Task:
    """A function of a module with its first arguments, to be called in any process.

    Workers must be able to import the module, and to see files with laws and shapes of
    the user's. Raises InputError for arguments that cannot be pickled.
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
        self.cache, self.versions = os.environ.get(CACHE_VARIABLE), _versions()

    def __call__(self, *further) -> Any:
        """Call the function, with further arguments, on one thread.

        Raises InputError in a process that has other versions than the sender, and for
        a law that ends the program.
        """
        _check_versions(self.versions)
        set_up_process(self.cache)
        function, arguments = _unpickled(self.payload)
        try:
            with one_thread():
                return function(*arguments, *further)
        except SystemExit as error:
            # Workers would obey, one after another.
            file, row = users_line(error)
            raise InputError(describe_error(error), file=file, row=row) from error

    def __dask_tokenize__(self):
        return type(self).__name__, hashlib.sha256(self.payload).hexdigest()


_versions = functools.cache(versions)


def _check_versions(sent: dict[str, str]) -> None:
    other = [
        f"{name} {here} in place of {sent.get(name)}"
        for name, here in _versions().items()
        if here != sent.get(name)
    ]
    if other:
        raise InputError(
            f"a worker on {platform.node()} has {', '.join(other)}, but results depend "
            "on versions; install the same ones there"
        )


def set_up_process(cache: str | None) -> None:
    """Set JAX to float64, and what is compiled to be kept, in the process of a worker;
    one that computes in float64 already is left as it is.

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
    """Pickles classes that were read from a user's file as that file and their name,
    and laws and shapes of users with a digest of what they compute with."""

    def reducer_override(self, value):
        if not isinstance(value, type) or "<" in value.__qualname__:
            return NotImplemented
        file, name = file_of(value), value.__qualname__
        if issubclass(value, Part) and not is_ours(value):
            digest = code_digest(value)
            return _same_class, (file and str(file), value.__module__, name, digest)
        return NotImplemented if file is None else (class_of_file, (str(file), name))


def _same_class(file: str | None, module: str, name: str, digest: str) -> type:
    """Return the class of a law or a shape. Raises InputError where this process has
    none under its name, as of a cell of a notebook, or another one: a worker that began
    before an edit."""
    if file is None:
        # Not refused by the sender: threads and workers inside its process have it.
        try:
            kind = operator.attrgetter(name)(import_module(module))
        except AttributeError as error:
            raise InputError(
                f"a worker on {platform.node()} has no class {name} in {module}; put "
                "it into a module or a file, not into a cell of a notebook, and start "
                "the workers anew after an edit"
            ) from error
    else:
        kind = class_of_file(file, name)
    if code_digest(kind) != digest:
        raise InputError(
            f"a worker on {platform.node()} has another {name} than the process that "
            f"sends it, or other constants of it: {name_of(kind)}; start the workers "
            "anew after an edit"
        )
    return kind


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

    Where a client of Dask has no workers left its tasks wait for others, with a
    NoWorkersWarning after some seconds.

    Raises what a task raises, InputError for a worker without packages or with others,
    and IncompleteError where workers were lost for good; all other results were taken
    by then.
    """
    warn = WorkerlessWarner(getattr(executor, "_client", None))
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
                running, POLL, concurrent.futures.FIRST_COMPLETED
            )
            warn(finished=bool(done))
            for future in done:
                place, loss = running.pop(future), loss_of(future)
                if loss is None:
                    take(place, future.result())
                    continue
                lost.append(loss)
                # A broken pool takes no more tasks.
                more &= not isinstance(loss, concurrent.futures.BrokenExecutor)
    finally:
        for future in running:
            future.cancel()
    if lost:
        raise IncompleteError(
            f"{len(lost)} parts lost their workers ({lost[0]}); what was computed is "
            "kept where there is a journal, and the same call goes on from there"
        )


_executor: contextvars.ContextVar[concurrent.futures.Executor | None]
_executor = contextvars.ContextVar("_executor", default=None)


@contextlib.contextmanager
def computing(
    *,
    progress: Progress | ProgressFunction | None = None,
    executor: concurrent.futures.Executor | None = None,
) -> Iterator[None]:
    """Have the work inside tell its progress, and its parts run on an executor.

    Args:
        progress: see `as_progress`.
        executor: see `check_executor`; None for this process.
    """
    if executor is not None:
        check_executor(executor)
    token = _executor.set(executor)
    try:
        with telling(as_progress(progress)):
            yield
    finally:
        _executor.reset(token)


def call_each(
    function: Callable,
    arguments: Iterable[tuple],
    take: Callable[[int, Any], None],
) -> None:
    """Call a function with each of several arguments, here or on the executor that is
    set by `computing`, and take each result as it comes. As `run_tasks`."""
    executor = _executor.get()
    if executor is not None:
        return run_tasks(executor, (Task(function, *each) for each in arguments), take)
    for place, each in enumerate(arguments):
        take(place, function(*each))


class Stopped(Exception):
    """End of a task because another one has failed, or was interrupted."""


def run_in_threads(
    function: Callable[[Item], Result], items: Sequence[Item]
) -> list[Result]:
    """Call a function of every item in threads of their own; results in their order.

    Once one call has failed the others end the next time that they tell their progress.
    """
    stop, speaking, progress = threading.Event(), threading.Lock(), listening()

    class Shared(Progress):
        def __call__(self, what, done=None, total=None):
            with speaking:
                if stop.is_set():
                    raise Stopped
                progress(what, done, total)

    with (
        telling(Shared()),
        concurrent.futures.ThreadPoolExecutor(len(items)) as pool,
    ):
        running = [
            pool.submit(contextvars.copy_context().run, function, item)
            for item in items
        ]
        try:
            for ended in concurrent.futures.as_completed(running):
                ended.result()
        except BaseException:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [ended.result() for ended in running]


class WorkerlessWarner:
    """Function that warns where nothing finishes since a client of Dask has no workers
    left; None stands for engines that say themselves what they lack."""

    def __init__(self, client: Any):
        self._client, self._last, self._warned = client, time.monotonic(), False

    def __call__(self, *, finished: bool) -> None:
        """Look for workers if nothing has finished for long; warn once if there are
        none."""
        now = time.monotonic()
        if finished:
            self._last, self._warned = now, False
        elif self._client and not self._warned and now - self._last >= WORKERLESS:
            self._last, self._warned = now, not self._client.nthreads()
            if self._warned:
                warnings.warn(
                    "the client has no workers left: its work waits until it has some; "
                    "of a cluster of Dask, cluster.scale(n) starts n",
                    NoWorkersWarning,
                    stacklevel=3,
                )


def loss_of(future: Any) -> BaseException | None:
    """Return the error of a future that has finished if a worker died; None if it has a
    result. Raises its other errors, an InputError where a package is missing."""
    try:
        error = future.exception()
    except concurrent.futures.CancelledError as cancelled:
        error = cancelled  # by Dask, as the scheduler is gone
    # Of a scheduler that cannot unpickle a task Dask tells the reason as the cause.
    for one in (error, getattr(error, "__cause__", None)):
        if isinstance(one, ModuleNotFoundError):
            raise InputError(
                f"a worker or the scheduler has no module {one.name}; install the same "
                "packages there as here"
            ) from error
    names = {kind.__name__ for kind in type(error).__mro__}
    if error is None or names & {
        *("BrokenExecutor", "KilledWorker", "CommClosedError", "CancelledError")
    }:
        return error
    raise error

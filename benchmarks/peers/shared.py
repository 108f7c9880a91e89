"""What peers share: the compiled right-hand side, threads for those that let go of
Python's lock, worker processes for those that hold it, and silence for libraries in C
that report every impact they give up."""

import concurrent.futures
import contextlib
import copy
import functools
import itertools
import os
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures.process import BrokenProcessPool

import numpy as np

from ..impacts import Answer
from ..processes import process_pool
from . import model

PARTS = 8
"""Parts of a batch for each core: the slow impacts are spread over the cores."""


def answer(p: np.ndarray, start: np.ndarray, e_n: np.ndarray, seconds: float) -> Answer:
    """The answer, with the e_n of -1 that a block has which never sinks."""
    e_n = np.where(model.is_separating(p, start), -1.0, e_n)
    return Answer(np.where(np.isfinite(e_n), e_n, np.nan), seconds)


class Compiled:
    """A method on `model.rates`."""

    slider_time = 1e-6
    """tau_s [s]"""

    def with_slider_time(self, slider_time: float):
        """The same with another relaxation time of the slider [s]."""
        other = copy.copy(self)
        other.slider_time = slider_time
        return other


def solve_on_threads(
    integrate: Callable, p: np.ndarray, start: np.ndarray, batch: bool
) -> Answer:
    """Impacts by `integrate(first, last, e_n)`, which fills e_n from first to last and
    is compiled without Python's lock; on every core at once, or else on one."""
    cores = (os.cpu_count() or 1) if batch else 1
    e_n = np.empty(len(p))
    # Twenty parts a core: the slow impacts are spread over the cores.
    edges = np.linspace(0, len(p), min(len(p), 20 * cores) + 1).astype(int)
    begin = time.perf_counter()
    with quiet_stderr(), concurrent.futures.ThreadPoolExecutor(cores) as pool:
        list(
            pool.map(lambda k: integrate(*edges[k : k + 2], e_n), range(len(edges) - 1))
        )
    return answer(p, start, e_n, time.perf_counter() - begin)


@contextlib.contextmanager
def quiet_stderr() -> Iterator[None]:
    """What is written to stderr inside, by whatever means, is lost."""
    sys.stderr.flush()
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)


@functools.cache
def _pool() -> concurrent.futures.ProcessPoolExecutor:
    return process_pool(os.cpu_count())


def solve_scenes(
    one: Callable,
    p: np.ndarray,
    start: np.ndarray,
    tolerance: float,
    batch: bool,
    **options,
) -> Answer:
    """Impacts by `one(p, start, tolerance, **options)`, which gives e_n or NaN.

    Args:
        one: a function of a module, so that it can be sent to other processes.
        batch: on every core, else one after another in this process.
    """
    if not batch:
        begin = time.perf_counter()
        e_n = _solve_part(one, p, start, tolerance, options)
        return answer(p, start, e_n, time.perf_counter() - begin)
    cores = os.cpu_count() or 1

    def submit(a: int, b: int) -> concurrent.futures.Future:
        part = (_solve_part, one, p[a:b], start[a:b], tolerance, options)
        try:
            return _pool().submit(*part)
        except BrokenProcessPool:
            _pool.cache_clear()
            return _pool().submit(*part)

    # Processes that have not started yet, and what they compile, are not timed.
    concurrent.futures.wait([submit(0, 2) for _ in range(2 * cores)])
    edges = np.linspace(0, len(p), min(len(p), PARTS * cores) + 1).astype(int)
    begin = time.perf_counter()
    parts = [(submit(a, b), a, b) for a, b in itertools.pairwise(edges)]
    e_n = []
    for part, a, b in parts:
        try:
            e_n.append(part.result())
        except BrokenProcessPool:  # by this part, or another one
            e_n.append(_surviving(submit, a, b))
    return answer(p, start, np.concatenate(e_n), time.perf_counter() - begin)


def _surviving(
    submit: Callable[[int, int], concurrent.futures.Future], a: int, b: int
) -> np.ndarray:
    """Solve impacts at one of which a library may end its process: that one is not
    finished."""
    try:
        return submit(a, b).result()
    except BrokenProcessPool:
        if b - a == 1:
            return np.array([np.nan])
    middle = (a + b) // 2
    halves = _surviving(submit, a, middle), _surviving(submit, middle, b)
    return np.concatenate(halves)


def _solve_part(one, p, start, tolerance, options) -> np.ndarray:
    with quiet_stderr():
        e_n = [one(p[i], start[i], tolerance, **options) for i in range(len(p))]
    return np.array(e_n, float)

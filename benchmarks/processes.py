"""Worker processes for peers that hold Python's lock."""

import atexit
import concurrent.futures
import functools
import itertools
import multiprocessing
import os
import time
from collections.abc import Callable

import numpy as np

from .answer import Answer, answer
from .quiet import quiet_stderr

PARTS = 8
"""Parts of a batch for each core: the slow impacts are spread over the cores."""


@functools.cache
def _pool() -> concurrent.futures.ProcessPoolExecutor:
    # A fork of a process that has run JAX may hang.
    context = multiprocessing.get_context("spawn")
    pool = concurrent.futures.ProcessPoolExecutor(os.cpu_count(), context)
    atexit.register(pool.shutdown, cancel_futures=True)
    return pool


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
    pool = _pool()
    cores = os.cpu_count() or 1
    # Processes that have not started yet, and what they compile, are not timed.
    few = [
        pool.submit(_solve_part, one, p[:2], start[:2], tolerance, options)
        for _ in range(2 * cores)
    ]
    concurrent.futures.wait(few)
    edges = np.linspace(0, len(p), min(len(p), PARTS * cores) + 1).astype(int)
    begin = time.perf_counter()
    parts = [
        pool.submit(_solve_part, one, p[a:b], start[a:b], tolerance, options)
        for a, b in itertools.pairwise(edges)
    ]
    e_n = np.concatenate([part.result() for part in parts])
    return answer(p, start, e_n, time.perf_counter() - begin)


def _solve_part(one, p, start, tolerance, options) -> np.ndarray:
    with quiet_stderr():
        e_n = [one(p[i], start[i], tolerance, **options) for i in range(len(p))]
    return np.array(e_n, float)

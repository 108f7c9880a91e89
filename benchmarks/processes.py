"""Processes for methods that hold Python's lock, or need a process of their own."""

import atexit
import concurrent.futures
import multiprocessing


def process_pool(count: int) -> concurrent.futures.ProcessPoolExecutor:
    """Start so many processes, which end with this one."""
    # A fork of a process that has run JAX may hang.
    context = multiprocessing.get_context("spawn")
    pool = concurrent.futures.ProcessPoolExecutor(count, context)
    atexit.register(pool.shutdown, cancel_futures=True)
    return pool

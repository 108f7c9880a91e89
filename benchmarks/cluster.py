"""What a cluster costs: `python -m benchmarks.cluster 1e6 --workers 2`.

A sweep is computed in this process on some threads (`--workers 0 --threads 2`), or by
the workers of the command line, which have one thread each, into memory or into a store
of Zarr (`--into`). Printed is one line of JSON: seconds by the clock, processor time of
the workers and of this process, with the scheduler, and the largest memory of each.
Processor time is what can be compared on a machine that is not idle. `--kills 5` kills
workers at random moments while a store is written, then compares it with the sweep in
this process, bit by bit. `--seconds` stops a sweep that would take too long.
"""

import argparse
import json
import os
import random
import resource
import shutil
import signal
import threading
import time
from functools import partial
from pathlib import Path

os.environ["JAX_ENABLE_X64"] = "1"

import numpy as np
import xarray as xr

from jaximpact import Scene, sweep, write_zarr
from jaximpact.cli.options import engine_of

ORIENTATIONS = np.linspace(0.0, 100.0, 4)
RATIOS = np.linspace(1.0, 3.0, 5)


def axes_of(size: int) -> dict:
    """Axes of a sweep of some size: half of its impacts are oblique and elongated."""
    count = max(1, round(size / (len(RATIOS) * len(ORIENTATIONS))))
    return {
        "angle_deg": np.linspace(0.0, 80.0, count),
        "aspect_ratio": RATIOS,
        "orientation_deg": ORIENTATIONS,
    }


def usage() -> tuple[float, float, float]:
    """Processor time of this process [s], its memory at most, and now [MB]."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    now = pages * resource.getpagesize() / 1e6
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3, now


def kill_at_random(client, count: int, seconds: float, killed: list[float]) -> None:
    """Kill one of the workers at random moments."""
    draw = random.Random(len(killed))
    start = time.monotonic()
    while len(killed) < count:
        time.sleep(draw.uniform(0.2, 1.8) * seconds)
        workers = [*client.run(os.getpid, on_error="ignore").values()]
        if workers:  # else all are being started again
            os.kill(draw.choice(workers), signal.SIGKILL)
            killed.append(round(time.monotonic() - start, 1))


def measure(work, client=None) -> dict:
    """Measure some work, in this process and in the workers of a client."""
    before = usage()[0]
    of_workers = client.run(usage) if client else {}
    start, interrupted = time.perf_counter(), False
    try:
        work()
    except TimeoutError:
        interrupted = True
    seconds = time.perf_counter() - start
    told = {"clock_s": seconds, "stopped": interrupted}
    told["cpu_s"] = usage()[0] - before
    if client:
        after = client.run(usage)
        told["cpu_of_workers_s"] = sum(
            used[0] - of_workers.get(name, (0.0,))[0] for name, used in after.items()
        )
        told["peak_of_workers_MB"] = max(used[1] for used in after.values())
    told["peak_MB"] = usage()[1]
    return {k: round(v, 2) if isinstance(v, float) else v for k, v in told.items()}


def alarm(*_) -> None:
    """Stop the sweep."""
    raise TimeoutError


def on_threads(asked: argparse.Namespace, axes: dict, chunks: dict) -> dict:
    """Measure the sweep in this process."""
    os.environ["JAXIMPACT_THREADS"] = str(asked.threads)
    sweep(Scene(), axes_of(100), accuracy=asked.accuracy)  # compiles
    if not asked.into:
        return measure(lambda: sweep(Scene(), axes, accuracy=asked.accuracy))
    import dask

    lazy = sweep(Scene(), axes, accuracy=asked.accuracy, chunks=chunks)
    with dask.config.set(scheduler="synchronous"):
        return measure(lambda: write_zarr(asked.into, lazy))


def on_workers(asked: argparse.Namespace, axes: dict, chunks: dict) -> dict:
    """Measure the sweep on the workers of the command line."""
    with engine_of(asked) as executor:
        client = executor._client
        warm = sweep(Scene(), axes_of(4000), accuracy=asked.accuracy, chunks=5)
        warm.compute()
        # Until here compiled and loaded.
        lazy = sweep(Scene(), axes, accuracy=asked.accuracy, chunks=chunks)
        killed: list[float] = []
        if asked.kills:
            threading.Thread(
                target=kill_at_random,
                args=(client, asked.kills, asked.every, killed),
                daemon=True,
            ).start()
        work = partial(write_zarr, asked.into, lazy) if asked.into else lazy.compute
        told = measure(work, client)
    if asked.kills:
        there = xr.open_zarr(asked.into).load()
        here = sweep(Scene(), axes, accuracy=asked.accuracy)
        same = all(there[n].values.tobytes() == here[n].values.tobytes() for n in here)
        told |= {"killed_at_s": killed, "bits_equal": same}
        shutil.rmtree(asked.into)
    return told


def main() -> None:
    """Measure what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("size", type=float)
    parser.add_argument("--workers", type=int, default=0)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--accuracy", default="balanced")
    parser.add_argument("--block", type=int, default=100_000)
    parser.add_argument("--into", type=Path)
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--every", type=float, default=5.0)
    parser.add_argument("--seconds", type=int, default=0)
    asked = parser.parse_args(namespace=argparse.Namespace(scheduler=None))
    axes = axes_of(int(asked.size))
    each = len(RATIOS) * len(ORIENTATIONS)
    told = {"impacts": len(axes["angle_deg"]) * each, "workers": asked.workers}
    chunks = {"angle_deg": max(1, asked.block // each)}
    signal.signal(signal.SIGALRM, alarm)
    signal.alarm(asked.seconds)
    measured = on_workers if asked.workers else on_threads
    print(json.dumps(told | measured(asked, axes, chunks)), flush=True)


if __name__ == "__main__":
    main()

"""Number of threads that compute at once."""

import contextlib
import contextvars
import functools
import os
from collections.abc import Iterator
from pathlib import Path

from ..errors import InputError

VARIABLE = "JAXIMPACT_THREADS"
"""Environment variable: how many threads compute. Without it as many as there are cores
that this process may use."""
GROUPS = Path("/sys/fs/cgroup")
_is_alone = contextvars.ContextVar("_is_alone", default=False)


def thread_count() -> int:
    """Return the number of threads that may compute at once.

    Raises InputError unless `JAXIMPACT_THREADS`, where it is set, is a whole number
    above 0.
    """
    return 1 if _is_alone.get() else _count(os.environ.get(VARIABLE))


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """Compute what is inside, and called from this thread, on one thread: beside others
    that an engine runs on the other cores."""
    token = _is_alone.set(True)
    try:
        yield
    finally:
        _is_alone.reset(token)


@functools.cache
def _count(stated: str | None) -> int:
    if stated is None:
        return usable_cores()
    if not stated.isdecimal() or int(stated) == 0:
        raise InputError(
            f"{VARIABLE} must be a whole number above 0, but is {stated!r}"
        )
    return int(stated)


def usable_cores() -> int:
    """Return the cores that this process may use: those of its affinity, and no more
    than the share of time that its control group grants."""
    if hasattr(os, "sched_getaffinity"):
        cores = len(os.sched_getaffinity(0))
    else:
        cores = os.cpu_count() or 1
    granted = _granted(GROUPS, Path("/proc/self/cgroup"))
    return max(1, cores if granted > cores else int(granted))


def _granted(groups: Path, membership: Path) -> float:
    """Return the cores granted by the control groups of this process, and by those that
    they are in; infinite without a limit."""
    least = float("inf")
    try:
        lines = membership.read_text("utf-8").splitlines()
    except OSError:
        return least
    for line in lines:
        _, controllers, name = line.split(":", 2)
        if controllers and "cpu" not in controllers.split(","):
            continue
        root = groups / "cpu" if controllers else groups
        place = root / name.lstrip("/")
        # Inside a container the name may be that outside; the root is then its own.
        for group in (place, *place.parents):
            least = min(least, _limit(group))
            if group == root:
                break
    return least


def _limit(group: Path) -> float:
    """Return the cores granted by one group; infinite where it says nothing."""
    try:
        if (group / "cpu.max").exists():
            quota, period = (group / "cpu.max").read_text("utf-8").split()
        else:
            quota = (group / "cpu.cfs_quota_us").read_text("utf-8")
            period = (group / "cpu.cfs_period_us").read_text("utf-8")
        limit = float(quota) / float(period)
    except (OSError, ValueError):  # "max" is no number
        return float("inf")
    return -(-limit // 1) if limit > 0 else float("inf")

"""What the machine grants: how many threads may compute, and how much memory."""

import math
import os
import sys

import psutil
import pytest

from jaximpact.backend import threads
from jaximpact.errors import InputError
from jaximpact.io import checks


@pytest.mark.parametrize("stated", ["x", "", "0", "-1", "1.5"])
def test_a_count_that_is_none_is_refused(monkeypatch, stated):
    monkeypatch.setenv(threads.VARIABLE, stated)
    with pytest.raises(InputError, match=f"above 0, but is '{stated}'"):
        threads.thread_count()


def test_the_environment_says_how_many(monkeypatch):
    monkeypatch.setenv(threads.VARIABLE, "5")
    assert threads.thread_count() == 5


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="Linux alone has it")
def test_no_more_than_the_affinity():
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert threads.usable_cores() == 1
    finally:
        os.sched_setaffinity(0, allowed)


UNIFIED, OLDER = "0::/a/b\n", "3:memory:/m\n2:cpu,cpuacct:/a/b\n1:name=systemd:/s\n"


@pytest.mark.parametrize(
    ("own", "files", "granted"),
    [
        (UNIFIED, {"a/b/cpu.max": "150000 100000"}, 2),
        (UNIFIED, {"a/b/cpu.max": "max 100000"}, math.inf),
        # The group above grants less, or the one that is the container's root.
        (UNIFIED, {"a/cpu.max": "100000 100000", "a/b/cpu.max": "max 100000"}, 1),
        (UNIFIED, {"cpu.max": "300000 100000"}, 3),
        (UNIFIED, {}, math.inf),
        (UNIFIED, {"a/b/cpu.max": ""}, math.inf),
        (None, {"cpu.max": "100000 100000"}, math.inf),
        (
            OLDER,
            {
                "cpu/a/b/cpu.cfs_quota_us": "400000",
                "cpu/a/b/cpu.cfs_period_us": "100000",
            },
            4,
        ),
        (
            OLDER,
            {"cpu/a/b/cpu.cfs_quota_us": "-1", "cpu/a/b/cpu.cfs_period_us": "100000"},
            math.inf,
        ),
        # Of another controller
        (OLDER, {"memory/m/cpu.max": "100000 100000"}, math.inf),
    ],
)
def test_control_groups(tmp_path, own, files, granted):
    groups, listed = tmp_path / "groups", tmp_path / "listed"
    groups.mkdir()
    if own is not None:
        listed.write_text(own)
    for name, text in files.items():
        (groups / name).parent.mkdir(parents=True, exist_ok=True)
        (groups / name).write_text(text)
    assert threads._granted(groups, listed) == granted


# --- memory


def unknown(name):
    raise ValueError("unrecognized configuration name")


@pytest.mark.parametrize("sysconf", [None, unknown], ids=["no", "knows nothing"])
def test_psutil_tells_the_memory_where_the_system_does_not(monkeypatch, sysconf):
    if sysconf is None:
        monkeypatch.delattr(os, "sysconf")
    else:
        monkeypatch.setattr(os, "sysconf", sysconf)
    assert checks._memory() == psutil.virtual_memory().total
    # The system counts whole pages, psutil whole KiB.
    assert checks._memory() == pytest.approx(checks.MEMORY, rel=1e-5)


def test_where_nothing_tells_nothing_is_refused(monkeypatch):
    with pytest.raises(InputError, match="this machine has"):
        checks.check_memory(1e15, "so many impacts")
    monkeypatch.delattr(os, "sysconf")
    monkeypatch.setitem(sys.modules, "psutil", None)
    monkeypatch.setattr(checks, "MEMORY", checks._memory())
    assert math.isinf(checks.MEMORY)
    checks.check_memory(1e15, "so many impacts")

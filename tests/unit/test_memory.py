"""How much memory the machine has, by whatever tells it."""

import math
import os
import sys

import psutil
import pytest

from jaximpact.errors import InputError
from jaximpact.io import checks


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

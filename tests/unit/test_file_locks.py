"""Locks between processes, as POSIX has them and as Windows has them."""

import os
import subprocess
import sys

import pytest
from paths import HELPERS, ROOT

from jaximpact import file_locks
from jaximpact.io import files

HOLD = """
import sys, time
import windows_locks
from pathlib import Path
from jaximpact.io.files import locked
with locked(Path(sys.argv[1])):
    print(flush=True)
    time.sleep(float(sys.argv[2]))
"""


@pytest.fixture
def hold():
    """Function that has another process hold the lock of a path, for some seconds."""
    running = []

    def start(path, seconds):
        environment = os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{HELPERS}"}
        command = [sys.executable, "-c", HOLD, str(path), str(seconds)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment)
        running.append(process)
        process.stdout.readline()
        return process

    yield start
    for process in running:
        process.kill()
        process.communicate()


@pytest.fixture
def windows(monkeypatch):
    """Has this process lock as on Windows."""
    import windows_locks

    monkeypatch.setattr(file_locks, "fcntl", None)
    monkeypatch.setattr(file_locks, "msvcrt", windows_locks)


def test_a_file_that_another_process_writes_is_refused(windows, hold, tmp_path):
    path = tmp_path / "results.csv"
    holder = hold(path, 60)
    with (
        pytest.raises(BlockingIOError, match=rf"process {holder.pid}\); wait for it"),
        files.locked(path),
    ):
        pytest.fail("locked twice")
    holder.kill()
    holder.wait()
    with files.locked(path):
        pass
    assert not [*tmp_path.iterdir()]


def test_who_waits_has_the_lock_when_the_other_ends(windows, hold, tmp_path):
    path = tmp_path / "results.csv"
    holder = hold(path, 0.3)
    descriptor = os.open(tmp_path / f".results.csv.{files.LOCK_SUFFIX}", os.O_RDWR)
    file_locks.lock(descriptor, wait=True)
    assert holder.wait(60) == 0
    os.close(descriptor)


def test_a_system_without_locks_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr(file_locks, "fcntl", None)
    with open(tmp_path / "file", "w") as file, pytest.raises(OSError, match="no locks"):
        file_locks.lock(file.fileno(), wait=True)

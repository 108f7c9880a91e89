"""Engines that are there already: two workers of Dask, pools of processes, and a worker
that is killed. Workers start in float32, as JAX does.

Processes that start, and whatever is compiled, cost seconds each: all tests share one
cluster and one kernel, that of a law in a file, and other processes start meanwhile.
"""

import multiprocessing
import multiprocessing.forkserver
import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from functools import partial
from types import SimpleNamespace

import dask
import distributed
import joblib
import numpy as np
import psutil
import pytest
import xarray as xr
from error_messages import assert_one_line_error
from own_laws import FLOW
from runout_scenes import SLOPE_STUDY

from jaximpact import (
    Block,
    Impact,
    Scene,
    Soil,
    read_netcdf,
    simulate_batch,
    sweep,
    tasks,
    write_zarr,
)
from jaximpact.cli import main
from jaximpact.errors import IncompleteError, NoWorkersWarning
from jaximpact.finding import find_part
from jaximpact.laws import AbstractFlow
from jaximpact.runout import read_slope_study, run_slope_study
from jaximpact.store import open_cache
from jaximpact.tasks import run_tasks

pytestmark = pytest.mark.slow

AXES = {
    "angle_deg": np.linspace(10.0, 80.0, 30),
    "orientation_deg": [20.0, 50.0, 100.0],
}
NEEDED_BY_WORKERS = (
    "dask.array",
    "distributed",
    "jaximpact.batch",
    "jaximpact.runout",
    "jaximpact.sweeping",
    "zarr",
)
BLOCK = Block(mass=np.linspace(50.0, 500.0, 300), aspect_ratio=2.0)
IMPACT = Impact.from_degrees(angle=30.0, orientation=20.0)


@pytest.fixture(scope="module")
def laws(tmp_path_factory):
    """A file with a law, which all scenes here have."""
    path = tmp_path_factory.mktemp("laws") / "my_laws.py"
    path.write_text(FLOW)
    return path


@pytest.fixture(scope="module")
def soil(laws):
    return Soil(flow=find_part("flow", AbstractFlow, f"{laws}:Creeping"))


@pytest.fixture(scope="module")
def fork_server():
    """The server from which workers are forked: it imports what each of them needs."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(NEEDED_BY_WORKERS))
    multiprocessing.forkserver.ensure_running()


@pytest.fixture(scope="module")
def pools() -> Iterator[list[Executor]]:
    """Pools of one process each, which start."""
    spawn = multiprocessing.get_context("spawn")
    pools: list[Executor] = [
        joblib.externals.loky.get_reusable_executor(max_workers=1),
        ProcessPoolExecutor(1, mp_context=spawn),
    ]
    for pool in pools:
        pool.submit(exec, "import jaximpact.batch")
    yield pools
    for pool in pools:
        pool.shutdown()


BUSY = """
import argparse, time
from jaximpact.cli.options import engine_of
from jaximpact.interruption import ending_on_signals

asked = argparse.Namespace(workers=1, scheduler=None)
with ending_on_signals(), engine_of(asked) as executor:
    executor.submit(time.sleep, 600)
    print("ready", flush=True)
    time.sleep(600)
"""


@pytest.fixture(scope="module")
def command(tmp_path_factory):
    """A command that starts, and then waits for a worker of its own."""
    # Tests in the background ignore Ctrl-C, which a command inherits.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    with subprocess.Popen(
        [sys.executable, "-c", BUSY],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"TMPDIR": str(tmp_path_factory.mktemp("temporary"))},
    ) as run:
        signal.signal(signal.SIGINT, before)
        yield run
        run.terminate()


@pytest.fixture(scope="module")
def at_once(fork_server, pools, command, soil):
    """The sweep of this process, in which it compiles while the others start."""
    return sweep(Scene(soil=soil), AXES)


@pytest.fixture(scope="module")
def client(at_once):
    settings = {
        # A busy machine takes longer than 15 s to start a worker that was killed again.
        "distributed.deploy.lost-worker-timeout": "10 minutes",
        # The commands spawn theirs, as Dask does where it is not told.
        "distributed.worker.multiprocessing-method": "forkserver",
    }
    with (
        dask.config.set(settings),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            dashboard_address=":0",
            silence_logs=50,
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def assert_same_bits(received, expected):
    for name in expected.data_vars:
        assert received[name].values.tobytes() == expected[name].values.tobytes(), name


def test_two_workers_give_the_same_bits(client, at_once, soil):
    lazy = sweep(Scene(soil=soil), AXES, chunks={"angle_deg": 7})
    assert_same_bits(lazy.compute(), at_once)


def test_workers_keep_compiled_code_in_the_directory_that_they_are_told(client, soil):
    def settings():
        import jax

        from jaximpact import store

        return jax.config.jax_enable_x64, str(store.open_cache().path)

    sweep(Scene(soil=soil), AXES, chunks={"angle_deg": 15}).compute()
    for x64, path in client.run(settings).values():
        assert x64
        assert path == str(open_cache().path)


def test_a_batch_on_a_client_is_taken_up_from_its_journal(client, soil, tmp_path):
    expected = simulate_batch(BLOCK, soil, IMPACT)
    told, journal = [], tmp_path / "journal"
    how = {"journal": journal, "progress": lambda *done: told.append(done)}
    received = simulate_batch(
        BLOCK, soil, IMPACT, executor=client.get_executor(pure=False), **how
    )
    assert received.e_bar.tobytes() == expected.e_bar.tobytes()
    assert told[-1] == (300, 300)
    told.clear()
    simulate_batch(BLOCK, soil, IMPACT, **how)
    assert told == [(300, 300)]


def test_a_run_out_study_on_a_client(client, tmp_path):
    path = tmp_path / "slope.toml"
    path.write_text(
        SLOPE_STUDY.replace("count = 70", "count = 12").replace(
            '["Ellipsoid", "EllipticCylinder"]', '"Ellipsoid"'
        )
    )
    study, told = read_slope_study(path), []
    expected = run_slope_study(study)
    received = run_slope_study(
        study,
        executor=client.get_executor(pure=False),
        progress=lambda *done: told.append(done),
    )
    xr.testing.assert_identical(received, expected)
    assert told[-1] == (12, 12)


def test_commands_on_a_scheduler(client, laws, folder, capsys):
    study = f"flow = '{laws}:Creeping'\n[axes]\n"
    study += "angle_deg = { from = 10, to = 60, count = 30 }\n"
    (folder / "study.toml").write_text(study)
    address = ["--scheduler", client.scheduler.address]
    for out in (["here.nc"], ["there.nc", *address], ["there.zarr", *address]):
        assert main(["sweep", "study.toml", "--out", *out]) == 0
    assert "1 of 1 regions computed, 0 were there" in capsys.readouterr().err
    here = read_netcdf(folder / "here.nc")
    xr.testing.assert_identical(read_netcdf(folder / "there.nc"), here)
    xr.testing.assert_identical(xr.open_zarr(folder / "there.zarr").load(), here)
    assert main(["sweep", "study.toml", "--out", "there.zarr"]) == 0
    assert "0 of 1 regions computed, 1 were there" in capsys.readouterr().err


def test_a_killed_worker_loses_nothing(client, at_once, soil, tmp_path):
    lazy = sweep(Scene(soil=soil), AXES, chunks={"angle_deg": 8})
    workers = [*client.run(os.getpid).values()]

    def kill(done: int, regions: int) -> None:
        if workers and done == 1:
            os.kill(workers.pop(), signal.SIGKILL)

    regions = write_zarr(tmp_path / "a.zarr", lazy, progress=kill)
    assert len(workers) == 1
    assert regions.total == regions.computed == 4
    there = xr.open_zarr(tmp_path / "a.zarr").load()
    xr.testing.assert_identical(there, at_once)
    assert_same_bits(there, at_once)


def test_a_worker_killed_at_work_costs_its_task_alone(client):
    """The task is done again elsewhere, the others go on, and none is sent twice."""
    executor, sent, done = client.get_executor(pure=False), [], []
    counting = SimpleNamespace(
        submit=lambda task: sent.append(task) or executor.submit(task),
        _client=client,
    )
    client.wait_for_workers(2)  # The test before has killed one.
    pids = client.run(os.getpid)
    address, *_ = pids

    def kill_at_work():
        while not client.processing()[address]:
            time.sleep(0.01)
        os.kill(pids[address], signal.SIGKILL)

    killer = threading.Thread(target=kill_at_work)
    killer.start()
    run_tasks(
        counting,
        (tasks.Task(time.sleep, 0.3) for _ in range(5)),
        lambda place, _: done.append(place),
    )
    killer.join()
    assert sorted(done) == [0, 1, 2, 3, 4]
    assert len(sent) == 5


def test_an_interrupted_call_lets_its_workers_go(client):
    """KeyboardInterrupt ends the call at once, not after the tasks that it waits for;
    and tasks that had begun are of no use to anybody."""

    def interrupted():
        yield from (tasks.Task(time.sleep, 5.0) for _ in range(6))
        while not any(client.processing().values()):
            time.sleep(0.01)
        raise KeyboardInterrupt

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run_tasks(client.get_executor(pure=False), interrupted(), lambda *_: None)
    while any(client.processing().values()):
        assert time.monotonic() - begin < 10.0  # one after the other they take 15 s
        time.sleep(0.05)


def test_an_interrupted_command_takes_its_workers_with_it(command, tmp_path_factory):
    assert command.stdout.readline() == "ready\n"
    temporary = tmp_path_factory.getbasetemp() / "temporary0"
    assert [*temporary.glob("jaximpact-*/dask-scratch-space/worker-*")]
    workers = psutil.Process(command.pid).children(recursive=True)
    command.send_signal(signal.SIGINT)
    assert command.wait(timeout=60) == 130
    assert len(workers) > 1  # and a process of Python that tracks resources
    assert psutil.wait_procs(workers, timeout=30)[1] == []
    assert command.stderr.read() == "jaximpact: interrupted\n"
    assert not [*temporary.glob("jaximpact-*")]


def test_workers_that_cannot_start_are_told_in_one_line(folder, monkeypatch, capsys):
    def start(**_):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr(distributed, "LocalCluster", start)
    (folder / "study.toml").write_text("[axes]\nangle_deg = [10, 20]\n")
    command = ["sweep", "study.toml", "--out", "a.nc", "--workers"]
    assert main([*command, "1"]) == 1
    assert_one_line_error(capsys, "a worker died as it was started: Nanny failed")
    assert main([*command, "1000000"]) == 2
    assert_one_line_error(capsys, "1000000 workers would take", "GiB of memory")
    assert main([*command, "two"]) == 2
    assert_one_line_error(capsys, "must be a whole number from 1, but is two")


def test_a_client_without_workers_is_told_and_goes_on_with_new_ones(
    at_once, soil, tmp_path, monkeypatch
):
    monkeypatch.setattr(tasks, "WORKERLESS", 0.1)
    lazy = sweep(Scene(soil=soil), {"angle_deg": [30.0, 40.0]}, chunks=1)
    quiet, told = {"dashboard_address": ":0", "silence_logs": 50}, []
    with (
        distributed.LocalCluster(n_workers=0, processes=False, **quiet) as cluster,
        distributed.Client(cluster),
        warnings.catch_warnings(),
    ):

        def show(message, *_):
            told.append(message)
            cluster.scale(1)

        # Without a warning the call would wait for ever, and the test with it.
        late = threading.Timer(30.0, cluster.scale, [1])
        late.start()
        warnings.filterwarnings("always", category=NoWorkersWarning)
        monkeypatch.setattr(warnings, "showwarning", show)
        regions = write_zarr(tmp_path / "a.zarr", lazy)
        late.cancel()
    assert [type(message) for message in told] == [NoWorkersWarning]
    assert regions.computed == 2


def test_a_pool_of_joblib_and_one_of_python(pools, soil):
    expected = simulate_batch(BLOCK, soil, IMPACT)
    for pool in pools:
        received = simulate_batch(BLOCK, soil, IMPACT, executor=pool)
        assert received.e_bar.tobytes() == expected.e_bar.tobytes()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_pool_that_breaks_is_told_after_what_it_gave(pools):
    die, found = partial(signal.raise_signal, signal.SIGKILL), []
    with pools[1] as pool, pytest.raises(IncompleteError, match="lost their workers"):
        run_tasks(pool, [int, die], lambda place, _: found.append(place))
    assert found in ([0], [])

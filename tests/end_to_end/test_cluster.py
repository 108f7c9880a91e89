"""Engines that are there already: two workers of Dask, pools of processes, and a worker
that is killed. Workers start in float32, as JAX does.

Processes that start, and whatever is compiled, cost seconds each: all tests share one
cluster and one kernel, and the worker that is killed is the last to be needed.
"""

import multiprocessing
import os
import signal
import warnings
from concurrent.futures import Executor, ProcessPoolExecutor

import dask
import distributed
import joblib
import numpy as np
import pytest
import xarray as xr
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
    write_zarr,
)
from jaximpact.cli import main
from jaximpact.errors import NoWorkersWarning
from jaximpact.finding import find_part
from jaximpact.laws import AbstractFlow
from jaximpact.lazy import regions as computing
from jaximpact.runout import read_slope_study, run_slope_study
from jaximpact.store import open_cache

pytestmark = pytest.mark.slow

AXES = {
    "angle_deg": np.linspace(10.0, 80.0, 30),
    "orientation_deg": [20.0, 50.0, 100.0],
}
BLOCK = Block(mass=np.linspace(50.0, 500.0, 300), aspect_ratio=2.0)
IMPACT = Impact.from_degrees(angle=30.0, orientation=20.0)


@pytest.fixture(scope="module")
def client():
    # A busy machine takes longer than 15 s to start a worker that was killed again.
    patience = {"distributed.deploy.lost-worker-timeout": "10 minutes"}
    with (
        dask.config.set(patience),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            dashboard_address=":0",
            silence_logs=50,
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def at_once():
    return sweep(Scene(), AXES)


def assert_same_bits(received, expected):
    for name in expected.data_vars:
        assert received[name].values.tobytes() == expected[name].values.tobytes(), name


def test_two_workers_give_the_same_bits(client, at_once):
    lazy = sweep(Scene(), AXES, chunks={"angle_deg": 7})
    assert_same_bits(lazy.compute(), at_once)


def test_workers_keep_compiled_code_in_the_directory_that_they_are_told(client):
    def settings():
        import jax

        from jaximpact import store

        return jax.config.jax_enable_x64, str(store.open_cache().path)

    sweep(Scene(), AXES, chunks={"angle_deg": 15}).compute()
    for x64, path in client.run(settings).values():
        assert x64
        assert path == str(open_cache().path)


def test_a_batch_on_a_client_is_taken_up_from_its_journal(client, tmp_path):
    expected = simulate_batch(BLOCK, Soil(), IMPACT)
    told, journal = [], tmp_path / "journal"
    how = {"journal": journal, "progress": lambda *done: told.append(done)}
    received = simulate_batch(
        BLOCK, Soil(), IMPACT, executor=client.get_executor(pure=False), **how
    )
    assert received.e_bar.tobytes() == expected.e_bar.tobytes()
    assert told[-1] == (300, 300)
    told.clear()
    simulate_batch(BLOCK, Soil(), IMPACT, **how)
    assert told == [(300, 300)]


def test_a_law_of_a_file_is_found_by_workers(client, tmp_path):
    path = tmp_path / "my_laws.py"
    path.write_text(FLOW)
    soil = Soil(flow=find_part("flow", AbstractFlow, f"{path}:Creeping"))
    lazy = sweep(Scene(soil=soil), {"my_creep_share": [0.0, 0.1]}, chunks=2)
    expected = sweep(Scene(soil=soil), {"my_creep_share": [0.0, 0.1]})
    assert_same_bits(lazy.compute(), expected)


def test_a_run_out_study_on_a_client(client, tmp_path):
    path = tmp_path / "slope.toml"
    path.write_text(SLOPE_STUDY.replace("count = 70", "count = 12"))
    study, told = read_slope_study(path), []
    received = run_slope_study(
        study,
        executor=client.get_executor(pure=False),
        progress=lambda *done: told.append(done),
    )
    xr.testing.assert_identical(received, run_slope_study(study))
    assert told[-1] == (12, 12)


def test_commands_on_a_scheduler(client, folder, capsys):
    study = "[axes]\nangle_deg = { from = 0, to = 60, count = 30 }\n"
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


def test_a_killed_worker_loses_nothing(client, at_once, tmp_path):
    lazy = sweep(Scene(), AXES, chunks={"angle_deg": 1})
    workers = [*client.run(os.getpid).values()]

    def kill(done: int, regions: int) -> None:
        if workers and done == 5:
            os.kill(workers.pop(), signal.SIGKILL)

    regions = write_zarr(tmp_path / "a.zarr", lazy, progress=kill)
    assert len(workers) == 1
    assert regions.total == regions.computed == 30
    there = xr.open_zarr(tmp_path / "a.zarr").load()
    xr.testing.assert_identical(there, at_once)
    assert_same_bits(there, at_once)


def test_a_client_without_workers_is_told_and_goes_on_with_new_ones(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(computing, "WORKERLESS", 0.1)
    lazy = sweep(Scene(), {"angle_deg": [30.0, 40.0]}, chunks=1)
    quiet = {"dashboard_address": ":0", "silence_logs": 50}
    with (
        distributed.LocalCluster(n_workers=0, processes=False, **quiet) as cluster,
        distributed.Client(cluster),
        warnings.catch_warnings(),
    ):
        warnings.filterwarnings("always", category=NoWorkersWarning)
        monkeypatch.setattr(warnings, "showwarning", lambda *_: cluster.scale(1))
        regions = write_zarr(tmp_path / "a.zarr", lazy)
    assert regions.computed == 2


def test_a_pool_of_joblib_and_one_of_python():
    expected = simulate_batch(BLOCK, Soil(), IMPACT)
    spawn = multiprocessing.get_context("spawn")
    pools: list[Executor] = [
        joblib.externals.loky.get_reusable_executor(max_workers=1),
        ProcessPoolExecutor(1, mp_context=spawn),
    ]
    for pool in pools:
        with pool:
            received = simulate_batch(BLOCK, Soil(), IMPACT, executor=pool)
        assert received.e_bar.tobytes() == expected.e_bar.tobytes()

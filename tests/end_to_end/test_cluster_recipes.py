"""Recipes of docs/how-to/on-a-cluster.md, as they are written there, where the tools
that they are for are installed."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr
from paths import DOCS, ROOT

from jaximpact import Scene, sweep, write_zarr

pytestmark = pytest.mark.slow

BLOCKS = (DOCS / "how-to" / "on-a-cluster.md").read_text().split("```")[1::2]
SCENES = pd.DataFrame({"name": range(3), "angle_deg": [10.0, 20.0, 30.0]})


def needs(program: str, package: str = ""):
    there = shutil.which(program, path=environment()["PATH"])
    there = there and (not package or importlib.util.find_spec(package))
    if there and program == "sbatch":  # installed, but does a controller run?
        there = (
            subprocess.run(["scontrol", "ping"], capture_output=True).returncode == 0
        )
    tools = " and ".join(filter(None, (program, package)))
    return pytest.mark.skipif(
        not there, reason=f"{tools} not installed, or not running"
    )


def environment() -> dict[str, str]:
    """Environment in which commands are those of this Python."""
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    return os.environ | {"PATH": path, "PYTHONPATH": str(ROOT)}


def recipe(part: str, **changed: str) -> str:
    """The block of the page that holds a text, with what this machine needs changed."""
    text = next(block for block in BLOCKS if part in block).partition("\n")[2]
    for old, new in changed.items():
        assert old in text
        text = text.replace(old, new)
    return text


def run(*command: str) -> str:
    done = subprocess.run(command, env=environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@needs("snakemake")
def test_snakemake(folder):
    SCENES.to_csv("part-0.csv", index=False)
    Path("Snakefile").write_text(recipe("rule all", **{"range(4)": "range(1)"}))
    run("snakemake", "--cores", "1")
    assert list(pd.read_csv("result-0.csv").angle_deg) == [10.0, 20.0, 30.0]


@needs("sbatch")
def test_a_job_array_of_slurm(folder):
    SCENES.to_csv("part-0.csv", index=False)
    changed = {"0-3": "0-0", "--cpus-per-task=8": "--cpus-per-task=1"}
    Path("job.sh").write_text(recipe("#SBATCH", **changed))
    run("sbatch", "-W", "job.sh")
    assert list(pd.read_csv("result-0.csv").angle_deg) == [10.0, 20.0, 30.0]


@needs("sbatch", "dask_jobqueue")
def test_jobs_of_slurm_are_workers_of_dask(folder):
    axes = {"angle_deg": [10.0, 20.0, 30.0]}
    small = 'cores=1, processes=1, memory="1GB"'
    small += ', scheduler_options={"dashboard_address": ":0"}'
    changed = {
        'cores=8, processes=8, memory="16GB"': small,
        "jobs=10": "jobs=1",
        "/shared/": "",
    }
    names = {"write_zarr": write_zarr, "lazy": sweep(Scene(), axes, chunks=2)}
    exec(recipe("SLURMCluster", **changed) + "\ncluster.close()", names)
    there = xr.open_zarr(folder / "angles.zarr").load()
    xr.testing.assert_identical(there, sweep(Scene(), axes))

"""Stores of Zarr written by region: whole, taken up where they stopped, and of one
study alone."""

import errno
import json

import dask.array
import numpy as np
import pytest
import xarray as xr

from jaximpact import Block, Outcome, Scene, simulate_dataset, sweep, write_zarr
from jaximpact.errors import InputError
from jaximpact.lazy import WrittenRegions, impacts
from jaximpact.lazy.zarr_store import JOURNAL

BASE = Scene(block=Block(mass=200.0))
AXES = {
    "angle_deg": np.linspace(0.0, 60.0, 5),
    "ground": {"name": ["dense", "loose"], "c_v": [1.0, 0.5]},
}
CHUNKS = {"angle_deg": 2}


@pytest.fixture
def computed(monkeypatch):
    """Counts of the impacts of each block that was computed."""
    counts, compute = [], impacts.compute_part

    def counted(scene, count, *how):
        counts.append(count)
        return compute(scene, count, *how)

    monkeypatch.setattr(impacts, "compute_part", counted)
    return counts


def test_a_store_is_the_sweep(tmp_path):
    told = []
    lazy = sweep(BASE, AXES, chunks=CHUNKS)
    regions = write_zarr(
        tmp_path / "a.zarr", lazy, progress=lambda *done: told.append(done)
    )
    assert regions == WrittenRegions(total=3, found=0, computed=3)
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]
    there = xr.open_zarr(tmp_path / "a.zarr").load()
    xr.testing.assert_identical(there, sweep(BASE, AXES))
    assert {path.name for path in tmp_path.iterdir()} == {"a.zarr"}


def test_what_several_regions_need_is_computed_once(tmp_path):
    needed = []

    def needed_by_all(speed):
        needed.append(speed)
        return speed

    speed = xr.Variable((), dask.array.from_array(np.array(11.0)))
    scenes = xr.Dataset({"angle_deg": ("x", [0.0, 10.0, 20.0])}).chunk(x=1)
    scenes["speed_mps"] = speed.copy(data=speed.data.map_blocks(needed_by_all))
    lazy = simulate_dataset(scenes).drop_vars("speed_mps")
    needed.clear()  # Dask calls it to learn what it returns
    assert write_zarr(tmp_path / "a.zarr", lazy).computed == 3
    assert needed == [11.0]


def test_a_store_is_taken_up_where_it_stopped(tmp_path, computed):
    path, lazy = tmp_path / "a.zarr", sweep(BASE, AXES, chunks=CHUNKS)

    def stopped(done, total):
        if done == 1:
            raise KeyboardInterrupt

    with dask.config.set(scheduler="synchronous"):
        with pytest.raises(KeyboardInterrupt):
            write_zarr(path, lazy, progress=stopped)
        assert len(computed) == 1
        assert write_zarr(path, lazy) == WrittenRegions(total=3, found=1, computed=2)
        assert sorted(computed) == [2, 4, 4]
        assert write_zarr(path, lazy) == WrittenRegions(total=3, found=3, computed=0)
    assert sorted(computed) == [2, 4, 4]
    xr.testing.assert_identical(xr.open_zarr(path).load(), sweep(BASE, AXES))


def test_attributes_and_chunks_of_all_kinds_are_taken_up(tmp_path):
    """JSON gives a list for a tuple or an array; NaN is not equal to itself."""
    scenes = xr.Dataset(
        {"angle_deg": ("x", [0.0, 10.0, 20.0]), "mass_kg": ("x", [1.0, 2.0, 3.0])},
        attrs={"tuple": (1, 2), "array": np.array([1.0, np.nan]), "nan": np.nan},
    )
    for name, length in {"angle_deg": 1, "mass_kg": 3}.items():
        scenes[name] = scenes[name].chunk(x=length)
    lazy = simulate_dataset(scenes)
    assert write_zarr(tmp_path / "a.zarr", lazy).computed == 3
    assert write_zarr(tmp_path / "a.zarr", lazy).found == 3


def test_a_region_that_was_cut_short_is_computed_again(tmp_path):
    """A kill between a region's numbers and its row, or in the row, leaves it out."""
    path, lazy = tmp_path / "a.zarr", sweep(BASE, AXES, chunks=CHUNKS)
    write_zarr(path, lazy)
    rows = (path / JOURNAL).read_bytes()
    last = int.from_bytes(rows[-8 * (1 + len(Outcome)) :][:8], "little")
    (path / JOURNAL).write_bytes(rows[:-1])
    (path / "e_n" / f"{last}.0").write_bytes(b"cut")
    assert write_zarr(path, lazy).computed == 1
    xr.testing.assert_identical(xr.open_zarr(path).load(), sweep(BASE, AXES))


@pytest.mark.parametrize(
    "how",
    [
        {"base": Scene(block=Block(mass=201.0))},
        {"accuracy": "fast"},
        {"axes": AXES | {"angle_deg": np.linspace(0.0, 61.0, 5)}},
        {"axes": AXES | {"angle_deg": [0.0, 1.0, 2.0]}},
        {"chunks": {"angle_deg": 3}},
    ],
)
def test_a_store_of_another_study_is_refused(tmp_path, how):
    usual = {"base": BASE, "axes": AXES, "chunks": CHUNKS}
    write_zarr(tmp_path / "a.zarr", sweep(**usual))
    with pytest.raises(InputError, match="begun for another dataset, other chunks"):
        write_zarr(tmp_path / "a.zarr", sweep(**usual | how))


def test_a_directory_of_something_else_is_refused(tmp_path):
    (tmp_path / "a.zarr" / "e_n").mkdir(parents=True)
    (tmp_path / "a.zarr" / "letter.txt").write_text("mine")
    with pytest.raises(InputError, match="no store written by region"):
        write_zarr(tmp_path / "a.zarr", sweep(BASE, AXES, chunks=CHUNKS))
    assert (tmp_path / "a.zarr" / "letter.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("chunks", "message"),
    [
        ((1, 3, 1), r"chunks along angle_deg must have one length.*\(1, 3, 1\)"),
        (None, "no lazy variable"),
    ],
)
def test_datasets_without_regions_are_refused(tmp_path, chunks, message):
    how = {} if chunks is None else {"chunks": {"angle_deg": chunks}}
    with pytest.raises(InputError, match=message):
        write_zarr(tmp_path / "a.zarr", sweep(BASE, AXES, **how))


def test_chunks_of_no_size_are_regions_too(tmp_path):
    lazy = sweep(BASE, AXES, chunks={"angle_deg": (2, 0, 2, 1)})
    assert write_zarr(tmp_path / "a.zarr", lazy).total == 4
    there = xr.open_zarr(tmp_path / "a.zarr").load()
    assert json.loads(there.attrs["outcomes"]) == {"detached": 10}
    xr.testing.assert_identical(there, sweep(BASE, AXES))


def test_a_store_that_cannot_be_begun_leaves_nothing(tmp_path, monkeypatch):
    def full(dataset, path, **_):
        path.mkdir()
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_zarr", full)
    with pytest.raises(OSError, match=r"No space left on device: '.*a\.zarr'"):
        write_zarr(tmp_path / "a.zarr", sweep(BASE, AXES, chunks=CHUNKS))
    assert [*tmp_path.iterdir()] == []

"""Lazy arrays: impacts in blocks are those computed at once, to the last bit."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr
from runout_scenes import SLOPE_STUDY

from jaximpact import Accuracy, Block, Impact, Scene, simulate_dataset, sweep
from jaximpact.errors import InputError
from jaximpact.lazy import impacts
from jaximpact.runout import read_slope_study, run_slope_study

BASE = Scene(block=Block(mass=200.0), impact=Impact(speed=11.0))
AXES = {
    "ground": {"name": ["dense", "loose"], "c_v": [1.0, 0.5], "gamma_v": [8.7, 1.7]},
    "angle_deg": [0.0, 10.0, 40.0, 55.0, 70.0],
    "shape": ["Ellipsoid", "EllipticCylinder"],
}


@pytest.fixture(scope="module")
def at_once():
    """The sweep, without what nobody has counted of a lazy one."""
    dataset = sweep(BASE, AXES)
    del dataset.attrs["outcomes"]
    return dataset


def assert_same_bits(received, expected):
    xr.testing.assert_identical(received, expected)
    for name in expected.data_vars:
        assert received[name].values.tobytes() == expected[name].values.tobytes(), name


@pytest.mark.parametrize(
    "chunks",
    [
        1,
        "auto",
        {"angle_deg": 2},
        {"angle_deg": (4, 1), "ground": 1},
        {"angle_deg": (0, 3, 0, 2)},
    ],
)
def test_a_sweep_in_chunks_is_the_sweep(at_once, chunks):
    lazy = sweep(BASE, AXES, chunks=chunks)
    assert all(variable.chunks for variable in lazy.data_vars.values())
    assert_same_bits(lazy.compute(), at_once)


@pytest.mark.parametrize("chunks", ["auto", {"angle_deg": "auto"}, ("auto", 500)])
def test_blocks_that_dask_chooses_are_as_long_as_each_other(chunks):
    """So that no worker waits for another at the end."""
    axes = {
        "angle_deg": np.linspace(0.0, 80.0, 1000),
        "speed_mps": np.linspace(1.0, 30.0, 1000),
    }
    lengths = sweep(BASE, axes, chunks=chunks).e_n.chunks[0]
    assert len(lengths) > 1
    assert sum(lengths) == 1000
    # Zarr wants all but the last to be the same.
    assert len(set(lengths[:-1])) == 1
    assert 0 <= lengths[0] - lengths[-1] < len(lengths)


@pytest.mark.parametrize("chunks", [(3, 4), [3, 4], ((3, 4),), {"angle_deg": (3, 4)}])
def test_lengths_along_one_axis(chunks):
    lazy = sweep(BASE, {"angle_deg": np.linspace(0.0, 80.0, 7)}, chunks=chunks)
    assert lazy.e_n.chunks == ((3, 4),)


def test_a_block_is_computed_once_for_all_its_numbers(monkeypatch):
    computed, compute = [], impacts.compute_part

    def counted(scene, count, *how):
        computed.append(count)
        return compute(scene, count, *how)

    monkeypatch.setattr(impacts, "compute_part", counted)
    lazy = sweep(BASE, {"angle_deg": np.linspace(0, 80, 7)}, chunks=3)
    assert computed == []
    lazy.compute()
    assert sorted(computed) == [1, 3, 3]


def test_a_dataset_of_arrays_is_computed_at_once_and_keeps_what_it_is(at_once):
    scenes = at_once.drop_vars([*at_once.data_vars]).assign_attrs(campaign="spring")
    scenes["site"] = "angle_deg", list("abcde"), {"long_name": "site"}
    result = simulate_dataset(scenes.set_coords("site"), BASE)
    for name in at_once.data_vars:
        expected = at_once[name].transpose(*result[name].dims)
        assert result[name].values.tobytes() == expected.values.tobytes(), name
        assert result[name].attrs == expected.attrs
    assert result.attrs["campaign"] == "spring"
    assert result.site.attrs == {"long_name": "site"}
    assert result.attrs["outcomes"] == '{"detached": 20}'


def test_a_dataset_in_chunks_is_the_dataset_of_arrays():
    mass, angle = np.linspace(50.0, 500.0, 6), np.linspace(0.0, 60.0, 4)
    scenes = xr.Dataset(
        {
            "mass_kg": ("block", mass),
            "angle_deg": (("block", "test"), np.add.outer(mass / 50, angle)),
        }
    )
    lazy = simulate_dataset(scenes.chunk(block=(1, 5), test=3))
    assert lazy.e_n.chunks == ((1, 5), (3, 1))
    whole = simulate_dataset(scenes)
    del whole.attrs["outcomes"]
    assert_same_bits(lazy.compute(), whole)


def test_a_point_that_fails_ends_nothing():
    # a step size control that cannot be met
    impossible = Accuracy("impossible", 1e-300, 1e-300)
    lazy = sweep(BASE, {"angle_deg": [0.0, 30.0]}, accuracy=impossible, chunks=1)
    found = lazy.compute()
    assert set(found.outcome.values) == {"failed"}
    assert np.all(np.isnan(found.e_n))


@pytest.mark.parametrize(
    ("variables", "message"),
    [
        ({"angel_deg": 1.0}, "angel_deg is unknown; did you mean angle_deg"),
        ({"e_n": 0.5, "angle_deg": 1.0}, "e_n is a result"),
        ({"name": "a"}, "holds no quantity of a scene"),
        ({"mass_kg": np.datetime64(1, "ns")}, "mass_kg must hold numbers, but holds d"),
        ({"angle_deg": 95.0}, "must be in \\(-90, 90\\) deg, but is 1.65806 rad = 95"),
    ],
)
def test_datasets_that_cannot_be_simulated_are_refused(variables, message):
    scenes = xr.Dataset({name: ("x", [value]) for name, value in variables.items()})
    with pytest.raises(InputError, match=message):
        simulate_dataset(scenes)


def test_a_value_of_a_block_that_is_out_of_range_is_told_as_it_is_computed():
    """It is counted within its block, and the error says so."""
    scenes = xr.Dataset({"angle_deg": ("x", [0.0, 95.0])}).chunk(x=1)
    message = r"Impact\.angle must be in .* \(impact of a block, number 0\)"
    with pytest.raises(InputError, match=message):
        simulate_dataset(scenes).compute()


@pytest.mark.parametrize(
    ("how", "message"),
    [
        (
            {"chunks": {"angel_deg": 1}},
            "chunks must name axes .*, but holds 'angel_deg'",
        ),
        ({"chunks": {"angle_deg": (1, 1)}}, "lengths that add up to the axes"),
        ({"chunks": 1, "progress": print}, "write_zarr, which has progress"),
    ],
)
def test_chunks_that_do_not_fit_are_refused(how, message):
    with pytest.raises(InputError, match=message):
        sweep(BASE, AXES, **how)


def test_more_blocks_than_the_memory_has_room_for_are_refused():
    names = ("mass_kg", "speed_mps", "k_E", "gamma_v")
    axes = dict.fromkeys(names, np.linspace(1.0, 10.0, 1000))
    with pytest.raises(InputError, match=r"1000000000000 blocks .* would take"):
        sweep(BASE, axes, chunks=1)


def test_without_dask_the_cure_is_told(monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == "dask"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "dask", None)
    with pytest.raises(InputError, match=r"the package dask, .*jaximpact\[cluster\]"):
        sweep(BASE, AXES, chunks=1)


@pytest.mark.slow
def test_a_run_out_study_in_parts_is_the_study(tmp_path):
    path = tmp_path / "slope.toml"
    path.write_text(SLOPE_STUDY)
    study = read_slope_study(path)
    whole = run_slope_study(study)
    with ThreadPoolExecutor(1) as pool:  # two portions
        xr.testing.assert_identical(run_slope_study(study, executor=pool), whole)

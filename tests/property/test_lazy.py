"""Lazy arrays: impacts in blocks are those computed at once, to the last bit."""

import errno
import json
import sys
from concurrent.futures import ThreadPoolExecutor

import dask.array
import numpy as np
import pytest
import xarray as xr
from runout_scenes import SLOPE_STUDY

from jaximpact import (
    Accuracy,
    Block,
    Impact,
    Outcome,
    Scene,
    simulate_dataset,
    sweep,
    write_zarr,
)
from jaximpact.errors import InputError
from jaximpact.lazy import WrittenRegions, impacts
from jaximpact.lazy.zarr_store import JOURNAL
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


@pytest.fixture
def computed(monkeypatch):
    """Counts of the impacts of each block that was computed."""
    counts, compute = [], impacts.compute_part

    def counted(scene, count, *how):
        counts.append(count)
        return compute(scene, count, *how)

    monkeypatch.setattr(impacts, "compute_part", counted)
    return counts


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


def test_a_block_is_computed_once_for_all_its_numbers(computed):
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


@pytest.mark.parametrize("words", ["deg", "degrees", "°", "", None])
def test_quantities_of_a_result_say_their_units(words):
    said = {} if words is None else {"units": words}
    scenes = xr.Dataset(
        {"mass_kg": ("angle_deg", [50.0, 500.0], {"source": "scale"})},
        {"angle_deg": ("angle_deg", [0.0, 30.0], said)},
    )
    result = simulate_dataset(scenes)
    assert result.angle_deg.attrs == {"units": "deg"}
    assert result.mass_kg.attrs == {"source": "scale", "units": "kg"}
    assert scenes.angle_deg.attrs == said  # the user's stay as they are


@pytest.mark.parametrize(
    ("name", "unit"),
    [("angle_deg", "rad"), ("mass_kg", "g"), ("aspect_ratio", "%"), ("k_E", "kPa")],
)
def test_units_that_contradict_a_name_are_refused(name, unit):
    given = xr.Dataset({name: ("x", [1.0, 1.2], {"units": unit})})
    message = f"{name} must have the unit .*, but its attribute units says '{unit}'"
    for scenes in (given, given.chunk(x=1), given.set_coords(name)):
        with pytest.raises(InputError, match=message):
            simulate_dataset(scenes)
    for axes in ({name: given[name]}, {"both": {name: given[name]}}):
        with pytest.raises(InputError, match=f"^axis .*{message}"):
            sweep(BASE, axes)


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
        ({"chunks": 0}, r"lengths that add up to the axes .*, but is 0: .* zero"),
        ({"chunks": {"angle_deg": 0}}, r"but is \{'angle_deg': 0\}: .* zero"),
        ({"chunks": {"angle_deg": -3}}, "but is .* -3}: a length is negative"),
        ({"chunks": {"angle_deg": (-1, 6)}}, "but is .*: a length is negative"),
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


# --- stores of Zarr written by region: whole, taken up, and of one study alone


STORED_AXES = {
    "angle_deg": np.linspace(0.0, 60.0, 5),
    "ground": {"name": ["dense", "loose"], "c_v": [1.0, 0.5]},
}
CHUNKS = {"angle_deg": 2}


def test_a_store_is_the_sweep(tmp_path):
    told = []
    lazy = sweep(BASE, STORED_AXES, chunks=CHUNKS)
    regions = write_zarr(
        tmp_path / "a.zarr", lazy, progress=lambda *done: told.append(done)
    )
    assert regions == WrittenRegions(total=3, found=0, computed=3)
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]
    there = xr.open_zarr(tmp_path / "a.zarr").load()
    xr.testing.assert_identical(there, sweep(BASE, STORED_AXES))
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
    path, lazy = tmp_path / "a.zarr", sweep(BASE, STORED_AXES, chunks=CHUNKS)

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
    xr.testing.assert_identical(xr.open_zarr(path).load(), sweep(BASE, STORED_AXES))


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
    path, lazy = tmp_path / "a.zarr", sweep(BASE, STORED_AXES, chunks=CHUNKS)
    write_zarr(path, lazy)
    rows = (path / JOURNAL).read_bytes()
    last = int.from_bytes(rows[-8 * (1 + len(Outcome)) :][:8], "little")
    (path / JOURNAL).write_bytes(rows[:-1])
    (path / "e_n" / f"{last}.0").write_bytes(b"cut")
    assert write_zarr(path, lazy).computed == 1
    xr.testing.assert_identical(xr.open_zarr(path).load(), sweep(BASE, STORED_AXES))


@pytest.mark.parametrize(
    "how",
    [
        {"base": Scene(block=Block(mass=201.0))},
        {"accuracy": "fast"},
        {"axes": STORED_AXES | {"angle_deg": np.linspace(0.0, 61.0, 5)}},
        {"axes": STORED_AXES | {"angle_deg": [0.0, 1.0, 2.0]}},
        {"chunks": {"angle_deg": 3}},
    ],
)
def test_a_store_of_another_study_is_refused(tmp_path, how):
    usual = {"base": BASE, "axes": STORED_AXES, "chunks": CHUNKS}
    write_zarr(tmp_path / "a.zarr", sweep(**usual))
    with pytest.raises(InputError, match="begun for another dataset, other chunks"):
        write_zarr(tmp_path / "a.zarr", sweep(**usual | how))


def scenes_in_chunks(heaviest=500.0):
    mass = np.linspace(50.0, heaviest, 5)
    return xr.Dataset({"mass_kg": ("block", mass)}).chunk(block=2)


def test_a_store_is_of_the_values_of_numbers_in_chunks(tmp_path):
    """Whichever file or function they come from."""
    path, scenes = tmp_path / "a.zarr", scenes_in_chunks()
    assert write_zarr(path, simulate_dataset(scenes)).computed == 3
    scenes.to_zarr(tmp_path / "scenes.zarr", zarr_format=2)
    elsewhere = xr.open_zarr(tmp_path / "scenes.zarr")
    computed = scenes.map(lambda mass: 2.0 * (0.5 * mass))
    for same in (elsewhere, computed):
        assert write_zarr(path, simulate_dataset(same)).found == 3
    for other in (scenes_in_chunks(501.0), scenes.isel(block=slice(None, None, -1))):
        with pytest.raises(InputError, match="begun for another dataset"):
            write_zarr(path, simulate_dataset(other.chunk(block=2)))


def test_a_store_is_of_shapes_in_chunks(tmp_path):
    def lazy(*names):
        scenes = {"shape": ("x", [*names]), "mass_kg": ("x", [1.0, 2.0, 3.0])}
        return simulate_dataset(xr.Dataset(scenes).chunk(x=1))

    names = ["Ellipsoid", "RectangularPrism", "Ellipsoid"]
    assert write_zarr(tmp_path / "a.zarr", lazy(*names)).computed == 3
    assert write_zarr(tmp_path / "a.zarr", lazy(*names)).found == 3
    with pytest.raises(InputError, match="begun for another dataset"):
        write_zarr(tmp_path / "a.zarr", lazy(*names[1:], "Ellipsoid"))


def test_what_is_made_of_results_is_computed_once(tmp_path, computed):
    lazy = simulate_dataset(scenes_in_chunks())
    lazy["lost"] = 1.0 - lazy.e_n**2
    write_zarr(tmp_path / "a.zarr", lazy)
    assert sorted(computed) == [1, 2, 2]


def test_a_store_without_a_whole_region_is_taken_up(tmp_path):
    path, lazy = tmp_path / "a.zarr", simulate_dataset(scenes_in_chunks())

    def interrupted(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_zarr(path, lazy, progress=interrupted)
    with pytest.raises(InputError, match="begun for another dataset"):
        write_zarr(path, simulate_dataset(scenes_in_chunks(501.0)))
    assert write_zarr(path, lazy) == WrittenRegions(total=3, found=0, computed=3)


def test_a_coordinate_may_have_any_name(tmp_path):
    """Also that of a file by which is found whether a directory can be written."""
    scenes = scenes_in_chunks().assign_coords(x=("block", np.arange(5.0)))
    lazy = simulate_dataset(scenes)
    assert write_zarr(tmp_path / "a.zarr", lazy).computed == 3
    assert write_zarr(tmp_path / "a.zarr", lazy).found == 3


def test_a_directory_of_something_else_is_refused(tmp_path):
    (tmp_path / "a.zarr" / "e_n").mkdir(parents=True)
    (tmp_path / "a.zarr" / "letter.txt").write_text("mine")
    with pytest.raises(InputError, match="no store written by region"):
        write_zarr(tmp_path / "a.zarr", sweep(BASE, STORED_AXES, chunks=CHUNKS))
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
        write_zarr(tmp_path / "a.zarr", sweep(BASE, STORED_AXES, **how))


@pytest.mark.parametrize("names", [{"block": 3}, {"e_n": 3}])
def test_names_that_are_no_texts_are_refused(tmp_path, names):
    lazy = simulate_dataset(scenes_in_chunks()).rename(names)
    with pytest.raises(InputError, match=r"of a store must be of type str, but is 3"):
        write_zarr(tmp_path / "a.zarr", lazy)


@pytest.mark.parametrize(
    "name",
    [
        "soil/type",
        "soil\\type",
        "draft.partial",
        "_regions",
        ".zgroup",
        ".zattrs",
        "..",
    ],
)
def test_names_that_are_no_folders_of_a_store_are_refused(tmp_path, computed, name):
    axes = {name: {"name": ["dense", "loose"], "c_v": [1.0, 0.5]}}
    with pytest.raises(InputError) as refused:
        write_zarr(tmp_path / "a.zarr", sweep(BASE, axes, chunks=1))
    assert f"a variable or an axis named {name!r}" in str(refused.value)
    assert [*tmp_path.iterdir()] == [] == computed


def test_chunks_of_no_size_are_regions_too(tmp_path):
    lazy = sweep(BASE, STORED_AXES, chunks={"angle_deg": (2, 0, 2, 1)})
    assert write_zarr(tmp_path / "a.zarr", lazy).total == 4
    there = xr.open_zarr(tmp_path / "a.zarr").load()
    assert json.loads(there.attrs["outcomes"]) == {"detached": 10}
    xr.testing.assert_identical(there, sweep(BASE, STORED_AXES))


def test_a_store_that_cannot_be_begun_leaves_nothing(tmp_path, monkeypatch):
    def full(dataset, path, **_):
        path.mkdir()
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_zarr", full)
    with pytest.raises(OSError, match=r"No space left on device: '.*a\.zarr'"):
        write_zarr(tmp_path / "a.zarr", sweep(BASE, STORED_AXES, chunks=CHUNKS))
    assert [*tmp_path.iterdir()] == []

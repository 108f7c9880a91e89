"""Sweeps: every point is the impact that it is said to be."""

import dataclasses
import itertools
import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from jaximpact import (
    Accuracy,
    Block,
    Impact,
    Scene,
    Soil,
    parametric_set,
    read_netcdf,
    simulate,
    simulate_set,
    sweep,
    write_netcdf,
)
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.parametric_sets import GROUNDS, PARAMETRIC_SETS
from jaximpact.shapes import EllipticCylinder
from jaximpact.sweeping import read_sweep_study

BASE = Scene(block=Block(mass=200.0, aspect_ratio=1.5), impact=Impact(speed=11.0))
AXES = {
    "ground": {"name": ["dense", "loose"], "c_v": [1.0, 0.5], "gamma_v": [8.7, 1.7]},
    "angle_deg": [10.0, 40.0, 70.0],
    "orientation_deg": [0.0, 120.0],
}


@pytest.fixture(scope="module")
def dataset():
    return sweep(BASE, AXES)


@pytest.mark.slow
def test_every_point_is_the_impact_of_its_coordinates(dataset):
    assert dict(dataset.sizes) == {"ground": 2, "angle_deg": 3, "orientation_deg": 2}
    for places in itertools.product(range(2), range(3), range(2)):
        point = dataset.isel(dict(zip(dataset.sizes, places, strict=True)))
        alone = simulate(
            BASE.block,
            Soil(c_v=float(point.c_v), gamma_v=float(point.gamma_v)),
            dataclasses.replace(
                BASE.impact,
                angle=np.radians(point.angle_deg),
                orientation=np.radians(point.orientation_deg),
            ),
        )
        assert str(point.outcome.values) == str(alone.outcome)
        for name, field in (
            ("e_n", "e_n"),
            ("max_penetration_m", "max_penetration"),
            ("omega_radps", "angular_velocity"),
            ("max_tangential_force_N", "max_tangential_force"),
        ):
            # a batch gives what the scene gives alone, to rounding
            expected = float(getattr(alone, field))
            assert float(point[name]) == pytest.approx(expected, rel=1e-9)


def test_names_units_and_labels(dataset):
    assert dataset.max_normal_force_N.attrs["units"] == "N"
    assert dataset.angle_deg.attrs["units"] == "deg"
    dense = dataset.sel(ground="dense", angle_deg=40.0, orientation_deg=0.0)
    assert float(dense.gamma_v) == 8.7
    assert json.loads(dataset.attrs["base"])["mass_kg"] == 200.0
    assert sum(json.loads(dataset.attrs["outcomes"]).values()) == 12


def test_netcdf_takes_names_of_every_script(tmp_path):
    dataset = xr.Dataset(
        {"łąka": ("скала", [1.0, 2.0], {"größe": "µm"}), "wörd": ("x", [1.5])},
        {"скала": [3.0, 4.0]},
        {"石": "rock"},
    )
    write_netcdf(tmp_path / "names.nc", dataset)
    xr.testing.assert_identical(read_netcdf(tmp_path / "names.nc"), dataset)
    # As the format has names, and other programs read them.
    assert "łąka".encode() in (tmp_path / "names.nc").read_bytes()


def test_netcdf_gives_back_what_was_written(dataset, tmp_path):
    path = tmp_path / "sweep.nc"
    write_netcdf(path, dataset)
    xr.testing.assert_identical(read_netcdf(path), dataset)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.slow
def test_other_laws_are_named_in_the_dataset():
    # Longer than wide on the ground, without which the two are one law.
    usual_base = Scene(
        Block(aspect_ratio=2.0), impact=Impact.from_degrees(orientation=90.0)
    )
    base = Scene(
        usual_base.block, Soil(hardening="HardeningPerRootArea"), usual_base.impact
    )
    axes = {"speed_mps": [14.0], "c_v": [0.5, 1.0]}
    other = sweep(base, axes)
    usual = sweep(usual_base, axes)
    assert abs(float(other.e_n[0, 0]) - float(usual.e_n[0, 0])) > 1e-3
    laws = json.loads(other.attrs["laws"])
    assert laws["hardening"].startswith("jaximpact.laws.hardening.HardeningPerRootArea")


def test_a_journal_is_taken_up(dataset, tmp_path):
    journal = tmp_path / "journal"
    seen = []
    sweep(BASE, AXES, journal=journal)
    sweep(BASE, AXES, journal=journal, progress=lambda *done: seen.append(done))
    assert seen == [(12, 12)]  # all taken over, none computed again


@pytest.mark.parametrize(
    "kind", [pd.DataFrame, lambda of: pd.DataFrame(of).to_xarray()]
)
def test_quantities_that_vary_together_may_be_a_table(dataset, kind):
    tables = AXES | {"ground": kind(AXES["ground"])}
    xr.testing.assert_identical(sweep(BASE, tables), dataset)


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ({}, "needs at least one axis"),
        ({"k_e": [1.0]}, "axis k_e is unknown; did you mean k_E"),
        ({"angle_deg": [10.0, 95.0]}, "must be in \\(-90, 90\\) deg, but holds 95"),
        ({"angle_deg": 10.0}, "must be a list of at least one number"),
        ({"angle_deg": []}, "must be a list of at least one number"),
        ({"angle_deg": ["steep"]}, "must be a number or an array of numbers"),
        ({"g": {"c_v": [1.0], "gamma_v": [1.0, 2.0]}}, "c_v 1, gamma_v 2"),
        ({"g": {"c_v": [1.0], "name": ["a", "b"]}}, "c_v 1, name 2"),
        ({"g": {"gamma": [1.0]}}, "axis g: gamma is unknown; did you mean gamma_v"),
        ({"g": {"name": ["a"]}}, "varies no quantity"),
        ({3: {"c_v": [1.0]}}, r"name of an axis must be of type str, but is 3 \(int"),
        ({"": {"c_v": [1.0]}}, "name of an axis must have a letter, but is ''"),
        ({"e_n": {"c_v": [1.0]}}, "e_n is a quantity"),
        ({"c_v": [1.0], "g": {"c_v": [1.0]}}, "c_v already varies along c_v"),
    ],
)
def test_wrong_axes_are_refused(axes, message):
    with pytest.raises(InputError, match=message):
        sweep(Scene(), axes)


def test_points_that_fail_are_named_and_nan():
    # a step size control that cannot be met
    impossible = Accuracy("impossible", 1e-300, 1e-300)
    dataset = sweep(Scene(), {"angle_deg": [0.0, 30.0]}, accuracy=impossible)
    assert set(dataset.outcome.values) == {"failed"}
    numbers = dataset.drop_vars("outcome").data_vars
    assert [n for n, of in numbers.items() if not np.all(np.isnan(of))] == ["steps"]
    assert json.loads(dataset.attrs["outcomes"]) == {"failed": 2}


@pytest.mark.parametrize("name", PARAMETRIC_SETS)
def test_parametric_sets_are_those_of_the_paper(name):
    dataset = simulate_set(name, accuracy="fast")
    assert tuple(dataset.ground.values) == GROUNDS
    base = json.loads(dataset.attrs["base"])
    assert (base["mass_kg"], base["speed_mps"], base["k_E"]) == (100.0, 14.0, 900.0)
    spans = {
        "I": {"aspect_ratio": (1.0, 4.0)},
        "II": {"aspect_ratio": (1.0, 4.0)},
        "III": {"angle_deg": (10.0, 80.0), "aspect_ratio": (1.0, 4.0)},
        "IV": {"orientation_deg": (0.0, 170.0), "aspect_ratio": (1.0, 4.0)},
        "fig13": {
            "orientation_deg": (0.0, 180.0),
            "angular_velocity_degps": (0.0, 2000.0),
        },
    }[name]
    for quantity, ends in spans.items():
        values = dataset[quantity].values
        assert (values[0], values[-1]) == ends
    assert not np.any(dataset.outcome == "failed")


def test_a_set_on_one_ground_is_that_part_of_the_whole():
    whole = simulate_set("II", accuracy="fast").sel(ground=GROUNDS[1])
    alone = sweep(*parametric_set("II", GROUNDS[1]), accuracy="fast")
    assert tuple(alone.sizes) == ("aspect_ratio",)
    xr.testing.assert_equal(alone, whole.drop_vars(["ground", "c_v", "gamma_v"]))


def test_unknown_sets_and_grounds_are_refused():
    with pytest.raises(InputError, match="did you mean 'Table 1'"):
        parametric_set("I", "table 1")
    with pytest.raises(InputError, match=r"ground must be of type str, .*ndarray"):
        parametric_set("I", np.array([1, 2]))
    with pytest.raises(InputError, match="V is no parametric set; did you mean IV"):
        parametric_set("V")


@pytest.fixture
def study(tmp_path):
    def write(text):
        path = tmp_path / "study.toml"
        path.write_text(text)
        return read_sweep_study(path)

    return write


def test_a_study_may_be_larger_than_memory_if_its_results_need_not_fit(study):
    axis = "{ from = 0.1, to = 1, count = 1000000 }"
    base, axes, _ = study(f"[axes]\nc_v = {axis}\nalpha_s = {axis}\n")
    with pytest.raises(InputError, match=r"10{12} points would take"):
        sweep(base, axes)


def test_a_study_file_gives_base_and_axes(study):
    base, axes, accuracy = study(
        """
        accuracy = "fast"
        [impact]
        speed_mps = 11
        [axes]
        angle_deg = { from = 10, to = 80, count = 8 }
        k_E = { from = 1e2, to = 1e4, count = 3, spacing = "logarithmic" }
        [axes.ground]
        name = ["dense", "loose"]
        c_v = [1.0, 0.5]
        """
    )
    assert float(base.impact.speed) == 11.0
    assert accuracy == "fast"
    np.testing.assert_allclose(axes["angle_deg"], np.arange(10.0, 81.0, 10.0))
    np.testing.assert_allclose(axes["k_E"], [1e2, 1e3, 1e4])
    assert axes["ground"] == {"name": ["dense", "loose"], "c_v": [1.0, 0.5]}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[impact]\nangle_deg = 5\n[axes]\nangle_deg = [10, 20]",
            r"key axes\.angle_deg: stands in \[impact\] too; remove one",
        ),
        (
            "angle_deg = 5\n[axes.g]\nname = ['a']\nangle_deg = [10]",
            r"key axes\.g\.angle_deg: stands before all tables too; remove one",
        ),
    ],
)
def test_a_study_says_a_quantity_once(study, text, message):
    with pytest.raises(InputError, match=message):
        study(text)


def test_an_unusual_value_of_an_axis_is_told_by_file_key_and_unit(study):
    with pytest.warns(UnusualValueWarning) as caught:
        study(
            """
            [axes]
            friction_angle_deg = [30, 0.4, 0.52]
            [axes.ground]
            name = ["soft", "hard"]
            k_E = [0.1, 900]
            """
        )
    angle, modulus = (str(warning.message) for warning in caught)
    assert "study.toml, key axes.friction_angle_deg: is 0.4 deg; usual" in angle
    assert "rad? 0.4 rad is 22.92 deg" in angle
    assert "key axes.ground.k_E: is 0.1; usual" in modulus


def test_the_shape_of_a_study_says_which_parameters_it_has(study):
    base, axes, _ = study(
        """
        [block]
        shape = "RectangularPrism"
        corner_radius_ratio = 0.2
        [axes]
        shape = ["Ellipsoid", "RectangularPrism"]
        """
    )
    assert float(base.block.corner_radius_ratio) == 0.2
    assert len(axes["shape"]) == 2


def test_a_file_that_is_no_netcdf_is_refused(tmp_path):
    path = tmp_path / "noise.nc"
    path.write_bytes(b"CDF\x02 noise, not a dataset")
    with pytest.raises(InputError, match=r"noise\.nc"):
        read_netcdf(path)
    with pytest.raises(InputError, match="No such file"):
        read_netcdf(tmp_path / "absent.nc")


def test_a_scene_may_be_given_by_its_parts():
    along = {"angle_deg": [40.0]}
    parts = (BASE.block, BASE.soil, BASE.impact)
    xr.testing.assert_identical(sweep(parts, along), sweep(BASE, along))
    xr.testing.assert_identical(sweep(Block(), along), sweep(Scene(), along))


@pytest.mark.slow
def test_histories_stand_beside_the_numbers(dataset):
    times = [0.0, 0.01, 0.1]
    axes = AXES | {"shape": ["Ellipsoid", "EllipticCylinder"]}
    told = []
    with_histories = sweep(
        BASE, axes, save_at=times, progress=lambda *done: told.append(done)
    )
    assert told[-1] == (24, 24)
    of_ellipsoids = with_histories.sel(shape="Ellipsoid").drop_vars("shape")
    xr.testing.assert_allclose(of_ellipsoids.e_n, dataset.e_n)
    assert with_histories.time.units == "s"
    force = with_histories.normal_force
    assert force.dims == (*axes, "time")
    point = dict(ground=1, angle_deg=2, orientation_deg=1, shape=1)
    alone = simulate(
        dataclasses.replace(BASE.block, shape=EllipticCylinder(aspect_ratio=1.5)),
        Soil(c_v=0.5, gamma_v=1.7),
        dataclasses.replace(
            BASE.impact, angle=np.radians(70.0), orientation=np.radians(120.0)
        ),
        save_at=times,
    )
    np.testing.assert_allclose(force.isel(point), alone.history.normal_force)
    np.testing.assert_array_equal(
        alone.to_xarray().normal_force, alone.history.normal_force
    )


@pytest.mark.parametrize(
    ("axes", "how", "message"),
    [
        ({"c_v": [1.0]}, {"save_at": [0.1], "chunks": "auto"}, "give it no chunks"),
        ({"c_v": [1.0]}, {"save_at": [[0.1], [0.2]]}, "one list of times"),
        ({"time": {"c_v": [1.0]}}, {"save_at": [0.1]}, "that of a series"),
    ],
)
def test_histories_that_cannot_be_had_are_refused(axes, how, message):
    with pytest.raises(InputError, match=message):
        sweep(BASE, axes, **how)


def test_long_names_are_names(dataset):
    """They label axes; what more there is to say is a comment."""
    for variable in dataset.variables.values():
        assert not set(",;:()") & set(variable.attrs.get("long_name", ""))
    assert dataset.orientation_deg.long_name == "orientation"
    assert dataset.outcome.comment.endswith("separating or failed")


def test_axes_of_a_set_may_be_changed():
    """Which changes no set that is asked for later."""
    before = parametric_set("I")[1]
    _, axes = parametric_set("I")
    axes["aspect_ratio"] = [1.0]
    axes["ground"]["c_v"][0] = 9.0
    after = parametric_set("I")[1]
    np.testing.assert_array_equal(after["aspect_ratio"], before["aspect_ratio"])
    assert after["ground"]["c_v"][0] == 1.0


def test_no_times_and_one_shape_are_axes_too():
    assert sweep(Scene(), {"angle_deg": [1.0]}, save_at=[]).sizes["time"] == 0
    result = simulate(Block(mass=[1.0, 2.0]), Soil(), Impact(), save_at=[])
    assert dict(result.to_xarray().sizes) == {"scene": 2, "time": 0}
    alike = sweep(Scene(), {"case": {"name": ["a", "b"], "shape": ["Ellipsoid"] * 2}})
    assert float(np.ptp(alike.e_n.values)) == 0.0

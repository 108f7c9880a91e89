"""Ground that differs from block to block, and roughness."""

import dataclasses
import json

import numpy as np
import pytest
from runout_scenes import BIPLANAR, LAWS, assert_same_bits, blocks_over, pieces_of
from slope_study import slope_text

from jaximpact import Block, ConstantCoefficients, Soil, read_netcdf
from jaximpact.cli import main
from jaximpact.runout import (
    ClosedForm,
    Ending,
    FullModel,
    Ground,
    MotionMode,
    Profile,
    Release,
    read_slope_study,
    simulate_runout,
)
from jaximpact.runout.blocks import select
from jaximpact.runout.flight.placement import lying_height
from jaximpact.runout.random_inputs import philox
from jaximpact.runout.study.drawing import drawn_grounds
from jaximpact.runout.study.report_page import _grounds

ELASTIC = ClosedForm(ConstantCoefficients(1.0, 1.0))
HILLS = Profile([0.0, 40.0, 60.0, 110.0, 300.0], [70.0, 40.0, 42.0, 0.0, 0.0])


def rough(profile, degrees):
    return dataclasses.replace(profile, roughness=np.radians(degrees))


def dropped(count, speed, roughness):
    """Contacts of spheres that fall on a flat, each with one facet."""
    flat = Profile([-1e4, 1e4], [0.0, 0.0])
    release = Release(Block(), np.zeros(count), 50.0, 0.0, -speed)
    ground = Ground(roughness=roughness)
    runs = simulate_runout(flat, release, ELASTIC, ground=ground, event_limit=1)
    assert set(runs.ending) == {Ending.event_limit}
    return runs.contacts


@pytest.mark.parametrize(
    ("words", "key", "known"),
    [
        ("0 0 0 0", "0 0", "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
        (
            "ffffffff ffffffff ffffffff ffffffff",
            *("ffffffff ffffffff", "408f276d 41c83b0e a20bc7c6 6d5451fd"),
        ),
        (
            "243f6a88 85a308d3 13198a2e 03707344",
            *("a4093822 299f31d0", "d16cfe09 94fdcceb 5001e420 24126ea1"),
        ),
    ],
)
def test_philox_gives_the_known_answers_of_its_authors(words, key, known):
    words, key, known = ([int(x, 16) for x in s.split()] for s in (words, key, known))
    found = philox([np.array([word]) for word in words], tuple(key))
    assert [int(word[0]) for word in found] == known


def test_facets_are_normal_and_cut():
    deviation = np.radians(10.0)
    slope = dropped(20_000, 20.0, deviation).slope
    # What cutting at 3 leaves of the variance.
    left = 1.0 - 6.0 * np.exp(-4.5) / np.sqrt(2.0 * np.pi) / 0.9973002
    # Five standard errors.
    assert np.mean(slope) == pytest.approx(0.0, abs=5.0 * deviation / 141.0)
    assert np.std(slope) == pytest.approx(
        deviation * np.sqrt(left), abs=5.0 * deviation / 200.0
    )
    assert 2.8 * deviation < np.max(np.abs(slope)) <= 3.0 * deviation


def test_an_elastic_sphere_is_mirrored_at_the_facet():
    contacts = dropped(200, 20.0, np.radians(8.0))
    into = contacts.normal_velocity_before
    speed = np.hypot(into, contacts.tangential_velocity_before)
    # It comes straight down, and goes at twice the facet's angle.
    np.testing.assert_allclose(into, speed * np.cos(contacts.slope), rtol=1e-12)
    up = -contacts.normal_velocity * np.cos(contacts.slope)
    up -= contacts.tangential_velocity * np.sin(contacts.slope)
    # The gap at touch, 1e-9 of the block, is climbed as well.
    np.testing.assert_allclose(up, speed * np.cos(2.0 * contacts.slope), rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("contacts", [ClosedForm(LAWS[0]), FullModel("fast")])
def test_no_roughness_is_as_if_there_were_none(contacts):
    release = blocks_over(HILLS, np.random.default_rng(1), 20)
    plain = simulate_runout(HILLS, release, contacts, time_limit=20.0)
    ground = Ground(HILLS.soil, HILLS.rolling_friction_angle, 0.0, seed=5)
    same = simulate_runout(HILLS, release, contacts, ground=ground, time_limit=20.0)
    assert_same_bits(plain, same)


@pytest.mark.parametrize("contacts", [ClosedForm(LAWS[4]), FullModel("fast")])
def test_no_block_is_sent_into_the_ground(contacts):
    """On one plane, where nothing else is in the way."""
    angle = np.radians(25.0)
    plane = Profile([0.0, 300.0], [140.0, 140.0 - 300.0 * np.tan(angle)])
    plane = rough(plane, 10.0)
    release = blocks_over(plane, np.random.default_rng(1), 40)
    runs = simulate_runout(plane, release, contacts, time_limit=6.0)
    assert np.max(np.abs(runs.contacts.slope - angle)) > np.radians(20.0)
    p = pieces_of(runs, MotionMode.flight)
    outline = select(release.outline, p.trajectory)
    lowest = lying_height(plane, outline, p.x, p.orientation)
    # Touches may be early by 1e-9 of the block, and are of 0.1 to 1 m.
    assert np.min(p.y - lowest) > -1e-8


def test_facets_depend_on_seed_block_and_impact_alone():
    profile = rough(HILLS, 8.0)
    release, law = (
        blocks_over(profile, np.random.default_rng(1), 60),
        ClosedForm(LAWS[3]),
    )
    ground = Ground.of_profile(profile, seed=3)
    whole = simulate_runout(profile, release, law, ground=ground)
    assert_same_bits(
        simulate_runout(profile, release, law, ground=ground, width=7), whole
    )
    chosen = np.array([5, 17, 40])
    some, again = release.of_blocks(chosen), ground.of_blocks(np.arange(60))
    part = simulate_runout(profile, some, law, ground=again.of_blocks(chosen))
    np.testing.assert_array_equal(part.x, whole.x[chosen])
    other = dataclasses.replace(ground, seed=4)
    other = simulate_runout(profile, release, law, ground=other)
    first, other_first = (
        runs.contacts.slope[np.searchsorted(runs.contacts.trajectory, np.arange(60))]
        for runs in (whole, other)
    )
    assert not np.any(first == other_first)


@pytest.mark.parametrize("rates", [(2.0, 8.7, 30.0), (30.0, 8.7, 2.0)])
def test_each_block_has_its_soil(rates):
    """As if it went alone over a slope of that soil, whichever block ends first."""
    soils = Soil(gamma_v=np.array(rates)[:, None], c_v=np.array([1.0, 0.4]))
    rolling = np.radians([[10.0], [20.0], [30.0]])
    release = Release(Block(), [2.0, 2.0, 2.0], 232.0, 15.0)
    law = FullModel("fast")
    runs = simulate_runout(BIPLANAR, release, law, ground=Ground(soils, rolling))
    assert len(set(runs.x)) == 3
    for i, gamma_v in enumerate(rates):
        profile = Profile(
            BIPLANAR.x, BIPLANAR.y, Soil(gamma_v=gamma_v, c_v=[1.0, 0.4]), rolling[i]
        )
        alone = simulate_runout(profile, Release(Block(), 2.0, 232.0, 15.0), law)
        assert alone.x == runs.x[i]
        assert alone.time == runs.time[i]


def test_a_ground_of_other_blocks_is_refused():
    release = Release(Block(), [2.0, 3.0, 4.0], 233.0)
    ground = Ground(Soil(c_v=np.ones((2, 1))))
    with pytest.raises(ValueError, match="3 blocks and 2 segments, but one has shape"):
        simulate_runout(BIPLANAR, release, ELASTIC, ground=ground)
    with pytest.raises(ValueError, match="a ground's roughness_deg must be in"):
        Ground(roughness=1.0)


SLOPE = slope_text(
    top="count = 40\nseed = 7\ncollectors_m = [60]\nbins = 10",
    ground="[ground]\nc_v = 0.5\nroughness_deg = 4\n[ground.segment.2]\nk_E = 700",
    block="mass_kg = { mean = 100, sd = 30, least = 20 }",
)


def test_ground_samples_change_no_other_number(slope, changed):
    plain = read_slope_study(slope)
    varied = read_slope_study(
        changed(
            ("c_v = 0.5", "c_v = { mean = 0.5, sd = 0.1, least = 0 }"),
            ("k_E = 700", "k_E = [600, 700, 800]\nrolling_friction_angle_deg = 9"),
            ("roughness_deg = 4", "roughness_deg = { from = 2, to = 6 }"),
        )
    )
    np.testing.assert_array_equal(plain.release.x, varied.release.x)
    np.testing.assert_array_equal(plain.release.block.mass, varied.release.block.mass)
    drawn, ground = varied.inputs.ground_samples, varied.ground
    assert set(drawn) == {"c_v", "roughness_deg", "segment.2.k_E"}
    assert len(set(drawn["c_v"])) == 40
    np.testing.assert_array_equal(ground.soil.c_v, drawn["c_v"][:, None])
    np.testing.assert_array_equal(drawn["segment.2.k_E"][:4], [600, 700, 800, 600])
    np.testing.assert_array_equal(ground.soil.k_E[:, 1], drawn["segment.2.k_E"])
    np.testing.assert_array_equal(ground.soil.k_E[:, [0, 2]], 900.0)
    rolling = np.degrees(ground.rolling_friction_angle)
    np.testing.assert_allclose(rolling, [20.0, 9.0, 20.0])
    roughness = np.degrees(ground.roughness[:, 0])
    np.testing.assert_allclose(roughness, drawn["roughness_deg"])
    assert 2.0 <= roughness.min() < roughness.max() <= 6.0


def test_a_segment_has_its_own_beside_samples(changed):
    samples = ("c_v = 0.5", "c_v = { from = 0.4, to = 0.6 }")
    study = read_slope_study(changed(samples, ("k_E = 700", "c_v = 0.9")))
    c_v = study.ground.soil.c_v
    np.testing.assert_array_equal(c_v[:, 1], 0.9)
    np.testing.assert_array_equal(c_v[:, 2], study.inputs.ground_samples["c_v"])
    assert _grounds(study).rows == [
        ("0", "50", "c_v random"),
        ("50", "80", "c_v = 0.9"),
        ("80", "200", "c_v random"),
    ]
    inputs = study.inputs
    drawn = drawn_grounds(study.profile, inputs.materials, inputs.random_ground)
    assert drawn.words == ["c_v random", "c_v = 0.9"]


def test_roughness_alone_is_chance(slope, changed):
    changed(
        ("count = 40\n", ""),
        ("{ mean = 100, sd = 30, least = 20 }", "100"),
        ("{ from = 2, to = 6 }", "3"),
    )
    assert read_slope_study(slope).release.count == 1000
    slope.write_text(slope.read_text().replace("roughness_deg = 4", ""))
    assert read_slope_study(slope).release.count == 1


@pytest.mark.slow
def test_a_block_can_be_repeated(changed, tmp_path):
    """From what the dataset holds and the seed."""
    changed(("c_v = 0.5", "c_v = { mean = 0.5, sd = 0.1, least = 0 }"))
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    dataset = read_netcdf(tmp_path / "out" / "blocks.nc")
    assert dataset.ground_c_v.attrs["units"] == "-"
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert manifest["ground"]["c_v"] == {"mean": 0.5, "sd": 0.1, "least": 0}
    assert manifest["ground"]["roughness_deg"] == 4
    study, block = read_slope_study("slope.toml"), dataset.isel(block=17)
    release = (block[f"release_{name}"].values for name in ("x_m", "y_m", "v_x_mps"))
    ground = Ground(
        dataclasses.replace(study.profile.soil, c_v=block.ground_c_v.values),
        *(study.profile.rolling_friction_angle, np.radians(4.0)),
        seed=7,
        numbers=np.array([17]),
    )
    alone = simulate_runout(
        study.profile,
        Release(Block(mass=block.mass_kg.values), *release),
        study.law.contacts,
        ground=ground,
    )
    assert alone.x == block.x_m.values


def test_a_column_of_the_profile_is_roughness(changed, tmp_path):
    (tmp_path / "p.csv").write_text("x_m,y_m,roughness_deg\n0,50,2\n80,0,0\n200,0,0\n")
    points = "points_m = [[0, 50], [50, 20], [80, 0], [200, 0]]"
    of_all = "roughness_deg = 4\n", ""
    study = read_slope_study(changed((points, 'csv = "p.csv"'), of_all))
    np.testing.assert_allclose(np.degrees(study.profile.roughness), [2.0, 0.0])

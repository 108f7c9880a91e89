"""Tables of the model's impacts: exact at their nodes, sharp at jumps, true in a
run-out."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from runout_scenes import BIPLANAR, assert_no_energy_gained, assert_same_bits
from text_files import rows_of

from jaximpact import Block, Impact, Outcome, Soil, simulate
from jaximpact.errors import InputError
from jaximpact.io.datasets import read_netcdf, write_netcdf
from jaximpact.lookup import (
    Nodes,
    Tabulated,
    measure_error,
    random_impacts,
    read_table,
    tabulate,
    write_csv,
    write_table,
)
from jaximpact.lookup.table import (
    Direction,
    direction_of,
    impact_from,
    look_up_many,
    slip_factor_of,
)
from jaximpact.lookup.table_files import DIMENSIONS
from jaximpact.lookup.tabulation import axes_of, compute
from jaximpact.runout import FullModel, Profile, Release, simulate_runout

SPHERE, ELONGATED = Block(), Block(aspect_ratio=2.0)
STEEP = float(np.arctan2(230.0, 400.0))
MANY = 10_000
"""As many impacts as `tabulate` looks up: for another number XLA compiles again."""
COARSE = Nodes(4, 6, 9)
"""Of tables with as many nodes, too, the lookup is compiled once."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def of_sphere():
    return tabulate(SPHERE, slopes=[0.0, STEEP], nodes=Nodes(10, 16, 25))


@pytest.fixture(scope="module")
def of_elongated():
    slopes = np.radians(np.linspace(-89.0, 89.0, 5))
    return tabulate(ELONGATED, slopes=slopes, nodes=Nodes(5, 6, 9, 5))


def impacts_at(table, places):
    """Impacts at nodes of a table."""
    axes = axes_of(table)
    speed, elevation, azimuth, orientation, slope = (
        axis[place] for axis, place in zip(axes, places, strict=True)
    )
    return impact_from(
        table.block,
        Direction(speed, elevation, azimuth),
        orientation,
        slope,
        slip_factor_of(table.outcomes.shape[3]),
    )


@pytest.mark.parametrize("aspect_ratio", [0.5, 1.0, 3.0])
def test_coordinates_are_taken_there_and_back(aspect_ratio):
    generator = np.random.default_rng(1)
    block = Block(aspect_ratio=aspect_ratio)
    n = 1000
    there = Direction(
        generator.uniform(0.01, 100.0, n),
        generator.uniform(0.001, 0.5 * np.pi - 0.001, n),
        generator.uniform(-np.pi, np.pi, n),
    )
    impact = impact_from(block, there, generator.uniform(0.0, 7.0, n), 0.3)
    for back, value in zip(direction_of(block, impact), there, strict=True):
        # The slip is a difference of velocities that are larger.
        np.testing.assert_allclose(back, value, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("which", ["of_sphere", "of_elongated"])
def test_at_its_nodes_a_table_is_the_model(which, request):
    table = request.getfixturevalue(which)
    generator = np.random.default_rng(2)
    places = [generator.integers(0, n, MANY) for n in table.outcomes.shape]
    # At the pole azimuths are one.
    places[1] = generator.integers(0, table.outcomes.shape[1] - 1, MANY)
    impact = impacts_at(table, places)
    blows = compute(table.block, table.soil, impact, "fast")
    entry = look_up_many(table, impact)
    same = np.asarray(entry.outcome) == blows.outcome
    assert np.mean(same) > 0.99
    assert len(set(blows.outcome[same])) > 1
    size = np.asarray(direction_of(table.block, impact).total_speed)[same]
    for found, model in zip(entry[:-1], blows.response, strict=True):
        error = np.abs(np.asarray(found)[same] - model[same])
        error /= 1.0 + size + np.abs(model[same])
        # Coordinates to rounding; and by rounding the model may take another step,
        # which changes it within its tolerance: more often on faces of 89 degrees.
        assert np.median(error) < 1e-9
        assert np.quantile(error, 0.95) < 1e-5
        assert np.max(error) < 1e-2
    if which == "of_sphere":
        error = measure_error(table, impact)
        level = dataclasses.replace(impact, slope=np.zeros(MANY))
        scalar = dataclasses.replace(impact, slope=0.0)
        assert measure_error(table, scalar) == measure_error(table, level)
        assert error.impacts == np.sum(blows.outcome != Outcome.failed)
        assert error.of_90_percent < 1e-6
        assert error.energy == pytest.approx(error.energy_of_model, rel=1e-3)
        shifted = dataclasses.replace(table, entries=table.entries + 0.1)
        assert measure_error(shifted, impact).median > 0.05


def test_the_law_is_called_with_scalars_and_agrees_with_simulate(of_sphere):
    """At a node, so that only the accuracies differ."""
    impact = impacts_at(of_sphere, [6, 9, 5, 0, 1])
    scalar = jax.tree.map(jnp.asarray, impact)
    after = of_sphere(SPHERE, scalar)
    result = simulate(SPHERE, Soil(), scalar, accuracy="reference")
    for name, value in after._asdict().items():
        assert float(value) == pytest.approx(float(getattr(result, name)), rel=1e-3)


def test_more_nodes_bring_a_table_nearer(of_sphere):
    coarse = tabulate(SPHERE, slopes=[0.0, STEEP], nodes=COARSE)
    assert of_sphere.error.median < 0.7 * coarse.error.median
    assert of_sphere.error.of_90_percent < coarse.error.of_90_percent
    assert of_sphere.error.wrong_outcomes < coarse.error.wrong_outcomes


def test_where_outcomes_meet_nothing_is_mixed(of_sphere):
    """A made-up table that is 1 for one outcome and 2 for another."""
    generator = np.random.default_rng(4)
    codes = generator.integers(0, 2, of_sphere.outcomes.shape)
    table = dataclasses.replace(
        of_sphere,
        outcomes=jnp.asarray(codes),
        entries=jnp.broadcast_to(1.0 + codes[..., None], of_sphere.entries.shape),
    )
    entry = look_up_many(table, random_impacts(table, MANY))
    np.testing.assert_allclose(entry.duration, 1.0 + np.asarray(entry.outcome))
    assert set(np.asarray(entry.outcome)) == {0, 1}


def test_a_block_looks_the_same_after_half_a_turn(of_elongated):
    impact = random_impacts(of_elongated, MANY)
    turned = dataclasses.replace(impact, orientation=impact.orientation + np.pi)
    one, other = look_up_many(of_elongated, impact), look_up_many(of_elongated, turned)
    same = np.asarray(one.outcome) == np.asarray(other.outcome)
    assert np.mean(same) > 0.99
    # To the rounding of the angle; a jump lies between a few.
    for a, b in zip(one[:3], other[:3], strict=True):
        assert np.quantile(np.abs(a - b), 0.99) < 1e-6


def test_derivatives_are_those_of_the_table(of_sphere):
    def after(speed):
        impact = Impact(speed=speed, angle=0.7, orientation=0.4, slope=STEEP)
        return of_sphere(SPHERE, impact).tangential_velocity

    step = 1e-4
    difference = (after(13.0 + step) - after(13.0 - step)) / (2.0 * step)
    derivative = float(jax.grad(after)(13.0))
    assert derivative == pytest.approx(float(difference), rel=1e-6)


def test_beyond_the_table_impacts_fail_and_slow_ones_have_its_edge(of_sphere):
    def outcome(**values):
        entry = of_sphere.look_up(Impact(**values))
        return Outcome(int(entry.outcome)), float(entry.tangential_velocity)

    assert outcome(speed=119.0, angle=0.2)[0] != Outcome.failed
    for beyond in ({"speed": 130.0}, {"slope": STEEP + 0.01}, {"slope": -0.01}):
        code, velocity = outcome(angle=0.2, **beyond)
        assert code == Outcome.failed
        assert np.isnan(velocity)
    slow = [
        float(of_sphere.look_up(Impact(speed=v, angle=0.3)).duration)
        for v in (0.1, 0.001)
    ]
    assert slow[0] == pytest.approx(slow[1], rel=1e-9)
    away, velocity = outcome(speed=5.0, angle=2.0)
    assert away == Outcome.separating
    assert velocity == pytest.approx(5.0 * np.sin(2.0))


def released(block, count):
    generator = np.random.default_rng(5)
    height = 230.0 + float(max(block.semi_axes)) + generator.uniform(0.5, 5.0, count)
    return Release(
        block,
        np.ones(count),
        height,
        20.0 * np.cos(0.17),
        generator.uniform(-4.0, 4.0, count),
        generator.uniform(0.0, np.pi, count),
        generator.uniform(0.0, 100.0, count),
    )


def test_spheres_run_as_far_by_a_table_as_by_the_model(of_sphere):
    """Quartiles of 400 run-outs. The table is right to 1 % of the speed; they differ
    by some 100 m among themselves."""
    release = released(SPHERE, 400)
    model = simulate_runout(BIPLANAR, release, FullModel("fast"))
    table = simulate_runout(BIPLANAR, release, Tabulated(of_sphere))
    assert set(table.count_endings()) == {"stopped"}
    quartiles = [np.quantile(runs.x, [0.25, 0.5, 0.75]) for runs in (model, table)]
    np.testing.assert_allclose(*quartiles, atol=15.0)
    contacts = [len(runs.contacts.time) for runs in (model, table)]
    assert contacts[1] == pytest.approx(contacts[0], rel=0.25)


def test_interpolated_impacts_give_no_energy(of_elongated):
    """From piece to piece of run-outs by a coarse table, of blocks that tumble over
    teeth of 45 degrees. Without a limit they gain what lifts them by 0.24 m."""
    x = np.arange(0.0, 60.0, 1.5)
    profile = Profile(x, 60.0 - x + 1.5 * (np.arange(len(x)) % 2))
    generator = np.random.default_rng(6)
    release = Release(
        ELONGATED,
        np.full(200, 2.0),
        generator.uniform(63.0, 70.0, 200),
        generator.uniform(0.0, 20.0, 200),
        angular_velocity=generator.uniform(-20.0, 60.0, 200),
    )
    runs = simulate_runout(profile, release, Tabulated(of_elongated))
    assert_no_energy_gained(runs)
    assert len(runs.contacts.time) > 400


def test_a_trajectory_does_not_depend_on_the_others(of_sphere):
    release = released(SPHERE, 60)
    alone, together = (
        simulate_runout(BIPLANAR, release, Tabulated(of_sphere), width=width)
        for width in (7, 60)
    )
    assert_same_bits(alone, together)


def test_every_block_finds_its_table(of_sphere, of_elongated):
    one = Impact(speed=10.0, angle=0.5, orientation=0.3, slope=STEEP)
    impact = jax.tree.map(lambda value: np.full(4, value), one)
    block = Block(aspect_ratio=np.array([1.0, 2.0, 1.0, 2.0]))
    blows = Tabulated([of_elongated, of_sphere])(block, Soil(), impact)
    for k, table in enumerate((of_sphere, of_elongated)):
        expected = table.look_up(one)
        duration = blows.response.duration[k::2]
        np.testing.assert_allclose(duration, float(expected.duration), rtol=1e-6)
        np.testing.assert_array_equal(blows.outcome[k::2], expected.outcome)
    with pytest.raises(InputError, match="no table was made for a block of 100 kg"):
        Tabulated(of_sphere)(block, Soil(), impact)
    with pytest.raises(InputError, match="no table was made"):
        Tabulated(of_sphere)(SPHERE, Soil(gamma_v=1.7), impact)
    with pytest.raises(InputError, match="at least one table"):
        Tabulated([])


def test_a_table_is_read_as_it_was_written(of_sphere, tmp_path):
    path = tmp_path / "table.nc"
    write_table(path, of_sphere)
    read = read_table(path)
    assert read.error == of_sphere.error
    assert read.accuracy == of_sphere.accuracy
    for a, b in zip(jax.tree.leaves(read), jax.tree.leaves(of_sphere), strict=True):
        # Angles of the soil are written in degrees.
        np.testing.assert_allclose(a, b, rtol=1e-14)
    # And is known as that of the same block and ground.
    impact = jax.tree.map(lambda value: np.full(3, value), Impact(speed=9.0))
    Tabulated(read)(SPHERE, Soil(), impact)
    dataset = read_netcdf(path)
    dataset.attrs["slip_factor"] = "2.0"
    write_netcdf(path, dataset)
    with pytest.raises(InputError, match=r"another factor than \d.*; tabulate again"):
        read_table(path)
    path.write_bytes(b"nothing")
    with pytest.raises(InputError):
        read_table(path)


def test_a_table_that_another_program_wrote_is_read_as_its_axes_say(
    of_elongated, tmp_path
):
    """However they are ordered; with nodes that were left out, or turned, another value
    would stand at each node."""
    path = tmp_path / "table.nc"
    write_table(path, of_elongated)
    dataset = read_netcdf(path)
    write_netcdf(path, dataset.transpose(*reversed(DIMENSIONS)))
    read = read_table(path)
    np.testing.assert_array_equal(read.entries, of_elongated.entries)
    np.testing.assert_array_equal(read.outcomes, of_elongated.outcomes)
    write_netcdf(path, dataset.isel(slope_deg=[1, 3]))
    np.testing.assert_array_equal(
        read_table(path).entries, of_elongated.entries[..., [1, 3], :]
    )
    for name, kept in (
        ("total_speed_mps", [0, 1, 4]),
        ("total_speed_mps", [0]),
        ("elevation_deg", slice(1, None)),
        ("azimuth_deg", slice(4, None)),
        ("orientation_deg", slice(3)),
        ("slope_deg", slice(None, None, -1)),
    ):
        write_netcdf(path, dataset.isel({name: kept}))
        with pytest.raises(InputError, match=f"{name} that are not those of a table"):
            read_table(path)


def test_the_rows_for_other_programs_are_the_models_impacts(of_elongated, tmp_path):
    path = tmp_path / "table.csv"
    write_csv(path, of_elongated)
    rows = rows_of(path)
    assert len(rows) == of_elongated.outcomes.size
    assert tuple(rows[0])[:5] == DIMENSIONS
    places = np.unravel_index(1234, of_elongated.outcomes.shape)
    row = rows[1234]
    impact = impacts_at(of_elongated, [np.array([place]) for place in places])
    degree = np.pi / 180.0
    assert float(row["speed_mps"]) == pytest.approx(float(impact.speed[0]))
    assert float(row["angle_deg"]) * degree == pytest.approx(float(impact.angle[0]))
    blow = compute(ELONGATED, Soil(), impact, "fast").response
    # Coordinates by rounding, with which the model may take another step.
    assert float(row["normal_velocity_mps"]) == pytest.approx(
        blow.normal_velocity[0], rel=1e-4
    )
    assert float(row["e_t"]) == pytest.approx(
        blow.tangential_velocity[0] / float(impact.tangential_velocity[0]), rel=1e-4
    )
    assert (tmp_path / "table.csv.manifest.json").is_file()


@pytest.mark.parametrize("orientations", [1, 5])
def test_azimuths_for_other_programs_are_of_the_factor_in_the_manifest(
    of_elongated, orientations, tmp_path
):
    """Written out as the page on tables does, with r and T of the major axis along the
    normal."""
    kept = slice(orientations)
    table = dataclasses.replace(
        of_elongated,
        entries=of_elongated.entries[:, :, :, kept],
        outcomes=of_elongated.outcomes[:, :, :, kept],
    )
    write_csv(tmp_path / "table.csv", table)
    manifest = json.loads((tmp_path / "table.csv.manifest.json").read_text())
    rows = [
        row
        for row in rows_of(tmp_path / "table.csv")
        # In a vertical approach there is neither slip nor turning.
        if float(row["orientation_deg"]) == 0.0 and float(row["elevation_deg"]) < 89.0
    ]
    assert len(rows) == table.outcomes[:, :-1, :, 0].size
    columns = "speed_mps", "angle_deg", "angular_velocity_degps", "azimuth_deg"
    speed, angle, spin, alpha = (
        np.array([float(row[name]) for row in rows]) for name in columns
    )
    axes, omega = ELONGATED.semi_axes, np.radians(spin)
    slip = speed * np.sin(np.radians(angle)) - float(axes.major) * omega
    turning = omega * float(axes.minor)
    expected = np.arctan2(turning, manifest["slip_factor"] * slip)
    # From degrees and back; where nearly all is approach, slip is a small difference.
    np.testing.assert_allclose(
        np.exp(1j * np.radians(alpha)), np.exp(1j * expected), atol=1e-9
    )


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"speeds": (0.0, 10.0)}, "the last, ascending from above 0, but got"),
        ({"speeds": (5.0, 1.0)}, "speeds of a table must be the first and the last"),
        ({"speeds": (1, 2, 3)}, r"must be the first and the last, .* \[1.0, 2.0, 3.0"),
        ({"speeds": ("1", "2")}, "speeds of a table must be a number or an array of"),
        ({"slopes": ["a"]}, "slopes of a table must be a number or an array of num"),
        ({"slopes": []}, "slopes of a table must be a list that ascends"),
        ({"slopes": [0.2, 0.1]}, "slopes of a table must be a list that ascends"),
        ({"slopes": [2.0]}, r"slopes of a table must be in \(-pi/2, pi/2\)"),
        ({"nodes": Nodes(speed=1)}, "number of nodes of speed must be at least 2"),
        ({"nodes": Nodes(2.5, 2, 2, 2)}, "nodes of speed must be a whole number"),
        ({"nodes": (2, 2, 2, 2)}, "nodes must be of type Nodes, but is"),
        ({"block": Block(mass=-1.0)}, "mass"),
        ({"accuracy": "quick"}, "accuracy must be one of"),
    ],
)
def test_values_out_of_range_are_told(values, message):
    with pytest.raises(ValueError, match=message):
        tabulate(**values)


@pytest.mark.parametrize(
    ("count", "message"),
    [(-1, "must be at least 1"), (0, "must be at least 1"), (1.5, "a whole number")],
)
def test_a_count_of_random_impacts_is_a_whole_number(of_sphere, count, message):
    with pytest.raises(InputError, match=f"number of random impacts .*{message}"):
        measure_error(of_sphere, count)


@pytest.mark.parametrize(
    ("seed", "message"), [(-1, "must be at least 0"), ("a", "a whole number")]
)
def test_a_seed_of_random_impacts_is_a_whole_number(of_sphere, seed, message):
    with pytest.raises(InputError, match=f"seed of random impacts .*{message}"):
        random_impacts(of_sphere, 3, seed=seed)


def test_impacts_that_a_table_does_not_have_are_no_failures_of_the_model(of_sphere):
    fast = 2.0 * float(of_sphere.speeds[-1])
    speeds = np.append(np.full(MANY - 1, 10.0), fast)
    error = measure_error(of_sphere, Impact(speed=speeds, angle=0.3))
    assert (error.impacts, error.failed, error.without_entry) == (MANY - 1, 0, 1)
    text = dataclasses.replace(of_sphere, error=error).in_words()
    assert "0 left out, as the model failed, and 1 that the table does not have" in text
    with pytest.raises(InputError, match="there is none that the table has"):
        measure_error(of_sphere, Impact(speed=np.full(MANY, fast), angle=0.3))


def test_a_table_of_slow_impacts_alone():
    table = tabulate(SPHERE, speeds=(0.1, 0.9), slopes=[0.0, STEEP], nodes=COARSE)
    speeds = direction_of(SPHERE, random_impacts(table, 100)).total_speed
    assert np.max(speeds) <= 0.9 * (1.0 + 1e-9)
    assert table.error.impacts == MANY


def test_what_is_not_known_of_an_impact_is_not_looked_up(of_sphere):
    impact = Impact(speed=jnp.array([10.0, jnp.nan]), angle=0.1)
    entry = of_sphere.look_up(impact)
    assert int(entry.outcome[1]) == Outcome.failed
    assert np.isnan(entry.normal_velocity[1])
    assert np.isfinite(entry.normal_velocity[0])


def test_the_derivative_at_a_vertical_impact_without_spin(of_sphere):
    def after(speed, angle=0.0):
        return of_sphere(SPHERE, Impact(speed=speed, angle=angle)).normal_velocity

    step = 1e-4
    difference = (after(10.0 + step) - after(10.0 - step)) / (2.0 * step)
    assert float(jax.grad(after)(10.0)) == pytest.approx(float(difference), rel=1e-6)


def test_the_derivative_of_a_block_at_rest(of_elongated):
    """What does not close is left alone: v_n after is the speed by its cosine."""

    def after(speed):
        impact = Impact(speed=speed, angle=0.5, orientation=0.7)
        return of_elongated(ELONGATED, impact).normal_velocity

    assert float(jax.grad(after)(0.0)) == pytest.approx(np.cos(0.5), rel=1e-12)


def test_rows_do_not_replace_what_is_no_manifest(of_sphere, tmp_path):
    mine = tmp_path / "table.csv.manifest.json"
    mine.write_text("mine")
    with pytest.raises(InputError, match="no manifest says that jaximpact wrote it"):
        write_csv(tmp_path / "table.csv", of_sphere)
    assert mine.read_text() == "mine"
    assert not (tmp_path / "table.csv").exists()

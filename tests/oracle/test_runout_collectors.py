"""Passages and envelopes: against exact facts and against samples of the way."""

import dataclasses

import numpy as np
import pytest
from runout_scenes import DEAD, FLAT, SPHERE, G, R, rolling_sphere

from jaximpact import Block, FrictionalEllipsoid
from jaximpact.runout import (
    ClosedForm,
    Pieces,
    Profile,
    Release,
    Runs,
    first_passages,
    maxima_along,
    passages,
    simulate_runout,
)
from jaximpact.shapes import Ellipsoid, RectangularPrism, shape_of_each

pytestmark = pytest.mark.slow

SPACING = 2e-3
"""Between samples of a way [s]."""


@pytest.fixture(scope="module")
def runs() -> Runs:
    """Blocks of many kinds that bounce, slide and roll to and fro in a gully."""
    generator = np.random.default_rng(5)
    x = np.cumsum(np.append(0.0, generator.uniform(1.0, 8.0, 29)))
    y = 0.02 * (x - 0.6 * x[-1]) ** 2 + generator.normal(0.0, 0.4, 30)
    profile = Profile(x, y, rolling_friction_angle=generator.uniform(0.0, 0.2, 29))
    n = 24
    block = Block(
        mass=generator.uniform(20.0, 2000.0, n),
        aspect_ratio=np.where(np.arange(n) % 3, generator.uniform(0.5, 3.0, n), 1.0),
    )
    release = Release(
        block,
        generator.uniform(x[1], x[-2], n),
        y.max() + 2.0,
        generator.normal(0.0, 8.0, n),
        generator.normal(0.0, 5.0, n),
        generator.uniform(0.0, 6.0, n),
        generator.normal(0.0, 20.0, n),
    )
    law = ClosedForm(FrictionalEllipsoid(0.5, 0.6))
    # No hops are rolled: a long block that rolls to an edge begins its flight over it
    # some decimetres back, which samples would take for passages to and fro.
    return simulate_runout(profile, release, law, time_limit=20.0, hop_threshold=0.0)


def sampled(runs, trajectory):
    """Samples of a way, the last of them where the block ended."""
    path = runs.path(trajectory, SPACING)
    path["x"][-1] = runs.x[trajectory]
    return path


def test_a_projectile_passes_as_it_must():
    release = Release(SPHERE, 10.0, 50.0, 20.0, 5.0, 0.3, 4.0)
    runs = simulate_runout(FLAT, release, DEAD)
    found = passages(runs, 40.0)
    time, mass, inertia = 1.5, 100.0, float(SPHERE.inertia)
    v_y = 5.0 - G * time
    height = 50.0 + 5.0 * time - 0.5 * G * time**2
    expected = {
        "time": time,
        "v_x": 20.0,
        "v_y": v_y,
        "angular_velocity": 4.0,
        "translational_energy": 0.5 * mass * (400.0 + v_y**2),
        "rotational_energy": 0.5 * inertia * 16.0,
        "centre_height": height,
        "lowest_height": height - R,
        "speed": np.hypot(20.0, v_y),
    }
    for name, value in expected.items():
        assert getattr(found, name) == pytest.approx(value, rel=1e-12), name
    assert found.energy[0] == found.translational_energy[0] + found.rotational_energy[0]


def test_what_rolls_up_without_friction_comes_back_as_fast():
    rise, v, place = np.radians(20.0), 10.0, 2.0
    x, y = np.array([-100.0, 0.0, 300.0]), [0.0, 0.0, 300.0 * np.tan(rise)]
    profile = Profile(x, y, rolling_friction_angle=0.0)
    release = rolling_sphere(profile, place, v)
    runs = simulate_runout(profile, release, DEAD, time_limit=10.0)
    found = passages(runs, 12.0)
    assert list(np.sign(found.v_x)) == [1.0, -1.0]
    np.testing.assert_allclose(found.speed[0], found.speed[1], rtol=1e-9)
    # 10 m of x up; a sphere has I = 2/5 m R^2.
    loss = 2.0 * G * 10.0 * np.tan(rise) / 1.4
    # It touches down at once from 1e-9 of its size, which leaves 1e-5 of its speed.
    assert found.speed[0] == pytest.approx(np.sqrt(v**2 - loss), rel=1e-4)
    # The highest place it comes to is never passed again.
    top = place + v**2 * 1.4 / (2.0 * G * np.tan(rise))
    assert len(passages(runs, top + 0.01).time) == 0
    assert len(passages(runs, top - 0.01).time) == 2


def test_passages_are_those_of_samples(runs):
    inner = np.linspace(runs.profile.x[1], runs.profile.x[-2], 37)
    total = back = 0
    for x in inner:
        found = passages(runs, x)
        assert np.all(np.diff(found.trajectory) >= 0)
        for i in range(runs.release.count):
            path = sampled(runs, i)
            right = path["x"] >= x
            at = np.flatnonzero(right[1:] != right[:-1])
            mine = found.trajectory == i
            assert np.sum(mine) == len(at)
            total, back = total + len(at), back + np.sum(found.v_x[mine] < 0.0)
            # Times, by the sample before and the one after.
            assert np.all(found.time[mine] >= path["time"][at] - 1e-12)
            assert np.all(found.time[mine] <= path["time"][at + 1] + 1e-12)
            # Over a sample a velocity changes by g times its length.
            for name in ("v_x", "v_y"):
                np.testing.assert_allclose(
                    getattr(found, name)[mine], path[name][at], atol=2.0 * G * SPACING
                )
    # The gully sends many of them back.
    assert total > 100
    assert back > 20


def test_a_place_that_no_block_of_several_shapes_passes():
    shape = shape_of_each([Ellipsoid, RectangularPrism])
    release = Release(Block(mass=[100.0, 100.0], shape=shape), 0.0, 2.0, v_x=1.0)
    runs = simulate_runout(FLAT, release, DEAD)
    assert list(passages(runs, 0.1).trajectory) == [0, 1]
    found = passages(runs, 90.0)
    assert {len(values) for values in found} == {0}
    counts, first = first_passages(found, 2)
    assert list(counts) == [0, 0]
    assert np.all(np.isnan(first.energy))


def test_a_piece_that_turns_and_a_jump_between_pieces():
    """A way made by hand: it turns at t = 2 in x = 4, then jumps from -5 to -6."""
    profile = Profile([-50.0, 50.0], [0.0, 0.0])
    release = Release(SPHERE, 0.0, 1.0, 4.0)
    runs = simulate_runout(profile, release, DEAD)
    columns = {name: np.zeros(2) for name in Pieces._fields}
    columns |= {
        "time": np.array([0.0, 5.0]),
        "duration": np.array([5.0, 1.0]),
        "x": np.array([0.0, -6.0]),
        "y": np.array([1.0, 2.0]),
        "v_x": np.array([4.0, -1.0]),
        "a_x": np.array([-2.0, 0.0]),
    }
    runs = dataclasses.replace(runs, pieces=Pieces(**columns), x=np.array([-7.5]))
    there_and_back = passages(runs, 3.0)
    np.testing.assert_allclose(there_and_back.time, [1.0, 3.0], rtol=1e-14)
    np.testing.assert_allclose(there_and_back.v_x, [2.0, -2.0], rtol=1e-14)
    np.testing.assert_allclose(passages(runs, -1.0).time, 2.0 + 5.0**0.5, rtol=1e-14)
    assert list(passages(runs, 0.0).time) == [4.0]
    assert len(passages(runs, 4.1).time) == 0
    for jumped, time in ((-5.5, 5.0), (-7.2, 6.0)):
        found = passages(runs, jumped)
        assert list(found.time) == [time]
    assert passages(runs, -5.5).v_x == -6.0
    jumped_back = dataclasses.replace(runs, x=np.array([-5.6]))
    assert list(passages(jumped_back, -5.8).time) == [5.0, 6.0]
    maxima = maxima_along(runs, np.array([-10.0, -5.5, 0.0, 3.0, 10.0]))
    np.testing.assert_allclose(maxima.speed, [[1.0, 6.0, 4.0, 2.0]], rtol=1e-14)
    np.testing.assert_array_equal(maxima.height, [[2.0, 1.0, 1.0, 1.0]])


def test_first_passages_and_their_count(runs):
    x = 0.6 * runs.profile.x[-1]
    found = passages(runs, x)
    count, first = first_passages(found, runs.release.count)
    assert count.sum() == len(found.time)
    for i in range(runs.release.count):
        times = found.time[found.trajectory == i]
        assert count[i] == len(times)
        if len(times):
            assert first.time[i] == times.min()
        else:
            assert np.isnan(first.time[i])
            assert np.isnan(first.energy[i])
    assert 0 < np.sum(count == 0) < runs.release.count


def test_envelopes_are_those_of_samples(runs):
    edges = np.linspace(runs.profile.x[0], runs.profile.x[-1], 31)
    maxima = maxima_along(runs, edges)
    mass, inertia = (np.asarray(v) for v in runs.release.mass_properties)
    compared = 0
    for i in range(runs.release.count):
        path = runs.path(i, SPACING)
        height = path["y"] - runs.profile.height(path["x"])
        speed = np.hypot(path["v_x"], path["v_y"])
        energy = 0.5 * (mass[i] * speed**2 + inertia[i] * path["angular_velocity"] ** 2)
        # Samples on an edge belong to either side.
        place = np.clip(np.searchsorted(edges, path["x"]) - 1, 0, 29)
        near = np.min(np.abs(path["x"][:, None] - edges), axis=1) < 1e-9
        for b in np.unique(place[~near]):
            inside = (place == b) & ~near
            for values, samples in zip(maxima, (height, speed, energy), strict=True):
                # Samples never lie higher but for rounding, and come close: between
                # two of them a height changes by a speed, an energy by a power.
                most = samples[inside].max()
                assert values[i, b] >= most - 1e-9 * abs(most) - 1e-12
                step = SPACING * max(speed.max() * 2.0, G)
                assert values[i, b] <= most + step * (
                    1.0 if samples is not energy else mass[i] * (speed.max() + G)
                )
                compared += 1
    assert compared > 500
    assert np.any(np.isnan(maxima.speed))


def test_the_highest_point_of_a_flight_is_found_between_samples():
    release = Release(SPHERE, 100.0, 20.0, 10.0, 15.0)
    runs = simulate_runout(FLAT, release, DEAD)
    edges = np.linspace(0.0, 1000.0, 101)
    height = maxima_along(runs, edges).height[0]
    summit = 100.0 + 10.0 * 15.0 / G
    assert height[int(summit // 10.0)] == pytest.approx(
        20.0 + 15.0**2 / (2 * G), rel=1e-12
    )
    assert np.isnan(height[0])


def test_what_lies_beyond_the_outer_edges_counts_to_the_outer_bins(runs):
    """Exactly: over each segment of the profile there, as within them."""
    x = runs.profile.x
    inner = np.linspace(x[0], x[-1], 7)[2:5]
    found = maxima_along(runs, inner)
    whole = maxima_along(runs, np.array([x[0], *inner[1:-1], x[-1]]))
    for one, other in zip(found, whole, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)

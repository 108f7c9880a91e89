"""The first contact in flight, against dense sampling in time."""

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from runout_scenes import ellipse, height_over

from jaximpact.backend.simd.tables import address_of
from jaximpact.runout import Profile
from jaximpact.runout.blocks import Body, fly, select
from jaximpact.runout.flight import ground_search
from jaximpact.runout.flight.flights import follow_flights
from jaximpact.runout.flight.placement import lying_height
from jaximpact.runout.lane_programs import LaneProgram

FASTEST = np.radians(20_000.0)
AROUND = np.linspace(0.0, 2.0 * np.pi, 721)


def profile_of(generator, points):
    """A rough slope with convex and concave breaks, finer or coarser than a block."""
    steps = generator.uniform(0.05, generator.choice([0.5, 3.0]), points)
    rises = generator.normal(-0.5, generator.choice([0.1, 1.0]), points) * steps
    return Profile(np.cumsum(steps), np.cumsum(rises))


def clearance(body, outline, profile, times):
    """Least height of points on the ellipse over the ground, at many times, and least
    distance of the breaks from the ellipse, by its size."""
    now = fly(body, times[:, None])
    sin, cos = np.sin(now.orientation), np.cos(now.orientation)
    major, minor, _ = outline.axes
    along, across = major * np.cos(AROUND), minor * np.sin(AROUND)
    x = now.x + along * sin + across * cos
    y = now.y + along * cos - across * sin
    inside = (x >= profile.x[0]) & (x <= profile.x[-1])
    over = np.where(inside, y - profile.height(x), np.inf)
    d_x, d_y = profile.x - now.x, profile.y - now.y
    size = np.hypot((d_x * sin + d_y * cos) / major, (d_x * cos - d_y * sin) / minor)
    return np.min(over, axis=1), np.min(size, axis=1) - 1.0


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_the_first_contact_is_the_first(seed):
    generator = np.random.default_rng(seed)
    profile = profile_of(generator, generator.integers(2, 40))
    n = 5
    major = generator.uniform(0.1, 1.0, n)
    minor = major / generator.uniform(1.0, 5.0, n) ** generator.choice([-1.0, 1.0], n)
    outline = ellipse(major, minor)
    x = generator.uniform(profile.x[0], profile.x[-1], n)
    top = np.max(profile.y) + np.max(minor) + np.max(major)
    body = Body(
        x,
        np.full(n, top),
        generator.normal(0.0, 8.0, n),
        generator.normal(0.0, 5.0, n),
        generator.uniform(0.0, 3.0, n),
        generator.choice([0.0, 10.0, FASTEST, -FASTEST], n),
    )
    ends = follow_flights(body, outline, profile, np.full(n, 50.0))
    assert not np.any(ends.failed)
    assert np.all(ends.touched != ends.left)
    for i in range(n):
        one, shape = select(body, [i]), select(outline, [i])
        end = ends.time[i]
        times = np.concatenate(
            [np.linspace(0.0, end, 300), end - end * np.geomspace(1e-8, 0.1, 60)]
        )
        over, apart = clearance(one, shape, profile, times)
        # Touching counts from a gap of 1e-9 of the block on; `over` is in metres,
        # `apart` in parts of the block.
        assert over.min() > -5e-9 * shape.largest[0]
        assert apart.min() > -5e-9
        if ends.touched[i]:
            over, apart = clearance(one, shape, profile, np.array([end]))
            # Points on the ellipse are a 720th of a turn apart: the lowest of them lies
            # at most half of that, squared, times the radius of curvature over two
            # above the lowest point; the ground may slope by 80 degrees.
            curvature = shape.largest[0] ** 2 / min(major[i], minor[i])
            coarse = 0.5 * (np.pi / 720.0) ** 2 * curvature / np.cos(1.4)
            assert min(over[0], apart[0] * shape.largest[0]) < coarse + 1e-8


def test_a_fast_spin_is_not_tunnelled_through():
    """A slender block that turns 55 times a second, dropped on a plane: the first time
    at which its height is that of its support, found by sampling."""
    outline = ellipse(np.array([0.53]), np.array([0.13]))
    body = Body(*(np.array([v]) for v in (0.0, 3.0, 5.0, 0.0, 0.4, FASTEST)))
    ends = follow_flights(body, outline, Profile([-50, 50], [0, 0]), np.array([9.0]))
    times = np.linspace(0.0, 1.0, 4_000_001)
    now = fly(body, times)
    support = np.hypot(0.53 * np.cos(now.orientation), 0.13 * np.sin(now.orientation))
    first = times[np.argmax(now.y < support)]
    # a step of the sampling
    assert ends.time[0] == pytest.approx(first, abs=2.5e-7)


def test_a_sphere_meets_planes_and_edges_when_geometry_says():
    r = 0.2
    outline = ellipse(np.full(3, r), np.full(3, r))
    # Onto the slope of 45 degrees; onto the edge at the origin; into the corner.
    body = Body(
        np.array([-5.0, 0.0, 10.0]),
        np.array([9.0, 3.0, -6.0]),
        *np.zeros((4, 3)),
    )
    profile = Profile([-10, 0, 10, 20], [10, 0, -10, 0])
    ends = follow_flights(body, outline, profile, np.full(3, 50.0))
    slope = np.sqrt(2.0)
    falls = np.array(
        [9.0 - (5.0 + r * slope), 3.0 - r * slope, -6.0 + 10.0 - r * slope]
    )
    np.testing.assert_allclose(ends.time, np.sqrt(2.0 * falls / 9.81), rtol=1e-8)
    edge = Profile([-10, 0, 10], [-10, 0, -10])
    ends = follow_flights(
        select(body, [1]), select(outline, [1]), edge, np.array([9.0])
    )
    np.testing.assert_allclose(ends.time, np.sqrt(2.0 * (3.0 - r) / 9.81), rtol=1e-8)
    normal = ends.normal_x[0], ends.normal_y[0]
    np.testing.assert_allclose(normal, [0.0, 1.0], atol=1e-12)


@pytest.mark.slow
def test_a_line_of_many_segments_is_that_line():
    generator = np.random.default_rng(0)
    n = 50
    major = generator.uniform(0.2, 3.0, n)
    outline = ellipse(major, major / 2.0)
    body = Body(
        np.zeros(n),
        np.full(n, 6.0),
        generator.uniform(-5.0, 20.0, n),
        np.zeros(n),
        *generator.uniform(-3.0, 3.0, (2, n)),
    )
    limit = np.full(n, 50.0)
    x = np.linspace(-40.0, 160.0, 800)
    one = follow_flights(body, outline, Profile([-40, 160], [20, -80]), limit)
    many = follow_flights(body, outline, Profile(x, -0.5 * x), limit)
    assert np.all(one.touched)
    assert np.all(many.touched)
    # Both touch within 1e-9 of the block's size, at 1 m/s or more.
    np.testing.assert_allclose(one.time, many.time, atol=1e-8)
    np.testing.assert_allclose(one.normal_x, many.normal_x, atol=1e-7)
    np.testing.assert_allclose(one.normal_y, many.normal_y, atol=1e-7)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_nothing_is_reached_before_its_time(seed):
    """By a sphere, whose distance from each segment is exact: of all segments, and of
    the one touched at its end."""
    generator = np.random.default_rng(seed)
    profile = profile_of(generator, 12)
    n = 5
    r = generator.uniform(0.1, 2.0, n)
    outline = ellipse(r, r)
    x = generator.uniform(profile.x[0], profile.x[-1], n)
    body = Body(
        x,
        lying_height(profile, outline, x, np.zeros(n))
        + generator.uniform(0.0, 4.0, n) * generator.choice([0.0, 1.0], n),
        generator.choice([0.0, 1.0, -9.0], n),
        generator.normal(0.0, 5.0, n),
        *np.zeros((2, n)),
    )
    ends = follow_flights(body, outline, profile, np.full(n, 5.0))
    for lane in range(n):
        times = np.linspace(0.0, ends.time[lane], 2001)
        path = fly(select(body, [lane]), times)
        distance = height_over(path.x, path.y, profile)
        assert np.min(distance) > r[lane] * (1.0 - 3e-9)
        if ends.touched[lane] and ends.time[lane] > 0.0:
            assert distance[-1] == pytest.approx(r[lane], rel=1e-11)


@pytest.mark.parametrize("points", [3, 12, 60, 300])
def test_a_flight_over_the_mirrored_ground_takes_as_long(points):
    """To rounding, however the search comes to the contact: far below the gap within
    which a block touches."""
    for seed in range(5):
        generator = np.random.default_rng(seed)
        profile = profile_of(generator, points)
        back = Profile(-profile.x[::-1], profile.y[::-1])
        n = 20
        major = generator.uniform(0.1, 1.0, n)
        outline = ellipse(major, major / generator.uniform(1.0, 4.0, n))
        body = Body(
            generator.uniform(profile.x[0], profile.x[-1], n),
            np.full(n, np.max(profile.y) + 2.0),
            generator.normal(0.0, 8.0, n),
            generator.normal(0.0, 3.0, n),
            *generator.normal(0.0, 3.0, (2, n)),
        )
        turned = Body(-body.x, body.y, -body.v_x, body.v_y, *(-v for v in body[4:]))
        limit = np.full(n, 50.0)
        there = follow_flights(body, outline, profile, limit)
        again = follow_flights(turned, outline, back, limit)
        np.testing.assert_array_equal(there.touched, again.touched)
        np.testing.assert_allclose(there.time, again.time, rtol=0.0, atol=1e-13)
        np.testing.assert_allclose(there.normal_x, -again.normal_x, atol=1e-12)
        np.testing.assert_allclose(there.gap, 0.0, atol=1e-13)


def test_a_block_that_climbs_out_of_the_ground_comes_down_on_it():
    """Not into the depth at which it started."""
    profile = Profile([-50.0, 0.0, 50.0], [0.0, 0.0, 20.0])
    outline = ellipse(np.array([0.6, 0.6]), np.array([0.3, 0.3]))
    still = np.zeros(2)
    spin = np.array([0.5, -3.0])
    body = Body(still - 10.0, still + 0.2, still, still + 8.0, still, spin)
    ends = follow_flights(body, outline, profile, np.full(2, 10.0))
    assert np.all(ends.touched)
    np.testing.assert_allclose(ends.gap, 0.0, atol=1e-8)
    for i in range(2):
        one, shape = select(body, [i]), select(outline, [i])
        over, _ = clearance(one, shape, profile, ends.time[[i]])
        # Points on the ellipse lie within 1 - cos(pi / 720) of its lowest one.
        np.testing.assert_allclose(over, 0.0, atol=1e-5)


def test_a_search_that_runs_out_of_steps_says_so(monkeypatch):
    monkeypatch.setattr(ground_search, "MAX_STEPS", 2)
    # A function of its own: JAX keeps what it has traced by the function.
    impatient = LaneProgram(
        ground_search.begin, lambda w: ground_search.step(w), ground_search.finish
    )
    body = Body(*(np.array([v]) for v in (0.0, 3.0, 5.0, 0.0, 0.4, FASTEST)))
    outline = ellipse(np.array([0.53]), np.array([0.13]))
    covers = Profile([-50.0, 50.0], [0.0, 0.0]).covers
    found = impatient(body, outline, address_of(covers), 50.0, 1e3)
    assert found.given_up[0] == 1.0
    assert found.touched[0] == 0.0


def test_machine_code_does_what_the_functions_say():
    body = Body(*(np.array([v]) for v in (0.0, 3.0, 5.0, 0.0, 0.4, 40.0)))
    outline = ellipse(np.array([0.5]), np.array([0.2]))
    # Of two covers, so that the search goes through a tree.
    profile = Profile(np.linspace(-50.0, 50.0, 7), np.linspace(0.0, -20.0, 7))
    address = np.array([address_of(profile.covers)])
    inputs = body, outline, address, np.array([50.0]), np.array([1e3])
    found = ground_search.first_contact(*inputs)
    inputs = jax.tree.map(jax.numpy.asarray, inputs)
    search, going = ground_search.begin(*inputs), True
    while going:
        search, going = ground_search.step(search)
    assert found.touched[0] == 1.0
    # One unit in the last place of a sine, some steps long.
    expected = ground_search.finish(inputs, search)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9)

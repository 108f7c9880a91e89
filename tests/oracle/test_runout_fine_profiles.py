"""Blocks over profiles whose segments are short against them, against searches of every
segment, and against exact solutions."""

import numpy as np
import pytest
from runout_scenes import ellipse, height_over

from jaximpact import Block
from jaximpact.backend.simd.tables import address_of
from jaximpact.runout import Profile, Release
from jaximpact.runout.blocks import Body, fly, select
from jaximpact.runout.contacts.impact import free_fraction
from jaximpact.runout.covers import cover_table
from jaximpact.runout.flight.flights import follow_flights
from jaximpact.runout.flight.ground_search import first_contact
from jaximpact.runout.flight.placement import check_release, lying_height
from jaximpact.shapes import Ellipsoid, RectangularPrism

SHAPES = (
    *(Ellipsoid(aspect_ratio=ratio) for ratio in (1.0, 2.0, 4.0)),
    RectangularPrism(aspect_ratio=1.7),
    RectangularPrism(corner_radius_ratio=0.1),
)
LONG = 600.0
R = 1.3


def shape_name(shape):
    return f"{type(shape).__name__}-{float(shape.aspect_ratio):g}"


def measured(generator, segments):
    """A slope measured every 0.02 to 1 m, with noise, and with steps of up to 6 m."""
    steps = np.full(segments, np.exp(generator.uniform(np.log(0.02), 0.0)))
    noise = generator.choice([0.0, 0.05, 0.5, 2.0]) * generator.normal(size=segments)
    rises = steps * (generator.normal(-0.5, 0.3) + noise)
    walls = generator.choice(segments, segments // 50, replace=False)
    steps[walls], rises[walls] = 0.01, generator.normal(0.0, 3.0, len(walls))
    return Profile(*(np.cumsum([0.0, *column]) for column in (steps, rises)))


def flights_over(generator, profile, shape, count=12):
    """Blocks of 1 kg to 50 t that touch the ground, or begin in it, or above it."""
    mass = np.exp(generator.uniform(0.0, np.log(50e3), count))
    x = generator.uniform(profile.x[0], profile.x[-1], count)
    spin = generator.normal(0.0, 5.0, count) * generator.choice([0, 1, 20], count)
    release = Release(
        *(Block(mass=mass, shape=shape), x, 0.0),
        generator.normal(0.0, 8.0, count) * generator.choice([0, 1, 1], count),
        generator.normal(0.0, 5.0, count),
        generator.uniform(0.0, 3.0, count),
        spin,
    )
    around = np.linspace(-1.0, 1.0, 400)[:, None] * release.outline.largest
    y = np.max(profile.height(x + around), axis=0)
    over = generator.choice([0.3, 1.0, 1.001, 1.5], count, p=[0.1, 0.3, 0.3, 0.3])
    body = release.body._replace(y=y + over * release.outline.largest)
    return body, release.outline


def by_every_segment(body, outline, profile):
    """Times of the first contacts, inf for none, of searches of each segment alone."""
    count, segments = len(body.x), profile.segments
    lane, i = np.divmod(np.arange(count * segments), segments)
    x, y = profile.x, profile.y
    size = np.max(np.abs([x, y])) + np.abs(body.y)
    border = np.where(body.v_x > 0.0, x[-1], x[0]) - body.x
    still = body.v_x == 0.0
    leaves = np.where(still, LONG, border / np.where(still, 1.0, body.v_x))
    # The tree of a profile of one segment is that segment.
    trees = [cover_table(x[j : j + 2], y[j : j + 2]) for j in range(segments)]
    addresses = np.array([address_of(tree) for tree in trees])
    found = first_contact(
        *(select(body, lane), select(outline, lane), addresses[i]),
        *(size[lane], leaves[lane]),
    )
    times = np.where(found.touched > 0.0, found.time, np.inf)
    return np.min(times.reshape(count, segments), axis=1)


@pytest.mark.parametrize("shape", SHAPES, ids=shape_name)
@pytest.mark.parametrize("segments", [300, 60])
def test_the_first_contact_is_that_of_every_segment(shape, segments):
    """A profile of few segments too, if they are short against the block."""
    for seed in range(6):
        generator = np.random.default_rng(seed)
        profile = measured(generator, segments)
        body, outline = flights_over(generator, profile, shape)
        ends = follow_flights(body, outline, profile, np.full(len(body.x), LONG))
        assert not np.any(ends.failed)
        first = by_every_segment(body, outline, profile)
        np.testing.assert_array_equal(ends.touched, np.isfinite(first))
        # Both touch within 1e-9 of the block, of up to 5 m, at 0.05 m/s or more.
        touched = ends.touched
        np.testing.assert_allclose(ends.time[touched], first[touched], atol=1e-7)


def test_no_sphere_comes_through_the_ground():
    for seed in range(6):
        generator = np.random.default_rng(seed)
        profile = measured(generator, 400)
        body, outline = flights_over(generator, profile, SHAPES[0], 10)
        above = height_over(body.x, body.y, profile) >= outline.largest
        ends = follow_flights(body, outline, profile, np.full(10, LONG))
        for lane in np.flatnonzero(above & (ends.touched | ends.left)):
            end = min(float(ends.time[lane]), 20.0)
            times = np.concatenate(
                [np.linspace(0.0, end, 300), end - end * np.geomspace(1e-6, 0.1, 50)]
            )
            way = fly(select(body, [lane]), times)
            nearest = height_over(way.x, way.y, profile)
            # A touch counts from a gap of 1e-9 of the radius on, and may be late so.
            assert np.min(nearest) > outline.largest[lane] * (1.0 - 3e-9)


@pytest.mark.parametrize("shape", SHAPES[1:4], ids=shape_name)
def test_a_flight_does_not_depend_on_the_others(shape):
    generator = np.random.default_rng(3)
    profile = measured(generator, 500)
    body, outline = flights_over(generator, profile, shape, 30)
    limit = np.full(30, LONG)
    together = follow_flights(body, outline, profile, limit)
    for lanes in ([7], [29, 3, 11], np.arange(30)[::-1]):
        some = select(body, lanes), select(outline, lanes)
        alone = follow_flights(*some, profile, limit[lanes])
        for column, expected in zip(alone, together, strict=True):
            np.testing.assert_array_equal(column, expected[lanes])


def cut(profile, pieces):
    """The same ground with each segment in so many pieces."""
    place = np.arange(profile.segments * pieces + 1) / pieces
    x = np.interp(place, np.arange(profile.segments + 1), profile.x)
    return Profile(x, profile.height(x))


@pytest.mark.parametrize("pieces", [1, 4, 1500])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_contact_ends_at_the_foot_of_a_rise(pieces, side):
    """A sphere that moves along level ground stops where it touches the rise of
    45 degrees."""
    points = np.array([[0.0, 0.0], [60.0, 0.0], [80.0, 20.0]])
    if side < 0.0:
        points = (points * [-1.0, 1.0])[::-1]
    profile = cut(Profile(*points.T), pieces)
    x, travel = np.array([56.0, 59.0, 20.0, 56.0]), np.array([8.0, 9.0, 5.0, 0.0])
    outline = ellipse(np.full(4, R), np.full(4, R))
    zero = np.zeros(4)
    x = side * x
    body = Body(x, zero + R, zero, zero, zero, zero)
    segment = np.searchsorted(profile.x, x) - 1
    free = free_fraction(
        *(profile, segment, body, outline, x, zero + R, zero),
        (side * travel, zero),
    )
    stop = 60.0 + R * (1.0 - np.sqrt(2.0))
    expected = [(stop - 56.0) / 8.0, (stop - 59.0) / 9.0, 1.0, 1.0]
    # Heights are interpolated, with the rounding of 20 m.
    np.testing.assert_allclose(free, expected, atol=1e-12)


@pytest.mark.parametrize("pieces", [1, 3000])
def test_a_block_lies_on_what_is_highest_under_it(pieces):
    """On level ground, and on a spike of 0.4 m that is in reach or not."""
    level = cut(Profile([0.0, 100.0], [0.0, 0.0]), pieces)
    spike = np.array([[49.9, 0.0], [50.0, 0.4], [50.1, 0.0]])
    beside = (level.x < 49.9) | (level.x > 50.1)
    points = np.concatenate([np.stack([level.x, level.y], axis=1)[beside], spike])
    profile = Profile(*points[np.argsort(points[:, 0])].T)
    x = np.array([20.0, 49.5, 50.0, 51.0])
    outline = ellipse(np.full(4, R), np.full(4, R))
    y = lying_height(profile, outline, x, np.zeros(4))
    over_spike = 0.4 + np.sqrt(R**2 - (x[1:] - 50.0) ** 2)
    np.testing.assert_allclose(y, [R, *np.maximum(R, over_spike)], atol=1e-12)


@pytest.mark.parametrize("shape", SHAPES, ids=shape_name)
def test_a_block_must_not_be_released_in_fine_ground(shape):
    """Below the height at which it lies, by more than rounding."""
    generator = np.random.default_rng(2)
    profile = measured(generator, 900)
    mass = np.geomspace(1.0, 50e3, 9)
    turned = generator.uniform(0.0, 3.0, 9)
    span = profile.x[-1] - profile.x[0]
    x = profile.x[0] + span * generator.uniform(0.2, 0.8, 9)
    block = Block(mass=mass, shape=shape)
    outline = Release(block, x, 0.0).outline
    y = lying_height(profile, outline, x, turned)
    # So much higher that depths, of up to 1e-6 of the block, are below that.
    check_release(Release(block, x, y + 1e-7, orientation=turned), profile)
    y[6] -= 1e-3 * outline.largest[6]
    with pytest.raises(ValueError, match="block 6 is released"):
        check_release(Release(block, x, y, orientation=turned), profile)

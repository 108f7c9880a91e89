"""Run-outs of blocks of other shapes, against polygons of their outlines."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from runout_scenes import assert_no_energy_gained, rows_of_records

from jaximpact import Block, ConstantCoefficients, FrictionalEllipsoid, Soil
from jaximpact.parameters import parameter
from jaximpact.runout import (
    ClosedForm,
    Ground,
    MotionMode,
    Profile,
    Release,
    passages,
    simulate_runout,
)
from jaximpact.runout.blocks import Body, fly, select
from jaximpact.runout.flight.flights import follow_flights
from jaximpact.runout.flight.placement import lying_height
from jaximpact.shapes import (
    AbstractShape,
    Ellipsoid,
    EllipticCylinder,
    RectangularPrism,
    Section,
    shape_of_each,
)
from jaximpact.shapes.base import farthest_direction
from jaximpact.shapes.support import round_block

pytestmark = pytest.mark.slow

FASTEST = np.radians(20_000.0)
PROFILE = Profile(
    [0.0, 100.0, 130.0, 131.0, 200.0, 260.0, 300.0, 420.0],
    [150.0, 90.0, 85.0, 70.0, 40.0, 45.0, 30.0, 28.0],
    rolling_friction_angle=np.radians(18.0),
)


class Chamfered(AbstractShape):
    """A rectangle whose corners are cut off straight, told by its support alone."""

    aspect_ratio: jax.Array = parameter(1.0, "-", "(0, inf)", "H/R")
    out_of_plane_ratio: jax.Array = parameter(1.0, "-", "(0, inf)", "W/R")
    flat_part: jax.Array = parameter(0.5, "-", "(0, 1)", "part of a face that is left")

    @property
    def unit_volume(self):
        cut = 2.0 * (1.0 - self.flat_part) ** 2 * self.aspect_ratio
        return 2.0 * self.out_of_plane_ratio * (4.0 * self.aspect_ratio - cut)

    @property
    def unit_inertia(self):
        return (self.aspect_ratio**2 + 1.0) / 4.0

    def support(self, axes, sin, cos, *, side=None):
        long, short = axes.major * jnp.abs(cos), axes.minor * jnp.abs(sin)
        part = self.flat_part
        return jnp.maximum(long + part * short, part * long + short)

    def section(self, axes, sin, cos, height, sinking):
        return Section(-axes.minor, axes.minor, 2.0 * axes.out_of_plane)


SHAPES = (
    EllipticCylinder(aspect_ratio=2.0),
    RectangularPrism(aspect_ratio=1.7),
    RectangularPrism(corner_radius_ratio=0.02),
    Chamfered(aspect_ratio=1.3),
)


def corners(block, lane, count=60):
    """Points of the outline, along the major and the minor axis, and the radius of the
    circle that moves along it."""
    axes = jax.tree.map(lambda x: float(np.ravel(x)[lane]), block.semi_axes)
    shape = jax.tree.map(lambda x: float(np.ravel(x)[lane]), block.shape)
    if isinstance(shape, EllipticCylinder | Ellipsoid):
        turn = np.linspace(0.0, 2.0 * np.pi, 2000, endpoint=False)
        return axes.major * np.cos(turn), axes.minor * np.sin(turn)
    if isinstance(shape, Chamfered):
        p = shape.flat_part
        x = np.array([1.0, p, -p, -1.0, -1.0, -p, p, 1.0])
        y = np.array([p, 1.0, 1.0, p, -p, -1.0, -1.0, -p])
        return axes.major * x, axes.minor * y
    radius = shape.corner_radius_ratio * min(axes.major, axes.minor)
    x, y = [], []
    for quarter, (s, t) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        turn = (quarter + np.linspace(0.0, 1.0, count)) * 0.5 * np.pi
        x.append(s * (axes.major - radius) + radius * np.cos(turn))
        y.append(t * (axes.minor - radius) + radius * np.sin(turn))
    return np.concatenate(x), np.concatenate(y)


def depth_of(points, along, across):
    """How deep points are in a convex polygon; negative outside."""
    x, y = along, across
    edge_x, edge_y = np.roll(x, -1) - x, np.roll(y, -1) - y
    length = np.hypot(edge_x, edge_y)
    kept = length > 0.0
    n_x, n_y = edge_y[kept] / length[kept], -edge_x[kept] / length[kept]
    inside = n_x * (x[kept] - points[0][:, None]) + n_y * (y[kept] - points[1][:, None])
    return np.min(inside, axis=1)


def penetration(block, lane, body, profile):
    """Deepest point of the block under the ground, and of the ground in the block [m],
    at many moments."""
    along, across = corners(block, lane)
    deepest = -np.inf
    for x, y, theta in zip(body.x, body.y, body.orientation, strict=True):
        sin, cos = np.sin(theta), np.cos(theta)
        at_x, at_y = x + along * sin + across * cos, y + along * cos - across * sin
        inside = (at_x >= profile.x[0]) & (at_x <= profile.x[-1])
        over = at_y[inside] - profile.height(at_x[inside])
        deepest = max(deepest, np.max(-over, initial=-np.inf))
        d_x, d_y = profile.x - x, profile.y - y
        points = d_x * sin + d_y * cos, d_x * cos - d_y * sin
        deepest = max(deepest, np.max(depth_of(points, along, across)))
    return deepest


def release_of(shape, count=24):
    generator = np.random.default_rng(1)
    return Release(
        Block(mass=generator.uniform(50.0, 400.0, count), shape=shape),
        generator.uniform(2.0, 60.0, count),
        generator.uniform(155.0, 160.0, count),
        generator.uniform(0.0, 15.0, count),
        generator.uniform(-2.0, 2.0, count),
        generator.uniform(-3.0, 3.0, count),
        generator.uniform(-20.0, 30.0, count),
    )


def rough_ground(generator):
    steps = generator.uniform(0.1, 1.0, 30)
    rises = generator.normal(-0.5, 0.6, 30) * steps
    return Profile(np.cumsum(steps), np.cumsum(rises))


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: type(s).__name__)
def test_first_contacts_are_the_first(shape):
    generator = np.random.default_rng(5)
    profile = rough_ground(generator)
    n = 8
    release = Release(
        Block(mass=generator.uniform(20.0, 800.0, n), shape=shape),
        generator.uniform(profile.x[0], profile.x[-1], n),
        np.max(profile.y) + 2.0,
    )
    body = release.body._replace(
        v_x=generator.normal(0.0, 8.0, n),
        v_y=generator.normal(0.0, 5.0, n),
        orientation=generator.uniform(0.0, 3.0, n),
        angular_velocity=generator.choice([0.0, 10.0, FASTEST, -FASTEST], n),
    )
    ends = follow_flights(body, release.outline, profile, np.full(n, 50.0))
    assert not np.any(ends.failed)
    assert np.all(ends.touched != ends.left)
    for i in range(n):
        one = select(body, [i])
        times = np.linspace(0.0, ends.time[i], 200)
        now = Body(*(np.broadcast_to(v, times.shape) for v in fly(one, times)))
        size = float(release.outline.largest[i])
        assert penetration(release.block, i, now, profile) < 2e-8 * size
        if ends.touched[i]:
            at_end = Body(*(v[-1:] for v in now))
            # Corners of 60 points, and ellipses of 2000, are so coarse.
            coarse = 3e-4 * size
            assert penetration(release.block, i, at_end, profile) > -coarse


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize(
    "law", [FrictionalEllipsoid(0.5, 0.5), ConstantCoefficients(0.5, 0.85)]
)
def test_energy_never_rises_and_flights_stay_above_the_ground(shape, law):
    release = release_of(shape)
    runs = simulate_runout(PROFILE, release, ClosedForm(law), event_limit=500)
    assert set(runs.count_endings()) <= {"stopped", "left profile"}
    assert_no_energy_gained(runs)
    p, generator = runs.pieces, np.random.default_rng(0)
    flights = np.flatnonzero((p.motion == MotionMode.flight) & (p.duration > 1e-3))
    # Not those that begin in the ground, as a round block that rolled may.
    for i in generator.choice(flights, 25, replace=False):
        lane = int(p.trajectory[i])
        one = Body(*(np.array([getattr(p, name)[i]]) for name in Body._fields))
        times = np.linspace(0.0, p.duration[i], 60)
        now = Body(*(np.broadcast_to(v, times.shape) for v in fly(one, times)))
        start = penetration(release.block, lane, Body(*(v[:1] for v in now)), PROFILE)
        allowed = max(start, 0.0) + 1e-7
        assert penetration(release.block, lane, now, PROFILE) < allowed


def test_mixed_shapes_go_as_each_alone():
    """To the last bit, with a law and a ground of each block, and random facets."""
    kinds, slow = [Ellipsoid, RectangularPrism] * 6, np.linspace(0.3, 0.6, 12)
    law = ClosedForm(ConstantCoefficients(slow, 0.85))
    ground = Ground(Soil(gamma_v=slow[:, None] * 10.0), roughness=0.05, seed=3)
    steps = []
    runs = simulate_runout(
        *(PROFILE, release_of(shape_of_each(kinds), 12), law),
        ground=ground,
        progress=lambda done, count: steps.append((done, count)),
    )
    assert steps[-1] == (12, 12)
    assert steps == sorted(steps)
    places = passages(runs, 100.0)
    for place, kind in enumerate((Ellipsoid, RectangularPrism)):
        alone = simulate_runout(PROFILE, release_of(kind(), 12), law, ground=ground)
        lanes = np.arange(place, 12, 2)
        np.testing.assert_array_equal(runs.x[lanes], alone.x[lanes])
        pairs = (
            (runs.contacts, alone.contacts),
            (runs.pieces, alone.pieces),
            (places, passages(alone, 100.0)),
        )
        for several, one in pairs:
            chosen, of_one = (np.isin(t.trajectory, lanes) for t in (several, one))
            assert np.any(chosen)
            jax.tree.map(
                np.testing.assert_array_equal,
                rows_of_records(several, chosen),
                rows_of_records(one, of_one),
            )


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: type(s).__name__)
def test_blocks_lie_on_the_ground(shape):
    generator = np.random.default_rng(4)
    for profile in (PROFILE, rough_ground(generator)):
        x = generator.uniform(profile.x[0], profile.x[-1], 10)
        turned = generator.uniform(0.0, 3.0, 10)
        block = Block(mass=generator.uniform(50.0, 400.0, 10), shape=shape)
        release = Release(block, x, 0.0)
        y = lying_height(profile, release.outline, x, turned)
        for i in range(10):
            lying = (x[i], y[i], 0, 0, turned[i], 0)
            body = Body(*(np.array([value]) for value in lying))
            assert abs(penetration(release.block, i, body, profile)) < 3e-4
        # And a run agrees that this is no place in the ground.
        release = Release(block, x, y, orientation=turned)
        law = ClosedForm(ConstantCoefficients(0.0, 1.0))
        simulate_runout(profile, release, law, time_limit=1e-3)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: type(s).__name__)
def test_points_are_parted_from_blocks_as_from_polygons(shape):
    """By the shape's own way, and by its support alone; an ellipse's own way parts
    points of a line, not points alone."""
    block = Block(shape=shape)
    axes = block.semi_axes
    size = float(axes.major)
    points = np.random.default_rng(0).uniform(-2.0 * size, 2.0 * size, (200, 2))
    expected = -depth_of(points.T, *corners(block, 0))
    outside = expected > 0.0

    def distance(direction, along, across):
        u, v = direction
        length = jnp.sqrt(u**2 + v**2)
        reach = block.shape.support(axes, v / length, u / length)
        return (along * u + across * v) / length - reach

    def both(along, across):
        by_support = farthest_direction(block.shape, axes, along, across)
        own = block.shape.parting_direction(axes, along, across)
        return distance(by_support, along, across), distance(own, along, across)

    found, own = map(np.asarray, jax.vmap(both)(*points.T))
    nearest = np.min(
        np.hypot(*(points.T[:, :, None] - np.stack(corners(block, 0, 4000))[:, None])),
        axis=1,
    )
    # The nearest corner is no nearer than the block, and the nearest face no farther.
    assert np.all(found[outside] <= nearest[outside] + 1e-9)
    assert np.all(found[outside] >= expected[outside] - 1e-4 * size)
    assert np.all((found > 1e-5 * size) <= outside)
    if not isinstance(shape, EllipticCylinder):
        np.testing.assert_allclose(own[outside], found[outside], atol=1e-7 * size)


@pytest.mark.parametrize("shape", SHAPES[:3], ids=lambda s: type(s).__name__)
def test_round_blocks_are_those_of_the_support(shape):
    axes = Block(shape=shape).semi_axes
    for own, sampled in zip(
        shape.round_block(axes), round_block(shape, axes), strict=True
    ):
        assert float(own) == pytest.approx(float(sampled), rel=2e-3)

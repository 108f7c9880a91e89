"""Shapes against polygon clipping, an independent integrator, and what must hold of any
shape."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import shape_oracle
from pages import blocks_of, run
from paths import DOCS
from shapely import affinity
from shapely.geometry import box

from jaximpact import (
    PRESETS,
    Block,
    Impact,
    Outcome,
    Scene,
    Soil,
    select_model,
    simulate,
    simulate_batch,
)
from jaximpact.errors import InputError
from jaximpact.impact.reduced_models import PLANAR, VERTICAL
from jaximpact.shapes import (
    AbstractShape,
    Ellipsoid,
    EllipticCylinder,
    RectangularPrism,
    SemiAxes,
    foundation,
)

pytestmark = pytest.mark.slow

SHAPES = (Ellipsoid, EllipticCylinder, RectangularPrism)
PAGE = DOCS / "shapes.md"
DEGREE = np.pi / 180.0


def drawn_prisms(count):
    """Rows of H, R, corner radius ratio, Theta and height over support."""
    draw = np.random.default_rng(1)
    return zip(
        *np.exp(draw.uniform(-1.0, 0.5, (2, count))).tolist(),
        draw.uniform(0.01, 1.0, count).tolist(),
        draw.uniform(-np.pi, np.pi, count).tolist(),
        draw.uniform(-0.98, 0.98, count).tolist(),
        strict=True,
    )


@jax.jit
def prism_at(major, minor, corner, theta, height):
    axes = SemiAxes(major, minor, 1.0)
    shape = RectangularPrism(corner_radius_ratio=corner)
    sin, cos = jnp.sin(theta), jnp.cos(theta)
    sinking = shape.support(axes, sin, cos) - height
    return foundation(shape, axes, sin, cos, sinking)


def test_prism_agrees_with_polygon_clipping():
    kinds = set()
    for major, minor, corner, theta, share in drawn_prisms(150):
        radius = corner * min(major, minor)
        polygon = shape_oracle.rounded_rectangle(major, minor, radius)
        # Seen with the ground's normal up; the polygon's y, the major axis, points down
        # at Theta = 0, and clockwise is positive.
        placed = affinity.rotate(polygon, -np.degrees(theta), origin=(0, 0))
        left, bottom, right, _ = placed.bounds
        support = -bottom
        height = share * support
        ours = prism_at(major, minor, corner, theta, height)
        # 10 000 corners: off by a twelve-millionth of the radius.
        exact = dict(abs=1e-6)
        assert float(ours.normal_arm) == pytest.approx(height, abs=1e-12)
        assert float(ours.sinking) == pytest.approx(support - height, **exact)
        below = placed.intersection(box(-9.0, -9.0, 9.0, -height))
        sides = below.bounds
        # The widest of what is below the ground, on each side
        assert float(ours.length) == pytest.approx(sides[2] - sides[0], abs=2e-5)
        middle = 0.5 * (sides[0] + sides[2])
        assert float(ours.tangential_arm) == pytest.approx(middle, abs=2e-5)
        points = np.asarray(placed.exterior.coords)
        lowest = points[np.argmin(points[:, 1])]
        # An arc's polygon has its lowest corner within half a side, 0.3 mm a metre.
        within = 4e-4 * radius
        assert float(ours.tangency_arm) == pytest.approx(lowest[0], abs=within)
        kinds.add((sides[0] > left + 1e-9, sides[2] < right - 1e-9, height > 0.0))
    assert len(kinds) >= 6


@pytest.mark.parametrize(
    ("corner", "ratio", "orientation", "angle", "spin"),
    [
        (None, 2.0, 30.0, 20.0, 0.0),
        (None, 1.0, 0.0, 40.0, 0.0),
        (0.2, 2.0, 30.0, 20.0, 0.0),
        # Over a level face, either way
        (0.2, 1.5, -5.0, 30.0, 500.0),
        (0.2, 1.5, 3.0, 30.0, -1000.0),
        # From a level face
        (0.2, 1.5, 0.0, 30.0, 300.0),
        (0.05, 1.5, 90.0, -20.0, -300.0),
        (0.2, 1.5, 90.0, 30.0, 0.0),
    ],
)
def test_agrees_with_an_independent_integrator(corner, ratio, orientation, angle, spin):
    motion = dict(orientation=orientation, angle=angle, angular_velocity=spin)
    units = dict(angular_velocity="degps")
    scene = {f"{name}_{units.get(name, 'deg')}": x for name, x in motion.items()}
    exact = shape_oracle.simulate(scene | dict(aspect_ratio=ratio), corner)
    shape = EllipticCylinder(aspect_ratio=ratio)
    if corner is not None:
        shape = RectangularPrism(aspect_ratio=ratio, corner_radius_ratio=corner)
    impact = Impact.from_degrees(**motion)
    for accuracy, within in (("balanced", 1e-4), ("reference", 1e-6)):
        ours = simulate(Block(shape=shape), Soil(), impact, accuracy=accuracy)
        assert ours.outcome in (Outcome.detached, Outcome.toppled)
        for name in ("e_n", "e_t", "e_bar", "e_contact"):
            assert float(getattr(ours, name)) == pytest.approx(exact[name], abs=within)
        rigid = exact["e_vijayakumar"]
        assert float(ours.e_n_vijayakumar) == pytest.approx(rigid, abs=within)
        for name, theirs in (
            ("max_penetration", "max_penetration_m"),
            ("max_sinking", "max_sinking_m"),
            ("max_normal_force", "max_normal_force_N"),
            ("max_moment", "max_moment_Nm"),
            ("duration", "duration_s"),
            ("rotation", "rotation_rad"),
        ):
            assert float(getattr(ours, name)) == pytest.approx(
                exact[theirs], rel=within
            )


def test_a_flat_block_with_spin_sinks_at_its_end():
    axes, shape = SemiAxes(1.5, 1.0, 1.0), RectangularPrism(corner_radius_ratio=0.2)
    for sin, cos, half in ((0.0, 1.0, 0.8), (1.0, 0.0, 1.3), (0.0, -1.0, 0.8)):
        arms = [
            float(shape.arm_at_touch(axes, sin, cos, jnp.asarray(spin)))
            for spin in (-2.0, 0.0, 2.0)
        ]
        np.testing.assert_allclose(arms, [-half, 0.0, half], atol=1e-15)


RESULTS = (
    "e_n",
    "e_t",
    "e_bar",
    "e_contact",
    "max_sinking",
    "max_normal_force",
    "max_moment",
    "duration",
    "rotation",
)


def results_of(shape, **impact):
    found = simulate(
        Block(shape=shape), Soil(), Impact.from_degrees(**impact), accuracy="reference"
    )
    return np.array([float(getattr(found, name)) for name in RESULTS])


OBLIQUE = dict(angle=30.0, orientation=35.0, angular_velocity=200.0)
SYMMETRIES = {
    # Both are integrated by other steps, to some 1e-10 at "reference"; R_r is small.
    "half a turn": ({}, OBLIQUE | dict(orientation=215.0), 1.0, 1e-7, 1e-10),
    "mirrored": (
        {},
        dict(angle=-30.0, orientation=145.0, angular_velocity=-200.0),
        np.array([-1.0 if name == "rotation" else 1.0 for name in RESULTS]),
        1e-7,
        1e-10,
    ),
    # R is the half size that W goes by. The start, at 1e-6 R, is another one: that
    # shows in the fifth digit.
    "axes exchanged, a quarter turn": (
        dict(aspect_ratio=1.0 / 1.6, out_of_plane_ratio=1.0 / 1.6),
        OBLIQUE | dict(orientation=125.0),
        1.0,
        1e-4,
        2e-5,
    ),
}


@pytest.mark.parametrize("name", SYMMETRIES)
@pytest.mark.parametrize("kind", SHAPES)
def test_symmetric_impacts_are_symmetric(kind, name):
    ratios, impact, signs, rtol, atol = SYMMETRIES[name]
    other = results_of(kind(**{"aspect_ratio": 1.6} | ratios), **impact)
    expected = results_of(kind(aspect_ratio=1.6), **OBLIQUE)
    np.testing.assert_allclose(signs * other, expected, rtol=rtol, atol=atol)


def random_scenes(kind, count, seed=5) -> Scene:
    draw = np.random.default_rng(seed)

    def over(low, high):
        return draw.uniform(low, high, count)

    own = {"corner_radius_ratio": over(0.02, 1.0)} if kind is RectangularPrism else {}
    shape = kind(aspect_ratio=over(0.4, 4.0), out_of_plane_ratio=over(0.5, 2.0), **own)
    spins = np.where(over(0.0, 1.0) < 0.5, over(-2000.0, 2000.0), 0.0)
    # One in four on a face, or upright
    faces = np.where(over(0.0, 1.0) < 0.25, 90.0 * draw.integers(0, 3, count), np.nan)
    orientation = np.where(np.isnan(faces), over(0.0, 180.0), faces)
    return Scene(
        Block(mass=np.exp(over(2.0, 8.0)), shape=shape),
        Soil(
            c_v=np.exp(over(-2.0, 1.5)),
            gamma_v=np.exp(over(-0.7, 4.0)),
            k_E=np.exp(over(4.6, 8.5)),
            friction_angle=over(25.0, 45.0) * DEGREE,
            relative_density=over(0.3, 1.0),
        ),
        Impact.from_degrees(over(1.0, 40.0), over(0.0, 80.0), orientation, spins),
    )


SOFT = dict(cohesion=np.full(10_000, 1e4), dilatancy=np.full(10_000, 0.7))
"""Ground that bears a foundation until it vanishes: the block is lifted off under
load."""


@pytest.mark.parametrize("ground", [{}, SOFT], ids=["dry", "cohesive"])
@pytest.mark.parametrize("kind", SHAPES)
def test_ten_thousand_scenes_have_no_nan_and_a_ledger_that_closes(kind, ground):
    scenes = random_scenes(kind, 10_000)
    soil = dataclasses.replace(scenes.soil, **ground)
    found = simulate_batch(dataclasses.replace(scenes, soil=soil), ledger=True)
    outcome = np.asarray(found.outcome_code)
    failed = outcome == Outcome.failed
    # None of the ellipsoid's; of 10 000 of the others no more than a knife edge.
    assert np.count_nonzero(failed) <= (0 if kind is Ellipsoid else 2)
    for name in ("e_n", "e_bar", "max_normal_force", "duration", "rotation"):
        assert np.all(np.isfinite(np.asarray(getattr(found, name))[~failed])), name
    largest = np.max(np.abs(np.stack(found.energy)), axis=0)
    residual = np.abs(np.asarray(found.energy.residual)) / largest
    # Each step errs by the tolerance at most; most contacts have dozens.
    tolerance = PRESETS["balanced"].tolerance
    assert np.nanmax(residual) < 5.0 * tolerance
    assert np.nanpercentile(residual, 99.0) < tolerance


def prism_results(values):
    orientation, spin, corner, ratio, hardening = values
    shape = RectangularPrism(aspect_ratio=ratio, corner_radius_ratio=corner)
    found = simulate(
        Block(shape=shape),
        Soil(c_v=hardening),
        Impact(orientation=orientation, angular_velocity=spin, angle=0.5),
        accuracy="reference",
    )
    return jnp.stack([found.e_n, found.e_bar, found.rotation, found.max_sinking])


@pytest.mark.parametrize(
    ("orientation", "spin"),
    [(-5.0, 500.0), (3.0, -1000.0), (84.0, 800.0), (30.0, 0.0)],
    ids=["over a face", "back over a face", "over the end face", "over none"],
)
def test_derivatives_agree_with_differences_across_a_level_face(orientation, spin):
    point = jnp.array([orientation * DEGREE, spin * DEGREE, 0.2, 1.5, 1.0])
    slopes = np.asarray(jax.jacfwd(prism_results)(point))
    width = 1e-5
    for place, column in enumerate(slopes.T):
        step = width * np.eye(len(point))[place]
        difference = (prism_results(point + step) - prism_results(point - step)) / (
            2.0 * width
        )
        # Results are good to 1e-9 or so, by 2e-5.
        np.testing.assert_allclose(column, difference, rtol=1e-3, atol=1e-3)


def test_derivatives_on_a_level_face_are_one_sided():
    # The spin turns the block to larger orientations.
    point = jnp.array([0.0, 300.0 * DEGREE, 0.2, 1.5, 1.0])
    slopes = np.asarray(jax.jacfwd(prism_results)(point))[:, 0]
    step = 1e-6 * np.eye(5)[0]
    here = prism_results(point)
    ahead = (prism_results(point + step) - here) / 1e-6
    behind = (here - prism_results(point - step)) / 1e-6
    np.testing.assert_allclose(slopes, ahead, rtol=0.01, atol=2e-3)
    assert np.max(np.abs(slopes - behind)) > 0.05


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_derivatives_on_a_level_face_without_spin_are_those_of_the_way_it_turns(sign):
    """Friction turns the block, to larger orientations where it comes from the left."""

    def e_n(orientation):
        block = Block(mass=500.0, shape=RectangularPrism(aspect_ratio=2.0))
        impact = Impact(speed=10.0, angle=sign * 0.7, orientation=orientation)
        return simulate(block, Soil(), impact, accuracy="reference").e_n

    slope, step = float(jax.grad(e_n)(0.0)), sign * 1e-6
    behind, here, ahead = (float(e_n(place)) for place in (-step, 0.0, step))
    # Results are good to 1e-9 or so.
    assert slope == pytest.approx((ahead - here) / step, rel=0.01)
    assert slope != pytest.approx((here - behind) / step, rel=0.1)


def test_the_load_at_the_start_is_no_largest_force():
    """A grazing block, and the same with axes exchanged: it starts at 1e-6 of another
    length, and its springs with another load, a hundred times that of the impact."""
    ratio, other = 0.91868, 0.75284
    soil = Soil(
        **dict(gamma_v=19.894, c_v=4.7, k_E=3718.3, n_E=0.096973, poisson=0.13163),
        **dict(friction_angle=0.5108, unit_weight=19450.0, relative_density=0.22756),
        **dict(beta=0.81313, psi=0.54405, alpha_vT=3.4286, alpha_vR=0.82471),
        alpha_s=1.3223,
    )

    def largest(shape, orientation):
        impact = Impact(14.457, -1.3103, orientation, 8.9493, -0.67288)
        block = Block(mass=4003.2, density=2731.5, shape=shape)
        return float(simulate(block, soil, impact).max_normal_force)

    as_it_is = largest(RectangularPrism(ratio, other), 2.9274)
    exchanged = largest(
        RectangularPrism(1.0 / ratio, other / ratio), 2.9274 + 0.5 * np.pi
    )
    # It sinks by ten times what it starts with.
    assert as_it_is == pytest.approx(exchanged, rel=0.02)


@pytest.mark.parametrize("kind", SHAPES)
def test_sections_have_finite_derivatives_everywhere(kind):
    def numbers(ratio, theta, sinking):
        shape = kind(aspect_ratio=ratio)
        axes = SemiAxes(ratio, 1.0, 1.2)
        found = foundation(shape, axes, jnp.sin(theta), jnp.cos(theta), sinking)
        return jnp.stack(found[:-1])

    turn, sinking = np.meshgrid(
        [0.0, 1e-13, 0.3, np.pi / 4, np.pi / 2, 2.0, np.pi, -0.5 * np.pi],
        [-2.0, -1e-9, 0.0, 1e-12, 0.1, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0],
    )
    functions = (
        numbers,
        *(of(numbers, argnums=(0, 1, 2)) for of in (jax.jacfwd, jax.jacrev)),
    )
    for function in functions:
        of_all = jax.jit(jax.vmap(function))
        for ratio in (0.5, 1.0, 3.0):
            found = of_all(np.full(turn.size, ratio), turn.ravel(), sinking.ravel())
            assert np.all(np.isfinite(np.stack(found)))


def test_a_sharp_corner_is_refused_in_words():
    with pytest.raises(InputError, match="harden the ground without bound"):
        RectangularPrism(corner_radius_ratio=0.0)
    with pytest.raises(InputError, match="harden the ground without bound"):
        RectangularPrism(corner_radius_ratio=np.array([0.1, 0.0]))


def test_central_impacts_on_a_face_or_a_corner_of_a_square_do_not_turn():
    def model(shape, degrees):
        impact = Impact.from_degrees(orientation=degrees)
        return select_model(Block(shape=shape), Soil(), impact)

    oblong, square = RectangularPrism(aspect_ratio=2.0), RectangularPrism()
    assert model(oblong, 90.0) is VERTICAL
    assert model(oblong, 45.0) is PLANAR
    assert model(square, 45.0) is VERTICAL
    assert model(square, 30.0) is PLANAR
    assert model(RectangularPrism(corner_radius_ratio=1.0), 30.0) is VERTICAL


@pytest.mark.parametrize("kind", SHAPES)
def test_outlines_are_those_of_the_shape(kind):
    shape = kind(aspect_ratio=2.0)
    axes = SemiAxes(2.0, 1.0, 1.0)
    across, along = shape.outline(axes).T
    assert np.max(along) == pytest.approx(2.0, rel=1e-3)
    assert np.max(across) == pytest.approx(1.0, rel=1e-3)
    assert (across[0], along[0]) == pytest.approx((across[-1], along[-1]))
    if kind is RectangularPrism:
        corners = np.column_stack([across, along])
        for end in ((1.0, 1.8), (0.8, 2.0), (-1.0, -1.8)):
            # Flat faces have both their ends, but for one part in 180 of a turn of
            # the corner.
            assert np.min(np.hypot(*(corners - end).T)) < 0.2 * np.pi / 180.0
    # Nothing reaches beyond the circle about the block, and something up to it.
    reach = np.max(np.hypot(across, along))
    assert reach == pytest.approx(float(shape.bound), rel=1e-3)


def test_a_shape_of_ones_own_in_a_batch_and_by_its_parameter(folder):
    (code,) = [block for block in blocks_of(PAGE) if block.file]
    run(code, {})
    pebble = Block(shape="my_shapes.py:Pebble", aspect_ratio=1.5).shape
    assert isinstance(pebble, AbstractShape)

    impact = Impact.from_degrees(angle=20.0, orientation=30.0)

    def energetic(exponent):
        shape = dataclasses.replace(pebble, edge_exponent=exponent)
        block = Block(shape=shape)
        return simulate(block, Soil(), impact, accuracy="reference").e_bar

    slope = float(jax.grad(energetic)(0.3))
    difference = (energetic(0.3 + 1e-5) - energetic(0.3 - 1e-5)) / 2e-5
    assert slope == pytest.approx(float(difference), rel=1e-4)
    many = dataclasses.replace(pebble, edge_exponent=np.array([0.1, 0.3, 0.5]))
    batch = simulate_batch(
        Scene(Block(shape=many), Soil(), impact), accuracy="reference"
    )
    alone = [float(energetic(exponent)) for exponent in (0.1, 0.3, 0.5)]
    np.testing.assert_allclose(batch.e_bar, alone, rtol=1e-7)

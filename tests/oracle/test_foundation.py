"""The equivalent foundation in closed form against an ellipsoid cut by brute force."""

import geometry_oracle as brute
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact import Block, Impact, Scene, Soil
from jaximpact.impact.dynamics import contact_geometry, prepare
from jaximpact.shapes import Ellipsoid, EllipticCylinder, Foundation, SemiAxes
from jaximpact.shapes import foundation as foundation_of

SHAPE = Ellipsoid()
support_radius, tangency_arm = SHAPE.support, SHAPE.tangency_arm
SIZES = tuple(name for name in Foundation._fields if name != "most_slender")

# The brute force is good to 1e-10 of the block's size; a block is below 2 here.
BRUTE = 1e-9
# Closed forms against each other: rounding.
ROUNDING = 1e-13


def foundation(axes, sin, cos, sinking, shape=SHAPE) -> Foundation:
    return foundation_of(shape, axes, sin, cos, sinking)


def at_height(major, minor, out_of_plane, theta, height) -> Foundation:
    """Foundation of a block whose centre lies `height` above the ground."""
    axes = SemiAxes(*(jnp.asarray(a, float) for a in (major, minor, out_of_plane)))
    sin, cos = jnp.sin(theta), jnp.cos(theta)
    return foundation(axes, sin, cos, support_radius(axes, sin, cos) - height)


batched = jax.jit(jax.vmap(at_height))


def random_cuts(count, seed=1):
    """Rows of H, R, W, Theta and d, all ways that the ground can cut a block."""
    generator = np.random.default_rng(seed)
    major, minor, out_of_plane = np.exp(generator.uniform(-1.0, 0.5, (3, count)))
    theta = generator.uniform(-np.pi, np.pi, count)
    support = np.hypot(major * np.cos(theta), minor * np.sin(theta))
    height = support * generator.uniform(-0.98, 0.98, count)
    return major, minor, out_of_plane, theta, height


@pytest.mark.slow
def test_agrees_with_the_ellipsoid_equation():
    cuts = random_cuts(60)
    ours = batched(*cuts)
    kinds = set()
    for i, cut in enumerate(zip(*(column.tolist() for column in cuts), strict=True)):
        exact = brute.foundation(*cut)
        pairs = {
            "B_t": ours.length,
            "B_w": ours.width,
            "u_D": ours.sinking,
            "r_t": ours.tangential_arm,
            "t_low": ours.tangency_arm,
        }
        for name, value in pairs.items():
            assert float(value[i]) == pytest.approx(exact[name], abs=BRUTE), name
        assert float(ours.normal_arm[i]) == pytest.approx(cut[-1], abs=ROUNDING)
        kinds.add((exact["left"][0] < 0, exact["right"][0] < 0, cut[-1] > 0))
    # Both extreme points above; one or the other below; both below. Centre on either
    # side of the ground with each.
    assert len(kinds) >= 6


@pytest.mark.slow
def test_elliptic_cylinder_is_cut_as_the_ellipsoid_and_has_one_width():
    for H, R, W, theta, height in zip(*random_cuts(40, seed=6), strict=True):
        axes = SemiAxes(*(jnp.asarray(a, float) for a in (H, R, W)))
        sin, cos = jnp.sin(theta), jnp.cos(theta)
        sinking = support_radius(axes, sin, cos) - height
        ours = foundation(axes, sin, cos, sinking, EllipticCylinder())
        # The section in the plane of motion is the one w = 0 of the ellipsoid.
        exact = brute.foundation(*map(float, (H, R, W, theta, height)))
        for name, value in {
            "B_t": ours.length,
            "u_D": ours.sinking,
            "r_t": ours.tangential_arm,
            "t_low": ours.tangency_arm,
        }.items():
            assert float(value) == pytest.approx(exact[name], abs=BRUTE), name
        assert float(ours.width) == pytest.approx(2.0 * W, rel=ROUNDING)


def test_sphere_leaves_a_cap():
    radius = 0.21
    sinking = np.linspace(0.01, 0.99, 25) * radius
    cap = 2.0 * np.sqrt(2.0 * radius * sinking - sinking**2)
    for theta in (0.0, 0.4, 2.0):
        same = [np.full_like(sinking, radius)] * 3
        base = batched(*same, np.full_like(sinking, theta), radius - sinking)
        np.testing.assert_allclose(base.length, cap, rtol=ROUNDING)
        np.testing.assert_allclose(base.width, cap, rtol=ROUNDING)
        np.testing.assert_allclose(base.tangential_arm, 0.0, atol=ROUNDING)
        np.testing.assert_allclose(base.tangency_arm, 0.0, atol=ROUNDING)


def test_sphere_sunk_past_its_centre_is_as_wide_as_it_is():
    base = at_height(0.21, 0.21, 0.21, 0.3, -0.05)
    assert base.length == pytest.approx(0.42, rel=ROUNDING)
    assert base.width == pytest.approx(0.42, rel=ROUNDING)


def test_round_block_does_not_depend_on_orientation():
    angles = np.linspace(0.0, np.pi, 37)
    same = [np.full_like(angles, size) for size in (0.3, 0.3, 0.45)]
    for height in (0.29, 0.1, -0.1):
        base = batched(*same, angles, np.full_like(angles, height))
        for values in base[:-1]:
            np.testing.assert_allclose(values, values[0], atol=ROUNDING)


def test_turning_by_half_a_turn_changes_nothing():
    major, minor, out_of_plane, theta, height = random_cuts(50, seed=2)
    once = batched(major, minor, out_of_plane, theta, height)
    again = batched(major, minor, out_of_plane, theta + np.pi, height)
    for a, b in zip(once[:-1], again[:-1], strict=True):
        # Near the onset the section's root magnifies the rounding of the angle.
        np.testing.assert_allclose(a, b, atol=1e-12)


def test_mirrored_orientation_mirrors_the_arms():
    major, minor, out_of_plane, theta, height = random_cuts(50, seed=3)
    base = batched(major, minor, out_of_plane, theta, height)
    mirrored = batched(major, minor, out_of_plane, -theta, height)
    signs = Foundation(1.0, 1.0, 1.0, 1.0, -1.0, -1.0)
    for a, b, sign in zip(base[:-1], mirrored[:-1], signs[:-1], strict=True):
        np.testing.assert_allclose(a, sign * b, atol=ROUNDING)


def test_exchanged_axes_are_a_quarter_turn():
    major, minor, out_of_plane, theta, height = random_cuts(50, seed=4)
    base = batched(major, minor, out_of_plane, theta, height)
    exchanged = batched(minor, major, out_of_plane, theta + 0.5 * np.pi, height)
    for a, b in zip(base[:-1], exchanged[:-1], strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12)


def test_tangency_arm_is_the_slope_of_the_support_radius():
    axes = SemiAxes(*map(jnp.asarray, (0.4, 0.25, 0.3)))

    def support(theta):
        return support_radius(axes, jnp.sin(theta), jnp.cos(theta))

    for theta in (0.0, 0.3, 1.2, 2.9):
        arm = tangency_arm(axes, jnp.sin(theta), jnp.cos(theta))
        assert float(arm) == pytest.approx(
            float(jax.grad(support)(theta)), abs=ROUNDING
        )


def sides_of(function, point, width=1e-7):
    """Value and slope just below and just above a point."""
    return [jax.value_and_grad(function)(point + side) for side in (-width, width)]


def height_of_extreme_point(major, minor, theta):
    """Height of the centre at which the block's left extreme point is at the ground."""
    difference = (major**2 - minor**2) * np.sin(theta) * np.cos(theta)
    return difference / np.hypot(major * np.sin(theta), minor * np.cos(theta))


@pytest.mark.parametrize("field", ["length", "tangential_arm"])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["left", "right"])
def test_smooth_where_an_extreme_point_passes_the_ground(field, side):
    major, minor, theta = 0.5, 0.3, 0.6
    switch = side * height_of_extreme_point(major, minor, theta)

    def quantity(height):
        return getattr(at_height(major, minor, 0.3, theta, height), field)

    (below, slope_below), (above, slope_above) = sides_of(quantity, switch)
    # Over 2e-7 a value changes by its slope, of order 1, and a slope by its curvature,
    # of order 10; a wrong branch would jump by a part of the block's size.
    assert float(below) == pytest.approx(float(above), abs=1e-6)
    assert float(slope_below) == pytest.approx(float(slope_above), abs=1e-5)
    # There is a switch: the curvature jumps.
    curvature = jax.grad(jax.grad(quantity))
    assert abs(curvature(switch - 1e-5) - curvature(switch + 1e-5)) > 0.1


@pytest.mark.parametrize("field", SIZES)
@pytest.mark.parametrize("theta", [0.0, 0.6, 0.5 * np.pi])
def test_smooth_where_the_centre_passes_the_ground(field, theta):
    def quantity(height):
        return getattr(at_height(0.5, 0.3, 0.35, theta, height), field)

    (below, slope_below), (above, slope_above) = sides_of(quantity, 0.0)
    # As above.
    assert float(below) == pytest.approx(float(above), abs=1e-6)
    assert float(slope_below) == pytest.approx(float(slope_above), abs=1e-5)


def test_width_is_that_of_the_section_until_the_centre_is_below():
    heights = np.array([0.3, 0.1, 1e-3, -1e-3, -0.01, -0.1, -0.3])
    widths = [float(at_height(0.5, 0.3, 0.35, 0.6, height).width) for height in heights]
    support = np.hypot(0.5 * np.cos(0.6), 0.3 * np.sin(0.6))
    section = 0.7 * np.sqrt(1.0 - (np.maximum(heights, 0.0) / support) ** 2)
    np.testing.assert_allclose(widths, section, rtol=ROUNDING)


@pytest.mark.parametrize("theta", [0.0, 0.6, 0.5 * np.pi])
@pytest.mark.parametrize("sinking", [0.0, -1e-9, -0.1])
@pytest.mark.parametrize("aspect_ratio", [0.5, 1.0, 3.0])
def test_no_section_and_finite_gradient_at_and_above_the_ground(
    theta, sinking, aspect_ratio
):
    def numbers(major, minor, angle, depth):
        axes = SemiAxes(major, minor, minor)
        return foundation(axes, jnp.sin(angle), jnp.cos(angle), depth)

    arguments = (0.2 * aspect_ratio, 0.2, theta, sinking)
    base = numbers(*arguments)
    assert base.length == 0.0
    assert base.width == 0.0
    slopes = jax.jacfwd(numbers, argnums=(0, 1, 2, 3))(*arguments)
    assert np.all(np.isfinite(jax.tree.leaves(base)))
    assert np.all(np.isfinite(jax.tree.leaves(slopes)))
    assert slopes.length[3] == 0.0


def test_no_section_for_one_lane_only():
    height = jnp.asarray([0.5, 0.3, 0.29])  # in the air, touching, sunk

    def length(depth):
        return at_height(0.3, 0.3, 0.3, 0.2, depth).length

    value, slope = jax.vmap(jax.value_and_grad(length))(height)
    assert np.all(np.isfinite(slope))
    np.testing.assert_array_equal(np.asarray(value) > 0.0, [False, False, True])


@pytest.mark.parametrize("degrees", [0.0, 90.0, 180.0])
def test_upright_and_lying_blocks_are_symmetric_with_finite_gradients(degrees):
    def numbers(theta, height):
        return at_height(0.5, 0.25, 0.25, theta, height)

    theta = np.radians(degrees)
    for height in (0.2, 0.0, -0.05):
        base = numbers(theta, height)
        # cos 90 degrees is 6e-17, not 0.
        assert float(base.tangential_arm) == pytest.approx(0.0, abs=1e-16)
        assert float(base.tangency_arm) == pytest.approx(0.0, abs=1e-16)
        slopes = jax.jacfwd(numbers, argnums=(0, 1))(theta, height)
        assert np.all(np.isfinite(jax.tree.leaves(slopes)))
        # Turning either way shortens or lengthens the section alike.
        assert float(slopes.length[0]) == pytest.approx(0.0, abs=1e-14)


def test_gradients_agree_with_differences():
    major, minor, out_of_plane, theta, height = random_cuts(40, seed=5)
    cuts = (major, minor, out_of_plane, theta, 0.9 * height)
    slopes = jax.vmap(jax.jacfwd(at_height, argnums=(3, 4)))(*cuts)
    delta = 1e-6
    for place, slot in ((3, 0), (4, 1)):
        ends = []
        for sign in (1.0, -1.0):
            moved = list(cuts)
            moved[place] = cuts[place] + sign * delta
            ends.append(batched(*moved))
        for field in SIZES:
            difference = (getattr(ends[0], field) - getattr(ends[1], field)) / 2e-6
            # Truncation 1e-12 times third derivatives, rounding 1e-16 / 1e-6; the
            # section's root has large third derivatives near the onset, kept off by
            # the 0.9. A few parts in a million where a switch lies within delta.
            np.testing.assert_allclose(
                getattr(slopes, field)[slot], difference, atol=1e-6, rtol=1e-6
            )


def test_sinking_keeps_its_digits_at_the_start():
    # At impact u_n = 1e-6 R and the rotation is 0: taken as r_y - d, the difference of
    # radii would leave ten digits, and the onset's section half of those.
    block = Block(aspect_ratio=3.0)
    scene = Scene(block, Soil(), Impact(orientation=0.7))
    ground = prepare(scene)
    penetration = 1e-6 * block.semi_axes.minor
    base = contact_geometry(ground, penetration, jnp.zeros(()))
    assert float(base.sinking) == float(penetration)
    # After a small rotation: against the Taylor series of the support radius, whose
    # third term is 1e-21.
    turn = 1e-7

    def radius(theta):
        return support_radius(block.semi_axes, jnp.sin(theta), jnp.cos(theta))

    slope, bend = jax.grad(radius)(0.7), jax.grad(jax.grad(radius))(0.7)
    expected = float(penetration + slope * turn + 0.5 * bend * turn**2)
    sunk = contact_geometry(ground, penetration, jnp.asarray(turn)).sinking
    # By subtraction of radii: 1e-16 / 1e-7.
    assert float(sunk) == pytest.approx(expected, rel=1e-12)

"""The equivalent foundation in closed form against an ellipsoid cut by brute force."""

import functools

import geometry_oracle as brute
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact import Block, Impact, Scene, Soil
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.impact.dynamics import contact_geometry, prepare
from jaximpact.shapes import Ellipsoid, EllipticCylinder, Foundation, SemiAxes
from jaximpact.shapes import foundation as foundation_of

SHAPE = Ellipsoid()
support_radius = SHAPE.support
SIZES = tuple(name for name in Foundation._fields if name != "most_slender")

# The brute force is good to 1e-10 of the block's size; a block is below 2 here.
BRUTE = 1e-9
# Closed forms against each other: rounding.
ROUNDING = 1e-13


def foundation(axes, sin, cos, sinking, shape=SHAPE) -> Foundation:
    return foundation_of(shape, axes, sin, cos, sinking)


def at_height(major, minor, out_of_plane, theta, height, shape=SHAPE) -> Foundation:
    """Foundation of a block whose centre lies `height` above the ground."""
    axes = SemiAxes(*(jnp.asarray(a, float) for a in (major, minor, out_of_plane)))
    sin, cos = jnp.sin(theta), jnp.cos(theta)
    return foundation(axes, sin, cos, shape.support(axes, sin, cos) - height, shape)


batched = jax.jit(jax.vmap(at_height))
of_cylinders = jax.jit(jax.vmap(functools.partial(at_height, shape=EllipticCylinder())))


def random_cuts(count, seed=1):
    """Rows of H, R, W, Theta and d, all ways that the ground can cut a block."""
    generator = np.random.default_rng(seed)
    major, minor, out_of_plane = np.exp(generator.uniform(-1.0, 0.5, (3, count)))
    theta = generator.uniform(-np.pi, np.pi, count)
    support = np.hypot(major * np.cos(theta), minor * np.sin(theta))
    height = support * generator.uniform(-0.98, 0.98, count)
    return major, minor, out_of_plane, theta, height


# Spheres and round sections, upright and lying blocks, on both sides of the centre
SYMMETRIC = [
    (0.3, 0.3, 0.3, 0.4, 0.1),
    (0.3, 0.3, 0.3, 2.0, -0.1),
    (0.3, 0.3, 0.45, 0.3, 0.29),
    (0.3, 0.3, 0.45, np.pi, -0.2),
    (0.5, 0.3, 0.4, 0.0, 0.1),
    (0.5, 0.3, 0.4, 0.5 * np.pi, -0.1),
]


@pytest.mark.slow
def test_agrees_with_the_ellipsoid_equation():
    cuts = np.concatenate([np.transpose(SYMMETRIC), random_cuts(60)], axis=1)
    ours, cylinder = batched(*cuts), of_cylinders(*cuts)
    # A cylinder is as wide everywhere, and cut as the ellipsoid is in the middle.
    np.testing.assert_allclose(cylinder.width, 2.0 * cuts[2], rtol=ROUNDING)
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
        for name in ("length", "sinking", "tangential_arm", "tangency_arm"):
            value = getattr(cylinder, name)[i]
            assert value == pytest.approx(float(getattr(ours, name)[i]), abs=BRUTE)
        assert float(ours.normal_arm[i]) == pytest.approx(cut[-1], abs=ROUNDING)
        kinds.add((exact["left"][0] < 0, exact["right"][0] < 0, cut[-1] > 0))
    # Both extreme points above; one or the other below; both below. Centre on either
    # side of the ground with each.
    assert len(kinds) >= 6


@unfused_jit
def sizes_and_slopes(theta, height):
    """Sizes of the foundation of a block, their slopes and curvatures by the height."""

    def sizes(height):
        base = at_height(0.5, 0.3, 0.35, theta, height)
        return jnp.stack([getattr(base, name) for name in SIZES])

    slopes = jax.jacfwd(sizes)
    return sizes(height), slopes(height), jax.jacfwd(slopes)(height)


def height_of_extreme_point(theta):
    """Height of the centre at which the block's left extreme point is at the ground."""
    difference = (0.5**2 - 0.3**2) * np.sin(theta) * np.cos(theta)
    return difference / np.hypot(0.5 * np.sin(theta), 0.3 * np.cos(theta))


@pytest.mark.parametrize(
    ("theta", "switch"),
    [
        (0.6, height_of_extreme_point(0.6)),
        (0.6, -height_of_extreme_point(0.6)),
        (0.0, 0.0),
        (0.6, 0.0),
        (0.5 * np.pi, 0.0),
    ],
    ids=["left extreme", "right extreme", "upright", "centre", "lying"],
)
def test_smooth_where_an_extreme_point_or_the_centre_passes_the_ground(theta, switch):
    below, above = (sizes_and_slopes(theta, switch + side) for side in (-1e-7, 1e-7))
    # Over 2e-7 a value changes by its slope, of order 1, and a slope by its curvature,
    # of order 10; a wrong branch would jump by a part of the block's size.
    np.testing.assert_allclose(below[0], above[0], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(below[1], above[1], rtol=0.0, atol=1e-5)
    if switch != 0.0:
        # There is a switch: the curvature jumps.
        curvatures = [
            sizes_and_slopes(theta, switch + side)[2] for side in (-1e-5, 1e-5)
        ]
        jumps = np.abs(np.subtract(*curvatures))
        for name in ("length", "tangential_arm"):
            assert jumps[SIZES.index(name)] > 0.1


def test_no_section_and_finite_gradient_at_and_above_the_ground():
    def numbers(major, minor, angle, depth):
        axes = SemiAxes(major, minor, minor)
        return foundation(axes, jnp.sin(angle), jnp.cos(angle), depth)

    # The last is sunk: lanes without a section beside one with it.
    grid = [[0.5, 1.0, 3.0], [0.0, 0.6, 0.5 * np.pi], [0.0, -1e-9, -0.1, 0.01]]
    ratio, theta, sinking = (x.ravel() for x in np.meshgrid(*grid))
    lanes = 0.2 * ratio, np.full_like(ratio, 0.2), theta, sinking
    base = jax.vmap(numbers)(*lanes)
    slopes = unfused_jit(jax.vmap(jax.jacfwd(numbers, argnums=(0, 1, 2, 3))))(*lanes)
    assert np.all(np.isfinite(np.stack(jax.tree.leaves((base, slopes)))))
    for section in (base.length, base.width, slopes.length[3]):
        np.testing.assert_array_equal(section > 0.0, sinking > 0.0)


def test_gradients_agree_with_differences():
    major, minor, out_of_plane, theta, height = random_cuts(40, seed=5)
    cuts = (major, minor, out_of_plane, theta, 0.9 * height)
    slopes = unfused_jit(jax.vmap(jax.jacfwd(at_height, argnums=(3, 4))))(*cuts)
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

"""Rebound laws in closed form, against their exact facts."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaximpact import (
    Block,
    BozzoloPamini,
    ConstantCoefficients,
    FrictionalEllipsoid,
    Impact,
    Outcome,
    PfeifferBowen,
    RigidEllipsoid,
    Scene,
    Soil,
    energetic_coefficient,
    simulate_batch,
    vijayakumar_coefficient,
)

angles = st.floats(-1.5, 1.5)
impacts = st.builds(
    Impact,
    speed=st.floats(0.1, 60.0),
    angle=angles,
    orientation=angles,
    angular_velocity=st.floats(-300.0, 300.0),
)
blocks = st.builds(Block, mass=st.floats(1e-3, 1e5), aspect_ratio=st.floats(0.2, 6.0))
shares = st.floats(0.01, 1.0)


def energy(block, normal, tangential, spin):
    return (
        0.5 * block.mass * (normal**2 + tangential**2) + 0.5 * block.inertia * spin**2
    )


def motion_before(impact):
    return (
        impact.normal_velocity,
        impact.tangential_velocity,
        impact.angular_velocity,
    )


def energy_before(block, impact):
    return float(energy(block, *motion_before(impact)))


@given(impacts, shares, shares)
def test_constant_coefficients_are_what_they_say(impact, e_n, e_t):
    after = ConstantCoefficients(e_n, e_t)(Block(), impact)
    # to rounding: one product and one quotient
    assert float(after.e_n(impact)) == pytest.approx(e_n, rel=1e-14)
    if float(impact.tangential_velocity) != 0.0:
        assert float(after.e_t(impact)) == pytest.approx(e_t, rel=1e-14)


@given(blocks, impacts, shares, shares)
def test_pfeiffer_bowen_never_makes_energy_and_rolls_away(block, impact, r_n, r_t):
    after = PfeifferBowen(r_n, r_t)(block, impact)
    assert float(energy(block, *after)) <= energy_before(block, impact) * (1 + 1e-13)
    radius = float(block.semi_axes.minor)
    assert float(after.tangential_velocity) == pytest.approx(
        float(after.angular_velocity) * radius, rel=1e-13
    )


def test_pfeiffer_bowen_in_feet():
    """A case worked by hand: 10 ft/s down, 20 ft/s along, no spin, a sphere of 1 ft."""
    foot = 0.3048
    block = Block(mass=4.0 / 3.0 * np.pi * foot**3 * 2577.8)
    assert float(block.semi_axes.minor) == pytest.approx(foot, rel=1e-12)
    impact = Impact(speed=foot * np.hypot(10, 20), angle=np.arctan2(20, 10))
    after = PfeifferBowen(0.3, 0.8)(block, impact)
    assert float(after.normal_velocity) / foot == pytest.approx(-3 / (1 + 1 / 9))
    friction = 0.8 + 0.2 / 2.2
    scaling = 0.8 / (1 + (10 / 75) ** 2)
    # a sphere has I = 2/5 m R^2
    expected = 20 * np.sqrt(friction * scaling / 1.4)
    assert float(after.tangential_velocity) / foot == pytest.approx(expected)


@given(blocks, impacts, shares)
def test_rigid_ellipsoid_turns_the_approach_round(block, impact, e_contact):
    after = RigidEllipsoid(e_contact)(block, impact)
    _, arm = arms(block, impact)
    closing = float(impact.normal_velocity + arm * impact.angular_velocity)
    if closing <= 0.0:
        # the contact point moves away: nothing happens
        assert float(after.normal_velocity) == float(impact.normal_velocity)
        assert float(after.angular_velocity) == float(impact.angular_velocity)
        return
    opening = float(after.normal_velocity + arm * after.angular_velocity)
    scale = float(impact.speed) + abs(arm * float(impact.angular_velocity))
    # The two terms may cancel: rounding is that of their size.
    assert opening == pytest.approx(-e_contact * closing, abs=1e-12 * scale)
    normal = impact.normal_velocity
    expected = vijayakumar_coefficient(
        block, impact.orientation, e_contact, normal, impact.angular_velocity
    )
    assert float(after.e_n(impact)) == pytest.approx(
        float(expected), abs=1e-12 * scale / float(normal)
    )
    elastic = RigidEllipsoid(1.0)(block, impact)
    before = energy_before(block, impact)
    assert float(energy(block, *elastic)) == pytest.approx(before, rel=1e-11)
    assert float(energy(block, *after)) <= before * (1.0 + 1e-11)


@pytest.mark.parametrize(
    "law",
    [
        ConstantCoefficients(0.3, 0.8),
        PfeifferBowen(0.3, 0.8),
        RigidEllipsoid(0.5),
        BozzoloPamini(),
        FrictionalEllipsoid(0.5, 0.4),
    ],
)
def test_mirrored_impacts_rebound_mirrored(law):
    there = Impact(angle=0.6, orientation=0.4, angular_velocity=7.0)
    back = Impact(angle=-0.6, orientation=-0.4, angular_velocity=-7.0)
    block = Block(aspect_ratio=2.0)
    one, other = law(block, there), law(block, back)
    np.testing.assert_allclose(
        [one.normal_velocity, -one.tangential_velocity, -one.angular_velocity],
        other,
        rtol=1e-14,
    )


def arms(block, impact):
    """How far the contact point lies below the centre, and down-slope of it."""
    sin, cos = jnp.sin(impact.orientation), jnp.cos(impact.orientation)
    axes, shape = block.semi_axes, block.shape
    support, arm = shape.support(axes, sin, cos), shape.tangency_arm(axes, sin, cos)
    return float(support), float(arm)


def contact_velocities(block, impact, motion):
    """Normal and tangential velocity of the contact point, of (v_n, v_t, Omega)."""
    below, along = arms(block, impact)
    normal, tangential, spin = (float(x) for x in motion)
    return normal + along * spin, tangential - below * spin


def speed_scale(block, impact):
    """The largest velocity that takes part: that of rounding."""
    size = float(max(block.semi_axes.major, block.semi_axes.minor))
    return float(impact.speed) + size * abs(float(impact.angular_velocity))


def impulses(block, impact, after):
    """Normal and tangential impulse that the ground has given."""
    before = motion_before(impact)
    return tuple(
        float(block.mass) * float(was - now)
        for was, now in zip(before[:2], after[:2], strict=True)
    )


@given(blocks, impacts)
def test_bozzolo_pamini_turns_about_the_contact_point(block, impact):
    after = BozzoloPamini()(block, impact)
    before = motion_before(impact)
    if contact_velocities(block, impact, before)[0] <= 0.0:
        assert [float(x) for x in after] == [float(x) for x in before]
        return
    scale = speed_scale(block, impact)
    # The contact point rests: sums of two velocities of that size, rounded.
    still = contact_velocities(block, impact, after)
    np.testing.assert_allclose(still, 0.0, atol=1e-13 * scale)
    below, along = arms(block, impact)

    def momentum(normal, tangential, spin):
        return block.inertia * spin + block.mass * (below * tangential - along * normal)

    size = float(block.mass) * (below + abs(along)) * scale
    assert float(momentum(*after)) == pytest.approx(
        float(momentum(*before)), abs=1e-13 * size
    )
    # Energy is that of a rotation: nothing else is left.
    assert float(energy(block, *after)) <= float(energy(block, *before)) * (1 + 1e-12)


restitutions = st.one_of(st.just(0.0), st.just(1.0), st.floats(0.0, 1.0))
frictions = st.one_of(st.just(0.0), st.floats(0.0, 3.0), st.floats(3.0, 1e4))


@given(blocks, impacts, restitutions, frictions)
def test_friction_makes_no_energy_and_stays_in_its_cone(block, impact, e, friction):
    after = FrictionalEllipsoid(e, friction)(block, impact)
    before = motion_before(impact)
    # The energy of the scale below, whose rounding is seen where rotation dominates
    most = 0.5 * float(block.mass) * speed_scale(block, impact) ** 2
    assert float(energy(block, *after)) <= float(energy(block, *before)) + 1e-11 * most
    normal, tangential = impulses(block, impact, after)
    rounding = 1e-12 * float(block.mass) * speed_scale(block, impact)
    assert normal >= -rounding
    assert abs(tangential) <= friction * (normal + rounding) + rounding
    if contact_velocities(block, impact, before)[0] > 0.0:
        # The contact point leaves the ground, or rests.
        opening = contact_velocities(block, impact, after)[0]
        assert opening <= 1e-11 * (1.0 + friction) * speed_scale(block, impact)
    else:
        assert [float(x) for x in after] == [float(x) for x in before]


@given(blocks, impacts, restitutions)
def test_without_friction_it_is_the_rigid_ellipsoid(block, impact, e):
    after = FrictionalEllipsoid(e, 0.0)(block, impact)
    rigid = RigidEllipsoid(e)(block, impact)
    sizes = 1.0, 1.0, float(block.semi_axes.minor)
    allowed = 1e-12 * speed_scale(block, impact)
    np.testing.assert_allclose(
        np.array(after) * sizes, np.array(rigid) * sizes, atol=allowed
    )


@given(blocks, impacts)
def test_with_endless_friction_it_turns_about_the_contact_point(block, impact):
    turned = BozzoloPamini()(block, impact)
    normal, _ = impulses(block, impact, turned)
    after = FrictionalEllipsoid(0.0, 1e9)(block, impact)
    gap = max(
        abs(float(a - b)) * size
        for a, b, size in zip(after, turned, (1, 1, block.semi_axes.minor), strict=True)
    )
    scale = speed_scale(block, impact)
    if normal >= 0.0:
        # What is left of the slip's length goes with 1/mu; rounding with mu.
        assert gap <= 1e-6 * scale
    else:
        # That law would have the ground pull.
        assert impulses(block, impact, after)[0] >= -1e-6 * float(block.mass) * scale


@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.25, 0.8])
@pytest.mark.parametrize("spin", [-40.0, 0.0, 30.0])
def test_a_sphere_slides_or_rolls(e, friction, spin):
    """The textbook's closed forms: it slides throughout or leaves rolling."""
    block, impact = Block(), Impact(speed=12.0, angle=0.6, angular_velocity=spin)
    radius, mass = float(block.semi_axes.minor), float(block.mass)
    normal, tangential = (float(v) for v in motion_before(impact)[:2])
    slip = tangential - radius * spin
    impulse = min(friction * (1 + e) * mass * normal, 2 / 7 * mass * abs(slip))
    impulse *= np.sign(slip)
    after = FrictionalEllipsoid(e, friction)(block, impact)
    np.testing.assert_allclose(
        [float(x) for x in after],
        [
            -e * normal,
            tangential - impulse / mass,
            spin + 2.5 * impulse / (mass * radius),
        ],
        rtol=1e-12,
        atol=1e-12,
    )


def marched(block, impact, e, friction, *, newton=False, steps=20_000):
    """The impact as a process, a small normal impulse at a time; friction at each step
    is what stops the slip, or as much of that as the cone has. Newton's hypothesis ends
    it by the contact's velocity in place of the impulse."""
    below, along = arms(block, impact)
    mass, inertia = float(block.mass), float(block.inertia)
    # Columns: what a unit impulse out of the ground, and up-slope, does to the motion.
    out = np.array([-1 / mass, 0.0, -along / inertia])
    up = np.array([0.0, -1 / mass, below / inertia])
    approach, slip = np.array([1.0, 0.0, along]), np.array([0.0, 1.0, -below])
    motion = np.array([float(v) for v in motion_before(impact)])
    closing = approach @ motion
    # An upper bound of the impulse of compression, by sticking: A - C^2/B
    stick = -(approach @ out) - (approach @ up) ** 2 / -(slip @ up)
    step = (closing + abs(approach @ up) * abs(slip @ motion)) / stick / steps
    normal, compression = 0.0, None
    while True:
        pushed = motion + step * out
        wanted = (slip @ pushed) / -(slip @ up)
        motion = pushed + np.clip(wanted, -friction * step, friction * step) * up
        normal += step
        if compression is None and approach @ motion <= 0.0:
            compression = normal
        if compression is not None and (
            approach @ motion <= -e * closing
            if newton
            else normal >= (1 + e) * compression
        ):
            return motion


# Angle, orientation, friction, and the slip against the first one at the end of
# compression and at the end: 1 the same way, 0 none, -1 the other way.
KINDS = {
    "slips on": (1.2, 1.1, 0.3, (1, 1)),
    "slips ever faster": (1.2, -0.5, 0.1, (1, 1)),
    "sticks while compressed": (0.7, 0.1, 0.9, (0, 0)),
    "sticks while restituted": (-0.9, 0.0, 0.2, (1, 0)),
    "slips back while compressed": (0.7, 0.5, 0.2, (-1, -1)),
    "slips back while restituted": (-1.0, -0.7, 0.3, (1, -1)),
    "compressed by friction": (-1.2, 0.9, 4.0, (0, 0)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_contact_against_a_march_in_small_impulses(kind):
    angle, orientation, friction, slips = KINDS[kind]
    block = Block(aspect_ratio=2.5)
    impact = Impact(
        speed=10.0, angle=angle, orientation=orientation, angular_velocity=3.0
    )
    compressed = FrictionalEllipsoid(0.0, friction)(block, impact)
    after = FrictionalEllipsoid(0.6, friction)(block, impact)
    first, *later = (
        contact_velocities(block, impact, motion)[1]
        for motion in (motion_before(impact), compressed, after)
    )
    # Rounding of velocities of 10 m/s.
    signs = [int(np.sign(v / first)) if abs(v) > 1e-12 else 0 for v in later]
    assert tuple(signs) == slips
    assert (abs(later[1]) > abs(first)) == (kind == "slips ever faster")
    # The march is of first order: some steps of 1/20 000 of the impact.
    np.testing.assert_allclose(
        [float(x) for x in after], marched(block, impact, 0.6, friction), atol=0.01
    )


def test_arrays_broadcast():
    angles, frictions = np.linspace(-1.0, 1.0, 5), np.array([0.1, 0.2, 0.4, 0.8, 1.6])
    ratios = np.array([[1.0], [2.0], [4.0]])
    many, one = (
        (Block(aspect_ratio=ratios), Impact(angle=angles)),
        (Block(aspect_ratio=4.0), Impact(angle=angles[3])),
    )
    for law_of_many, law_of_one in (
        (BozzoloPamini(), BozzoloPamini()),
        (FrictionalEllipsoid(0.5, frictions), FrictionalEllipsoid(0.5, 0.8)),
    ):
        together = jax.jit(lambda law, scene: law(*scene))(law_of_many, many)
        alone = law_of_one(*one)
        assert all(velocity.shape == (3, 5) for velocity in together)
        # Arrays and scalars may be rounded differently.
        np.testing.assert_allclose([v[2, 3] for v in together], alone, rtol=1e-13)


@pytest.mark.slow
def test_gradients_of_rigid_laws_against_differences():
    @functools.partial(jax.jit, static_argnums=1)
    def velocities(inputs, law):
        angle, orientation, spin, ratio, *parameters = inputs
        impact = Impact(angle=angle, orientation=orientation, angular_velocity=spin)
        return jnp.array(law(*parameters)(Block(aspect_ratio=ratio), impact))

    for law, parameters in ((BozzoloPamini, ()), (FrictionalEllipsoid, (0.4, 0.3))):
        inputs = jnp.array([0.5, 0.4, 3.0, 2.0, *parameters])
        slopes = jax.jacfwd(lambda x, law=law: velocities(x, law))(inputs)
        for place, step in enumerate(1e-5 * np.eye(len(inputs))):
            difference = velocities(inputs + step, law) - velocities(inputs - step, law)
            # Second order of a step of 1e-5, and rounding over it
            np.testing.assert_allclose(
                slopes[:, place], difference / 2e-5, rtol=1e-7, atol=1e-7
            )


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("angle", [0.0, 1.5])
@pytest.mark.parametrize("spin", [0.0, 1e3])
def test_gradients_of_friction_are_finite_at_its_kinks(friction, angle, spin):
    def total(e, friction, angle, orientation, spin):
        impact = Impact(angle=angle, orientation=orientation, angular_velocity=spin)
        law = FrictionalEllipsoid(e, friction)
        return sum(law(Block(aspect_ratio=2.0), impact))

    def of_pfeiffer_bowen(friction, angle, spin):
        impact = Impact(angle=angle, angular_velocity=spin)
        return sum(PfeifferBowen(0.3, friction)(Block(), impact)[:2])

    slopes = jax.grad(of_pfeiffer_bowen, (0, 1, 2))(friction, angle, spin)
    assert all(np.isfinite(float(slope)) for slope in slopes)
    for orientation in (0.0, 0.5):  # without slip or arm; with
        inputs = (0.0, friction, angle, orientation, spin)
        slopes = jax.grad(total, (0, 1, 2, 3, 4))(*inputs)
        assert all(np.isfinite(float(slope)) for slope in slopes)


# --- coefficients of the model against their definitions, on random scenes


COUNT = 400


@pytest.fixture(scope="module")
def result():
    """Random impacts of random blocks, with spin and on slopes."""
    rng = np.random.default_rng(4)

    def some(low, high):
        return rng.uniform(low, high, COUNT)

    scene = Scene(
        Block(mass=np.exp(some(2.0, 9.0)), aspect_ratio=some(0.5, 4.0)),
        Soil(gamma_v=np.exp(some(-0.2, 2.2))),
        Impact(
            speed=some(5.0, 30.0),
            angle=some(-1.2, 1.2),
            orientation=some(0.0, np.pi),
            angular_velocity=some(-20.0, 20.0),
            slope=some(-0.5, 0.5),
        ),
    )
    found = simulate_batch(scene, accuracy="fast", ledger=True)
    assert not np.any(found.outcome_code == Outcome.failed)
    return found


def rotational_energy(result, spin):
    return 0.5 * np.asarray(result.scene.block.inertia) * spin**2


def translational_energy(result, *velocities):
    mass = result.scene.block.mass
    return 0.5 * mass * sum(np.asarray(v) ** 2 for v in velocities)


def test_equation_5_is_the_ratio_of_energies(result):
    impact = result.scene.impact
    turning = rotational_energy(result, impact.angular_velocity)
    before = turning / (turning + translational_energy(result, impact.speed))
    from_apparent = energetic_coefficient(
        result.e_n, result.e_t, impact.angle, before, result.R_r
    )
    energies = np.sqrt(result.energy.kinetic_out / result.energy.kinetic_in)
    # Rounding, of sums of two squares over e_n and e_t of either size; 1 - R_r loses
    # digits where nearly all is rotation.
    digits = 1e-13 / (1.0 - result.R_r)
    np.testing.assert_array_less(abs(from_apparent / energies - 1.0), digits)
    np.testing.assert_allclose(result.e_bar, energies, rtol=1e-14)


def test_apparent_coefficients_and_rotational_ratio(result):
    impact = result.scene.impact
    np.testing.assert_allclose(
        result.e_n, -result.normal_velocity / np.asarray(impact.normal_velocity)
    )
    np.testing.assert_allclose(
        result.e_t, result.tangential_velocity / np.asarray(impact.tangential_velocity)
    )
    turning = rotational_energy(result, result.angular_velocity)
    moving = translational_energy(
        result, result.normal_velocity, result.tangential_velocity
    )
    np.testing.assert_allclose(result.R_r, turning / (turning + moving), rtol=1e-13)


def test_equation_6_is_the_rigid_ellipsoid_with_the_coefficient_at_the_contact(result):
    scene = result.scene
    rigid = jax.vmap(lambda e, b, i: RigidEllipsoid(e)(b, i).e_n(i))(
        result.e_contact, scene.block, scene.impact
    )
    struck = result.outcome_code != Outcome.separating
    assert np.sum(struck) > 0.9 * COUNT
    # Rounding, of a sum of terms up to a hundred times as large
    np.testing.assert_allclose(
        result.e_n_vijayakumar[struck], rigid[struck], rtol=1e-12, atol=1e-12
    )


@pytest.mark.parametrize("ratio", [1.0, 1.5, 4.0])
def test_sphericity_compares_with_the_sphere_of_equal_volume(ratio):
    block = Block(aspect_ratio=ratio)
    sphere = Block(mass=block.mass).semi_axes.minor
    expected = float(sphere / block.semi_axes.major)
    assert float(block.sphericity) == pytest.approx(expected, rel=1e-14)


def test_the_energetic_coefficient_of_vertical_and_of_failed_impacts():
    """e_t has no meaning there; what is NaN stays so, and is no loss of all energy."""
    result = simulate_batch(Block(), Soil(), Impact(angle=np.array([0.0, 0.3])))
    arguments = result.e_n, result.e_t, result.scene.impact.angle, 0.0, result.R_r
    found = energetic_coefficient(*arguments)
    np.testing.assert_allclose(found, result.e_bar, rtol=1e-14)
    assert np.isnan(energetic_coefficient(np.nan, np.nan, 0.3, 0.0, 0.1))
    slope = jax.grad(energetic_coefficient)(0.2, jnp.nan, 0.0, 0.0, 0.0)
    assert float(slope) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "law",
    [
        BozzoloPamini(),
        FrictionalEllipsoid(e_contact=0.3, friction_coefficient=0.6),
        PfeifferBowen(normal_coefficient=0.3, tangential_coefficient=0.8),
        RigidEllipsoid(e_contact=0.3),
    ],
)
@pytest.mark.parametrize("missing", ["speed", "angular_velocity"])
def test_what_is_not_known_before_an_impact_is_not_after_it(law, missing):
    """A missing spin, as tables have, is no spin that passes on."""
    values = {"speed": 10.0, "angle": 0.3, "orientation": 0.4, "angular_velocity": 1.0}
    rebound = law(Block(aspect_ratio=1.5), Impact(**values | {missing: jnp.nan}))
    assert np.isnan(rebound.angular_velocity)

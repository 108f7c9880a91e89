"""Restitution coefficients of the model against their definitions, on random scenes."""

import jax
import numpy as np
import pytest

from jaximpact import (
    Block,
    Impact,
    Outcome,
    RigidEllipsoid,
    Scene,
    Soil,
    energetic_coefficient,
    simulate_batch,
)

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


@pytest.mark.slow
def test_spheres_have_one_normal_coefficient():
    angle = np.linspace(0.0, 1.3, 14)
    scene = Scene(Block(), Soil(), Impact(angle=angle))
    result = simulate_batch(scene, accuracy="fast")
    np.testing.assert_allclose(result.e_contact, result.e_n, rtol=1e-12)
    np.testing.assert_allclose(result.e_n_vijayakumar, result.e_n, rtol=1e-12)


@pytest.mark.parametrize("ratio", [1.0, 1.5, 4.0])
def test_sphericity_compares_with_the_sphere_of_equal_volume(ratio):
    block = Block(aspect_ratio=ratio)
    sphere = Block(mass=block.mass).semi_axes.minor
    expected = float(sphere / block.semi_axes.major)
    assert float(block.sphericity) == pytest.approx(expected, rel=1e-14)

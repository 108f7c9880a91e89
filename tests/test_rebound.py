"""Rebound laws in closed form, against their exact facts."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaximpact import (
    Block,
    ConstantCoefficients,
    Impact,
    PfeifferBowen,
    RigidEllipsoid,
    vijayakumar_coefficient,
)
from jaximpact.foundation import tangency_arm

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


def energy_before(block, impact):
    return energy(
        block,
        impact.normal_velocity,
        impact.tangential_velocity,
        impact.angular_velocity,
    )


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
    assert float(energy(block, *after)) <= float(energy_before(block, impact)) * (
        1.0 + 1e-13
    )
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
    arm = float(
        tangency_arm(
            block.semi_axes, jnp.sin(impact.orientation), jnp.cos(impact.orientation)
        )
    )
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
    assert float(after.e_n(impact)) == pytest.approx(
        float(
            vijayakumar_coefficient(
                block,
                impact.orientation,
                e_contact,
                impact.normal_velocity,
                impact.angular_velocity,
            )
        ),
        abs=1e-12 * scale / float(impact.normal_velocity),
    )
    elastic = RigidEllipsoid(1.0)(block, impact)
    before = float(energy_before(block, impact))
    assert float(energy(block, *elastic)) == pytest.approx(before, rel=1e-11)
    assert float(energy(block, *after)) <= before * (1.0 + 1e-11)


@pytest.mark.parametrize(
    "law",
    [ConstantCoefficients(0.3, 0.8), PfeifferBowen(0.3, 0.8), RigidEllipsoid(0.5)],
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


def test_gradients_are_finite_where_nothing_moves_along():
    def tangential(coefficients, angle, spin):
        law = PfeifferBowen(*coefficients)
        after = law(Block(), Impact(angle=angle, angular_velocity=spin))
        return after.tangential_velocity + after.normal_velocity

    slopes = jax.grad(tangential, (0, 1, 2))((0.3, 0.8), 0.0, 0.0)
    assert all(np.isfinite(x) for x in jax.tree.leaves(slopes))

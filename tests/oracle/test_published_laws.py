"""Laws fitted by others: as printed, in their units, and as differential equations."""

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import lambertw

from jaximpact.paper.comparisons.published_laws import (
    KatsuragiDurian,
    gerber_penetration_m,
    labiouse_max_force_kN,
    lambert_w,
    wyllie_normal_restitution,
)


def test_the_power_laws_at_a_point_worked_by_hand():
    # Powers of 2 and 10 whose exponents are whole: 32^(2/5) = 4, 1024^(3/5) = 64
    force = labiouse_max_force_kN(32.0, 32.0, 16.0, 64.0)
    assert float(force) == pytest.approx(1.765 * 4.0 * 2.0 * 64.0, rel=1e-14)
    depth = gerber_penetration_m(27.0, 1e5, 32.0)
    assert float(depth) == pytest.approx(0.1 * 3.0 * 1e-2 * 16.0, rel=1e-14)
    assert float(wyllie_normal_restitution(1.0)) == pytest.approx(19.5, rel=1e-14)


def test_the_law_of_the_angle_spans_what_its_author_reports():
    # Wyllie (2014): about 0.2 at normal impact, above 1 for shallow ones.
    assert 0.15 < float(wyllie_normal_restitution(90.0)) < 0.25
    assert float(wyllie_normal_restitution(15.0)) > 1.0


@pytest.mark.parametrize("height", [0.5, 8.0])
def test_force_rises_with_speed_to_the_power_of_six_fifths(height):
    def force(speed):
        return labiouse_max_force_kN(1e4, 0.4, 5.0, speed**2 / (2 * 9.81))

    speed = np.sqrt(2 * 9.81 * height)
    elasticity = jax.grad(force)(speed) * speed / force(speed)
    assert float(elasticity) == pytest.approx(1.2, rel=1e-13)


def test_lambert_w_where_it_is_used():
    x = np.concatenate([np.linspace(-0.36, 1.0, 60), np.geomspace(1.0, 1e6, 60)])
    # Both to rounding; close to the branch point the argument's own is magnified.
    np.testing.assert_allclose(lambert_w(x), lambertw(x).real, rtol=1e-13, atol=1e-15)
    slopes = jax.vmap(jax.grad(lambert_w))(x)
    exact = 1.0 / (np.exp(lambertw(x).real) * (1.0 + lambertw(x).real))
    np.testing.assert_allclose(slopes, exact, rtol=1e-11)


def test_stopping_depths_of_the_steel_sphere():
    depths = KatsuragiDurian().stopping_depth(np.array([1.0, 2.0, 3.0, 4.0]))
    # The law evaluated, to the three digits that were given.
    np.testing.assert_allclose(
        100.0 * depths, [3.36, 5.02, 6.37, 7.50], atol=0.005, rtol=0.0
    )


@pytest.mark.parametrize("speed", [1e-3, 0.5, 2.0, 4.0, 12.0])
def test_the_closed_form_against_an_integration_over_time(speed):
    law = KatsuragiDurian()

    def rate(_, state):
        depth, velocity = state
        return velocity, 9.81 - float(law.force(depth, velocity)) / law.mass

    def stops(_, state):
        return state[1]

    stops.terminal, stops.direction = True, -1
    found = solve_ivp(
        rate, (0.0, 1.0), (0.0, speed), events=stops, rtol=1e-10, atol=1e-13
    )
    stopped = float(law.stopping_depth(speed))
    # The integrator's tolerance, some times over
    assert stopped == pytest.approx(found.y_events[0][0, 0], rel=1e-8)
    np.testing.assert_allclose(
        law.squared_speed(found.y[0], speed),
        found.y[1] ** 2,
        atol=1e-8 * max(speed, 1.0) ** 2,
    )


def test_a_sphere_let_go_sinks_by_its_weight():
    law = KatsuragiDurian(drag_length=1e3)
    # Without drag: a mass on a spring swings to twice its rest.
    assert float(law.stopping_depth(0.0)) == pytest.approx(2 * 9.81 / 1040.0, rel=1e-3)


def test_derivatives_of_the_stopping_depth():
    def depth(speed, length, stiffness):
        law = KatsuragiDurian(drag_length=length, stiffness_over_mass=stiffness)
        return law.stopping_depth(speed)

    inputs = np.array([2.0, 0.087, 1040.0])
    slopes = jax.grad(depth, (0, 1, 2))(*inputs)
    for place, slope in enumerate(slopes):
        step = 1e-5 * inputs[place] * np.eye(3)[place]
        difference = depth(*(inputs + step)) - depth(*(inputs - step))
        # Second order of a step of 1e-5, and rounding over it
        assert float(slope) == pytest.approx(
            float(difference) / (2 * step[place]), rel=1e-8
        )

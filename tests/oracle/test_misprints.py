"""The paper's misprints: each printed form contradicts what it should say; ours agrees.

Equation numbers are those of Dattola, Crosta and di Prisco (2023). The judges are the
general equation of the ellipsoid (`geometry_oracle`), the balance of a rigid body, the
definition of the energies, and the independence of a number from the unit of length.
"""

import geometry_oracle as brute
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq

from jaximpact import Block, energetic_coefficient, vijayakumar_coefficient
from jaximpact.shapes import Ellipsoid, SemiAxes, foundation

SHAPE = Ellipsoid()
support_radius, tangency_arm = SHAPE.support, SHAPE.tangency_arm

# An oblong block, turned, its centre above the ground; and one sunk past its centre.
H, R, W, THETA = 0.5, 0.3, 0.4, 0.6
SIN, COS = np.sin(THETA), np.cos(THETA)
SUPPORT = np.hypot(H * COS, R * SIN)
ABOVE, BELOW = 0.6 * SUPPORT, -0.3 * SUPPORT

# Brute force is good to 1e-10 of the block's size, which is below 1 here.
EXACT = 1e-9
# A misprint moves its quantity by more than a tenth of the smallest semi-axis.
WRONG = 0.03


def ours(height):
    axes = SemiAxes(*map(jnp.asarray, (H, R, W)))
    return foundation(SHAPE, axes, SIN, COS, SUPPORT - height)


def on_surface(n, t, w, height):
    """Value of the ellipsoid's equation, 1 on the surface."""
    return float(brute.level(n, t, w, H, R, W, THETA, height))


def test_equation_5_prints_a_translational_for_a_rotational_ratio():
    mass, inertia = 100.0, 2.5
    before, after = np.array([9.0, 6.0, 12.0]), np.array([-2.0, 4.0, 25.0])

    def energies(motion):
        translational = 0.5 * mass * (motion[0] ** 2 + motion[1] ** 2)
        return translational, 0.5 * inertia * motion[2] ** 2

    (moving, turning), (moving_out, turning_out) = energies(before), energies(after)
    exact = np.sqrt((moving_out + turning_out) / (moving + turning))
    e_n, e_t = -after[0] / before[0], after[1] / before[1]
    angle = np.arctan2(before[1], before[0])
    rotational = turning / (moving + turning), turning_out / (moving_out + turning_out)
    printed = energetic_coefficient(e_n, e_t, angle, *(1.0 - r for r in rotational))
    assert abs(float(printed) - exact) > 0.1
    mended = energetic_coefficient(e_n, e_t, angle, *rotational)
    # Rounding.
    assert float(mended) == pytest.approx(exact, rel=1e-14)


def rigid_body_coefficient(arm, mass, inertia, e_contact, normal_velocity, spin):
    """Apparent coefficient from one normal impulse at the contact, which turns the
    contact's velocity v + r_t Omega into -e* times itself."""
    closing = normal_velocity + arm * spin
    impulse = (1.0 + e_contact) * closing / (1.0 / mass + arm**2 / inertia)
    return -(normal_velocity - impulse / mass) / normal_velocity


def equation_6(arm, mass, inertia, e_contact, normal_velocity, spin, power):
    """Equation 6 with the arm in its last term to a power: 2 is printed."""
    turning = mass * arm**2
    return (inertia * e_contact - turning) / (inertia + turning) + (
        (1.0 + e_contact) * arm**power * inertia / (inertia + turning)
    ) * spin / normal_velocity


def test_equation_6_prints_the_arm_squared():
    orientation, e_contact, normal_velocity, spin = 0.5, 0.3, 10.0, 30.0
    numbers = {}
    for unit in (1.0, 1000.0):  # metres; millimetres
        block = Block(aspect_ratio=2.0, density=2577.8 / unit**3)
        arm = float(tangency_arm(block.semi_axes, np.sin(orientation), np.cos(0.5)))
        body = (
            arm,
            100.0,
            float(block.inertia),
            e_contact,
            normal_velocity * unit,
            spin,
        )
        numbers[unit] = dict(
            exact=rigid_body_coefficient(*body),
            printed=equation_6(*body, power=2),
            mended=float(
                vijayakumar_coefficient(
                    block, orientation, e_contact, normal_velocity * unit, spin
                )
            ),
        )
    metres, millimetres = numbers[1.0], numbers[1000.0]
    # Rounding.
    assert metres["mended"] == pytest.approx(metres["exact"], rel=1e-12)
    assert metres["mended"] == pytest.approx(millimetres["mended"], rel=1e-12)
    # A pure number that depends on the unit of length is none.
    assert abs(metres["printed"] - millimetres["printed"]) > 1.0
    assert abs(metres["printed"] - metres["exact"]) > 0.1


def test_equation_13_prints_the_major_for_the_out_of_plane_semi_axis():
    # The block's farthest point out of the plane lies W from the centre, or nowhere.
    assert on_surface(-ABOVE, 0.0, W, ABOVE) == pytest.approx(1.0, abs=EXACT)
    assert abs(on_surface(-ABOVE, 0.0, H, ABOVE) - 1.0) > WRONG
    # So the section at ground level (eqs. 18 and 21) is W q wide, not H q.
    half_width = brute.section_half_width(H, R, W, THETA, ABOVE)
    q = np.sqrt(1.0 - (ABOVE / SUPPORT) ** 2)
    assert abs(H * q - half_width) > WRONG
    assert float(ours(ABOVE).width) == pytest.approx(2.0 * half_width, abs=EXACT)


def test_equation_22_prints_a_sum_for_the_difference_of_squares():
    ends = brute.section_ends(H, R, W, THETA, ABOVE)
    centre, half = 0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])
    b_2 = (R * H) ** 2 - ABOVE**2 * (H**2 + R**2 - SUPPORT**2)

    def section(squares):
        """Centre and half-length by eqs. 19, 20 and 22."""
        b_1 = ABOVE * squares * SIN * COS / SUPPORT
        return -b_1 / SUPPORT, np.sqrt(b_2 + b_1**2) / SUPPORT

    printed, mended = section(R**2 + H**2), section(H**2 - R**2)
    assert abs(printed[0] - centre) > WRONG
    assert abs(printed[1] - half) > WRONG
    np.testing.assert_allclose(mended, (centre, half), atol=EXACT)
    # No extreme point is below the ground here, so our foundation is that section.
    assert float(ours(ABOVE).tangential_arm) == pytest.approx(centre, abs=EXACT)
    assert float(ours(ABOVE).length) == pytest.approx(2.0 * half, abs=EXACT)


def test_equation_22_sets_a_sphere_s_section_aside_of_its_centre():
    radius, height = 0.3, 0.18
    ends = brute.section_ends(radius, radius, radius, THETA, height)
    printed = -height * (radius**2 + radius**2) * SIN * COS / radius**2
    assert 0.5 * (ends[0] + ends[1]) == pytest.approx(0.0, abs=EXACT)
    assert abs(printed) > WRONG
    axes = SemiAxes(*map(jnp.asarray, (radius, radius, radius)))
    base = foundation(SHAPE, axes, SIN, COS, radius - height)
    assert float(base.tangential_arm) == pytest.approx(0.0, abs=EXACT)


@pytest.mark.parametrize("height", [ABOVE, BELOW])
def test_equation_26_prints_a_wrong_level_of_the_widest_points(height):
    # With u_t = 0 the printed point is (n, t, w) = (-H, 0, W).
    side = brute.extreme((0, 0, 1), H, R, W, THETA)
    assert side[0] - height == pytest.approx(-height, abs=EXACT)
    assert on_surface(-height, 0.0, W, height) == pytest.approx(1.0, abs=EXACT)
    assert on_surface(-H, 0.0, W, height) > 1.0 + WRONG


def test_equation_26_decides_when_the_foundation_is_the_whole_width():
    # By the printed level, -H, the block would never be that wide.
    assert float(ours(BELOW).width) == pytest.approx(2.0 * W, abs=EXACT)
    assert float(ours(ABOVE).width) < 2.0 * W - WRONG
    widest = brute.sampled_extent(H, R, W, THETA, BELOW, points=401)["B_w"]
    # Sampling at 1/400 of a turn.
    assert float(ours(BELOW).width) == pytest.approx(widest, abs=1e-3)
    section = 2.0 * brute.section_half_width(H, R, W, THETA, BELOW)
    assert abs(section - 2.0 * W) > WRONG


def test_equation_33_prints_the_same_point_at_both_ends():
    C_w1, C_w2 = (brute.extreme((0, 0, s), H, R, W, THETA)[2] for s in (-1.0, 1.0))
    D_w1, printed_D_w2, mended_D_w2 = C_w1, C_w1, C_w2
    assert mended_D_w2 - D_w1 == pytest.approx(2.0 * W, abs=EXACT)
    assert abs(printed_D_w2 - D_w1 - 2.0 * W) > WRONG
    assert float(ours(BELOW).width) == pytest.approx(mended_D_w2 - D_w1, abs=EXACT)


def test_equation_40_prints_a_tangent_for_a_sine():
    # The deepest point of the parametric ellipse n(p) = H cos p cos T + R sin p sin T.
    def depth(p):
        return H * np.cos(p) * COS + R * np.sin(p) * SIN

    def printed(p):
        return -H * np.tan(p) * COS + R * np.cos(p) * SIN

    deepest = brute.extreme((1, 0, 0), H, R, W, THETA)[0]
    # Equation 41 is the solution of the equation meant, -H sin p cos T + R cos p sin T.
    meant = np.arctan(R / H * np.tan(THETA))
    assert depth(meant) == pytest.approx(deepest, abs=EXACT)
    assert abs(printed(meant)) > 0.005
    # The root of what is printed is another angle, and not the deepest point.
    root = brentq(printed, 0.0, 1.5)
    assert abs(root - meant) > 0.01
    assert depth(root) < deepest - 1e-5
    axes = SemiAxes(*map(jnp.asarray, (H, R, W)))
    assert float(support_radius(axes, SIN, COS)) == pytest.approx(deepest, abs=EXACT)
    assert float(ours(ABOVE).sinking) == pytest.approx(deepest - ABOVE, abs=EXACT)

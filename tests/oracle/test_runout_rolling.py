"""Rolling of a round block against an ellipse that rolls by itself, whose energy is
integrated here, without the package."""

import numpy as np
import pytest
from runout_scenes import DEAD, G, pieces_of
from scipy.integrate import quad

from jaximpact import Block
from jaximpact.runout import MotionMode, Profile, Release, simulate_runout

LEVEL = Profile([0.0, 1000.0], [0.0, 0.0], rolling_friction_angle=0.0)


# The round block has the inertia about its own contact, the ellipse more of it on
# average: it is slower by so much for the same energy.
@pytest.mark.parametrize(
    ("aspect_ratio", "slower"), [(1.0, 0.0), (1.2, 0.01), (1.5, 0.03), (2.0, 0.08)]
)
def test_a_round_block_is_little_faster_than_its_ellipse(aspect_ratio, slower):
    block = Block(aspect_ratio=aspect_ratio)
    runs = simulate_runout(LEVEL, Release(block, 10.0, 1.0, 12.0, 0.0, 0.0, 40.0), DEAD)
    rolling = pieces_of(runs, MotionMode.rolling)
    speed, spin = rolling.v_x[0], rolling.angular_velocity[0]
    radius = speed / spin
    major, minor = float(block.semi_axes.major), float(block.semi_axes.minor)
    inertia = (major**2 + minor**2) / 5.0
    energy = 0.5 * (speed**2 + inertia * spin**2)

    def height(theta):
        return np.hypot(minor * np.sin(theta), major * np.cos(theta))

    def time_per_angle(theta):
        arm = (minor**2 - major**2) * np.sin(theta) * np.cos(theta) / height(theta)
        about_contact = inertia + height(theta) ** 2 + arm**2
        kinetic = energy - G * (height(theta) - radius)
        return np.sqrt(0.5 * about_contact / kinetic)

    turn, _ = quad(time_per_angle, 0.0, 2.0 * np.pi, limit=200)
    perimeter, _ = quad(height, 0.0, 2.0 * np.pi, limit=200)
    assert radius == pytest.approx(perimeter / (2.0 * np.pi), rel=1e-4)
    mean = perimeter / turn
    # Rounding, and the radius of equal perimeter by a formula that is 1e-5 off.
    assert speed * (1.0 - slower) <= mean <= speed * (1.0 + 1e-4)

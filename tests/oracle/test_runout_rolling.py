"""Rolling against an ellipse that rolls by itself: integrated here, without the
package."""

import numpy as np
import pytest
from runout_scenes import DEAD, G, pieces_of
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from jaximpact import Block
from jaximpact.runout import MotionMode, Profile, Release, simulate_runout

LEVEL = Profile([0.0, 1000.0], [0.0, 0.0], rolling_friction_angle=0.0)


class Ellipse:
    """Ellipse of an ellipsoidal block of mass 1 that touches a plane."""

    def __init__(self, major, minor):
        self.major, self.minor = major, minor
        self.inertia = (major**2 + minor**2) / 5.0

    def height(self, theta):
        return np.hypot(self.minor * np.sin(theta), self.major * np.cos(theta))

    def arm(self, theta):
        """Derivative of the height."""
        difference = self.minor**2 - self.major**2
        return difference * np.sin(theta) * np.cos(theta) / self.height(theta)

    def bend(self, theta):
        """Second derivative of the height."""
        difference = self.minor**2 - self.major**2
        height = self.height(theta)
        return (difference * np.cos(2.0 * theta) - self.arm(theta) ** 2) / height

    def about_contact(self, theta):
        """Moment of inertia about the point that touches."""
        return self.inertia + self.height(theta) ** 2 + self.arm(theta) ** 2


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
    ellipse = Ellipse(float(block.semi_axes.major), float(block.semi_axes.minor))
    energy = 0.5 * (speed**2 + ellipse.inertia * spin**2)

    def time_per_angle(theta):
        kinetic = energy - G * (ellipse.height(theta) - radius)
        return np.sqrt(0.5 * ellipse.about_contact(theta) / kinetic)

    turn, _ = quad(time_per_angle, 0.0, 2.0 * np.pi, limit=200)
    perimeter, _ = quad(ellipse.height, 0.0, 2.0 * np.pi, limit=200)
    assert radius == pytest.approx(perimeter / (2.0 * np.pi), rel=1e-4)
    mean = perimeter / turn
    # Rounding, and the radius of equal perimeter by a formula that is 1e-5 off.
    assert speed * (1.0 - slower) <= mean <= speed * (1.0 + 1e-4)


def test_an_ellipse_leaves_the_ground_at_a_walking_pace():
    """On rigid level ground, at A_r 1.5; so nearly every block that rolls down a slope
    would hop."""
    ellipse = Ellipse(0.3, 0.2)

    def rates(_, state):
        theta, spin = state
        couple = ellipse.arm(theta) * (ellipse.height(theta) + ellipse.bend(theta))
        weight = -G * ellipse.arm(theta)
        return [spin, (weight - couple * spin**2) / ellipse.about_contact(theta)]

    def normal_force(_, state):
        theta, spin = state
        turning = ellipse.arm(theta) * rates(0.0, state)[1]
        return G + ellipse.bend(theta) * spin**2 + turning

    def least_force(speed):
        start = [0.5 * np.pi, speed / ellipse.minor]
        found = solve_ivp(rates, (0.0, 2.0), start, rtol=1e-9, max_step=1e-3)
        return min(normal_force(0.0, state) for state in found.y.T)

    lifts = brentq(least_force, 1.0, 3.0, rtol=1e-3)
    assert 1.0 < lifts < 2.5

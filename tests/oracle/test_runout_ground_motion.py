"""Motion of blocks along fine ground against energy integrals."""

import numpy as np
import pytest
from runout_scenes import DEAD, G
from scipy.optimize import brentq
from scipy.special import ellipk

from jaximpact import Block, ConstantCoefficients
from jaximpact.runout import (
    ClosedForm,
    Ending,
    Profile,
    Release,
    first_passages,
    passages,
    simulate_runout,
)
from jaximpact.runout.centre_path import CentrePath

SPHERE = Block(mass=500.0)
R = float(SPHERE.semi_axes.minor)
WHOLE = 1.4
"""1 + k of a sphere."""


def valley(radius, steepest, spacing, friction=0.0):
    """A circular valley up to a slope of an angle, points at a distance, the lowest at
    the origin."""
    count = int(np.ceil(steepest * radius / spacing))
    angle = np.linspace(-steepest, steepest, 2 * count + 1)
    return Profile(
        radius * np.sin(angle),
        radius * (1.0 - np.cos(angle)),
        rolling_friction_angle=np.arctan(friction),
    )


def rolled(profile, x, **how):
    """Run of a sphere from rest on the path of its centre at x."""
    path = CentrePath.of(profile, R)
    _, y = path.locate(np.array([x]), np.array([R]), np.ones(1))
    return simulate_runout(
        profile, Release(SPHERE, x, y + 1e-12, 0.0, 0.0), DEAD, **how
    )


def turning_points(runs):
    """Places where a block comes to rest on its way: x and y."""
    pieces = runs.pieces
    rests = (pieces.v_x == 0.0) & (pieces.v_y == 0.0) & (pieces.motion > 0)
    return pieces.x[rests], pieces.y[rests]


def period_of(runs):
    """Mean time of a swing between the first and the last passage of x = 0."""
    time = passages(runs, 0.0).time
    return 2.0 * (time[-1] - time[0]) / (len(time) - 1)


def period_in_circle(radius, largest):
    """Period of a sphere on the circle on which its centre moves, to an angle."""
    return 4.0 * np.sqrt(WHOLE * radius / G) * ellipk(np.sin(0.5 * largest) ** 2)


@pytest.mark.parametrize("spacing", [0.4, 0.2, 0.1])
def test_small_swings_in_a_circular_valley(spacing):
    r"""$T = 2\pi\sqrt{7/5\,(R - r)/g}$, and $1 + \vartheta^2/16$ of it.

    Where the sphere turns, a chord is steeper or flatter than the circle by (h / A)/2
    at most, for about the root of h / A of the time: the error is of the order 3/2."""
    amplitude, radius = 20.0, 1000.0
    profile = valley(radius, 0.03, spacing)
    path = radius - R
    small = 2.0 * np.pi * np.sqrt(WHOLE * path / G)
    runs = rolled(profile, -amplitude, time_limit=20.6 * small)
    assert runs.ending[0] == Ending.time_limit
    expected = small * (1.0 + (amplitude / path) ** 2 / 16.0)
    error = 0.25 * (spacing / amplitude) ** 1.5
    assert period_of(runs) == pytest.approx(expected, rel=error)
    x, y = turning_points(runs)
    assert len(x) >= 40
    # Sums of energies over 20 swings: rounding.
    np.testing.assert_allclose(np.abs(x), amplitude, atol=1e-6)
    np.testing.assert_allclose(y, y[0], atol=1e-9)


@pytest.mark.parametrize("largest", np.radians([30.0, 60.0, 80.0]))
def test_large_swings_in_a_circular_valley(largest):
    """The period by the complete elliptic integral, on ground that becomes steep."""
    radius, spacing = 40.0, 0.1
    profile = valley(radius, largest + 0.1, spacing)
    path = radius - R
    expected = period_in_circle(path, largest)
    runs = rolled(profile, -path * np.sin(largest), time_limit=5.3 * expected)
    assert runs.ending[0] == Ending.time_limit
    # (h / A)^1.5 is 2e-4 for the smallest.
    assert period_of(runs) == pytest.approx(expected, rel=1e-4)
    x, _ = turning_points(runs)
    np.testing.assert_allclose(np.abs(x), path * np.sin(largest), rtol=1e-6)


@pytest.mark.parametrize("friction", [0.02, 0.1, 0.3])
def test_friction_brings_a_block_to_rest_where_it_can_hold_it(friction):
    r"""From turning point to turning point $\Delta y = \mu |\Delta x|$ on the circle of
    the centre; the last is the first from which no way leads down."""
    radius, spacing = 20.0, 0.1
    path = radius - R
    steepest = 1.0
    runs = rolled(
        valley(radius, steepest + 0.05, spacing, friction), -path * np.sin(steepest)
    )
    assert runs.ending[0] == Ending.stopped

    def height(x):
        return path - np.sqrt(path**2 - x**2)

    x = [-path * np.sin(steepest)]
    hold = path * friction / np.hypot(1.0, friction)
    while abs(x[-1]) > hold:
        way = -np.sign(x[-1])

        def left(other, way=way):
            return height(x[-1]) - height(other) - friction * way * (other - x[-1])

        # Beyond where it is fastest.
        x.append(brentq(left, -way * hold, way * path))
    # A chord lies h^2/8R = 6e-5 m above the circle, at a slope of 0.2 at least from
    # where friction holds: 3e-4 m, and as much from the swing before.
    found, _ = turning_points(runs)
    np.testing.assert_allclose(found, x[1:-1], atol=2e-3)
    assert runs.x[0] == pytest.approx(x[-1], abs=2e-3)


@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("rise", [0.25, 0.8])
def test_a_sphere_stops_between_two_rises(friction, rise):
    """In a V it loses energy at every corner, and stops touching both sides."""
    profile = Profile(
        [-20.0, 0.0, 20.0],
        [20.0 * rise, 0.0, 20.0 * rise],
        rolling_friction_angle=np.arctan(friction),
    )
    runs = rolled(profile, -3.0)
    assert runs.ending[0] == Ending.stopped
    assert runs.x[0] == pytest.approx(0.0, abs=1e-6)
    assert runs.y[0] == pytest.approx(R * np.hypot(1.0, rise), abs=1e-6)


@pytest.mark.parametrize("spacing", [1.0, 0.5, 0.25, 0.1])
def test_no_sphere_stops_on_the_rounded_toe_of_a_dam(spacing):
    """Down a slope, and up a toe of radius 17 m to 45 degrees: friction holds up to 15
    degrees, and a chord of the toe turns by 3.4 degrees at most."""
    along = np.arange(0.0, 12.0 + 1e-9, spacing)
    face = 17.0 - np.sqrt(17.0**2 - along**2)
    x = np.concatenate([[0.0, 60.0], 70.0 + along, [92.0, 200.0]])
    y = np.concatenate([[40.0, 0.0], face, [face[-1] + 10.0] * 2])
    g = np.random.default_rng(0)
    n = 200
    slope = Profile(x, y, rolling_friction_angle=np.radians(15.0))
    at = g.uniform(3.0, 30.0, n)
    block = Block(mass=np.exp(g.normal(6.0, 0.5, n)))
    runs = simulate_runout(
        slope,
        Release(block, at, slope.height(at) + 2.0),
        ClosedForm(ConstantCoefficients(e_n=0.2, e_t=0.95)),
    )
    # Most come to where it rises by 20 degrees.
    count, _ = first_passages(passages(runs, 76.0), n)
    assert np.mean(count > 0) > 0.5
    assert np.mean(runs.ending == Ending.stopped) > 0.9
    on_face = (runs.ending == Ending.stopped) & (runs.x > 70.0) & (runs.x < 92.0)
    angle = np.arcsin((np.minimum(runs.x, 82.0) - 70.0) / 17.0)
    assert np.all(angle[on_face] < np.radians(15.0) + spacing / 17.0)

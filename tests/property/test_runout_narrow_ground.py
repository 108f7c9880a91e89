"""A sphere at steps, edges and gaps that are narrower than it is: exact places."""

import numpy as np
import pytest
from runout_scenes import SPHERE, R, rolling_sphere, rows_of_records

from jaximpact import ConstantCoefficients, Soil
from jaximpact.runout import ClosedForm, Ending, Profile, Release, simulate_runout

LAW = ClosedForm(ConstantCoefficients(e_n=0.35, e_t=0.85))


def first_strike(points, speed=5.0):
    """Of a sphere that rolls along the level towards what begins at x = 0."""
    x, y = zip(*points, strict=True)
    profile = Profile([-20.0, *x, 40.0], [0.0, *y, y[-1]], Soil(), 0.0)
    runs = simulate_runout(profile, rolling_sphere(profile, -3.0, speed), LAW)
    return rows_of_records(runs.contacts, np.argmax(runs.contacts.outcome >= 0))


@pytest.mark.parametrize("high", [0.1, 0.4, 0.9])
@pytest.mark.parametrize("wide", [1e-3, 0.05])
def test_a_sphere_strikes_the_top_of_a_step(high, wide):
    r"""A circle on the level touches the top of a step of height h < R
    $\sqrt{2 R h - h^2}$ before it, by a plane whose normal points to its centre."""
    h = high * R
    strike = first_strike([(0.0, 0.0), (wide * h, h)])
    before = np.sqrt(2.0 * R * h - h**2)
    assert strike.x == pytest.approx(wide * h - before, abs=1e-9)
    assert strike.y == pytest.approx(R, abs=1e-9)
    assert strike.slope == pytest.approx(-np.arcsin(before / R), abs=1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("high", [0.2, 2.0])
def test_a_sphere_that_falls_on_an_edge_is_thrown_off_it(high, side):
    """From both sides alike, by the direction from the edge to the centre, on a kerb as
    on a wall: the level ground beside it is long."""
    x = np.array([-20.0, 0.0, 1e-3, 20.0])
    y = np.array([0.0, 0.0, high * R, high * R])
    beside = 0.3 * R
    if side < 0.0:
        x, y = -x[::-1], y[::-1]
    profile = Profile(x, y)
    release = Release(SPHERE, side * (1e-3 - beside), 4.0)
    strike = simulate_runout(profile, release, LAW).contacts
    assert strike.slope[0] == pytest.approx(-side * np.arcsin(0.3), abs=1e-6)
    assert strike.y[0] == pytest.approx(high * R + np.sqrt(R**2 - beside**2), abs=1e-6)


@pytest.mark.parametrize(("width", "speed"), [(0.2, 1.2), (0.6, 0.6), (1.2, 0.3)])
def test_a_sphere_strikes_the_far_edge_of_a_gap(width, speed):
    """Too slow to fly and fast enough for an impact, it turns about the near edge of a
    gap until it touches the far one, half-way, at the angle of sine w / (2 R)."""
    gap = width * R
    deep = 5.0 * R
    points = [(0.0, 0.0), (0.01, -deep), (gap - 0.01, -deep), (gap, 0.0)]
    strike = first_strike(points, speed)
    assert strike.x == pytest.approx(0.5 * gap, abs=1e-9)
    assert strike.y == pytest.approx(np.sqrt(R**2 - 0.25 * gap**2), abs=1e-9)
    assert strike.slope == pytest.approx(-np.arcsin(0.5 * gap / R), abs=1e-9)


def test_a_sphere_over_a_gap_narrower_than_itself_rests_on_both_edges():
    """The floor of the gap is out of its reach."""
    gap = 1.1 * R
    points = [(0.0, 0.0), (0.4 * R, -3.0 * R), (0.7 * R, -3.0 * R), (gap, 0.0)]
    x, y = zip(*points, strict=True)
    profile = Profile([-20.0, *x, 20.0], [0.0, *y, 0.0])
    runs = simulate_runout(profile, Release(SPHERE, 0.5 * gap, 0.9 * R), LAW)
    assert runs.ending[0] == Ending.stopped
    # What is slower than an impact may leave it a hundredth of its size above.
    assert runs.x[0] == pytest.approx(0.5 * gap, abs=0.02 * R)
    assert runs.y[0] == pytest.approx(np.sqrt(R**2 - 0.25 * gap**2), abs=0.02 * R)

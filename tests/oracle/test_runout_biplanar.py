"""The paper's slope of two planes: what is known of it exactly, and the numbers that
figures and claims take from runs."""

import numpy as np
import pytest
from runout_scenes import SPHERE, G, R, impact_of, rows_of_records

from jaximpact import Block, ConstantCoefficients, Scene, Soil, simulate_batch
from jaximpact.runout import (
    ClosedForm,
    FullModel,
    MotionMode,
    Profile,
    Release,
    simulate_runout,
)
from paper.biplanar import (
    ASPECT_RATIOS,
    COMPARED_X,
    SLOPE,
    SPEED,
    SPINS_DEGPS,
    BiplanarCase,
    bounces,
    jumps,
    off_the_parabola,
    paths_apart,
    restitutions,
)

SHAPE = len(ASPECT_RATIOS), len(SPINS_DEGPS)


@pytest.fixture(scope="module")
def runs():
    """The runs on Table 1."""
    case = BiplanarCase()
    return simulate_runout(case.profile(Soil()), case.release(), FullModel("fast"))


@pytest.fixture(scope="module")
def flying():
    """The same runs where each hop is a flight that ends in an impact."""
    case = BiplanarCase()
    slope, release = case.profile(Soil()), case.release()
    return simulate_runout(slope, release, FullModel("fast"), hop_threshold=0.0)


def test_slope_is_30_degrees_as_the_paper_rounds_it():
    assert round(np.degrees(SLOPE)) == 30
    profile = BiplanarCase().profile(Soil())
    np.testing.assert_allclose(profile.slope, [SLOPE, 0.0])


def test_shapes_start_alike_with_equal_energies():
    release = BiplanarCase().release()
    for name in ("x", "y", "v_x", "v_y", "orientation"):
        assert np.ptp(getattr(release, name)) == 0.0
    mass, inertia = release.mass_properties
    np.testing.assert_allclose(mass, 100.0)
    assert np.hypot(release.v_x, release.v_y)[0] == pytest.approx(SPEED, rel=1e-15)
    turning = (0.5 * inertia * release.angular_velocity**2).reshape(SHAPE)
    expected = 0.5 * 0.4 * 100.0 * R**2 * np.radians(SPINS_DEGPS) ** 2
    np.testing.assert_allclose(turning, np.tile(expected, (5, 1)), rtol=1e-12)
    same = BiplanarCase(equal_energy=False, spin_sense=-1.0).release()
    np.testing.assert_allclose(
        same.angular_velocity.reshape(SHAPE), -np.tile(np.radians(SPINS_DEGPS), (5, 1))
    )


@pytest.mark.slow
def test_the_sphere_comes_down_where_its_parabola_does(runs):
    """Where the centre is at its radius from the plane. It touches from a gap of 1e-9
    of the radius on."""
    case = BiplanarCase()
    v_x, v_y = SPEED * np.cos(case.direction), SPEED * np.sin(case.direction)
    above = case.height - R / np.cos(SLOPE)
    rising = v_y + v_x * np.tan(SLOPE)
    x = v_x * (rising + np.sqrt(rising**2 + 2.0 * G * above)) / G
    assert runs.contacts.x[0] == pytest.approx(x, rel=1e-8)
    # The paper's 250 m are out of reach of this flight.
    assert x == pytest.approx(60.4, abs=0.1)
    assert np.max(off_the_parabola(runs)) < 1e-9


def test_a_sphere_that_drops_jumps_by_the_square_of_its_coefficient():
    flat = Profile([0.0, 10.0], [0.0, 0.0])
    law = ClosedForm(ConstantCoefficients(0.7, 1.0))
    runs = simulate_runout(flat, Release(SPHERE, 5.0, 1.0 + R), law)
    flights = jumps(runs)
    expected = R + 0.49 ** np.arange(len(flights.height))
    # Each touch is early by up to 1e-9 of the block.
    np.testing.assert_allclose(flights.height, expected, atol=1e-8)
    np.testing.assert_allclose(flights.rise[1:], expected[1:] - R, atol=1e-8)
    assert flights.rise[0] == 0.0
    # A law that takes no time leaves no piece of a contact between the flights.
    assert not flights.after_contact.any()


@pytest.mark.slow
def test_heights_are_the_largest_on_the_way(flying):
    """Over the toe too, where the ground bends: against 400 samples of each flight,
    which can miss the top by (duration/800)^2 g/2."""
    runs = flying
    flights = jumps(runs)
    p = type(runs.pieces)(*(column[flights.piece] for column in runs.pieces))
    time = p.duration[:, None] * np.linspace(0.0, 1.0, 401)
    x = p.x[:, None] + p.v_x[:, None] * time
    y = p.y[:, None] + (p.v_y[:, None] - 0.5 * G * time) * time
    sampled = np.max(y - runs.profile.height(x), axis=1)
    assert np.any((x[:, 0] < 400.0) & (x[:, -1] > 400.0))
    assert np.all(flights.height >= sampled - 1e-9)
    missed = (p.duration / 800.0) ** 2 * G / 2.0
    assert np.all(flights.height <= sampled + missed + 1e-9)
    start = p.y - runs.profile.height(p.x)
    np.testing.assert_allclose(flights.rise, flights.height - start, atol=1e-12)


def test_a_law_of_constant_coefficients_has_these():
    case = BiplanarCase()
    law = ClosedForm(ConstantCoefficients(0.5, 0.8))
    runs = simulate_runout(case.profile(Soil()), case.release(), law)
    found = restitutions(runs)
    impacts = runs.contacts.outcome >= 0
    # The law has no depth to climb out of, but a sphere that touches is some 1e-9 of
    # its size above the ground, which counts where it is slow.
    spheres = impacts & (runs.contacts.trajectory < len(SPINS_DEGPS))
    np.testing.assert_allclose(found.e_n[spheres], 0.5, rtol=1e-5)
    np.testing.assert_allclose(found.e_t[spheres], 0.8, rtol=1e-5)
    assert np.isnan(found.e_n[~impacts]).all()


@pytest.mark.slow
def test_coefficients_before_the_climb_are_those_of_the_impact(runs):
    """First impacts of all shapes, against `simulate_batch`."""
    with_climb = restitutions(runs)
    without = restitutions(runs, out_of_the_crater=False)
    blocks = np.arange(0, runs.release.count, len(SPINS_DEGPS))
    first = np.searchsorted(runs.contacts.trajectory, blocks)
    impact = impact_of(rows_of_records(runs.contacts, first))
    scene = Scene(Block(aspect_ratio=ASPECT_RATIOS), Soil(), impact)
    alone = simulate_batch(scene, accuracy="fast")
    # The block touches 1e-9 of its size above the ground.
    np.testing.assert_allclose(without.e_n[first], alone.e_n, rtol=1e-6)
    np.testing.assert_allclose(without.e_t[first], alone.e_t, rtol=1e-6)
    assert np.all(np.abs(with_climb.e_n[first]) < np.abs(without.e_n[first]))
    assert np.all(with_climb.e_t[first] < without.e_t[first])


@pytest.mark.slow
def test_paths_are_apart_by_what_they_are_seen_to_be(runs):
    apart = paths_apart(runs)
    assert apart[0] == 0.0
    heights = []
    for block in range(0, runs.release.count, len(SPINS_DEGPS)):
        path = runs.path(block, 0.01)
        # Set back on the ground a block may turn back a little: the first passage.
        ends = [int(np.argmax(path["x"] >= place)) for place in COMPARED_X]
        around = [slice(end - 1, end + 1) for end in ends]
        pairs = zip(COMPARED_X, around, strict=True)
        heights.append([np.interp(x, path["x"][k], path["y"][k]) for x, k in pairs])
    found = np.max(np.abs(np.array(heights) - heights[0]), axis=1)
    # Chords of 0.01 s lie g/8 1e-4 s2 below the path.
    np.testing.assert_allclose(apart, found, rtol=0.0, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("which", ["runs", "flying"])
def test_bounces_are_the_flights_before_a_block_rolls(which, request):
    runs = request.getfixturevalue(which)
    flights = jumps(runs)
    found = bounces(runs, flights)
    rise_of = dict(zip(flights.piece, flights.rise, strict=True))
    for block in range(runs.release.count):
        pieces = np.flatnonzero(runs.pieces.trajectory == block)
        rises, rolls = [], False
        for piece in pieces[1:]:
            way = runs.pieces.motion[piece]
            if way == MotionMode.rolling:
                rolls = True
                break
            if way == MotionMode.flight:
                rises.append(rise_of[piece])
        assert found["bounces"][block] == len(rises)
        assert found["highest_bounce_m"][block] == max(rises, default=0.0)
        assert found["rolls"][block] == rolls

"""Ground that is narrower than blocks: steps, gaps, ditches and walls."""

import numpy as np
import pytest
from runout_scenes import gain_between_pieces, gain_over_contacts

from jaximpact import Block, ConstantCoefficients, Soil
from jaximpact.runout import (
    ClosedForm,
    Ending,
    FullModel,
    Profile,
    Release,
    simulate_runout,
)
from jaximpact.runout.trajectory import MotionMode, state_after

LAW = ClosedForm(ConstantCoefficients(e_n=0.35, e_t=0.85))
SPHERE = Block(mass=100.0)
R = float(SPHERE.semi_axes.minor)


def walls(generator):
    """A slope with walls of centimetres and ditches between faces of 60 to 89°."""
    x, y = [0.0], [0.0]
    for _ in range(4):
        high, wide = generator.uniform(0.5, 6.0), generator.uniform(0.01, 0.6)
        turn = generator.choice([-1.0, 1.0])
        faces = high / np.tan(np.radians(generator.uniform(60.0, 89.0, 2)))
        for along, up in (
            *[(generator.uniform(2.0, 15.0), -generator.uniform(0.0, 8.0))],
            *[(faces[0], turn * high), (wide, 0.0), (faces[1], -turn * high)],
        ):
            x.append(x[-1] + along)
            y.append(y[-1] + up)
    return Profile([*x, x[-1] + 30.0], [*y, y[-1]])


def sawtooth(generator):
    """A slope of points at random, some of them closer than blocks are wide."""
    along = generator.uniform(0.05, 1.0, 60)
    up = -0.5 * along + generator.normal(0.0, generator.uniform(0.05, 0.6), 60)
    x, y = np.cumsum([0.0, *along]), np.cumsum([0.0, *up])
    return Profile([*x, x[-1] + 30.0], [*y, y[-1]])


def blocks_over(profile, generator, count=40):
    return Release(
        Block(
            mass=2600.0 * 10.0 ** generator.uniform(-2.0, 1.0, count),
            aspect_ratio=generator.choice([1.0, 1.5, 2.5, 4.0], count),
        ),
        generator.uniform(0.0, 0.8 * profile.x[-1], count),
        np.max(profile.y) + 4.0,
        v_x=generator.uniform(-5.0, 15.0, count),
        orientation=generator.uniform(0.0, np.pi, count),
        angular_velocity=generator.normal(0.0, 10.0, count),
    )


def distance_to_ground(profile, x, y):
    """Distance from points over a profile to it [m], segment by segment."""
    nearest = np.full(len(x), np.inf)
    for i in range(profile.segments):
        start = np.array([profile.x[i], profile.y[i]])
        along = np.array([profile.x[i + 1], profile.y[i + 1]]) - start
        from_start = np.stack([x, y], axis=1) - start
        part = np.clip(from_start @ along / (along @ along), 0.0, 1.0)
        apart = from_start - part[:, None] * along
        nearest = np.minimum(nearest, np.hypot(*apart.T))
    return nearest


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("of_profile", [walls, sawtooth])
def test_blocks_find_their_ends_among_walls(of_profile, seed):
    """No run fails or goes on for ever, no centre is in the ground, no energy comes
    from nowhere, and no block rolls deeper into ground than it began to."""
    generator = np.random.default_rng(seed)
    profile = of_profile(generator)
    runs = simulate_runout(profile, blocks_over(profile, generator), LAW)
    assert set(runs.ending) <= {Ending.stopped, Ending.left_profile}
    pieces = runs.pieces
    inside = profile.height(pieces.x) - pieces.y > 1e-9
    inside &= (pieces.x >= profile.x[0]) & (pieces.x <= profile.x[-1])
    assert not np.any(inside)
    stopped = runs.ending == Ending.stopped
    assert np.all(profile.height(runs.x) <= runs.y + 1e-9, where=stopped)
    gain, mass = gain_between_pieces(runs)
    # of a lift by 1e-7 m: a touch may be early by 1e-9 of the block
    assert np.max(gain / mass, initial=0.0) < 1e-6

    sphere = runs.release.block.aspect_ratio[pieces.trajectory] == 1.0
    rolls = np.flatnonzero(sphere & (pieces.motion == MotionMode.rolling))
    rolling = type(pieces)(*(column[rolls] for column in pieces))
    # Past the ends of the profile there is no ground to be in.
    at_end = state_after(rolling, rolling.duration).x
    there = (at_end > profile.x[0]) & (at_end < profile.x[-1])
    rolling = type(pieces)(*(column[there] for column in rolling))
    radius = runs.release.block.semi_axes.minor[rolling.trajectory]
    depths = []
    for part in np.linspace(0.0, 1.0, 9):
        at = state_after(rolling, part * rolling.duration)
        depths.append(radius - distance_to_ground(profile, at.x, at.y))
    # Pieces lie apart from the path that the centre takes by a hundredth of the radius.
    assert np.all(np.max(depths, axis=0) < np.maximum(depths[0], 0.0) + 0.01 * radius)


@pytest.mark.parametrize("of_profile", [walls, sawtooth])
@pytest.mark.parametrize("seed", range(2))
def test_no_contact_that_takes_time_adds_energy(of_profile, seed):
    """Blocks travel along steep faces during contacts of the full model, up too, and
    climb out of the ground, no further than their energy reaches."""
    generator = np.random.default_rng(seed)
    profile = of_profile(generator)
    release = blocks_over(profile, generator)
    runs = simulate_runout(profile, release, FullModel("fast"))
    assert set(runs.ending) <= {Ending.stopped, Ending.left_profile}
    for gain, mass in (gain_between_pieces(runs), gain_over_contacts(runs)):
        # 0.3 J/kg without these limits; a touch may be early by 1e-9 of the block
        assert np.max(gain / mass, initial=0.0) < 1e-6


@pytest.mark.parametrize("seed", range(4))
def test_what_other_blocks_are_there_changes_no_bit(seed):
    """Which places are narrow depends on the largest block, but no block's run does."""
    generator = np.random.default_rng(seed)
    profile = [walls, sawtooth][seed % 2](generator)
    release = blocks_over(profile, generator)
    runs = simulate_runout(profile, release, LAW)
    for i in range(0, 40, 3):
        alone = simulate_runout(profile, release.of_blocks(np.array([i])), LAW)
        assert (alone.x[0], alone.y[0]) == (runs.x[i], runs.y[i])


def rolling_on_the_level(points, speed=5.0):
    """A sphere that rolls along the level towards what begins at x = 0."""
    x, y = zip(*points, strict=True)
    profile = Profile([-20.0, *x, 40.0], [0.0, *y, y[-1]], Soil(), 0.0)
    release = Release(SPHERE, -3.0, R, speed, 0.0, 0.0, speed / R)
    runs = simulate_runout(profile, release, LAW)
    strikes = np.flatnonzero(runs.contacts.outcome >= 0)
    return runs, type(runs.contacts)(*(c[strikes[0]] for c in runs.contacts))


@pytest.mark.parametrize("high", [0.1, 0.4, 0.9])
@pytest.mark.parametrize("wide", [1e-3, 0.05])
def test_a_sphere_strikes_the_top_of_a_step(high, wide):
    r"""A circle on the level touches the top of a step of height h < R
    $\sqrt{2 R h - h^2}$ before it, by a plane whose normal points to its centre."""
    h = high * R
    _, strike = rolling_on_the_level([(0.0, 0.0), (wide * h, h)])
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
    _, strike = rolling_on_the_level(points, speed)
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

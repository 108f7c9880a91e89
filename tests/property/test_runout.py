"""Run-out: exact facts, energy, symmetry, endings, and that nothing depends on how
trajectories are put together."""

import dataclasses

import jax
import numpy as np
import pytest
from runout_scenes import (
    BIPLANAR,
    DEAD,
    FLAT,
    LAWS,
    SPHERE,
    G,
    R,
    gain_between_pieces,
    pieces_of,
)

from jaximpact import (
    Block,
    ConstantCoefficients,
    Impact,
    Outcome,
    PfeifferBowen,
    Scene,
    Soil,
    simulate,
    simulate_batch,
)
from jaximpact.errors import InputError
from jaximpact.rebound import Rebound
from jaximpact.runout import (
    ClosedForm,
    Ending,
    FullModel,
    MotionMode,
    Profile,
    Release,
    passages,
    simulate_runout,
)
from jaximpact.runout.blocks import Body
from jaximpact.runout.trajectory import state_after


def inclined(angle, length=200.0, **values):
    """A plane that descends to the right from the origin."""
    x = length * np.cos(angle)
    return Profile([0.0, x], [0.0, -length * np.sin(angle)], **values)


def blocks_above(profile, generator, count):
    """Blocks of many kinds in the air."""
    aspect_ratio = generator.uniform(0.5, 4.0, count)
    aspect_ratio[:: max(1, count // 5)] = 1.0
    block = Block(
        mass=generator.uniform(20.0, 2000.0, count), aspect_ratio=aspect_ratio
    )
    size = np.max(np.asarray(block.semi_axes.major + block.semi_axes.minor))
    return Release(
        block,
        generator.uniform(profile.x[0], profile.x[-1], count),
        np.max(profile.y) + size,
        generator.normal(0.0, 8.0, count),
        generator.normal(0.0, 5.0, count),
        generator.uniform(0.0, 6.0, count),
        generator.normal(0.0, 50.0, count),
    )


def rough(generator):
    """A slope with corners and edges, coarse or finer than the blocks."""
    points = generator.integers(2, 50)
    steps = generator.uniform(0.1, generator.choice([1.0, 8.0]), points)
    slopes = generator.normal(-0.5, generator.choice([0.05, 0.5]), points)
    return Profile(
        np.cumsum(steps),
        np.cumsum(slopes * steps),
        Soil(alpha_s=generator.uniform(0.3, 1.2)),
        generator.uniform(0.0, 0.6, points - 1),
    )


def test_a_projectile_comes_down_where_it_must():
    """Level ground, thrown at 30 degrees from the height of its radius."""
    speed, angle = 20.0, np.radians(30.0)
    release = Release(SPHERE, 0.0, R, speed * np.cos(angle), speed * np.sin(angle))
    runs = simulate_runout(FLAT, release, DEAD)
    # Touching counts from a gap of 1e-9 of the block's size on.
    assert runs.contacts.x[0] == pytest.approx(
        speed**2 * np.sin(2.0 * angle) / G, rel=1e-9
    )
    assert runs.contacts.time[0] == pytest.approx(2.0 * speed * np.sin(angle) / G)


def test_a_sphere_bounces_in_a_geometric_sequence():
    """Its lowest point falls 1 m; every bounce takes 0.7 of the time of the last."""
    runs = simulate_runout(
        FLAT, Release(SPHERE, 500.0, 1.0 + R), ClosedForm(ConstantCoefficients(0.7, 1))
    )
    fall = np.sqrt(2.0 / G)
    flights = 2.0 * fall * 0.7 ** np.arange(1, len(runs.contacts.time))
    expected = fall + np.concatenate([[0.0], np.cumsum(flights)])
    # Each touch is early by up to 1e-9 of the block, over the speed then.
    np.testing.assert_allclose(runs.contacts.time, expected, atol=1e-8)
    np.testing.assert_allclose(expected[:3], [0.451524, 1.083657, 1.526150], atol=1e-6)
    assert runs.count_endings() == {"stopped": 1}
    assert runs.x[0] == 500.0
    assert runs.y[0] == pytest.approx(R, rel=1e-8)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_sphere_rolls_down_a_plane(way):
    slope, friction = np.radians(25.0) * way, np.radians(10.0)
    profile = inclined(slope, rolling_friction_angle=friction)
    x = 50.0
    height = -x * np.tan(slope) + R / np.cos(slope)
    v = 3.0 * way
    release = Release(
        SPHERE, x, height, v * np.cos(slope), -v * np.sin(slope), 0.0, v / R
    )
    runs = simulate_runout(profile, release, DEAD)
    rolling = pieces_of(runs, MotionMode.rolling)
    assert len(rolling.time) == 1
    expected = (
        way * G * (np.sin(abs(slope)) - np.tan(friction) * np.cos(slope)) / 1.4
    )  # a sphere has I = 2/5 m R^2
    along = rolling.a_x[0] * np.cos(slope) - rolling.a_y[0] * np.sin(slope)
    assert along == pytest.approx(expected, rel=1e-12)
    # It starts with a fall of 1e-9 of its size, which takes it 7 microseconds, and a
    # touch that takes nothing from it.
    assert np.hypot(rolling.v_x[0], rolling.v_y[0]) == pytest.approx(3.0, rel=1e-5)
    assert rolling.angular_velocity[0] == pytest.approx(v / R, rel=1e-5)
    assert runs.count_endings() == {"left profile": 1}


def test_a_sphere_rolls_to_rest_on_the_flat():
    friction = np.radians(15.0)
    profile = dataclasses.replace(FLAT, rolling_friction_angle=friction)
    runs = simulate_runout(
        profile, Release(SPHERE, 100.0, R, 10.0, 0.0, 0.0, 10.0 / R), DEAD
    )
    reach = 10.0**2 / (2.0 * G * np.tan(friction) / 1.4)
    # It starts with a fall that takes 7 microseconds.
    assert runs.x[0] - 100.0 == pytest.approx(reach, abs=1e-4)
    assert runs.count_endings() == {"stopped": 1}


def test_slip_is_lost_at_once_and_angular_momentum_kept():
    """A sphere that slides onto the flat without spin rolls at 5/7 of its speed."""
    runs = simulate_runout(FLAT, Release(SPHERE, 100.0, R, 7.0), DEAD)
    rolling = pieces_of(runs, MotionMode.rolling)
    assert rolling.v_x[0] == pytest.approx(5.0, rel=1e-6)
    assert rolling.angular_velocity[0] == pytest.approx(5.0 / R, rel=1e-6)


def test_a_slow_long_block_lies_down_and_slides():
    block = Block(aspect_ratio=3.0)
    height = float(block.semi_axes.minor)
    soil = Soil(alpha_s=0.5)
    profile = dataclasses.replace(FLAT, soil=soil)
    speed = 1.0
    release = Release(block, 100.0, height, speed, 0.0, 0.5 * np.pi)
    runs = simulate_runout(profile, release, DEAD)
    sliding = pieces_of(runs, MotionMode.sliding)
    friction = 0.5 * np.tan(np.radians(30.0))
    assert len(sliding.time) == 1
    assert runs.x[0] - sliding.x[0] == pytest.approx(
        speed**2 / (2.0 * G * friction),
        rel=1e-7,  # it has to climb by 1e-9 of its size
    )
    assert runs.y[0] == pytest.approx(height, rel=1e-8)


def test_a_long_block_rolls_where_the_slope_turns_it_over():
    """Aspect ratio 1.2 falls over its long axis from 10.4 degrees on, friction aside;
    3 does from 53.1 on."""
    slope = np.radians(30.0)
    profile = inclined(slope, rolling_friction_angle=np.radians(5.0))
    ways = []
    for aspect_ratio in (1.2, 3.0):
        block = Block(aspect_ratio=aspect_ratio)
        height = float(block.semi_axes.minor)
        release = Release(
            block,
            50.0,
            -50.0 * np.tan(slope) + height / np.cos(slope),
            0.0,
            0.0,
            slope + 0.5 * np.pi,
        )
        runs = simulate_runout(profile, release, DEAD)
        # A round block takes its place on the ground, as a contact.
        others = {MotionMode.flight, MotionMode.contact}
        ways.append(set(runs.pieces.motion) - others)
    assert ways == [{MotionMode.rolling}, {MotionMode.sliding}]


def test_a_sphere_leaves_an_edge_if_it_is_fast():
    """From the flat over an edge: at once if v^2 > g R; if slower it turns about the
    edge, by an angle at which v^2 = g R cos, if there is slope enough for it."""
    drop = np.radians(60.0)
    profile = Profile([-1.0, 0.0, 50.0], [0.0, 0.0, -50.0 * np.tan(drop)], Soil(), 0.0)
    fast = np.sqrt(1.5 * G * R)
    runs = simulate_runout(
        profile, Release(SPHERE, -1.0, R, fast, 0.0, 0.0, fast / R), DEAD
    )
    flight = pieces_of(runs, MotionMode.flight)
    assert (flight.x[1], flight.y[1]) == pytest.approx((0.0, R), abs=1e-8)
    assert (flight.v_x[1], flight.v_y[1]) == pytest.approx((fast, 0.0), rel=1e-6)

    slow = np.sqrt(0.5 * G * R)
    runs = simulate_runout(
        profile, Release(SPHERE, -1.0, R, slow, 0.0, 0.0, slow / R), DEAD
    )
    flight = pieces_of(runs, MotionMode.flight)
    # v^2 + 2 g R (1 - cos)/1.4 = g R cos, and 0.001 rad beyond
    angle = np.arccos((0.5 + 2.0 / 1.4) / (1.0 + 2.0 / 1.4)) + 1e-3
    assert flight.x[1] == pytest.approx(R * np.sin(angle), rel=1e-6)
    speed = np.hypot(flight.v_x[1], flight.v_y[1])
    assert speed**2 == pytest.approx(
        slow**2 + 2.0 * G * R * (1.0 - np.cos(angle)) / 1.4, rel=1e-6
    )

    gentle = Profile([-1.0, 0.0, 50.0], [0.0, 0.0, -50.0 * np.tan(0.1)], Soil(), 0.0)
    runs = simulate_runout(
        gentle, Release(SPHERE, -1.0, R, slow, 0.0, 0.0, slow / R), DEAD
    )
    assert len(pieces_of(runs, MotionMode.flight).time) == 1
    # To the edge, about it, and down from it.
    assert len(pieces_of(runs, MotionMode.rolling).time) == 3


@pytest.mark.parametrize(("share", "over"), [(1.01, True), (0.99, False)])
def test_a_crest_takes_energy_to_cross(share, over):
    """Up 10 degrees for 5 m without friction, and as far down."""
    rise = np.radians(10.0)
    far = 5.0 * np.cos(rise)
    top = 5.0 * np.sin(rise)
    profile = Profile(
        [-100.0, 0.0, far, 2 * far, 200.0], [0.0, 0.0, top, 0.0, 0.0], Soil(), 0.0
    )
    # Started on the way up; the corner at its foot would cost it.
    height = 1.0 * np.sin(rise)
    x, y = 1.0 * np.cos(rise) - R * np.sin(rise), height + R * np.cos(rise)
    needed = 2.0 * G * (top + R - y) / 1.4
    v = share * np.sqrt(needed)
    release = Release(SPHERE, x, y, v * np.cos(rise), v * np.sin(rise), 0.0, v / R)
    runs = simulate_runout(profile, release, DEAD, time_limit=8.0)
    assert (np.max(runs.path(0)["x"]) > far + R) == over


def test_a_block_strikes_the_next_segment_in_a_corner():
    rise = np.radians(40.0)
    profile = Profile([0.0, 50.0, 100.0], [0.0, 0.0, 50.0 * np.tan(rise)], Soil(), 0.0)
    runs = simulate_runout(
        profile, Release(SPHERE, 10.0, R, 7.0, 0.0, 0.0, 7.0 / R), DEAD
    )
    blow = 1 if runs.contacts.outcome[0] < 0 else 0
    c = type(runs.contacts)(*(column[blow] for column in runs.contacts))
    assert c.segment == 1
    assert c.slope == pytest.approx(-rise)
    assert c.x == pytest.approx(50.0 - R * np.tan(0.5 * rise), rel=1e-9)
    assert c.normal_velocity_before == pytest.approx(7.0 * np.sin(rise), rel=1e-6)
    assert c.tangential_velocity_before == pytest.approx(7.0 * np.cos(rise), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
def test_energy_never_grows_on_rough_slopes(law):
    """Kinetic and potential energy from piece to piece of the way. Every run ends by
    itself."""
    generator = np.random.default_rng(5)
    for _ in range(12):
        profile = rough(generator)
        release = blocks_above(profile, generator, 60)
        runs = simulate_runout(profile, release, ClosedForm(law))
        assert set(runs.ending) <= {Ending.stopped, Ending.left_profile}
        gain, mass = gain_between_pieces(runs)
        # of a lift by 1e-7 m: a touch may be early by 1e-9 of the block, and blocks
        # here are of some metres at most
        assert np.max(gain / (mass * G)) < 1e-7


def test_contacts_that_take_time_are_no_faster_than_flights():
    """Their pieces begin with the velocities with which the flight before ends, and end
    along the plane as the contact does, and out of it as fast as they went in: no speed
    on the way is greater than one at an end of a flight. A block that has turned is set
    back out of the ground by a piece of its own."""
    block = Block(mass=100.0, aspect_ratio=np.repeat([1.0, 2.0, 4.0], 4))
    release = Release(block, 0.0, 235.0, 20.0, 3.0, 0.4, np.tile([0, 20, 90, 200], 3))
    runs = simulate_runout(
        BIPLANAR, release, FullModel("fast"), event_limit=60, hop_threshold=0.0
    )
    p = runs.pieces
    before, contact, after = (p.motion[i : len(p.motion) - 2 + i] for i in range(3))
    between = (before == MotionMode.flight) & (contact == MotionMode.contact)
    between &= (after != MotionMode.rolling) & (p.trajectory[:-2] == p.trajectory[2:])
    contacts = np.flatnonzero(between) + 1
    assert len(contacts) > 100
    starts, ends = Body(*p[4:8], *p[10:12]), state_after(p, p.duration)
    # The flight is worked out from its start by other sums: rounding.
    for start, end in zip(starts, ends, strict=True):
        np.testing.assert_allclose(
            start[contacts], end[contacts - 1], rtol=0.0, atol=1e-9
        )
    for name in ("x", "y"):
        # Up to a hundred-millionth of the block nothing is recorded.
        np.testing.assert_allclose(
            getattr(starts, name)[contacts + 1],
            getattr(ends, name)[contacts],
            rtol=0.0,
            atol=1e-8,
        )
    fastest = np.maximum(np.hypot(p.v_x, p.v_y)[contacts], 1.0)
    # Spin becomes speed along the plane: by some hundredths.
    assert np.all(np.hypot(ends.v_x, ends.v_y)[contacts] < 1.03 * fastest)


@pytest.mark.parametrize(("threshold", "least"), [(0.0, 4), (1.0, 3)])
@pytest.mark.parametrize("contacts", [*map(ClosedForm, LAWS[::3]), FullModel("fast")])
def test_a_mirrored_slope_gives_the_mirrored_run(contacts, threshold, least):
    release = Release(
        Block(aspect_ratio=[1.0, 2.0, 3.5]),
        *(1.0, 232.0, 15.0, 3.0),
        [0.0, 0.4, 1.2],
        [0.0, 3.0, -2.0],
    )
    mirrored = dataclasses.replace(
        release,
        x=-release.x,
        v_x=-release.v_x,
        orientation=-release.orientation,
        angular_velocity=-release.angular_velocity,
    )
    profile = Profile(-BIPLANAR.x[::-1], BIPLANAR.y[::-1])
    # Some contacts; later ones magnify rounding.
    how = {"time_limit": 4.0, "hop_threshold": threshold}
    there = simulate_runout(BIPLANAR, release, contacts, **how)
    back = simulate_runout(profile, mirrored, contacts, **how)
    assert len(there.contacts.time) >= least
    np.testing.assert_array_equal(there.ending, back.ending)
    np.testing.assert_array_equal(there.events, back.events)
    # Rounding, times e to the number of contacts or so.
    np.testing.assert_allclose(there.x, -back.x, atol=1e-5)
    np.testing.assert_allclose(there.contacts.time, back.contacts.time, atol=1e-5)


@pytest.mark.parametrize("contacts", [ClosedForm(LAWS[3]), FullModel("fast")])
def test_a_run_does_not_depend_on_what_runs_beside_it(contacts):
    generator = np.random.default_rng(1)
    release = blocks_above(BIPLANAR, generator, 24)
    how = {"time_limit": 25.0}
    whole = simulate_runout(BIPLANAR, release, contacts, **how)
    for width in (1, 7):
        part = simulate_runout(BIPLANAR, release, contacts, width=width, **how)
        for name in ("ending", "x", "y", "time", "events"):
            np.testing.assert_array_equal(getattr(whole, name), getattr(part, name))
        for records in ("contacts", "pieces"):
            for one, other in zip(
                getattr(whole, records), getattr(part, records), strict=True
            ):
                np.testing.assert_array_equal(one, other)


@pytest.mark.slow
def test_the_full_model_is_that_of_one_impact():
    """The first contact of a run against `simulate`, and what the climb costs."""
    block = Block(aspect_ratio=2.0)
    release = Release(block, 1.0, 232.0, 19.7, 3.5, 0.3, 4.0)
    contacts = simulate_runout(BIPLANAR, release, time_limit=5.0).contacts
    c = type(contacts)(*(column[0] for column in contacts))
    impact = Impact(
        speed=np.hypot(c.normal_velocity_before, c.tangential_velocity_before),
        angle=np.arctan2(c.tangential_velocity_before, c.normal_velocity_before),
        orientation=c.orientation,
        angular_velocity=c.angular_velocity_before,
        slope=c.slope,
    )
    result = simulate(block, Soil(), impact)
    assert c.slope == pytest.approx(np.arctan2(230.0, 400.0))
    assert c.outcome == result.outcome
    # Rounding of speed and angle changes steps: by less than the error of "balanced".
    assert c.duration == pytest.approx(float(result.duration), rel=1e-6)
    assert c.sinking == pytest.approx(float(result.final_sinking), rel=1e-6)
    mass, inertia = float(block.mass), float(block.inertia)

    def kinetic(v_n, v_t, spin):
        return 0.5 * (mass * (v_n**2 + v_t**2) + inertia * spin**2)

    model = kinetic(
        *(
            float(v)
            for v in (
                result.normal_velocity,
                result.tangential_velocity,
                result.angular_velocity,
            )
        )
    )
    climb = mass * G * np.cos(c.slope) * c.sinking
    # The gap at touch, 1e-9 of the block, is climbed as well.
    after = kinetic(c.normal_velocity, c.tangential_velocity, c.angular_velocity)
    assert after == pytest.approx(model - climb, rel=1e-6)
    travel = (
        0.5 * (c.tangential_velocity_before + float(result.tangential_velocity))
    ) * c.duration
    along = (c.x_after - c.x) * np.cos(c.slope) - (c.y_after - c.y) * np.sin(c.slope)
    assert along == pytest.approx(travel, rel=1e-6)


def test_a_block_turning_fast_may_strike_while_it_rises():
    """Its centre moves off the ground, its end does not: the model takes it."""
    block = Block(aspect_ratio=3.0)
    contacts = FullModel()
    fields = {"speed": 2.0, "angle": 2.0, "orientation": 2.3, "angular_velocity": 60.0}
    impact = Impact(**{name: [value] for name, value in fields.items()})
    spread = jax.tree.map(lambda leaf: np.array([leaf]), (block, Soil(), impact.slope))
    impact = dataclasses.replace(impact, slope=spread[2])
    blows = contacts(spread[0], spread[1], impact)
    assert blows.outcome[0] != Outcome.failed
    assert blows.outcome[0] != Outcome.separating
    assert np.all(np.isfinite(list(blows.response)))


class NoAnswer(ConstantCoefficients):
    """A law that fails on steep ground."""

    def __call__(self, block, impact):
        after = super().__call__(block, impact)
        return Rebound(*(x + jax.numpy.sqrt(0.1 - impact.slope) * 0.0 for x in after))


def test_every_run_says_why_it_ended():
    release = Release(SPHERE, [1.0, 500.0, 990.0], [232.0, 5.0, 5.0], [5.0, 5.0, 20.0])
    law = ClosedForm(NoAnswer(0.5, 0.9))
    runs = simulate_runout(BIPLANAR, release, law)
    assert list(runs.ending) == [Ending.failed, Ending.stopped, Ending.left_profile]
    assert runs.count_endings() == {"stopped": 1, "left profile": 1, "failed": 1}
    assert runs.x[2] == pytest.approx(1000.0, rel=1e-12)
    law = ClosedForm(ConstantCoefficients(0.5, 0.9))
    runs = simulate_runout(BIPLANAR, release, law, time_limit=0.5)
    assert list(runs.ending) == [Ending.time_limit] * 2 + [Ending.left_profile]
    np.testing.assert_allclose(runs.time[:2], 0.5)
    runs = simulate_runout(BIPLANAR, release, law, event_limit=1)
    assert list(runs.ending) == [Ending.event_limit] * 2 + [Ending.left_profile]


def test_paths_go_on_without_a_break():
    generator = np.random.default_rng(3)
    release = blocks_above(BIPLANAR, generator, 5)
    runs = simulate_runout(BIPLANAR, release, ClosedForm(PfeifferBowen(0.35, 0.85)))
    for i in range(release.count):
        path = runs.path(i)
        assert np.all(np.diff(path["time"]) >= 0.0)
        assert path["time"][-1] == pytest.approx(runs.time[i], rel=1e-12)
        assert (path["x"][-1], path["y"][-1]) == pytest.approx(
            (runs.x[i], runs.y[i]), abs=1.0
        )
    # All is there, and by trajectory.
    assert set(runs.pieces.trajectory) == set(range(release.count))
    assert np.all(np.diff(runs.pieces.trajectory) >= 0)


def test_releases_in_the_ground_or_off_the_profile_are_refused():
    with pytest.raises(ValueError, match=r"block 1 is released 0\.\d+ m in the ground"):
        simulate_runout(FLAT, Release(SPHERE, 10.0, [1.0, 0.5 * R]), DEAD)
    with pytest.raises(ValueError, match="block 0 is released at x = -1, but"):
        simulate_runout(FLAT, Release(SPHERE, -1.0, 1.0), DEAD)
    with pytest.raises(ValueError, match="v_x must be finite"):
        Release(SPHERE, 10.0, 1.0, [0.0, np.nan])
    with pytest.raises(ValueError, match=r"mass must be above 0 kg, but is -1"):
        Release(Block(mass=-1.0), 10.0, 1.0)
    with pytest.raises(ValueError, match="must broadcast to one axis"):
        Release(SPHERE, [1.0, 2.0], [1.0, 2.0, 3.0])


def test_no_block_is_carried_through_a_wall_while_in_contact():
    """Spheres that skim along the ground get on by half a metre during a contact, and
    the wall is 0.1 m thick."""
    wall = Profile([0, 30, 30.001, 30.1, 30.101, 90], [0, 0, 5, 5, 0, 0])
    release = Release(Block(), x=np.linspace(20.0, 29.0, 24), y=0.6, v_x=14.0, v_y=-0.6)
    for how in (release, mirror(release, 60.1)):
        runs = simulate_runout(wall, how, FullModel("fast"), time_limit=5.0)
        assert np.max(runs.contacts.duration * 14.0) > 0.2
        assert not len(passages(runs, 30.05).time)


def mirror(release, twice):
    """Blocks that go the other way about half of twice."""
    return dataclasses.replace(release, x=twice - release.x, v_x=-release.v_x)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["Ellipsoid", "RectangularPrism"])
def test_a_scene_begins_as_its_impact_strikes(shape):
    profile = inclined(0.35)
    scene = Scene(
        Block(shape=shape, aspect_ratio=1.5, mass=[50.0, 200.0]),
        Soil(c_v=[0.5, 1.0]),
        Impact(speed=12.0, angle=0.5, orientation=0.3, angular_velocity=2.0),
    )
    runs = simulate_runout(profile, scene, x=[20.0, 30.0], event_limit=3)
    on_plane = dataclasses.replace(scene.impact, slope=0.35)
    alone = simulate_batch(Scene(scene.block, scene.soil, on_plane))
    contacts = runs.contacts
    first = np.searchsorted(contacts.trajectory, [0, 1])
    # To the rounding of positions, over the speed.
    np.testing.assert_allclose(contacts.time[first], 0.0, atol=1e-8)
    for name in ("normal_velocity", "tangential_velocity", "angular_velocity"):
        expected = getattr(scene.impact, name)
        found = getattr(contacts, name + "_before")[first]
        np.testing.assert_allclose(found, expected, rtol=1e-6)
    np.testing.assert_allclose(contacts.orientation[first], 0.3, atol=1e-7)
    # That touch differs by so much, and the accuracy is the same.
    np.testing.assert_allclose(contacts.duration[first], alone.duration, rtol=1e-4)
    np.testing.assert_allclose(contacts.sinking[first], alone.final_sinking, rtol=1e-3)
    from_parts = simulate_runout(
        profile,
        (scene.block, scene.soil, scene.impact),
        x=[20.0, 30.0],
        event_limit=3,
    )
    np.testing.assert_array_equal(from_parts.x, runs.x)


def test_a_scene_needs_a_place_and_a_release_none():
    with pytest.raises(InputError, match="a scene needs x"):
        simulate_runout(FLAT, Scene())
    with pytest.raises(InputError, match="x is for a scene"):
        simulate_runout(FLAT, Release(SPHERE, 5.0, 5.0), x=3.0)


def test_spheres_never_hop():
    """They do not heave as they roll: every threshold gives the same bits."""
    release = Release(SPHERE, np.linspace(0.0, 50.0, 8), 240.0, 15.0, 0.0, 0.0, 10.0)
    contacts = ClosedForm(ConstantCoefficients(0.4, 0.9))
    first, second = (
        simulate_runout(BIPLANAR, release, contacts, hop_threshold=threshold)
        for threshold in (0.0, 1e6)
    )
    assert not np.any(second.contacts.hop)
    for name in ("contacts", "pieces"):
        for one, other in zip(getattr(first, name), getattr(second, name), strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("threshold", [0.0, 0.5, 2.0])
def test_flights_lower_than_the_heave_are_rolled(threshold):
    """A contact is followed by a flight where that lifts the block by the threshold at
    least, by motion along the ground where it would lift it by less."""
    generator = np.random.default_rng(7)
    release = blocks_above(BIPLANAR, generator, 40)
    law = ClosedForm(PfeifferBowen(0.5, 0.9))
    runs = simulate_runout(BIPLANAR, release, law, hop_threshold=threshold)
    c, p = runs.contacts, runs.pieces
    owner = c.trajectory.astype(int)
    outline = release.outline
    heave = (outline.largest - outline.smallest)[owner]
    height = np.maximum(-c.normal_velocity, 0.0) ** 2 / (2.0 * G * np.cos(c.slope))
    hops = c.hop.astype(bool)
    assert np.all(height[hops] < threshold * heave[hops])
    assert np.any(hops) == (threshold > 0.0)
    # What a block does next is the piece that begins as the contact ends.
    flights = set(zip(p.trajectory[p.motion == 0], p.time[p.motion == 0], strict=True))
    flies = np.array(
        [(t, time) in flights for t, time in zip(owner, c.time, strict=True)]
    )
    assert not np.any(flies & hops)
    assert np.all(height[flies] >= threshold * heave[flies])
    gain, mass = gain_between_pieces(runs)
    # Rounding of energies of some hundred metres of height.
    assert np.max(gain / mass) <= 1e-9


@pytest.mark.parametrize("threshold", [-0.1, np.nan, "1"])
def test_a_threshold_of_hops_is_checked(threshold):
    release = Release(SPHERE, 10.0, 240.0)
    with pytest.raises(InputError, match="hop_threshold must be"):
        simulate_runout(BIPLANAR, release, DEAD, hop_threshold=threshold)


@pytest.mark.parametrize(
    "contacts", [ClosedForm(PfeifferBowen(0.5, 0.9)), FullModel("reference")]
)
def test_points_on_a_straight_slope_change_nothing(contacts):
    """Profiles that were surveyed have points on a line, which rounding makes a break
    of 1e-16 rad."""
    x = np.linspace(0.0, 400.0, 81)
    cut = Profile(np.append(x, 1000.0), np.append(230.0 - 0.575 * x, 0.0))
    generator = np.random.default_rng(3)
    n = 16
    block = Block(aspect_ratio=np.tile([1.0, 1.5, 2.0, 3.0], n // 4))
    release = Release(
        block, 3.0, 245.0, 12.0, 0.0, generator.uniform(0.0, 6.0, n), np.arange(n) * 2.0
    )
    whole, cut_up = (
        simulate_runout(profile, release, contacts) for profile in (BIPLANAR, cut)
    )
    np.testing.assert_array_equal(whole.ending, cut_up.ending)
    # Rounding, magnified by some ten contacts; less accurate contacts magnify it more.
    np.testing.assert_allclose(whole.x, cut_up.x, atol=1e-4)


def test_a_block_rolls_over_a_break_that_throws_it_less_than_a_hop():
    """The flight would rise over the next segment by (v sin(turn))^2/(2 g cos w)."""
    speed, turn = 10.0, np.radians([2.0, 12.0])
    block = Block(aspect_ratio=1.5)
    motions = []
    for angle in turn:
        profile = Profile(
            [0.0, 100.0, 200.0], [0.0, 0.0, -100.0 * np.tan(angle)], Soil(), 0.0
        )
        release = Release(block, 90.0, 1.0, speed, 0.0, 0.0, 40.0)
        runs = simulate_runout(profile, release, DEAD)
        rolling = np.flatnonzero(runs.pieces.motion == MotionMode.rolling)
        v = runs.pieces.v_x[rolling[0]]
        rise = (v * np.sin(angle)) ** 2 / (2.0 * G * np.cos(angle))
        outline = runs.release.outline
        low = rise < (outline.largest - outline.smallest)[0]
        # The ellipse takes the place of the round block as a contact.
        goes_on = runs.pieces.motion[rolling[0] + 1 :]
        motions.append((low, goes_on[goes_on != MotionMode.contact][0]))
    assert motions == [(True, MotionMode.rolling), (False, MotionMode.flight)]

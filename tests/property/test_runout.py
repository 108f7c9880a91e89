"""Run-out: exact facts, one impact of the model, hops, endings."""

import dataclasses

import jax
import numpy as np
import pytest
from matplotlib import pyplot
from runout_scenes import (
    BIPLANAR,
    DEAD,
    FLAT,
    SPHERE,
    G,
    R,
    assert_no_energy_gained,
    assert_same_bits,
    blocks_over,
    impact_of,
    pieces_of,
    rolling_sphere,
    rows_of_records,
)

from jaximpact import (
    Block,
    ConstantCoefficients,
    Impact,
    Outcome,
    PfeifferBowen,
    Scene,
    Soil,
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
from jaximpact.runout.terrain import subdivide
from jaximpact.runout.trajectory import state_after


def inclined(angle, **values):
    """A plane of 200 m that descends to the right from the origin."""
    x, y = 200.0 * np.cos(angle), -200.0 * np.sin(angle)
    return Profile([0.0, x], [0.0, y], **values)


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
    v = 3.0 * way
    runs = simulate_runout(profile, rolling_sphere(profile, 50.0, v), DEAD)
    rolling = pieces_of(runs, MotionMode.rolling)
    assert len(rolling.time) == 1
    # a sphere has I = 2/5 m R^2
    net = np.sin(abs(slope)) - np.tan(friction) * np.cos(slope)
    along = rolling.a_x[0] * np.cos(slope) - rolling.a_y[0] * np.sin(slope)
    assert along == pytest.approx(way * G * net / 1.4, rel=1e-12)
    # It starts with a fall of 1e-9 of its size, which takes it 7 microseconds, and a
    # touch that takes nothing from it.
    assert np.hypot(rolling.v_x[0], rolling.v_y[0]) == pytest.approx(3.0, rel=1e-5)
    assert rolling.angular_velocity[0] == pytest.approx(v / R, rel=1e-5)
    assert runs.count_endings() == {"left profile": 1}


def test_a_sphere_rolls_to_rest_on_the_flat():
    friction = np.radians(15.0)
    profile = dataclasses.replace(FLAT, rolling_friction_angle=friction)
    runs = simulate_runout(profile, rolling_sphere(profile, 100.0, 10.0), DEAD)
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
    block, speed = Block(aspect_ratio=3.0), 1.0
    height = float(block.semi_axes.minor)
    profile = dataclasses.replace(FLAT, soil=Soil(alpha_s=0.5))
    release = Release(block, 100.0, height, speed, 0.0, 0.5 * np.pi)
    runs = simulate_runout(profile, release, DEAD)
    sliding = pieces_of(runs, MotionMode.sliding)
    friction = 0.5 * np.tan(np.radians(30.0))
    assert len(sliding.time) == 1
    # It has to climb by 1e-9 of its size.
    way = speed**2 / (2.0 * G * friction)
    assert runs.x[0] - sliding.x[0] == pytest.approx(way, rel=1e-7)
    assert runs.y[0] == pytest.approx(height, rel=1e-8)


@pytest.mark.parametrize(
    ("aspect_ratio", "motion"), [(1.2, MotionMode.rolling), (3.0, MotionMode.sliding)]
)
def test_a_long_block_rolls_where_the_slope_turns_it_over(aspect_ratio, motion):
    """Aspect ratio 1.2 falls over its long axis from 10.4 degrees on, friction aside;
    3 does from 53.1 on."""
    slope = np.radians(30.0)
    profile = inclined(slope, rolling_friction_angle=np.radians(5.0))
    block = Block(aspect_ratio=aspect_ratio)
    y = profile.height(50.0) + float(block.semi_axes.minor) / np.cos(slope)
    lying = Release(block, 50.0, y, 0.0, 0.0, slope + 0.5 * np.pi)
    runs = simulate_runout(profile, lying, DEAD)
    # A round block takes its place on the ground, as a contact.
    others = {MotionMode.flight, MotionMode.contact}
    assert set(runs.pieces.motion) - others == {motion}


def over_an_edge(drop, speed):
    """Pieces of flight, and the number of those that roll, of a sphere that rolls to
    the edge of a slope."""
    profile = Profile([-1.0, 0.0, 50.0], [0.0, 0.0, -50.0 * np.tan(drop)], Soil(), 0.0)
    runs = simulate_runout(profile, rolling_sphere(profile, -1.0, speed), DEAD)
    flights = pieces_of(runs, MotionMode.flight)
    return flights, len(pieces_of(runs, MotionMode.rolling).time)


def test_a_sphere_leaves_an_edge_if_it_is_fast():
    """From the flat over an edge: at once if v^2 > g R; if slower it turns about the
    edge, by an angle at which v^2 = g R cos, if there is slope enough for it."""
    drop, fast, slow = np.radians(60.0), np.sqrt(1.5 * G * R), np.sqrt(0.5 * G * R)
    flight, _ = over_an_edge(drop, fast)
    assert (flight.x[1], flight.y[1]) == pytest.approx((0.0, R), abs=1e-8)
    assert (flight.v_x[1], flight.v_y[1]) == pytest.approx((fast, 0.0), rel=1e-6)

    flight, _ = over_an_edge(drop, slow)
    # v^2 + 2 g R (1 - cos)/1.4 = g R cos, and 0.001 rad beyond
    angle = np.arccos((0.5 + 2.0 / 1.4) / (1.0 + 2.0 / 1.4)) + 1e-3
    assert flight.x[1] == pytest.approx(R * np.sin(angle), rel=1e-6)
    squared = slow**2 + 2.0 * G * R * (1.0 - np.cos(angle)) / 1.4
    assert flight.v_x[1] ** 2 + flight.v_y[1] ** 2 == pytest.approx(squared, rel=1e-6)

    flight, rolling = over_an_edge(0.1, slow)
    assert len(flight.time) == 1
    # To the edge, about it, and down from it.
    assert rolling == 3


@pytest.mark.parametrize(("share", "over"), [(1.01, True), (0.99, False)])
def test_a_crest_takes_energy_to_cross(share, over):
    """Up 10 degrees for 5 m without friction, and as far down."""
    rise = np.radians(10.0)
    far, top = 5.0 * np.cos(rise), 5.0 * np.sin(rise)
    profile = Profile(
        [-100.0, 0.0, far, 2 * far, 200.0], [0.0, 0.0, top, 0.0, 0.0], Soil(), 0.0
    )
    # Started on the way up; the corner at its foot would cost it.
    x = np.cos(rise) - R * np.sin(rise)
    height = top + R - (profile.height(x) + R / np.cos(rise))
    release = rolling_sphere(profile, x, share * np.sqrt(2.0 * G * height / 1.4))
    runs = simulate_runout(profile, release, DEAD, time_limit=8.0)
    assert (np.max(runs.path(0)["x"]) > far + R) == over


def test_a_block_strikes_the_next_segment_in_a_corner():
    rise = np.radians(40.0)
    profile = Profile([0.0, 50.0, 100.0], [0.0, 0.0, 50.0 * np.tan(rise)], Soil(), 0.0)
    contacts = simulate_runout(
        profile, rolling_sphere(profile, 10.0, 7.0), DEAD
    ).contacts
    c = rows_of_records(contacts, np.argmax(contacts.outcome >= 0))
    assert c.segment == 1
    assert c.slope == pytest.approx(-rise)
    assert c.x == pytest.approx(50.0 - R * np.tan(0.5 * rise), rel=1e-9)
    assert c.normal_velocity_before == pytest.approx(7.0 * np.sin(rise), rel=1e-6)
    assert c.tangential_velocity_before == pytest.approx(7.0 * np.cos(rise), rel=1e-6)


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
        assert np.max(np.abs(start[contacts] - end[contacts - 1])) < 1e-9
    # Up to a hundred-millionth of the block nothing is recorded.
    assert np.max(np.abs(starts.x[contacts + 1] - ends.x[contacts])) < 1e-8
    assert np.max(np.abs(starts.y[contacts + 1] - ends.y[contacts])) < 1e-8
    fastest = np.maximum(np.hypot(p.v_x, p.v_y)[contacts], 1.0)
    # Spin becomes speed along the plane: by some hundredths.
    assert np.all(np.hypot(ends.v_x, ends.v_y)[contacts] < 1.03 * fastest)


def test_a_block_turning_fast_may_strike_while_it_rises():
    """Its centre moves off the ground, its end does not: the model takes it."""
    impact = Impact(speed=2.0, angle=2.0, orientation=2.3, angular_velocity=60.0)
    one = jax.tree.map(
        lambda leaf: np.array([leaf]), (Block(aspect_ratio=3.0), Soil(), impact)
    )
    blows = FullModel()(*one)
    assert blows.outcome[0] not in (Outcome.failed, Outcome.separating)
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


def test_paths_end_where_and_when_their_runs_do():
    release = blocks_over(BIPLANAR, np.random.default_rng(3), 5)
    runs = simulate_runout(BIPLANAR, release, ClosedForm(PfeifferBowen(0.35, 0.85)))
    for i in range(release.count):
        path = runs.path(i)
        assert np.all(np.diff(path["time"]) >= 0.0)
        assert path["time"][-1] == pytest.approx(runs.time[i], rel=1e-12)
        end = path["x"][-1], path["y"][-1]
        assert end == pytest.approx((runs.x[i], runs.y[i]), abs=1.0)


@pytest.mark.parametrize(
    ("message", "release", "how"),
    [
        (
            r"block 1 is released in the ground, .* 0\.\d+ m abov",
            (10.0, [1.0, 0.5 * R]),
            {},
        ),
        ("block 0 is released at x = -1, but", (-1.0, 1.0), {}),
        ("v_x must be finite", (10.0, 1.0, [0.0, np.nan]), {}),
        ("must broadcast to one axis", ([1.0, 2.0], [1.0, 2.0, 3.0]), {}),
        ("x is for a scene", (5.0, 5.0), {"x": 3.0}),
        *(
            ("hop_threshold must be", (10.0, 9.0), {"hop_threshold": bad})
            for bad in (-0.1, np.nan, "1")
        ),
    ],
)
def test_what_cannot_be_run_is_refused(message, release, how):
    with pytest.raises(ValueError, match=message):
        simulate_runout(FLAT, Release(SPHERE, *release), DEAD, **how)


def test_scenes_and_blocks_that_cannot_be_run_are_refused():
    with pytest.raises(InputError, match="a scene needs x"):
        simulate_runout(FLAT, Scene())
    with pytest.raises(ValueError, match=r"mass must be above 0 kg, but is -1"):
        Release(Block(mass=-1.0), 10.0, 1.0)


def test_no_block_is_carried_through_a_wall_while_in_contact():
    """Spheres that skim along the ground get on by half a metre during a contact, and
    the wall is 0.1 m thick."""
    wall = Profile([0, 30, 30.001, 30.1, 30.101, 90], [0, 0, 5, 5, 0, 0])
    release = Release(Block(), x=np.linspace(20.0, 29.0, 24), y=0.6, v_x=14.0, v_y=-0.6)
    back = dataclasses.replace(release, x=60.1 - release.x, v_x=-release.v_x)
    for way in (release, back):
        runs = simulate_runout(wall, way, FullModel("fast"), time_limit=5.0)
        assert np.max(runs.contacts.duration * 14.0) > 0.2
        assert not len(passages(runs, 30.05).time)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["Ellipsoid", "RectangularPrism"])
def test_a_scene_begins_as_its_impact_strikes(shape):
    """With the impact of `simulate_batch`, less what the climb out of the ground costs,
    and on by the mean velocity along it."""
    profile = inclined(0.35)
    scene = Scene(
        Block(shape=shape, aspect_ratio=1.5, mass=[50.0, 200.0]),
        Soil(c_v=[0.5, 1.0]),
        Impact(speed=12.0, angle=0.5, orientation=0.3, angular_velocity=2.0),
    )
    runs = simulate_runout(profile, scene, x=[20.0, 30.0], event_limit=3)
    first = np.searchsorted(runs.contacts.trajectory, [0, 1])
    c = rows_of_records(runs.contacts, first)
    into, along = c.normal_velocity_before, c.tangential_velocity_before
    # To the rounding of positions, over the speed.
    np.testing.assert_allclose(c.time, 0.0, atol=1e-8)
    np.testing.assert_allclose(into, scene.impact.normal_velocity, rtol=1e-6)
    np.testing.assert_allclose(along, scene.impact.tangential_velocity, rtol=1e-6)
    np.testing.assert_allclose(c.angular_velocity_before, 2.0, rtol=1e-6)
    np.testing.assert_allclose(c.orientation, 0.3, atol=1e-7)

    alone = simulate_batch(Scene(scene.block, scene.soil, impact_of(c)))
    assert [str(Outcome(code)) for code in c.outcome] == alone.outcome.tolist()
    # Rounding of speed and angle changes steps: by less than the error of "balanced".
    np.testing.assert_allclose(c.duration, alone.duration, rtol=1e-6)
    np.testing.assert_allclose(c.sinking, alone.final_sinking, rtol=1e-6)
    mass, inertia = runs.release.mass_properties

    def kinetic(after):
        squared = after.normal_velocity**2 + after.tangential_velocity**2
        return 0.5 * (mass * squared + inertia * after.angular_velocity**2)

    # The gap at touch, 1e-9 of the block, is climbed as well.
    climb = mass * G * np.cos(0.35) * c.sinking
    np.testing.assert_allclose(kinetic(c), kinetic(alone) - climb, rtol=1e-6)
    way = 0.5 * (along + alone.tangential_velocity) * c.duration
    moved = (c.x_after - c.x) * np.cos(0.35) - (c.y_after - c.y) * np.sin(0.35)
    np.testing.assert_allclose(moved, way, rtol=1e-6)
    parts = scene.block, scene.soil, scene.impact
    from_parts = simulate_runout(profile, parts, x=[20.0, 30.0], event_limit=3)
    np.testing.assert_array_equal(from_parts.x, runs.x)


def test_spheres_never_hop():
    """They do not heave as they roll: every threshold gives the same bits."""
    release = Release(SPHERE, np.linspace(0.0, 50.0, 8), 240.0, 15.0, 0.0, 0.0, 10.0)
    contacts = ClosedForm(ConstantCoefficients(0.4, 0.9))
    first, second = (
        simulate_runout(BIPLANAR, release, contacts, hop_threshold=threshold)
        for threshold in (0.0, 1e6)
    )
    assert not np.any(second.contacts.hop)
    assert_same_bits(first, second)


@pytest.mark.parametrize("threshold", [0.0, 0.5, 2.0])
def test_flights_lower_than_the_heave_are_rolled(threshold):
    """A contact is followed by a flight where that lifts the block by the threshold at
    least, by motion along the ground where it would lift it by less."""
    release = blocks_over(BIPLANAR, np.random.default_rng(7), 40)
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
    assert_no_energy_gained(runs)


@pytest.mark.parametrize(
    "contacts",
    [
        ClosedForm(ConstantCoefficients(0.35, 0.85)),
        ClosedForm(PfeifferBowen(0.5, 0.9)),
        FullModel("reference"),
    ],
)
def test_points_on_a_straight_slope_change_nothing(contacts):
    """Profiles that were surveyed have points on a line, which rounding makes a break
    of 1e-16 rad; as `subdivide` makes them for fields of the ground."""
    cut, _ = subdivide(BIPLANAR, np.arange(3.0, 1000.0, 7.0))
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


def test_runs_are_a_table_a_dataset_and_a_drawing():
    release = Release(SPHERE, np.array([300.0, 500.0]), 1.0 + R, v_x=[2.0, 0.0])
    law = ClosedForm(ConstantCoefficients(0.7, 1))
    runs = simulate_runout(FLAT, release, law)
    frame = runs.to_dataframe()
    assert frame.ending.tolist() == ["stopped"] * 2
    np.testing.assert_array_equal(frame.x_m, runs.x)
    assert runs.to_xarray().time_s.units == "s"
    figure, axes = pyplot.subplots()
    assert runs.plot(ax=axes) is axes
    ends = next(line for line in axes.lines if line.get_label() == "end")
    np.testing.assert_array_equal(ends.get_xdata(), runs.x)
    pyplot.close(figure)


@pytest.mark.parametrize("time", [3.0, 9.0, 15.0, 18.0, 23.0])
def test_a_time_limit_ends_blocks_on_the_ground_too(time):
    """In flight, on one straight line of hundreds of metres, and on the next."""
    profile = Profile([0.0, 400.0, 1000.0], [230.0, 0.0, 0.0], Soil())
    release = Release(Block(), x=2.0, y=234.0, v_x=20.0)
    law = ClosedForm(ConstantCoefficients(e_n=0.4, e_t=0.8))
    whole = simulate_runout(profile, release, law).path(0, 0.01)
    runs = simulate_runout(profile, release, law, time_limit=time)
    assert list(runs.ending) == [Ending.time_limit]
    assert runs.time[0] == pytest.approx(time, abs=1e-9)
    # Between samples 0.01 s apart, at accelerations below g.
    assert runs.x[0] == pytest.approx(
        np.interp(time, whole["time"], whole["x"]), abs=1e-3
    )
    assert runs.y[0] == pytest.approx(
        np.interp(time, whole["time"], whole["y"]), abs=1e-3
    )


def test_cuts_a_rounding_apart_are_one():
    """As ends of materials in metres beside points of a drawing in millimetres."""
    profile = Profile([0.0, 60300 * 1e-3, 300.0], [100.0, 50.0, 0.0], Soil())
    same, piece = subdivide(profile, [60.3])
    assert same is profile
    cut, piece = subdivide(profile, [10.0, 10.0 + 1e-9, 300.0 - 1e-9])
    np.testing.assert_array_equal(cut.x, [0.0, 10.0, 60300 * 1e-3, 300.0])
    np.testing.assert_array_equal(piece, [0, 0, 1])

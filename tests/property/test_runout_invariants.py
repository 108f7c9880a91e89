"""What holds of every run, on ground that is finer and narrower than blocks too:
terraces, noisy hills, dams with rounded toes, ditches, scans of 5 cm, walls, teeth."""

import dataclasses

import numpy as np
import pytest
from runout_scenes import (
    LAWS,
    assert_no_energy_gained,
    assert_same_bits,
    blocks_over,
    gain_in_contacts,
    height_over,
    mirrored,
    rows_of_records,
)

from jaximpact import Block, ConstantCoefficients, RigidEllipsoid, Soil
from jaximpact.runout import (
    ClosedForm,
    Ending,
    FullModel,
    MotionMode,
    Profile,
    Release,
    first_passages,
    passages,
    simulate_runout,
)
from jaximpact.runout.blocks import select
from jaximpact.runout.trajectory import state_after

LAW = ClosedForm(ConstantCoefficients(e_n=0.35, e_t=0.85))


def terraces(g):
    """Walls of 0.2 to 1 m that lean by 1 cm, and a level run-out."""
    x, y = [0.0], [0.0]
    for _ in range(30):
        x += [x[-1] + g.uniform(0.3, 1.5)]
        x += [x[-1] + 0.01]
        y += [y[-1] - g.uniform(0.0, 0.1)]
        y += [y[-1] - g.uniform(0.2, 1.0)]
    return [*x, x[-1] + 60.0], [*y, y[-1]]


def hill(g):
    """Points every 0.25 m, with 5 cm of noise."""
    x = np.arange(0.0, 120.0, 0.25)
    y = 60.0 * np.exp(-x / 40.0) + np.sin(x / 6.0)
    return x, y + g.normal(0.0, 0.05, len(x))


def dam(g):
    """A slope, and the toe of a dam, rounded with a radius of 17 m."""
    along = np.arange(0.0, 12.0 + 1e-9, g.choice([0.1, 0.25, 0.5]))
    face = 17.0 - np.sqrt(17.0**2 - along**2)
    x = np.concatenate([[0.0, 60.0], 70.0 + along, [92.0, 200.0]])
    return x, np.concatenate([[40.0, 0.0], face, [face[-1] + 10.0] * 2])


def ditches(g):
    """V-shaped ditches, most of them narrower than blocks."""
    x, y = [0.0], [0.0]
    for _ in range(25):
        apart, wide = g.uniform(0.5, 4.0), g.uniform(0.05, 0.6)
        x += [x[-1] + apart]
        x += [x[-1] + 0.5 * wide, x[-1] + wide]
        y += [y[-1] - apart * g.uniform(0.0, 0.9)]
        y += [y[-1] - g.uniform(0.05, 1.0), y[-1]]
    return [*x, x[-1] + 60.0], [*y, y[-1]]


def scan(g):
    """Points every 5 cm of a surface that wanders by centimetres."""
    x = np.arange(0.0, 30.0, 0.05)
    y = 2.0 * np.sin(x / 5.0) - 0.6 * x + g.normal(0.0, 0.01, len(x))
    y += np.cumsum(g.normal(0.0, 0.004, len(x)))
    return np.append(x, 70.0), np.append(y, y[-1])


def walls(g):
    """A slope with walls of centimetres and ditches between faces of 60 to 89°."""
    x, y = [0.0], [0.0]
    for _ in range(4):
        high, wide = g.uniform(0.5, 6.0), g.uniform(0.01, 0.6)
        turn = g.choice([-1.0, 1.0])
        faces = high / np.tan(np.radians(g.uniform(60.0, 89.0, 2)))
        before = g.uniform(2.0, 15.0), -g.uniform(0.0, 8.0)
        for along, up in (
            *(before, (faces[0], turn * high)),
            *((wide, 0.0), (faces[1], -turn * high)),
        ):
            x.append(x[-1] + along)
            y.append(y[-1] + up)
    return [*x, x[-1] + 30.0], [*y, y[-1]]


def teeth(g):
    """A slope of points at random, some of them closer than blocks are wide."""
    along = g.uniform(0.05, 1.0, 60)
    up = -0.5 * along + g.normal(0.0, g.uniform(0.05, 0.6), 60)
    x, y = np.cumsum([0.0, *along]), np.cumsum([0.0, *up])
    return [*x, x[-1] + 30.0], [*y, y[-1]]


GROUNDS = (terraces, hill, dam, ditches, scan)
NARROW = (walls, teeth)
SHAPES = ("Ellipsoid", "EllipticCylinder", "RectangularPrism")


def profile_of(ground, g):
    return Profile(
        *map(np.asarray, ground(g)), rolling_friction_angle=np.radians(g.uniform(0, 25))
    )


def check(runs):
    """All that must hold of runs."""
    profile, pieces = runs.profile, runs.pieces
    assert set(runs.ending) <= {Ending.stopped, Ending.left_profile}
    assert np.all(pieces.duration > 0.0)
    trajectory = pieces.trajectory
    size = runs.release.outline.smallest[trajectory]
    end = state_after(pieces, pieces.duration)
    last = np.append(np.diff(trajectory) > 0, True)
    # Each block moves, and its last piece ends where and when its run does.
    assert np.array_equal(trajectory[last], np.arange(len(runs.x)))
    follows = np.where(last, 0, np.append(np.arange(1, len(last)), 0))
    for found, start, of_run in (
        (end.x, pieces.x, runs.x),
        (end.y, pieces.y, runs.y),
        (pieces.time + pieces.duration, pieces.time, runs.time),
    ):
        goes_on = np.where(last, of_run[trajectory], start[follows])
        assert np.all(np.abs(goes_on - found) < 1e-7 * np.maximum(size, 1.0))
    assert_no_energy_gained(runs)
    # A contact may take a centre into the crater, and a run may end there.
    outside = pieces.motion != MotionMode.contact
    for part in np.linspace(0.0, 1.0, 5):
        at = state_after(pieces, part * pieces.duration)
        in_crater = last & (runs.ending[trajectory] == Ending.stopped) & (part == 1.0)
        on_profile = (at.x > profile.x[0]) & (at.x < profile.x[-1])
        deep = profile.height(at.x) - at.y > 1e-7 * size
        assert not np.any(deep & on_profile & outside & ~in_crater)


@pytest.mark.parametrize("hop_threshold", [1.0, 0.0])
@pytest.mark.parametrize("ground", GROUNDS)
def test_runs_in_closed_form(ground, hop_threshold):
    g = np.random.default_rng(1)
    for shape in SHAPES:
        profile = profile_of(ground, g)
        release = blocks_over(profile, g, 16, shape)
        check(simulate_runout(profile, release, LAW, hop_threshold=hop_threshold))


@pytest.mark.parametrize("hop_threshold", [1.0, 0.0])
@pytest.mark.parametrize("ground", GROUNDS + NARROW)
def test_runs_by_the_full_model(ground, hop_threshold):
    """Contacts take blocks along steep faces, up too, and out of the ground: no further
    than their energy reaches. Without a limit they gain 0.3 J/kg on walls."""
    g = np.random.default_rng(2)
    profile = profile_of(ground, g)
    release = blocks_over(profile, g, 24)
    contacts = FullModel("fast")
    check(simulate_runout(profile, release, contacts, hop_threshold=hop_threshold))


def test_a_block_that_comes_down_onto_a_lower_side_is_held_up_at_its_cost():
    """One contact in some thousands of prisms on noisy ground, by the full model: other
    ground is in the way of coming down, and the energy of the way that is not made was
    once kept, up to 15 % of the energy at touch."""
    g = np.random.default_rng(16)
    profile = Profile(
        *map(np.asarray, hill(g)), rolling_friction_angle=np.radians(15.0)
    )
    release = blocks_over(profile, g, 400, "RectangularPrism")
    runs = simulate_runout(profile, release, FullModel("fast"))
    assert_no_energy_gained(runs)
    ledger = runs.impact_energies()
    assert np.max(ledger.gain / ledger.energy) < 1e-9


@pytest.mark.parametrize("ground", [hill, scan, teeth])
def test_pieces_along_the_ground_end_as_fast_as_the_next_begins(ground):
    """But for what is lost at a corner that is struck; also where a block starts from
    rest on an arc, or a hop that is not followed takes it over a corner: there 14 % of
    its energy were once lost of what was recorded and not of what went on."""
    g = np.random.default_rng(1)
    profile = profile_of(ground, g)
    runs = simulate_runout(profile, blocks_over(profile, g, 64), LAW)
    # One between two rises, 5e-14 m apart, turned there and back 10 000 times.
    assert not np.any(runs.ending == Ending.event_limit)
    mass, inertia = select(runs.release.mass_properties, runs.pieces.trajectory)

    def kinetic(of):
        squared = of.v_x**2 + of.v_y**2
        return 0.5 * (mass * squared + inertia * of.angular_velocity**2)

    pieces = runs.pieces
    starts, ends = kinetic(pieces), kinetic(state_after(pieces, pieces.duration))
    rolls = pieces.motion == MotionMode.rolling
    goes_on = rolls[1:] & rolls[:-1] & (np.diff(pieces.trajectory) == 0)
    assert np.count_nonzero(goes_on) > 500
    # The error that `ride.SPEED_KEPT` allows.
    assert np.all((starts[1:] <= 1.031 * ends[:-1])[goes_on])


@pytest.mark.parametrize("aspect_ratio", [1.0, 0.4])
@pytest.mark.parametrize("roughness", [0.0, 4.0])
def test_contacts_cut_short_are_no_faster_than_their_blocks(aspect_ratio, roughness):
    """Other ground is in the way at once in a gap narrower than most blocks. Pieces of
    contacts may end with a tenth more energy than they begin with, and blocks at rest
    are moved to where they lie at the speed of a fall from half as high: that is some
    metres a second. Contacts once ended at 1e13 m/s."""
    g = np.random.default_rng(3)
    profile = Profile(
        *([0.0, 50.0, 50.3, 50.8, 51.1, 100.0, 160.0], [50, 20, 12, 12, 20, 10, 10]),
        Soil(kinematics="WorkConjugate"),
        *(np.radians(18.0), np.radians(roughness)),
    )
    x = g.uniform(2.0, 10.0, 300)
    release = Release(
        Block(mass=np.exp(g.normal(5.5, 1.1, 300)), aspect_ratio=aspect_ratio),
        *(x, profile.height(x) + 3.0, g.uniform(1.0, 10.0, 300)),
    )
    runs = simulate_runout(profile, release, FullModel("fast"))
    assert_no_energy_gained(runs)
    gain, mass = gain_in_contacts(runs)
    fastest = np.max(np.hypot(runs.pieces.v_x, runs.pieces.v_y))
    assert np.max(gain / mass) < 0.5 * (3.0**2 + 0.1 * fastest**2)


@pytest.mark.parametrize("contacts", [LAW, FullModel("fast")])
@pytest.mark.parametrize("east", [2.6e6, 3.25e7])
def test_a_national_grid_changes_nothing(east, contacts):
    """x is resolved to 4e-9 m at 3e7 m, which places of release are given by."""
    g = np.random.default_rng(7)
    x, y = np.array([0.0, 40.0, 40.5, 43.0, 43.5, 150.0]), [40, 15, 9, 9, 14.5, 14]
    here = Profile(x, y, rolling_friction_angle=np.radians(20.0))
    there = Profile(x + east, y, rolling_friction_angle=np.radians(20.0))
    n = 60
    block = Block(mass=np.exp(g.normal(5.0, 1.0, n)), aspect_ratio=1.5)
    motion = dict(y=45.0, v_x=g.uniform(2.0, 15.0, n), orientation=g.uniform(0, 3, n))
    # Both are the same numbers but for the first digits.
    places = (east + g.uniform(2.0, 10.0, n)) - east
    runs = simulate_runout(here, Release(block, places, **motion), contacts)
    far = simulate_runout(there, Release(block, places + east, **motion), contacts)
    spacing = np.spacing(east)
    np.testing.assert_allclose(far.x - east, runs.x, rtol=0.0, atol=spacing)
    assert np.array_equal(far.y, runs.y)
    assert np.array_equal(far.time, runs.time)
    assert np.array_equal(far.events, runs.events)
    for rows, others in ((far.contacts, runs.contacts), (far.pieces, runs.pieces)):
        np.testing.assert_allclose(rows.x - east, others.x, rtol=0.0, atol=spacing)


def test_spheres_in_a_corner_below_a_wall_stop():
    """At the end of an element the wall ahead, steeper ground behind: each stood for
    10 000 events at one time."""
    x, y = [0.0, 50.0, 50.01, 52.0, 52.01, 120.0], [40.0, 15.0, 25.0, 25.0, 15.0, 10.0]
    profile = Profile(x, y, Soil(kinematics="WorkConjugate"))
    release = Release(Block(mass=np.linspace(50.0, 2000.0, 200)), 5.0, 41.5, 5.0)
    runs = simulate_runout(profile, release, FullModel("fast"))
    assert set(runs.ending) == {Ending.stopped}
    assert np.max(runs.events) < 200


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("ground", NARROW)
def test_no_sphere_rolls_deeper_into_narrow_ground(ground, seed):
    """Than it began to."""
    g = np.random.default_rng(seed)
    profile = profile_of(ground, g)
    runs = simulate_runout(profile, blocks_over(profile, g, 40), LAW)
    check(runs)
    pieces, block = runs.pieces, runs.release.block
    sphere = block.aspect_ratio[pieces.trajectory] == 1.0
    rolls = sphere & (pieces.motion == MotionMode.rolling)
    # Past the ends of the profile there is no ground to be in.
    at_end = state_after(pieces, pieces.duration).x
    rolls &= (at_end > profile.x[0]) & (at_end < profile.x[-1])
    rolling = rows_of_records(pieces, rolls)
    radius = block.semi_axes.minor[rolling.trajectory]
    depths = []
    for part in np.linspace(0.0, 1.0, 9):
        at = state_after(rolling, part * rolling.duration)
        depths.append(radius - height_over(at.x, at.y, profile))
    # Pieces lie apart from the path that the centre takes by a hundredth of the radius.
    assert np.all(np.max(depths, axis=0) < np.maximum(depths[0], 0.0) + 0.01 * radius)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
def test_no_law_adds_energy(law):
    """On slopes coarser and finer than blocks, over facets too."""
    g = np.random.default_rng(5)
    for degrees in (0.0, 1.0, 5.0, 12.0, 30.0) * 3:
        points = g.integers(2, 50)
        steps = g.uniform(0.1, g.choice([1.0, 8.0]), points)
        rises = g.normal(-0.5, g.choice([0.05, 0.5]), points) * steps
        profile = Profile(
            *(np.cumsum(steps), np.cumsum(rises)),
            *(Soil(alpha_s=g.uniform(0.3, 1.2)), g.uniform(0.0, 0.6, points - 1)),
            np.radians(degrees),
        )
        release = blocks_over(profile, g, 60)
        runs = simulate_runout(profile, release, ClosedForm(law))
        assert set(runs.ending) <= {Ending.stopped, Ending.left_profile}
        slopes = profile.slope[runs.contacts.segment.astype(int)]
        assert np.any(runs.contacts.slope != slopes) or degrees == 0.0
        assert_no_energy_gained(runs)


@pytest.mark.parametrize("contacts", [LAW, FullModel("fast")])
@pytest.mark.parametrize("ground", GROUNDS + NARROW)
def test_what_runs_beside_a_block_changes_no_bit(ground, contacts):
    """Which places are narrow depends on the largest block, but no block's run does."""
    g = np.random.default_rng(3)
    profile = profile_of(ground, g)
    release = blocks_over(profile, g, 24)
    whole = simulate_runout(profile, release, contacts)
    assert_same_bits(simulate_runout(profile, release, contacts, width=5), whole)
    for i in range(0, 24, 6):
        alone = simulate_runout(profile, release.of_blocks(np.array([i])), contacts)
        for name in ("ending", "x", "y", "time", "events"):
            assert getattr(alone, name)[0] == getattr(whole, name)[i]


def sensitivity(profile, release, contacts, **how):
    """How far blocks stop elsewhere when they are released 1e-9 m beside [m]."""
    stops = [
        simulate_runout(
            profile, dataclasses.replace(release, x=release.x + shift), contacts, **how
        ).x
        for shift in (0.0, 1e-9, -3e-9)
    ]
    return np.ptp(stops, axis=0)


@pytest.mark.parametrize(
    ("contacts", "hop_threshold", "little"),
    [
        (LAW, 1.0, 1e-6),
        (ClosedForm(RigidEllipsoid(0.6)), 0.0, 1e-6),
        # Mirrored impacts are integrated by other steps, to the accuracy of "balanced".
        (FullModel("balanced"), 1.0, 2e-2),
    ],
)
@pytest.mark.parametrize("ground", GROUNDS)
def test_a_mirrored_slope_gives_the_mirrored_run(
    ground, contacts, hop_threshold, little
):
    """To what a shift of the release by 1e-9 m changes, some of it at each contact."""
    g = np.random.default_rng(4)
    profile = profile_of(ground, g)
    release = blocks_over(profile, g, 16)
    how = {"hop_threshold": hop_threshold}
    there = simulate_runout(profile, release, contacts, **how)
    back = simulate_runout(*mirrored(profile, release), contacts, **how)
    change = sensitivity(profile, release, contacts, **how)
    known = change < 1e-3
    assert np.mean(known) > 0.3
    apart = np.abs(there.x + back.x)
    assert np.all(apart[known] < 100.0 * change[known] + little)


@pytest.mark.parametrize("aspect_ratio", [1.0, 2.0])
@pytest.mark.parametrize("ground", [terraces, dam, ditches])
def test_points_on_straight_lines_change_nothing(ground, aspect_ratio):
    """Points every decimetre: closer than most blocks are wide."""
    g = np.random.default_rng(5)
    x, y = map(np.asarray, ground(g))
    release = blocks_over(Profile(x, y), g, 16)
    block = Block(mass=release.block.mass, aspect_ratio=aspect_ratio)
    release = dataclasses.replace(release, block=block, y=release.y + 10.0)
    cuts = np.arange(x[0], x[-1], 0.1) + 0.003
    cuts = cuts[np.min(np.abs(cuts[:, None] - x), axis=1) > 1e-4]
    fine = np.union1d(x, cuts)
    whole, cut = (
        Profile(x_i, np.interp(x_i, x, y), rolling_friction_angle=0.2)
        for x_i in (x, fine)
    )
    runs, cut_up = (simulate_runout(p, release, LAW) for p in (whole, cut))
    apart = np.abs(cut_up.x - runs.x)
    assert np.median(apart) < 1e-8
    # Heights of points are rounded, as in a release 1e-9 m beside; one block in ten may
    # be where that decides between two ways.
    change = sensitivity(whole, release, LAW)
    assert np.mean(apart < 100.0 * change + 1e-6) > 0.9


@pytest.mark.parametrize(
    ("mass", "aspect_ratio"), [(1.0, 1.0), (300.0, 1.0), (300.0, 2.0)]
)
def test_a_curve_is_one_however_many_points_draw_it(mass, aspect_ratio):
    """From points a metre apart to points of a decimetre, closer than most of the
    blocks are wide: stops, and energies and heights in passing."""
    g = np.random.default_rng(0)
    n = 60
    block = Block(mass=mass * np.exp(g.normal(0.0, 0.5, n)), aspect_ratio=aspect_ratio)
    x_0, speed = g.uniform(3.0, 8.0, n), g.uniform(2.0, 12.0, n)
    found = []
    for spacing in (1.0, 0.25, 0.1):
        x = np.arange(0.0, 600.0 + 0.5 * spacing, spacing)
        y = 200.0 * np.exp(-x / 150.0) + 4.0 * np.sin(x / 25.0)
        profile = Profile(x, y, rolling_friction_angle=np.radians(22.0))
        turned = np.linspace(0.0, 3.0, n)
        release = Release(block, x_0, 206.0, speed, orientation=turned)
        runs = simulate_runout(profile, release, LAW)
        _, at = first_passages(passages(runs, 150.0), n)
        energy = at.energy / np.asarray(block.mass)
        found.append(
            [
                np.percentile(values, (50.0, 95.0))
                for values in (runs.x, energy, at.centre_height)
            ]
        )
    for stops, energies, heights in found[:-1]:
        # The error is of the order of the spacing: 3 cm of 440 m at 1 m.
        np.testing.assert_allclose(stops, found[-1][0], rtol=1e-3)
        np.testing.assert_allclose(energies, found[-1][1], rtol=5e-3)
        np.testing.assert_allclose(heights, found[-1][2], atol=5e-3)

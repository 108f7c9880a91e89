"""Derivatives of run-outs: exact facts, differences, and refusals."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from runout_scenes import BIPLANAR, DEAD, FLAT, SPHERE, G, R

from jaximpact import (
    Block,
    BozzoloPamini,
    ConstantCoefficients,
    PfeifferBowen,
    RigidEllipsoid,
    Soil,
)
from jaximpact.accuracy import Accuracy
from jaximpact.errors import InputError
from jaximpact.parameters import parameter
from jaximpact.rebound import AbstractRebound, Rebound
from jaximpact.runout import (
    ClosedForm,
    FullModel,
    Ground,
    Profile,
    Release,
    Standing,
    differentiate_runout,
    first_passages,
    passages,
    runout_gradients,
    simulate_runout,
)
from jaximpact.runout.lane_programs import Carried, call, closed_form, root

pytestmark = pytest.mark.slow

DEGREE = np.pi / 180.0


def short_slope(**soil):
    """20 m of slope, then flat."""
    return Profile([0.0, 20.0, 1000.0], [10.0, 0.0, 0.0], Soil(**soil))


def blocks_on_short_slope(count, aspect_ratio, seed=0):
    generator = np.random.default_rng(seed)
    return Release(
        Block(mass=generator.uniform(50.0, 200.0, count), aspect_ratio=aspect_ratio),
        np.full(count, 2.0),
        10.0 + generator.uniform(2.0, 4.0, count),
        5.0,
        0.0,
        generator.uniform(0.0, 3.0, count),
        generator.uniform(0.0, 5.0, count),
    )


def test_programs_are_differentiated():
    """With respect to every input that changes, as JAX differentiates the function; an
    input that is a result, and one that does not matter, too."""

    def function(pair, scale, unused):
        a, b = pair
        return {"product": scale * jnp.sin(a) * b, "larger": jnp.maximum(a, b), "a": a}

    program = closed_form(function)
    a, b, scale = np.array([0.3, 1.1, 2.0]), np.array([1.5, 1.5, 1.5]), 3.0
    along_a = np.array([[1.0, 0.0, 2.0], [0.5, 0.5, 0.5]])
    along_b = np.array([[0.0], [1.0]])
    found = program.along(((a, b), scale, 7.0), ((along_a, along_b), None, None))
    inputs = (a, b), np.full(3, scale), np.full(3, 7.0)
    for place in range(2):
        directions = (along_a[place], np.full(3, along_b[place])), *np.zeros((2, 3))
        values, expected = jax.jvp(jax.vmap(function), inputs, directions)
        for name, values_of_all in program((a, b), scale, 7.0).items():
            # Sine of the compiled code and XLA's: to rounding.
            np.testing.assert_allclose(values_of_all, values[name], rtol=1e-14)
            np.testing.assert_allclose(
                found[name][place], expected[name], rtol=1e-14, atol=1e-15
            )


def test_what_passes_through_programs_alone():
    """Nothing to compute, and nothing to compute it from."""
    same, one = closed_form(lambda x, y: (x, 1.0))(np.array([1.0, 2.0]), 3.0)
    np.testing.assert_array_equal(same, [1.0, 2.0])
    np.testing.assert_array_equal(one, [1.0, 1.0])
    np.testing.assert_array_equal(closed_form(lambda x: x)(np.arange(3)), [0, 1, 2])


def test_numbers_of_blocks_keep_their_derivatives():
    """Through gathering, computing and scattering, along two directions."""
    blocks = Carried(
        {"x": np.array([1.0, 4.0, 9.0])},
        {"x": np.array([[1.0, 0.0, 2.0], [0.0, 3.0, 0.0]])},
    )
    half = closed_form(lambda block: {"x": 0.5 * block["x"]})
    some = np.array([2, 0])
    blocks.put(some, call(half, blocks.at(some)))
    np.testing.assert_array_equal(blocks.value["x"], [0.5, 4.0, 4.5])
    np.testing.assert_array_equal(
        blocks.tangent["x"], [[0.5, 0.0, 1.0], [0.0, 3.0, 0.0]]
    )


@pytest.mark.parametrize(
    ("x", "slope"), [(4.0, 0.25), (0.0, np.inf), (-1.0, 0.0)], ids=str
)
def test_roots_of_what_does_not_change(x, slope):
    """The rate of a root at zero is infinite, which does not matter where nothing
    moves."""
    value, change = jax.jvp(root, (x,), (1.0,))
    assert (float(value), float(change)) == (np.sqrt(max(x, 0.0)), slope)
    assert float(jax.jvp(root, (x,), (0.0,))[1]) == 0.0


def test_where_a_projectile_comes_down():
    """x = v^2 sin(2 a) / g, by speed and angle; touching counts from a gap of 1e-9 of
    the block's size on."""
    v, angle = 20.0, np.radians(30.0)
    release = Release(SPHERE, 0.0, R, v * np.cos(angle), v * np.sin(angle))
    _, tangents = differentiate_runout(
        FLAT, release, DEAD, ["speed_mps", "direction_deg", "angular_velocity_degps"]
    )
    expected = [2 * v * np.sin(2 * angle) / G, 2 * v**2 * np.cos(2 * angle) / G, 0.0]
    np.testing.assert_allclose(tangents.contacts.x[:, 0], expected, rtol=1e-8)
    times = [2 * np.sin(angle) / G, 2 * v * np.cos(angle) / G, 0.0]
    np.testing.assert_allclose(tangents.contacts.time[:, 0], times, rtol=1e-8)


def test_a_bouncing_sphere_by_its_coefficient():
    """t_n = f (1 + 2 e + ... + 2 e^(n-1)), f the time of the first fall."""
    e, fall = 0.7, np.sqrt(2.0 / G)
    runs, tangents = differentiate_runout(
        FLAT,
        Release(SPHERE, 500.0, 1.0 + R),
        ClosedForm(ConstantCoefficients(e, 1.0)),
        ["e_n", "y_m"],
    )
    n = np.arange(len(runs.contacts.time))
    powers = np.where(n > 0, n * e ** np.maximum(n - 1, 0), 0.0)
    expected = 2.0 * fall * np.cumsum(powers)
    # Each touch is early by up to 1e-9 of the block, at speeds down to 0.2 m/s.
    np.testing.assert_allclose(tangents.contacts.time[0], expected, atol=1e-7)
    by_height = runs.contacts.time / 2.0
    np.testing.assert_allclose(tangents.contacts.time[1], by_height, atol=1e-7)
    assert tangents.x[0, 0] == 0.0


def test_how_far_a_sphere_rolls_on_the_flat():
    """x = 1.4 v^2 / (2 g tan(phi)), from where it touches at once."""
    v, phi = 6.0, np.radians(20.0)
    profile = Profile([0.0, 1000.0], [0.0, 0.0], rolling_friction_angle=phi)
    release = Release(SPHERE, 10.0, R, v, 0.0, 0.0, v / R)
    names = ["rolling_friction_angle_deg", "speed_mps", "x_m", "angular_velocity_degps"]
    found = runout_gradients(profile, release, DEAD, names, ["x_m", "time_s"])
    x = float(found.output_value[0, 0]) - 10.0
    assert x == pytest.approx(1.4 * v**2 / (2 * G * np.tan(phi)), rel=1e-5)
    # v' = (m R v + I w) / (m R^2 + I) R is 5/7 of its own speed and 2/7 of its spin's.
    by_friction = -x * (1.0 + np.tan(phi) ** 2) / np.tan(phi) * DEGREE
    expected = [by_friction, 2 * x / v * 5 / 7, 1.0, 2 * x / v * 2 / 7 * R * DEGREE]
    # It falls by 1e-9 of its size at first, on which it gets on by 4e-5 m.
    np.testing.assert_allclose(found.derivative[0, 0], expected, rtol=1e-4)
    assert np.all(found.standing == Standing.confirmed)


def test_blocks_that_leave_the_profile_or_run_out_of_time():
    profile = Profile([0.0, 50.0], [0.0, 0.0])
    release = Release(SPHERE, 10.0, 100.0, [20.0, 2.0], 0.0)
    runs, tangents = differentiate_runout(
        profile, release, DEAD, ["speed_mps", "x_m"], time_limit=3.0
    )
    assert [float(x) for x in runs.x] == pytest.approx([50.0, 16.0])
    # To the border in 2 s, by 2 s / v less for each m/s more; at the limit of 3 s.
    np.testing.assert_allclose(tangents.time, [[-0.1, 0.0], [-0.05, 0.0]])
    np.testing.assert_allclose(tangents.x, [[0.0, 3.0], [0.0, 1.0]], atol=1e-14)
    by_speed = 0.1 * 2.0 * G  # less time to fall
    np.testing.assert_allclose(tangents.y[0], [by_speed, 0.0], atol=1e-13)


def test_values_are_those_of_the_plain_run():
    """To the last bit with a law in closed form; impacts by code for derivatives differ
    by rounding, which a few contacts of a sphere hardly enlarge."""
    release = blocks_on_short_slope(20, 1.5)
    law = ClosedForm(PfeifferBowen(0.35, 0.85))
    plain = simulate_runout(BIPLANAR, dataclasses.replace(release, y=240.0), law)
    carried, _ = differentiate_runout(
        BIPLANAR, dataclasses.replace(release, y=240.0), law, ["y_m"]
    )
    np.testing.assert_array_equal(carried.x, plain.x)
    np.testing.assert_array_equal(carried.contacts.time, plain.contacts.time)
    release = blocks_on_short_slope(5, 1.0)
    plain = simulate_runout(short_slope(), release)
    carried, _ = differentiate_runout(short_slope(), release, FullModel(), ["gamma_v"])
    np.testing.assert_allclose(carried.x, plain.x, rtol=1e-9)


def differences(change, step):
    """Of end, time and first passage of x = 15 m, over runs made anew."""

    def numbers(amount):
        runs = simulate_runout(*change(amount), FullModel("reference"))
        _, first = first_passages(passages(runs, 15.0), runs.release.count)
        return np.stack([runs.x, runs.time, first.speed, first.lowest_height], axis=1)

    return (numbers(step) - numbers(-step)) / (2.0 * step)


@pytest.mark.parametrize("aspect_ratio", [1.0, 1.5])
def test_derivatives_of_the_model_are_those_of_differences(aspect_ratio):
    """Blocks of 4 to 15 contacts. Derivatives of an impact are exact to 3e-6 in 95 of
    100 cases and differences over 1e-5 to about 1e-4; both grow over the contacts."""
    release, gamma_v = blocks_on_short_slope(12, aspect_ratio), 8.7
    outputs = ["x_m", "time_s", "passage_speed_mps", "passage_lowest_height_m"]
    found = runout_gradients(
        short_slope(),
        release,
        None,
        ["gamma_v", "y_m"],
        outputs,
        collectors=[15.0],
    )
    step = 1e-5
    expected = [
        differences(lambda h: (short_slope(gamma_v=gamma_v + h), release), step),
        differences(
            lambda h: (short_slope(), dataclasses.replace(release, y=release.y + h)),
            step,
        ),
    ]
    confirmed = found.standing.values == Standing.confirmed
    # Nearly all of the spheres, most of the others.
    assert np.mean(confirmed) > (0.97 if aspect_ratio == 1.0 else 0.7)
    assert not np.any(np.isin(found.standing, [Standing.lost, Standing.no_value]))
    for number, slopes in enumerate(expected):
        own = found.derivative.values[:, :, number]
        off = np.abs(own - slopes) / (np.abs(slopes) + 1e-4)
        chosen = confirmed[:, :, number]
        assert np.median(off[chosen]) < 1e-4
        assert np.quantile(off[chosen], 0.9) < 5e-3
        assert np.all(np.isnan(own[~chosen]))


def test_a_blocks_numbers_are_of_one_tolerance():
    """Which is told: those of a run of all blocks with it, to the last bit."""
    release = blocks_on_short_slope(12, 1.5)
    choice = {"parameters": ["gamma_v", "k_E"], "hop_threshold": 0.0}
    found = runout_gradients(short_slope(), release, **choice)
    assert found.block.values.tolist() == list(range(12))
    tolerances = {2e-6, 1e-8}
    assert set(found.tolerance.values.tolist()) == tolerances
    for tolerance in tolerances:
        accuracy = Accuracy("same", tolerance, 1e-2)
        contacts = FullModel(accuracy)
        same = runout_gradients(short_slope(), release, contacts, **choice, check=False)
        own = found.tolerance.values == tolerance
        np.testing.assert_array_equal(found.output_value[own], same.output_value[own])
        given = found.isel(block=own).standing.values == Standing.confirmed
        assert np.all(given) or tolerance == 1e-8
        np.testing.assert_array_equal(
            found.derivative[own].values[given], same.derivative[own].values[given]
        )


def test_the_ground_is_found_from_a_mean_run_out():
    """Spheres keep their contacts: Newton's steps by the mean of the derivatives."""
    count, generator = 10, np.random.default_rng(1)
    release = Release(
        Block(mass=generator.uniform(50.0, 200.0, count)),
        2.0,
        232.0 + generator.uniform(0.0, 2.0, count),
        19.7,
        -3.5,
    )

    def slope(gamma_v):
        return Profile(BIPLANAR.x, BIPLANAR.y, Soil(gamma_v=gamma_v))

    accuracy = FullModel("reference")
    observed = np.mean(simulate_runout(slope(8.7), release, accuracy).x)
    gamma_v = 5.0
    for _ in range(4):
        found = runout_gradients(
            slope(gamma_v), release, accuracy, ["gamma_v"], ["x_m"]
        )
        assert np.all(found.standing == Standing.confirmed)
        excess = float(found.output_value.mean()) - observed
        gamma_v -= excess / float(found.derivative.mean())
    # Quadratic: errors of 3.7, 0.8, 0.05, 1e-4 and less.
    assert gamma_v == pytest.approx(8.7, abs=1e-4)


def test_a_change_of_contacts_is_refused():
    """A sphere that drops onto the end of a step, or just past it."""
    steps = Profile([0.0, 10.0, 10.1, 100.0], [5.0, 5.0, 0.0, 0.0])
    law = ClosedForm(ConstantCoefficients(0.3, 0.9))

    def run(v):
        return Release(SPHERE, 5.0, 5.0 + R, v, 2.0)

    near, far = 1.0, 40.0
    for _ in range(60):
        middle = 0.5 * (near + far)
        first = simulate_runout(steps, run(middle), law).contacts.segment[0]
        near, far = (middle, far) if first == 0.0 else (near, middle)
    there = run([0.5 * (near + far), near - 0.1])
    found = runout_gradients(steps, there, law, ["speed_mps"], ["x_m", "max_speed_mps"])
    assert found.standing[0, 0, 0] == Standing.sequence_changes
    assert np.isnan(found.derivative[0, 0, 0])
    assert found.same_sequence_within[0, 0] == 0.0
    assert found.standing[1, 0, 0] == Standing.confirmed
    unchecked = runout_gradients(steps, there, law, ["speed_mps"], check=False)
    assert np.all(unchecked.standing == Standing.unchecked)
    assert np.all(np.isfinite(unchecked.derivative))


class Planted(AbstractRebound):
    """A law with one right parameter, and three with wrong derivatives."""

    right: float = parameter(0.4, "-", "[0, 1]", "normal restitution")
    constant: float = parameter(0.8, "-", "[0, 1]", "its derivative is lost")
    kinked: float = parameter(0.5, "-", "[0, 1]", "its derivative is of one side")
    jumping: float = parameter(0.5, "-", "[0, 1]", "its jump has no derivative")

    def __call__(self, block, impact):
        kinked = jnp.where(self.kinked >= 0.5, self.kinked, 0.5)
        jump = jnp.where(self.jumping > 0.5, 0.01, 0.0)
        return Rebound(
            -(self.right + jump) * impact.normal_velocity,
            jax.lax.stop_gradient(self.constant) * impact.tangential_velocity,
            kinked * impact.angular_velocity,
        )


@pytest.mark.parametrize("planted", ["constant", "kinked", "jumping"])
def test_one_wrong_derivative_among_right_ones_is_found(planted):
    """Though all parameters change at once: those of each block alike, that have no
    part in the wrong one, are confirmed."""
    generator = np.random.default_rng(2)
    release = Release(
        Block(mass=generator.uniform(20.0, 400.0, 50)),
        *(5.0, generator.uniform(3.0, 9.0, 50), generator.uniform(1.0, 9.0, 50)),
        angular_velocity=generator.uniform(5.0, 20.0, 50),
    )
    right = ["speed_mps", "right", "y_m", "mass_kg", "angular_velocity_degps"]
    names = [*right[:3], planted, *right[3:]]
    law = ClosedForm(Planted())
    found = runout_gradients(FLAT, release, law, names, ["x_m", "time_s"])
    of_end = found.sel(output="x_m")
    assert np.all(of_end.standing.sel(parameter=planted) != Standing.confirmed)
    assert np.mean(of_end.standing.sel(parameter=right) == Standing.confirmed) > 0.95
    # The time of flight has no part in what moves blocks along or turns them.
    of_time = found.sel(output="time_s").standing.sel(parameter=right)
    assert np.mean(of_time == Standing.confirmed) > 0.95


def test_an_output_before_the_change_is_not():
    """Whether the sphere's last hop is followed decides where it ends, and not how fast
    it passed before."""
    law = ClosedForm(ConstantCoefficients(0.5, 0.9))

    def run(height):
        return Release(SPHERE, 5.0, R + np.asarray(height), 3.0)

    low, high = 1.0, 3.0
    contacts = len(simulate_runout(FLAT, run(low), law).contacts.x)
    for _ in range(60):
        middle = 0.5 * (low + high)
        same = len(simulate_runout(FLAT, run(middle), law).contacts.x) == contacts
        low, high = (middle, high) if same else (low, middle)
    names = ["time_s", "passage_time_s", "max_height_m"]
    found = runout_gradients(FLAT, run(low), law, ["y_m"], names, collectors=[6.0])
    assert found.standing[0, 0, 0] == Standing.sequence_changes
    assert np.all(found.standing[0, 1:, 0] == Standing.confirmed)
    assert float(found.derivative[0, 2, 0]) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    "law",
    [ConstantCoefficients(0.4, 0.8), RigidEllipsoid(0.4), BozzoloPamini()],
    ids=lambda law: type(law).__name__,
)
def test_blocks_on_rough_slopes(law):
    """Corners, edges, rolling, sliding and flights off: no derivative gets lost, and
    where contacts stay the same differences confirm it but for a few of a hundred,
    which turn too sharply: 1 to 6 as measured, most without friction."""
    generator = np.random.default_rng(5)
    x = np.cumsum(generator.uniform(0.3, 3.0, 40))
    y = -np.cumsum(np.diff(x, prepend=0.0) * generator.uniform(-0.2, 0.9, 40))
    count = 40
    aspect_ratio = np.where(np.arange(count) % 4, generator.uniform(0.6, 3, count), 1.0)
    release = Release(
        Block(mass=generator.uniform(20.0, 400.0, count), aspect_ratio=aspect_ratio),
        generator.uniform(x[0], x[20], count),
        y[0] + 2.0,
        generator.normal(0.0, 4.0, count),
        generator.normal(0.0, 2.0, count),
        generator.uniform(0.0, 6.0, count),
        generator.normal(0.0, 10.0, count),
    )
    names = ["speed_mps", "orientation_deg", "mass_kg", "rolling_friction_angle_deg"]
    found = runout_gradients(
        Profile(x, y),
        release,
        ClosedForm(law),
        names,
        ["x_m", "time_s"],
        event_limit=40,
    )
    standing = found.standing.values
    assert not np.any(standing == Standing.lost)
    same = standing != Standing.sequence_changes
    assert np.mean(same) > 0.7
    assert np.mean(standing[same] == Standing.differs) < 0.1
    assert np.median(found.contacts) >= 2


def test_what_cannot_be_asked_for():
    release = Release(SPHERE, 5.0, 5.0)
    with pytest.raises(InputError, match="gamma is unknown; did you mean gamma_v"):
        runout_gradients(FLAT, release, DEAD, ["gamma"])
    with pytest.raises(InputError, match="parameter e_n stands twice"):
        runout_gradients(FLAT, release, DEAD, ["e_n", "e_n"])
    with pytest.raises(InputError, match="at least one parameter"):
        runout_gradients(FLAT, release, DEAD, [])
    with pytest.raises(InputError, match="must be a list of names"):
        runout_gradients(FLAT, release, DEAD, "e_n")
    with pytest.raises(InputError, match="output x is unknown; did you mean x_m"):
        runout_gradients(FLAT, release, DEAD, ["e_n"], ["x"])
    with pytest.raises(InputError, match="needs a collector"):
        runout_gradients(FLAT, release, DEAD, ["e_n"], ["passage_speed_mps"])
    with pytest.raises(ValueError, match="FullModel or ClosedForm, but these are by"):
        runout_gradients(FLAT, release, lambda *_: None, ["y_m"])


def test_no_value_no_derivative():
    """A collector that is not passed; a parameter at the end of its range."""
    release = Release(SPHERE, 5.0, 5.0, 1.0)
    found = runout_gradients(
        Profile(FLAT.x, FLAT.y, Soil(alpha_s=0.0)),
        release,
        DEAD,
        ["y_m", "alpha_s"],
        ["passage_speed_mps", "y_m"],
        collectors=[900.0],
    )
    assert np.all(found.standing[0, 0] == Standing.no_value)
    assert np.all(np.isnan(found.derivative[0, 0]))
    assert found.standing[0, 1, 1] == Standing.unchecked
    assert list(found.output.values) == ["passage_speed_mps at 900.0", "y_m"]
    case = json.loads(found.attrs["case"])
    assert case["ground"]["soil"]["alpha_s"] == [0.0]
    assert case["release"]["v_x"] == [1.0]
    assert case["release"]["block"]["mass"] == [100.0]
    assert case["contacts"] == {"law": "ConstantCoefficients", "e_n": 0.0, "e_t": 1.0}


def test_ground_of_segments_is_not_taken_for_that_of_blocks():
    """Two segments, two blocks: a change of the soil is one of both segments."""
    x, release = [0.0, 500.0, 1000.0], Release(SPHERE, [100.0, 600.0], 3.0, 4.0)
    soft = Profile(x, [0.0, 0.0, 0.0], Soil(gamma_v=[8.7, 1.7]))
    both = runout_gradients(soft, release, None, ["gamma_v"], ["x_m"])
    assert np.all(both.standing == Standing.confirmed)
    for place, gamma_v in enumerate((8.7, 1.7)):
        # Blocks know nothing of the ground of the other.
        own = Release(SPHERE, release.x[place], 3.0, 4.0)
        alone = Profile(x[::2], [0.0, 0.0], Soil(gamma_v=gamma_v))
        found = runout_gradients(alone, own, None, ["gamma_v"], ["x_m"], check=False)
        np.testing.assert_allclose(found.derivative[0], both.derivative[place], 1e-6)


def test_rough_ground_samples_for_each_block():
    """Facets stay the same as parameters change a little; soil may differ by block."""
    release = blocks_on_short_slope(6, 1.0)
    ground = Ground(
        Soil(gamma_v=np.linspace(4.0, 9.0, 6)[:, None]),
        np.radians(20.0),
        np.radians(2.0),
        seed=1,
    )
    found = runout_gradients(
        short_slope(), release, None, ["gamma_v", "y_m"], ["x_m"], ground=ground
    )
    assert np.mean(found.standing == Standing.confirmed) > 0.6
    assert not np.any(found.standing == Standing.lost)


def test_unchecked_derivatives_of_flat_faces_are_refused():
    release = Release(Block(shape="RectangularPrism"), 5.0, 300.0)
    with pytest.raises(InputError, match=r"flat faces \(RectangularPrism\); runo"):
        differentiate_runout(BIPLANAR, release)
    with pytest.raises(InputError, match="give check=True"):
        runout_gradients(BIPLANAR, release, check=False)

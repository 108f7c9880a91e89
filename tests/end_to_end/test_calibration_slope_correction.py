"""A slope that nobody measured well, under blocks whose way in space is known."""

import jax
import numpy as np
import pytest
from calibration_studies import write_study_of
from error_messages import assert_one_line_error

from jaximpact import (
    PRESETS,
    Accuracy,
    Block,
    Impact,
    Soil,
    calibrate,
    predict,
    simulate,
)
from jaximpact.calibration import read_study
from jaximpact.calibration.problem.derived_targets import SIGN, as_stated
from jaximpact.calibration.problem.forward_model import engine_of
from jaximpact.calibration.problem.objective import Objective
from jaximpact.cli import main
from jaximpact.shapes import Ellipsoid

pytestmark = pytest.mark.slow

TARGETS = ("e_n", "e_t", "e_bar", "max_sinking_m", "v_n_mps", "v_t_mps")
TESTS = (  # campaign, mass, aspect ratio, speed, angle, orientation, slope
    ("north", 300, 1.3, 10, 40, 20, 25),
    ("north", 600, 1.5, 14, 55, -30, 25),
    ("north", 150, 1.0, 9, 20, 0, 25),
    ("south", 400, 1.4, 12, 45, 70, 15),
    ("south", 200, 1.2, 15, 30, 10, 15),
    ("south", 800, 1.0, 8, 60, 0, 15),
)
HEADER = "campaign,mass_kg,aspect_ratio,speed_mps,angle_deg,orientation_deg,slope_deg"
STUDY = """\
data = "tests.csv"
starts = 4
[parameters]
c_v = { start = 0.9, lower = 0.1, upper = 10.0 }
gamma_v = { start = 6.0, lower = 0.5, upper = 100.0 }
[nuisance.slope_deg]
by = "campaign"
prior = { mean = 0.0, sd = 6.0 }
turns_ground = true
"""
TRUE = (1.5, 4.0)
TURNS = (4.0, -3.0)
EXACT = Accuracy("exact", 1e-11, PRESETS["reference"].floor)


def write_study(folder, text=STUDY, measured=None):
    measured = (
        np.full((len(TESTS), len(TARGETS)), 0.5) if measured is None else measured
    )
    rows = [(*test, *values) for test, values in zip(TESTS, measured, strict=True)]
    return write_study_of(folder, text, (*HEADER.split(","), *TARGETS), rows)


@pytest.fixture(scope="module")
def objective(tmp_path_factory):
    study = read_study(write_study(tmp_path_factory.mktemp("study")))
    return Objective(study, study.variants[0], engine_of(study), EXACT)


@pytest.fixture(scope="module")
def points(objective):
    return objective(objective.bounds.coordinate([*TRUE, *TURNS])[None])


def test_turning_the_ground_changes_angle_and_orientation(points):
    """The model asked directly with the slope steeper by delta, the angle from the
    normal larger and the orientation, clockwise from the normal, smaller by it."""
    for row in (0, 3):
        _, mass, ratio, speed, angle, orientation, slope = TESTS[row]
        turn = TURNS[row // 3]
        impact = Impact(
            speed=speed,
            angle=np.deg2rad(angle + turn),
            orientation=np.deg2rad(orientation - turn),
            slope=np.deg2rad(slope + turn),
        )
        block, soil = Block(mass=mass, aspect_ratio=ratio), Soil(c_v=1.5, gamma_v=4.0)
        result = simulate(block, soil, impact, accuracy=EXACT)
        e_bar, sinking = points.predicted[0, row, 2:4]
        # Two programs of the same equations.
        assert e_bar == pytest.approx(float(result.e_bar), rel=1e-7)
        assert sinking == pytest.approx(float(result.max_sinking), rel=1e-7)
        # In space: the velocity after, from the true axes and from the stated ones.
        true = in_space(
            float(result.normal_velocity),
            float(result.tangential_velocity),
            slope + turn,
        )
        stated = in_space(*points.predicted[0, row, 4:6], slope)
        np.testing.assert_allclose(stated, true, rtol=1e-6, atol=1e-7 * speed)
        # And the coefficients are those of the stated axes.
        along = np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))]) * speed
        np.testing.assert_allclose(
            points.predicted[0, row, :2] * along * [-1.0, 1.0],
            points.predicted[0, row, 4:6],
            rtol=1e-12,
        )


def in_space(v_n, v_t, slope_deg):
    """Components to the right and up, down-slope being to the right."""
    slope = np.deg2rad(slope_deg)
    down_slope = np.array([np.cos(slope), -np.sin(slope)])
    into_ground = np.array([-np.sin(slope), -np.cos(slope)])
    return v_n * into_ground + v_t * down_slope


def test_way_in_space_is_kept():
    """Velocity and block before the impact stand where they stood: as vectors, and by
    the point of an ellipse, drawn in space, that is deepest along either normal."""
    _, mass, ratio, speed, angle, orientation, slope = TESTS[0]
    axes = Block(mass=mass, aspect_ratio=ratio).semi_axes
    clockwise = np.deg2rad(slope + orientation)
    major = np.array([np.sin(clockwise), np.cos(clockwise)])
    minor = np.array([major[1], -major[0]])
    round_about = np.linspace(0.0, 2.0 * np.pi, 200_001)[:, None]
    ellipse = float(axes.major) * np.cos(round_about) * major
    ellipse = ellipse + float(axes.minor) * np.sin(round_about) * minor
    velocities = []
    for turn in (0.0, TURNS[0]):
        there = {"slope_deg": slope + turn}
        there |= {"angle_deg": angle + SIGN["angle_deg"] * turn}
        there |= {"orientation_deg": orientation + SIGN["orientation_deg"] * turn}
        a = np.deg2rad(there["angle_deg"])
        velocities.append(
            in_space(speed * np.cos(a), speed * np.sin(a), there["slope_deg"])
        )
        into = in_space(1.0, 0.0, there["slope_deg"])
        deepest = ellipse[np.argmax(ellipse @ into)]
        theta = np.deg2rad(there["orientation_deg"])
        arm = Ellipsoid().tangency_arm(axes, np.sin(theta), np.cos(theta))
        # Points on the ellipse are 3e-5 apart.
        along = deepest @ in_space(0.0, 1.0, there["slope_deg"])
        assert along == pytest.approx(float(arm), abs=1e-4)
    np.testing.assert_allclose(velocities[1], velocities[0], rtol=1e-14)


def test_without_a_turn_nothing_changes(tmp_path, objective):
    """A turn of 0 is the study without the nuisance."""
    plain = read_study(write_study(tmp_path, STUDY.split("[nuisance")[0]))
    plain = Objective(plain, plain.variants[0], engine_of(plain), EXACT)
    turned = objective(objective.bounds.coordinate([*TRUE, 0.0, 0.0])[None])
    expected = plain(plain.bounds.coordinate(TRUE)[None])
    # Two codes: their sums run in another order.
    np.testing.assert_allclose(
        turned.predicted, expected.predicted, rtol=1e-6, atol=1e-8
    )


def test_jacobian_equals_central_differences(objective, points):
    width = 1e-4
    x, size = points.x[0], points.x.shape[1]
    steps = width * np.eye(size)
    around = objective(np.concatenate([x + steps, x - steps]))
    plus, minus = np.split(around.predicted, 2)
    differences = np.moveaxis((plus - minus) / (2.0 * width), 0, -1)
    largest = np.max(np.abs(differences), axis=(0, 2), keepdims=True)
    # Integration at 1e-11 over steps of 1e-4, and their square.
    np.testing.assert_allclose(
        points.jacobian[0] / largest, differences / largest, rtol=0.0, atol=1e-5
    )
    # Each test knows its own campaign's slope alone, and that one well.
    np.testing.assert_array_equal(points.jacobian[0, :3, :, 3], 0.0)
    assert np.all(np.max(np.abs(points.jacobian[0, :3, :, 2]), axis=1) > 1e-3)


def test_stated_axes_by_automatic_differentiation():
    """The derivatives of `as_stated`, along a random direction, against JAX's."""
    random = np.random.default_rng(1)
    values, rates = random.normal(size=(2, 5, 8))
    turn, speed = random.normal(size=(2, 5)), random.uniform(5.0, 9.0, size=(2, 5))
    angle = random.uniform(0.2, 1.2, size=5)

    def of_time(t):
        delta = turn[0] + t * turn[1]
        v_n, v_t = (values[:, 6 + i] + t * rates[:, 6 + i] for i in (0, 1))
        velocity = speed[0] + t * speed[1]
        n = v_n * jax.numpy.cos(delta) + v_t * jax.numpy.sin(delta)
        s = v_t * jax.numpy.cos(delta) - v_n * jax.numpy.sin(delta)
        e_n = -n / (velocity * np.cos(angle))
        e_t = s / (velocity * np.sin(angle))
        return jax.numpy.stack([e_n, e_t, n, s], axis=1)

    found = as_stated(TARGETS, values, rates, turn, speed, angle)
    expected = jax.jvp(of_time, (0.0,), (1.0,))
    for got, wanted, given in zip(found, expected, (values, rates), strict=True):
        np.testing.assert_allclose(got[:, [0, 1, 4, 5]], wanted, rtol=1e-12)
        np.testing.assert_array_equal(got[:, 2:4], given[:, 2:4])


def test_turned_ground_is_found_again(tmp_path, points):
    """Soil and both turns from noise-free targets; the prior of 6 degrees pulls by far
    less than sigma. A campaign that the fit knows is predicted with its turn, another
    one with the prior's."""
    text = STUDY + "[default_sigma]\n" + "".join(f"{t} = 1e-5\n" for t in TARGETS)
    path = write_study(tmp_path, text, points.predicted[0])
    found = calibrate(path)
    variant = found.result.variants[0]
    assert variant.reason.at_minimum
    np.testing.assert_allclose(variant.parameters[:2], TRUE, rtol=1e-4)
    np.testing.assert_allclose(variant.parameters[2:], TURNS, atol=1e-3)
    found.write(tmp_path / "out")
    again = predict(tmp_path / "out", tmp_path / "tests.csv").variants[0]
    np.testing.assert_allclose(again.best, points.predicted[0], atol=1e-4)
    table = (tmp_path / "tests.csv").read_text().replace("north", "west")
    (tmp_path / "other.csv").write_text(table)
    other = predict(found, tmp_path / "other.csv").variants[0]
    np.testing.assert_allclose(other.best[3:], points.predicted[0, 3:], atol=1e-4)
    # A prior of 6 degrees makes e_t of the west uncertain by some tenths.
    width = other.model_high - other.model_low
    assert np.all(width[:3, 1] > 0.05)
    assert np.all(width[3:, 1] < 1e-3)


BAD = {
    "no slope": ("turns_ground = true", "turns_ground = 1", ("true or false",)),
    "angle": (
        "[nuisance.slope_deg]",
        "[nuisance.angle_deg]\nprior = { sd = 1.0 }\n[nuisance.slope_deg]",
        ("turns_ground", "angle_deg"),
    ),
    "other column": ("slope_deg]", "orientation_deg]", ("belongs to slope_deg",)),
    "beyond": ("mean = 0.0", "mean = 31.0", ("angle_deg", "(-90, 90)")),
}


@pytest.mark.parametrize(("old", "new", "parts"), BAD.values(), ids=BAD)
def test_bad_study_is_one_line(tmp_path, capsys, old, new, parts):
    path = write_study(tmp_path, STUDY.replace(old, new, 1))
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, str(path), *parts)


def test_a_turn_needs_the_slope_stated(tmp_path, capsys):
    path = write_study(tmp_path)
    (tmp_path / "tests.csv").write_text("campaign,angle_deg,e_bar\na,30,0.5\n")
    assert main(["calibrate", str(path), "--out", str(tmp_path / "out")]) == 2
    assert_one_line_error(capsys, str(path), "turns_ground", "needs a column slope_deg")

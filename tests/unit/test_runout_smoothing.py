"""Smoothing of measured profiles."""

import json

import numpy as np
import pytest
from slope_study import CONSTANT, slope_text
from text_files import write_rows

from jaximpact import Block, ConstantCoefficients, Soil
from jaximpact.cli import main
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.runout import (
    ClosedForm,
    Profile,
    Release,
    read_slope_study,
    simulate_runout,
)
from jaximpact.runout.smoothing import smooth_heights


def hillside(x):
    return 200.0 * np.exp(-x / 150.0) + 4.0 * np.sin(x / 25.0)


def rms(values):
    return np.sqrt(np.mean(values**2))


@pytest.fixture
def irregular():
    """Places from 1 mm to 5 m apart, some of them in heaps."""
    rng = np.random.default_rng(3)
    steps = 10.0 ** rng.uniform(-3.0, np.log10(5.0), 400)
    return np.cumsum(steps) + 2.6e6


@pytest.mark.parametrize("length", [0.2, 1.0, 5.0, 20.0])
@pytest.mark.parametrize("curvature", [0.0, 1e-3])
def test_lines_and_parabolas_stay_up_to_the_ends(irregular, length, curvature):
    u = irregular - irregular[0]
    y = 1800.0 - 0.7 * u + curvature * u**2
    # x of millions of metres is rounded to 5e-10 m.
    np.testing.assert_allclose(smooth_heights(irregular, y, length), y, atol=1e-7)


def test_it_is_a_weighted_least_squares_fit_at_each_point(irregular):
    x, length = irregular - irregular[0], 3.0
    y = hillside(x) + np.random.default_rng(0).normal(size=len(x))
    smooth = smooth_heights(x, y, length)
    for i in (0, 1, 57, 200, len(x) - 1):
        near = np.abs(x - x[i]) <= 4.0 * length
        u = x[near] - x[i]
        # NumPy's weights are of the residuals, not of their squares.
        fit = np.polyfit(u, y[near], 2, w=np.exp(-0.25 * (u / length) ** 2))
        # Of two solutions of the same equations; heights differ by some metres.
        assert smooth[i] == pytest.approx(fit[-1], abs=1e-6)


@pytest.mark.slow
def test_blocks_stop_on_a_smoothed_profile_as_on_the_exact_one():
    """In the median. Over 2 m this noise is left enough of to throw blocks up at crests
    that they roll over without it."""
    x, generator = np.arange(0.0, 600.01, 0.25), np.random.default_rng(1)
    start = generator.uniform(3.0, 8.0, 60)
    release = Release(
        Block(mass=300.0 * np.exp(generator.normal(0.0, 0.5, 60))),
        x=start,
        y=hillside(start) + 2.0,
        v_x=generator.uniform(2.0, 12.0, 60),
    )
    law = ClosedForm(ConstantCoefficients(e_n=0.35, e_t=0.85))
    noise = 0.05 * np.random.default_rng(0).normal(size=len(x))
    exact, smooth, noisy = (
        np.median(simulate_runout(profile, release, law).x)
        for profile in (
            Profile(x, hillside(x)),
            Profile(x, hillside(x) + noise).smoothed(3.0),
            Profile(x, hillside(x) + noise),
        )
    )
    # Measured: 0.1 % of the way; with the noise a third of it is missing.
    assert smooth == pytest.approx(exact, rel=0.01)
    assert noisy < 0.8 * exact


def test_points_farther_apart_than_the_length_stay():
    x = np.arange(0.0, 300.0, 10.0)
    y = np.random.default_rng(0).normal(size=30)
    with pytest.warns(UnusualValueWarning, match=r"points that are 10 m apart; choose"):
        np.testing.assert_allclose(smooth_heights(x, y, 2.0), y, atol=1e-12)


def test_a_wall_that_is_rounded_off_is_told_with_its_place():
    x = np.arange(0.0, 100.0, 0.25)
    wall = np.where(x < 50.0, 5.0, 0.0)
    with pytest.warns(
        UnusualValueWarning, match=r"by 2.* m at x = (49.75|50) m: it rou"
    ):
        Profile(x, wall).smoothed(1.0)


def test_segments_keep_their_ground_and_ends_their_places():
    x = np.linspace(0.0, 100.0, 401)
    c_v, rolling = np.linspace(0.4, 0.9, 400), np.linspace(0.2, 0.5, 400)
    rough = Profile(x, hillside(x), Soil(c_v=c_v), rolling, 0.1)
    smooth = rough.smoothed(1.0)
    np.testing.assert_array_equal(smooth.x, x)
    np.testing.assert_array_equal(smooth.soil.c_v, c_v)
    np.testing.assert_array_equal(smooth.rolling_friction_angle, rolling)
    np.testing.assert_array_equal(smooth.roughness, 0.1)


@pytest.mark.parametrize(
    ("length", "said"),
    [
        (0, "above 0 and at most a tenth of the profile's 100 m"),
        (10.1, "but is 10.1 m"),
        *((bad, "must be a finite number") for bad in (np.nan, np.inf, [1.0, 2.0])),
        ("wide", "must be a number"),
    ],
)
def test_lengths_out_of_range_are_refused(length, said):
    with pytest.raises(InputError, match=f"the length of a smoothing .*{said}"):
        Profile([0.0, 50.0, 100.0], [50.0, 20.0, 0.0]).smoothed(length)


SLOPE = slope_text(
    top="",
    profile='csv = "profile.csv"\nsmooth_m = 2',
    ground="""
[ground.materials.scree]
from_x_m = 0
to_x_m = 60.1
c_v = 0.5
[ground.materials.meadow]
from_x_m = 60.1
to_x_m = 200
""",
    release="x_m = 2",
    contacts=CONSTANT,
)


@pytest.mark.slow
def test_a_study_smooths_and_says_by_how_much(slope, folder, capsys):
    x = np.arange(0.0, 200.01, 0.25)
    y = hillside(x) + 0.05 * np.random.default_rng(0).normal(size=len(x))
    write_rows(folder / "profile.csv", ("x_m", "y_m"), zip(x, y, strict=True))
    profile = read_slope_study(slope).profile
    moved = profile.height(x) - y
    assert rms(profile.height(x) - hillside(x)) < 0.5 * 0.05
    # The border of the materials is where the study has it.
    assert 60.1 in profile.x
    np.testing.assert_array_equal(profile.soil.c_v[profile.x[:-1] < 60], 0.5)
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    most = np.max(np.abs(moved))
    said = f"smoothed over 2 m, which moves heights by up to {most:.3g} m, "
    said += f"{rms(moved):.3g} m rms"
    assert said in " ".join(capsys.readouterr().out.split())
    assert said in (folder / "out/report.html").read_text(encoding="utf-8")
    assert json.loads((folder / "out/manifest.json").read_text())["profile"] == {
        "smooth_m": 2.0,
        "largest_move_m": pytest.approx(most),
        "rms_move_m": pytest.approx(rms(moved)),
    }

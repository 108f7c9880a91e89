"""Files of back-analyses: what is read, and what is refused, by name and place."""

import re

import numpy as np
import pytest

from jaximpact.cli import main
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.rebound import ConstantCoefficients
from jaximpact.runout import ClosedForm, read_slope_study, simulate_runout
from jaximpact.runout.back_analysis.data_sets import _seed, simulate_data_sets
from jaximpact.runout.back_analysis.observed import MOST_BLOCKS
from jaximpact.runout.back_analysis.problem import read_slope_fit

SLOPE = """
count = 5

[profile]
points_m = [[0, 40], [50, 10], [150, 10]]

[ground]
roughness_deg = 2

[ground.materials.debris]
from_x_m = 0
to_x_m = 50

[ground.materials.meadow]
from_x_m = 50
to_x_m = 150

[release]
x_m = 5
clearance_m = 2
speed_mps = 5

[contacts]
law = "constant coefficients"
e_n = 0.35
e_t = 0.85

[fit]
roughness_deg = { from = 0, to = 8 }

[fit.materials.meadow]
rolling_friction_angle_deg = { median = 25, geometric_sd = 1.3, most = 60 }

[observed]
stops = "stops.csv"
passages = "passages.csv"
counts = [{ x_m = 60, passed = 2, of = 3 }]
held_out_m = [80]
sigma = { x_m = 1 }
"""
STOPS = "x_m,name\n70,a\n75.5,b\n61,c\n"
PASSAGES = "collector_m,speed_mps,energy_kJ\n55,10,5\n55,12,\n80,4,3\n"
UNUSED = "ignore:.*not used are the columns name"


@pytest.fixture
def slope(tmp_path):
    path = tmp_path / "slope.toml"
    path.write_text(SLOPE)
    (tmp_path / "stops.csv").write_text(STOPS)
    (tmp_path / "passages.csv").write_text(PASSAGES)
    return path


def changed(path, old, new, name="slope.toml"):
    file = path.parent / name
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new))
    return path


def test_what_a_file_says(slope):
    with pytest.warns(UserWarning, match=r"stops.csv: not used are the columns name"):
        fit = read_slope_fit(slope)
    names = [parameter.name for parameter in fit.parameters]
    meadow = "materials.meadow.rolling_friction_angle_deg"
    assert names == ["roughness_deg", meadow]
    words = {c.words: c.blocks for c in fit.observed.channels}
    assert words == {
        "x_m of stopping points": 3,
        "speed_mps at x = 55 m": 2,
        "speed_mps at x = 80 m": 1,
        "energy_kJ at x = 55 m": 1,
        "energy_kJ at x = 80 m": 1,
        "share past x = 60 m": 3,
    }
    assert len(fit.observed.held_out) == 2
    assert fit.observed.released == 3
    assert fit.places == [55.0, 60.0, 80.0]
    np.testing.assert_allclose(fit.values(np.array([0.5, 0.5])), [4.0, 25.0], rtol=0.01)


@pytest.mark.slow
@pytest.mark.filterwarnings(UNUSED)
def test_parameters_of_a_law_are_fitted(slope):
    """Each data set meets the law of its own candidate, whatever the others have."""
    changed(slope, "e_n = 0.35\n", "")
    changed(
        slope,
        "[observed]",
        "[fit.contacts]\ne_n = { from = 0.2, to = 0.6 }\n"
        "e_t = { mean = 0.8, sd = 0.1, least = 0, most = 1 }\n\n[observed]",
    )
    fit = read_slope_fit(slope)
    assert [p.name for p in fit.parameters][2:] == ["contacts.e_n", "contacts.e_t"]
    assert fit.slope.laws[0].description["e_n"] == "fitted"
    u = np.array([[0.5, 0.5, 0.1, 0.9], [0.5, 0.5, 0.9, 0.1]])
    _, _, e_n, e_t = fit.values(u).T
    np.testing.assert_allclose(e_n, [0.24, 0.56])
    blocks = 20
    both = simulate_data_sets(fit, u, blocks, 0)
    _, release, ground = fit.slope.sample(
        2 * blocks,
        _seed(fit, 0, 0),
        {
            p.key: np.repeat(column, blocks)
            for p, column in zip(fit.parameters[:2], fit.values(u).T, strict=False)
        },
    )
    for i in range(2):
        law = ClosedForm(ConstantCoefficients(e_n[i], e_t[i]))
        runs = simulate_runout(fit.slope.layout.profile, release, law, ground=ground)
        mine = slice(i * blocks, (i + 1) * blocks)
        np.testing.assert_array_equal(both[i, :, 0], runs.x[mine])
    assert not np.any(both[0, :, 0] == both[1, :, 0])


@pytest.mark.filterwarnings(UNUSED)
@pytest.mark.parametrize(
    ("law", "fitted", "parts"),
    [
        (None, "e_m = { from = 0, to = 1 }", r"fit.contacts.e_m.*did you mean e_"),
        (None, "e_n = { from = 0, to = 2 }", r"fit.contacts.e_n.to: must be in"),
        ('law = "full model"', "e_n = { from = 0, to = 1 }", "for a law in closed"),
    ],
)
def test_parameters_that_a_law_does_not_have(slope, law, fitted, parts):
    if law is not None:
        changed(slope, 'law = "constant coefficients"\ne_n = 0.35\ne_t = 0.85', law)
    changed(slope, "[observed]", f"[fit.contacts]\n{fitted}\n\n[observed]")
    with pytest.raises(InputError, match=parts):
        read_slope_fit(slope)


def test_run_outs_pass_over_what_was_observed(slope):
    assert read_slope_study(slope).release.count == 5


def test_of_many_blocks_a_random_part_is_used(slope):
    x = np.linspace(60.0, 90.0, 10_000)
    (slope.parent / "stops.csv").write_text("x_m\n" + "\n".join(map(str, x)))
    with pytest.warns(UserWarning, match="10000 blocks were observed; 400 of them"):
        fit = read_slope_fit(slope)
    stops, *_, count = fit.observed.channels
    assert stops.blocks == fit.observed.released == MOST_BLOCKS
    # A uniform sample: 5 standard errors of its mean.
    assert np.mean(stops.values) == pytest.approx(75.0, abs=5 * 30 / 12**0.5 / 20)
    assert count.blocks == 1


@pytest.mark.filterwarnings(UNUSED)
@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("[fit]", "[fits]", "fits: is unknown; did you mean fit"),
        ("[observed]", "[observe]", "observe: is unknown.*observed"),
        ("roughness_deg = { f", "roughnes_deg = { f", "fit.roughnes_deg: .*roughness"),
        ("{ from = 0, to = 8 }", "3", "fit.roughness_deg: must be a prior"),
        (
            "{ from = 0, to = 8 }",
            "{ from = 0, to = 80 }",
            "roughness_deg.to: must be in",
        ),
        ("[fit.materials.meadow]", "[fit.materials.meadw]", "mean meadow"),
        ("{ from = 0, to = 8 }", "{ mean = 2, sd = 1 }", "roughness_deg.*reaches from"),
        ("[fit]", "[fit]\ndata_sets = 10", "key fit.data_sets: must be at least 200"),
        ("stops =", "stop =", "observed.stop: is unknown.*stops"),
        ("stops.csv", "none.csv", "none.csv: cannot be read"),
        ("held_out_m = [80]", "held_out_m = [81]", "holds 81, where no passage"),
        ("passed = 2", "passed = 4", "counts.1.passed: must be at most 3"),
        ("passed = 2, ", "", "counts.1.passed: is needed"),
        ("x_m = 60", "x_m = 600", "counts.1.x_m: must lie between"),
        ("sigma = { x_m = 1 }", "sigma = { x = 1 }", "sigma.x: is unknown"),
        ("sigma = { x_m = 1 }", "sigma = { x_m = -1 }", "x_m: must be at least 0"),
        ("sigma =", "blocks = 2\nsigma =", "blocks: must be at least 3"),
        (
            '[contacts]\nlaw = "constant',
            '[[contacts]]\n[[contacts]]\nlaw = "constant',
            "names 2 laws",
        ),
    ],
)
def test_bad_studies_are_refused(slope, old, new, told):
    with pytest.raises(InputError, match=told):
        read_slope_fit(changed(slope, old, new))


@pytest.mark.filterwarnings(UNUSED)
@pytest.mark.parametrize(
    ("name", "old", "new", "told"),
    [
        ("stops.csv", "x_m,", "x,", "row 1: needs one column x_m"),
        ("stops.csv", "75.5", "far", "row 3, column x_m: must be a number"),
        ("stops.csv", "75.5", "", "row 3, column x_m: must be a number, but is ''"),
        ("stops.csv", "75.5", "nan", "row 3, column x_m: must be a number"),
        ("stops.csv", "75.5", "755", "row 3, column x_m: must lie on the profile"),
        ("stops.csv", STOPS, "x_m\n", "has a header, but no row"),
        ("stops.csv", STOPS, "", "is empty"),
        ("passages.csv", "10,5", "-10,5", "row 2, column speed_mps: must be above 0"),
        ("passages.csv", "80,4,3", "800,4,3", "row 4, column collector_m: must lie"),
        ("passages.csv", "80,4,3", "80,4", "row 4: has 2 cells"),
        ("passages.csv", "energy_kJ", "speed_mps", "stands twice"),
    ],
)
def test_bad_tables_are_refused(slope, name, old, new, told):
    with pytest.raises(InputError, match=f"{name}.*{re.escape(told)}"):
        read_slope_fit(changed(slope, old, new, name))


@pytest.mark.filterwarnings(UNUSED)
@pytest.mark.parametrize("values", ["9999,5", "101,5"])
def test_speeds_that_no_block_has_are_warned_of(slope, values):
    changed(slope, "10,5", values, "passages.csv")
    with pytest.warns(
        UnusualValueWarning, match="row 2, column speed_mps: is .* no data"
    ):
        read_slope_fit(slope)


@pytest.mark.filterwarnings(UNUSED)
def test_parameters_that_the_law_does_not_know_are_told(slope):
    changed(
        slope, "roughness_deg = {", "gamma_v = { from = 1, to = 8 }\nroughness_deg = {"
    )
    with pytest.warns(UserWarning, match="key fit.gamma_v: .*constant coefficients"):
        read_slope_fit(slope)


def test_the_command_refuses_in_one_line(slope, capsys):
    changed(slope, "[observed]", "[observe]")
    out = slope.parent / "out"
    assert main(["calibrate", str(slope), "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "did you mean observed?" in error
    assert main(["calibrate", str(slope), "--out", str(out), "--posterior"]) == 2
    assert "--posterior is for impacts" in capsys.readouterr().err

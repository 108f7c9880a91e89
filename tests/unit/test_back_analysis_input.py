"""Files of back-analyses: what is read, and what is refused, by name and place."""

import numpy as np
import own_laws
import pytest
from error_messages import assert_one_line_error, warned_once
from slope_study import slope_text

from jaximpact.cli import main
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.rebound import ConstantCoefficients
from jaximpact.runout import ClosedForm, read_slope_study, simulate_runout
from jaximpact.runout.back_analysis.data_sets import _seed, simulate_data_sets
from jaximpact.runout.back_analysis.observed import MOST_BLOCKS, ObservedCount
from jaximpact.runout.back_analysis.problem import read_slope_fit

LAW = 'law = "constant coefficients"\ne_n = 0.35\ne_t = 0.85'
SLOPE = slope_text(
    top="count = 5",
    profile="points_m = [[0, 40], [50, 10], [150, 10]]",
    ground="""
[ground]
roughness_deg = 2
[ground.materials.debris]
from_x_m = 0
to_x_m = 50
[ground.materials.meadow]
from_x_m = 50
to_x_m = 150
""",
    release="x_m = 5",
    contacts=LAW,
)
SLOPE += """
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


@pytest.mark.filterwarnings(UNUSED)
def test_data_sets_are_kept_for_the_code_of_a_law(slope, tmp_path):
    """What was simulated with a law that has been edited since must not be taken."""
    own_laws.write_laws(tmp_path)
    changed(slope, "[ground]\n", '[ground]\nflow = "my_laws.py:Creeping"\n')
    before = read_slope_fit(slope).identity
    assert read_slope_fit(slope).identity == before
    changed(slope, "nucleus + creep", "2.0 * nucleus + creep", name="my_laws.py")
    assert read_slope_fit(slope).identity != before


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
    ("said", "law", "fitted"),
    [
        (r"fit.contacts.e_m.*did you mean e_", LAW, "e_m = { from = 0, to = 1 }"),
        (r"fit.contacts.e_n.to: must be in", LAW, "e_n = { from = 0, to = 2 }"),
        ("for a law in closed", 'law = "full model"', "e_n = { from = 0, to = 1 }"),
    ],
)
def test_parameters_that_a_law_does_not_have(slope, said, law, fitted):
    changed(slope, LAW, law)
    changed(slope, "[observed]", f"[fit.contacts]\n{fitted}\n\n[observed]")
    with pytest.raises(InputError, match=said):
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


UNIFORM, TWO_LAWS = "{ from = 0, to = 8 }", "[[contacts]]\n[[contacts]]\nlaw = "


@pytest.mark.filterwarnings(UNUSED)
@pytest.mark.parametrize(
    ("said", "old", "new"),
    [
        ("fits: is unknown; did you mean fit", "[fit]", "[fits]"),
        ("observe: is unknown.*observed", "[observed]", "[observe]"),
        ("fit.roughnes_deg: .*roughness", "roughness_deg = { f", "roughnes_deg = { f"),
        ("fit.roughness_deg: must be a prior", UNIFORM, "3"),
        ("roughness_deg.to: must be in", UNIFORM, "{ from = 0, to = 80 }"),
        ("mean meadow", "[fit.materials.meadow]", "[fit.materials.meadw]"),
        ("roughness_deg.*reaches from", UNIFORM, "{ mean = 2, sd = 1 }"),
        ("key fit.data_sets: must be at least 200", "[fit]", "[fit]\ndata_sets = 10"),
        ("observed.stop: is unknown.*stops", "stops =", "stop ="),
        ("none.csv: cannot be read", "stops.csv", "none.csv"),
        ("holds 81, where no passage", "held_out_m = [80]", "held_out_m = [81]"),
        (
            "2600029.5, where no passage",
            "held_out_m = [80]",
            "held_out_m = [2600029.5]",
        ),
        ("counts.1.passed: must be at most 3", "passed = 2", "passed = 4"),
        ("counts.1.passed: is needed", "passed = 2, ", ""),
        ("counts.1.x_m: must lie between", "x_m = 60", "x_m = 600"),
        ("sigma.x: is unknown", "sigma = { x_m = 1 }", "sigma = { x = 1 }"),
        ("x_m: must be at least 0", "sigma = { x_m = 1 }", "sigma = { x_m = -1 }"),
        ("blocks: must be at least 3", "sigma =", "blocks = 2\nsigma ="),
        ("names 2 laws", "[contacts]\nlaw = ", TWO_LAWS),
    ],
)
def test_bad_studies_are_refused(slope, said, old, new):
    with pytest.raises(InputError, match=said):
        read_slope_fit(changed(slope, old, new))


@pytest.mark.filterwarnings(UNUSED)
@pytest.mark.parametrize(
    ("name", "said", "old", "new"),
    [
        ("stops.csv", "row 1: needs one column x_m", "x_m,", "x,"),
        ("stops.csv", "row 3, column x_m: must be a number", "75.5", "far"),
        ("stops.csv", "row 3, column x_m: must be a number, but is ''", "75.5", ""),
        ("stops.csv", "row 3, column x_m: must be a number", "75.5", "nan"),
        ("stops.csv", "row 3, column x_m: must lie on the profile", "75.5", "755"),
        ("stops.csv", "has a header, but no row", STOPS, "x_m\n"),
        ("stops.csv", "is empty", STOPS, ""),
        ("passages.csv", "row 2, column speed_mps: must be above 0", "10,5", "-10,5"),
        ("passages.csv", "row 4, column collector_m: must lie", "80,4,3", "800,4,3"),
        ("passages.csv", "row 4: has 2 cells", "80,4,3", "80,4"),
        ("passages.csv", "stands twice", "energy_kJ", "speed_mps"),
    ],
)
def test_bad_tables_are_refused(slope, name, said, old, new):
    with pytest.raises(InputError, match=f"{name}.*{said}"):
        read_slope_fit(changed(slope, old, new, name))


@pytest.mark.parametrize(
    ("stops", "told"),
    [
        ("x_m,name,\n70,a,\n61,c,\n", "name"),
        (",x_m,,name\n0,70,,a\n1,61,,c\n", "one without a name, name"),
    ],
)
def test_columns_without_a_name_are_told_if_they_hold_something(slope, stops, told):
    (slope.parent / "stops.csv").write_text(stops)
    with warned_once(UserWarning, rf"stops\.csv: not used are the columns {told}$"):
        read_slope_fit(slope)


@pytest.mark.filterwarnings(UNUSED)
@pytest.mark.parametrize(
    ("values", "column"),
    [("9999,5", "speed_mps"), ("101,5", "speed_mps"), ("10,2e6", "energy_kJ")],
)
def test_passages_that_no_block_has_are_warned_of(slope, values, column):
    changed(slope, "10,5", values, "passages.csv")
    said = f"row 2, column {column}: is .* no data"
    with pytest.warns(UnusualValueWarning, match=said):
        read_slope_fit(slope)


@pytest.mark.filterwarnings(UNUSED)
def test_parameters_that_the_law_does_not_know_are_told(slope):
    changed(
        slope, "roughness_deg = {", "gamma_v = { from = 1, to = 8 }\nroughness_deg = {"
    )
    with pytest.warns(UserWarning, match="key fit.gamma_v: .*constant coefficients"):
        read_slope_fit(slope)


def test_the_command_refuses_in_one_line(slope, capsys):
    command = ["calibrate", str(slope), "--out", str(slope.parent / "out")]
    assert main([*command, "--posterior"]) == 2
    assert_one_line_error(capsys, "--posterior is for impacts")
    changed(slope, "[observed]", "[observe]")
    assert main(command) == 2
    assert_one_line_error(capsys, "did you mean observed?")


@pytest.mark.filterwarnings(UNUSED)
def test_of_more_blocks_released_none_observed_is_left_out(slope):
    """What was mapped is used whole, however many blocks came down."""
    few = [channel.blocks for channel in read_slope_fit(slope).observed.channels]
    changed(slope, "[observed]\n", "[observed]\nblocks = 1000\n")
    observed = read_slope_fit(slope).observed
    assert observed.released == 1000
    assert [channel.blocks for channel in observed.channels] == few
    assert not any("at random" in remark for remark in observed.remarks)


def test_places_of_a_national_grid_keep_their_digits():
    count = ObservedCount(2600150.4, 11, 20)
    assert count.words == "share past x = 2600150.4 m"

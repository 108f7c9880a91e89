"""Ground drawn as a calibration left it."""

import dataclasses
import json

import numpy as np
import pytest
from slope_study import assert_refused, slope_text
from text_files import write_changed

from jaximpact import PRESETS, read_netcdf
from jaximpact.calibration.fitted_ground import FORMAT
from jaximpact.cli import main
from jaximpact.errors import UnusualValueWarning
from jaximpact.runout import read_slope_study

pytestmark = pytest.mark.slow

NAMES = ("c_v", "gamma_v", "dilatancy")
MEAN = np.array([np.log(0.5), np.log(4.0), 0.8])
"""In the coordinates of the fit: dilatancy by half its range."""
ROOT = np.array([[0.2, 0.0, 0.0], [-0.15, 0.1, 0.0], [0.1, 0.1, 0.3]])
COVARIANCE = ROOT @ ROOT.T
SLOPE = slope_text(
    top="count = 4000\nseed = 7",
    profile="points_m = [[0, 20], [30, 0], [80, 0]]",
    ground='[ground]\nfrom = "fit"',
    block="mass_kg = { mean = 100, sd = 5 }",
    contacts='law = "rigid ellipsoid"\ne_contact = 0.3',
)
FROM = 'from = "fit"'
DEFAULTS = {"rolling_friction_angle_deg": 20.0, "roughness_deg": 0.0}
"""Of a ground, as the manifest says them."""


def fit(**changes):
    """As `jaximpact calibrate` writes it, as far as it is read: samples of a normal
    distribution between the bounds, with weights that change neither mean nor
    covariance."""
    normal = np.random.default_rng(0).normal(size=(5_000, 3)) @ ROOT.T
    x = np.concatenate([MEAN + normal, MEAN - normal])
    values = np.column_stack([np.exp(x[:, 0]), np.exp(x[:, 1]), 0.5 * x[:, 2]])
    values = values[(values[:, 2] >= 0.0) & (values[:, 2] <= 1.0)]
    # The unknowns of a fit hold what differs between campaigns too.
    values = np.insert(values, 1, 99.0, axis=1)
    variant = {key: {} for key in ("profiles", "fit", "parts")} | {
        "name": "as given",
        "soil": {"k_E": 700.0},
        "parameters": {
            name: {"value": value, "determined": True, "reason": None}
            for name, value in zip(NAMES, (0.5, 4.0, 0.4), strict=True)
        },
        "nuisances": {"slope_deg of a": {"value": 1.0}},
        "unknowns": ["c_v", "slope_deg of a", "gamma_v", "dilatancy"],
        "draws": {
            "values": values.tolist(),
            "weights": np.ones(len(values)).tolist(),
            "accuracy": dataclasses.asdict(PRESETS["balanced"]),
        },
        "uncertainty": {"inflation": 1.0},
    }
    ranges = ((0.01, 10.0), (0.05, 500.0), (0.0, 1.0))
    empty = ("block", "parts", "tied", "nuisances", "versions")
    manifest = {key: {} for key in empty} | {
        "soil": {"k_E": 500.0, "beta": 0.8},
        "parameters": {
            name: {"start": high, "lower": low, "upper": high, "prior": None}
            for name, (low, high) in zip(NAMES, ranges, strict=True)
        },
        "targets": ["e_n"],
        "accuracy": {"name": "balanced"},
        "seed": 0,
    }
    return {
        "format": FORMAT,
        "title": "sand",
        "variants": [variant | changes],
        "simple_laws": [],
        "comparison": None,
        "manifest": manifest,
        "fitted_tests": {"ranges": {}, "results": {}, "shapes": []},
        "sigma_given": {},
    }


@pytest.fixture
def here(folder):
    (folder / "fit").mkdir()
    write(folder, fit())
    (folder / "slope.toml").write_text(SLOPE)
    return folder


def write(path, content):
    (path / "fit" / "fit.json").write_text(json.dumps(content))


def study_with(path, ground, *pairs):
    """The study with a ground that its file says, and with replacements."""
    pairs = (FROM, ground), *pairs
    return read_slope_study(write_changed(path / "slope.toml", SLOPE, *pairs))


def coordinates(study):
    """x of what was drawn."""
    c_v, gamma_v, dilatancy = (study.inputs.ground_samples[name] for name in NAMES)
    return np.stack([np.log(c_v), np.log(gamma_v), dilatancy / 0.5])


def test_blocks_get_soils_as_the_calibration_left_them(here):
    study = read_slope_study(here / "slope.toml")
    x = coordinates(study)
    drawn = study.inputs.ground_samples
    assert drawn["dilatancy"].min() >= 0.0
    assert drawn["dilatancy"].max() <= 1.0
    # The third is cut at 0 and 1, 2.4 and 3.6 deviations off, which is hardly seen in
    # the first two. Five standard errors, and 0.005 for the cut.
    error = 5.0 / np.sqrt(4000.0)
    for i in (0, 1):
        deviation = np.sqrt(COVARIANCE[i, i])
        assert np.mean(x[i]) == pytest.approx(MEAN[i], abs=error * deviation + 0.005)
        assert np.std(x[i]) == pytest.approx(deviation, rel=error + 0.01)
    correlation = COVARIANCE[0, 1] / np.sqrt(COVARIANCE[0, 0] * COVARIANCE[1, 1])
    assert np.corrcoef(x[0], x[1])[0, 1] == pytest.approx(correlation, abs=error)
    np.testing.assert_array_equal(study.ground.soil.c_v[:, 0], drawn["c_v"])
    # What the fit held is held: the variant's before the study's.
    np.testing.assert_array_equal(study.profile.soil.k_E, 700.0)
    np.testing.assert_array_equal(study.profile.soil.beta, 0.8)
    assert len(study.inputs.checksums_by_name["fit.json"]) == 64
    assert study.inputs.ground_table == DEFAULTS | {"from": "fit"}


def test_neither_the_count_nor_other_draws_matter(here):
    whole = read_slope_study(here / "slope.toml")
    few = study_with(here, FROM, ("count = 4000", "count = 50"))
    for name in NAMES:
        np.testing.assert_array_equal(
            few.inputs.ground_samples[name], whole.inputs.ground_samples[name][:50]
        )
    plain = study_with(here, "c_v = 1")
    np.testing.assert_array_equal(plain.release.x, whole.release.x)
    np.testing.assert_array_equal(plain.release.block.mass, whole.release.block.mass)
    other = study_with(here, FROM, ("seed = 7", "seed = 8"))
    assert not np.any(
        other.inputs.ground_samples["c_v"] == whole.inputs.ground_samples["c_v"]
    )


def test_a_parameter_that_is_said_is_held_and_the_others_follow(here):
    study = study_with(here, f"{FROM}\nc_v = 0.8")
    assert set(study.inputs.ground_samples) == {"gamma_v", "dilatancy"}
    np.testing.assert_array_equal(study.profile.soil.c_v, 0.8)
    x = np.log(study.inputs.ground_samples["gamma_v"])
    ratio = COVARIANCE[0, 1] / COVARIANCE[0, 0]
    mean = MEAN[1] + ratio * (np.log(0.8) - MEAN[0])
    deviation = np.sqrt(COVARIANCE[1, 1] - ratio * COVARIANCE[0, 1])
    error = 5.0 / np.sqrt(4000.0)
    # 0.01 for the cut of the third, with which it is correlated.
    assert np.mean(x) == pytest.approx(mean, abs=error * deviation + 0.01)
    assert np.std(x) == pytest.approx(deviation, rel=error + 0.03)
    # Block by block, where it differs from block to block.
    study = study_with(here, f"{FROM}\nc_v = {{ from = 0.4, to = 1.2 }}")
    c_v, gamma_v, _ = coordinates(study)
    assert np.polyfit(c_v, gamma_v, 1)[0] == pytest.approx(ratio, abs=0.06)
    study = study_with(here, f"{FROM}\nc_v = 0.5\ngamma_v = 4\ndilatancy = 0")
    assert study.inputs.ground_samples == {}


def test_a_segment_may_have_its_own(here):
    study = study_with(here, f"{FROM}\n[ground.segment.2]\nc_v = 3")
    np.testing.assert_array_equal(study.ground.soil.c_v[:, 1], 3.0)
    np.testing.assert_array_equal(
        study.ground.soil.c_v[:, 0], study.inputs.ground_samples["c_v"]
    )


def test_samples_are_those_of_the_fit_by_their_weights(here):
    """Two heaps, which no normal distribution has, one of three times the weight."""
    values = [[0.1, 99.0, 2.0, 0.2], [2.0, 99.0, 50.0, 0.9]] * 500
    accuracy = fit()["variants"][0]["draws"]["accuracy"]
    draws = {"values": values, "weights": [3.0, 1.0] * 500, "accuracy": accuracy}
    write(here, fit(draws=draws))
    found = read_slope_study(here / "slope.toml").inputs.ground_samples
    low = found["c_v"] < 1.0
    # Four standard errors of 4000 blocks.
    assert np.mean(low) == pytest.approx(0.75, abs=4.0 * np.sqrt(0.1875 / 4000.0))
    np.testing.assert_allclose(found["gamma_v"], np.where(low, 2.0, 50.0), rtol=1e-12)
    np.testing.assert_allclose(found["dilatancy"], np.where(low, 0.2, 0.9), rtol=1e-12)


def test_few_samples_are_warned_of(here):
    content = fit()
    draws = content["variants"][0]["draws"]
    draws["weights"] = [1.0] * 20 + [0.0] * (len(draws["values"]) - 20)
    write(here, content)
    with pytest.warns(UnusualValueWarning, match="size is 20 of .* --posterior"):
        read_slope_study(here / "slope.toml")


def test_a_slope_is_a_group_of_its_own(here):
    """The variance of a new group's factor is added, and of no other parameter."""
    content = fit()
    prior = {"mean": 0.0, "sd": 0.3}
    content["manifest"]["nuisances"] = {
        "c_v": {"by": "campaign", "prior": prior, "pooled": True},
        "slope_deg": {"by": "campaign", "prior": prior},
    }
    write(here, content)
    variances = np.var(coordinates(read_slope_study(here / "slope.toml")), axis=1)
    # Four standard errors of variances of 4000 blocks; the cut of the third.
    np.testing.assert_allclose(
        variances[:2], [COVARIANCE[0, 0] + 0.09, COVARIANCE[1, 1]], rtol=0.09
    )


def test_undetermined_parameters_must_be_said(here, capsys):
    content = fit()
    reason = "the fit runs to its lower bound"
    content["variants"][0]["parameters"]["c_v"] |= {
        "determined": False,
        "reason": reason,
    }
    write(here, content)
    assert_refused(capsys, f"key ground ... must say c_v ... {reason}")
    study_with(here, f"{FROM}\nc_v = 0.5", ("4000", "20"))
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    dataset = read_netcdf(here / "out" / "blocks.nc")
    assert "ground_c_v" not in dataset
    assert len(np.unique(dataset.ground_gamma_v)) == 20
    manifest = json.loads((here / "out" / "manifest.json").read_text())
    assert manifest["ground"] == DEFAULTS | {"from": "fit", "c_v": 0.5}
    assert "fit.json" in manifest["files"]


def test_what_the_table_of_the_tests_says_of_the_ground_holds(here):
    """Values that all tests share, unless the study or the file of the fit says another
    one; defaults are not repeated."""
    content = fit()
    ranges = {"friction_angle_deg": 31.0, "k_E": 600.0, "psi": 0.4, "rho_c0": 0.001}
    ranges = {name: [value, value] for name, value in ranges.items()}
    content["fitted_tests"]["ranges"] = ranges | {"mass_kg": [1.0, 9.0], "c_v": [1, 2]}
    write(here, content)
    soil = study_with(here, f"{FROM}\npsi = 0.5").profile.soil
    assert np.unique(soil.friction_angle) == pytest.approx(np.radians(31.0))
    np.testing.assert_array_equal(soil.k_E, 700.0)
    np.testing.assert_array_equal(soil.psi, 0.5)


@pytest.mark.parametrize(
    ("ranges", "nuisances", "message"),
    [
        ([0.3, 0.4], {}, "must say psi, which is 0.3 to 0.4 in the tests"),
        (
            [0.33, 0.33],
            {"psi": {"by": "campaign", "prior": {"mean": 0.3, "sd": 0.1}}},
            "must say psi, which has a value for each campaign in the tests",
        ),
    ],
)
def test_what_differs_between_the_tests_must_be_said(
    here, capsys, ranges, nuisances, message
):
    content = fit()
    content["fitted_tests"]["ranges"] = {"psi": ranges}
    content["manifest"]["nuisances"] = nuisances
    write(here, content)
    assert_refused(capsys, f"key ground ... {message}")
    soil = study_with(here, f"{FROM}\npsi = 0.35").profile.soil
    np.testing.assert_array_equal(soil.psi, 0.35)
    (here / "p.csv").write_text("x_m,y_m,psi\n0,20,0.2\n30,0,0.3\n80,0,0.3\n")
    points = "points_m = [[0, 20], [30, 0], [80, 0]]"
    soil = study_with(here, FROM, (points, 'csv = "p.csv"')).profile.soil
    np.testing.assert_array_equal(soil.psi, [0.2, 0.3])


@pytest.mark.parametrize(
    ("message", "ground", "changes"),
    [
        ("fot ... cannot be read", 'from = "fot"', {}),
        ("ground.form ... is unknown", 'form = "fit"', {}),
        ("key ground.from ... must be a text", "from = 3", {}),
        ("ground.variant ... needs from too", 'variant = "a"', {}),
        ("no variant 'a' ... known are 'as given'", f'{FROM}\nvariant = "a"', {}),
        ("c_v between 0.01 and 10 ... it is 20", f"{FROM}\nc_v = 20", {}),
        (
            "ground.c_v ... leave out correlation_length_m",
            f"{FROM}\nc_v = {{ from = 1, to = 2, correlation_length_m = 3 }}",
            {},
        ),
        ("is no fit.json ... calibrate again", FROM, {"unknowns": ["c_v"]}),
        ("is no fit.json ... calibrate again", FROM, {"draws": None}),
    ],
)
def test_what_cannot_be_drawn_from_is_refused(here, capsys, message, ground, changes):
    write(here, fit(**changes))
    write_changed(here / "slope.toml", SLOPE, (FROM, ground))
    assert_refused(capsys, message)


def test_several_variants_need_a_name(here, capsys):
    content = fit()
    content["variants"].append(fit(name="other", soil={})["variants"][0])
    write(here, content)
    said = assert_refused(capsys, "2 variants ... as given, other")
    assert "InputError" not in said
    study = study_with(here, f'{FROM}\nvariant = "other"')
    np.testing.assert_array_equal(study.profile.soil.k_E, 500.0)


def test_a_column_of_the_profile_must_not_hide_it(here, capsys):
    (here / "p.csv").write_text("x_m,y_m,c_v\n0,20,1\n30,0,0.2\n80,0,0\n")
    points = "points_m = [[0, 20], [30, 0], [80, 0]]"
    write_changed(here / "slope.toml", SLOPE, (points, 'csv = "p.csv"'))
    assert_refused(capsys, "key ground.c_v ... is also a column of p.csv")

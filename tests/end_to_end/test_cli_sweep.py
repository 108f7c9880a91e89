"""`jaximpact sweep`: from a file or a named set to a NetCDF file."""

import pytest
from error_messages import assert_one_line_error

from jaximpact import read_netcdf
from jaximpact.cli import main

STUDY = """
accuracy = "fast"
[axes]
angle_deg = [0, 30, 60]
aspect_ratio = { from = 1, to = 2, count = 2 }
"""


@pytest.fixture
def study(folder):
    path = folder / "angles.toml"
    path.write_text(STUDY)
    return path


@pytest.mark.slow
def test_a_study_becomes_a_file_and_a_summary(study, tmp_path, capsys):
    assert main(["sweep", "angles.toml"]) == 0
    out, err = capsys.readouterr()
    dataset = read_netcdf(tmp_path / "angles.nc")
    assert dict(dataset.sizes) == {"angle_deg": 3, "aspect_ratio": 2}
    assert '"fast"' in dataset.attrs["accuracy"]
    assert "axes: angle_deg 3, aspect_ratio 2" in out
    assert f"{dataset.e_n.values.max():.4g}" in out
    assert "6 impacts written to angles.nc" in err
    # the journal is gone, nothing else was left
    assert {path.name for path in tmp_path.iterdir()} == {"angles.toml", "angles.nc"}


def test_the_option_overrides_the_accuracy_of_the_study(study, tmp_path):
    assert main(["sweep", "angles.toml", "--accuracy", "balanced"]) == 0
    attributes = read_netcdf(tmp_path / "angles.nc").attrs
    assert '"balanced"' in attributes["accuracy"]


def test_a_named_set(study, tmp_path):
    assert main(["sweep", "--set", "I", "--out", "first.nc"]) == 0
    assert dict(read_netcdf(tmp_path / "first.nc").sizes) == {
        "ground": 3,
        "aspect_ratio": 7,
    }


def test_points_of_a_store_are_counted_as_those_of_a_file(folder, capsys):
    # A block of no mass to speak of cannot be integrated.
    (folder / "fails.toml").write_text("[axes]\nmass_kg = [1e-300, 100, 200]\n")
    for out in ("a.nc", "a.zarr", "a.zarr"):
        assert main(["sweep", "fails.toml", "--out", out]) == 0
        said = capsys.readouterr().out
        assert said.startswith("axes: mass_kg 3\noutcomes: 2 detached, 1 failed\n")


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["sweep"], "study.toml --set is required"),
        (["sweep", "--set", "V"], "V is no parametric set"),
        (["sweep", "absent.toml"], "cannot be read"),
        (["sweep", "angles.toml", "--out", "angles.csv"], "must end in .nc"),
        (["sweep", "angles.toml", "--out", "absent/a.nc"], "existing directory"),
    ],
)
def test_wrong_input_is_one_line(study, capsys, arguments, part):
    assert main(arguments) == 2
    assert_one_line_error(capsys, part)


def test_interruption_says_how_to_go_on(study, capsys, monkeypatch):
    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("jaximpact.sweeping.simulate_batch", interrupted)
    assert main(["sweep", "angles.toml"]) == 130
    assert_one_line_error(capsys, "the same command goes on from here")

"""`jaximpact simulate`: what it prints and draws."""

import dataclasses
import json
import os
import subprocess
import sys

import pytest
from error_messages import assert_one_line_error

from jaximpact import Block, Impact, ImpactResult, Soil, simulate
from jaximpact.cli import main
from jaximpact.quantities import ENERGY_COLUMNS, FURTHER_COLUMNS, RESULT_COLUMNS


@pytest.fixture(scope="module")
def impact_along_the_normal():
    """An impact of which e_t has no meaning."""
    return simulate(Block(mass=500.0), Soil(), Impact())


def test_simulate_prints_every_result_as_json(folder, capsys, impact_along_the_normal):
    (folder / "scene.toml").write_text("[block]\nmass_kg = 500\n")
    assert main(["simulate", "scene.toml", "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    shown = json.loads(out)
    result = impact_along_the_normal
    assert shown["e_t"] is None
    assert shown["outcome"] == str(result.outcome)
    for column in (*RESULT_COLUMNS.values(), *FURTHER_COLUMNS.values()):
        if column.name != "e_t":
            assert shown[column.name] == float(getattr(result, column.field))
    for column in ENERGY_COLUMNS.values():
        expected = float(getattr(result.energy, column.field))
        assert shown["energy_J"][column.field] == expected
    assert shown["manifest"]["scene"]["mass_kg"] == 500.0
    assert shown["manifest"]["accuracy"]["name"] == "balanced"


def test_simulate_prints_every_result_as_text(folder, capsys, impact_along_the_normal):
    (folder / "scene.toml").write_text("mass_kg = 500\n")
    assert main(["simulate", "scene.toml"]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    shown = {line[0]: line[1:3] for line in lines if line[0] != "energy"}
    energy = {line[1]: line[2:4] for line in lines if line[0] == "energy"}
    result = impact_along_the_normal
    for column in (*RESULT_COLUMNS.values(), *FURTHER_COLUMNS.values()):
        value, unit = shown[column.name]
        assert float(value) == pytest.approx(
            float(getattr(result, column.field)), rel=1e-5, nan_ok=True
        )
        assert unit == column.unit.split()[0]
    assert energy.keys() == {column.field for column in ENERGY_COLUMNS.values()}
    assert energy["kinetic_in"] == ["49000", "J"]


def test_no_result_is_left_out_of_the_report():
    shown = {
        column.field for column in (*RESULT_COLUMNS.values(), *FURTHER_COLUMNS.values())
    }
    other = {"energy", "outcome_code", "scene", "accuracy", "history"}
    other |= {"engine"}
    fields = {field.name for field in dataclasses.fields(ImpactResult)}
    # e_t is read from a field that is never NaN on purpose.
    assert fields - {"tangential_ratio"} | {"e_t"} == shown | other


def test_the_accuracy_of_the_option_goes_before_that_of_the_file(folder, capsys):
    (folder / "scene.toml").write_text('accuracy = "reference"\n')
    used = []
    for arguments in ([], ["--accuracy", "balanced"]):
        assert main(["simulate", "scene.toml", "--json", *arguments]) == 0
        shown = json.loads(capsys.readouterr().out)
        used.append(shown["manifest"]["accuracy"]["name"])
    assert used == ["reference", "balanced"]


def test_a_plot_that_fails_leaves_no_file(folder, monkeypatch, capsys):
    (folder / "scene.toml").write_text("")

    def half_a_plot(self, path):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(ImpactResult, "plot", half_a_plot)
    assert main(["simulate", "scene.toml", "--plot", "plot.png"]) == 1
    assert_one_line_error(capsys, "No space left on device")
    assert os.listdir(folder) == ["scene.toml"]


def test_a_plot_is_drawn_to_the_file_that_was_named(folder, monkeypatch):
    (folder / "scene.toml").write_text("")
    monkeypatch.setattr(ImpactResult, "plot", lambda self, path: path.write_text("it"))
    assert main(["simulate", "scene.toml", "--plot", "plot.png"]) == 0
    assert (folder / "plot.png").read_text() == "it"


def test_a_bad_scene_is_one_line(folder, capsys):
    (folder / "scene.toml").write_text("[block]\nmass_kg = -1\n")
    assert main(["simulate", "scene.toml"]) == 2
    err = assert_one_line_error(
        capsys, "error: scene.toml, key mass_kg: must be above 0"
    )
    assert err.count("\n") == 1


@pytest.mark.slow
def test_compiled_program_is_kept_for_the_next_time(folder):
    (folder / "scene.toml").write_text("")
    command = ["simulate", "scene.toml", "--plot", "plot.png"]
    subprocess.run(
        [sys.executable, "-m", "jaximpact", *command],
        env=os.environ | {"XDG_CACHE_HOME": str(folder)},
        stdout=subprocess.DEVNULL,
        check=True,
    )
    # What drives lanes; an impact and its history, each also by the text of its program
    assert len(list((folder / "jaximpact").glob("machine-*"))) == 5


@pytest.mark.slow
def test_home_that_cannot_be_written_to_is_no_error(folder):
    (folder / "scene.toml").write_text("")
    (folder / "file").write_text("")
    done = subprocess.run(
        [sys.executable, "-m", "jaximpact", "simulate", "scene.toml", "--json"],
        env=os.environ | {"XDG_CACHE_HOME": str(folder / "file")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""

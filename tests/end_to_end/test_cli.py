"""The command line: exit codes, what goes to which stream, and what is left behind."""

import dataclasses
import io
import json
import os
import re
import subprocess
import sys
import time

import numpy as np
import pytest
from error_messages import assert_one_line_error
from text_files import rows_of

from jaximpact import (
    Block,
    Impact,
    ImpactResult,
    Outcome,
    Soil,
    simulate,
    simulate_batch,
)
from jaximpact.backend.simd import LEVELS, host
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.progress import as_progress, in_words, tell, telling
from jaximpact.progress_lines import ProgressLines, showing
from jaximpact.quantities import (
    ENERGY_COLUMNS,
    FURTHER_COLUMNS,
    INPUT_COLUMNS,
    RESULT_COLUMNS,
)

SCENES = "name,mass_kg\nc,3\na,1\nb,2\n"


@pytest.fixture
def folder(folder):
    """A working directory with one table of scenes."""
    (folder / "scenes.csv").write_text(SCENES)
    return folder


# --- arguments and help


def test_help_explains_every_command_option_and_column(capsys):
    for command, words in (
        ([], ["simulate", "batch", "calibrate", "--version"]),
        (["batch"], ["--out", "--timing", "--accuracy", *INPUT_COLUMNS]),
        (["batch"], [*RESULT_COLUMNS, "outcome"]),
        (["simulate"], ["--json", "--plot", "--accuracy", *INPUT_COLUMNS]),
        (["calibrate"], ["--out", "STUDY", "expression", "group_sd"]),
    ):
        with pytest.raises(SystemExit) as exit_:
            main([*command, "--help"])
        assert exit_.value.code == 0
        text = capsys.readouterr().out.split()
        assert set(words) <= {word.strip("[],:") for word in text}


def test_the_module_runs_as_a_program():
    done = subprocess.run(
        [sys.executable, "-m", "jaximpact", "batch"], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("jaximpact: error: the following arguments are req")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ([], "COMMAND"),
        (["bach"], "'bach'"),
        (["validate"], "in a checkout of the repository run python -m paper claims"),
        (["batch", "scenes.csv"], "--out"),
        (["batch", "--out", "o.csv"], "scenes.csv"),
        (["batch", "scenes.csv", "--out", "o.csv", "--accuracy", "fats"], "'fats'"),
        (["batch", "scenes.csv", "--out", "o.csv", "--time"], "--time"),
        (
            ["batch", "scenes.csv", "--oot", "o.csv"],
            "--oot is no option of jaximpact batch; did you mean --out?",
        ),
        (["--versio"], "--versio is no option of jaximpact; did you mean --version?"),
        (["batch", "scenes.csv", "--out", "o.xlsx"], "must end in .csv or .parquet"),
        (["batch", "scenes.csv", "--out", "o"], "must end in .csv or .parquet"),
        (["batch", "scenes.csv", "--out", "none/o.csv"], "existing directory"),
        (["batch", "scenes.csv", "--out", "."], "must be a file"),
        (["batch", "scenes.csv", "--out", os.devnull], "must be a file"),
        (["simulate", "scene.toml", "--plot", "plot.csv"], ".png"),
        (["simulate", "scene.toml", "--plot", "none/plot.png"], "existing directory"),
    ],
)
def test_wrong_arguments_are_one_line_and_leave_nothing(
    folder, capsys, arguments, part
):
    assert main(arguments) == 2
    assert assert_one_line_error(capsys, "error: ", part).count("\n") == 1
    assert os.listdir(folder) == ["scenes.csv"]


# --- batch


def test_results_stand_in_the_order_of_the_scenes(folder, capsys):
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == 0
    rows = rows_of("results.csv")
    assert [row["name"] for row in rows] == ["c", "a", "b"]
    expected = simulate_batch(Block(mass=[3.0, 1.0, 2.0]))
    assert [float(row["e_n"]) for row in rows] == expected.e_n.tolist()
    assert [row["outcome"] for row in rows] == ["detached"] * 3
    names = ["results.csv", "results.csv.manifest.json", "scenes.csv"]
    assert sorted(os.listdir(folder)) == names
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines()[-1] == "jaximpact: 3 impacts: 3 detached"


def test_a_scene_that_cannot_be_solved_does_not_stop_the_rest(
    folder, monkeypatch, capsys
):
    def failing(*arguments, **options):
        result = simulate_batch(*arguments, **options)
        codes = np.array([Outcome.detached, Outcome.failed, Outcome.detached], float)
        e_n = np.where(codes == Outcome.failed, np.nan, result.e_n)
        return dataclasses.replace(result, e_n=e_n, outcome_code=codes)

    monkeypatch.setattr("jaximpact.batch.simulate_batch", failing)
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == 0
    rows = rows_of("results.csv")
    assert [row["outcome"] for row in rows] == ["detached", "failed", "detached"]
    assert [row["e_n"] == "nan" for row in rows] == [False, True, False]
    err = capsys.readouterr().err
    assert err.splitlines()[-1] == "jaximpact: 3 impacts: 2 detached, 1 failed"


def test_accuracy_and_timing(folder, capsys):
    arguments = ["--accuracy", "fast", "--timing"]
    assert main(["batch", "scenes.csv", "--out", "results.csv", *arguments]) == 0
    manifest = json.loads((folder / "results.csv.manifest.json").read_text())
    assert manifest["accuracy"]["name"] == "fast"
    times = r"jaximpact: [\d.]+ s compiling, [\d.]+ s running, \d+ impacts/s in machine"
    assert re.search(times, capsys.readouterr().err)


def test_where_a_journal_holds_all_results_no_times_are_told(
    folder, monkeypatch, capsys
):
    def cut_short(table, result):
        raise KeyboardInterrupt

    command = ["batch", "scenes.csv", "--out", "results.csv", "--timing"]
    with monkeypatch.context() as patch:
        patch.setattr("jaximpact.io.result_table._lines", cut_short)
        assert main(command) == 130
    capsys.readouterr()
    assert main(command) == 0
    said = capsys.readouterr().err
    assert "no impact was computed: results.csv.journal held all results" in said
    assert "impacts/s" not in said


@pytest.mark.parametrize(
    ("error", "code", "part"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (OSError(28, "No space left on device"), 1, "No space left on device"),
    ],
)
def test_a_batch_that_is_cut_short_leaves_its_journal_alone(
    folder, monkeypatch, capsys, error, code, part
):
    def cut_short(table, result):
        yield ["half of it"]
        raise error

    monkeypatch.setattr("jaximpact.io.result_table._lines", cut_short)
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == code
    assert_one_line_error(capsys, part)
    assert sorted(os.listdir(folder)) == ["results.csv.journal", "scenes.csv"]


# --- simulate


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
    assert sorted(os.listdir(folder)) == ["scene.toml", "scenes.csv"]


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
    # What drives lanes; an impact and its history, each also by the text of its
    # program, unless they come with the package
    come = host()[0] in LEVELS and sys.platform.startswith("linux")
    kept = list((folder / "jaximpact").glob("machine-*"))
    assert len(kept) == (1 if come else 5)


# --- progress


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_on_a_terminal_overwrites_itself(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    with ProgressLines() as progress:
        progress("impacts", 1, 3)
        progress("impacts", 3, 3)
    assert sys.stderr.getvalue() == (
        "\r1 of 3 impacts (33 %)\r3 of 3 impacts (100 %)\n"
    )


def test_progress_elsewhere_is_a_line_every_tenth(monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with ProgressLines() as progress:
        for done in range(101):
            progress("impacts", done, 100)
    lines = sys.stderr.getvalue().splitlines()
    assert lines == [f"{n} of 100 impacts ({n} %)" for n in range(0, 101, 10)]


def test_progress_in_python_waits_and_can_be_off(monkeypatch):
    """Short work has no line; False is silence; who listens already hears it alone."""
    monkeypatch.setattr(sys, "stderr", Terminal())
    clock = iter(range(100))
    monkeypatch.setattr(time, "monotonic", lambda: 1.5 * next(clock))
    with showing(None):  # at 0 s: lines from 2 s on
        tell("early")
        tell("late")
    with showing(False):
        tell("silent")
    with pytest.raises(InputError, match="progress"), showing("bar"):
        pass
    heard = []
    with telling(as_progress(heard.append)), showing(None):
        tell("heard")
    assert sys.stderr.getvalue() == "\rlate\n"
    assert heard == ["heard"]


def test_a_count_stands_behind_its_step():
    assert in_words("drops: impacts", 3, 10) == "drops: 3 of 10 impacts"
